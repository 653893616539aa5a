// SPDX-License-Identifier: MIT
#include "panels.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <string>
#include <utility>

#include "shape_colors.hpp"
#include "statistics_panel.hpp"

namespace crofton::viewer {
namespace {

constexpr float kFontPixels = 13.0f;  // what Dear ImGui's own font is made for
constexpr float kMargin = 8.0f;
constexpr float kPadding = 8.0f;  // Dear ImGui's own, inside a window

float width_of_main_panel(float display, float font) {
    return std::min(27.0f * font, 0.52f * display);
}

ImVec4 display_color(const glm::vec3& linear) {
    return {std::sqrt(linear.r), std::sqrt(linear.g), std::sqrt(linear.b), 1.0f};
}
ImVec4 display_color(std::uint32_t rgba) {
    return ImGui::ColorConvertU32ToFloat4(rgba);
}

// A sample of a colour at the line's beginning; `height` of a line of text.
void sample(const ImVec4& color, float height) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float font = ImGui::GetFontSize();
    const float top = at.y + 0.5f * (1.0f - height) * font;
    ImGui::GetWindowDrawList()->AddRectFilled(ImVec2(at.x, top), ImVec2(at.x + font, top + height * font),
                                              ImGui::GetColorU32(color));
    ImGui::Dummy(ImVec2(font, font));
    ImGui::SameLine();
}

// From slivers to equilateral triangles, as color_by_shape() has them.
void shape_legend() {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float width = ImGui::GetContentRegionAvail().x, height = ImGui::GetFontSize();
    constexpr int kSteps = 32;
    for (int i = 0; i < kSteps; ++i) {
        const float left = width * static_cast<float>(i) / kSteps, right = width * static_cast<float>(i + 1) / kSteps;
        ImGui::GetWindowDrawList()->AddRectFilled(
            ImVec2(at.x + left, at.y), ImVec2(at.x + right, at.y + height),
            ImGui::GetColorU32(display_color(shape_color((static_cast<float>(i) + 0.5f) / kSteps))));
    }
    ImGui::Dummy(ImVec2(width, height));
    ImGui::TextUnformatted("0: sliver");
    ImGui::SameLine(ImGui::GetCursorPosX() + width - ImGui::CalcTextSize("equilateral: 1").x);
    ImGui::TextUnformatted("equilateral: 1");
}

void visible_set_hint(const PanelInput& input) {
    if (input.loaded.regions()) return ImGui::TextWrapped("sets of regions: 'crofton pvs' on their folder");
    if (input.loaded.pvs() == nullptr)
        ImGui::TextWrapped("no visible sets: bake them with 'crofton pvs', and show them with --baked FILE");
    else if (input.loaded.pvs()->find_cell(input.frame.camera.position) == pvs::kNoCell)
        ImGui::TextWrapped("no cell holds the eye: everything is drawn from here");
}

void legend(const PanelInput& input) {
    for (const InstanceColoring::Count& tint : input.instance_coloring.counts()) {
        if (tint.instances == 0 &&
            (input.settings.coloring == Coloring::depth || input.settings.coloring == Coloring::regions))
            continue;
        sample(display_color(tint.color), 1.0f);
        ImGui::Text("%s: %s", tint.name, with_thousands(tint.instances).c_str());
    }
    if (input.settings.coloring == Coloring::clusters) {
        for (const ClusterColoring::Count& fate : input.cluster_coloring.counts()) {
            sample(display_color(fate.color), 1.0f);
            ImGui::Text("%s: %s (%s)", fate.name, with_thousands(fate.clusters).c_str(),
                        with_thousands(fate.triangles).c_str());
        }
        ImGui::TextDisabled("clusters (triangles)");
    }
    for (const LineMeaning& line : input.overlay.legend()) {
        sample(display_color(line.color), 0.2f);
        if (line.count)
            ImGui::Text("%s: %s", line.name, with_thousands(*line.count).c_str());
        else
            ImGui::TextUnformatted(line.name);
    }
    if (input.cascades.size() > 1)
        for (std::size_t i = 0; i < input.cascades.size(); ++i) {
            const Cascade& cascade = input.cascades[i];
            sample(display_color(cascade.color), 0.2f);
            ImGui::Text("view %zu: %.1f to %.1f m, %s visible", i + 1, cascade.camera.near_distance,
                        cascade.camera.far_distance, with_thousands(cascade.visible).c_str());
        }
    if (input.settings.coloring == Coloring::shape) shape_legend();
    if (input.settings.coloring == Coloring::visible_set) visible_set_hint(input);
}

// What streaming costs.
void hitches(const PanelInput& input) {
    if (!input.frame.regions) return;
    const auto plot =
        input.frame_history.history([](const HistoryEntry& e) { return 1e-3 * (e.frame.update_us + e.frame.cull_us); });
    const double worst = plot.empty() ? 0.0 : static_cast<double>(*std::max_element(plot.begin(), plot.end()));
    ImGui::Text("update and cull: worst of %zu frames %.2f ms", plot.size(), worst);
    ImGui::PlotLines("ms", plot.data(), static_cast<int>(plot.size()), 0, nullptr, 0.0f, FLT_MAX,
                     ImVec2(0.0f, 3.0f * ImGui::GetFontSize()));
}

void heading(const PanelInput& input) {
    const double ms = input.frame_history.mean([](const HistoryEntry& e) { return e.frame_us * 1e-3; }, 30);
    ImGui::Text("%s: %.1f frames/s", input.loaded.source().name.c_str(), ms > 0.0 ? 1000.0 / ms : 0.0);
    ImGui::TextDisabled("%s", input.device.name().c_str());
    const glm::dvec3& eye = input.eye.camera.position;
    ImGui::Text("eye %.1f %.1f %.1f m, %s %.3g m/s", eye.x, eye.y, eye.z,
                input.eye.mode == CameraMode::orbit ? "in orbit," : "flying at", input.eye.speed);
    // One line, always there: nothing below it jumps.
    std::string state;
    for (const auto& [is, name] : {std::pair<bool, const char*>{input.settings.freeze, "FROZEN"},
                                   {input.recording, "recording"},
                                   {input.replaying, "replaying"},
                                   {input.settings.paused, "paused"}})
        if (is) state += (state.empty() ? "" : ", ") + std::string(name);
    if (state.empty())
        ImGui::TextDisabled("culling with the eye's camera");
    else
        ImGui::TextColored(ImVec4(1.0f, 0.85f, 0.3f, 1.0f), "%s", state.c_str());
}

// Remembers where the panel being built lies.
void cover(PanelWish& wish) {
    const ImVec2 at = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
    wish.covered.push_back({at.x, at.y, at.x + size.x, at.y + size.y});
}

// A heading whose part the user, a key or a script may unfold.
bool unfolded(const char* title, bool& open) {
    ImGui::SetNextItemOpen(open);
    open = ImGui::CollapsingHeader(title);
    return open;
}

void main_panel(const PanelInput& input, PanelWish& wish) {
    const ImGuiCond when = input.relayout ? ImGuiCond_Always : ImGuiCond_FirstUseEver;
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(kMargin, kMargin), when);
    ImGui::SetNextWindowSize(ImVec2(main_panel_width(), display.y - 2.0f * kMargin), when);
    if (input.fold) ImGui::SetNextWindowCollapsed(*input.fold, ImGuiCond_Always);
    if (ImGui::Begin("Crofton")) {
        heading(input);
        statistics_panel(input);
        hitches(input);
        legend(input);
        if (ImGui::CollapsingHeader("Switches", ImGuiTreeNodeFlags_DefaultOpen)) switches_panel(input, wish);
        if (unfolded("More statistics", input.settings.more)) more_statistics(input);
        if (unfolded("History", input.settings.history)) history_plots(input.frame_history);
    }
    cover(wish);
    ImGui::End();
}

