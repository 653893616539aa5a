// SPDX-License-Identifier: MIT
// `crofton-study`: the sub-commands for those who study the paper, which `crofton` starts when they are asked for.
#include <crofton/core/version.hpp>

#include "commands.hpp"

int main(int argc, char** argv) {
    using namespace crofton::cli;
    CommandLine line(kDescription, crofton::version_string());
    add_merge_command(line);
    add_verify_command(line);
    add_measure_command(line);
    add_factors_command(line);
    add_hierarchy_command(line);
    add_radiosity_command(line);
    return line.run(argc, argv);
}
