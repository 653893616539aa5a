// SPDX-License-Identifier: MIT
#include "statistics_panel.hpp"

#include <array>
#include <cfloat>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <string_view>

namespace crofton::viewer {
namespace {

using Frame = pipeline::FrameStatistics;
using Value = double (*)(const Frame&);

constexpr std::size_t kMeanOf = 60;

constexpr StatisticsRow kMainRows[] = {
    {"instances", "instances", "in the scene"},
    {"visible", "visible", "whose bound meets the view: inside + straddling"},
    {"  inside", "inside", "whose bound lies in the view"},
    {"  straddling", "straddling", "whose bound crosses the view's boundary"},
    {"  improper", "improper",
     "whose bound straddles, though the object itself does not: a tighter bound would save these"},
    {"nodes tested", "nodes_tested", "of the tree, against the view"},
    {"triangles submitted", "triangles_submitted", "of the visible instances"},
    {"triangles in view", "triangles_passed", "that meet the view"},
    {"triangles seen", "triangles_seen",
     "that own a pixel: the least that could be drawn; counted every thirtieth frame"},
    {"  in view for each", "passed_per_seen", "triangles in view for each that is seen"},
    {"colliding pairs", "colliding_pairs", "of instances whose boxes meet, where one of them moves"},
    {"update \u00b5s", "update_us", "to move objects, and to update the tree"},
    {"cull \u00b5s", "cull_us", "to find visible objects"},
    {"collide \u00b5s", "collide_us", "to find colliding objects"},
    {"draw \u00b5s", "draw_us", "of the last frame: from submitting until the device is done"},
};
constexpr StatisticsRow kMoreRows[] = {
    {"instances seen", "instances_seen", "that own a pixel"},
    {"triangles clipped", "triangles_clipped", "predicted: those left of the submitted ones after clipping"},
    {"GPU assembled", "gpu_input_assembly_primitives", "triangles that the device has read"},
    {"GPU clip invocations", "gpu_clipping_invocations", "triangles that the device has clipped"},
    {"GPU clip primitives", "gpu_clipping_primitives", "triangles that the device's clipping has left"},
    {"GPU samples passed", "gpu_samples_passed", "pixels that passed the depth test"},
    {"box pairs tested", "pairs_tested", "whose axis-aligned bounds meet"},
    {"  apart by face of A", "separated_by_face_a", "separated by an axis of the first box"},
    {"  apart by face of B", "separated_by_face_b", "separated by an axis of the second box"},
    {"  apart by edges", "separated_by_edges", "separated by the cross product of two edges"},
    {"  refined", "pairs_refined", "decided in double or exactly, where float could not"},
    {"contact points", "contacts", "of the colliding pairs' manifolds"},
    {"regions attached", "regions_attached", "of a folder of regions"},
    {"  came", "regions_came", "attached before this frame"},
    {"  went", "regions_went", "detached before this frame"},
    {"  attach \u00b5s", "regions_attach_us", "to attach and to detach them, a part of the update"},
    {"  wait \u00b5s", "regions_wait_us", "for regions that were not prepared in time: in scripts alone"},
};

const pipeline::StatisticsColumn& column_named(const char* name) {
    static const std::map<std::string, pipeline::StatisticsColumn> kByName = [] {
        std::map<std::string, pipeline::StatisticsColumn> columns;
        for (const pipeline::StatisticsColumn& column : pipeline::statistics_columns())
            columns.emplace(column.name, column);
        return columns;
    }();
    return kByName.at(name);
}

// Ends at the column's right edge.
void right_aligned(const std::string& text) {
    const float room = ImGui::GetContentRegionAvail().x - ImGui::CalcTextSize(text.c_str()).x;
    if (room > 0.0f) ImGui::SetCursorPosX(ImGui::GetCursorPosX() + room);
    ImGui::TextUnformatted(text.c_str());
}

void number(double value) {
    right_aligned(with_thousands(static_cast<std::uint64_t>(std::llround(value))));
}

// Shows the number of the last frame for which it was counted; nothing before.
void seen_number(const Frame* frame, const pipeline::StatisticsColumn& column) {
    if (frame == nullptr) return;
    if (std::string_view(column.name) != "passed_per_seen") return number(column.value(*frame));
    char text[32];
    std::snprintf(text, sizeof text, "%.1f", column.value(*frame));
    right_aligned(text);
}

bool is_of_what_is_seen(std::string_view column) {
    return column.ends_with("seen");
}

// The device's numbers are those of the last frame that it has drawn.
bool is_counted_later(const std::string& column) {
    return column == "draw_us" || column == "triangles_clipped" || column.rfind("gpu_", 0) == 0;
}

// Shows occlusion of A, and of B or the mean, if one of the two has it.
void occlusion_rows(const PanelInput& input) {
    using Count = double (*)(const OcclusionCounts&);
    struct Row {
        const char *label, *hint;
        Count count;
    };
    static constexpr Row kRows[] = {
        {"hidden", "instances whose bound meets the view, behind occluders: not drawn",
         [](const OcclusionCounts& c) { return static_cast<double>(c.hidden); }},
        {"  their triangles", "not submitted, because their object is hidden",
         [](const OcclusionCounts& c) { return static_cast<double>(c.triangles_hidden); }},
        {"  occluders", "drawn into the depth buffer: those that are worth most to this view",
         [](const OcclusionCounts& c) { return static_cast<double>(c.occluders); }},
        {"occlude \u00b5s", "to choose occluders, to draw them, and to test every object",
         [](const OcclusionCounts& c) { return c.us; }},
    };
    const Occlusion* own = input.loaded.occlusion();
    if (own == nullptr && input.other_occlusion == nullptr) return;
    for (const Row& row : kRows) {
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(row.label);
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", row.hint);
        ImGui::TableNextColumn();
        if (own != nullptr) number(row.count(own->counts()));
        ImGui::TableNextColumn();
        if (input.other == nullptr)
            number(input.frame_history.mean_of_occlusion(row.count, kMeanOf));
        else if (input.other_occlusion != nullptr)
            number(row.count(input.other_occlusion->counts()));
    }
}

void table(const char* id, const PanelInput& input, std::span<const StatisticsRow> rows) {
    const bool compare = input.other != nullptr;
    if (!ImGui::BeginTable(id, 3, ImGuiTableFlags_RowBg)) return;
    ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthStretch, 2.0f);
    ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthStretch, 1.0f);
    ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthStretch, 1.0f);
    ImGui::TableNextRow(ImGuiTableRowFlags_Headers);
    ImGui::TableNextColumn();
    ImGui::TextUnformatted("per frame");
    ImGui::TableNextColumn();
    right_aligned(compare ? "A" : "now");
    ImGui::TableNextColumn();
    right_aligned(compare ? "B" : "mean of 60");
    for (const StatisticsRow& row : rows) {
        const pipeline::StatisticsColumn& column = column_named(row.column);
        const Value value = column.value;
        const bool later = is_counted_later(row.column);
        if (std::string_view(row.column).starts_with("regions_") && !input.frame.regions) continue;
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(row.label);
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", row.hint);
        ImGui::TableNextColumn();
        if (is_of_what_is_seen(row.column)) {
            seen_number(input.seen, column);
            continue;
        }
        if (!later)
            number(value(input.frame));
        else if (input.drawn != nullptr)
            number(value(*input.drawn));
        ImGui::TableNextColumn();
        if (!compare)
            number(input.frame_history.mean_of_frames(value, kMeanOf));
        else if (!later || input.other->gpu)
            number(value(*input.other));
    }
    if (std::string_view(id) == "statistics") occlusion_rows(input);
    ImGui::EndTable();
}

