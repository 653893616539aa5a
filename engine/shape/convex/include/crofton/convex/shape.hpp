// SPDX-License-Identifier: MIT
// Shapes: convex ones, hulls of points, meshes, height fields, compounds. Mass properties.
#pragma once
#include <compare>
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/core/version.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/shapes.hpp>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <span>

namespace crofton::mesh {
class MeshTree;
}

namespace crofton::convex {

// ---- Mass ----

// Mass properties in the shape's frame. Multiply them by the density to get mass and inertia tensor.
struct MassProperties {
    double volume = 0.0;
    glm::dvec3 center{0.0};   // of mass
    glm::dmat3 inertia{0.0};  // about `center`: ∫ (|r|² I − r rᵀ) dV, symmetric
};

// Convex hulls as shapes: exactly the hull of the points, with faces, edges and vertices that keep their ids.

inline constexpr int kMaxHullVertices = 256;
// The largest length or coordinate of a shape in its own frame.
inline constexpr float kMaxExtent = 1e15f;

struct HullOptions {
    // In [4, kMaxHullVertices]. A hull with more vertices is replaced by a larger one that contains it.
    int max_vertices = kMaxHullVertices;
    // Neighbouring triangles become one face if all its vertices lie within this of a common plane, relative to the
    // hull's size. It affects contacts only: faces say where shapes touch, while the vertices define the shape. In [0,
    // 1e-2].
    float face_tolerance = 1e-5f;
};

struct HullEdge {
    std::uint16_t vertices[2];  // counter-clockwise around faces[0]
    std::uint16_t faces[2];
};

// A convex hull. Its vertices are corners: none lies in the hull of the others.
class Hull {
  public:
    // Builds the hull of the points, taken as reals, by exact predicates.
    //
    // Duplicates, points inside and points on faces or edges are dropped; nearly coplanar points are kept if they are
    // corners. If the hull has more than max_vertices corners, it is replaced by a larger one that contains all points;
    // max_overshoot() bounds how far that reaches beyond. Takes n log n time for n points.
    //
    // Errors: fewer than four points; all on one point, line or plane (item kNoItem); a point that is NaN, infinite or
    // beyond kMaxExtent (the first such point); options out of range.
    [[nodiscard]] static Result<Hull> build(std::span<const glm::vec3> points, const HullOptions& options = {});

    [[nodiscard]] std::span<const glm::vec3> vertices() const { return vertices_; }
    // Returns the exact surface as triangles of three vertices each, counter-clockwise seen from outside.
    [[nodiscard]] std::span<const std::uint16_t> triangles() const { return triangles_; }
    [[nodiscard]] std::span<const HullEdge> edges() const { return edges_; }
    [[nodiscard]] int face_count() const { return static_cast<int>(normals_.size()); }
    // Returns the vertices around the face, counter-clockwise seen from outside.
    [[nodiscard]] std::span<const std::uint16_t> face_vertices(int face) const { return loop(face_vertices_, face); }
    // Returns the edges of the face. Edge k leads from vertex k of the face to the next.
    [[nodiscard]] std::span<const std::uint16_t> face_edges(int face) const { return loop(face_edges_, face); }
    [[nodiscard]] const glm::dvec3& face_normal(int face) const {  // unit, outward
        return normals_[static_cast<std::size_t>(face)];
    }
    // Returns how far the shape extends at most beyond the hull of the points if it was replaced, and 0 otherwise.
    [[nodiscard]] double max_overshoot() const { return max_overshoot_; }
    [[nodiscard]] double radius() const { return radius_; }  // of the sphere around the frame's origin that contains it
    [[nodiscard]] const MassProperties& mass() const { return mass_; }

    // Returns the radius of the sphere around the center of mass that lies within the shape, rounded down.
    [[nodiscard]] double inner_radius() const { return inner_radius_; }

