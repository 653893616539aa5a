#include "panels.hpp"

#include <algorithm>
#include <cinttypes>
#include <cmath>
#include <string>
#include <utility>

#include "help_panel.hpp"
#include "scene_panel.hpp"
#include "statistics_panel.hpp"
#include "switches_panel.hpp"

namespace crofton::viewer {
namespace {

constexpr float kFontPixels = 13.0f;  // what Dear ImGui's own font is made for
constexpr float kMargin = 8.0f;

ImVec4 display_color(const glm::vec3& linear) {
    return {std::sqrt(linear.r), std::sqrt(linear.g), std::sqrt(linear.b), 1.0f};
}
ImVec4 display_color(std::uint32_t rgba) {
    return ImGui::ColorConvertU32ToFloat4(rgba);
}

void legend(const PanelInput& input) {
    for (const Painter::Count& tint : input.painter.counts()) {
        ImGui::ColorButton(tint.name, display_color(tint.color), ImGuiColorEditFlags_NoTooltip,
                           ImVec2(ImGui::GetFontSize(), ImGui::GetFontSize()));
        ImGui::SameLine();
        ImGui::Text("%s: %" PRIu64, tint.name, tint.instances);
    }
    if (input.cascades.size() > 1)
        for (std::size_t i = 0; i < input.cascades.size(); ++i) {
            const Cascade& cascade = input.cascades[i];
            ImGui::TextColored(display_color(cascade.color), "view %zu: %.1f to %.1f m, %" PRIu64 " visible", i + 1,
                               cascade.camera.near, cascade.camera.far, cascade.visible);
        }
    if (input.settings.coloring == Coloring::shape)
        ImGui::TextUnformatted("triangles: red = slivers, green = equilateral");
    if (input.settings.coloring == Coloring::collision) {
        ImGui::Text("contacts between triangles: %" PRIu64, input.overlay.contact_count());
        ImGui::Text("near misses with their separating axis: %" PRIu64, input.overlay.separation_count());
    }
}

void heading(const PanelInput& input) {
    const double ms = input.journal.mean([](const JournalEntry& e) { return e.frame_us * 1e-3; }, 30);
    ImGui::Text("%s: %.1f frames/s", input.stage.source().name.c_str(), ms > 0.0 ? 1000.0 / ms : 0.0);
    ImGui::TextDisabled("%s", input.device.c_str());
    const glm::dvec3& eye = input.eye.camera.position;
    ImGui::Text("eye %.1f %.1f %.1f m, %s %.3g m/s", eye.x, eye.y, eye.z,
                input.eye.mode == EyeMode::orbit ? "in orbit," : "flying at", input.eye.speed);
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
    if (ImGui::Begin("Crofton")) {
        heading(input);
        statistics_panel(input);
        legend(input);
        if (ImGui::CollapsingHeader("Switches", ImGuiTreeNodeFlags_DefaultOpen)) switches_panel(input, wish);
        if (unfolded("More statistics", input.settings.more)) more_statistics(input);
        if (unfolded("History", input.settings.history)) history_plots(input.journal);
    }
    cover(wish);
    ImGui::End();
}

void inset_panel(const PanelInput& input, PanelWish& wish) {
    if (input.inset == nullptr) return;
    const ImVec2 display = ImGui::GetIO().DisplaySize;
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
    return std::min(27.0f * ImGui::GetFontSize(), 0.52f * ImGui::GetIO().DisplaySize.x);
}

void apply_style(float scale) {
    ImGui::StyleColorsDark();
    ImGuiStyle& style = ImGui::GetStyle();
    style.WindowRounding = 4.0f;
    style.Colors[ImGuiCol_WindowBg].w = 0.88f;
    style.ScaleAllSizes(scale);
    // Drawn at its size, not enlarged.
    ImFontConfig font;
    font.SizePixels = std::round(kFontPixels * scale);
    ImGui::GetIO().Fonts->AddFontDefault(&font);
}

PanelWish draw_panels(const PanelInput& input) {
    PanelWish wish;
    main_panel(input, wish);
    scene_panel(input, wish);
    inset_panel(input, wish);
    notices_panel(input.notices);
    if (input.settings.help) help_panel(input.settings, wish);
    return wish;
}

}  // namespace crofton::viewer
