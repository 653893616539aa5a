# SPDX-License-Identifier: MIT
# What every target of ours shares, and how an engine module is declared.

# Every rounding that the source has, and no other.
function(crofton_round_as_written target)
    # Contraction off: a*b+c rounds twice on every instruction set, so filters keep their proven bounds and verdicts agree.
    # Where g++ 12 puts two statements into one vector, it forgets to round to float what becomes double again: boxes then
    # lack points. It is wrong at -O2 and at -O3; loops are right. tests/base/geometry/rounding_test.cpp sees it.
    target_compile_options(${target} PRIVATE -ffp-contract=off $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-fno-tree-slp-vectorize>)
endfunction()

# Warnings, rounding, sanitizers: for our own targets only, never for a consumer's.
# crofton_own_target(TARGET [LIGHT] [UNITY])
# LIGHT: optimised builds compile it with -O1, as its own code takes no time worth saving.
# UNITY: its sources may be compiled together: no two of them define the same name in an anonymous namespace.
# A source that must stay alone, as one with a library's implementation, says so: SKIP_UNITY_BUILD_INCLUSION.
function(crofton_own_target target)
    if("LIGHT" IN_LIST ARGN)
        target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
    endif()
    if("UNITY" IN_LIST ARGN)
        # Headers are read once for a batch, of 32 sources or fewer; equal batches keep several processors busy.
        set(count 0)
        get_target_property(sources ${target} SOURCES)
        foreach(source IN LISTS sources)
            get_source_file_property(is_included ${source} HEADER_FILE_ONLY)
            get_source_file_property(is_alone ${source} SKIP_UNITY_BUILD_INCLUSION)
            if(source MATCHES "\\.cpp$" AND NOT is_included AND NOT is_alone)
                math(EXPR count "${count} + 1")
            endif()
        endforeach()
        math(EXPR batches "(${count} - 1) / 32 + 1")
        math(EXPR size "(${count} + ${batches} - 1) / ${batches}")
        set_target_properties(${target} PROPERTIES UNITY_BUILD ${CROFTON_UNITY} UNITY_BUILD_BATCH_SIZE ${size})
        # In a batch g++ takes the sources for headers, whose classes should not use anonymous namespaces.
        target_compile_options(${target} PRIVATE $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-subobject-linkage>)
    endif()
    target_compile_features(${target} PUBLIC cxx_std_20)
    set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF C_STANDARD 11)
    crofton_round_as_written(${target})
    target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow
        $<$<COMPILE_LANGUAGE:CXX>:-Wconversion>
        # g++ 12 is wrong about the unused tail of a fixed-capacity array, and about "text" + string (GCC bug 105329).
        $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-maybe-uninitialized -Wno-restrict>
        $<$<BOOL:${CROFTON_WERROR}>:-Werror>)
    if(CROFTON_FUZZ AND CROFTON_SANITIZE)
        target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link)
    elseif(CROFTON_FUZZ AND NOT target MATCHES "^fuzz_")
        # For executions a second: edges of the engine alone are counted, comparisons are not traced, and what a fuzzer does
        # not call is not linked, so that there are few counters to look at after each execution.
        target_compile_options(${target} PRIVATE -fsanitize-coverage=inline-8bit-counters,pc-table
                                                 -ffunction-sections -fdata-sections)
    endif()
    if(CROFTON_SANITIZE)
        target_compile_options(${target} PRIVATE -fsanitize=${CROFTON_SANITIZE} -fno-omit-frame-pointer
                                                 -fno-sanitize-recover=all)
        if(CROFTON_SANITIZE MATCHES undefined)
            # The engine has no run-time type information for this check to read.
            target_compile_options(${target} PRIVATE -fno-sanitize=vptr)
        endif()
        target_link_options(${target} PUBLIC -fsanitize=${CROFTON_SANITIZE})
    endif()
endfunction()

