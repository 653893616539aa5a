// SPDX-License-Identifier: MIT
// Lines drawn over the scene: bounds, frusta, contacts.
#pragma once
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/crofton.hpp>
#include <optional>

#include "found_contacts.hpp"
#include "line_list.hpp"
#include "loaded_scene.hpp"
#include "near_misses.hpp"
#include "settings.hpp"
#include "visible_set.hpp"

namespace crofton::viewer {

// One view of several into which the depth range is split.
struct Cascade {
    Camera camera;
    std::uint64_t visible = 0;
    std::uint32_t color = 0;
};
// The camera's range [near, far or `range`] in `count` parts, halfway between even and geometric spacing.
[[nodiscard]] std::vector<Cascade> split_view(const Camera& camera, int count, double range);

// The meaning of a kind of line.
struct LineMeaning {
    const char* name;
    std::uint32_t color;
    std::optional<std::uint64_t> count{};
};

class Overlay {
  public:
    // All lines that the settings ask for but those below. `frame` is what culling said; its camera culled.
    void draw(LineList& lines, const Settings& settings, const LoadedScene& loaded,
              const pipeline::FrameStatistics& frame, const FoundContacts& contacts, std::span<const Cascade> cascades,
              scene::InstanceId selected, bool show_frustum);
    // After draw(). Hulls of the visible instances, the nearest kMaxHulls, and where the hulls of pairs touch.
    void draw_hulls(LineList& lines, InstanceShapes& shapes, const scene::Scene& scene,
                    const pipeline::FrameStatistics& frame, std::span<const HullContacts> contacts);
    // Likewise: the cell in which the eye is.
    void draw_cell(LineList& lines, const CellSight& sight);
    // Returns the meanings of the lines last drawn.
    [[nodiscard]] std::span<const LineMeaning> legend() const { return legend_; }
    [[nodiscard]] std::uint64_t contact_count() const { return contacts_; }
    [[nodiscard]] std::uint64_t separation_count() const { return separations_; }
    [[nodiscard]] std::uint64_t hull_count() const { return hulls_; }
    [[nodiscard]] std::uint64_t manifold_point_count() const { return manifold_points_; }

  private:
    void draw_bounds(LineList& lines, const Settings& settings, const LoadedScene& loaded,
                     const pipeline::FrameStatistics& frame);
    // Boxes of regions: attached, coming, away.
    void draw_regions(LineList& lines, const pipeline::RegionStream& stream);
    // The root is level 0.
    void draw_tree_level(LineList& lines, const boxtree::BoxTree& tree, int level);
    void draw_pairs(LineList& lines, const LoadedScene& loaded, const pipeline::FrameStatistics& frame);
    void draw_contacts(LineList& lines, const scene::Scene& scene, std::span<const TriangleContacts> contacts);
    void draw_separations(LineList& lines, const LoadedScene& loaded, const pipeline::FrameStatistics& frame);

    std::vector<LineMeaning> legend_;
    std::uint64_t contacts_ = 0, separations_ = 0, hulls_ = 0, manifold_points_ = 0;
};

}  // namespace crofton::viewer
