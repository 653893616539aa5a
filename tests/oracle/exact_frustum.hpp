// SPDX-License-Identifier: MIT
// Oracle: does a convex body meet a frustum, in exact rational arithmetic (GMP), by eliminating one variable after
// another (Fourier 1826, Motzkin 1936): no geometry, no case distinctions.
#pragma once
#include <gmpxx.h>

#include <crofton/cull/classify.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <vector>

namespace crofton::oracle {

// Σ row[k] x_k + row.back() ≥ 0
using Inequality = std::vector<mpq_class>;

inline bool is_feasible(std::vector<Inequality> system) {
    while (system.front().size() > 1) {
        std::vector<Inequality> positive, negative, next;
        for (Inequality& row : system) {
            const int s = sgn(row.front());
            if (s != 0) {
                const mpq_class scale = abs(row.front());
                for (mpq_class& entry : row) entry /= scale;
            }
            const Inequality rest(row.begin() + 1, row.end());
            (s > 0 ? positive : s < 0 ? negative : next).push_back(rest);
        }
        for (const Inequality& p : positive)
            for (const Inequality& n : negative) {
                Inequality sum(p);
                for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += n[k];
                next.push_back(sum);
            }
        if (next.empty()) return true;
        system = next;
    }
    for (const Inequality& row : system)
        if (row[0] < 0) return false;
    return true;
}

inline mpq_class plane_value(const Frustum& frustum, const Plane& plane, const std::array<mpq_class, 3>& x) {
    mpq_class sum = plane.offset;
    for (int j = 0; j < 3; ++j) sum += mpq_class(plane.normal[j]) * (x[std::size_t(j)] - mpq_class(frustum.origin[j]));
    return sum;
}

// One row per plane: the slopes along the box's half edges, and the value at its centre.
inline std::vector<Inequality> rows_of(const Frustum& frustum, const Obb& box) {
    std::vector<Inequality> rows;
    for (const Plane& plane : frustum.view()) {
        Inequality row;
        for (int k = 0; k < 3; ++k) {
            mpq_class slope = 0;
            for (int j = 0; j < 3; ++j)
                slope += mpq_class(plane.normal[j]) * mpq_class(double(box.axes[k][j])) *
                         mpq_class(double(box.half_extents[k]));
            row.push_back(slope);
        }
        row.push_back(
            plane_value(frustum, plane, {mpq_class(box.center.x), mpq_class(box.center.y), mpq_class(box.center.z)}));
        rows.push_back(row);
    }
    return rows;
}

inline bool is_inside(const Frustum& frustum, const Obb& box) {
    for (const Inequality& row : rows_of(frustum, box))
        if (row[3] < abs(row[0]) + abs(row[1]) + abs(row[2])) return false;
    return true;
}

inline bool is_rejected_by_a_plane(const Frustum& frustum, const Obb& box) {
    for (const Inequality& row : rows_of(frustum, box))
        if (row[3] + abs(row[0]) + abs(row[1]) + abs(row[2]) < 0) return true;
    return false;
}

inline bool meets(const Frustum& frustum, const Obb& box) {
    std::vector<Inequality> rows = rows_of(frustum, box);
    for (std::size_t k = 0; k < 3; ++k)
        for (const int side : {-1, 1}) {
            Inequality face(4, mpq_class(0));
            face[k] = side;
            face[3] = 1;
            rows.push_back(face);
        }
    return is_feasible(rows);
}

inline cull::Verdict classify(const Frustum& frustum, const Obb& box) {
    if (is_inside(frustum, box)) return cull::Verdict::inside;
    return meets(frustum, box) ? cull::Verdict::straddling : cull::Verdict::outside;
}

inline bool meets(const Frustum& frustum, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    std::vector<Inequality> rows;
    const auto point = [](const glm::dvec3& p) {
        return std::array<mpq_class, 3>{mpq_class(p.x), mpq_class(p.y), mpq_class(p.z)};
    };
    for (const Plane& plane : frustum.view()) {
        const mpq_class fa = plane_value(frustum, plane, point(a));
        rows.push_back({plane_value(frustum, plane, point(b)) - fa, plane_value(frustum, plane, point(c)) - fa, fa});
    }
    rows.push_back({1, 0, 0});
    rows.push_back({0, 1, 0});
    rows.push_back({-1, -1, 1});
    return is_feasible(rows);
}

}  // namespace crofton::oracle
