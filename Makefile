# SPDX-License-Identifier: Apache-2.0
# The daily workflow. Each verb first installs its own missing packages (scripts/setup), and only those.
JOBS := $(shell nproc)
PREFIX ?= /usr/local
.DEFAULT_GOAL := build
.PHONY: help build install demo test test-full gallery precision mutate bench bench-rtl asan tsan fuzz extremes soak format clean references mutate-golden fpga-tools fpga board-sim headline fpga-fast fpga-plans area-check tradeoffs studies plan-promise plan-boards sweep-search slurm-test cycle-fit engine-predictions report-bundle mutate-hls test-hls formal signoff mutate-auto faults large-scenes

help: ## this list
	@sed -n 's/^\([a-z-]*\):[^#]*## \(.*\)/  make \1\t\2/p' Makefile | expand -t 24

build: ## build/photonloom (the default)
	@scripts/setup build
	@cmake --preset release
	@cmake --build build --target photonloom scenes

install: build ## the program with its data, manual page and completions into PREFIX (/usr/local), under DESTDIR if set
	@cmake --build build --target manual
	@cmake --install build --prefix "$(PREFIX)"

demo: build ## images of two scenes: reference, golden, error map, metrics; then the same through the RTL
	@scripts/setup demo
	@scripts/demo

test: ## the quick tests
	@scripts/setup test
	@cmake --preset release -DBUILD_TESTING=ON
	@cmake --build build --target quick
	@ctest --preset release -j $(JOBS)

test-full: ## all tests, the slow ones too
	@scripts/setup test-full
	@cmake --preset release -DBUILD_TESTING=ON
	@cmake --build build
	@ctest --test-dir build --output-on-failure -j $(JOBS)

gallery: build ## all scenes by both integrators, with metrics: docs/gallery.md and its contact sheet
	@scripts/gallery

mutate: ## planted bugs in the RTL, each caught by a bench or a test
	@scripts/setup mutate
	@cmake --preset release -DBUILD_TESTING=ON
	@cmake --build build --target benches scenes test_rtl test_rtl_slow
	@scripts/mutate

bench: ## the golden gather beside nanoflann, FLANN and CGAL (10 minutes)
	@scripts/setup bench
	@scripts/bench

large-scenes: build ## ten million triangles and a billion of instances rendered, and mesh readers beside assimp: docs/scene.md
	@scripts/setup bench
	@cmake -S bench -B build/bench -G Ninja
	@cmake --build build/bench --target bench_meshes
	@scripts/large-scenes

bench-rtl: ## throughput of the RTL units beside its goals
	@scripts/setup bench-rtl
	@cmake --preset release
	@scripts/bench-rtl

formal: formal-arguments ## proofs of the RTL and of golden's error bounds, each beside a planted bug that must be refuted (15 minutes on two cores; docs/formal.md)
	@scripts/setup formal
	@scripts/fpga-tools
	@scripts/formal $(FORMAL_FLAGS)

signoff: ## what of the units' RTL their benches reach, and every hole with its reason, into each unit's page (UNITS=...; half an hour)
	@scripts/setup signoff
	@cmake --preset release
	@cmake --build build --target benches
	@scripts/signoff $(UNITS) --update

faults: ## faults of link, board, memory port, units and disk, and what becomes of results: docs/faults.md
	@scripts/setup faults
	@cmake --preset release -DBUILD_TESTING=ON
	@cmake --build build --target photonloom scenes benches test_units test_command test_command_slow test_rtl_slow
	@scripts/faults --update

mutate-auto: ## COUNT (200) mutants of each unit's RTL, of operators, constants and conditions, each caught by its bench (UNITS=..., SEED=1; hours)
	@scripts/setup mutate-auto
	@cmake --preset release
	@cmake --build build --target benches
	@scripts/mutate-auto $(UNITS) --count $(or $(COUNT),200) --seed $(or $(SEED),1) --update

