# SPDX-License-Identifier: MIT
# WebAssembly by Emscripten, its tests run by node (docs/testing.md says what to install). `wasm_flags`: of both languages.
find_file(CROFTON_EMSCRIPTEN Emscripten.cmake NO_DEFAULT_PATH REQUIRED
          PATHS $ENV{EMSDK}/upstream/emscripten/cmake/Modules/Platform /usr/share/emscripten/cmake/Modules/Platform)
set(EMSCRIPTEN_SYSTEM_PROCESSOR wasm32)
set(CMAKE_CROSSCOMPILING_EMULATOR node;--no-experimental-fetch)
# Exceptions are off unless asked for, and Debian 12's Emscripten has no std::bit_cast in its library.
set(CMAKE_C_FLAGS_INIT "-pthread -fexceptions ${wasm_flags}")
set(CMAKE_CXX_FLAGS_INIT "${CMAKE_C_FLAGS_INIT} -include ${CMAKE_CURRENT_LIST_DIR}/../bindings/web/native/missing.hpp")
# A pool of threads must exist before the program waits for one.
set(CMAKE_EXE_LINKER_FLAGS_INIT
    "-pthread -fexceptions -sPTHREAD_POOL_SIZE=12 -sINITIAL_MEMORY=1073741824 -sEXIT_RUNTIME=1 -sTOTAL_STACK=4194304")
include(${CROFTON_EMSCRIPTEN})
