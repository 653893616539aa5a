# SPDX-License-Identifier: MIT
# Cross compiling for 64-bit ARM on Debian, its tests run by qemu (docs/testing.md says what to install).
# CROFTON_ARM64_ROOT: a folder with the arm64 libraries, where they are not installed beside the machine's own.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
find_program(CROFTON_QEMU NAMES qemu-aarch64-static qemu-aarch64)
set(CMAKE_CROSSCOMPILING_EMULATOR ${CROFTON_QEMU};-L;/usr/aarch64-linux-gnu)

set(CROFTON_ARM64_ROOT "" CACHE PATH "Folder with usr/lib/aarch64-linux-gnu of the arm64 packages")
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES CROFTON_ARM64_ROOT)
if(CROFTON_ARM64_ROOT)
    list(PREPEND CMAKE_PREFIX_PATH ${CROFTON_ARM64_ROOT}/usr)
    include_directories(SYSTEM ${CROFTON_ARM64_ROOT}/usr/include ${CROFTON_ARM64_ROOT}/usr/include/aarch64-linux-gnu)
    set(CMAKE_EXE_LINKER_FLAGS_INIT -L${CROFTON_ARM64_ROOT}/usr/lib/aarch64-linux-gnu)
    # qemu looks here for shared libraries.
    list(APPEND CMAKE_CROSSCOMPILING_EMULATOR -E LD_LIBRARY_PATH=${CROFTON_ARM64_ROOT}/usr/lib/aarch64-linux-gnu)
endif()
