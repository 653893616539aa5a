// SPDX-License-Identifier: MIT
#include "exact_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "exact_numbers.hpp"

namespace crofton::cli {
namespace {

using convex::ShapeAtPose;
using ExactVector = oracle::Vec3<Dyadic>;

glm::dvec3 rounded(const ExactVector& a) {
    const auto value = [](const Dyadic& x) {
        return x.sign() == 0 ? 0.0 : std::ldexp(x.scaled(x.exponent()), x.exponent());
    };
    return {value(a[0]), value(a[1]), value(a[2])};
}

// 1 where all points lie on or below the plane through w[i] across n, −1 on or above, 0 on both sides.
int side_of(const std::vector<ExactVector>& w, std::size_t i, const ExactVector& n) {
    const Dyadic level = oracle::dot(n, w[i]);
    bool above = false, below = false;
    for (const ExactVector& p : w) {
        const int side = (oracle::dot(n, p) - level).sign();
        above = above || side > 0;
        below = below || side < 0;
        if (above && below) return 0;
    }
    return above ? -1 : 1;
}

// Rounded points that are clearly on both sides of the plane through three of them.
bool is_clearly_inside(const std::vector<glm::dvec3>& w, std::size_t i, const glm::dvec3& n, double margin) {
    bool above = false, below = false;
    for (const glm::dvec3& p : w) {
        const double side = glm::dot(n, p - w[i]);
        above = above || side > margin;
        below = below || side < -margin;
        if (above && below) return true;
    }
    return false;
}

}  // namespace

bool meet_exactly(const ShapeAtPose& a, const ShapeAtPose& b, const glm::dvec3& normal, const ExactWay& way_of_b) {
    // Guesses are made near a's origin, where coordinates are small.
    const RigidTransform near_a{a.pose.rotation, glm::dvec3(0.0)};
    const RigidTransform near_b{b.pose.rotation,
                                (b.pose.translation - a.pose.translation) + way_of_b.time * way_of_b.velocity};
    const convex::Distance d = convex::distance({a.shape, near_a}, {b.shape, near_b});
    const convex::Penetration p = convex::penetration({a.shape, near_a}, {b.shape, near_b});
    const std::vector<glm::dvec3> normals{normal, d.normal};
    const std::vector<glm::dvec3> points{0.5 * (p.on_a + p.on_b), 0.5 * (d.on_a + d.on_b)};
    return oracle::decide_by<Dyadic>(
        [&]<class Number>() { return oracle::meet_in<Number>(a, b, normals, points, way_of_b); });
}

bool is_parted_by(const ShapeAtPose& a, const ShapeAtPose& b, const glm::dvec3& normal) {
    const glm::dvec3& origin = a.pose.translation;
    return oracle::decide_by<Dyadic>([&]<class Number>() {
        const int answer = oracle::parts(oracle::polytope<Number>(a, origin), oracle::polytope<Number>(b, origin),
                                         oracle::vector_of<Number>(normal));
        if (answer == oracle::kUnknown) throw oracle::Undecided{};
        return answer == 1;
    });
}

bool depth_lies_between(const ShapeAtPose& a, const ShapeAtPose& b, double lower, double upper) {
    const glm::dvec3& origin = a.pose.translation;
    const auto of_a = oracle::polytope<Dyadic>(a, origin), of_b = oracle::polytope<Dyadic>(b, origin);
    std::vector<ExactVector> w;
    std::vector<glm::dvec3> about;
    for (const ExactVector& p : of_a.points)
        for (const ExactVector& q : of_b.points) about.push_back(rounded(w.emplace_back(oracle::minus(p, q))));
    double size = 0.0;
    for (const glm::dvec3& p : about) size = std::max(size, glm::length(p));
    const Dyadic low = Dyadic(lower) * Dyadic(lower), high = Dyadic(upper) * Dyadic(upper);
    bool reached = false;
    for (std::size_t i = 0; i < w.size(); ++i)
        for (std::size_t j = i + 1; j < w.size(); ++j)
            for (std::size_t k = j + 1; k < w.size(); ++k) {
                const glm::dvec3 guess = glm::cross(about[j] - about[i], about[k] - about[i]);
                if (is_clearly_inside(about, i, guess, 1e-12 * size * size * size)) continue;
                const ExactVector n = oracle::cross(oracle::minus(w[j], w[i]), oracle::minus(w[k], w[i]));
                if ((n[0].sign() | n[1].sign() | n[2].sign()) == 0 || side_of(w, i, n) == 0) continue;
                // The face's distance from the origin, squared, is level² / |n|².
                const Dyadic level = oracle::dot(n, w[i]), squared = oracle::dot(n, n);
                if ((low * squared - level * level).sign() > 0) return false;
                reached = reached || (level * level - high * squared).sign() <= 0;
            }
    return reached;
}

}  // namespace crofton::cli