void prediction(const PanelInput& input) {
    if (input.drawn == nullptr || !input.drawn->gpu) return;
    const Frame& frame = *input.drawn;
    const std::uint64_t predicted = frame.triangles_clipped, counted = frame.gpu->clipping_primitives;
    const bool exactly = input.device.counts_exactly();
    const ImVec4 same(0.4f, 0.9f, 0.4f, 1.0f), fault(1.0f, 0.5f, 0.3f, 1.0f);
    ImGui::TextColored(predicted == counted ? same
                       : exactly            ? fault
                                            : ImGui::GetStyleColorVec4(ImGuiCol_Text),
                       "%s", clip_counts(predicted, counted, exactly).c_str());
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("triangles that clipping leaves, as computed on the CPU and as the device's counter says%s",
                          exactly ? "" : "; this device clips in its own way");
}

}  // namespace

std::string with_thousands(std::uint64_t value) {
    const std::string digits = std::to_string(value);
    std::string text;
    for (std::size_t i = 0; i < digits.size(); ++i) {
        if (i > 0 && (digits.size() - i) % 3 == 0) text += ' ';
        text += digits[i];
    }
    return text;
}

std::string clip_counts(std::uint64_t predicted, std::uint64_t counted, bool exactly) {
    const char* between = predicted == counted ? " = " : exactly ? " but " : ", ";
    return "clipped: predicted " + with_thousands(predicted) + between + with_thousands(counted) + " counted";
}

