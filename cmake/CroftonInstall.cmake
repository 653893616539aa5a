# cmake --install: headers, libraries and the package that find_package(crofton) reads.
include(CMakePackageConfigHelpers)

get_property(include_dirs GLOBAL PROPERTY CROFTON_INCLUDE_DIRS)
foreach(dir IN LISTS include_dirs)
    install(DIRECTORY ${dir}/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
endforeach()
install(FILES LICENSE README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR} OPTIONAL)
