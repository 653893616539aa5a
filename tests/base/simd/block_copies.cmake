# SPDX-License-Identifier: MIT
# Fails if a function that is compiled per instruction set (namespace N_AVX2, N_SSE4 …) contains `rep movs`.
if(NOT OBJDUMP)
    message(STATUS "skipped: objdump is not installed")
    return()
endif()
if(NOT PROCESSOR MATCHES "x86_64|AMD64|i.86")
    message(STATUS "skipped: ${PROCESSOR} has no such instruction")
    return()
endif()
if(NOT BUILD_TYPE MATCHES "Release|RelWithDebInfo" OR SANITIZE)
    message(STATUS "skipped: only an optimised build without sanitizers says what users run")
    return()
endif()
execute_process(COMMAND ${OBJDUMP} --disassemble --no-show-raw-insn ${LIBRARY}
                COMMAND grep -E "^[0-9a-f]+ <|rep movs"
                COMMAND grep -B 1 "rep movs"
                COMMAND grep -E "^[0-9a-f]+ <.*N_(SSSE3|SSE4|AVX2|AVX3|AVX3_DL|AVX3_ZEN4|SCALAR|EMU128)"
                OUTPUT_VARIABLE found)
if(found)
    message(FATAL_ERROR "These kernels copy blocks of memory:\n${found}")
endif()
