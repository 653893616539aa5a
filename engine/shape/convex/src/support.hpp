// SPDX-License-Identifier: MIT
// The farthest point of a shape's core along a direction, in its own frame.
#pragma once
#include <cmath>
#include <crofton/convex/shape.hpp>
#include <crofton/core/extensions.hpp>
#include <cstring>
#include <glm/geometric.hpp>

namespace crofton::convex {

#if defined(CROFTON_COMPILER_VECTORS)
// The compilers' own vectors: operations are single roundings on every machine.
using Lanes2 = double __attribute__((vector_size(16)));

// b where either is NaN.
[[nodiscard]] inline Lanes2 larger(Lanes2 a, Lanes2 b) {
    return a > b ? a : b;
}
#else
struct Lanes2 {
    double lane[2];
    double operator[](int i) const { return lane[i]; }
    friend Lanes2 operator+(const Lanes2& a, const Lanes2& b) {
        return {{a.lane[0] + b.lane[0], a.lane[1] + b.lane[1]}};
    }
    friend Lanes2 operator*(const Lanes2& a, const Lanes2& b) {
        return {{a.lane[0] * b.lane[0], a.lane[1] * b.lane[1]}};
    }
};
[[nodiscard]] inline Lanes2 larger(const Lanes2& a, const Lanes2& b) {
    return {{a.lane[0] > b.lane[0] ? a.lane[0] : b.lane[0], a.lane[1] > b.lane[1] ? a.lane[1] : b.lane[1]}};
}
#endif

// From numbers that are aligned as such alone: clang loads a vector type of a lesser alignment as an aligned one.
[[nodiscard]] inline Lanes2 load2(const double* from) {
    Lanes2 lanes;
    std::memcpy(&lanes, from, sizeof lanes);
    return lanes;
}

struct Support {
    glm::dvec3 point;
    int vertex;    // of a polytope, else 0
    double along;  // dot(point, direction)
};

// As farthest_of(), by the widest vectors that there are: for more points than a call costs.
[[nodiscard]] int farthest_of_many(const double* x, const double* y, const double* z, int count, const glm::dvec3& d,
                                   double& most);

// The first of the points, given by their coordinates, that is farthest along d. `count` is a multiple of four. NaN
// directions give 0.
[[nodiscard]] inline int farthest_of(const double* x, const double* y, const double* z, int count, const glm::dvec3& d,
                                     double& most) {
    if (count > 12) return farthest_of_many(x, y, z, count, d, most);
    alignas(16) double along[12];
    const Lanes2 dx{d.x, d.x}, dy{d.y, d.y}, dz{d.z, d.z};
    const auto value = [&](int i) {
        const Lanes2 v = (dx * load2(x + i) + dy * load2(y + i)) + dz * load2(z + i);
        std::memcpy(along + i, &v, sizeof v);
        return v;
    };
    Lanes2 high = value(0), high2 = value(2);
    for (int i = 4; i < count; i += 4) {
        const Lanes2 v = value(i), w = value(i + 2);
        high = larger(v, high);
        high2 = larger(w, high2);
    }
    high = larger(high2, high);
    most = (high[1] > high[0] ? high[1] : high[0]) + 0.0;  // 0 has one sign, whichever vectors found it
    for (int i = 0; i < count; ++i)
        if (along[i] == most) return i;
    return 0;
}

[[nodiscard]] inline Support farthest_vertex(const Shape& shape, const glm::dvec3& d) {
    double along = 0.0;
    const int vertex = farthest_of(shape.column(0), shape.column(1), shape.column(2), shape.padded_count(), d, along);
    return {shape.vertex(vertex), vertex, along};
}

[[nodiscard]] inline Support farthest_round(const Shape& shape, const glm::dvec3& d) {
    const double radius = shape.half_extents().x, height = shape.half_extents().y;
    const double across = std::sqrt(d.x * d.x + d.z * d.z);
    const glm::dvec3 rim =
        across > 0.0 ? glm::dvec3(radius * (d.x / across), 0.0, radius * (d.z / across)) : glm::dvec3(radius, 0.0, 0.0);
    glm::dvec3 point = rim;
    if (shape.kind() == Kind::cylinder)
        point.y = d.y >= 0.0 ? height : -height;
    else if (height * d.y > radius * across - height * d.y)
        point = {0.0, height, 0.0};
    else
        point.y = -height;
    return {point, 0, glm::dot(point, d)};
}

[[nodiscard]] inline Support core_support(const Shape& shape, const glm::dvec3& direction) {
    if (shape.kind() == Kind::box) {
        const glm::dvec3& h = shape.half_extents();
        const int x = direction.x >= 0.0, y = direction.y >= 0.0, z = direction.z >= 0.0;
        const glm::dvec3 point(x != 0 ? h.x : -h.x, y != 0 ? h.y : -h.y, z != 0 ? h.z : -h.z);
        return {point, x + 2 * y + 4 * z, glm::dot(point, direction)};
    }
    return shape.has_polytope_core() ? farthest_vertex(shape, direction) : farthest_round(shape, direction);
}

}  // namespace crofton::convex
