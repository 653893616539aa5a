// SPDX-License-Identifier: MIT
// Distances of needles, a million times as long as wide, between bounds found in long double.
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/collide/bound_contacts.hpp>
#include <crofton/collide/narrow_phase.hpp>
#include <limits>
#include <vector>

#include "random_boxes.hpp"

using namespace crofton;
using namespace crofton::collide;
using namespace crofton::testing;

namespace {

using Long3 = glm::vec<3, long double, glm::highp>;

// The differences of two boxes' points: offset + Σ t_k edge_k, t_k in [−1, 1]. A capsule's segment is a box with one
// edge. All of the numbers are exact but for the offset of the centers, which is rounded once.
class Difference {
  public:
    Difference(const Obb& a, const Obb& b) : offset_(Long3(b.center) - Long3(a.center)) {
        add(a);
        add(b);
    }
    Difference(const Obb& a, const glm::dvec3& begin, const glm::dvec3& end)
        : offset_(0.5L * (Long3(begin) + Long3(end)) - Long3(a.center)) {
        add(a);
        edges_.push_back(0.5L * (Long3(end) - Long3(begin)));
    }
    [[nodiscard]] long double size() const {
        long double sum = glm::length(offset_);
        for (const Long3& edge : edges_) sum += glm::length(edge);
        return sum;
    }
    // The gap of the slabs across `direction`: no distance is below it.
    [[nodiscard]] long double gap_along(const Long3& direction) const {
        long double gap = glm::dot(direction, offset_);
        for (const Long3& edge : edges_) gap -= std::abs(glm::dot(direction, edge));
        return gap / glm::length(direction);
    }
    // The nearest of all corners, of the feet on all edges' lines and on all faces' planes that lie within.
    void find_bounds() {
        values_.assign(edges_.size(), 0.0L);
        choose(0, {});
        for (std::size_t i = 0; i < edges_.size(); ++i)
            for (std::size_t j = 0; j < i; ++j) {
                const Long3 across = glm::cross(edges_[i], edges_[j]);
                if (glm::length(across) > 0.0L)
                    for (const long double sign : {-1.0L, 1.0L}) lower_ = std::max(lower_, gap_along(sign * across));
            }
    }
    [[nodiscard]] long double lower() const { return lower_; }
    [[nodiscard]] long double upper() const { return upper_; }

  private:
    void add(const Obb& box) {
        for (int k = 0; k < 3; ++k)
            if (box.half_extents[k] > 0.0f)
                edges_.push_back(Long3(box.axes[k]) * static_cast<long double>(box.half_extents[k]));
    }
    void choose(std::size_t edge, const std::vector<std::size_t>& free) {
        if (edge == edges_.size()) return take(free);
        for (const long double end : {-1.0L, 1.0L}) {
            values_[edge] = end;
            choose(edge + 1, free);
        }
        if (free.size() == 2) return;
        std::vector<std::size_t> more = free;
        more.push_back(edge);
        choose(edge + 1, more);
    }
    void take(const std::vector<std::size_t>& free) {
        for (const std::size_t edge : free) values_[edge] = 0.0L;
        const Long3 rest = way();
        if (free.size() == 1) {
            const Long3& u = edges_[free[0]];
            values_[free[0]] = -glm::dot(rest, u) / glm::dot(u, u);
        } else if (free.size() == 2) {
            const Long3 &u = edges_[free[0]], &v = edges_[free[1]], n = glm::cross(u, v);
            const long double squared = glm::dot(n, n);
            if (!(squared > 0.0L)) return;
            values_[free[0]] = -glm::dot(glm::cross(rest, v), n) / squared;
            values_[free[1]] = glm::dot(glm::cross(rest, u), n) / squared;
        }
        for (const std::size_t edge : free) values_[edge] = std::clamp(values_[edge], -1.0L, 1.0L);
        const Long3 found = way();
        const long double length = glm::length(found);
        if (length > upper_) return;
        upper_ = length;
        if (length > 0.0L) lower_ = std::max(lower_, gap_along(found));
    }
    [[nodiscard]] Long3 way() const {
        Long3 sum = offset_;
        for (std::size_t i = 0; i < edges_.size(); ++i) sum += values_[i] * edges_[i];
        return sum;
    }