references: build ## scenes/references: path traced, two seeds, with their own error
	@scripts/references

mutate-golden: ## planted faults in golden, each caught by a named test
	@scripts/setup mutate-golden
	@scripts/mutate-golden

mutate-hls: ## planted faults in the HLS kernels, each caught by a bench
	@scripts/setup mutate-hls
	@cmake --preset release -DBUILD_TESTING=ON
	@cmake --build build --target benches
	@scripts/mutate --hls

test-hls: build ## a kernel package by g++ and clang++ with each toolset (AP_TYPES_INCLUDE, AC_TYPES_INCLUDE: the real headers)
	@scripts/setup test-hls
	@scripts/test-hls
	@scripts/test-hls --subset

precision: build ## what positions, mantissas and directions cost: docs/precision.md
	@scripts/setup precision
	@scripts/precision

asan: ## the quick tests under AddressSanitizer and UndefinedBehaviorSanitizer: docs/sanitizers.md
	@scripts/setup asan
	@scripts/asan

tsan: ## frames and a sweep under ThreadSanitizer: docs/sanitizers.md
	@scripts/setup tsan
	@scripts/tsan

fuzz: ## SECONDS (60) of libFuzzer for each thing that reads files or bytes, and the lines of its parser that were reached: docs/sanitizers.md
	@scripts/setup fuzz
	@scripts/fuzz --update $(or $(SECONDS),60)

extremes: ## cases at the ends of all ranges, with the RTL: docs/extremes.md; bounds of golden's arithmetic: docs/error-analysis.md
	@scripts/setup extremes
	@cmake --preset release -DBUILD_TESTING=ON
	@cmake --build build --target extremes
	@scripts/extremes

# Wrong arguments are told before anything is built or fetched; without a Python yet, once scripts/setup brought it.
JUDGED = ! command -v python3 >/dev/null ||
FPGA_ARGUMENTS = $(if $(PLAN),"$(PLAN)") $(if $(BOARD),--board "$(BOARD)") $(if $(SEEDS),--seeds "$(SEEDS)") $(if $(UNITS),--units "$(UNITS)") $(if $(CLOCK),--clock "$(CLOCK)") $(FPGA_FLAGS)
HEADLINE_ARGUMENTS = $(PLAN) $(if $(SEEDS),--seeds "$(SEEDS)") $(if $(CLOCK),--clock "$(CLOCK)") $(HEADLINE_FLAGS)
.PHONY: fpga-arguments headline-arguments fpga-tools-arguments formal-arguments soak-arguments
fpga-arguments:
	@$(JUDGED) scripts/fpga $(FPGA_ARGUMENTS) --dry-run
headline-arguments:
	@$(JUDGED) scripts/headline $(HEADLINE_ARGUMENTS) --dry-run
fpga-tools-arguments:
	@$(JUDGED) scripts/fpga $(if $(BOARD),--board "$(BOARD)") --dry-run
formal-arguments:
	@$(JUDGED) scripts/formal $(FORMAL_FLAGS) --list >/dev/null
soak-arguments:
	@scripts/soak --dry-run $(PACKETS)

soak: soak-arguments ## PACKETS (10000000) random packets through the gatherer and the reorder buffer, golden beside RTL: docs/soak.md
	@scripts/setup soak
	@cmake --preset release
	@cmake --build build --target bench_photon_gatherer bench_reorder_buffer
	@scripts/soak $(PACKETS)

FPGA_TOOLS = case "$(BOARD)" in arty-a7-100t | nexys-video) scripts/fpga-tools --xilinx ;; *) scripts/fpga-tools ;; esac

fpga-tools: fpga-tools-arguments ## Yosys, nextpnr-ecp5 and ecppack in build/fpga-tools, without touching the host; for an Artix-7 BOARD its nextpnr too
	@$(FPGA_TOOLS)

