// SPDX-License-Identifier: MIT
// Everything that can be switched while the viewer runs, by panel, key or script.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/cull/classify.hpp>
#include <string>

#include "json/json.hpp"
#include "pipeline/bounds.hpp"
#include "pipeline/pipeline.hpp"

namespace crofton::viewer {

enum class Coloring : std::uint8_t {
    lit,
    verdict,
    improper,
    occlusion,
    visible_set,
    clusters,
    collision,
    depth,
    shape,
    regions
};
inline constexpr const char* kColoringNames[] = {"lit",      "verdict",   "improper", "occlusion", "visible-set",
                                                 "clusters", "collision", "depth",    "shape",     "regions"};

// How polygons and the planar patches of meshes are cut into triangles; `loaded`: as the scene came.
enum class Triangulation : std::uint8_t { loaded, ear, delaunay, minimum_weight };
inline constexpr const char* kTriangulationNames[] = {"loaded", "ear", "delaunay", "minimum-weight"};

// The settings that a frame's work depends on; two of these can be compared side by side.
struct Method {
    pipeline::BoundsKind bounds = pipeline::BoundsKind::obb_perimeter;
    pipeline::CullMode cull = pipeline::CullMode::tree;
    boxtree::Orientation tree = boxtree::Orientation::aligned;  // of the tree's inner bounds
    Triangulation triangulation = Triangulation::loaded;
    bool occlude = false;  // what is hidden behind other things is not visible
    bool operator==(const Method&) const = default;
};

[[nodiscard]] inline const char* to_string(Coloring coloring) {
    return kColoringNames[static_cast<std::size_t>(coloring)];
}
[[nodiscard]] inline const char* to_string(Triangulation triangulation) {
    return kTriangulationNames[static_cast<std::size_t>(triangulation)];
}

inline constexpr double kMinResolution = 0.25;

struct Settings {
    Method method;
    Method other;  // B of the comparison
    bool compare = false;
    Coloring coloring = Coloring::lit;
    bool exact = true;  // exact second stage; false: planes only
    bool collisions = true;
    bool freeze = false;        // culling keeps its camera
    bool inset = false;         // a second view, from outside
    bool outside = false;       // what is culled, as wire boxes
    bool bounds = false;        // the visible instances' bounds
    bool hulls = false;         // their convex hulls, and where those of movers touch
    bool depth_buffer = false;  // of the occluders, as a picture
    int tree_level = -1;        // bounds of the tree's nodes at this depth; −1: none
    bool wireframe = false;
    bool seen = true;  // twice a second count the triangles that own a pixel, by drawing once more
    int cascades = 1;  // views: the camera's depth range split into so many
    bool panels = true;
    bool help = false;                   // the list of keys
    bool more = false, history = false;  // the panel's lower parts, unfolded
    bool paused = false;
    double time_scale = 1.0;
    double resolution = 1.0;  // share of the picture's pixels each way that is drawn; the rest is enlarged
};

// One switch by its name, as scripts name it: "coloring", "bounds_kind", "cull", "tree", "triangulation", "occlude",
// "other_bounds_kind", …, "exact", "freeze", … Errors: an unknown name or a value of the wrong kind or
// range; nothing is changed then.
[[nodiscard]] Result<void> set_switch(Settings& settings, const std::string& name, const Json& value);
[[nodiscard]] Json to_json(const Settings& settings);

}  // namespace crofton::viewer
