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

#define CROFTON_OCCLUSION_COLUMN(field)                                                                          \
    Column {                                                                                                     \
        "occlusion_" #field,                                                                                     \
            [](const FrameStatistics& f) { return f.occlusion ? static_cast<double>(f.occlusion->field) : 0.0; } \
    }
#define CROFTON_OCCLUSION_GPU_COLUMN(field)                                                              \
    Column {                                                                                             \
        "occlusion_gpu_" #field, [](const FrameStatistics& f) {                                          \
            return f.occlusion && f.occlusion->gpu ? static_cast<double>(f.occlusion->gpu->field) : 0.0; \
        }                                                                                                \
    }

constexpr std::array kOcclusionColumns = {
    CROFTON_OCCLUSION_COLUMN(visible),
    CROFTON_OCCLUSION_COLUMN(occluders),
    CROFTON_OCCLUSION_COLUMN(triangles_submitted),
    CROFTON_OCCLUSION_COLUMN(triangles_passed),
    CROFTON_OCCLUSION_COLUMN(triangles_clipped),
    CROFTON_OCCLUSION_GPU_COLUMN(clipping_primitives),
    CROFTON_OCCLUSION_GPU_COLUMN(samples_passed),
    CROFTON_OCCLUSION_COLUMN(occlude_us),
    CROFTON_OCCLUSION_COLUMN(draw_us),
};

#undef CROFTON_OCCLUSION_COLUMN
#undef CROFTON_OCCLUSION_GPU_COLUMN
#undef CROFTON_COLUMN
#undef CROFTON_GPU_COLUMN

bool drawn(std::span<const FrameStatistics> frames) {
    return std::any_of(frames.begin(), frames.end(), [](const FrameStatistics& f) { return f.gpu.has_value(); });
}

bool needs_gpu(const Column& column) {
    return std::string_view(column.name).find("gpu_") != std::string_view::npos;
}

// What these frames have values for.
std::vector<Column> columns_of(std::span<const FrameStatistics> frames) {
    std::vector<Column> columns(kColumns.begin(), kColumns.end());
    if (std::any_of(frames.begin(), frames.end(), [](const FrameStatistics& f) { return f.occlusion.has_value(); }))
        columns.insert(columns.end(), kOcclusionColumns.begin(), kOcclusionColumns.end());
    if (!drawn(frames)) std::erase_if(columns, needs_gpu);
    return columns;
}

Json gpu_json(const std::optional<render::GpuCounters>& gpu) {
    if (!gpu) return nullptr;
    return {{"input_assembly_primitives", gpu->input_assembly_primitives},
            {"clipping_invocations", gpu->clipping_invocations},
            {"clipping_primitives", gpu->clipping_primitives},
            {"samples_passed", gpu->samples_passed}};
}

Json occlusion_json(const std::optional<OccludedFrame>& f, bool with_ids) {
    if (!f) return nullptr;
    Json entry = {{"visible", f->visible},
                  {"occluders", f->occluders},
                  {"triangles_submitted", f->triangles_submitted},
                  {"triangles_passed", f->triangles_passed},
                  {"triangles_clipped", f->triangles_clipped},
                  {"gpu", gpu_json(f->gpu)},
                  {"owners", nullptr},
                  {"occlude_us", f->occlude_us},
                  {"draw_us", f->draw_us}};
    if (f->owners) entry["owners"] = {{"instances", f->owners->instances}, {"triangles", f->owners->triangles}};
    if (with_ids) entry["visible_ids"] = f->visible_ids;
    return entry;
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
std::span<const StatisticsColumn> occlusion_columns() {
    return kOcclusionColumns;
}

Json to_json(const FrameStatistics& f, bool with_ids) {
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
                  {"gpu", gpu_json(f.gpu)},
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
                  {"draw_us", f.draw_us},
                  {"occlusion", occlusion_json(f.occlusion, with_ids)}};
    if (with_ids) {
        entry["visible_ids"] = f.visible_ids;
        entry["colliding_ids"] = f.colliding_ids;
    }
    return entry;
}

Json summary_json(std::span<const FrameStatistics> frames, const std::optional<Verification>& verification) {
    Json summary = {{"frames", frames.size()}};
    const double count = static_cast<double>(std::max<std::size_t>(1, frames.size()));
    for (const Column& column : columns_of(frames)) {
        double sum = 0.0;
        for (const FrameStatistics& frame : frames) sum += column.value(frame);
        summary["mean_" + std::string(column.name)] = sum / count;
    }
    summary["drawn"] = drawn(frames);
    if (const auto owners = mean_owners(frames)) {
        summary["mean_owners"] = owners->instances;
        summary["mean_owner_triangles"] = owners->triangles;
    }
    summary["verified"] = verification.has_value();
    summary["mismatches"] = verification ? verification->mismatches() : 0;
    if (verification) {
        summary["culled_but_visible"] = verification->culled_but_visible;
        summary["wrong_verdicts"] = verification->wrong_verdicts;
        summary["wrong_pairs"] = verification->wrong_pairs;
        summary["wrong_counts"] = verification->wrong_counts;
        summary["hidden_but_seen"] = verification->hidden_but_seen;
        summary["changed_pictures"] = verification->changed_pictures;
        summary["unclear"] = verification->unclear;
        summary["mismatch_messages"] = verification->messages;
    }
    return summary;
}

std::optional<MeanOwners> mean_owners(std::span<const FrameStatistics> frames) {
    MeanOwners sum;
    std::size_t count = 0;
    for (const FrameStatistics& f : frames) {
        if (!f.occlusion || !f.occlusion->owners) continue;
        sum.instances += static_cast<double>(f.occlusion->owners->instances);
        sum.triangles += static_cast<double>(f.occlusion->owners->triangles);
        ++count;
    }
    if (count == 0) return std::nullopt;
    return MeanOwners{sum.instances / static_cast<double>(count), sum.triangles / static_cast<double>(count)};
}

std::string to_csv(std::span<const FrameStatistics> frames) {
    const std::vector<Column> columns = columns_of(frames);
    std::string text = "index";
    for (const Column& column : columns) text += "," + std::string(column.name);
    text += "\n";
    for (const FrameStatistics& frame : frames) {
        text += std::to_string(frame.index);
        for (const Column& column : columns) text += "," + number(column.value(frame));
        text += "\n";
    }
    return text;
}

}  // namespace crofton::pipeline
