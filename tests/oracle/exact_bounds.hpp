// SPDX-License-Identifier: MIT
// Oracles for axis-aligned boxes and spheres against a frustum, in exact rational arithmetic (GMP), and cases that
// nearly touch.
#pragma once
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/shapes.hpp>
#include <oracle/exact_frustum.hpp>
#include <oracle/near_misses.hpp>

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

using Point = std::array<mpq_class, 3>;

inline mpq_class dot(const Point& a, const Point& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Plane i as normal · x + offset for x relative to the sphere's centre.
struct RationalPlane {
    Point normal;
    mpq_class offset;
};

inline std::vector<RationalPlane> planes_of(const Frustum& frustum, const Sphere& sphere) {
    std::vector<RationalPlane> planes;
    for (const Plane& plane : frustum.view())
        planes.push_back(
            {{mpq_class(plane.normal.x), mpq_class(plane.normal.y), mpq_class(plane.normal.z)},
             plane_value(frustum, plane,
                         {mpq_class(sphere.center.x), mpq_class(sphere.center.y), mpq_class(sphere.center.z)})});
    return planes;
}

inline bool is_rejected_by_a_plane(const Frustum& frustum, const Sphere& sphere) {
    for (const RationalPlane& plane : planes_of(frustum, sphere))
        if (plane.offset < 0 && plane.offset * plane.offset > mpq_class(sphere.radius) * mpq_class(sphere.radius) *
                                                                  dot(plane.normal, plane.normal))
            return true;
    return false;
}

// The nearest point of the volume is the centre, or its projection onto a face, an edge or a corner: all of them are
// tried, by eliminating what lies along the planes chosen before (Gram, Schmidt).
inline cull::Verdict classify(const Frustum& frustum, const Sphere& sphere) {
    const std::vector<RationalPlane> planes = planes_of(frustum, sphere);
    const mpq_class square = mpq_class(sphere.radius) * mpq_class(sphere.radius);
    bool inside = true;
    for (const RationalPlane& plane : planes)
        inside = inside && plane.offset >= 0 && plane.offset * plane.offset >= square * dot(plane.normal, plane.normal);
    if (inside) return cull::Verdict::inside;
    bool reaches = false;
    const auto try_point = [&](const Point& x) {
        for (const RationalPlane& plane : planes)
            if (dot(plane.normal, x) + plane.offset < 0) return;
        reaches = reaches || dot(x, x) <= square;
    };
    const auto project = [&](const auto& self, const Point& x, std::vector<Point> basis, std::size_t first) -> void {
        try_point(x);
        if (basis.size() == 3) return;
        for (std::size_t i = first; i < planes.size(); ++i) {
            Point along = planes[i].normal;
            for (const Point& b : basis) {
                const mpq_class share = dot(planes[i].normal, b) / dot(b, b);
                for (std::size_t j = 0; j < 3; ++j) along[j] -= share * b[j];
            }
            const mpq_class length = dot(along, along);
            if (length == 0) continue;
            const mpq_class step = -(dot(planes[i].normal, x) + planes[i].offset) / length;
            Point moved = x;
            for (std::size_t j = 0; j < 3; ++j) moved[j] += step * along[j];
            std::vector<Point> extended = basis;
            extended.push_back(along);
            self(self, moved, extended, i + 1);
        }
    };
    project(project, Point{0, 0, 0}, {}, 0);
    return reaches ? cull::Verdict::straddling : cull::Verdict::outside;
}

}  // namespace crofton::oracle
