#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# usage: plan.sh THROUGHPUT PLAN: PLAN is what the throughput bench of the gatherer measures with k = 16.
set -eu
made=$(mktemp) && trap 'rm -f "$made"' EXIT
"$1" --k 16 --write-plan "$made"
diff "$2" "$made" || { echo "refresh with: $1 --k 16 --write-plan $2"; exit 1; }