    Long3 offset_;
    std::vector<Long3> edges_;
    std::vector<long double> values_;
    long double lower_ = -std::numeric_limits<long double>::infinity(),
                upper_ = std::numeric_limits<long double>::infinity();
};

// Half of the boxes are needles, the others have any form. Directions are close to each other in half of the pairs.
struct NeedlePair {
    Obb a, b;
};
NeedlePair needle_pair(std::mt19937_64& random) {
    const auto form = [&](Obb& box) {
        const int kind = static_cast<int>(random() % 4);
        for (int k = 0; k < 3; ++k) {
            if (kind < 2) box.half_extents[k] *= k == kind ? 1e6f : 1.0f;  // needle
            if (kind == 2) box.half_extents[k] *= k == 0 ? 1.0f : 1e6f;    // plate
        }
    };
    NeedlePair pair{random_box(random), random_box(random)};
    form(pair.a);
    form(pair.b);
    if (random() % 2) {
        const double angle = std::pow(10.0, -1.0 - double(random() % 8));
        const glm::dmat3 turn(glm::mat3_cast(glm::angleAxis(angle, glm::normalize(random_vector(random)))));
        pair.b.axes = glm::mat3(turn * glm::dmat3(pair.a.axes));
    }
    const glm::dvec3 direction = glm::normalize(random_vector(random));
    const double touch = touching_distance(pair.a, pair.b, direction);
    const double size = double(glm::length(pair.a.half_extents)) + double(glm::length(pair.b.half_extents));
    const double gap = std::pow(10.0, -double(random() % 13)) * (random() % 4 ? 1.0 : -1.0);
    pair.a.center *= random() % 2 ? 1.0 : 1e7;
    pair.b.center = pair.a.center + (touch + gap * size) * direction;
    return pair;
}

struct Misses {
    int distances = 0, points = 0, verdicts = 0, unproven = 0, apart = 0;
    double worst = 0.0;
};

void compare(const Distance& d, bool meet, double radius, Difference truth, Misses& misses) {
    truth.find_bounds();
    const long double size = truth.size() + radius, slack = 1e-12L * size;
    if (!(truth.upper() - std::max(truth.lower(), 0.0L) <= 1e-14L * size) && !meet) ++misses.unproven;
    const long double lower = std::max(0.0L, truth.lower() - radius), upper = std::max(0.0L, truth.upper() - radius);
    misses.verdicts += (d.distance == 0.0) != meet;
    misses.apart += !meet;
    const long double off = std::max(lower - d.distance, d.distance - upper);
    misses.worst = std::max(misses.worst, static_cast<double>(off / size));
    if (!meet) misses.distances += off > slack;
    misses.points +=
        std::abs(glm::distance(d.on_a, d.on_b) - d.distance) > 1e-12 * double(size) + 1e-15 * glm::length(d.on_a);
}

}  // namespace

TEST_SUITE("collide/needle distance") {
    TEST_CASE("boxes a million times as long or as broad as wide: within 1e-12 of the size") {
        std::mt19937_64 random(71);
        Misses misses;
        for (int i = 0; i < 20000; ++i) {
            const auto [a, b] = needle_pair(random);
            compare(distance(a, b), intersects(a, b), 0.0, Difference(a, b), misses);
        }
        CHECK(misses.apart > 8000);
        CHECK(misses.distances == 0);
        CHECK(misses.points == 0);
        CHECK(misses.verdicts == 0);
        CHECK(misses.unproven < 20);
    }

    TEST_CASE("a capsule a million times as long as wide and boxes: within 1e-12 of the size") {
        std::mt19937_64 random(72);
        Misses misses;
        for (int i = 0; i < 20000; ++i) {
            const auto [a, b] = needle_pair(random);
            const int axis = static_cast<int>(random() % 3);
            const glm::dvec3 half = glm::dvec3(b.axes[axis]) * double(b.half_extents[axis]);
            const Capsule capsule{b.center - half, b.center + half, random() % 2 ? 0.0 : 1.0};
            compare(distance(a, capsule), intersects(a, capsule), capsule.radius,
                    Difference(a, capsule.begin, capsule.end), misses);
        }
        CHECK(misses.apart > 8000);
        CHECK(misses.distances == 0);
        CHECK(misses.points == 0);
        CHECK(misses.verdicts == 0);
        CHECK(misses.unproven < 20);
    }
}
