// SPDX-License-Identifier: MIT
#include "shape.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/geometry/predicates.hpp>
#include <glm/geometric.hpp>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>

namespace crofton::occlude {
namespace {

// An edge as one triangle has it.
struct HalfEdge {
    std::uint32_t low, high, triangle;
    bool forward;  // from low to high
};

[[nodiscard]] bool is_before(const glm::vec3& p, const glm::vec3& q) {
    return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z);
}

// The points that triangles use, each once, in ascending order; triangles of fewer than three points are left out, and
// `source` says which were kept.
void weld(std::span<const glm::vec3> points, std::span<const std::uint32_t> indices, Shape& shape,
          Vector<std::uint32_t>& source) {
    Vector<std::uint32_t> order(indices.begin(), indices.end());
    std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
        return is_before(points[i], points[j]) || (points[i] == points[j] && i < j);
    });
    Vector<std::uint32_t> welded(points.size(), kNone);
    for (const std::uint32_t i : order) {
        if (shape.points.empty() || shape.points.back() != points[i]) shape.points.push_back(points[i]);
        welded[i] = static_cast<std::uint32_t>(shape.points.size() - 1);
    }
    for (std::size_t t = 0; t < indices.size() / 3; ++t) {
        const std::uint32_t a = welded[indices[3 * t]], b = welded[indices[3 * t + 1]], c = welded[indices[3 * t + 2]];
        if (a == b || b == c || c == a) continue;
        for (const std::uint32_t i : {a, b, c}) shape.triangles.push_back(i);
        source.push_back(static_cast<std::uint32_t>(t));
    }
    for (const glm::vec3& p : shape.points)
        shape.max_abs = std::max({shape.max_abs, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
}

[[nodiscard]] Vector<HalfEdge> half_edges_of(const Shape& shape) {
    Vector<HalfEdge> result;
    result.reserve(shape.triangles.size());
    for (std::size_t i = 0; i < shape.triangles.size(); ++i) {
        const std::size_t t = i / 3;
        const std::uint32_t a = shape.triangles[i], b = shape.triangles[3 * t + (i + 1) % 3];
        result.push_back({std::min(a, b), std::max(a, b), static_cast<std::uint32_t>(t), a < b});
    }
    std::sort(result.begin(), result.end(), [](const HalfEdge& p, const HalfEdge& q) {
        return std::tie(p.low, p.high, p.forward, p.triangle) < std::tie(q.low, q.high, q.forward, q.triangle);
    });
    return result;
}

// Calls visit(group) for the half edges between each pair of points.
template <class Visit>
void for_each_edge(std::span<const HalfEdge> edges, const Visit& visit) {
    for (std::size_t begin = 0; begin < edges.size();) {
        std::size_t end = begin + 1;
        while (end < edges.size() && edges[end].low == edges[begin].low && edges[end].high == edges[begin].high) ++end;
        visit(edges.subspan(begin, end - begin));
        begin = end;
    }
}

[[nodiscard]] std::uint32_t root_of(Vector<std::uint32_t>& parents, std::uint32_t i) {
    while (parents[i] != i) i = parents[i] = parents[parents[i]];
    return i;
}

// Sorts triangles and edges by pieces.
void divide(Shape& shape) {
    Vector<std::uint32_t> parents(shape.triangle_count());
    std::iota(parents.begin(), parents.end(), 0u);
    for (const ShapeEdge& edge : shape.edges)
        if (edge.right != kNone) {
            const std::uint32_t a = root_of(parents, edge.left), b = root_of(parents, edge.right);
            parents[std::max(a, b)] = std::min(a, b);
        }
    Vector<std::uint32_t> order(shape.triangle_count()), place(shape.triangle_count());
    std::iota(order.begin(), order.end(), 0u);
    for (std::uint32_t& i : place) i = kNone;
    Vector<std::uint32_t> roots(shape.triangle_count());
    for (std::uint32_t t = 0; t < roots.size(); ++t) roots[t] = root_of(parents, t);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return roots[a] < roots[b]; });
    Vector<std::uint32_t> triangles;
    triangles.reserve(shape.triangles.size());
    for (const std::uint32_t t : order) {
        const auto position = static_cast<std::uint32_t>(triangles.size() / 3);
        if (shape.pieces.empty() || roots[order[shape.pieces.back().first_triangle]] != roots[t])
            shape.pieces.push_back({position, position, 0, 0});
        shape.pieces.back().end_triangle = position + 1;
        place[t] = position;
        for (std::size_t k = 0; k < 3; ++k) triangles.push_back(shape.triangles[3 * t + k]);
    }
    shape.triangles.swap(triangles);
    for (ShapeEdge& edge : shape.edges) {
        edge.left = place[edge.left];
        if (edge.right != kNone) edge.right = place[edge.right];
    }
    std::sort(shape.edges.begin(), shape.edges.end(), [](const ShapeEdge& p, const ShapeEdge& q) {
        return std::tie(p.left, p.a, p.b) < std::tie(q.left, q.a, q.b);
    });
    std::uint32_t e = 0;
    for (ShapePiece& piece : shape.pieces) {
        piece.first_edge = e;
        while (e < shape.edges.size() && shape.edges[e].left < piece.end_triangle) ++e;
        piece.end_edge = e;
    }
}

