// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/lines/lines.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <crofton/pvs/pvs.hpp>
#include <crofton/sampling/sampling.hpp>
#include <cstdio>

#include "pipeline/pvs_scene.hpp"
#include "pipeline/pvs_views.hpp"

#include "topics.hpp"

namespace crofton::cli {
namespace {

using sampling::Random;

constexpr double kConfidence = 0.999;
constexpr std::uint64_t kCellsAsked = 96;

struct Baked {
    assets::SceneSource source;
    pipeline::PvsScene scene;
    pvs::Cells cells;
    pvs::Bake bake;
    pvs::Pvs sets;
    double epsilon = 0.0, lines_a_cell = 0.0;
};

Result<Baked> bake_town(const VerifyOptions& options) {
    auto source = assets::load_scene("town");
    if (!source) return source.error();
    source->scene.update();
    auto scene = pipeline::make_pvs_scene(*source, true);
    if (!scene) return scene.error();
    // Proofs take as long as all lines, whatever their number; few trials are for a quick look.
    const std::uint32_t side = options.trials < 100'000 ? 8 : 24;
    auto cells = pvs::Cells::grid(pipeline::eyes_of(source->scene, 10.0), {side, 2, side});
    if (!cells) return cells.error();
    // Lines through the cell among all, by surfaces; ε from (7).
    const auto surface = [](const Aabb& box) {
        const glm::dvec3 e = box.max - box.min;
        return 2.0 * (e.x * e.y + e.y * e.z + e.z * e.x);
    };
    const double lines = static_cast<double>(options.trials) * surface(cells->box(0)) / surface(cells->bounds());
    const auto pairs = static_cast<double>(cells->size() * scene->geometry.boxes.size());
    const double epsilon = std::min(0.5, std::log(pairs / (1.0 - kConfidence)) / lines);
    auto bake = pvs::Bake::create(scene->geometry, *cells,
                                  {.epsilon = epsilon, .confidence = kConfidence, .seed = options.seed});
    if (!bake) return bake.error();
    if (auto ran = bake->run(); !ran) return ran.error();
    auto sets = pvs::Pvs::finish(*bake, scene->occluders, {.near_radius = 0.0, .halvings = 2});
    if (!sets) return sets.error();
    return Baked{
        std::move(*source), std::move(*scene), std::move(*cells), std::move(*bake), std::move(*sets), epsilon, lines};
}

// The objects at the ends of the gaps that the line has within the box, each once.
void add_ends(std::span<const lines::Hit> hits, const pvs::BakeGeometry& geometry, const Line& line, const Aabb& box,
              std::vector<std::uint32_t>& ends) {
    double begin = -HUGE_VAL, end = HUGE_VAL;
    for (int k = 0; k < 3; ++k) {
        const double a = (box.min[k] - line.point[k]) / line.direction[k];
        const double b = (box.max[k] - line.point[k]) / line.direction[k];
        begin = std::max(begin, std::min(a, b));
        end = std::min(end, std::max(a, b));
    }
    const double some = 0.01 * (box.max.y - box.min.y);
    ends.clear();
    for (std::size_t gap = 0; gap <= hits.size(); ++gap) {
        const double from = std::max(begin, gap == 0 ? -HUGE_VAL : static_cast<double>(hits[gap - 1].t));
        const double to = std::min(end, gap == hits.size() ? HUGE_VAL : static_cast<double>(hits[gap].t));
        if (to - from < some) continue;
        if (gap > 0) ends.push_back(geometry.object_of[hits[gap - 1].triangle]);
        if (gap < hits.size()) ends.push_back(geometry.object_of[hits[gap].triangle]);
    }
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
}

// Pairs above ε, by lines through each of some cells alone, that the bake has not seen. Above is what 20 times the
// lines estimate so: for p = ε they have 20·ln(P/δ) hits in the mean, about 400, so a standard deviation of 5 % of ε
// at most. A pair estimated above ε is thus above 0.8·ε, but for one in 30,000, and was missed with a chance of
// (δ/P)^0.8. Gaps shorter than a hundredth of a cell's height do not count, so estimates are rather low.
VerifyRow missed_pairs(const Baked& baked, const lines::LineTracer& tracer, const VerifyOptions& options) {
    std::uint64_t missed = 0, above = 0;
    const auto lines = static_cast<std::uint64_t>(20.0 * baked.lines_a_cell);
    for (std::uint64_t i = 0; i < kCellsAsked; ++i) {
        Random random(options.seed + 500, i);
        const std::size_t cell = random.bits() % baked.cells.size();
        const Aabb world = baked.cells.box(cell);
        const Aabb box{world.min - baked.scene.geometry.origin, world.max - baked.scene.geometry.origin};
        Vector<Line> all;
        for (std::uint64_t n = 0; n < lines; ++n) all.push_back(sampling::line_from_box(box, random.point<5>()));
        lines::LineHits hits;
        tracer.all_hits(all, hits);
        std::vector<std::uint64_t> counts(baked.scene.geometry.boxes.size(), 0);
        std::vector<std::uint32_t> ends;
        for (std::size_t n = 0, first = 0; n < all.size(); first = hits.ends[n], ++n) {
            add_ends(std::span(hits.hits).subspan(first, hits.ends[n] - first), baked.scene.geometry, all[n], box,
                     ends);
            for (const std::uint32_t object : ends) ++counts[object];
        }
        for (std::uint32_t o = 0; o < counts.size(); ++o) {
            if (static_cast<double>(counts[o]) < baked.epsilon * static_cast<double>(lines)) continue;
            ++above;
            missed += !baked.bake.is_seen(cell, o);
        }
    }
    if (above == 0) return untried_row("pairs that the bake missed: none is above epsilon", "theory.md (7)");
    char claim[200];
    std::snprintf(claim, sizeof claim,
                  "town, epsilon %.2g: of %llu pairs above it in %llu cells, found by 20 times the lines, missed per "
                  "1,000 cells",
                  baked.epsilon, static_cast<unsigned long long>(above), static_cast<unsigned long long>(kCellsAsked));
    VerifyRow row = at_most_row(claim, "theory.md (7)", 1.0,
                                1000.0 * static_cast<double>(missed) / static_cast<double>(kCellsAsked), 0.0);
    row.cases = above;
    return row;
}

void wrong_rays(const Baked& baked, const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    const auto tree =
        mesh::MeshTree::build(baked.scene.geometry.mesh, {.boxes = mesh::MeshBoxes::principal_axes, .rays = true});
    std::uint64_t rays = 0, hits = 0, drawn_less = 0, hidden = 0;
    Random random(options.seed + 501);
    while (tree && rays < options.trials) {
        const std::size_t cell = random.bits() % baked.cells.size();
        const glm::dvec3 eye = sampling::box_point(baked.cells.box(cell), random.point<3>());
        for (int n = 0; n < 64; ++n, ++rays) {
            const Ray ray{eye - baked.scene.geometry.origin, sampling::direction(random.point<2>())};
            const std::uint32_t from = baked.sets.find_cell(eye);
            const auto hit = mesh::raycast(ray, *tree);
            if (!hit || from == pvs::kNoCell) continue;
            ++hits;
            const pvs::PairState state = baked.sets.state(from, baked.scene.geometry.object_of[hit->triangle]);
            drawn_less += state != pvs::PairState::seen;
            hidden += state == pvs::PairState::hidden;
        }
    }
    const pvs::PairCounts counts = baked.sets.counts();
    char claim[300];
    std::snprintf(
        claim, sizeof claim,
        "town: rays from eyes in cells that first meet an object proved hidden (%.1f %% of pairs are; %.2g of "
        "the rays first meet one that no line has seen, at epsilon %.2g)",
        100.0 * static_cast<double>(counts.hidden) / static_cast<double>(counts.all()),
        static_cast<double>(drawn_less) / static_cast<double>(std::max<std::uint64_t>(1, hits)), baked.epsilon);
    rows.push_back(none_row(claim, "docs/notes/pvs.md", hits, hidden));
}

// Views from places that the bake knew nothing of.
VerifyRow wrong_pixels(const Baked& baked, const VerifyOptions& options) {
    const auto views = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(options.trials / 200, 20, 1000));
    const auto looked = pipeline::look_at_views(baked.source.scene, baked.scene.geometry, baked.sets,
                                                {.views = views, .seed = options.seed, .near_radius = 0.0});
    if (!looked) return computed_row("street views: " + looked.error().message, "docs/pvs.md", 1.0, 0.0, 0.0);
    char claim[300];
    std::snprintf(
        claim, sizeof claim,
        "town: wrong pixels in %u street views, conservative (%.2f times the triangles of objects that own a pixel; "
        "statistical at epsilon %.2g: %.2g in the mean, %.2g at worst, %.2f times the triangles)",
        views, looked->conservative.triangles / looked->owner_triangles, baked.epsilon, looked->statistical.wrong_mean,
        looked->statistical.wrong_worst, looked->statistical.triangles / looked->owner_triangles);
    VerifyRow row = computed_row(claim, "docs/pvs.md", 0.0, looked->conservative.wrong_worst, 0.0);
    row.cases = views;
    return row;
}

}  // namespace

std::vector<VerifyRow> verify_pvs(const VerifyOptions& options) {
    std::vector<VerifyRow> rows;
    const auto baked = bake_town(options);
    if (!baked) {
        rows.push_back(computed_row("the town is baked: " + baked.error().message, "docs/pvs.md", 1.0, 0.0, 0.0));
        return rows;
    }
    const auto tracer = lines::LineTracer::build(baked->scene.geometry.mesh);
    rows.push_back(tracer ? missed_pairs(*baked, *tracer, options)
                          : untried_row("pairs that the bake missed", "theory.md (7)"));
    wrong_rays(*baked, options, rows);
    rows.push_back(wrong_pixels(*baked, options));
    return rows;
}

}  // namespace crofton::cli
