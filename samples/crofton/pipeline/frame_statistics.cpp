// SPDX-License-Identifier: MIT
#include "frame_statistics.hpp"

#include <algorithm>
#include <array>

#include "camera_path.hpp"
#include "json/json.hpp"

namespace crofton::pipeline {
namespace {

using Column = StatisticsColumn;

#define CROFTON_COLUMN(field)                                                         \
    Column {                                                                          \
#field, [](const FrameStatistics& f) { return static_cast<double>(f.field); } \
    }
#define CROFTON_GPU_COLUMN(field)                                                                               \
    Column {                                                                                                    \
        "gpu_" #field, [](const FrameStatistics& f) { return f.gpu ? static_cast<double>(f.gpu->field) : 0.0; } \
    }

constexpr std::array kColumns = {
    CROFTON_COLUMN(instances),
    CROFTON_COLUMN(visible),
    CROFTON_COLUMN(inside),
    CROFTON_COLUMN(straddling),
    CROFTON_COLUMN(improper),
    CROFTON_COLUMN(nodes_tested),
    CROFTON_COLUMN(triangles_submitted),
    CROFTON_COLUMN(triangles_passed),
    CROFTON_COLUMN(triangles_clipped),
    CROFTON_GPU_COLUMN(input_assembly_primitives),
    CROFTON_GPU_COLUMN(clipping_invocations),
    CROFTON_GPU_COLUMN(clipping_primitives),
    CROFTON_GPU_COLUMN(samples_passed),
    CROFTON_COLUMN(colliding_pairs),
    CROFTON_COLUMN(pairs_tested),
    CROFTON_COLUMN(separated_by_face_a),
    CROFTON_COLUMN(separated_by_face_b),
    CROFTON_COLUMN(separated_by_edges),
    CROFTON_COLUMN(pairs_refined),
    CROFTON_COLUMN(contacts),
    CROFTON_COLUMN(update_us),
    CROFTON_COLUMN(cull_us),
    CROFTON_COLUMN(collide_us),
    CROFTON_COLUMN(draw_us),
};

#undef CROFTON_COLUMN
#undef CROFTON_GPU_COLUMN

bool drawn(std::span<const FrameStatistics> frames) {
    return std::any_of(frames.begin(), frames.end(), [](const FrameStatistics& f) { return f.gpu.has_value(); });
}

bool needs_gpu(const Column& column) {
    return std::string_view(column.name).substr(0, 4) == "gpu_";
}

std::string number(double value) {
    char text[40];
    std::snprintf(text, sizeof text, value == static_cast<double>(static_cast<long long>(value)) ? "%.0f" : "%.3f",
                  value);
    return text;
}

}  // namespace

std::span<const StatisticsColumn> statistics_columns() {
    return kColumns;
}

Json to_json(const FrameStatistics& f, bool with_ids) {
    Json gpu = nullptr;
    if (f.gpu)
        gpu = {{"input_assembly_primitives", f.gpu->input_assembly_primitives},
               {"clipping_invocations", f.gpu->clipping_invocations},
               {"clipping_primitives", f.gpu->clipping_primitives},
               {"samples_passed", f.gpu->samples_passed}};
    Json entry = {{"index", f.index},
                  {"camera", to_json(f.camera)},
                  {"instances", f.instances},
                  {"visible", f.visible},
                  {"inside", f.inside},
                  {"straddling", f.straddling},
                  {"improper", f.improper},
                  {"nodes_tested", f.nodes_tested},
                  {"triangles_submitted", f.triangles_submitted},
                  {"triangles_passed", f.triangles_passed},
                  {"triangles_clipped", f.triangles_clipped},
                  {"gpu", std::move(gpu)},
                  {"colliding_pairs", f.colliding_pairs},
                  {"pairs_tested", f.pairs_tested},
                  {"separated_by_face_a", f.separated_by_face_a},
                  {"separated_by_face_b", f.separated_by_face_b},
                  {"separated_by_edges", f.separated_by_edges},
                  {"pairs_refined", f.pairs_refined},
                  {"contacts", f.contacts},
                  {"update_us", f.update_us},
                  {"cull_us", f.cull_us},
                  {"collide_us", f.collide_us},
                  {"draw_us", f.draw_us}};
    if (with_ids) {
        entry["visible_ids"] = f.visible_ids;
        entry["colliding_ids"] = f.colliding_ids;
    }
    return entry;
}

Json summary_json(std::span<const FrameStatistics> frames, const std::optional<Verification>& verification) {
    Json summary = {{"frames", frames.size()}};
    const double count = static_cast<double>(std::max<std::size_t>(1, frames.size()));
    for (const Column& column : kColumns) {
        if (needs_gpu(column) && !drawn(frames)) continue;
        double sum = 0.0;
        for (const FrameStatistics& frame : frames) sum += column.value(frame);
        summary["mean_" + std::string(column.name)] = sum / count;
    }
    summary["drawn"] = drawn(frames);
    summary["verified"] = verification.has_value();
    summary["mismatches"] = verification ? verification->mismatches() : 0;
    if (verification) {
        summary["culled_but_visible"] = verification->culled_but_visible;
        summary["wrong_verdicts"] = verification->wrong_verdicts;
        summary["wrong_pairs"] = verification->wrong_pairs;
        summary["wrong_counts"] = verification->wrong_counts;
        summary["unclear"] = verification->unclear;
        summary["mismatch_messages"] = verification->messages;
    }
    return summary;
}

std::string to_csv(std::span<const FrameStatistics> frames) {
    const bool with_gpu = drawn(frames);
    std::string text = "index";
    for (const Column& column : kColumns)
        if (with_gpu || !needs_gpu(column)) text += "," + std::string(column.name);
    text += "\n";
    for (const FrameStatistics& frame : frames) {
        text += std::to_string(frame.index);
        for (const Column& column : kColumns)
            if (with_gpu || !needs_gpu(column)) text += "," + number(column.value(frame));
        text += "\n";
    }
    return text;
}

}  // namespace crofton::pipeline
