# SPDX-License-Identifier: MIT
# Cross compiling on Debian for `processor`, its tests run by qemu (docs/testing.md says what to install).
# CROFTON_CROSS_ROOT: a folder with that processor's libraries, where they are not installed beside the machine's own.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR ${processor})
set(CMAKE_LIBRARY_ARCHITECTURE ${processor}-linux-gnu)
set(CMAKE_C_COMPILER ${CMAKE_LIBRARY_ARCHITECTURE}-gcc)
set(CMAKE_CXX_COMPILER ${CMAKE_LIBRARY_ARCHITECTURE}-g++)
find_program(CROFTON_QEMU NAMES qemu-${processor}-static qemu-${processor})
set(CMAKE_CROSSCOMPILING_EMULATOR ${CROFTON_QEMU};-L;/usr/${CMAKE_LIBRARY_ARCHITECTURE})

set(CROFTON_CROSS_ROOT "" CACHE PATH "Folder with usr/lib/${CMAKE_LIBRARY_ARCHITECTURE} of that processor's packages")
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES CROFTON_CROSS_ROOT)
if(CROFTON_CROSS_ROOT)
    list(PREPEND CMAKE_PREFIX_PATH ${CROFTON_CROSS_ROOT}/usr)
    include_directories(SYSTEM ${CROFTON_CROSS_ROOT}/usr/include
                        ${CROFTON_CROSS_ROOT}/usr/include/${CMAKE_LIBRARY_ARCHITECTURE})
    set(CMAKE_EXE_LINKER_FLAGS_INIT -L${CROFTON_CROSS_ROOT}/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE})
    # qemu looks here for shared libraries.
    list(APPEND CMAKE_CROSSCOMPILING_EMULATOR -E
         LD_LIBRARY_PATH=${CROFTON_CROSS_ROOT}/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE})
endif()
