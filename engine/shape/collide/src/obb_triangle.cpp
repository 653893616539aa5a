// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/geometry/expansion.hpp>
#include <glm/geometric.hpp>
#include <limits>

// A box and a triangle are apart iff one of 13 axes says so. The facets of their difference body are spanned by two
// edges of the box, two of the triangle, or one of each. Zero extents and triangles without area follow by continuity,
// as in obb_obb.cpp. The half-space needs one axis, its normal.
namespace crofton::collide {
namespace {

struct BoxEdges {
    glm::dvec3 edge[3];
    double half[3];
    explicit BoxEdges(const Obb& box) {
        for (int k = 0; k < 3; ++k) {
            edge[k] = glm::dvec3(box.axes[k]);
            half[k] = static_cast<double>(box.half_extents[k]);
        }
    }
};

template <std::size_t N>
using Exact3 = std::array<Expansion<N>, 3>;

Exact3<2> exact_offset(const glm::dvec3& from, const glm::dvec3& to) {
    return {exact_difference(to.x, from.x), exact_difference(to.y, from.y), exact_difference(to.z, from.z)};
}

Exact3<1> exact_vector(const glm::dvec3& v) {
    return {exact(v.x), exact(v.y), exact(v.z)};
}

template <std::size_t N, std::size_t M>
Exact3<4 * N * M> exact_cross(const Exact3<N>& u, const Exact3<M>& v) {
    const auto component = [&](std::size_t i, std::size_t j) { return u[i] * v[j] - u[j] * v[i]; };
    return {component(1, 2), component(2, 0), component(0, 1)};
}

template <std::size_t N>
Expansion<N> magnitude(const Expansion<N>& e) {
    return e.sign() < 0 ? -e : e;
}

// Whether all of the triangle lies strictly beyond the box along n, on one side.
template <std::size_t N>
bool separates_exactly(const Exact3<N>& n, const BoxEdges& box, const glm::dvec3& center, const Triangle& t) {
    const auto projected_half = [&](int k) {
        const glm::dvec3& g = box.edge[k];
        return magnitude((n[0] * g.x + n[1] * g.y + n[2] * g.z) * box.half[k]);
    };
    const auto projected_radius = (projected_half(0) + projected_half(1)) + projected_half(2);
    bool above = true, below = true;
    for (const glm::dvec3& p : t) {
        const Exact3<2> w = exact_offset(center, p);
        const auto along = n[0] * w[0] + n[1] * w[1] + n[2] * w[2];
        above = above && (along - projected_radius).sign() > 0;
        below = below && (along + projected_radius).sign() < 0;
    }
    return above || below;
}

enum class Answer : std::uint8_t { separated, overlapping, unknown };

// u × v with each factor rounded at most once: components are off by at most 4 · 2^-53 of `magnitude`; the projections
// add six roundings, the projected radius seven. 2^-48 of magnitude · (|offsets| + radius) covers them three times
// over.
Answer filter(const glm::dvec3& u, const glm::dvec3& v, const BoxEdges& box, const glm::dvec3 (&offset)[3],
              const glm::dvec3& size) {
    const glm::dvec3 n = glm::cross(u, v);
    const glm::dvec3 a = glm::abs(u), b = glm::abs(v);
    const glm::dvec3 terms(a.y * b.z + a.z * b.y, a.z * b.x + a.x * b.z, a.x * b.y + a.y * b.x);
    double projected_radius = 0.0;
    for (int k = 0; k < 3; ++k) projected_radius += box.half[k] * std::abs(glm::dot(box.edge[k], n));
    const double error = 0x1p-48 * glm::dot(terms, size) + 1e-290;
    const double p = glm::dot(offset[0], n), q = glm::dot(offset[1], n), r = glm::dot(offset[2], n);
    const double gap = std::max(std::min({p, q, r}) - projected_radius, -projected_radius - std::max({p, q, r}));
    if (gap > error) return Answer::separated;
    return gap < -error ? Answer::overlapping : Answer::unknown;
}

}  // namespace

bool intersects(const Obb& obb, const Triangle& t) {
    const BoxEdges box(obb);
    glm::dvec3 offset[3], size(0.0), edge[3];
    for (std::size_t k = 0; k < 3; ++k) {
        offset[k] = t[k] - obb.center;
        edge[k] = t[(k + 1) % 3] - t[k];
        size = glm::max(size, glm::abs(offset[k]));
    }
    for (int k = 0; k < 3; ++k) size += box.half[k] * glm::abs(box.edge[k]);
    const glm::dvec3 sum = offset[0] + offset[1] + offset[2];
    if (!(std::abs(sum.x) + std::abs(sum.y) + std::abs(sum.z) + size.x + size.y + size.z <
          std::numeric_limits<double>::infinity()))
        return false;
    std::uint32_t unknown = 0;
    const auto ask = [&](const glm::dvec3& u, const glm::dvec3& v, std::uint32_t bit) {
        const Answer answer = filter(u, v, box, offset, size);
        if (answer == Answer::unknown) unknown |= 1u << bit;
        return answer == Answer::separated;
    };
    for (std::uint32_t k = 0; k < 3; ++k)
        if (ask(box.edge[(k + 1) % 3], box.edge[(k + 2) % 3], k)) return false;
    if (ask(edge[0], edge[1], 3)) return false;
    for (std::uint32_t i = 0; i < 3; ++i)
        for (std::uint32_t j = 0; j < 3; ++j)
            if (ask(box.edge[i], edge[j], 4 + 3 * i + j)) return false;
    for (std::uint32_t k = 0; k < 3; ++k)
        if ((unknown >> k & 1u) &&
            separates_exactly(exact_cross(exact_vector(box.edge[(k + 1) % 3]), exact_vector(box.edge[(k + 2) % 3])),
                              box, obb.center, t))
            return false;
    if ((unknown >> 3 & 1u) &&
        separates_exactly(exact_cross(exact_offset(t[0], t[1]), exact_offset(t[1], t[2])), box, obb.center, t))
        return false;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            if ((unknown >> (4 + 3 * i + j) & 1u) &&
                separates_exactly(exact_cross(exact_vector(box.edge[i]), exact_offset(t[j], t[(j + 1) % 3])), box,
                                  obb.center, t))
                return false;
    return true;
}

bool intersects(const Obb& box, const Plane& half_space) {
    const BoxEdges edges(box);
    const glm::dvec3& n = half_space.normal;
    double projected_radius = 0.0, size = std::abs(half_space.offset) + glm::dot(glm::abs(n), glm::abs(box.center));
    for (int k = 0; k < 3; ++k) {
        projected_radius += edges.half[k] * std::abs(glm::dot(edges.edge[k], n));
        size += edges.half[k] * glm::dot(glm::abs(edges.edge[k]), glm::abs(n));
    }
    if (!(size < std::numeric_limits<double>::infinity())) return false;
    // At most twelve roundings of 2^-53, each of a part of `size`.
    const double value = glm::dot(n, box.center) + half_space.offset + projected_radius,
                 error = 0x1p-48 * size + 1e-290;
    if (value > error) return true;
    if (value < -error) return false;
    const auto projected_half = [&](int k) {
        const glm::dvec3& g = edges.edge[k];
        return magnitude((exact_product(n.x, g.x) + exact_product(n.y, g.y) + exact_product(n.z, g.z)) * edges.half[k]);
    };
    const auto center = exact_product(n.x, box.center.x) + exact_product(n.y, box.center.y) +
                        exact_product(n.z, box.center.z) + exact(half_space.offset);
    return (center + (projected_half(0) + projected_half(1) + projected_half(2))).sign() >= 0;
}

}  // namespace crofton::collide
