// SPDX-License-Identifier: MIT
// Convex hulls as bodies: exactly the hull of the points, with faces, edges and vertices that keep their ids.
#pragma once
#include <crofton/convex/mass.hpp>
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

namespace crofton::convex {

inline constexpr int kMaxHullVertices = 256;
// Lengths and coordinates of a body, in its own frame, are at most this.
inline constexpr float kMaxExtent = 1e15f;

struct HullOptions {
    // In [4, kMaxHullVertices]. A hull with more vertices is replaced by one that contains it.
    int max_vertices = kMaxHullVertices;
    // Neighbouring triangles become one face where all its vertices lie within this of a common plane, relative to the
    // hull's size. For contacts alone: faces say where bodies touch, the vertices say what the body is. In [0, 1e-2].
    float face_tolerance = 1e-5f;
};

struct HullEdge {
    std::uint16_t vertices[2];  // counter-clockwise around faces[0]
    std::uint16_t faces[2];
};

// The convex hull of its vertices, which are corners: none lies in the hull of the others.
class Hull {
  public:
    // Exact predicates decide, so nothing is lost: the body is the hull of the points, taken as reals. Duplicates,
    // points inside and points on faces or edges are dropped; points that are nearly coplanar are kept where they are
    // corners. A hull with more than max_vertices corners is replaced by a larger one that contains all points;
    // excess() says by how much. Errors: fewer than four points; all on one point, line or plane (item kNoItem); NaN,
    // infinite or beyond kMaxExtent (the first such point); options out of range. Takes n log n time for n points.
    [[nodiscard]] static Result<Hull> build(std::span<const glm::vec3> points, const HullOptions& options = {});

    [[nodiscard]] std::span<const glm::vec3> vertices() const { return vertices_; }
    // The surface as triangles, counter-clockwise seen from outside: exact, three vertices each.
    [[nodiscard]] std::span<const std::uint16_t> triangles() const { return triangles_; }
    [[nodiscard]] std::span<const HullEdge> edges() const { return edges_; }
    [[nodiscard]] int face_count() const { return static_cast<int>(normals_.size()); }
    // Vertices around the face, counter-clockwise seen from outside.
    [[nodiscard]] std::span<const std::uint16_t> face_vertices(int face) const { return loop(face_vertices_, face); }
    // Edge k leads from vertex k of the face to the next.
    [[nodiscard]] std::span<const std::uint16_t> face_edges(int face) const { return loop(face_edges_, face); }
    [[nodiscard]] const glm::dvec3& face_normal(int face) const {  // unit, outward
        return normals_[static_cast<std::size_t>(face)];
    }
    // How far the body reaches beyond the hull of the points at most, where it was replaced; else 0.
    [[nodiscard]] double excess() const { return excess_; }
    [[nodiscard]] double radius() const { return radius_; }  // of the ball around the frame's origin that contains it
    [[nodiscard]] const MassProperties& mass() const { return mass_; }

    // Of a ball around the center of mass that lies within the body, rounded down.
    [[nodiscard]] double inner_radius() const { return inner_radius_; }

    // For the kernels: coordinate k of all vertices, or face normals, side by side; the last is repeated up to a
    // multiple of four.
    [[nodiscard]] const double* column(int k) const { return column_of(columns_, k); }
    [[nodiscard]] int padded_count() const { return static_cast<int>(columns_.size() / 3); }
    [[nodiscard]] const double* normal_column(int k) const { return column_of(normal_columns_, k); }
    [[nodiscard]] int padded_face_count() const { return static_cast<int>(normal_columns_.size() / 3); }

  private:
    [[nodiscard]] std::span<const std::uint16_t> loop(const Vector<std::uint16_t>& entries, int face) const {
        const auto first = face_first_[static_cast<std::size_t>(face)];
        return {entries.data() + first,
                static_cast<std::size_t>(face_first_[static_cast<std::size_t>(face) + 1]) - first};
    }
    [[nodiscard]] static const double* column_of(const Vector<double>& columns, int k) {
        return columns.data() + columns.size() / 3 * static_cast<std::size_t>(k);
    }
    void find_faces(double tolerance);
    void index_edges();

    Vector<glm::vec3> vertices_;
    Vector<std::uint16_t> triangles_, face_first_, face_vertices_, face_edges_;
    Vector<glm::dvec3> normals_;
    Vector<HullEdge> edges_;
    Vector<double> columns_, normal_columns_;
    MassProperties mass_;
    double excess_ = 0.0, radius_ = 0.0, inner_radius_ = 0.0;
};

}  // namespace crofton::convex