    // For the kernels: coordinate k of all vertices, or of all face normals, contiguous; the last one is repeated up to
    // a multiple of four.
    [[nodiscard]] const double* column(int k) const { return columns_.data() + k * padded_count_; }
    [[nodiscard]] int padded_count() const { return padded_count_; }
    [[nodiscard]] const double* normal_column(int k) const { return normal_columns_.data() + k * padded_face_count_; }
    [[nodiscard]] int padded_face_count() const { return padded_face_count_; }
    // The planes through triangles(): the coordinates of the unit normals, and for k = 3 their offsets dot(normal,
    // corner). Normals are off by plane_error() at most.
    [[nodiscard]] const double* plane_column(int k) const {
        return planes_.data() + planes_.size() / 4 * static_cast<std::size_t>(k);
    }
    [[nodiscard]] double plane_error() const { return plane_error_; }
    // The vertex that is farthest along a face's normal, and whether the face is too narrow to tell its sides apart.
    [[nodiscard]] int face_support(int face) const { return face_support_[static_cast<std::size_t>(face)]; }
    [[nodiscard]] bool is_narrow_face(int face) const { return face_is_narrow_[static_cast<std::size_t>(face)] != 0; }
    // How far the vertices of a face are from one plane across its normal.
    [[nodiscard]] double face_unevenness(int face) const { return face_unevenness_[static_cast<std::size_t>(face)]; }
    // The edges of triangles() that lead from a vertex: where to, and how long they are at most.
    struct Spoke {
        float length;
        std::uint16_t to;
    };
    [[nodiscard]] std::span<const Spoke> spokes(int vertex) const {
        const auto first = spoke_first_[static_cast<std::size_t>(vertex)];
        return {spokes_.data() + first,
                static_cast<std::size_t>(spoke_first_[static_cast<std::size_t>(vertex) + 1]) - first};
    }

  private:
    [[nodiscard]] std::span<const std::uint16_t> loop(const Vector<std::uint16_t>& entries, int face) const {
        const auto first = face_first_[static_cast<std::size_t>(face)];
        return {entries.data() + first,
                static_cast<std::size_t>(face_first_[static_cast<std::size_t>(face) + 1]) - first};
    }
    void find_faces(double tolerance);
    void index_edges();
    void find_planes();
    void describe_faces();
    void find_spokes();

    Vector<glm::vec3> vertices_;
    Vector<std::uint16_t> triangles_, face_first_, face_vertices_, face_edges_, face_support_, spoke_first_;
    Vector<Spoke> spokes_;
    Vector<std::uint8_t> face_is_narrow_;
    Vector<glm::dvec3> normals_;
    Vector<HullEdge> edges_;
    Vector<double> columns_, normal_columns_, planes_, face_unevenness_;
    int padded_count_ = 0, padded_face_count_ = 0;
    MassProperties mass_;
    double max_overshoot_ = 0.0, radius_ = 0.0, inner_radius_ = 0.0, plane_error_ = 0.0;
};

// Shapes of any kind, the argument of every query of this module.

class HeightField;
class Compound;

enum class Kind : std::uint8_t {
    sphere,
    capsule,
    cylinder,
    cone,
    box,
    triangle,
    hull,
    half_space,  // up to here convex
    mesh,
    height_field,
    compound,
};

// The sides of a surface's triangles that contacts and casts see. intersects, distance and penetration see both sides.
enum class Sides : std::uint8_t {
    both,
    front,  // contacts push to the front; what comes from behind passes
};

inline constexpr double kInfiniteRadius = std::numeric_limits<double>::infinity();

// A shape, as a small value. For a hull, mesh, height field or compound it is a view of an object that you keep alive
// and unchanged.
//
// Solids of revolution have the frame's y axis as axis, with the origin half way up. The functions below make shapes.
// They refuse NaN, infinite and negative lengths, and lengths beyond kMaxExtent. Zero lengths are allowed and give a
// segment, a disc or a point.
class Shape {
  public:
    [[nodiscard]] static Result<Shape> sphere(double radius);
    // A capsule: all points within `radius` of the segment from −half_height to half_height.
    [[nodiscard]] static Result<Shape> capsule(float half_height, float radius);
    [[nodiscard]] static Result<Shape> cylinder(float half_height, float radius);
    // A cone with its apex at half_height and its disc of `radius` at −half_height.
    [[nodiscard]] static Result<Shape> cone(float half_height, float radius);
    // A box. Error: a negative half extent, with the axis as the item.
    [[nodiscard]] static Result<Shape> box(const glm::vec3& half_extents);
    // A triangle, counter-clockwise seen from its front; it may be a segment or a point. The item of an error is the
    // corner.
    [[nodiscard]] static Result<Shape> triangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c);
    [[nodiscard]] static Shape hull(const Hull& hull);
    // The half-space { x : dot(normal, x) + offset ≥ 0 }. `normal` points into the solid, as everywhere, and has any
    // length but 0. Level ground at height h is {{0, -1, 0}, h}: planes of many engines point out of the solid.
    [[nodiscard]] static Result<Shape> half_space(const Plane& plane);
    // All points within `radius` of `core`, which is of any convex kind except a half-space.
    [[nodiscard]] static Result<Shape> rounded(const Shape& core, double radius);
    // The triangles of a mesh: a surface, even if it is closed. Error: a tree without triangles.
    [[nodiscard]] static Result<Shape> mesh(const mesh::MeshTree& mesh, Sides sides = Sides::both);
    // The triangles of a height field, whose fronts face up.
    [[nodiscard]] static Shape height_field(const HeightField& field, Sides sides = Sides::front);
    [[nodiscard]] static Shape compound(const Compound& compound);  // the union of its children

