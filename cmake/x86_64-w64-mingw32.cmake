# SPDX-License-Identifier: MIT
# Cross compiling for 64-bit Windows by MinGW on Debian, its tests run by Wine (docs/testing.md says what to install).
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(CMAKE_C_COMPILER x86_64-w64-mingw32-gcc-posix)
set(CMAKE_CXX_COMPILER x86_64-w64-mingw32-g++-posix)
set(CMAKE_RC_COMPILER x86_64-w64-mingw32-windres)
# No DLLs of the compiler beside each program. GCC leaves the stack of 64-bit Windows aligned to 16 bytes (GCC bug 54412),
# so instruction sets of wider vectors are left out.
set(CMAKE_EXE_LINKER_FLAGS_INIT "-static")
find_program(CROFTON_WINE NAMES wine64 wine)
set(CMAKE_CROSSCOMPILING_EMULATOR ${CROFTON_WINE})
