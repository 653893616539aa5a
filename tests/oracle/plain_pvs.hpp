// SPDX-License-Identifier: MIT
// What lines witness, the plain way: every triangle, every cell and every gap between crossings, one after another.
#pragma once
#include <algorithm>
#include <cmath>
#include <crofton/pvs/line_plan.hpp>
#include <crofton/pvs/pvs.hpp>
#include <crofton/sampling/sampling.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <set>
#include <utility>
#include <vector>

namespace crofton::oracle {

struct PlainCrossing {
    double t = 0.0;
    std::uint32_t object = 0;
    bool front = false;
};

// By the signs of three volumes, in double.
inline std::vector<PlainCrossing> crossings(const pvs::BakeGeometry& geometry, const Line& line) {
    std::vector<PlainCrossing> found;
    const auto volume = [&](const glm::dvec3& p, const glm::dvec3& q) {
        return glm::dot(line.direction, glm::cross(p - line.point, q - line.point));
    };
    for (std::size_t t = 0; t < geometry.object_of.size(); ++t) {
        const auto corner = [&](std::size_t k) {
            return glm::dvec3(geometry.mesh.positions[geometry.mesh.indices[3 * t + k]]);
        };
        const glm::dvec3 a = corner(0), b = corner(1), c = corner(2), normal = glm::cross(b - a, c - a);
        const double x = volume(a, b), y = volume(b, c), z = volume(c, a);
        if (!((x > 0.0 && y > 0.0 && z > 0.0) || (x < 0.0 && y < 0.0 && z < 0.0))) continue;
        const double slope = glm::dot(normal, line.direction);
        found.push_back({glm::dot(normal, a - line.point) / slope, geometry.object_of[t], slope < 0.0});
    }
    std::sort(found.begin(), found.end(), [](const auto& p, const auto& q) { return p.t < q.t; });
    return found;
}

// True where the line meets the box, and where it does.
inline bool span_in(const Aabb& box, const Line& line, double& begin, double& end) {
    begin = -HUGE_VAL, end = HUGE_VAL;
    for (int k = 0; k < 3; ++k)
        for (const bool upper : {false, true}) {
            // side · (x − at) ≤ 0 on the kept side
            const double side = upper ? 1.0 : -1.0, at = upper ? box.max[k] : box.min[k];
            const double value = side * (line.point[k] - at), slope = side * line.direction[k];
            if (slope > 0.0) end = std::min(end, -value / slope);
            if (slope < 0.0) begin = std::max(begin, -value / slope);
            if (slope == 0.0 && value > 0.0) return false;
        }
    return begin <= end;
}

// The line's part in a cell: each triangle of three corners lies in the hull, and together they cover its surface.
inline bool span_in(const pvs::ConvexCell& cell, const glm::dvec3& origin, const Line& line, double& begin,
                    double& end) {
    begin = HUGE_VAL, end = -HUGE_VAL;
    for (std::size_t i = 0; i < 8; ++i)
        for (std::size_t j = i + 1; j < 8; ++j)
            for (std::size_t k = j + 1; k < 8; ++k) {
                const glm::dvec3 a = cell.corners[i] - origin - line.point, b = cell.corners[j] - origin - line.point,
                                 c = cell.corners[k] - origin - line.point;
                const double x = glm::dot(line.direction, glm::cross(a, b)),
                             y = glm::dot(line.direction, glm::cross(b, c)),
                             z = glm::dot(line.direction, glm::cross(c, a));
                if (!((x > 0.0 && y > 0.0 && z > 0.0) || (x < 0.0 && y < 0.0 && z < 0.0))) continue;
                const glm::dvec3 normal = glm::cross(b - a, c - a);
                const double t = glm::dot(normal, a) / glm::dot(normal, line.direction);
                begin = std::min(begin, t), end = std::max(end, t);
            }
    return begin <= end;
}

using Pairs = std::set<std::pair<std::size_t, std::uint32_t>>;  // cell, object

// The lines are relative to the geometry's origin.
inline void add_witnessed(const pvs::BakeGeometry& geometry, const pvs::Cells& cells, occlude::Sides sides,
                          const Line& line, Pairs& pairs) {
    const auto hits = crossings(geometry, line);
    for (std::size_t c = 0; c < cells.size(); ++c) {
        const Aabb box = cells.box(c);
        double begin, end;
        const bool meets = cells.is_convex()
                               ? span_in(cells.corners(c), geometry.origin, line, begin, end)
                               : span_in({box.min - geometry.origin, box.max - geometry.origin}, line, begin, end);
        if (!meets) continue;
        for (std::size_t gap = 0; gap <= hits.size(); ++gap) {
            const double from = gap == 0 ? -HUGE_VAL : hits[gap - 1].t,
                         to = gap == hits.size() ? HUGE_VAL : hits[gap].t;
            if (std::max(from, begin) > std::min(to, end)) continue;
            for (std::size_t i = gap; i < hits.size(); ++i)
                if (sides == occlude::Sides::both || hits[i].front) {
                    pairs.insert({c, hits[i].object});
                    break;
                }
            for (std::size_t i = gap; i-- > 0;)
                if (sides == occlude::Sides::both || !hits[i].front) {
                    pairs.insert({c, hits[i].object});
                    break;
                }
        }
    }
}

// All lines of a bake.
inline Pairs witnessed(const pvs::BakeGeometry& geometry, const pvs::Cells& cells, const pvs::BakeOptions& options) {
    Pairs pairs;
    const auto plan = pvs::plan_lines(cells, cells.size() * geometry.boxes.size(), options);
    Vector<Line> lines;
    for (std::uint64_t block = 0; plan && block < plan->blocks; ++block) {
        plan->draw(block, cells, geometry.origin, lines);
        for (const Line& line : lines) add_witnessed(geometry, cells, options.sides, line, pairs);
    }
    return pairs;
}

}  // namespace crofton::oracle
