// SPDX-License-Identifier: MIT
#include "panels.hpp"

#include <algorithm>

#include "keys.hpp"

namespace crofton::viewer {

namespace {

void show_group(const KeyGroup& group) {
    const float column = 9.0f * ImGui::GetFontSize();
    ImGui::TextColored(ImVec4(0.55f, 0.78f, 1.0f, 1.0f), "%s", group.title);
    for (const KeyHelp& key : group.keys) {
        ImGui::TextUnformatted(key.shown);
        ImGui::SameLine(column);
        ImGui::PushTextWrapPos(0.0f);
        ImGui::TextUnformatted(key.does);
        ImGui::PopTextWrapPos();
    }
    ImGui::Spacing();
}

}  // namespace

void help_panel(Settings& settings, PanelWish& wish) {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    const float font = ImGui::GetFontSize();
    const bool two_columns = display.x > 78.0f * font;
    ImGui::SetNextWindowPos(ImVec2(0.5f * display.x, 0.5f * display.y), ImGuiCond_Always, ImVec2(0.5f, 0.5f));
    const ImVec2 size(std::min((two_columns ? 84.0f : 44.0f) * font, display.x - 16.0f),
                      std::min((two_columns ? 34.0f : 56.0f) * font, display.y - 16.0f));
    ImGui::SetNextWindowSize(size, ImGuiCond_Always);
    ImGui::SetNextWindowBgAlpha(0.97f);
    if (ImGui::Begin("Help (F1)", &settings.help, ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoResize) &&
        ImGui::BeginTable("groups", two_columns ? 2 : 1)) {
        // Moving and seeing on the left, the rest on the right.
        std::size_t shown = 0;
        ImGui::TableNextColumn();
        for (const KeyGroup& group : key_groups()) {
            if (two_columns && shown++ == 2) ImGui::TableNextColumn();
            show_group(group);
        }
        ImGui::EndTable();
    }
    const ImVec2 at = ImGui::GetWindowPos();
    wish.covered.push_back({at.x, at.y, at.x + size.x, at.y + size.y});
    ImGui::End();
}

void notices_panel(const std::deque<Notice>& notices) {
    if (notices.empty()) return;
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    const float left = main_panel_width() + 16.0f, width = std::max(display.x - left - 8.0f, 0.4f * display.x);
    ImGui::SetNextWindowPos(ImVec2(display.x - 8.0f, display.y - 8.0f), ImGuiCond_Always, ImVec2(1.0f, 1.0f));
    ImGui::SetNextWindowSize(ImVec2(width, 0.0f), ImGuiCond_Always);
    if (ImGui::Begin("Messages", nullptr,
                     ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoFocusOnAppearing)) {
        ImGui::PushTextWrapPos(0.0f);
        for (const Notice& notice : notices)
            ImGui::TextColored(notice.bad ? ImVec4(1.0f, 0.55f, 0.4f, 1.0f) : ImVec4(0.9f, 0.9f, 0.9f, 1.0f), "%s",
                               notice.text.c_str());
        ImGui::PopTextWrapPos();
    }
    ImGui::End();
}

}  // namespace crofton::viewer
