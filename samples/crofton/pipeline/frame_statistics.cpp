// SPDX-License-Identifier: MIT
#include "frame_statistics.hpp"

#include <algorithm>
#include <array>

#include "camera_path.hpp"
#include "json/json.hpp"

namespace crofton::pipeline {
namespace {

using Column = StatisticsColumn;

// A number that frames have where `has` holds of the frame f.
#define CROFTON_COLUMN_IF(name, has, number)                                                      \
    Column {                                                                                      \
        name, [](const FrameStatistics& f) { return (has) ? static_cast<double>(number) : 0.0; }, \
            []([[maybe_unused]] const FrameStatistics& f) { return static_cast<bool>(has); }      \
    }
#define CROFTON_COLUMN(field) CROFTON_COLUMN_IF(#field, true, f.field)
#define CROFTON_COLUMN_OF(part, field) CROFTON_COLUMN_IF(#part "_" #field, f.part, f.part->field)

constexpr std::array kColumns = {
    CROFTON_COLUMN(instances),
    CROFTON_COLUMN(visible),
    CROFTON_COLUMN(inside),
    CROFTON_COLUMN(straddling),
    CROFTON_COLUMN(improper),
    CROFTON_COLUMN(nodes_tested),
    CROFTON_COLUMN(triangles_submitted),
    CROFTON_COLUMN(triangles_passed),
    CROFTON_COLUMN_IF("triangles_seen", f.seen, f.seen->triangles),
    CROFTON_COLUMN_IF("passed_per_seen", f.seen, passed_per_seen(f.triangles_passed, f.seen)),
    CROFTON_COLUMN_IF("instances_seen", f.seen, f.seen->instances),
    CROFTON_COLUMN(triangles_clipped),
    CROFTON_COLUMN_OF(gpu, input_assembly_primitives),
    CROFTON_COLUMN_OF(gpu, clipping_invocations),
    CROFTON_COLUMN_OF(gpu, clipping_primitives),
    CROFTON_COLUMN_OF(gpu, samples_passed),
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
    CROFTON_COLUMN_OF(regions, attached),
    CROFTON_COLUMN_OF(regions, came),
    CROFTON_COLUMN_OF(regions, went),
    CROFTON_COLUMN_OF(regions, attach_us),
    CROFTON_COLUMN_OF(regions, wait_us),
};

constexpr std::array kOcclusionColumns = {
    CROFTON_COLUMN_OF(occlusion, visible),
    CROFTON_COLUMN_OF(occlusion, occluders),
    CROFTON_COLUMN_OF(occlusion, triangles_submitted),
    CROFTON_COLUMN_OF(occlusion, triangles_passed),
    CROFTON_COLUMN_IF("occlusion_passed_per_seen", f.occlusion&& f.seen,
                      passed_per_seen(f.occlusion->triangles_passed, f.seen)),
    CROFTON_COLUMN_OF(occlusion, triangles_clipped),
    CROFTON_COLUMN_IF("occlusion_gpu_clipping_primitives", f.occlusion&& f.occlusion->gpu,
                      f.occlusion->gpu->clipping_primitives),
    CROFTON_COLUMN_IF("occlusion_gpu_samples_passed", f.occlusion&& f.occlusion->gpu, f.occlusion->gpu->samples_passed),
    CROFTON_COLUMN_OF(occlusion, occlude_us),
    CROFTON_COLUMN_OF(occlusion, draw_us),
    CROFTON_COLUMN_OF(shadow, casters),
    CROFTON_COLUMN_OF(shadow, triangles),
    CROFTON_COLUMN_OF(shadow, casters_listed),
    CROFTON_COLUMN_OF(shadow, triangles_listed),
    CROFTON_COLUMN_OF(shadow, find_us),
};

#undef CROFTON_COLUMN_OF
#undef CROFTON_COLUMN
#undef CROFTON_COLUMN_IF

bool drawn(std::span<const FrameStatistics> frames) {
    return std::any_of(frames.begin(), frames.end(), [](const FrameStatistics& f) { return f.gpu.has_value(); });
}

Json ratio_json(std::uint64_t passed, const std::optional<Seen>& seen) {
    if (!seen) return nullptr;
    return passed_per_seen(passed, seen);
}

Json gpu_json(const std::optional<render::GpuCounters>& gpu) {
    if (!gpu) return nullptr;
    return {{"input_assembly_primitives", gpu->input_assembly_primitives},
            {"clipping_invocations", gpu->clipping_invocations},
            {"clipping_primitives", gpu->clipping_primitives},
            {"samples_passed", gpu->samples_passed}};
}

Json occlusion_json(const std::optional<OccludedFrame>& f, const std::optional<Seen>& seen, bool with_ids) {
    if (!f) return nullptr;
    Json entry = {{"visible", f->visible},
                  {"occluders", f->occluders},
                  {"triangles_submitted", f->triangles_submitted},
                  {"triangles_passed", f->triangles_passed},
                  {"passed_per_seen", ratio_json(f->triangles_passed, seen)},
                  {"triangles_clipped", f->triangles_clipped},
                  {"gpu", gpu_json(f->gpu)},
                  {"occlude_us", f->occlude_us},
                  {"draw_us", f->draw_us}};
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

std::vector<StatisticsColumn> columns_of(std::span<const FrameStatistics> frames) {
    std::vector<Column> columns(kColumns.begin(), kColumns.end());
    columns.insert(columns.end(), kOcclusionColumns.begin(), kOcclusionColumns.end());
    std::erase_if(columns,
                  [&](const Column& column) { return std::none_of(frames.begin(), frames.end(), column.has_value); });
    return columns;
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
                  {"triangles_seen", f.seen ? Json(f.seen->triangles) : Json(nullptr)},
                  {"passed_per_seen", ratio_json(f.triangles_passed, f.seen)},
                  {"instances_seen", f.seen ? Json(f.seen->instances) : Json(nullptr)},
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
                  {"occlusion", occlusion_json(f.occlusion, f.seen, with_ids)}};
    if (f.shadow)
        entry["shadow"] = {{"casters", f.shadow->casters},
                           {"triangles", f.shadow->triangles},
                           {"casters_listed", f.shadow->casters_listed},
                           {"triangles_listed", f.shadow->triangles_listed},
                           {"find_us", f.shadow->find_us}};
    if (f.regions)
        entry["regions"] = {{"attached", f.regions->attached},
                            {"came", f.regions->came},
                            {"went", f.regions->went},
                            {"attach_us", f.regions->attach_us},
                            {"wait_us", f.regions->wait_us}};
    if (with_ids) {
        entry["visible_ids"] = f.visible_ids;
        entry["colliding_ids"] = f.colliding_ids;
    }
    return entry;
}

Json summary_json(std::span<const FrameStatistics> frames, const std::optional<Verification>& verification) {
    Json summary = {{"frames", frames.size()}};
    for (const Column& column : columns_of(frames)) {
        double sum = 0.0, count = 0.0;
        for (const FrameStatistics& frame : frames) {
            if (!column.has_value(frame)) continue;
            sum += column.value(frame);
            ++count;
        }
        summary["mean_" + std::string(column.name)] = sum / std::max(count, 1.0);
    }
    summary["drawn"] = drawn(frames);
    // This is the ratio of the means, not the mean of the ratios.
    if (const auto seen = mean_seen(frames)) {
        summary["passed_per_seen"] = seen->passed_per_seen();
        if (frames.front().occlusion) summary["occlusion_passed_per_seen"] = seen->passed_per_seen_with_occlusion();
    }
    if (const auto found = hitches(frames))
        summary["regions"] = {{"came", found->came},
                              {"went", found->went},
                              {"most_attached", found->most_attached},
                              {"median_ms", found->median_ms},
                              {"worst_ms", found->worst_ms},
                              {"worst_frame", found->worst_frame},
                              {"wait_ms", found->wait_ms},
                              {"longest_load_ms", found->longest_load_ms}};
    summary["verified"] = verification.has_value();
    summary["mismatches"] = verification ? verification->mismatches() : 0;
    if (verification) {
        summary["culled_but_visible"] = verification->culled_but_visible;
        summary["wrong_verdicts"] = verification->wrong_verdicts;
        summary["wrong_pairs"] = verification->wrong_pairs;
        summary["wrong_counts"] = verification->wrong_counts;
        summary["hidden_but_seen"] = verification->hidden_but_seen;
        summary["changed_pictures"] = verification->changed_pictures;
        summary["changed_pixels"] = verification->changed_pixels;
        summary["unclear"] = verification->unclear;
        summary["mismatch_messages"] = verification->messages;
    }
    return summary;
}

double passed_per_seen(std::uint64_t passed, const std::optional<Seen>& seen) {
    return seen && seen->triangles > 0 ? static_cast<double>(passed) / static_cast<double>(seen->triangles) : 0.0;
}

std::optional<MeanSeen> mean_seen(std::span<const FrameStatistics> frames) {
    MeanSeen mean;
    double count = 0.0;
    for (const FrameStatistics& f : frames) {
        if (!f.seen) continue;
        mean.instances += static_cast<double>(f.seen->instances);
        mean.triangles += static_cast<double>(f.seen->triangles);
        mean.passed += static_cast<double>(f.triangles_passed);
        if (f.occlusion) mean.passed_with_occlusion += static_cast<double>(f.occlusion->triangles_passed);
        ++count;
    }
    if (count == 0.0) return std::nullopt;
    for (double* sum : {&mean.instances, &mean.triangles, &mean.passed, &mean.passed_with_occlusion}) *sum /= count;
    return mean;
}

std::optional<Hitches> hitches(std::span<const FrameStatistics> frames) {
    if (frames.empty() || !frames.front().regions) return std::nullopt;
    Hitches result;
    std::vector<double> times;
    for (const FrameStatistics& frame : frames) {
        const StreamedFrame& regions = *frame.regions;
        result.came += regions.came;
        result.went += regions.went;
        result.most_attached = std::max(result.most_attached, regions.attached);
        result.wait_ms += 1e-3 * regions.wait_us;
        result.longest_load_ms = std::max(result.longest_load_ms, regions.longest_load_ms);
        times.push_back(1e-3 * (frame.update_us + frame.cull_us));
        if (times.back() > result.worst_ms) result.worst_ms = times.back(), result.worst_frame = frame.index;
    }
    std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
    result.median_ms = times[times.size() / 2];
    return result;
}

std::string to_csv(std::span<const FrameStatistics> frames) {
    const std::vector<Column> columns = columns_of(frames);
    std::string text = "index";
    for (const Column& column : columns) text += "," + std::string(column.name);
    text += "\n";
    for (const FrameStatistics& frame : frames) {
        text += std::to_string(frame.index);
        for (const Column& column : columns)
            text += "," + (column.has_value(frame) ? number(column.value(frame)) : std::string());
        text += "\n";
    }
    return text;
}

}  // namespace crofton::pipeline