void connect(Shape& shape) {
    const Vector<HalfEdge> half_edges = half_edges_of(shape);
    for_each_edge(half_edges, [&](std::span<const HalfEdge> group) {
        const bool paired = group.size() == 2 && group[0].forward != group[1].forward;
        for (const HalfEdge& half : group) {
            const std::uint32_t a = half.forward ? half.low : half.high, b = half.forward ? half.high : half.low;
            const std::uint32_t right = paired ? (&half == &group[0] ? group[1] : group[0]).triangle : kNone;
            if (!paired || half.forward) shape.edges.push_back({a, b, half.triangle, right});
        }
    });
    divide(shape);
}

// Twice a triangle's area, along its normal.
[[nodiscard]] glm::dvec3 area_vector_of(const Shape& shape, std::size_t t) {
    const glm::dvec3 a(shape.points[shape.triangles[3 * t]]);
    return glm::cross(glm::dvec3(shape.points[shape.triangles[3 * t + 1]]) - a,
                      glm::dvec3(shape.points[shape.triangles[3 * t + 2]]) - a);
}

// Whether two triangles with a common edge lie in exactly one plane, side by side, and are no slivers.
[[nodiscard]] bool are_coplanar(const Shape& shape, std::uint32_t first, std::uint32_t second) {
    const auto point = [&](std::uint32_t t, std::size_t k) {
        return glm::dvec3(shape.points[shape.triangles[3 * t + k]]);
    };
    const auto is_sliver = [&](std::uint32_t t) {
        const double u = glm::length(point(t, 1) - point(t, 0)), v = glm::length(point(t, 2) - point(t, 0));
        return !(glm::length(area_vector_of(shape, t)) > 1e-6 * u * v);
    };
    if (is_sliver(first) || is_sliver(second)) return false;
    if (!(glm::dot(area_vector_of(shape, first), area_vector_of(shape, second)) > 0.0)) return false;
    for (std::size_t k = 0; k < 3; ++k)
        if (orientation(point(first, 0), point(first, 1), point(first, 2), point(second, k)) != 0) return false;
    return true;
}

