# SPDX-License-Identifier: MIT
# Programs built with nothing but a compiler and pkg-config: PREFIX, LIBDIR, C_COMPILER, CXX_COMPILER, SOURCES, OUTPUT.
set(ENV{PKG_CONFIG_PATH} ${PREFIX}/${LIBDIR}/pkgconfig)
function(build_and_run package command)
    foreach(ask "--cflags;--libs" "--cflags;--libs;--static")
        execute_process(COMMAND pkg-config ${ask} ${package} OUTPUT_VARIABLE flags COMMAND_ERROR_IS_FATAL ANY)
        separate_arguments(flags UNIX_COMMAND "${flags}")
        execute_process(COMMAND ${command} ${ARGN} ${flags} -o ${OUTPUT} COMMAND_ERROR_IS_FATAL ANY)
        execute_process(COMMAND ${CMAKE_COMMAND} -E env LD_LIBRARY_PATH=${PREFIX}/${LIBDIR} ${OUTPUT} COMMAND_ERROR_IS_FATAL ANY)
    endforeach()
endfunction()
build_and_run(crofton ${C_COMPILER} -std=c11 -Wall -Wextra -Wpedantic -Werror ${SOURCES}/main.c)
build_and_run(crofton-cxx ${CXX_COMPILER} -Wall -Wextra -Werror ${SOURCES}/main.cpp)  # no -std: the package says which
foreach(package crofton crofton-cxx)
    execute_process(COMMAND pkg-config --modversion ${package} OUTPUT_VARIABLE version OUTPUT_STRIP_TRAILING_WHITESPACE
                    COMMAND_ERROR_IS_FATAL ANY)
    if(NOT version STREQUAL VERSION)
        message(FATAL_ERROR "pkg-config says ${package} ${version}, not ${VERSION}")
    endif()
endforeach()
