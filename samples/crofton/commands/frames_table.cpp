// SPDX-License-Identifier: MIT
#include "frames_table.hpp"

#include <array>
#include <cstdio>

#include "assets/print.hpp"

namespace crofton::cli {
namespace {

using pipeline::FrameStatistics;
using Whole = unsigned long long;

double ratio(double a, double b) {
    return b > 0.0 ? a / b : 0.0;
}

// Dashes where nothing was drawn, which says what is seen.
std::string triangles_seen(const FrameStatistics& f) {
    return f.seen ? formatted("%llu", Whole{f.seen->triangles}) : "-";
}

std::string met_for_each_seen(const FrameStatistics& f, std::uint64_t passed) {
    return f.seen ? formatted("%.1f", pipeline::passed_per_seen(passed, f.seen)) : "-";
}

std::string row_with_occlusion(const FrameStatistics& f) {
    const pipeline::OccludedFrame& o = *f.occlusion;
    return formatted("%6u   %7llu %7llu   %9llu %9llu   %9llu %9llu %8s %7s %7s   %8.2f %8.2f %6.1f %10.2f\n", f.index,
                     Whole{f.visible}, Whole{o.visible}, Whole{f.triangles_submitted}, Whole{o.triangles_submitted},
                     Whole{f.triangles_passed}, Whole{o.triangles_passed}, triangles_seen(f).c_str(),
                     met_for_each_seen(f, f.triangles_passed).c_str(), met_for_each_seen(f, o.triangles_passed).c_str(),
                     frame_ms(f), frame_ms_with_occlusion(f), ratio(frame_ms(f), frame_ms_with_occlusion(f)),
                     1e-3 * o.occlude_us);
}

// No ratio where it is not less.
std::string mean_row(const char* what, const char* pattern, double without, double with) {
    const std::string numbers = formatted("  %-33s", what) + formatted(pattern, without) + formatted(pattern, with);
    return numbers + (without >= with ? formatted(" %8.2f\n", ratio(without, with)) : "\n");
}

std::string means_with_occlusion(std::span<const FrameStatistics> frames) {
    const auto mean = [&](auto value) { return mean_of(frames, value); };
    const auto rest = [&](auto value) {
        return mean_of(frames, [&](const FrameStatistics& f) { return value(*f.occlusion); });
    };
    const double submitted = rest([](const auto& f) { return f.triangles_submitted; });
    std::string text = formatted("mean of %4zu frames                    without      with    ratio\n", frames.size());
    text += mean_row("instances drawn", " %9.1f", mean([](const auto& f) { return f.visible; }),
                     rest([](const auto& f) { return f.visible; }));
    text +=
        mean_row("triangles submitted", " %9.0f", mean([](const auto& f) { return f.triangles_submitted; }), submitted);
    text +=
        mean_row("triangles that meet the frustum", " %9.0f", mean([](const auto& f) { return f.triangles_passed; }),
                 rest([](const auto& f) { return f.triangles_passed; }));
    const auto median = [&](auto value) { return median_of(frames, value); };
    if (frames.front().shadow) {
        text += mean_row("casters of the shadow map", " %9.1f", mean([](const auto& f) { return f.shadow->casters; }),
                         mean([](const auto& f) { return f.shadow->casters_listed; }));
        text +=
            mean_row("triangles of the shadow map", " %9.0f", mean([](const auto& f) { return f.shadow->triangles; }),
                     mean([](const auto& f) { return f.shadow->triangles_listed; }));
        text += formatted("  %-33s %9s %9.3f\n", "ms to find casters, median", "",
                          median([](const auto& f) { return 1e-3 * f.shadow->find_us; }));
    }
    text += mean_row("ms to cull, median", " %9.3f", median([](const auto& f) { return 1e-3 * f.cull_us; }),
                     median([](const auto& f) { return 1e-3 * f.occlusion->occlude_us; }));
    if (frames.front().gpu)
        text += mean_row("ms to draw it, median", " %9.2f", median([](const auto& f) { return 1e-3 * f.draw_us; }),
                         median([](const auto& f) { return 1e-3 * f.occlusion->draw_us; }));
    text += mean_row("ms of the frame, median", " %9.2f", median(frame_ms), median(frame_ms_with_occlusion));
    text += mean_row("ms of the frame, 99 % are below", " %9.2f", quantile_of(frames, 0.99, frame_ms),
                     quantile_of(frames, 0.99, frame_ms_with_occlusion));
    return text;
}

// How close the frame comes to drawing only what is seen.
std::string headline(std::span<const FrameStatistics> frames) {
    const auto seen = pipeline::mean_seen(frames);
    if (!seen) return {};
    std::string text = formatted("passed / seen: %.1f", seen->passed_per_seen());
    if (frames.front().occlusion)
        text += formatted(" without occlusion, %.1f with it", seen->passed_per_seen_with_occlusion());
    text += formatted("; %.0f triangles of %.1f instances own a pixel, %.0f meet the frustum", seen->triangles,
                      seen->instances, seen->passed);
    return text +
           (frames.front().occlusion ? formatted(" (%.0f with occlusion)\n", seen->passed_with_occlusion) : "\n");
}

std::string means_of_culling(const SceneFacts& scene, std::span<const FrameStatistics> frames) {
    const auto mean = [&](auto value) { return mean_of(frames, value); };
    return formatted("mean of %zu frames: %.1f of %llu instances visible, %.1f straddling (%.1f improperly)\n",
                     frames.size(), mean([](const auto& f) { return f.visible; }), Whole{scene.instances},
                     mean([](const auto& f) { return f.straddling; }), mean([](const auto& f) { return f.improper; })) +
           formatted("triangles: %.0f submitted, %.0f meet the frustum; colliding pairs: %.2f\n",
                     mean([](const auto& f) { return f.triangles_submitted; }),
                     mean([](const auto& f) { return f.triangles_passed; }),
                     mean([](const auto& f) { return f.colliding_pairs; }));
}

}  // namespace

double frame_ms(const FrameStatistics& f) {
    return 1e-3 * (f.update_us + f.collide_us + f.cull_us + f.draw_us);
}

double frame_ms_with_occlusion(const FrameStatistics& f) {
    return 1e-3 * (f.update_us + f.collide_us + f.occlusion->occlude_us + f.occlusion->draw_us);
}

std::string table_header(const SceneFacts& scene, bool occlusion) {
    const std::string title = formatted("%s: %llu nodes, %llu instances", printable(scene.name).c_str(),
                                        Whole{scene.nodes}, Whole{scene.instances}) +
                              (scene.triangles ? formatted(", %llu triangles\n\n", Whole{*scene.triangles}) : "\n\n");
    if (!occlusion)
        return title +
               " frame   visible straddle   improper     nodes  submitted     passed     seen   ratio    clipped  "
               "pairs "
               "update us  cull us  hits us   draw us\n";
    return title +
           "         instances drawn   triangles submitted   that meet the frustum     seen  met for each seen     "
           "milliseconds of the frame\n"
           " frame   without    with     without      with     without      with           without    with    without  "
           "   "
           "with  ratio  occlusion\n";
}

std::string table_row(const FrameStatistics& f) {
    if (f.occlusion) return row_with_occlusion(f);
    return formatted("%6u %9llu %8llu %10llu %9llu %10llu %10llu %8s %7s %10llu %6llu %9.0f %8.0f %8.0f %9.0f\n",
                     f.index, Whole{f.visible}, Whole{f.straddling}, Whole{f.improper}, Whole{f.nodes_tested},
                     Whole{f.triangles_submitted}, Whole{f.triangles_passed}, triangles_seen(f).c_str(),
                     met_for_each_seen(f, f.triangles_passed).c_str(),
                     Whole{f.gpu ? f.gpu->clipping_primitives : f.triangles_clipped}, Whole{f.colliding_pairs},
                     f.update_us, f.cull_us, f.collide_us, f.draw_us);
}

std::string table_means(const SceneFacts& scene, std::span<const FrameStatistics> frames,
                        const std::optional<pipeline::Verification>& verification) {
    const auto mean = [&](auto value) { return mean_of(frames, value); };
    std::string text = "\n" + headline(frames);
    text += frames.front().occlusion ? means_with_occlusion(frames) : means_of_culling(scene, frames);
    text += formatted(
        "collisions: %.1f pairs of boxes tested; early outs: %.1f by faces of the first, %.1f of the second, %.1f by "
        "edges; %.1f refined, %.1f contact points\n",
        mean([](const auto& f) { return f.pairs_tested; }), mean([](const auto& f) { return f.separated_by_face_a; }),
        mean([](const auto& f) { return f.separated_by_face_b; }),
        mean([](const auto& f) { return f.separated_by_edges; }), mean([](const auto& f) { return f.pairs_refined; }),
        mean([](const auto& f) { return f.contacts; }));
    text += formatted("microseconds: update %.0f, cull %.0f, collide %.0f, draw %.0f\n",
                      mean([](const auto& f) { return f.update_us; }), mean([](const auto& f) { return f.cull_us; }),
                      mean([](const auto& f) { return f.collide_us; }), mean([](const auto& f) { return f.draw_us; }));
    if (const auto found = pipeline::hitches(frames))
        text += formatted(
            "regions: %llu came, %llu went, at most %llu attached; update and cull: median %.2f ms, worst %.2f ms "
            "(frame "
            "%u); waited %.0f ms for regions, of which the slowest took %.0f ms to load\n",
            Whole{found->came}, Whole{found->went}, Whole{found->most_attached}, found->median_ms, found->worst_ms,
            found->worst_frame, found->wait_ms, found->longest_load_ms);
    if (!frames.front().gpu) text += "nothing was drawn: counts are the CPU's alone\n";
    if (!verification) return text;
    text += formatted(
        "verified by brute force: %llu mismatches in %llu frames (%llu answers too close for double to check)\n",
        Whole{verification->mismatches()}, Whole{verification->frames}, Whole{verification->unclear});
    if (frames.front().occlusion && frames.front().gpu)
        text += formatted(
            "verified by drawing: %llu triangles hidden that own a pixel, %llu pictures changed (%llu pixels)\n",
            Whole{verification->hidden_but_seen}, Whole{verification->changed_pictures},
            Whole{verification->changed_pixels});
    return text;
}

}  // namespace crofton::cli
