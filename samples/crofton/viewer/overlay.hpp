// SPDX-License-Identifier: MIT
// What is drawn over the scene as lines: bounds, frusta, contacts.
#pragma once
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/crofton.hpp>
#include <optional>

#include "line_list.hpp"
#include "loaded_scene.hpp"
#include "near_misses.hpp"
#include "settings.hpp"

namespace crofton::viewer {

// One view of several into which the depth range is split.
struct Cascade {
    Camera camera;
    std::uint64_t visible = 0;
    std::uint32_t color = 0;
};
// The camera's range [near, far or `reach`] in `count` parts, halfway between even and geometric spacing.
[[nodiscard]] std::vector<Cascade> split_view(const Camera& camera, int count, double reach);

// What a kind of line in the picture stands for.
struct LineMeaning {
    const char* name;
    std::uint32_t color;
    std::optional<std::uint64_t> count{};
};

class Overlay {
  public:
    // All lines that the settings ask for. `frame` is what culling said; its camera culled. `contacts` are those of the
    // scene's MeshWorld.
    void draw(LineList& lines, const Settings& settings, const LoadedScene& loaded,
              const pipeline::FrameStatistics& frame, std::span<const Contact> contacts,
              std::span<const Cascade> cascades, scene::InstanceId selected, bool show_frustum);
    // Of the lines last drawn.
    [[nodiscard]] std::span<const LineMeaning> legend() const { return legend_; }
    [[nodiscard]] std::uint64_t contact_count() const { return contacts_; }
    [[nodiscard]] std::uint64_t separation_count() const { return separations_; }

  private:
    void draw_bounds(LineList& lines, const Settings& settings, const LoadedScene& loaded,
                     const pipeline::FrameStatistics& frame);
    // The root is level 0.
    void draw_tree_level(LineList& lines, const boxtree::BoxTree& tree, int level);
    void draw_pairs(LineList& lines, const LoadedScene& loaded, const pipeline::FrameStatistics& frame);
    void draw_contacts(LineList& lines, const scene::Scene& scene, std::span<const Contact> contacts);
    void draw_separations(LineList& lines, const LoadedScene& loaded, const pipeline::FrameStatistics& frame);

    std::vector<LineMeaning> legend_;
    std::uint64_t contacts_ = 0, separations_ = 0;
};

}  // namespace crofton::viewer