std::span<const StatisticsRow> main_rows() {
    return kMainRows;
}
std::span<const StatisticsRow> more_rows() {
    return kMoreRows;
}

void statistics_panel(const PanelInput& input) {
    table("statistics", input, kMainRows);
    prediction(input);
}

void more_statistics(const PanelInput& input) {
    table("more", input, kMoreRows);
}

void history_plots(const FrameHistory& frame_history) {
    const float unit = ImGui::GetFontSize();
    ImGui::PushItemWidth(-6.0f * unit);
    const auto plot = [&](const char* name, const char* format, double (*value)(const HistoryEntry&)) {
        const auto history = frame_history.history(value);
        if (history.empty()) return;
        char now[64];
        std::snprintf(now, sizeof now, format, static_cast<double>(history.back()));
        ImGui::PlotLines(name, history.data(), static_cast<int>(history.size()), 0, now, 0.0f, FLT_MAX,
                         ImVec2(0.0f, 3.0f * unit));
    };
    ImGui::TextDisabled("last %zu frames, each from 0 up", FrameHistory::kHistory);
    plot("frame", "%.1f ms", [](const HistoryEntry& e) { return e.frame_us * 1e-3; });
    plot("draw", "%.1f ms", [](const HistoryEntry& e) { return e.frame.draw_us * 1e-3; });
    plot("update", "%.0f \u00b5s", [](const HistoryEntry& e) { return e.frame.update_us; });
    plot("cull", "%.0f \u00b5s", [](const HistoryEntry& e) { return e.frame.cull_us; });
    plot("collide", "%.0f \u00b5s", [](const HistoryEntry& e) { return e.frame.collide_us; });
    plot("visible", "%.0f instances", [](const HistoryEntry& e) { return static_cast<double>(e.frame.visible); });
    plot("hidden", "%.0f instances", [](const HistoryEntry& e) { return static_cast<double>(e.occlusion.hidden); });
    plot("in view", "%.0f triangles",
         [](const HistoryEntry& e) { return static_cast<double>(e.frame.triangles_passed); });
    plot("pairs", "%.0f colliding", [](const HistoryEntry& e) { return static_cast<double>(e.frame.colliding_pairs); });
    const auto bins = frame_history.frame_time_histogram();
    ImGui::PlotHistogram("frame ms", bins.data(), static_cast<int>(bins.size()), 0, "0 to 100 ms in steps of 5", 0.0f,
                         FLT_MAX, ImVec2(0.0f, 4.0f * unit));
    ImGui::PopItemWidth();
}

}  // namespace crofton::viewer