// Faces of a convex shape, each represented by its widest triangle, and the edges between them.
void find_faces(Shape& shape) {
    Vector<std::uint32_t> parents(shape.triangle_count()), face_of(shape.triangle_count(), kNone);
    std::iota(parents.begin(), parents.end(), 0u);
    for (const ShapeEdge& edge : shape.edges)
        if (edge.right != kNone && are_coplanar(shape, edge.left, edge.right))
            parents[root_of(parents, edge.left)] = root_of(parents, edge.right);
    Vector<double> widest;
    for (std::uint32_t t = 0; t < shape.triangle_count(); ++t) {
        std::uint32_t& face = face_of[root_of(parents, t)];
        if (face == kNone) {
            face = static_cast<std::uint32_t>(shape.faces.size());
            shape.faces.push_back({});
            widest.push_back(-1.0);
        }
        const glm::dvec3 area = area_vector_of(shape, t);
        if (!(glm::dot(area, area) > widest[face])) continue;
        widest[face] = glm::dot(area, area);
        shape.faces[face] = {shape.triangles[3 * t], shape.triangles[3 * t + 1], shape.triangles[3 * t + 2]};
    }
    for (ShapeEdge& edge : shape.edges) {
        edge.left = face_of[root_of(parents, edge.left)];
        if (edge.right != kNone) edge.right = face_of[root_of(parents, edge.right)];
    }
    std::erase_if(shape.edges, [](const ShapeEdge& edge) { return edge.left == edge.right; });
}

// The edges of one triangle alone, as those of triangle 0.
[[nodiscard]] Vector<ShapeEdge> boundary_of(const Shape& shape) {
    Vector<ShapeEdge> boundary;
    for (const ShapeEdge& edge : shape.edges)
        if (edge.right == kNone) boundary.push_back({edge.a, edge.b, 0, kNone});
    return boundary;
}

// Whether all points lie within shares of the extent of the plane of triangle 0 and to the left of the boundary, and
// all triangles look to one side. What is drawn of such a piece lacks no more than these shares (prepare_polygon).
[[nodiscard]] bool is_flat_and_convex(const Shape& shape, std::span<const ShapeEdge> boundary, double extent) {
    constexpr double kFlatness = 0x1p-10, kConvexity = 0x1p-14;
    const auto point = [&](std::uint32_t i) { return glm::dvec3(shape.points[i]); };
    const glm::dvec3 normal = glm::normalize(area_vector_of(shape, 0)), origin = point(shape.triangles[0]);
    for (std::size_t t = 0; t < shape.triangle_count(); ++t)
        if (!(glm::dot(area_vector_of(shape, t), normal) > 0.0)) return false;
    for (const glm::vec3& p : shape.points)
        if (!(std::fabs(glm::dot(normal, glm::dvec3(p) - origin)) <= kFlatness * extent)) return false;
    for (const ShapeEdge& edge : boundary) {
        const glm::dvec3 from = point(edge.a), inward = glm::cross(normal, point(edge.b) - from);
        const double least = -kConvexity * extent * glm::length(inward);
        for (const glm::vec3& p : shape.points)
            if (!(glm::dot(inward, glm::dvec3(p) - from) >= least)) return false;
    }
    return true;
}

[[nodiscard]] std::size_t widest_of(const Shape& shape) {
    std::size_t widest = 0;
    double most = -1.0;
    for (std::size_t t = 0; t < shape.triangle_count(); ++t) {
        const glm::dvec3 area = area_vector_of(shape, t);
        if (const double area2 = glm::dot(area, area); area2 > most) most = area2, widest = t;
    }
    return widest;
}

[[nodiscard]] double area_of(const Shape& shape) {
    double area = 0.0;
    for (std::size_t t = 0; t < shape.triangle_count(); ++t) area += glm::length(area_vector_of(shape, t));
    return 0.5 * area;
}

[[nodiscard]] double volume_of(const Shape& shape) {
    const glm::dvec3 base(shape.points.front());
    double volume = 0.0;
    for (std::size_t t = 0; t < shape.triangle_count(); ++t) {
        const glm::dvec3 a = glm::dvec3(shape.points[shape.triangles[3 * t]]) - base;
        const glm::dvec3 b = glm::dvec3(shape.points[shape.triangles[3 * t + 1]]) - base;
        volume += glm::dot(a, glm::cross(b, glm::dvec3(shape.points[shape.triangles[3 * t + 2]]) - base));
    }
    return volume / 6.0;
}