    [[nodiscard]] Kind kind() const { return kind_; }
    // Returns true for a single convex shape, and false for a shape of several convex parts.
    [[nodiscard]] bool is_convex() const { return kind_ < Kind::mesh; }
    [[nodiscard]] Sides sides() const { return sides_; }  // of a surface; else both
    [[nodiscard]] const mesh::MeshTree* mesh() const { return mesh_; }
    [[nodiscard]] const HeightField* height_field() const { return field_; }
    [[nodiscard]] const Compound* compound() const { return compound_; }
    // Returns the bounds of the shape in its frame, rounded outward. They are infinite for half-spaces and for
    // compounds that contain one.
    [[nodiscard]] const Aabb& bounds() const { return bounds_; }
    [[nodiscard]] bool is_bounded() const { return core_radius_ < kInfiniteRadius; }
    [[nodiscard]] double radius() const { return radius_; }  // of the rounding; of spheres and capsules
    [[nodiscard]] const Hull* hull() const { return hull_; }
    [[nodiscard]] const Plane& plane() const { return plane_; }
    // Returns the half extents of a box; for cylinders and cones: radius, half height, radius.
    [[nodiscard]] const glm::dvec3& half_extents() const { return half_; }
    // Tests whether the core, the shape without its rounding, is the hull of finitely many points.
    [[nodiscard]] bool has_polytope_core() const { return vertex_count_ > 0; }
    [[nodiscard]] bool is_polytope() const { return vertex_count_ > 0 && radius_ == 0.0; }
    [[nodiscard]] int vertex_count() const { return vertex_count_; }  // of the core: sphere 1, capsule 2, box 8
    [[nodiscard]] glm::dvec3 vertex(int i) const {
        const std::size_t at = static_cast<std::size_t>(i);
        return {column(0)[at], column(1)[at], column(2)[at]};
    }
    // Returns coordinate k of all vertices. Corner i of a box is on the + side of axis k if bit k of i is set.
    [[nodiscard]] const double* column(int k) const { return hull_ != nullptr ? hull_->column(k) : corners_[k]; }
    [[nodiscard]] int padded_count() const { return hull_ != nullptr ? hull_->padded_count() : padded_; }
    // Returns the radius of the sphere around the frame's origin that contains the core, rounded up; infinite if
    // bounds() are.
    [[nodiscard]] double core_radius() const { return core_radius_; }

  private:
    friend struct ShapeMaker;
    Shape() = default;
    void set_corners(std::span<const glm::dvec3> corners);
    void set_core_radius_of_bounds();

    Kind kind_ = Kind::sphere;
    Sides sides_ = Sides::both;
    int vertex_count_ = 0, padded_ = 0;
    double radius_ = 0.0, core_radius_ = 0.0;
    glm::dvec3 half_{0.0};
    Plane plane_;
    Aabb bounds_;
    const Hull* hull_ = nullptr;
    const mesh::MeshTree* mesh_ = nullptr;
    const glm::dmat3* map_ = nullptr;  // of the mesh; nullptr: none
    const HeightField* field_ = nullptr;
    const Compound* compound_ = nullptr;
    double corners_[3][8] = {};
};

// One of the convex parts of a shape, by number.
struct PartId {
    // The child of a compound, or 0. Children of nested compounds are counted in the place of their compound.
    std::uint32_t child;
    std::uint32_t triangle;  // of a mesh or height field; else 0
    auto operator<=>(const PartId&) const = default;
};

// Ground, given by heights at the corners of square or rectangular cells of two triangles each.

inline constexpr std::uint8_t kHole = 255;  // as a cell's material: nothing is there

struct HeightFieldDescription {
    std::uint32_t columns = 0, rows = 0;           // corners along x and along z, in [2, 32768]
    std::span<const float> heights = {};           // y of the corners, row by row: columns · rows of them
    glm::dvec2 spacing{1.0};                       // between corners along x and z, in [1e-6, 1e6]
    std::span<const std::uint8_t> materials = {};  // of the cells, row by row: (columns − 1)(rows − 1); empty: all 0
};

// A height field. Corner (i, j) is at (i · spacing.x, height, j · spacing.y), each rounded to double. Cell c = j
// (columns − 1) + i has triangles 2c and 2c + 1; 2c lies on the side of its corner (i, j). Their common edge leads from
// (i + 1, j) to (i, j + 1).
class HeightField {
  public:
    // Builds a height field; copies the arrays. Errors: sizes out of range or that do not match; a height that is NaN,
    // infinite or beyond kMaxExtent (item: the first such corner); a field that consists of holes only.
    [[nodiscard]] static Result<HeightField> build(const HeightFieldDescription& description);

