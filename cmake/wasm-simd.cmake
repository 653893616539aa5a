# SPDX-License-Identifier: MIT
# WebAssembly with SIMD.
set(wasm_flags -msimd128)
include(${CMAKE_CURRENT_LIST_DIR}/emscripten.cmake)
