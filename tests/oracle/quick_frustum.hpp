// SPDX-License-Identifier: MIT
// The answers of exact_frustum.hpp by checked proofs (feasible.hpp), and by elimination only where none is found.
#pragma once
#include <oracle/exact_frustum.hpp>
#include <oracle/tracked.hpp>

#include <oracle/frustum_rows.hpp>  // after the numbers that it decides by

namespace crofton::oracle::quick {

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
    const auto proof = proven_feasible<Rational>([&]<class Number>() { return rows_of_box<Number>(frustum, box); });
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
    const auto proof = proven_feasible<Rational>([&]<class Number>() {
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
