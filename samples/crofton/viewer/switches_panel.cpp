// SPDX-License-Identifier: MIT
#include "panels.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/boxtree/structure.hpp>

#include "keys.hpp"

namespace crofton::viewer {
namespace {

// Shows the key of the last widget.
void hint(const char* key) {
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s: %s", key, what_key_does(key));
}

// In a row of up to three, each as wide as the longest label wants it.
void flag(const char* label, bool& value, const char* key, int column) {
    const ImGuiStyle& style = ImGui::GetStyle();
    const float width =
        ImGui::GetFrameHeight() + 2.0f * style.ItemInnerSpacing.x + ImGui::CalcTextSize("compare (G)").x;
    if (column > 0) ImGui::SameLine(style.WindowPadding.x + static_cast<float>(column) * width);
    ImGui::Checkbox(label, &value);
    hint(key);
}

bool button(const char* label, const char* key, bool same_line) {
    if (same_line) ImGui::SameLine();
    const bool pressed = ImGui::Button(label);
    hint(key);
    return pressed;
}

template <class Enum>
void combo(const char* label, Enum& value, std::span<const Enum> choices) {
    using pipeline::to_string;
    if (!ImGui::BeginCombo(label, to_string(value))) return;
    for (const Enum choice : choices)
        if (ImGui::Selectable(to_string(choice), choice == value)) value = choice;
    ImGui::EndCombo();
}

struct MethodLabels {
    const char *bounds, *cull, *tree, *triangulation, *occlude;
};

void method(const MethodLabels& label, Method& value) {
    using enum pipeline::BoundsKind;
    static constexpr pipeline::BoundsKind kBounds[] = {sphere, aabb, obb_volume, obb_area, obb_perimeter, obb_frustum};
    static constexpr pipeline::CullMode kModes[] = {pipeline::CullMode::none, pipeline::CullMode::flat,
                                                    pipeline::CullMode::tree};
    combo(label.bounds, value.bounds, std::span<const pipeline::BoundsKind>(kBounds));
    hint("N");
    combo(label.cull, value.cull, std::span<const pipeline::CullMode>(kModes));
    hint("M");
    static constexpr boxtree::Orientation kAxes[] = {boxtree::Orientation::aligned, boxtree::Orientation::oriented,
                                                     boxtree::Orientation::automatic};
    combo(label.tree, value.tree, std::span<const boxtree::Orientation>(kAxes));
    hint("F4");
    static constexpr Triangulation kTriangulations[] = {Triangulation::loaded, Triangulation::ear,
                                                        Triangulation::delaunay, Triangulation::minimum_weight};
    combo(label.triangulation, value.triangulation, std::span<const Triangulation>(kTriangulations));
    hint("Y");
    ImGui::Checkbox(label.occlude, &value.occlude);
    hint("Z");
}

void flags(Settings& s) {
    flag("freeze (F)", s.freeze, "F", 0);
    flag("inset (I)", s.inset, "I", 1);
    flag("exact (L)", s.exact, "L", 2);
    flag("culled (O)", s.outside, "O", 0);
    flag("bounds (B)", s.bounds, "B", 1);
    flag("wires (X)", s.wireframe, "X", 2);
    flag("collide (K)", s.collisions, "K", 0);
    flag("compare (G)", s.compare, "G", 1);
    flag("hulls (U)", s.hulls, "U", 2);
    flag("help (F1)", s.help, "F1", 0);
    ImGui::SameLine();
    ImGui::Checkbox("count what is seen", &s.seen);
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("triangles that own a pixel: every thirtieth frame is drawn once more for that");
}

void sliders(const PanelInput& input) {
    Settings& s = input.settings;
    const int height = static_cast<int>(input.loaded.pipeline().world().tree().structure().height());
    ImGui::SliderInt("tree level (T)", &s.tree_level, -1, height - 1, s.tree_level < 0 ? "off" : "%d");
    hint("T");
    ImGui::SliderInt("views (V)", &s.cascades, 1, 8);
    hint("V");
    auto percent = static_cast<int>(std::lround(100.0 * s.resolution));
    if (ImGui::SliderInt("resolution", &percent, static_cast<int>(100.0 * kMinResolution), 100, "%d %%"))
        s.resolution = std::clamp(0.01 * percent, kMinResolution, 1.0);
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("of the drawn picture, each way, before it is enlarged: fewer pixels, more frames");
    auto scale = static_cast<float>(s.time_scale);
    if (ImGui::SliderFloat("time (+ -)", &scale, 0.0f, 4.0f, "%.2fx")) s.time_scale = static_cast<double>(scale);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("speed of moving objects; + and -: %s", what_key_does("+"));
}

}  // namespace

void switches_panel(const PanelInput& input, PanelWish& wish) {
    Settings& s = input.settings;
    // The longest label must fit beside its field, with or without a scroll bar.
    ImGui::PushItemWidth(-ImGui::CalcTextSize("tree level (T)").x - ImGui::GetStyle().ItemInnerSpacing.x);
    auto coloring = static_cast<int>(s.coloring);
    if (ImGui::Combo("colour (C)", &coloring, kColoringNames, static_cast<int>(std::size(kColoringNames))))
        s.coloring = static_cast<Coloring>(coloring);
    hint("C");
    static constexpr MethodLabels kOne{"bounds (N)", "cull (M)", "tree (F4)", "cut (Y)", "occlude (Z)"};
    static constexpr MethodLabels kA{"A: bounds (N)", "A: cull (M)", "A: tree (F4)", "A: cut (Y)", "A: occlude (Z)"};
    static constexpr MethodLabels kB{"B: bounds", "B: cull", "B: tree", "B: cut", "B: occlude"};
    method(s.compare ? kA : kOne, s.method);
    ImGui::SameLine();
    ImGui::Checkbox("depth buffer (J)", &s.depth_buffer);
    hint("J");
    if (s.compare) method(kB, s.other);
    flags(s);
    sliders(input);
    ImGui::PopItemWidth();
    wish.step = button("step (.)", ".", false);
    ImGui::SameLine();
    ImGui::Checkbox("pause (P)", &s.paused);
    hint("P");
    ImGui::SameLine();
    bool orbit = input.eye.mode == CameraMode::orbit;
    if (ImGui::Checkbox("orbit (Tab)", &orbit)) input.eye.mode = orbit ? CameraMode::orbit : CameraMode::fly;
    hint("Tab");
    wish.frame_all = button("frame all (Home)", "Home", false);
    wish.record = button(input.recording ? "stop (R)" : "record (R)", "R", true);
    wish.replay = button(input.replaying ? "stop (F6)" : "replay (F6)", "F6", true);
    wish.screenshot = button("picture (F2)", "F2", false);
    wish.export_files = button("export statistics (F5)", "F5", true);
}

}  // namespace crofton::viewer
