// SPDX-License-Identifier: MIT
// The sub-commands of `crofton`: each function adds one, its options and what it does.
#pragma once
#include "command_line.hpp"

namespace crofton::cli {

void add_fit_command(CommandLine& line);
void add_bake_command(CommandLine& line);
void add_collide_command(CommandLine& line);
void add_frames_command(CommandLine& line);
void add_hierarchy_command(CommandLine& line);
void add_lines_command(CommandLine& line);
void add_measure_command(CommandLine& line);
void add_merge_command(CommandLine& line);
void add_pvs_command(CommandLine& line);
void add_radiosity_command(CommandLine& line);
void add_triangulate_command(CommandLine& line);
void add_verify_command(CommandLine& line);
void add_view_command(CommandLine& line);  // where GLFW and Dear ImGui are installed

}  // namespace crofton::cli
