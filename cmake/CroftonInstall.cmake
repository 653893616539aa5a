# SPDX-License-Identifier: MIT
# cmake --install: headers, libraries, and the packages that find_package(crofton) and pkg-config read.
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/crofton)
get_property(include_dirs GLOBAL PROPERTY CROFTON_INCLUDE_DIRS_OF_crofton)
foreach(dir IN LISTS include_dirs)
    install(DIRECTORY ${dir}/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
endforeach()
install(TARGETS crofton EXPORT crofton-targets)
install(EXPORT crofton-targets NAMESPACE crofton:: DESTINATION ${package_dir})
# Each with headers of its own: `cmake --install` takes all, with `--component Unspecified` the library alone.
foreach(component bake study render)
    if(TARGET crofton_${component})
        get_property(include_dirs GLOBAL PROPERTY CROFTON_INCLUDE_DIRS_OF_${component})
        list(REMOVE_DUPLICATES include_dirs)
        foreach(dir IN LISTS include_dirs)
            if(EXISTS ${dir})
                install(DIRECTORY ${dir}/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT ${component})
            endif()
        endforeach()
        install(TARGETS crofton_${component} EXPORT crofton-${component}-targets
                ARCHIVE COMPONENT ${component} LIBRARY COMPONENT ${component} RUNTIME COMPONENT ${component})
        install(EXPORT crofton-${component}-targets NAMESPACE crofton:: DESTINATION ${package_dir} COMPONENT ${component})
    endif()
endforeach()
if(TARGET crofton_cli)
    install(TARGETS crofton_cli crofton_study_cli COMPONENT tools)
    install(FILES ${PROJECT_BINARY_DIR}/completion/crofton.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
            RENAME crofton COMPONENT tools)
    install(FILES ${PROJECT_BINARY_DIR}/completion/_crofton DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions COMPONENT tools)
    install(FILES ${PROJECT_BINARY_DIR}/completion/crofton.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT tools)
    # The manual pages are the texts of --help: made when they are installed.
    find_program(CROFTON_HELP2MAN help2man)
    if(CROFTON_HELP2MAN AND NOT CMAKE_CROSSCOMPILING)
        install(CODE "execute_process(
            COMMAND ${CMAKE_COMMAND} -E env \"LD_LIBRARY_PATH=$<TARGET_FILE_DIR:crofton>:$ENV{LD_LIBRARY_PATH}\"
                    ${PROJECT_SOURCE_DIR}/packaging/manual_pages.sh $<TARGET_FILE:crofton_cli>
                    \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_MANDIR}/man1\"
            COMMAND_ERROR_IS_FATAL ANY)" COMPONENT tools)
    else()
        message(STATUS "No manual pages are installed: help2man is not here")
    endif()
endif()

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/crofton-config.cmake.in ${PROJECT_BINARY_DIR}/crofton-config.cmake
    INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/crofton-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/crofton-config.cmake ${PROJECT_BINARY_DIR}/crofton-config-version.cmake
        DESTINATION ${package_dir})
# What the library itself needs, everybody needs who links with an archive. A shared one brings it, so that the packages
# need not be there: pkg-config looks for Requires.private as well.
set(pc_libs "")
set(pc_requires "")
if(NOT BUILD_SHARED_LIBS)
    set(pc_libs " -lstdc++ -lm -pthread")
    if(CROFTON_NEEDS_LIBATOMIC)
        string(APPEND pc_libs " -latomic")
    endif()
    get_target_property(pc_qhull Qhull::qhull_r ALIASED_TARGET)  # qhullstatic_r, where only that is installed
    string(REGEX REPLACE "^(Qhull::|.*NOTFOUND$)" "" pc_qhull "${pc_qhull}")
    if(NOT pc_qhull)
        set(pc_qhull qhull_r)
    endif()
    set(pc_requires "\nRequires: libhwy ${pc_qhull}")
endif()
file(RELATIVE_PATH pc_to_prefix /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
configure_file(${CMAKE_CURRENT_LIST_DIR}/crofton.pc.in ${PROJECT_BINARY_DIR}/crofton.pc @ONLY)
# What C++ needs besides, -std=c++20, would be an error in C.
configure_file(${CMAKE_CURRENT_LIST_DIR}/crofton-cxx.pc.in ${PROJECT_BINARY_DIR}/crofton-cxx.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/crofton.pc ${PROJECT_BINARY_DIR}/crofton-cxx.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
configure_file(${CMAKE_CURRENT_LIST_DIR}/crofton-bake.pc.in ${PROJECT_BINARY_DIR}/crofton-bake.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/crofton-bake.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT bake)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md
              ${PROJECT_SOURCE_DIR}/CONTRIBUTING.md ${PROJECT_SOURCE_DIR}/SECURITY.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES ${PROJECT_SOURCE_DIR}/engine/crofton.natvis ${PROJECT_SOURCE_DIR}/engine/crofton_gdb.py DESTINATION ${CMAKE_INSTALL_DATADIR}/crofton)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs DESTINATION ${CMAKE_INSTALL_DOCDIR})  # where the README's links lead