# crofton_kernels(TARGET): compiles up to five kernels of a module together, as Highway's headers, read once for each
# instruction set, take 1.5 s of each compilation. So no two kernels of a module define the same name in HWY_NAMESPACE.
# Those that ask for AVX3_DL are apart from the others, whose instruction sets differ.
# CROFTON_KERNEL_OPTIONS are theirs: small builds optimise kernels alone for speed.
function(crofton_kernels target)
    get_target_property(sources ${target} SOURCES)
    list(FILTER sources INCLUDE REGEX "^src/.*\\.cpp$")
    foreach(source IN LISTS sources)
        file(STRINGS ${source} kernel REGEX "hwy/foreach_target.h|define HWY_WANT_AVX3_DL")
        if(kernel MATCHES "AVX3_DL")
            list(APPEND avx3_dl ${source})
        elseif(kernel)
            list(APPEND avx3 ${source})
        endif()
    endforeach()
    foreach(group avx3 avx3_dl)
        if(NOT CROFTON_UNITY)
            foreach(source IN LISTS ${group})
                crofton_kernel_source(${source})
            endforeach()
            continue()
        endif()
        list(LENGTH ${group} count)
        foreach(first RANGE 0 ${count} 5)
            if(first LESS count)
                list(SUBLIST ${group} ${first} 5 batch)
                set_source_files_properties(${batch} PROPERTIES HEADER_FILE_ONLY ON)
                list(TRANSFORM batch REPLACE "^src/(.*)" "#include \"\\1\"\n")
                string(JOIN "" batch ${batch})
                set(together ${CMAKE_CURRENT_BINARY_DIR}/kernels/${group}_${first}.cpp)
                file(CONFIGURE OUTPUT ${together} CONTENT "${batch}" @ONLY)
                target_sources(${target} PRIVATE ${together})
                crofton_kernel_source(${together})
            endif()
        endforeach()
    endforeach()
    target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/kernels)
endfunction()
function(crofton_kernel_source source)
    string(REGEX REPLACE ".*/(src|kernels)/" "" name ${CMAKE_CURRENT_SOURCE_DIR}/${source})
    set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    set_property(SOURCE ${source} APPEND PROPERTY COMPILE_OPTIONS ${CROFTON_KERNEL_OPTIONS})
    set_property(SOURCE ${source} APPEND PROPERTY COMPILE_DEFINITIONS "HWY_TARGET_INCLUDE=\"${name}\"")
endfunction()

# crofton_module(NAME cull [LIBRARY bake] DEPENDS boxtree … SOURCES src/a.cpp … [HOT src/a.cpp …] [LINK hwy] [UNITY])
# One engine module = one object library that sees its own headers and those of the modules it names, nothing else:
# an include against the direction of docs/architecture.md does not compile. LIBRARY: the library that gathers it,
# crofton where none is named. Headers in internal/ are for other modules only: they are not installed. HOT: of the
# sources, no kernels, but compiled with CROFTON_KERNEL_OPTIONS as these are.
function(crofton_module)
    cmake_parse_arguments(ARG "UNITY" "NAME;LIBRARY" "DEPENDS;SOURCES;HOT;LINK" ${ARGN})
    set(target crofton_${ARG_NAME}_objects)
    set(library crofton)
    if(ARG_LIBRARY)
        set(library ${ARG_LIBRARY})
    endif()
    crofton_check_room(${ARG_NAME} ${ARG_DEPENDS})
    add_library(${target} OBJECT ${ARG_SOURCES})
    if(ARG_UNITY)
        set(unity UNITY)
    endif()
    if("hwy::hwy" IN_LIST ARG_LINK)
        crofton_kernels(${target})
    endif()
    crofton_own_target(${target} ${unity})
    if(CROFTON_KERNEL_OPTIONS)
        set_source_files_properties(${ARG_HOT} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
        set_property(SOURCE ${ARG_HOT} APPEND PROPERTY COMPILE_OPTIONS ${CROFTON_KERNEL_OPTIONS})
    endif()
    # So that a program that is linked with -Wl,--gc-sections has only the functions that it may call.
    target_compile_options(${target} PRIVATE "$<$<NOT:$<CXX_COMPILER_ID:MSVC>>:-ffunction-sections;-fdata-sections>")
    # Exceptions serve core/recovery.hpp alone: a failed allocation unwinds to the public function, which returns an Error.
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-fno-rtti>)
    target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
                                         PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/src)
    if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/internal)
        target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/internal>)
        set_property(GLOBAL APPEND PROPERTY CROFTON_INTERNAL_DIRS ${CMAKE_CURRENT_SOURCE_DIR}/internal)
    endif()
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET default)
    target_link_libraries(${target} PUBLIC crofton_settings crofton_third_party PRIVATE ${ARG_LINK})
    foreach(dependency IN LISTS ARG_DEPENDS)
        target_link_libraries(${target} PUBLIC crofton_${dependency}_objects)
    endforeach()
    set_property(GLOBAL APPEND PROPERTY CROFTON_MODULES_OF_${library} ${ARG_NAME})
    set_property(GLOBAL APPEND PROPERTY CROFTON_LINK_OF_${library} ${ARG_LINK})
    set_property(GLOBAL APPEND PROPERTY CROFTON_INCLUDE_DIRS_OF_${library} ${CMAKE_CURRENT_SOURCE_DIR}/include)
