// SPDX-License-Identifier: MIT
// Oracle: do two boxes meet, in any kind of number that knows its sign.
#pragma once
#include <array>
#include <crofton/geometry/box.hpp>
#include <oracle/tracked_numbers.hpp>

namespace crofton::oracle {

// The separating-axis theorem for the zonotope of the six scaled edges.
template <class Number>
bool boxes_meet_by_axes(const Obb& a, const Obb& b) {
    std::array<Vec3<Number>, 6> edge;
    std::array<Number, 6> half;
    for (int k = 0; k < 6; ++k) {
        const Obb& box = k < 3 ? a : b;
        edge[std::size_t(k)] = vector_of<Number>(box.axes[k % 3]);
        half[std::size_t(k)] = Number(double(box.half_extents[k % 3]));
    }
    const Vec3<Number> offset = minus(vector_of<Number>(b.center), vector_of<Number>(a.center));
    for (std::size_t p = 0; p < 6; ++p)
        for (std::size_t q = p + 1; q < 6; ++q) {
            const Vec3<Number> n = cross(edge[p], edge[q]);
            Number projected_radius(0.0);
            for (std::size_t k = 0; k < 6; ++k)
                if (k != p && k != q)
                    projected_radius = Number(projected_radius + half[k] * abs(Number(dot(edge[k], n))));
            if (sgn(Number(abs(Number(dot(offset, n))) - projected_radius)) > 0) return false;
        }
    return true;
}

}  // namespace crofton::oracle
