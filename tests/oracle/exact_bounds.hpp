// SPDX-License-Identifier: MIT
// Oracles for axis-aligned boxes and spheres against a frustum, in exact rational arithmetic (GMP), and cases that
// nearly touch.
#pragma once
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/shapes.hpp>
#include <oracle/exact_frustum.hpp>
#include <oracle/near_misses.hpp>
#include <oracle/sphere_verdict.hpp>
#include <oracle/tracked.hpp>

namespace crofton::oracle {

inline Aabb near_aabb(NearMisses& random, const Frustum& frustum) {
    Obb box = random.box(frustum);
    box.axes = glm::mat3(1.0f);
    return aabb_of(box);
}

inline Sphere near_sphere(NearMisses& random, const Frustum& frustum) {
    const glm::dvec3 target = random.surface_point(frustum, *frustum_corners(frustum));
    const double depth = std::exp(random.number(std::log(1e-16), std::log(1e-1)));
    const double distance = random.index(10) ? std::exp(random.number(-4.0, 2.0)) : 0.0;
    return {target + distance * random.direction(), std::max(0.0, distance + (random.index(2) ? depth : -depth))};
}

// One row per plane: the slopes along the box's edges from its least corner, and the value there; t in [0, 1].
inline std::vector<Inequality> rows_of(const Frustum& frustum, const Aabb& box) {
    std::vector<Inequality> rows;
    for (const Plane& plane : frustum.view()) {
        Inequality row;
        for (int j = 0; j < 3; ++j)
            row.push_back(mpq_class(plane.normal[j]) * (mpq_class(box.max[j]) - mpq_class(box.min[j])));
        row.push_back(plane_value(frustum, plane, {mpq_class(box.min.x), mpq_class(box.min.y), mpq_class(box.min.z)}));
        rows.push_back(row);
    }
    return rows;
}

inline bool is_rejected_by_a_plane(const Frustum& frustum, const Aabb& box) {
    for (const Inequality& row : rows_of(frustum, box)) {
        mpq_class most = row[3];
        for (std::size_t k = 0; k < 3; ++k)
            if (row[k] > 0) most += row[k];
        if (most < 0) return true;
    }
    return false;
}

inline cull::Verdict classify(const Frustum& frustum, const Aabb& box) {
    std::vector<Inequality> rows = rows_of(frustum, box);
    bool inside = true;
    for (const Inequality& row : rows) {
        mpq_class least = row[3];
        for (std::size_t k = 0; k < 3; ++k)
            if (row[k] < 0) least += row[k];
        inside = inside && least >= 0;
    }
    if (inside) return cull::Verdict::inside;
    for (std::size_t k = 0; k < 3; ++k)
        for (const int side : {1, -1}) {
            Inequality face(4, mpq_class(0));
            face[k] = side;
            face[3] = side > 0 ? 0 : 1;
            rows.push_back(face);
        }
    return is_feasible(rows) ? cull::Verdict::straddling : cull::Verdict::outside;
}

inline bool is_rejected_by_a_plane(const Frustum& frustum, const Sphere& sphere) {
    return SphereVerdict<mpq_class>(frustum, sphere).is_rejected_by_a_plane();
}

inline cull::Verdict classify(const Frustum& frustum, const Sphere& sphere) {
    return decide([&]<class Number>() { return SphereVerdict<Number>(frustum, sphere)(); });
}

}  // namespace crofton::oracle
