// SPDX-License-Identifier: MIT
// Oracle: polytopes where they stand, in any kind of number that knows its sign: do they meet, by proofs and by all
// separating axes.
#pragma once
#include <array>
#include <crofton/convex/query.hpp>
#include <oracle/tracked_numbers.hpp>
#include <vector>

namespace crofton::oracle {

template <class Number>
struct Polytope {
    std::vector<Vec3<Number>> points;
    std::vector<std::array<std::size_t, 3>> triangles;  // counter-clockwise seen from outside
};

inline std::vector<std::array<std::size_t, 3>> triangles_of(const convex::Shape& shape) {
    std::vector<std::array<std::size_t, 3>> result;
    if (shape.kind() == convex::Kind::box)
        return {{0, 4, 2}, {4, 6, 2}, {1, 3, 5}, {3, 7, 5}, {0, 1, 4}, {1, 5, 4},
                {2, 6, 3}, {6, 7, 3}, {0, 2, 1}, {2, 3, 1}, {4, 5, 6}, {5, 7, 6}};
    if (shape.hull() == nullptr) return {{0, 1, 2}, {0, 2, 1}};
    const auto indices = shape.hull()->triangles();
    for (std::size_t i = 0; i < indices.size(); i += 3) result.push_back({indices[i], indices[i + 1], indices[i + 2]});
    return result;
}

// A translation: velocity · time, not rounded.
struct ExactWay {
    glm::dvec3 velocity{0.0};
    double time = 0.0;
};

// Relative to `origin`, at the end of a way.
template <class Number>
Polytope<Number> polytope(const convex::ShapeAtPose& placed, const glm::dvec3& origin, const ExactWay& way = {}) {
    const RigidTransform& pose = placed.pose;
    Polytope<Number> result;
    const Vec3<Number> columns[3] = {vector_of<Number>(pose.rotation[0]), vector_of<Number>(pose.rotation[1]),
                                     vector_of<Number>(pose.rotation[2])};
    Vec3<Number> at = minus(vector_of<Number>(pose.translation), vector_of<Number>(origin));
    const Vec3<Number> velocity = vector_of<Number>(way.velocity);
    for (std::size_t c = 0; c < 3; ++c) at[c] = at[c] + velocity[c] * Number(way.time);
    for (int i = 0; i < placed.shape.vertex_count(); ++i) {
        const Vec3<Number> v = vector_of<Number>(placed.shape.vertex(i));
        Vec3<Number> image;
        for (std::size_t c = 0; c < 3; ++c)
            image[c] = columns[0][c] * v[0] + columns[1][c] * v[1] + columns[2][c] * v[2] + at[c];
        result.points.push_back(image);
    }
    result.triangles = triangles_of(placed.shape);
    return result;
}

// Whether all of b lies beyond all of a along n: 1 or 0, or kUnknown.
template <class Number>
int parts(const Polytope<Number>& a, const Polytope<Number>& b, const Vec3<Number>& n) {
    std::vector<Number> levels;
    levels.reserve(a.points.size());
    for (const auto& p : a.points) levels.push_back(dot(n, p));
    // One that cannot be told must not hide another that can.
    int answer = 1;
    for (const auto& q : b.points) {
        const Number level = dot(n, q);
        for (const Number& other : levels) {
            const int sign = told(Number(level - other));
            if (sign == 0 || sign == -1) return 0;
            if (sign == kUnknown) answer = kUnknown;
        }
    }
    return answer;
}
// 1 or 0, or kUnknown. 0 for a triangle, whose two faces alone do not bound it: the axes decide.
template <class Number>
int contains(const Polytope<Number>& a, const Vec3<Number>& x) {
    int answer = a.points.size() == 3 ? 0 : 1;
    for (const auto& t : a.triangles) {
        const Vec3<Number>&p = a.points[t[0]], n = cross(minus(a.points[t[1]], p), minus(a.points[t[2]], p));
        const int sign = told(Number(dot(n, minus(x, p))));
        if (sign == 1) return 0;
        if (sign == kUnknown) answer = kUnknown;
    }
    return answer;
}

// Whether a vector is certainly not 0. Throws where that cannot be told.
template <class Number>
bool is_some(const Vec3<Number>& v) {
    bool unknown = false;
    for (const Number& c : v) {
        const int sign = told(c);
        if (sign == 1 || sign == -1) return true;
        unknown = unknown || sign == kUnknown;
    }
    if (unknown) throw Undecided{};
    return false;
}

// Whether both shapes lie within one plane and a line of that plane parts them. All other axes are then across it.
template <class Number>
bool are_parted_in_a_plane(const Polytope<Number>& a, const Polytope<Number>& b) {
    std::vector<Vec3<Number>> ways;
    for (const auto* shape : {&a, &b})
        for (const auto& p : shape->points) ways.push_back(minus(p, a.points[0]));
    const auto first = [&](const auto& of) {
        for (const auto& way : ways)
            if (const Vec3<Number> v = of(way); is_some(v)) return v;
        return Vec3<Number>{Number(0.0), Number(0.0), Number(0.0)};
    };
    const auto either = [&](Vec3<Number> n) {
        if (parts(a, b, n) == 1) return true;
        for (Number& c : n) c = -c;
        return parts(a, b, n) == 1;
    };
    const Vec3<Number> u = first([](const auto& way) { return way; });
    if (!is_some(u)) return false;  // a single point
    const Vec3<Number> n = first([&](const auto& way) { return cross(u, way); });
    if (!is_some(n)) return either(u);  // on one line
    for (const auto& way : ways)
        if (const Vec3<Number> height{dot(n, way), Number(0.0), Number(0.0)}; is_some(height)) return false;
    for (const auto* shape : {&a, &b})
        for (const auto& t : shape->triangles)
            for (std::size_t i = 0; i < 3; ++i)
                if (either(cross(n, minus(shape->points[t[(i + 1) % 3]], shape->points[t[i]])))) return true;
    return false;
}

// The separating-axis theorem: normals of faces, products of edges.
template <class Number>
bool meet_by_axes(const Polytope<Number>& a, const Polytope<Number>& b) {
    bool undecided = false;
    const auto try_to_part = [&](Vec3<Number> n, bool turned) {
        if (turned)
            for (Number& c : n) c = -c;
        const int answer = parts(a, b, n);
        undecided = undecided || answer == kUnknown;
        return answer == 1;
    };
    for (int side = 0; side < 2; ++side)
        for (const auto& t : (side == 0 ? a : b).triangles) {
            const auto& p = (side == 0 ? a : b).points;
            if (try_to_part(cross(minus(p[t[1]], p[t[0]]), minus(p[t[2]], p[t[0]])), side == 1)) return false;
        }
    for (const auto& s : a.triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            if (s[i] > s[(i + 1) % 3]) continue;
            const Vec3<Number> u = minus(a.points[s[(i + 1) % 3]], a.points[s[i]]);
            for (const auto& t : b.triangles)
                for (std::size_t j = 0; j < 3; ++j) {
                    if (t[j] > t[(j + 1) % 3]) continue;
                    const Vec3<Number> n = cross(u, minus(b.points[t[(j + 1) % 3]], b.points[t[j]]));
                    if (try_to_part(n, false) || try_to_part(n, true)) return false;
                }
        }
    if (undecided) throw Undecided{};
    return !are_parted_in_a_plane(a, b);
}

// By a plane across one of the `normals`, or a common point, a's place plus one of the `points`; else by all axes. b
// stands at the end of a way. Throws Undecided where the numbers cannot tell.
template <class Number>
bool meet_in(const convex::ShapeAtPose& a, const convex::ShapeAtPose& b, const std::vector<glm::dvec3>& normals,
             const std::vector<glm::dvec3>& points, const ExactWay& way_of_b = {}) {
    const glm::dvec3& origin = a.pose.translation;
    const auto of_a = polytope<Number>(a, origin), of_b = polytope<Number>(b, origin, way_of_b);
    for (const glm::dvec3& n : normals)
        if (parts(of_a, of_b, vector_of<Number>(n)) == 1) return false;
    for (const glm::dvec3& p : points) {
        const Vec3<Number> x = vector_of<Number>(p);
        if (contains(of_a, x) == 1 && contains(of_b, x) == 1) return true;
    }
    return meet_by_axes(of_a, of_b);
}

}  // namespace crofton::oracle
