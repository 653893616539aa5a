// SPDX-License-Identifier: MIT
// The user interface: what one can read and switch.
#pragma once
#include <imgui.h>

#include <crofton/render/device.hpp>
#include <crofton/scene/scene.hpp>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "camera_controller.hpp"
#include "depth_picture.hpp"
#include "frame_history.hpp"
#include "instance_coloring.hpp"
#include "loaded_scene.hpp"
#include "overlay.hpp"
#include "picking.hpp"
#include "settings.hpp"

namespace crofton::viewer {

// Children of each node, for the tree panel.
class NodeTree {
  public:
    void rebuild(const scene::Scene& scene);
    [[nodiscard]] std::span<const scene::NodeId> children(scene::NodeId parent) const;  // kNone: the roots
    [[nodiscard]] std::span<const scene::InstanceId> instances(scene::NodeId node) const;

  private:
    std::vector<std::uint32_t> child_begin_, instance_begin_;
    std::vector<scene::NodeId> children_;
    std::vector<scene::InstanceId> instances_;
};

// A message in the window, until the session is so many seconds old.
struct Notice {
    std::string text;
    bool bad = false;
    double until = 0.0;
};

// Data that panels show and may change.
struct PanelInput {
    Settings& settings;
    CameraController& eye;
    const LoadedScene& loaded;
    const NodeTree& nodes;
    const pipeline::FrameStatistics& frame;
    const pipeline::FrameStatistics* drawn;  // the last frame that the device has counted, or null
    const pipeline::FrameStatistics* seen;   // the last frame that says what is seen, or null
    const pipeline::FrameStatistics* other;  // of the comparison's B, or null
    const FrameHistory& frame_history;
    const InstanceColoring& instance_coloring;
    const ClusterColoring& cluster_coloring;
    const Overlay& overlay;
    std::span<const Cascade> cascades;
    std::optional<Pick> pick;
    scene::InstanceId selected;
    std::span<const scene::NodeId> hiders;  // that hide the selected instance
    const Occlusion* other_occlusion;       // of the comparison's B, or null
    ImTextureID inset;                      // null: none
    ImVec2 inset_size;
    ImTextureID depth;  // null: none
    const DepthPicture& depth_picture;
    const render::Device& device;
    bool recording, replaying;
    const std::deque<Notice>& notices;
    bool relayout;             // the window or the texts have another size: every panel goes back to its place
    std::optional<bool> fold;  // where that leaves no room for a picture beside the panels, or room again
};

// The user's requests by buttons, and the places of the panels.
struct PanelWish {
    struct Area {
        float left, top, right, bottom;
    };
    std::vector<Area> covered;
    bool frame_all = false, record = false, replay = false, export_files = false, screenshot = false, step = false;
    std::optional<scene::InstanceId> select;
};

// Sizes and fonts for a display of this scale; the font's texture must be made anew.
void apply_style(float scale);
// True where panels side by side would leave nothing of the picture.
[[nodiscard]] bool is_narrow(const ImVec2& display);
[[nodiscard]] float main_panel_width();
[[nodiscard]] float font_pixels(float scale);
// Returns the largest width of each of two pictures, side by side, beside the main panel. `display` and `font` are in
// pixels.
[[nodiscard]] float half_beside_main_panel(float display, float font);
[[nodiscard]] PanelWish draw_panels(const PanelInput& input);

// Parts of draw_panels(), each in a file of its own.
void help_panel(Settings& settings, PanelWish& wish);           // the list of keys
void notices_panel(const std::deque<Notice>& notices);          // messages that come and go
void scene_panel(const PanelInput& input, PanelWish& wish);     // the scene graph, and the picked instance
void switches_panel(const PanelInput& input, PanelWish& wish);  // all switches, each with its key
void depth_panel(const PanelInput& input, PanelWish& wish);     // the occluders' depth buffer

}  // namespace crofton::viewer
