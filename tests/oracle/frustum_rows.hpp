// SPDX-License-Identifier: MIT
// A frustum and a box as linear inequalities in the coordinates along the box's half edges.
#pragma once
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <oracle/feasible.hpp>

namespace crofton::oracle::quick {

template <class Number>
Number plane_value(const Frustum& frustum, const Plane& plane, const glm::dvec3& x) {
    const Vec3<Number> from_origin = minus(vector_of<Number>(x), vector_of<Number>(frustum.origin));
    return Number(dot(vector_of<Number>(plane.normal), from_origin) + Number(plane.offset));
}

// In coordinates along the box's half edges.
template <class Number>
Row<Number> row_of(const Frustum& frustum, const Plane& plane, const Obb& box) {
    Row<Number> row;
    for (int k = 0; k < 3; ++k)
        row.normal[std::size_t(k)] =
            dot(vector_of<Number>(plane.normal), vector_of<Number>(box.axes[k])) * Number(double(box.half_extents[k]));
    row.offset = plane_value<Number>(frustum, plane, box.center);
    return row;
}
template <class Number>
Row<Number> row_of(const Frustum& frustum, const Plane& plane, const Aabb& box) {
    const Number half(0.5);
    Row<Number> row;
    for (std::size_t k = 0; k < 3; ++k) {
        const Number low(box.min[static_cast<int>(k)]), high(box.max[static_cast<int>(k)]);
        row.normal[k] = half * Number(plane.normal[static_cast<int>(k)]) * (high - low);
    }
    row.offset = half * (plane_value<Number>(frustum, plane, box.min) + plane_value<Number>(frustum, plane, box.max));
    return row;
}

// What a common point of both must keep.
template <class Number, class Box>
std::vector<Row<Number>> rows_of_box(const Frustum& frustum, const Box& box) {
    std::vector<Row<Number>> rows;
    rows.reserve(6 + frustum.plane_count);
    for (std::size_t k = 0; k < 3; ++k)
        for (const double side : {-1.0, 1.0}) {
            rows.push_back({{Number(0.0), Number(0.0), Number(0.0)}, Number(1.0)});
            rows.back().normal[k] = Number(side);
        }
    for (const Plane& plane : frustum.view()) rows.push_back(row_of<Number>(frustum, plane, box));
    return rows;
}

}  // namespace crofton::oracle::quick
