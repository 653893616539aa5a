#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What a build from nothing costs, in minutes of processor time (user and system), without a compiler cache:
#   bench/build_time.sh [PRESET] [cmake options …]     for example bench/build_time.sh release -DCROFTON_SIMD_TARGETS=AVX2
# First what samples/run.sh builds, then what tests/run.sh builds on top; for each, the sums of its folders from ninja's log (seconds
# that jobs took, so more than processor time where they wait for each other). Everything must be installed: third_party/install.sh --tests.
set -euo pipefail
cd "$(dirname "$0")/.."
preset=release
if [[ $# -gt 0 && $1 != -* ]]; then preset=$1; shift; fi
unset CMAKE_CXX_COMPILER_LAUNCHER CMAKE_C_COMPILER_LAUNCHER
export CCACHE_DISABLE=1
build=$(mktemp -d "${TMPDIR:-/tmp}/crofton_build_time.XXXXXX")
trap 'rm -rf "$build"' EXIT
cmake --preset "$preset" -B "$build" -DCROFTON_TESTS=ON "$@" >"$build/configure.log" 2>&1 || { tail -n 30 "$build/configure.log" >&2; exit 1; }

# measure NAME TARGET: builds TARGET and prints what that took.
measure() {
    local TIMEFORMAT='%U %S %R' times lines=0
    [[ ! -f $build/.ninja_log ]] || lines=$(wc -l <"$build/.ninja_log")
    if ! times=$({ time ninja -C "$build" "$2" >"$build/build.log" 2>&1; } 2>&1); then
        tail -n 30 "$build/build.log" >&2
        exit 1
    fi
    awk -v name="$1" '{ printf "%s: %.1f minutes of processor time (%.1f user, %.1f system), %.1f minutes by the clock\n",
                        name, ($1 + $2) / 60, $1 / 60, $2 / 60, $3 / 60 }' <<<"$times"
    tail -n "+$((lines + 1))" "$build/.ninja_log" | awk -F '\t' '
        /^#/ || NF < 5 { next }
        { folder = $4; sub(/CMakeFiles\/.*/, "", folder); sub(/\/[^\/]*$/, "", folder)
          if (folder ~ /^\//) next  # by-products, named once more
          seconds[folder] += ($2 - $1) / 1000; ++jobs[folder] }
        END { for (folder in seconds) printf "  %7.1f s %4d jobs  %s\n", seconds[folder], jobs[folder], folder }' | sort -rn
}
measure "samples/run.sh" crofton_cli
measure "tests/run.sh, on top" all