endfunction()

# Ends with an error where a module of this folder names one of a room below its own.
function(crofton_check_room module)
    cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY ${PROJECT_SOURCE_DIR}/engine OUTPUT_VARIABLE room)
    string(REGEX REPLACE "/.*" "" room ${room})
    set_property(GLOBAL PROPERTY CROFTON_ROOM_OF_${module} ${room})
    list(FIND CROFTON_ROOMS ${room} place)
    foreach(dependency IN LISTS ARGN)
        get_property(other GLOBAL PROPERTY CROFTON_ROOM_OF_${dependency})
        list(FIND CROFTON_ROOMS "${other}" other_place)
        if(place GREATER -1 AND (NOT other OR other_place GREATER place))
            message(FATAL_ERROR "engine/${room}: `${module}` uses `${dependency}`, which is in no room above it (docs/architecture.md)")
        endif()
    endforeach()
endfunction()

# crofton_library(bake [libraries it is built on …]): gathers the modules that name it. Targets: crofton, or crofton_bake
# and the alias crofton::bake.
function(crofton_library name)
    foreach(property MODULES LINK INCLUDE_DIRS)
        get_property(${property} GLOBAL PROPERTY CROFTON_${property}_OF_${name})
    endforeach()
    list(REMOVE_DUPLICATES LINK)
    set(target crofton)
    if(NOT name STREQUAL crofton)
        set(target crofton_${name})
    endif()
    add_library(${target})
    add_library(crofton::${name} ALIAS ${target})
    foreach(module IN LISTS MODULES)
        target_sources(${target} PRIVATE $<TARGET_OBJECTS:crofton_${module}_objects>)
    endforeach()
    foreach(dir IN LISTS INCLUDE_DIRS)
        target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${dir}>)
    endforeach()
    target_include_directories(${target} PUBLIC $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
    crofton_own_target(${target})
    if(BUILD_SHARED_LIBS AND NOT APPLE AND NOT WIN32)
        target_link_options(${target} PRIVATE -Wl,--version-script=${PROJECT_SOURCE_DIR}/cmake/crofton.map)
        set_property(TARGET ${target} APPEND PROPERTY LINK_DEPENDS ${PROJECT_SOURCE_DIR}/cmake/crofton.map)
    endif()
    set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} LINKER_LANGUAGE CXX VERSION ${PROJECT_VERSION} SOVERSION 0)
    target_link_libraries(${target} PUBLIC $<BUILD_INTERFACE:crofton_settings> glm::glm ${ARGN} PRIVATE ${LINK})
    # What the headers of an installed build were compiled with.
    target_compile_definitions(${target} INTERFACE $<INSTALL_INTERFACE:$<$<NOT:$<BOOL:${CROFTON_STATISTICS}>>:CROFTON_NO_STATISTICS=1>>)
endfunction()
