// SPDX-License-Identifier: MIT
// Where scenes come from: files of several formats, and the town we make ourselves.
#pragma once
#include <array>
#include <crofton/core/error.hpp>
#include <crofton/depth/clustered_mesh.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/scene/scene.hpp>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "assets/read_limits.hpp"

namespace crofton::assets {

struct LoadOptions {
    measure::Criterion criterion = measure::minimal_perimeter();  // for the boxes around meshes
    std::string map = {};                                         // which level of a WAD; empty: the first
    std::uint64_t seed = 1;                                       // of the town
    std::uint32_t instances = 0;  // of the town, roughly, at most 1,000,000; 0: about 3,000
    ReadLimits limits = {};       // of a file
    bool strict = false;          // a file of which anything would be left out is refused
    double unit = 0.0;            // metres that a length of 1 is; 0: as the file says
};

// A convex piece of a level's sector: a prism over three or four corners, from floor to ceiling.
struct Room {
    std::array<glm::dvec2, 4> corners{};  // (x, z), counter-clockwise seen from above; of three the last is repeated
    double floor = 0.0, ceiling = 0.0;
    std::array<bool, 4> is_wall{};  // the side from each corner to the next: opaque from floor to ceiling
    bool has_floor = true, has_ceiling = true;
};

// A scene with what one needs to visit it. +y is up, lengths are metres where the format says so.
struct SceneSource {
    std::string name;
    scene::Scene scene;
    std::vector<glm::dvec3> walk;  // a closed path at about eye height that leads where people go; may be empty
    std::vector<scene::InstanceId> movers;  // ascending: the instances that animate() moves; may be empty
    std::vector<std::string> warnings;      // what a file held that was left out, and why
    std::function<void(scene::Scene&, std::uint32_t)> motion;
    // By mesh: 1 where the colours are light already (glTF's KHR_materials_unlit). Empty: none.
    std::vector<std::uint8_t> unlit = {};
    // By mesh: 1 where faces are meant to be seen from their front only (glTF's doubleSided: false). Empty: none.
    std::vector<std::uint8_t> one_sided = {};
    // By mesh: 1 where each face has its own normal (glTF without NORMAL); else faces that meet at a small angle share
    // one. Empty: none.
    std::vector<std::uint8_t> flat = {};
    // By mesh, one radiosity per triangle: what its faces give off; nothing where a mesh is beyond the end or empty.
    std::vector<std::vector<glm::vec3>> emission = {};
    std::vector<Room> rooms = {};  // of a level
    // By mesh, where the meshes were cut when the scene was baked. Empty: not cut.
    std::vector<depth::ClusteredMesh> clusters = {};
    double unit = 1.0;  // metres that a length of 1 is; 0: neither the file nor its format says so

    // Sets the transforms of frame `frame`, at 60 frames a second; the same for the same frame. update() is the
    // caller's.
    void animate(std::uint32_t frame) {
        if (motion) motion(scene, frame);
    }
};

// "town", "room" (an interior to light), "office", "valley", "hall"; a folder of parts that make a city
// (holds_city_parts()); or a file by its extension: .glb, .gltf, .obj, .wad, and .crofton by `crofton bake`. Errors
// name the file, the item in it and the reason: missing or damaged file, unknown extension, unknown map, nothing to
// draw, beyond a limit. What is bad in a file (a node with a NaN, a primitive, face or sector that makes no sense, an
// image that cannot be read) is left out, with a warning each that names it; with `strict` the first one is an error.
// So is an extension of glTF that is not read, if it may change what is where; where the file requires such a one, it
// is refused.
[[nodiscard]] Result<SceneSource> load_scene(const std::string& source, const LoadOptions& options = {});

// Error: the path is a folder of regions or its index, which are no one scene.
[[nodiscard]] Result<void> refuse_regions(const std::string& path);

// Whether load_scene() makes it, rather than read a scene's file.
[[nodiscard]] bool is_made(const std::string& source);

[[nodiscard]] Result<SceneSource> make_town(const LoadOptions& options);
[[nodiscard]] Result<SceneSource> make_room(const LoadOptions& options);
[[nodiscard]] Result<SceneSource> make_office(const LoadOptions& options);
[[nodiscard]] Result<SceneSource> make_valley(const LoadOptions& options);
[[nodiscard]] Result<SceneSource> make_hall(const LoadOptions& options);
// A folder with a road_straight.gltf or .glb. Of each other part there may be none but for building_….
[[nodiscard]] bool holds_city_parts(const std::string& folder);
[[nodiscard]] Result<SceneSource> make_city(const std::string& folder, const LoadOptions& options);
[[nodiscard]] Result<SceneSource> load_gltf(const std::string& path, const LoadOptions& options);
[[nodiscard]] Result<SceneSource> load_obj(const std::string& path, const LoadOptions& options);
[[nodiscard]] Result<SceneSource> load_wad(const std::string& path, const LoadOptions& options);
[[nodiscard]] Result<SceneSource> load_baked(const std::string& path, const LoadOptions& options);

}  // namespace crofton::assets
