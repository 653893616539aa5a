# SPDX-License-Identifier: MIT
# The target `docs`, where doxygen is installed: reference of the headers that are installed.
find_package(Doxygen QUIET)
if(NOT DOXYGEN_FOUND)
    return()
endif()
file(GLOB reference_dirs ${PROJECT_SOURCE_DIR}/engine/*/*/include ${PROJECT_SOURCE_DIR}/engine/c_api/include ${PROJECT_SOURCE_DIR}/engine/render/include)
list(JOIN reference_dirs " " CROFTON_REFERENCE_DIRS)
configure_file(${CMAKE_CURRENT_LIST_DIR}/Doxyfile.in ${PROJECT_BINARY_DIR}/Doxyfile @ONLY)
add_custom_target(docs
    COMMAND ${DOXYGEN_EXECUTABLE} ${PROJECT_BINARY_DIR}/Doxyfile
    COMMENT "Reference of the public headers: ${PROJECT_BINARY_DIR}/reference/index.html" VERBATIM)
