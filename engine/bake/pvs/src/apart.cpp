// SPDX-License-Identifier: MIT
#include "apart.hpp"

#include <array>
#include <cstddef>
#include <glm/geometric.hpp>
#include <limits>

namespace crofton::pvs {
namespace {

constexpr int kMaxSteps = 8;
constexpr double kNoProgress = 1e-7;  // of the squared distance

struct DifferenceSimplex {
    std::array<glm::dvec3, 4> points{};
    std::size_t count = 0;
};

struct Nearest {
    double squared = std::numeric_limits<double>::infinity();
    glm::dvec3 point{0.0};
    DifferenceSimplex on;  // the corners it lies between

    void offer(const glm::dvec3& p, std::initializer_list<glm::dvec3> corners) {
        const double now = glm::dot(p, p);
        if (!(now < squared)) return;
        squared = now;
        point = p;
        on.count = 0;
        for (const glm::dvec3& corner : corners) on.points[on.count++] = corner;
    }
};

void offer_segment(const glm::dvec3& a, const glm::dvec3& b, Nearest& best) {
    const glm::dvec3 along = b - a;
    const double t = -glm::dot(a, along), length2 = glm::dot(along, along);
    if (t > 0.0 && t < length2) best.offer(a + t / length2 * along, {a, b});
}

void offer_triangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, Nearest& best) {
    const glm::dvec3 n = glm::cross(b - a, c - a);
    const double length2 = glm::dot(n, n);
    if (!(length2 > 0.0) || glm::dot(glm::cross(n, b - a), a) > 0.0 || glm::dot(glm::cross(n, c - b), b) > 0.0 ||
        glm::dot(glm::cross(n, a - c), c) > 0.0)
        return;
    best.offer(glm::dot(n, a) / length2 * n, {a, b, c});
}

// True if the origin is on the same side of each face as the corner across from it.
bool holds_origin(const std::array<glm::dvec3, 4>& p) {
    for (std::size_t k = 0; k < 4; ++k) {
        const glm::dvec3 &a = p[(k + 1) % 4], &b = p[(k + 2) % 4], &c = p[(k + 3) % 4];
        const glm::dvec3 n = glm::cross(b - a, c - a);
        if (!(glm::dot(n, p[k] - a) * glm::dot(n, -a) > 0.0)) return false;
    }
    return true;
}

// The point of a simplex that is nearest to the origin. Plain: of all corners, sides and faces.
Nearest nearest_of(const DifferenceSimplex& simplex) {
    Nearest best;
    const auto& p = simplex.points;
    for (std::size_t i = 0; i < simplex.count; ++i) {
        best.offer(p[i], {p[i]});
        for (std::size_t j = i + 1; j < simplex.count; ++j) {
            offer_segment(p[i], p[j], best);
            for (std::size_t k = j + 1; k < simplex.count; ++k) offer_triangle(p[i], p[j], p[k], best);
        }
    }
    return best;
}

}  // namespace

bool are_apart(std::span<const glm::dvec3> a, std::span<const glm::dvec3> b, double gap, glm::dvec3& axis) {
    DifferenceSimplex simplex;
    glm::dvec3 v = axis;  // from b to a
    if (!(glm::dot(v, v) > 0.0)) v = a[0] - b[0];
    if (!(glm::dot(v, v) > 0.0)) v = glm::dvec3(1.0, 0.0, 0.0);
    double nearest = std::numeric_limits<double>::infinity();
    for (int step = 0; step < kMaxSteps; ++step) {
        double low = std::numeric_limits<double>::infinity(), high = -low;
        std::size_t of_a = 0, of_b = 0;
        for (std::size_t i = 0; i < a.size(); ++i)
            if (const double x = glm::dot(v, a[i]); x < low) low = x, of_a = i;
        for (std::size_t i = 0; i < b.size(); ++i)
            if (const double x = glm::dot(v, b[i]); x > high) high = x, of_b = i;
        const double room = low - high, length2 = glm::dot(v, v);
        if (room > 0.0 && room * room > gap * gap * length2) {
            axis = v;
            return true;
        }
        if (simplex.count > 0 && length2 - room <= kNoProgress * length2) return false;
        if (simplex.count == 4) return false;
        simplex.points[simplex.count++] = a[of_a] - b[of_b];
        if (simplex.count == 4 && holds_origin(simplex.points)) return false;
        const Nearest found = nearest_of(simplex);
        if (!(found.squared < nearest) || found.squared <= gap * gap) return false;
        nearest = found.squared;
        v = found.point;
        simplex = found.on;
    }
    return false;
}

}  // namespace crofton::pvs
