// SPDX-License-Identifier: MIT
// How much a file may ask for, as options that every sub-command which reads files has.
#pragma once
#include <crofton/core/executor.hpp>
#include <string>
#include <vector>

#include "assets/read_limits.hpp"
#include "assets/scene_source.hpp"
#include "command_line.hpp"

namespace crofton::cli {

struct ReadOptions {
    assets::ReadLimits limits;
    bool strict = false;
    double unit = 0.0;  // metres that a length of 1 is; 0: as the file says
};

// For the help of sub-commands that show scenes: what is read of files.
inline constexpr const char* kSceneFormats =
    "Files are read in their initial state, without animation (more in docs/files.md):\n"
    "  .glb, .gltf  meshes, EXT_mesh_gpu_instancing, KHR_node_visibility, morph weights, skins, quantized and\n"
    "               compressed (Draco, meshopt) geometry; other extensions give a warning or a reason to refuse\n"
    "  .obj         faces of any number of corners, concave ones and keyholes too; materials' colours\n"
    "  .wad         levels of DOOM, of Hexen and in text (UDMF)\n";

// --max-bytes, --max-triangles, --max-pixels, --max-nodes, --max-seconds and --strict. `options` must
// outlive the parsing.
void add_read_options(Command& command, ReadOptions& options);

// --unit, of sub-commands that place people's eyes.
void add_unit_option(Command& command, ReadOptions& options);

// "crofton: warning: …" to stderr, a line each; at most 20, and how many there are besides.
void print_warnings(const std::vector<std::string>& warnings);

// With --strict: the first of these warnings about what was left out, as an error.
[[nodiscard]] Result<void> refuse_if_strict(const std::string& path, const std::vector<std::string>& warnings,
                                            const ReadOptions& read);

// assets::load_scene with these options, in place of those in `load`. Prints its warnings and brings it up to date.
[[nodiscard]] Result<assets::SceneSource> load_updated_scene(const std::string& scene, const ReadOptions& read,
                                                             assets::LoadOptions load = {},
                                                             Executor& executor = serial_executor());

}  // namespace crofton::cli
