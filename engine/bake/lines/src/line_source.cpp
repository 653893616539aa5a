// SPDX-License-Identifier: MIT
// Draws random lines through a scene's bounds.
#include <algorithm>
#include <cmath>
#include <crofton/core/error.hpp>
#include <crofton/lines/lines.hpp>
#include <glm/geometric.hpp>
#include <numbers>

namespace crofton::lines {
namespace {

constexpr std::uint64_t kMostGroups = 1 << 16;

Sphere sphere_around(const Aabb& box) {
    return {box.center(), glm::length(box.half_extents())};
}

}  // namespace

const char* to_string(LineMethod method) {
    switch (method) {
        case LineMethod::sphere_points:
            return "sphere";
        case LineMethod::disc:
            return "disc";
        case LineMethod::bundles:
            return "bundles";
        default:
            return "walls";
    }
}

LineSource::LineSource(const Aabb& bounds, LineMethod method, std::uint64_t seed, sampling::Sequence sequence)
    : bounds_(bounds), sphere_(sphere_around(bounds)), method_(method), seed_(seed), points_(seed, sequence) {
    CROFTON_ASSERT(surface_area() > 0.0, "lines need a body of two dimensions at least");
}

double LineSource::surface_area() const {
    if (method_ != LineMethod::walls) return 4.0 * std::numbers::pi * sphere_.radius * sphere_.radius;
    const glm::dvec3 d = bounds_.max - bounds_.min;
    return 2.0 * (d.x * d.y + d.y * d.z + d.z * d.x);
}

void LineSource::draw(std::uint64_t block, Vector<Line>& lines) const {
    lines.clear();
    if (method_ == LineMethod::bundles) {
        sampling::Random random(seed_, block);
        const double shadow = std::numbers::pi * sphere_.radius * sphere_.radius;
        sampling::append_line_bundle(sphere_, shadow / static_cast<double>(kBlock), random, lines);
        return;
    }
    for (std::uint64_t i = block * kBlock; i < (block + 1) * kBlock; ++i) {
        if (method_ == LineMethod::sphere_points)
            lines.push_back(sampling::line_through_two_sphere_points(sphere_, points_.at<4>(i)));
        else if (method_ == LineMethod::disc)
            lines.push_back(sampling::line_through_disc(sphere_, points_.at<4>(i)));
        else
            lines.push_back(sampling::line_from_box(bounds_, points_.at<5>(i)));
    }
}

VisibilityComplexity visibility_complexity(const LineTracer& tracer, const LineSource& source, std::uint64_t blocks,
                                           Executor& executor) {
    struct Counts {
        std::uint64_t lines = 0, crossings = 0, squares = 0, wasted = 0;
    };
    // Whole numbers: their sums are the same in any order, so that groups of blocks may share one place.
    const std::uint64_t groups = std::min(blocks, kMostGroups);
    const auto begin_of = [&](std::uint64_t group) {
        return blocks / groups * group + std::min(group, blocks % groups);
    };
    Vector<Counts> counts(static_cast<std::size_t>(groups));
    executor.parallel_for(counts.size(), 1, [&](std::size_t first, std::size_t end, unsigned) {
        Vector<Line> lines;
        LineHits hits;
        for (std::size_t g = first; g < end; ++g)
            for (std::uint64_t b = begin_of(g); b < begin_of(g + 1); ++b) {
                source.draw(b, lines);
                tracer.all_hits(lines, hits);
                std::uint32_t last = 0;
                for (const std::uint32_t end_of_line : hits.ends) {
                    const std::uint64_t n = end_of_line - last;
                    last = end_of_line;
                    ++counts[g].lines;
                    counts[g].crossings += n;
                    counts[g].squares += n * n;
                    counts[g].wasted += n == 0 ? 1u : 0u;
                }
            }
    });
    Counts all;
    for (const Counts& c : counts) {
        all.lines += c.lines;
        all.crossings += c.crossings;
        all.squares += c.squares;
        all.wasted += c.wasted;
    }
    VisibilityComplexity result;
    result.lines = all.lines;
    if (all.lines == 0) return result;
    const double n = static_cast<double>(all.lines);
    result.mean_crossings = static_cast<double>(all.crossings) / n;
    result.deviation =
        std::sqrt(std::max(0.0, static_cast<double>(all.squares) / n - result.mean_crossings * result.mean_crossings));
    result.wasted = static_cast<double>(all.wasted) / n;
    return result;
}

}  // namespace crofton::lines
