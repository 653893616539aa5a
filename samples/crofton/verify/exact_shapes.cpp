// SPDX-License-Identifier: MIT
#include "exact_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace crofton::cli {
namespace {

ExactVector exact(const glm::dvec3& v) {
    return {Dyadic(v.x), Dyadic(v.y), Dyadic(v.z)};
}
ExactVector operator-(const ExactVector& a, const ExactVector& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
ExactVector negative(const ExactVector& a) {
    return {-a[0], -a[1], -a[2]};
}
Dyadic dot_of(const ExactVector& a, const ExactVector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
ExactVector cross_of(const ExactVector& a, const ExactVector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
glm::dvec3 rounded(const ExactVector& a) {
    const auto value = [](const Dyadic& x) {
        return x.sign() == 0 ? 0.0 : std::ldexp(x.scaled(x.exponent()), x.exponent());
    };
    return {value(a[0]), value(a[1]), value(a[2])};
}

// Whether all of b lies beyond all of a along n.
bool parts(const ExactShape& a, const ExactShape& b, const ExactVector& n) {
    Dyadic most = dot_of(n, a.points[0]);
    for (const ExactVector& p : a.points)
        if (const Dyadic v = dot_of(n, p); (v - most).sign() > 0) most = v;
    for (const ExactVector& p : b.points)
        if ((dot_of(n, p) - most).sign() <= 0) return false;
    return true;
}

ExactVector normal_of(const ExactShape& shape, const std::array<std::size_t, 3>& t) {
    const ExactVector& p = shape.points[t[0]];
    return cross_of(shape.points[t[1]] - p, shape.points[t[2]] - p);
}

bool is_flat(const ExactShape& shape) {
    return shape.points.size() == 3;
}

// Returns false for a triangle without area, so that the axes decide.
bool triangle_contains(const ExactShape& shape, const ExactVector& x) {
    const ExactVector n = normal_of(shape, shape.triangles[0]);
    if ((n[0].sign() | n[1].sign() | n[2].sign()) == 0 || dot_of(n, x - shape.points[0]).sign() != 0) return false;
    for (std::size_t i = 0; i < 3; ++i) {
        const ExactVector& p = shape.points[i];
        if (dot_of(cross_of(n, shape.points[(i + 1) % 3] - p), x - p).sign() < 0) return false;
    }
    return true;
}

bool contains(const ExactShape& shape, const ExactVector& x) {
    if (is_flat(shape)) return triangle_contains(shape, x);
    for (const auto& t : shape.triangles)
        if (dot_of(normal_of(shape, t), x - shape.points[t[0]]).sign() > 0) return false;
    return true;
}

// Whether an edge of a, a triangle, parts them: all of b lies beyond it, seen across the triangle's plane.
bool parts_in_plane(const ExactShape& a, const ExactShape& b) {
    if (!is_flat(a)) return false;
    const ExactVector n = normal_of(a, a.triangles[0]);
    for (std::size_t i = 0; i < 3; ++i) {
        const ExactVector out = cross_of(a.points[(i + 1) % 3] - a.points[i], n);
        if (parts(a, b, out)) return true;
    }
    return false;
}

// All points rounded, around the first of a, so that most axes need no exact arithmetic. Let R
// be above all coordinates. Each is off by at most 2^-53 R, an axis by 16 · 2^-53 R² and a product by 130 · 2^-53 R³.
// That is far below the margin.
class RoundedPair {
  public:
    RoundedPair(const ExactShape& a, const ExactShape& b) {
        const ExactVector& origin = a.points[0];
        for (const ExactVector& p : a.points) a_.push_back(rounded(p - origin));
        for (const ExactVector& p : b.points) b_.push_back(rounded(p - origin));
        double radius = 0.0;
        for (const auto* points : {&a_, &b_})
            for (const glm::dvec3& p : *points) radius = std::max(radius, glm::length(p));
        margin_ = 1e-12 * radius * radius * radius;
    }
    [[nodiscard]] glm::dvec3 edge(bool of_a, std::size_t from, std::size_t to) const {
        return of_a ? a_[to] - a_[from] : b_[to] - b_[from];
    }
    // Whether a reaches clearly beyond where b begins along n: then n does not part them.
    [[nodiscard]] bool surely_overlap(const glm::dvec3& n) const {
        double most = -HUGE_VAL, least = HUGE_VAL;
        for (const glm::dvec3& p : a_) most = std::max(most, glm::dot(n, p));
        for (const glm::dvec3& p : b_) least = std::min(least, glm::dot(n, p));
        return most - least > margin_;
    }

  private:
    std::vector<glm::dvec3> a_, b_;
    double margin_;
};

// The separating-axis theorem: normals of faces, products of edges; of triangles in one plane, normals of edges.
bool meet_by_axes(const ExactShape& a, const ExactShape& b) {
    if (parts_in_plane(a, b) || parts_in_plane(b, a)) return false;
    const RoundedPair about(a, b);
    const auto normal = [&](bool of_a, const std::array<std::size_t, 3>& t) {
        return glm::cross(about.edge(of_a, t[0], t[1]), about.edge(of_a, t[0], t[2]));
    };
    for (const auto& t : a.triangles)
        if (!about.surely_overlap(normal(true, t)) && parts(a, b, normal_of(a, t))) return false;
    for (const auto& t : b.triangles)
        if (!about.surely_overlap(-normal(false, t)) && parts(a, b, negative(normal_of(b, t)))) return false;
    for (const auto& s : a.triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            if (s[i] > s[(i + 1) % 3]) continue;
            const ExactVector u = a.points[s[(i + 1) % 3]] - a.points[s[i]];
            const glm::dvec3 e = about.edge(true, s[i], s[(i + 1) % 3]);
            for (const auto& t : b.triangles)
                for (std::size_t j = 0; j < 3; ++j) {
                    if (t[j] > t[(j + 1) % 3]) continue;
                    const glm::dvec3 guess = glm::cross(e, about.edge(false, t[j], t[(j + 1) % 3]));
                    if (about.surely_overlap(guess) && about.surely_overlap(-guess)) continue;
                    const ExactVector n = cross_of(u, b.points[t[(j + 1) % 3]] - b.points[t[j]]);
                    if (parts(a, b, n) || parts(a, b, negative(n))) return false;
                }
        }
    return true;
}

std::vector<std::array<std::size_t, 3>> triangles_of(const convex::Shape& shape) {
    if (shape.kind() == convex::Kind::box)
        return {{0, 4, 2}, {4, 6, 2}, {1, 3, 5}, {3, 7, 5}, {0, 1, 4}, {1, 5, 4},
                {2, 6, 3}, {6, 7, 3}, {0, 2, 1}, {2, 3, 1}, {4, 5, 6}, {5, 7, 6}};
    if (shape.hull() == nullptr) return {{0, 1, 2}, {0, 2, 1}};
    std::vector<std::array<std::size_t, 3>> result;
    const auto indices = shape.hull()->triangles();
    for (std::size_t i = 0; i < indices.size(); i += 3) result.push_back({indices[i], indices[i + 1], indices[i + 2]});
    return result;
}

// 1 where all points lie on or below the plane through w[i] across n, −1 on or above, 0 on both sides.
int side_of(const std::vector<ExactVector>& w, std::size_t i, const ExactVector& n) {
    const Dyadic level = dot_of(n, w[i]);
    bool above = false, below = false;
    for (const ExactVector& p : w) {
        const int side = (dot_of(n, p) - level).sign();
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

ExactShape::ExactShape(const convex::ShapeAtPose& placed, const ExactWay& way) : triangles(triangles_of(placed.shape)) {
    const ExactVector columns[3] = {exact(placed.pose.rotation[0]), exact(placed.pose.rotation[1]),
                                    exact(placed.pose.rotation[2])};
    ExactVector at = exact(placed.pose.translation);
    for (std::size_t c = 0; c < 3; ++c) at[c] = at[c] + Dyadic(way.velocity[static_cast<int>(c)]) * Dyadic(way.time);
    for (int i = 0; i < placed.shape.vertex_count(); ++i) {
        const ExactVector v = exact(placed.shape.vertex(i));
        ExactVector image;
        for (std::size_t c = 0; c < 3; ++c)
            image[c] = columns[0][c] * v[0] + columns[1][c] * v[1] + columns[2][c] * v[2] + at[c];
        points.push_back(image);
    }
}

bool meet_exactly(const ExactShape& a, const ExactShape& b, std::span<const glm::dvec3> normals,
                  const glm::dvec3& origin, std::span<const glm::dvec3> points, std::uint64_t& by_axes) {
    for (const glm::dvec3& n : normals)
        if (parts(a, b, exact(n))) return false;
    for (const glm::dvec3& p : points) {
        ExactVector x = exact(p);
        const ExactVector from = exact(origin);
        for (std::size_t k = 0; k < 3; ++k) x[k] = x[k] + from[k];
        if (contains(a, x) && contains(b, x)) return true;
    }
    ++by_axes;
    return meet_by_axes(a, b);
}

bool meet_exactly(const convex::ShapeAtPose& a, const convex::ShapeAtPose& b, const glm::dvec3& normal,
                  std::uint64_t& by_axes, const ExactWay& way_of_b) {
    // Guesses are made near a's origin, where coordinates are small.
    const RigidTransform near_a{a.pose.rotation, glm::dvec3(0.0)};
    const RigidTransform near_b{b.pose.rotation,
                                (b.pose.translation - a.pose.translation) + way_of_b.time * way_of_b.velocity};
    const convex::Distance d = convex::distance({a.shape, near_a}, {b.shape, near_b});
    const convex::Penetration p = convex::penetration({a.shape, near_a}, {b.shape, near_b});
    const std::array normals{normal, d.normal};
    const std::array points{0.5 * (p.on_a + p.on_b), 0.5 * (d.on_a + d.on_b)};
    return meet_exactly(ExactShape(a), ExactShape(b, way_of_b), normals, a.pose.translation, points, by_axes);
}

bool depth_lies_between(const ExactShape& a, const ExactShape& b, double lower, double upper) {
    std::vector<ExactVector> w;
    std::vector<glm::dvec3> about;
    for (const ExactVector& p : a.points)
        for (const ExactVector& q : b.points) about.push_back(rounded(w.emplace_back(p - q)));
    double size = 0.0;
    for (const glm::dvec3& p : about) size = std::max(size, glm::length(p));
    const Dyadic low = Dyadic(lower) * Dyadic(lower), high = Dyadic(upper) * Dyadic(upper);
    bool reached = false;
    for (std::size_t i = 0; i < w.size(); ++i)
        for (std::size_t j = i + 1; j < w.size(); ++j)
            for (std::size_t k = j + 1; k < w.size(); ++k) {
                const glm::dvec3 guess = glm::cross(about[j] - about[i], about[k] - about[i]);
                if (is_clearly_inside(about, i, guess, 1e-12 * size * size * size)) continue;
                const ExactVector n = cross_of(w[j] - w[i], w[k] - w[i]);
                if ((n[0].sign() | n[1].sign() | n[2].sign()) == 0 || side_of(w, i, n) == 0) continue;
                // The face's distance from the origin, squared, is level² / |n|².
                const Dyadic level = dot_of(n, w[i]), squared = dot_of(n, n);
                if ((low * squared - level * level).sign() > 0) return false;
                reached = reached || (level * level - high * squared).sign() <= 0;
            }
    return reached;
}

}  // namespace crofton::cli
