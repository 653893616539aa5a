# SPDX-License-Identifier: MIT
# 64-bit RISC-V.
set(processor riscv64)
include(${CMAKE_CURRENT_LIST_DIR}/linux-gnu.cmake)
