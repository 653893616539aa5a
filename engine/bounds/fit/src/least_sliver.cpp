// SPDX-License-Identifier: MIT
#include "least_sliver.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/expansion.hpp>
#include <crofton/geometry/finite.hpp>
#include <crofton/geometry/predicates.hpp>
#include <glm/geometric.hpp>

#include "golden_section.hpp"

namespace crofton::fit {
namespace {

// How far `p` is from `origin` across the unit vector `along`, to 2^-50 of itself: the differences and products are
// taken with their roundings.
double across_of(const glm::dvec2& p, const glm::dvec2& origin, const glm::dvec2& along) {
    const detail::TwoTerms dx = detail::two_sum(p.x, -origin.x), dy = detail::two_sum(p.y, -origin.y);
    const detail::TwoTerms left = detail::two_product(along.x, dy.high), right = detail::two_product(along.y, dx.high);
    const detail::TwoTerms difference = detail::two_sum(left.high, -right.high);
    return difference.high + (difference.low + (left.low - right.low) + (along.x * dy.low - along.y * dx.low));
}

// Slivers whose sharp corner is at one end of the hull or beyond it.
class SharpEnd {
  public:
    SharpEnd(std::span<const glm::dvec2> hull, const glm::dvec2& end, const glm::dvec2& other)
        : hull_(hull), end_(end), along_(glm::normalize(other - end)) {
        for (const glm::dvec2& p : hull) {
            places_.emplace_back(std::max(0.0, glm::dot(p - end, along_)), across_of(p, end, along_));
            length_ = std::max(length_, places_.back().x);
            low_ = std::min(low_, places_.back().y);
            high_ = std::max(high_, places_.back().y);
            for (int k = 0; k < 2; ++k) rounding_ = std::max(rounding_, 0x1p-53 * std::abs(p[k]));
        }
    }

    // Replaces `best` by what is shorter.
    void improve(std::optional<Triangle2>& best) const {
        try_corner(end_, best);
        // Beyond the end by e the perimeter is about 2 (L + e) and what the corner's opening makes of L + e. The best
        // power of two first, then the best between its neighbours; and multiples, since corners are rounded.
        const auto perimeter = [&](double beyond) {
            return (length_ + beyond) * (2.0 + opening(beyond, middle(beyond)));
        };
        double best_beyond = length_, least = kInfinity;
        for (double beyond = length_; beyond >= std::max(rounding_, 0x1p-60 * length_); beyond *= 0.5)
            if (const double value = perimeter(beyond); value < least) least = value, best_beyond = beyond;
        best_beyond = minimise(0.5 * best_beyond, 2.0 * best_beyond, 40, perimeter);
        for (int k = 0; k < 5; ++k, best_beyond *= 2.0)
            try_corner(end_ - best_beyond * along_ + middle(best_beyond) * glm::dvec2(-along_.y, along_.x), best);
    }

  private:
    // Between the steepest lines from the corner through the points.
    [[nodiscard]] double opening(double beyond, double aside) const {
        double lowest = kInfinity, highest = -kInfinity;
        for (const glm::dvec2& p : places_) {
            const double slope = (p.y - aside) / (p.x + beyond);
            lowest = std::min(lowest, slope);
            highest = std::max(highest, slope);
        }
        return highest - lowest;
    }
    // Where the corner opens least: the opening is convex.
    [[nodiscard]] double middle(double beyond) const {
        const double thickness = high_ - low_;
        return minimise(low_ - thickness, high_ + thickness, 40, [&](double y) { return opening(beyond, y); });
    }

    void try_corner(const glm::dvec2& corner, std::optional<Triangle2>& best) const {
        const glm::dvec2* lowest = nullptr;
        const glm::dvec2* highest = nullptr;
        for (const glm::dvec2& p : hull_) {
            if (p == corner) continue;
            if (!lowest || orientation(corner, *lowest, p) < 0) lowest = &p;
            if (!highest || orientation(corner, *highest, p) > 0) highest = &p;
        }
        const glm::dvec2 across(-along_.y, along_.x);
        double reach = 0.0;
        for (const glm::dvec2& p : hull_) reach = std::max(reach, glm::dot(p - corner, along_));
        // The side across from the corner, at first through the points themselves where they are there.
        const auto end_of = [&](const glm::dvec2& through, double margin, double up) {
            const double before = glm::dot(through - corner, along_);
            const glm::dvec2 rest = (reach - before + margin) / before * (through - corner);
            return through + rest + up * margin * across;
        };
        for (double margin = 0.0; margin <= length_; margin = std::max(2.0 * margin, rounding_)) {
            const Triangle2 triangle{corner, end_of(*lowest, margin, -1.0), end_of(*highest, margin, 1.0)};
            if (best && perimeter_of(triangle) >= perimeter_of(*best)) return;
            if (!holds(triangle, hull_)) continue;
            best = triangle;
            return;
        }
    }

    std::span<const glm::dvec2> hull_;
    glm::dvec2 end_, along_;
    Vector<glm::dvec2> places_;  // along and across, from the end
    double length_ = 0.0, low_ = 0.0, high_ = 0.0, rounding_ = 0.0;
};

}  // namespace

bool holds(const Triangle2& triangle, std::span<const glm::dvec2> points) {
    return std::all_of(points.begin(), points.end(), [&](const glm::dvec2& p) {
        return orientation(triangle[0], triangle[1], p) >= 0 && orientation(triangle[1], triangle[2], p) >= 0 &&
               orientation(triangle[2], triangle[0], p) >= 0;
    });
}

double perimeter_of(const Triangle2& triangle) {
    return glm::distance(triangle[0], triangle[1]) + glm::distance(triangle[1], triangle[2]) +
           glm::distance(triangle[2], triangle[0]);
}

std::optional<Triangle2> least_sliver(std::span<const glm::dvec2> hull) {
    const auto farthest_from = [&](const glm::dvec2& from) {
        return *std::max_element(hull.begin(), hull.end(), [&](const glm::dvec2& p, const glm::dvec2& q) {
            return glm::distance(from, p) < glm::distance(from, q);
        });
    };
    const glm::dvec2 end = farthest_from(hull[0]), other = farthest_from(end);
    std::optional<Triangle2> best;
    SharpEnd(hull, end, other).improve(best);
    SharpEnd(hull, other, end).improve(best);
    return best;
}

}  // namespace crofton::fit
