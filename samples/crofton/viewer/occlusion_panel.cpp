// SPDX-License-Identifier: MIT
#include "panels.hpp"

#include <algorithm>
#include <cmath>

#include "statistics_panel.hpp"

namespace crofton::viewer {
namespace {

// The rectangle around a box's picture, in [0, 1]² from the top left. None where a corner comes before the near plane.
std::optional<ImVec4> rectangle_of(const Obb& box, const Camera& camera) {
    const glm::dmat3 to_view = world_to_view_rotation(camera);
    const double half = std::tan(0.5 * camera.fov_y);
    ImVec4 area(2.0f, 2.0f, -1.0f, -1.0f);
    for (const glm::dvec3& corner : corners(box)) {
        const glm::dvec3 p = to_view * (corner - camera.position);
        const bool perspective = camera.projection == Projection::perspective;
        const double height = perspective ? -p.z * half : 0.5 * camera.height;
        if (-p.z < camera.near_distance) return std::nullopt;
        const auto x = static_cast<float>(0.5 + 0.5 * p.x / (height * camera.aspect));
        const auto y = static_cast<float>(0.5 - 0.5 * p.y / height);
        area = {std::min(area.x, x), std::min(area.y, y), std::max(area.z, x), std::max(area.w, y)};
    }
    if (area.z < 0.0f || area.w < 0.0f || area.x > 1.0f || area.y > 1.0f) return std::nullopt;
    return area;
}

void mark_selection(const PanelInput& input, const ImVec2& at, const ImVec2& size) {
    const scene::Scene& scene = input.loaded.scene();
    if (input.selected >= scene.instance_count() || scene.is_removed(input.selected)) return;
    const auto area = rectangle_of(scene.world_boxes()[input.selected], input.frame.camera);
    if (!area) return;
    const auto place = [&](float x, float y) {
        return ImVec2(at.x + std::clamp(x, 0.0f, 1.0f) * size.x, at.y + std::clamp(y, 0.0f, 1.0f) * size.y);
    };
    ImDrawList& list = *ImGui::GetWindowDrawList();
    // No smaller than can be seen, and told apart from both ends of the scale.
    ImVec2 low = place(area->x, area->y), high = place(area->z, area->w);
    low = ImVec2(std::floor(std::min(low.x, high.x - 3.0f)) - 1.0f, std::floor(std::min(low.y, high.y - 3.0f)) - 1.0f);
    high = ImVec2(std::ceil(high.x) + 1.0f, std::ceil(high.y) + 1.0f);
    list.AddRect(ImVec2(low.x - 1.0f, low.y - 1.0f), ImVec2(high.x + 1.0f, high.y + 1.0f), IM_COL32(0, 0, 0, 255));
    list.AddRect(low, high, IM_COL32(90, 170, 255, 255));
}

// From the nearest to the farthest covered pixel.
void scale(const DepthPicture& picture, float width) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float height = 0.6f * ImGui::GetFontSize();
    constexpr int kSteps = 48;
    for (int i = 0; i < kSteps; ++i) {
        const float left = std::floor(width * static_cast<float>(i) / kSteps),
                    right = std::floor(width * static_cast<float>(i + 1) / kSteps);
        ImGui::GetWindowDrawList()->AddRectFilled(ImVec2(at.x + left, at.y), ImVec2(at.x + right, at.y + height),
                                                  depth_color((i + 0.5) / kSteps));
    }
    ImGui::Dummy(ImVec2(width, height));
    char far_text[32];
    std::snprintf(far_text, sizeof far_text, "%.3g m", picture.farthest);
    ImGui::Text("%.3g m", picture.nearest);
    ImGui::SameLine(ImGui::GetStyle().WindowPadding.x + width - ImGui::CalcTextSize(far_text).x);
    ImGui::TextUnformatted(far_text);
}

// In one line, as much as there is room for.
void facts(const DepthPicture& picture, float width) {
    const float font = ImGui::GetFontSize();
    if (width < 18.0f * font) return ImGui::Text("%.0f %% covered", 100.0 * picture.covered);
    ImGui::Text("%u \u00d7 %u, %.0f %% covered", picture.width, picture.height, 100.0 * picture.covered);
    ImGui::SameLine();
    const ImVec2 sample = ImGui::GetCursorScreenPos();
    ImGui::GetWindowDrawList()->AddRectFilled(sample, ImVec2(sample.x + font, sample.y + font), kOpenColor);
    ImGui::Dummy(ImVec2(font, font));
    ImGui::SameLine();
    ImGui::TextUnformatted("open");
}

// Beside the main panel and the picture from outside, and no higher than half the display.
ImVec2 picture_size(const PanelInput& input) {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    const float font = ImGui::GetFontSize(), room = display.x - main_panel_width() - 24.0f - 2.0f * font;
    const float beside = input.settings.inset ? half_beside_main_panel(display.x, font) : room;
    const auto aspect = static_cast<float>(input.frame.camera.aspect);
    const float width = std::floor(std::max(std::min({24.6f * font, beside, 0.5f * display.y * aspect}), 2.0f * font));
    return {width, std::floor(width / aspect)};
}

}  // namespace

void depth_panel(const PanelInput& input, PanelWish& wish) {
    if (!input.settings.depth_buffer) return;
    const ImGuiStyle& style = ImGui::GetStyle();
    const float font = ImGui::GetFontSize();
    const ImVec2 size = picture_size(input);
    // The top stays where it is, whether there is a picture or not.
    const float height =
        ImGui::GetFrameHeight() + 2.0f * style.WindowPadding.y + size.y + 2.6f * font + 3.0f * style.ItemSpacing.y;
    ImGui::SetNextWindowPos(ImVec2(main_panel_width() + 16.0f, ImGui::GetIO().DisplaySize.y - height - 8.0f),
                            input.relayout ? ImGuiCond_Always : ImGuiCond_Appearing);
    if (input.fold) ImGui::SetNextWindowCollapsed(*input.fold, ImGuiCond_Always);
    if (ImGui::Begin("Depth buffer (J)", nullptr, ImGuiWindowFlags_AlwaysAutoResize)) {
        if (input.depth == nullptr) {
            ImGui::TextUnformatted("occlusion is off: Z switches it on");
        } else {
            const DepthPicture& picture = input.depth_picture;
            const ImVec2 at = ImGui::GetCursorScreenPos();
            ImGui::Image(input.depth, size);
            mark_selection(input, at, size);
            if (picture.covered > 0.0) scale(picture, size.x);
            facts(picture, size.x);
        }
    }
    const ImVec2 at = ImGui::GetWindowPos(), whole = ImGui::GetWindowSize();
    wish.covered.push_back({at.x, at.y, at.x + whole.x, at.y + whole.y});
    ImGui::End();
}

}  // namespace crofton::viewer