void inset_panel(const PanelInput& input, PanelWish& wish) {
    if (input.inset == nullptr) return;
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    if (input.fold) ImGui::SetNextWindowCollapsed(*input.fold, ImGuiCond_Always);
    const float wide = input.inset_size.x + 2.0f * ImGui::GetStyle().WindowPadding.x;
    const float high = input.inset_size.y + ImGui::GetFrameHeight() + 2.0f * ImGui::GetStyle().WindowPadding.y;
    ImGui::SetNextWindowPos(ImVec2(display.x - wide - kMargin, display.y - high - kMargin),
                            input.relayout ? ImGuiCond_Always : ImGuiCond_Appearing);
    if (ImGui::Begin("From outside (I)", nullptr, ImGuiWindowFlags_AlwaysAutoResize))
        ImGui::Image(input.inset, input.inset_size);
    cover(wish);
    ImGui::End();
}

}  // namespace

float main_panel_width() {
    return width_of_main_panel(ImGui::GetIO().DisplaySize.x, ImGui::GetFontSize());
}

float font_pixels(float scale) {
    return std::round(kFontPixels * scale);
}

float half_beside_main_panel(float display, float font) {
    const float padding = kPadding * font / kFontPixels;
    return std::max(0.5f * (display - width_of_main_panel(display, font) - 4.0f * kMargin - 4.0f * padding),
                    2.0f * font);
}

bool is_narrow(const ImVec2& display) {
    return display.x < 32.0f * ImGui::GetFontSize() || display.y < 16.0f * ImGui::GetFontSize();
}

void apply_style(float scale) {
    ImGuiStyle& style = ImGui::GetStyle();
    style = ImGuiStyle();
    ImGui::StyleColorsDark();
    style.WindowRounding = 4.0f;
    style.AntiAliasedLinesUseTex = false;  // textures are not filtered
    style.Colors[ImGuiCol_WindowBg].w = 0.88f;
    style.ScaleAllSizes(scale);
    // Drawn at its size, not enlarged.
    ImFontConfig font;
    font.SizePixels = font_pixels(scale);
    ImGui::GetIO().Fonts->Clear();
    ImGui::GetIO().Fonts->AddFontDefault(&font);
}

PanelWish draw_panels(const PanelInput& input) {
    PanelWish wish;
    main_panel(input, wish);
    scene_panel(input, wish);
    inset_panel(input, wish);
    depth_panel(input, wish);
    notices_panel(input.notices);
    if (input.settings.help) help_panel(input.settings, wish);
    return wish;
}

}  // namespace crofton::viewer