[[nodiscard]] double extent_of(const Shape& shape) {
    Aabb bounds;
    for (const glm::vec3& p : shape.points) bounds.include(glm::dvec3(p));
    return glm::length(bounds.max - bounds.min);
}

// Finds the outline, where there is one.
void find_outline(Shape& shape) {
    constexpr std::size_t kMostTriangles = 32;
    if (shape.pieces.size() != 1 || shape.triangle_count() > kMostTriangles) return;
    const std::size_t widest = widest_of(shape);
    for (std::size_t k = 0; k < 3; ++k) std::swap(shape.triangles[k], shape.triangles[3 * widest + k]);
    for (ShapeEdge& edge : shape.edges)
        for (std::uint32_t ShapeEdge::*side : {&ShapeEdge::left, &ShapeEdge::right})
            if (edge.*side == 0 || edge.*side == widest) edge.*side = static_cast<std::uint32_t>(widest) - edge.*side;
    Vector<ShapeEdge> boundary = boundary_of(shape);
    if (is_flat_and_convex(shape, boundary, extent_of(shape))) shape.outline = std::move(boundary);
}

[[nodiscard]] Result<Shape> welded_shape(const TriangleMesh& mesh, Sides sides, Vector<std::uint32_t>& source) {
    if (auto valid = validate(mesh); !valid) return valid.error();
    Shape shape;
    shape.sides = sides;
    weld(mesh.positions, mesh.indices, shape, source);
    if (static_cast<double>(shape.max_abs) > kMaxCoordinate)
        return fail(ErrorCode::out_of_range, kNoItem, "occluder: a coordinate exceeds 1e30");
    if (!(area_of(shape) > 0.0))
        return fail(ErrorCode::degenerate, kNoItem, "occluder: no triangle has an area, so it hides nothing");
    return shape;
}

}  // namespace

Result<Shape> convex_shape(std::span<const glm::vec3> points) {
    const auto hull = convex_hull(points);
    if (!hull) return hull.error();
    if (hull->rank < 3)
        return fail(ErrorCode::degenerate, kNoItem, "occluder: the points are flat; give a polygon as a surface");
    Shape shape;
    shape.convex = true;
    Vector<std::uint32_t> source;
    weld(points, hull->triangles, shape, source);
    connect(shape);
    find_faces(shape);
    return shape;
}

Result<Shape> closed_shape(const TriangleMesh& mesh) {
    Vector<std::uint32_t> source;
    Result<Shape> shape = welded_shape(mesh, Sides::front, source);
    if (!shape) return shape;
    std::uint32_t open = kNone;
    const Vector<HalfEdge> half_edges = half_edges_of(*shape);
    for_each_edge(half_edges, [&](std::span<const HalfEdge> group) {
        const auto forward = std::count_if(group.begin(), group.end(), [](const HalfEdge& e) { return e.forward; });
        if (2 * static_cast<std::size_t>(forward) != group.size()) open = std::min(open, source[group[0].triangle]);
    });
    if (open != kNone)
        return fail(ErrorCode::invalid_argument, open,
                    {"occluder: the mesh is open at triangle ", open, "; close it, or give it as a surface"});
    const double extent = extent_of(*shape);
    const double volume = volume_of(*shape);
    if (std::fabs(volume) <= 1e-12 * extent * extent * extent)
        return fail(ErrorCode::degenerate, kNoItem, "occluder: the mesh is flat; give it as a surface");
    if (volume < 0.0)
        return fail(ErrorCode::invalid_argument, kNoItem, "occluder: the mesh is inside out; turn its triangles round");
    connect(*shape);
    return shape;
}

Result<Shape> surface_shape(const TriangleMesh& surface, Sides sides) {
    Vector<std::uint32_t> source;
    Result<Shape> shape = welded_shape(surface, sides, source);
    if (!shape) return shape;
    connect(*shape);
    find_outline(*shape);
    return shape;
}

}  // namespace crofton::occlude
