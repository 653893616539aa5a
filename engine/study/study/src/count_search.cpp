// SPDX-License-Identifier: MIT
#include "count_search.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "rotation_cells.hpp"

namespace crofton::study {
namespace {

struct CountCell {
    glm::dvec3 center;
    double half;
    std::uint32_t bound;  // queries that hit every box of the cell
    Vector<std::uint32_t> undecided;
};

// Boxes as stored have axes of floats, 6e-8 off.
constexpr double kRounding = 1e-6;

// A box inside all tight boxes of a cell, and a box around them. A unit axis that turns by an angle moves by
// s = 2 sin(angle / 2). A point's coordinate then changes by at most s times its distance from the middle. Let r be
// the points' greatest distance. Extents change by at most s r. No corner of a tight box is farther than √3 r.
struct Boxes {
    Obb inner, outer;
    bool has_inner;
};

class Turns {
  public:
    explicit Turns(std::span<const glm::dvec3> points) : points_(points) {
        glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
        for (const glm::dvec3& p : points) low = glm::min(low, p), high = glm::max(high, p);
        middle_ = 0.5 * (low + high);
        for (const glm::dvec3& p : points) radius_ = std::max(radius_, glm::length(p - middle_));
    }

    [[nodiscard]] Boxes boxes(const glm::dvec3& center, double half) const {
        const double longest = corner_turns(center, half).longest;
        // tan(angle / 2) = longest.
        const double moved = 2.0 * longest / std::sqrt(1.0 + longest * longest);
        const glm::dmat3 axes = rotation_of(center);
        glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
        for (const glm::dvec3& p : points_) {
            const glm::dvec3 along = (p - middle_) * axes;
            low = glm::min(low, along), high = glm::max(high, along);
        }
        const double farthest = glm::length(glm::max(glm::abs(low), glm::abs(high)));
        const double less = moved * (radius_ + farthest) + kRounding * radius_,
                     more = moved * (1.0 + std::sqrt(3.0)) * radius_ + kRounding * radius_;
        Boxes result;
        result.inner.axes = result.outer.axes = glm::mat3(axes);
        result.inner.center = result.outer.center = middle_ + 0.5 * (axes * (low + high));
        const glm::dvec3 half_extents = 0.5 * (high - low);
        result.has_inner = std::min({half_extents.x, half_extents.y, half_extents.z}) > less;
        result.inner.half_extents = glm::vec3(glm::max(half_extents - less, glm::dvec3(0.0)));
        result.outer.half_extents = glm::vec3(half_extents + more);
        return result;
    }

  private:
    std::span<const glm::dvec3> points_;
    glm::dvec3 middle_{0.0};
    double radius_ = 0.0;
};

}  // namespace

CountProof prove_count(std::span<const glm::dvec3> points, std::span<const std::uint32_t> triangles,
                       const QuerySample& queries, std::span<const std::uint32_t> candidates, std::uint32_t known,
                       double tolerance, std::uint64_t max_cells,
                       FunctionRef<std::uint32_t(const glm::dmat3&)> consider) {
    // A plane that hits the hull hits every box.
    CountCell all{glm::dvec3(0.0), kHalfOfAllRotations, 0, {}};
    for (const std::uint32_t q : candidates)
        if (queries.surely_hits(q, points, triangles))
            ++all.bound;
        else
            all.undecided.push_back(q);
    if (max_cells == 0) return {std::min(known, all.bound), 0};
    const Turns turns(points);
    CellQueue<CountCell> queue;
    const auto add = [&](const glm::dvec3& center, double half, const CountCell& above) {
        const Boxes boxes = turns.boxes(center, half);
        CountCell cell{center, half, above.bound, {}};
        for (const std::uint32_t q : above.undecided) {
            if (boxes.has_inner && queries.hits(q, boxes.inner))
                ++cell.bound;
            else if (queries.hits(q, boxes.outer))
                cell.undecided.push_back(q);
        }
        if (queue.add(std::move(cell), known)) known = std::min(known, consider(rotation_of(center)));
    };
    add(all.center, all.half, all);
    while (queue.cells() < max_cells && queue.has_below(static_cast<double>(known) * (1.0 - tolerance))) {
        const CountCell cell = queue.take();
        divide(cell.center, cell.half, [&](const glm::dvec3& c, double half) { add(c, half, cell); });
    }
    return {queue.lower_bound(known), queue.cells()};
}

}  // namespace crofton::study
