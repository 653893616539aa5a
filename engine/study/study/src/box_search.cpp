// SPDX-License-Identifier: MIT
#include "box_search.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <utility>

#include "direction_cells.hpp"
#include "rotation_cells.hpp"

namespace crofton::study {
namespace {

using std::numbers::pi;

struct BoxCell {
    glm::dvec3 center;
    double half, bound;
};

}  // namespace

BoxSearch::BoxSearch(Vector<glm::dvec3> points, const glm::dvec3& origin, const AncestorDirections& directions)
    : points_(std::move(points)), normals_(directions.normals) {
    for (std::size_t i = 0; i < normals_.size(); ++i)
        limits_.push_back(directions.limits[i] - glm::dot(normals_[i], origin));
    // Σ nnᵀ / N: its largest row sum of magnitudes is no less than its largest eigenvalue, which is no less than
    // the mean square of dot(n, u) for any unit vector u.
    glm::dmat3 moments(0.0);
    for (const glm::dvec3& n : normals_)
        for (int k = 0; k < 3; ++k) moments[k] += n[k] * n / static_cast<double>(normals_.size());
    double largest = 0.0;
    for (int k = 0; k < 3; ++k)
        largest = std::max(largest, std::abs(moments[k].x) + std::abs(moments[k].y) + std::abs(moments[k].z));
    mean_cosine_ = std::sqrt(largest);
}

double BoxSearch::measure_of(const glm::dmat3& axes) const {
    const Supports s = supports(axes);
    double sum = 0.0;
    for (std::size_t i = 0; i < normals_.size(); ++i) {
        double h = 0.0;
        for (int k = 0; k < 3; ++k) {
            const double along = glm::dot(normals_[i], axes[k]);
            const std::size_t side = static_cast<std::size_t>(k);
            h += along * glm::dot(axes[k], along >= 0.0 ? s.high[side] : s.low[side]);
        }
        sum += std::min(limits_[i], h);
    }
    return 4.0 * pi * sum / static_cast<double>(normals_.size());
}

double BoxSearch::bound(const glm::dvec3& center, double half) const {
    const glm::dmat3 axes = rotation_of(center);
    const Supports s = supports(axes);
    const auto [turns, longest] = corner_turns(center, half);
    const double angle = 2.0 * arc_tangent(longest, 1.0);
    const double flip = sine(std::min(0.5 * pi, angle));
    std::array<double, 8> sums{};
    for (std::size_t i = 0; i < normals_.size(); ++i) {
        const glm::dvec3& n = normals_[i];
        double base = 0.0;
        glm::dvec3 slope(0.0);
        for (int k = 0; k < 3; ++k) {
            const double along = glm::dot(n, axes[k]);
            // The angle to the face may pass 90 degrees within the cell: the term is at least 0.
            if (std::abs(along) <= flip) continue;
            const std::size_t side = static_cast<std::size_t>(k);
            const glm::dvec3& p = along >= 0.0 ? s.high[side] : s.low[side];
            const double out = glm::dot(p, axes[k]);
            base += along * out;
            // d dot(v, axis) = 2 dot(turn × axis, v) = 2 dot(turn, axis × v)
            slope += 2.0 * (along * glm::cross(axes[k], p) + out * glm::cross(axes[k], n));
        }
        for (unsigned c = 0; c < 8; ++c) sums[c] += std::min(limits_[i], base + glm::dot(slope, turns[c]));
    }
    const double mean = *std::min_element(sums.begin(), sums.end()) / static_cast<double>(normals_.size());
    return std::max(0.0, 4.0 * pi * (mean - remainder(s, longest, angle)));
}

void BoxSearch::run(const BoxGivenAncestorsOptions& options, glm::dmat3& best, BoxGivenAncestors& result) const {
    CellQueue<BoxCell> queue;
    const auto add = [&](const glm::dvec3& center, double half, double above) {
        const glm::dmat3 axes = rotation_of(center);
        if (const double value = measure_of(axes); value < result.value) result.value = value, best = axes;
        queue.add({center, half, std::max(above, bound(center, half))}, result.value);
    };
    add(glm::dvec3(0.0), kHalfOfAllRotations, 0.0);
    while (queue.cells() < options.max_cells && queue.has_below(result.value * (1.0 - options.tolerance))) {
        const BoxCell cell = queue.take();
        divide(cell.center, cell.half, [&](const glm::dvec3& c, double half) { add(c, half, cell.bound); });
    }
    result.cells = queue.cells();
    result.lower_bound = queue.lower_bound(result.value);
}

BoxSearch::Supports BoxSearch::supports(const glm::dmat3& axes) const {
    Supports s;
    s.high.fill(points_[0]);
    s.low.fill(points_[0]);
    for (int k = 0; k < 3; ++k) {
        const std::size_t at = static_cast<std::size_t>(k);
        double high = -std::numeric_limits<double>::infinity(), low = -high;
        for (const glm::dvec3& p : points_) {
            const double along = glm::dot(axes[k], p);
            if (along > high) high = along, s.high[at] = p;
            if (along < low) low = along, s.low[at] = p;
        }
    }
    return s;
}

// Bounds what a mean over the directions may lose by taking linear terms for dot(n, a) · dot(p, a) while a turns by up
// to `angle`: half the square of the angle times the second derivative, of which each of its four parts is at most |p|
// · |dot(n, u)| for some unit u; and by taking 2 tan(angle/2) for the angle.
double BoxSearch::remainder(const Supports& s, double longest, double angle) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < 3; ++k) sum += std::max(glm::length(s.high[k]), glm::length(s.low[k]));
    return sum * mean_cosine_ * (2.0 * angle * angle + 2.0 * (2.0 * longest - angle));
}

}  // namespace crofton::study