fpga: fpga-arguments build ## resources, Fmax and bitstream of PLAN on BOARD (SEEDS=3, UNITS=... for some parts)
	@scripts/setup fpga
	@case "$(BOARD)" in up5k) ;; *) $(FPGA_TOOLS) ;; esac
	@scripts/fpga $(FPGA_ARGUMENTS)

headline: headline-arguments build ## gathers a second of a routed board beside one core of this machine (hours where nothing is routed yet; goes on where it was ended; PLAN, SEEDS, CLOCK)
	@scripts/setup headline
	@scripts/fpga-tools
	@cmake --build build --target throughput_gather_cluster board_sim
	@cmake -S bench -B build/bench -G Ninja
	@cmake --build build/bench
	@scripts/headline $(HEADLINE_ARGUMENTS)

board-sim: build ## a frame through a simulated board over a pseudo-terminal, with link faults (10 minutes)
	@scripts/setup board-sim
	@cmake --build build --target board_sim
	@scripts/board-sim

fpga-fast: build ## the gatherer alone, wide and narrow: cycles, clocks, gathers a second for 1,000 LUT-equivalents (an hour; takes what was routed)
	@scripts/setup fpga-fast
	@scripts/fpga-tools
	@rm -f build/bench/rtl_photon_gatherer.json # cycles of earlier RTL
	@scripts/bench-rtl photon_gatherer || [ -s build/bench/rtl_photon_gatherer.json ]
	@scripts/fpga-fast

fpga-plans: build ## what several plans cost, and the fit that predicts it: docs/fpga-plans.md (an hour)
	@scripts/setup fpga-plans
	@scripts/fpga-tools
	@scripts/fpga-plans

tradeoffs: build ## a hundred plans on three scenes, error against cycles, LUTs and bytes: docs/tradeoffs.md (17 minutes on fast cores)
	@scripts/setup tradeoffs
	@scripts/tradeoffs

plan-promise: build ## whether plans for a visible error keep it on whole frames: docs/planner.md (half an hour)
	@scripts/setup plan-promise
	@scripts/plan-promise

plan-boards: build ## whether the engines planned for a board are routed: docs/planner.md (hours)
	@scripts/setup headline
	@scripts/fpga-tools
	@scripts/plan-boards

engine-predictions: ## predicted cycles of engines beside simulated ones: docs/planner.md (a quarter of an hour)
	@scripts/setup test
	@cmake --preset release -DBUILD_TESTING=ON
	@cmake --build build --target photonloom scenes test_study_slow
	@scripts/engine-predictions

studies: build ## shipped studies with tables, plots and goals: docs/studies.md (an hour)
	@scripts/setup studies
	@scripts/studies

cycle-fit: build ## plans through the RTL, and the fit that predicts cycles a gather: study/cycle_fit.hpp
	@scripts/setup cycle-fit
	@build/photonloom sweep studies/cycles.toml -o build/cycles
	@sed 's/^cycles = "rtl"/cycles = "model"/' studies/cycles.toml >build/cycles_modelled.toml # the same scenes, in ../scenes
	@build/photonloom sweep build/cycles_modelled.toml -o build/cycles_modelled
	@scripts/cycle-fit build/cycles/results.csv build/cycles_modelled/results.csv

sweep-search: ## what the strategy `search` of a study needs: Optuna
	@scripts/setup sweep-search

slurm-test: build ## a sweep on a Slurm of one node, started on the loopback device
	@scripts/setup slurm-test
	@PHOTONLOOM=build/photonloom tests/slurm/one_node.sh

report-bundle: ## report/bundle from report/page
	@scripts/setup report-bundle
	@cd report && npm ci --ignore-scripts --no-audit --no-fund --silent && node build.mjs

area-check: build ## whether the units grew since fpga/baseline.json
	@scripts/setup area-check
	@scripts/area-check

format: ## clang-format on every C++ file
	@scripts/setup format
	@git ls-files '*.cpp' '*.hpp' | xargs clang-format -i

clean: ## remove what was built
	@rm -rf build build-*
