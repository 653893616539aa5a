// SPDX-License-Identifier: MIT
// What makes a list of triangles a conforming triangulation of a polygon, checked the slow way in exact arithmetic.
#pragma once
#include <gmpxx.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/geometry/mesh.hpp>
#include <map>
#include <oracle/tracked.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace crofton::oracle {

using Point = std::pair<double, double>;

inline Point at(const Polygon& polygon, std::uint32_t i) {
    return {polygon.points[i].x + 0.0, polygon.points[i].y + 0.0};
}

template <class Number = Rational>
Number twice_area(Point a, Point b, Point c) {
    const Number ax(a.first), ay(a.second), bx(b.first), by(b.second), cx(c.first), cy(c.second);
    return Number((bx - ax) * (cy - ay) - (by - ay) * (cx - ax));
}

// Twice the area by the shoelace formula: |outer ring| − Σ |holes|, right for simple rings.
template <class Number = Rational>
Number twice_polygon_area(const Polygon& polygon) {
    Number total = 0.0;
    for (std::size_t r = 0; r < polygon.ring_count(); ++r) {
        const auto ring = polygon.ring(r);
        Number area = 0.0;
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const auto &p = ring[i], &q = ring[(i + 1) % ring.size()];
            area += Number(p.x) * Number(q.y) - Number(q.x) * Number(p.y);
        }
        total += r == 0 ? Number(abs(area)) : Number(-abs(area));
    }
    return total;
}

// Empty if the triangles are positively oriented, their directed sides are distinct, every side without a partner lies
// on a ring's edge, every used position is a vertex of no triangle's side (conforming) and the areas add up; else what
// is wrong. `weakly_simple`: the shoelace formula does not apply, so the area is not checked.
template <class Number = Rational>
std::string check_triangulation(const Polygon& polygon, const auto& triangles, bool weakly_simple = false) {
    std::set<std::pair<Point, Point>> sides;
    std::set<Point> used;
    Number area = 0.0;
    for (const auto& t : triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            if (t[k] >= polygon.points.size()) return "index out of range";
        }
        const Number a = twice_area<Number>(at(polygon, t[0]), at(polygon, t[1]), at(polygon, t[2]));
        if (sgn(a) <= 0) return "a triangle is not counter-clockwise";
        area += a;
        for (std::size_t k = 0; k < 3; ++k) {
            used.insert(at(polygon, t[k]));
            if (!sides.insert({at(polygon, t[k]), at(polygon, t[(k + 1) % 3])}).second) return "a side occurs twice";
        }
    }
    if (!weakly_simple && sgn(Number(area - twice_polygon_area<Number>(polygon))) != 0)
        return "the areas do not add up";
    // Sides without a partner form the boundary: each must lie on a ring edge.
    std::vector<std::pair<Point, Point>> edges;
    for (std::size_t r = 0; r < polygon.ring_count(); ++r) {
        const auto ring = polygon.ring(r);
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const auto &p = ring[i], &q = ring[(i + 1) % ring.size()];
            edges.push_back({{p.x + 0.0, p.y + 0.0}, {q.x + 0.0, q.y + 0.0}});
        }
    }
    const std::set<std::pair<Point, Point>> whole(edges.begin(), edges.end());
    const auto on = [](Point p, const std::pair<Point, Point>& e) {
        return std::min(e.first, e.second) <= p && p <= std::max(e.first, e.second) &&
               sgn(twice_area<Number>(e.first, e.second, p)) == 0;
    };
    for (const auto& side : sides) {
        if (sides.count({side.second, side.first})) continue;
        if (whole.count(side) || whole.count({side.second, side.first})) continue;
        if (std::none_of(edges.begin(), edges.end(),
                         [&](const auto& e) { return on(side.first, e) && on(side.second, e); })) {
            return "a side without a partner is not on the boundary";
        }
    }
    if (!weakly_simple) {
        for (const auto& p : polygon.points) {
            if (!used.count({p.x + 0.0, p.y + 0.0})) return "a vertex is not used";
        }
    }
    return "";
}

// Whether every diagonal is locally Delaunay: no apex beyond it lies inside the circle of the triangle before it. For
// polygons without slits that makes the triangulation constrained Delaunay (Lee and Lin 1986).
template <class Number = Rational>
bool is_constrained_delaunay(const Polygon& polygon, const auto& triangles) {
    std::map<std::pair<Point, Point>, Point> apex;
    for (const auto& t : triangles) {
        for (std::size_t k = 0; k < 3; ++k)
            apex[{at(polygon, t[k]), at(polygon, t[(k + 1) % 3])}] = at(polygon, t[(k + 2) % 3]);
    }
    for (const auto& [side, c] : apex) {
        const auto beyond = apex.find({side.second, side.first});
        if (beyond == apex.end() || side.second < side.first) continue;
        const Point d = beyond->second;
        const auto row = [&](Point p) {
            const Number x = Number(p.first) - Number(d.first), y = Number(p.second) - Number(d.second);
            return Vec3<Number>{x, y, x * x + y * y};
        };
        const auto p = row(side.first), q = row(side.second), r = row(c);
        if (sgn(Number(dot(p, cross(q, r)))) > 0) return false;
    }
    return true;
}

// The total length of the sides that occur in both directions.
inline double diagonal_length(const Polygon& polygon, const auto& triangles) {
    std::set<std::pair<Point, Point>> sides;
    double weight = 0.0;
    for (const auto& t : triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const Point p = at(polygon, t[k]), q = at(polygon, t[(k + 1) % 3]);
            if (sides.count({q, p})) weight += std::hypot(p.first - q.first, p.second - q.second);
            sides.insert({p, q});
        }
    }
    return weight;
}

}  // namespace crofton::oracle
