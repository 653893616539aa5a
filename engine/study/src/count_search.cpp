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
    glm::dvec3 center;  // Rodrigues
    double half;
    std::uint32_t certain;  // queries that hit every box of the cell
    Vector<std::uint32_t> undecided;
    std::uint64_t age;
};

// Boxes as stored have axes of floats, 6e-8 off.
constexpr double kRounding = 1e-6;

// What is in all tight boxes of a cell, and what holds all of them. A unit axis turned by up to an angle moves by s = 2
// sin(angle / 2) at most. So a point's coordinate changes by s times its distance from the middle, and an extent by s
// r, r the points' greatest distance. No corner of a tight box is farther than √3 r.
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
        double longest = 0.0;
        for (unsigned c = 0; c < 8; ++c)
            longest = std::max(longest, glm::length(turn_between(center, corner_of(center, half, c))));
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
    // What hits the hull hits every box.
    std::uint32_t base = 0;
    CountCell all{glm::dvec3(0.0), kHalfOfAllRotations, 0, {}, 0};
    for (const std::uint32_t q : candidates)
        if (queries.surely_hits(q, points, triangles))
            ++base;
        else
            all.undecided.push_back(q);
    CountProof proof;
    const Turns turns(points);
    std::uint32_t dropped = std::numeric_limits<std::uint32_t>::max();
    Vector<CountCell> heap;
    const auto lower = [](const CountCell& a, const CountCell& b) {
        return a.certain != b.certain ? a.certain > b.certain : a.age > b.age;
    };
    const auto add = [&](const glm::dvec3& center, double half, const CountCell& above) {
        const Boxes boxes = turns.boxes(center, half);
        CountCell cell{center, half, above.certain, {}, ++proof.cells};
        for (const std::uint32_t q : above.undecided) {
            if (boxes.has_inner && queries.hits(q, boxes.inner))
                ++cell.certain;
            else if (queries.hits(q, boxes.outer))
                cell.undecided.push_back(q);
        }
        if (base + cell.certain >= known) {
            dropped = std::min(dropped, cell.certain);
            return;
        }
        known = std::min(known, consider(rotation_of(center)));
        heap.push_back(std::move(cell));
        std::push_heap(heap.begin(), heap.end(), lower);
    };
    if (max_cells > 0) add(all.center, all.half, all);
    while (!heap.empty() && proof.cells < max_cells &&
           static_cast<double>(base + heap.front().certain) < static_cast<double>(known) * (1.0 - tolerance)) {
        std::pop_heap(heap.begin(), heap.end(), lower);
        const CountCell cell = std::move(heap.back());
        heap.pop_back();
        for (unsigned c = 0; c < 8; ++c) add(corner_of(cell.center, 0.5 * cell.half, c), 0.5 * cell.half, cell);
    }
    std::uint32_t least = max_cells > 0 ? dropped : 0;
    if (!heap.empty()) least = std::min(least, heap.front().certain);
    proof.lower_bound = least == std::numeric_limits<std::uint32_t>::max() ? known : std::min(known, base + least);
    return proof;
}

}  // namespace crofton::study
