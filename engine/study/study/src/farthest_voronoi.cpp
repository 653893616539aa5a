// SPDX-License-Identifier: MIT
#include "farthest_voronoi.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/geometry/finite.hpp>
#include <crofton/geometry/trigonometry.hpp>
#include <glm/geometric.hpp>
#include <queue>

#include "exact_cross.hpp"

namespace crofton::study {
namespace {

// (b − a) × (c − a) within a few roundings of itself. Corners nearly on a line have circles all the same; the sign says
// on which side their centres lie.
double twice_area(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    const double left = (b.x - a.x) * (c.y - a.y), right = (b.y - a.y) * (c.x - a.x);
    if (std::abs(left - right) > 0.5 * (std::abs(left) + std::abs(right))) return left - right;
    return exact_cross(a, b, a, c).estimate();
}

// Where the circle through a, b and c has its centre on the bisector of a and b, along the left normal of a → b.
double place_of_center(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    const double height = twice_area(a, b, c) / glm::length(b - a);
    return glm::dot(c - a, c - b) / (2.0 * height);
}

struct Candidate {
    double radius, angle;
    std::uint32_t corner, version;
    // The corner whose circle with its neighbours is the largest goes first; ties by the wider angle, then by number.
    bool operator<(const Candidate& other) const {
        if (radius != other.radius) return radius < other.radius;
        if (angle != other.angle) return angle < other.angle;
        return corner > other.corner;
    }
};

// Corners left, in a ring; each owns the growing edge to its successor.
class Ring {
  public:
    explicit Ring(std::span<const glm::dvec2> corners)
        : corners_(corners),
          before_(corners.size()),
          after_(corners.size()),
          version_(corners.size(), 0),
          known_(corners.size(), kInfinity) {
        const auto n = static_cast<std::uint32_t>(corners.size());
        for (std::uint32_t i = 0; i < n; ++i) before_[i] = (i + n - 1) % n, after_[i] = (i + 1) % n;
        for (std::uint32_t i = 0; i < n && n > 2; ++i) push(i);
    }

    Vector<VoronoiEdge> diagram() {
        Vector<VoronoiEdge> edges;
        edges.reserve(2 * corners_.size());
        for (std::size_t left = corners_.size(); left > 2; --left) {
            const std::uint32_t p = pop(), q = before_[p], s = after_[p];
            // The centre of q, p, s ends the edges of q–p and p–s and begins that of q–s.
            edges.push_back(edge(q, p, known_[q], place_of_center(corners_[q], corners_[p], corners_[s])));
            edges.push_back(edge(p, s, known_[p], place_of_center(corners_[p], corners_[s], corners_[q])));
            known_[q] = place_of_center(corners_[q], corners_[s], corners_[p]);
            after_[q] = s;
            before_[s] = q;
            root_ = q;
            if (left > 3) push(q), push(s);
        }
        const std::uint32_t other = after_[root_];
        edges.push_back(edge(root_, other, known_[root_], -known_[other]));
        return edges;
    }

  private:
    void push(std::uint32_t i) {
        const glm::dvec2 a = corners_[before_[i]], b = corners_[i], c = corners_[after_[i]];
        const glm::dvec2 ab = b - a, bc = c - b, ac = c - a;
        const double doubled = std::abs(twice_area(a, b, c));
        const double radius = glm::length(ab) * glm::length(bc) * glm::length(ac) / (2.0 * doubled);
        heap_.push({radius, arc_tangent(doubled, -glm::dot(ab, bc)), i, ++version_[i]});
    }
    std::uint32_t pop() {
        for (;;) {
            const Candidate top = heap_.top();
            heap_.pop();
            if (top.version != version_[top.corner]) continue;
            version_[top.corner] = 0;
            return top.corner;
        }
    }
    VoronoiEdge edge(std::uint32_t p, std::uint32_t q, double s, double t) const {
        const glm::dvec2 side = corners_[q] - corners_[p];
        const double length = glm::length(side);
        return {0.5 * (corners_[p] + corners_[q]), glm::dvec2(-side.y, side.x) / length, 0.5 * length, std::min(s, t),
                std::max(s, t)};
    }

    std::span<const glm::dvec2> corners_;
    Vector<std::uint32_t> before_, after_, version_;
    Vector<double> known_;  // where the edge of corner i and its successor comes from; hull edges from infinity
    std::priority_queue<Candidate, Vector<Candidate>> heap_;
    std::uint32_t root_ = 0;
};

}  // namespace

Vector<VoronoiEdge> farthest_voronoi(std::span<const glm::dvec2> corners) {
    return Ring(corners).diagram();
}

}  // namespace crofton::study
