# SPDX-License-Identifier: MIT
# Read by the scratch build of tests/mutation/run.py, after `project`: a mutant should cost one small compilation.
function(crofton_mutation_settings)
    get_property(modules GLOBAL PROPERTY CROFTON_MODULES)
    list(TRANSFORM modules PREPEND crofton_)
    foreach(target IN LISTS modules ITEMS crofton_study crofton_render)
        if(TARGET ${target})
            set_target_properties(${target} PROPERTIES UNITY_BUILD OFF)
            target_compile_options(${target} PRIVATE -O1)
        endif()
    endforeach()
endfunction()
cmake_language(DEFER CALL crofton_mutation_settings)
