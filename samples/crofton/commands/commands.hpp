// SPDX-License-Identifier: MIT
// The sub-commands of `crofton`: each function adds one, its options and what it does.
#pragma once
#include "command_line.hpp"

namespace crofton::cli {

void add_factors_command(CommandLine& line);
void add_fit_command(CommandLine& line);
void add_bake_command(CommandLine& line);
void add_collide_command(CommandLine& line);
void add_frames_command(CommandLine& line);
void add_hierarchy_command(CommandLine& line);
void add_measure_command(CommandLine& line);
void add_merge_command(CommandLine& line);
void add_pvs_command(CommandLine& line);
void add_radiosity_command(CommandLine& line);
void add_triangulate_command(CommandLine& line);
void add_verify_command(CommandLine& line);
void add_view_command(CommandLine& line);  // where GLFW and Dear ImGui are installed

constexpr const char* kDescription =
    "Frustum culling, collision detection and triangle counts, chosen by integral geometry.";

// Sub-commands that the program `crofton-study` has. `crofton` lists them, and starts that program for them.
struct StudyCommand {
    const char* name;
    const char* description;
    bool in_group;  // called as `crofton study NAME`

    Command add_to(CommandLine& line) const {
        return in_group ? line.study_command(name, description) : line.command(name, description);
    }
};
inline constexpr StudyCommand kMerge{"merge", "Merge the parts of a bake that ran as shards", false};
inline constexpr StudyCommand kVerify{"verify", "Check the mathematical claims behind Crofton, one row each", false};
inline constexpr StudyCommand kMeasure{
    "measure", "Test Crofton's formula on a mesh: area, volume and curvature, exact and by lines", true};
inline constexpr StudyCommand kFactors{"factors", "Form factors by global lines, of standard pairs or of scenes", true};
inline constexpr StudyCommand kHierarchy{
    "hierarchy", "Chains of plane bounds, each the best under the ones before it, as in the paper", true};
inline constexpr StudyCommand kRadiosity{"radiosity",
                                         "Light a scene by global lines and bake the light into vertex colours", true};
inline constexpr StudyCommand kStudyCommands[] = {kMerge, kVerify, kMeasure, kFactors, kHierarchy, kRadiosity};

}  // namespace crofton::cli
