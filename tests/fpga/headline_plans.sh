#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# usage: headline_plans.sh THROUGHPUT FOLDER: the plans in FOLDER are those that the throughput bench of the cluster writes.
set -eu
made=$(mktemp -d) && trap 'rm -rf "$made"' EXIT
"$1" --write-plans "$made"
diff -r "$2" "$made" || { echo "refresh with: $1 --write-plans $2"; exit 1; }
