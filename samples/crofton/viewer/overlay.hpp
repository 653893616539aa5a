// SPDX-License-Identifier: MIT
// Lines drawn over the scene: bounds, frusta, contacts.
#pragma once
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/crofton.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/pvs/pvs.hpp>
#include <crofton/render/rasterizer.hpp>
#include <optional>
#include <span>
#include <vector>

#include "found_contacts.hpp"
#include "json/json.hpp"
#include "loaded_scene.hpp"
#include "near_misses.hpp"
#include "pipeline/frame_statistics.hpp"
#include "settings.hpp"

namespace crofton::viewer {

struct CellSight {
    std::uint32_t cell = pvs::kNoCell;
    pvs::CellKind kind = pvs::CellKind::unknown;
    Aabb box;
    // Objects of the whole scene, whether in view or not.
    std::uint64_t seen = 0, unseen = 0, hidden = 0;
};
[[nodiscard]] Json to_json(const CellSight& sight);

// Returns the cell of the camera that culled the frame; nothing without sets, in no cell, or in a solid one.
[[nodiscard]] std::optional<CellSight> look_up(const pvs::Pvs* pvs, const pipeline::FrameStatistics& frame);

// RGBA with red in the lowest byte, as LineVertex has it.
constexpr std::uint32_t rgba(std::uint32_t r, std::uint32_t g, std::uint32_t b, std::uint32_t a = 255) {
    return r | g << 8 | b << 16 | a << 24;
}

class LineList {
  public:
    void clear(const glm::dvec3& eye) {
        controller_ = eye;
        vertices_.clear();
    }
    void segment(const glm::dvec3& a, const glm::dvec3& b, std::uint32_t color);
    void box(const Obb& box, std::uint32_t color);
    // The box's own axes from its centre, red, green and blue.
    void axes(const Obb& box);
    // Drawn to `far` where the camera sees farther.
    void frustum(const Camera& camera, double far, std::uint32_t color);
    void cross(const glm::dvec3& at, double size, std::uint32_t color);
    [[nodiscard]] std::span<const render::LineVertex> vertices() const { return vertices_; }

  private:
    glm::dvec3 controller_{0.0};
    std::vector<render::LineVertex> vertices_;
};

// The eight corners of what a camera sees up to `far`: near face left-bottom, right-bottom, left-top, right-top, then
// far.
[[nodiscard]] std::array<glm::dvec3, 8> view_corners(const Camera& camera, double far);

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
