#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Times culling of 100,000 boxes, 20 views, natively and in WebAssembly, one after the other. Needs both builds:
#   cmake --preset release && cmake --build --preset release --target crofton; bindings/web/test.sh
set -euo pipefail
cd "$(dirname "$0")/../.."
includes=()
for folder in $(find engine -name include -o -name internal); do includes+=("-I$folder"); done
g++ -std=c++20 -O2 "${includes[@]}" bindings/web/native/digests.cpp build/release/engine/libcrofton.a -lqhull_r -lhwy -lpthread -o build/web/digests
for repeat in 1 2 3; do
    for set in all AVX2 SSE4; do echo "$set:   $(build/web/digests bench $set build/web/questions)"; done
    for build in simd plain; do echo "$build:   $(node bindings/web/bench.js build/web/questions $build)"; done
done
