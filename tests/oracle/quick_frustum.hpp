// SPDX-License-Identifier: MIT
// The answers of exact_frustum.hpp by checked proofs (feasible.hpp), and by elimination only where none is found.
#pragma once
#include <oracle/exact_frustum.hpp>
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
Number reach(const Row<Number>& row) {
    return Number(abs(row.normal[0]) + abs(row.normal[1]) + abs(row.normal[2]));
}

inline bool is_rejected_by_a_plane(const Frustum& frustum, const Obb& box) {
    for (const Plane& plane : frustum.view()) {
        const bool outside = decide([&]<class Number>() {
            const auto row = row_of<Number>(frustum, plane, box);
            return sgn(Number(row.offset + reach(row))) < 0;
        });
        if (outside) return true;
    }
    return false;
}
inline bool is_inside(const Frustum& frustum, const Obb& box) {
    for (const Plane& plane : frustum.view()) {
        const bool inside = decide([&]<class Number>() {
            const auto row = row_of<Number>(frustum, plane, box);
            return sgn(Number(row.offset - reach(row))) >= 0;
        });
        if (!inside) return false;
    }
    return true;
}

inline bool meets(const Frustum& frustum, const Obb& box) {
    const auto proof = proven_feasible([&]<class Number>() {
        std::vector<Row<Number>> rows;
        rows.reserve(6 + frustum.plane_count);
        for (std::size_t k = 0; k < 3; ++k)
            for (const double side : {-1.0, 1.0}) {
                rows.push_back({{Number(0.0), Number(0.0), Number(0.0)}, Number(1.0)});
                rows.back().normal[k] = Number(side);
            }
        for (const Plane& plane : frustum.view()) rows.push_back(row_of<Number>(frustum, plane, box));
        return rows;
    });
    return proof ? *proof : oracle::meets(frustum, box);
}

inline cull::Verdict classify(const Frustum& frustum, const Obb& box) {
    if (is_inside(frustum, box)) return cull::Verdict::inside;
    return meets(frustum, box) ? cull::Verdict::straddling : cull::Verdict::outside;
}

// Of the points a + u (b − a) + v (c − a) of a triangle, whose third unknown is held at 0.
template <class Number>
std::vector<Row<Number>> rows_of_triangle() {
    const Number zero(0.0), one(1.0), minus_one(-1.0);
    return {{{one, zero, zero}, zero},
            {{zero, one, zero}, zero},
            {{minus_one, minus_one, zero}, one},
            {{zero, zero, minus_one}, zero},
            {{zero, zero, one}, zero}};
}

inline bool meets(const Frustum& frustum, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const auto proof = proven_feasible([&]<class Number>() {
        auto rows = rows_of_triangle<Number>();
        for (const Plane& plane : frustum.view()) {
            const Vec3<Number> normal = vector_of<Number>(plane.normal), from = vector_of<Number>(a);
            rows.push_back({{Number(dot(normal, minus(vector_of<Number>(b), from))),
                             Number(dot(normal, minus(vector_of<Number>(c), from))), Number(0.0)},
                            plane_value<Number>(frustum, plane, a)});
        }
        return rows;
    });
    return proof ? *proof : oracle::meets(frustum, a, b, c);
}

}  // namespace crofton::oracle::quick
