# SPDX-License-Identifier: MIT
# Cross compiling for 64-bit RISC-V on Debian, its tests run by qemu (docs/testing.md says what to install).
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR riscv64)
set(CMAKE_C_COMPILER riscv64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER riscv64-linux-gnu-g++)
set(CMAKE_LIBRARY_ARCHITECTURE riscv64-linux-gnu)
find_program(CROFTON_QEMU NAMES qemu-riscv64-static qemu-riscv64)
set(CMAKE_CROSSCOMPILING_EMULATOR ${CROFTON_QEMU};-L;/usr/riscv64-linux-gnu)
