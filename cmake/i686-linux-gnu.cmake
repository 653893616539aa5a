# SPDX-License-Identifier: MIT
# 32-bit x86 by the machine's own g++ (docs/testing.md says what to install).
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR i686)
# The headers of <asm/…> are the same; only the package g++-multilib, which no cross compiler can stand beside, links them.
set(CMAKE_C_FLAGS_INIT "-m32 -idirafter /usr/include/x86_64-linux-gnu")
set(CMAKE_CXX_FLAGS_INIT "-m32 -idirafter /usr/include/x86_64-linux-gnu")
set(CMAKE_CROSSCOMPILING_EMULATOR env)
