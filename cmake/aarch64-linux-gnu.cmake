# SPDX-License-Identifier: MIT
# 64-bit ARM.
set(processor aarch64)
include(${CMAKE_CURRENT_LIST_DIR}/linux-gnu.cmake)
