# SPDX-License-Identifier: Apache-2.0
.PHONY: build test
build:
	cmake -S . -B build -G Ninja
	ninja -C build
test: build
	ctest --test-dir build --output-on-failure
