# SPDX-License-Identifier: MIT
# 32-bit x86 by Debian's cross compiler (docs/testing.md says what to install); the tests run on this machine.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR i686)
set(CMAKE_C_COMPILER i686-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER i686-linux-gnu-g++)
# Static: a machine of 64 bits has no loader for 32-bit programs.
set(CMAKE_EXE_LINKER_FLAGS_INIT "-static")
set(CMAKE_CROSSCOMPILING_EMULATOR env)