    [[nodiscard]] std::uint32_t columns() const { return columns_; }
    [[nodiscard]] std::uint32_t rows() const { return rows_; }
    [[nodiscard]] std::uint32_t cell_count() const { return (columns_ - 1) * (rows_ - 1); }
    [[nodiscard]] std::uint8_t material(std::uint32_t cell) const { return materials_.empty() ? 0 : materials_[cell]; }
    [[nodiscard]] glm::dvec3 corner(std::uint32_t column, std::uint32_t row) const {
        return {static_cast<double>(column) * spacing_.x,
                static_cast<double>(heights_[std::size_t{row} * columns_ + column]),
                static_cast<double>(row) * spacing_.y};
    }
    [[nodiscard]] Triangle triangle(std::uint32_t index) const;  // counter-clockwise seen from above
    [[nodiscard]] const Aabb& bounds() const { return bounds_; }

  private:
    friend class FieldSearch;
    friend class FieldDescent;
    struct Span {
        float low, high;  // of heights; low > high where all cells are holes
    };
    struct Level {
        std::uint32_t columns, rows;
        std::size_t first;  // of spans_
    };
    [[nodiscard]] Span span_of(std::uint32_t column, std::uint32_t row) const;  // of a block of 4 × 4 cells
    void build_levels();

    std::uint32_t columns_ = 0, rows_ = 0;
    glm::dvec2 spacing_{1.0};
    Aabb bounds_;
    Vector<float> heights_;
    Vector<std::uint8_t> materials_;
    // Least and greatest heights of blocks of 4 × 4 cells, then of 4 × 4 of these blocks, up to one.
    Vector<Level> levels_;
    Vector<Span> spans_;
};

// Several shapes as one.

inline constexpr int kMaxCompoundDepth = 16;

struct CompoundChild {
    Shape shape;
    RigidTransform pose;  // in the compound's frame
};

// A compound, with a tree over its children. A child's pose in the world is the product of the poses, rounded to
// double.
class Compound {
  public:
    // Builds a compound. It copies the children; the objects that they are views of stay yours. A half-space is
    // infinite ground: the compound then has no finite bounds.
    //
    // Errors: no children; a pose that is not valid or mirrors; compounds nested deeper than kMaxCompoundDepth (item:
    // the child).
    [[nodiscard]] static Result<Compound> build(std::span<const CompoundChild> children);

    [[nodiscard]] std::span<const CompoundChild> children() const { return children_; }
    [[nodiscard]] int depth() const { return depth_; }  // 1: no compound within
    // Returns the number of children that are not compounds, those of nested compounds included. PartId::child is less.
    [[nodiscard]] std::uint32_t part_count() const { return part_count_; }
    // Returns the child of that number, with its pose in its own compound. Requires part < part_count().
    [[nodiscard]] const CompoundChild& part(std::uint32_t part) const;
    [[nodiscard]] const Aabb& bounds() const { return bounds_; }  // infinite with half-spaces

  private:
    friend class CompoundSearch;
    friend class CompoundRay;
    struct Node {
        Aabb box;
        std::uint32_t begin = 0, end = 0;  // of order_; all children below
        std::uint32_t right = 0;           // the left one follows at once; 0: a leaf
    };
    void split(std::uint32_t begin, std::uint32_t end, std::span<const Aabb> boxes);

    Vector<CompoundChild> children_;
    Vector<std::uint32_t> first_part_;  // by child
    Vector<Node> nodes_;                // of the bounded children; may be none
    Vector<std::uint32_t> order_;       // bounded children
    Vector<std::uint32_t> unbounded_;   // children that hold half-spaces
    Aabb bounds_;
    std::uint32_t part_count_ = 0;
    int depth_ = 0;
    bool has_surfaces_ = false;
};

// Returns the mass properties of a shape, by exact formulas, rounded. A triangle has volume 0.
//
// For compounds it is the sum over the children: a volume that two children share counts twice. The inertia of a
// compound about the axis of a child that is h times as long as thick is off by h² roundings. Errors: half-spaces,
// meshes and height fields, which have no volume (`unsupported`; for a compound's child the item is the child).
[[nodiscard]] Result<MassProperties> mass_properties(const Shape& shape);

// Returns the farthest point of the shape along `direction`, in the shape's frame. `direction` is finite and of any
// length; for length 0, returns some point of the shape. For all convex shapes except half-spaces.
[[nodiscard]] glm::dvec3 support_point(const Shape& shape, const glm::dvec3& direction);

}  // namespace crofton::convex
