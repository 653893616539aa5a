# SPDX-License-Identifier: MIT
# WebAssembly without SIMD.
set(wasm_flags -DHWY_COMPILE_ONLY_SCALAR)
include(${CMAKE_CURRENT_LIST_DIR}/emscripten.cmake)
