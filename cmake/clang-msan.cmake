# SPDX-License-Identifier: MIT
# clang's memory sanitizer: all that writes memory is compiled with it, the C++ library too (tests/platforms/run.py).
set(CMAKE_C_COMPILER clang-14)
set(CMAKE_CXX_COMPILER clang++-14)
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES CROFTON_LIBCXX)
set(CMAKE_C_FLAGS_INIT "-fsanitize=memory -fno-omit-frame-pointer -g1")
set(CMAKE_CXX_FLAGS_INIT "${CMAKE_C_FLAGS_INIT} -nostdinc++ -isystem ${CROFTON_LIBCXX}/include/c++/v1")
set(CMAKE_EXE_LINKER_FLAGS_INIT "-fsanitize=memory -stdlib=libc++ -L${CROFTON_LIBCXX}/lib -Wl,-rpath,${CROFTON_LIBCXX}/lib -lc++abi")
