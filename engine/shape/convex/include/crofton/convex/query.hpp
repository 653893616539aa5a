// SPDX-License-Identifier: MIT
// Queries of shapes: overlap, distance, depth, rays, contacts, casts.
#pragma once
#include <cmath>
#include <compare>
#include <crofton/convex/shape.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

namespace crofton::convex {

// ---- Overlap, distance, depth ----

// A shape at a pose: the image of its stored points under the stored pose, all taken as reals. Alive for the call only.
//
// Poses are valid and without reflection, as validate_pose checks. A rotation that is orthonormal only to 1e-6 skews
// the stored points accordingly; a shape's rounding keeps its radius.
struct ShapeAtPose {
    const Shape& shape;
    const RigidTransform& pose;
};

// Checks a pose. Errors: as validate(RigidTransform); a pose that mirrors, because it would turn the shape inside out.
[[nodiscard]] Result<void> validate_pose(const RigidTransform& pose, std::uint64_t item = kNoItem);

// Data that a pair keeps from one call to the next. It makes calls faster and changes no answer of `intersects`;
// numbers stay within their stated bounds. Zero-initialise it for a new pair. It belongs to one pair in one order, and
// to one thread at a time.
struct PairCache {
    glm::dvec3 axis{0.0};  // from a to b, where the shapes were last apart or least deep
    std::uint16_t on_a[4] = {}, on_b[4] = {};
    std::uint16_t count = 0;
    // For a manifold: the shape whose face it lies on, a (1) or b (2), and the face.
    std::uint16_t reference = 0, face = 0;
    std::uint32_t chosen[4] = {};  // and its points, where there were more than were wanted
};

// Tests whether two shapes share a point; touching counts. Returns false for a pose with NaN.
//
// Exact for two polytopes, and for a polytope and a half-space. If a shape is round, a gap or overlap below 1e-11 of
// the size (1e-7 with cylinders and cones) may be decided either way. `intersects`, `distance`, `penetration` and
// manifolds decide it the same way, with a cache or without, and in either order of the shapes. The size of a pair is
// the sum of the radii of the shapes around their origins and of the distance between the origins.
//
// Two half-spaces are exact if the rounded cross product of their normals is not 0, as they overlap then. A shape of
// parts overlaps another if one of its parts does, with the same exactness.
[[nodiscard]] bool intersects(const ShapeAtPose& a, const ShapeAtPose& b, PairCache* cache = nullptr);

struct Distance {
    double distance = 0.0;  // between on_a and on_b; 0 iff the shapes overlap
    // Proved: the true distance lies between them. For round shapes that are decided to overlap (see intersects) both
    // are 0, though the shapes may be 1e-11 of the size apart, cylinders and cones 1e-7.
    double lower = 0.0, upper = 0.0;
    glm::dvec3 on_a{0.0}, on_b{0.0};  // nearest points; if the shapes overlap, a common point up to 1e-9 of the size
    glm::dvec3 normal{0.0};           // unit, from a to b; 0 if the shapes overlap
    PartId part_a{}, part_b{};        // the nearest parts of shapes of parts
};
// Returns the distance of two shapes.
//
// upper − lower ≤ 1e-9 of the size for polytopes, also rounded ones. Computed by Gilbert, Johnson, Keerthi 1988, and in
// exact arithmetic where double does not reach the bound. Half-spaces have a positive distance only if they are
// parallel. For shapes of parts it is the distance of the nearest parts; caches are not used.
[[nodiscard]] Distance distance(const ShapeAtPose& a, const ShapeAtPose& b, PairCache* cache = nullptr);

// The shortest motion of b that ends the overlap: depth · normal.
struct Penetration {
    bool overlapping = false;  // as `intersects`; if false, all other members are 0
    double depth = 0.0;
    double lower = 0.0, upper = 0.0;  // proved: the true depth lies between them
    glm::dvec3 normal{0.0};           // unit, from a to b
    glm::dvec3 on_a{0.0}, on_b{0.0};  // deepest points: on_a − on_b = depth · normal
    PartId part_a{}, part_b{};        // of shapes of parts: the parts that are deepest in each other
};
// Returns how deep two shapes overlap.
//
// upper − lower ≤ 1e-9 of the size for polytopes, also rounded ones; ≤ 1e-5 for cylinders and cones, but 1e-3 if all
// ways out around an axis are equally long. Computed by the expanding polytope algorithm (van den Bergen 2001), then
// checked from both sides; if that fails, over all separating axes. Two boxes, a sphere whose center lies in a box,
// hull, cylinder or cone, and a capsule whose segment meets a box, are computed in closed form.
//
// Two half-spaces that overlap do so without end: depth, lower and upper are infinite. For shapes of parts it is the
// depth of the two deepest parts. `lower` holds for the shapes; `upper` is infinite, because parts may be pushed into
// others.
[[nodiscard]] Penetration penetration(const ShapeAtPose& a, const ShapeAtPose& b, PairCache* cache = nullptr);

// Returns the distance from a point (in the world) to the shape; a is the point.
[[nodiscard]] Distance closest_point(const ShapeAtPose& shape, const glm::dvec3& point);

// The first hit of a ray on a shape.
struct RayHit {
    double t = 0.0;          // along the ray, in [0, max_t]
    glm::dvec3 point{0.0};   // at t; on the shape's surface
    glm::dvec3 normal{0.0};  // unit, of the surface there, towards the ray; 0 if the ray began inside
    bool started_inside = false;
    PartId part{};  // the part hit; of several at the same t the lowest
};
// Returns the first point of the ray in the shape, or nothing.
//
// A ray that begins in a solid shape has started inside: t is 0, the point is the ray's origin, and the normal is 0.
// "In" is decided as by `intersects` of a sphere of radius 0 at the origin; for cylinders and cones it is decided by
// their distance, within 1e-15 of the size. Triangles, meshes and height fields have no inside: a ray that begins
// within one hits the nearest triangle. A ray in the plane of a triangle does not hit that triangle, as in
// mesh::raycast. A ray passes through one-sided triangles from behind.
//
// The point is the ray's first point in a shape that is larger or smaller by at most 1e-13 of its size. The size is
// core_radius() plus radius(); for half-spaces it is the distances from the frame's origin to the ray's, and from there
// to the point. So a ray that passes closer to the surface than that may hit or miss. t · |direction| is off by at most
// that divided by the cosine between the ray and the normal, and by 2^-51 of itself. This holds for origins within 1e18
// sizes of the shape, and for directions of any length; a ray from farther away is shifted by up to 2^-102 of that
// distance. Rays hit the triangles of a surface exactly, so that nothing slips through between two that share an edge.
// No allocation.
//
// Hits nothing if the ray's origin or direction is NaN or infinite, the direction is 0, max_t is NaN or negative, or
// the pose is not valid: validate(Ray) and validate_pose say why.
[[nodiscard]] std::optional<RayHit> raycast(const ShapeAtPose& shape, const Ray& ray);

// ---- Contacts ----

// A vertex, edge or face of a shape.
//
// - Hulls: the indices are the hull's.
// - Boxes: a vertex is a corner number; edge 4k + j runs along axis k; face 2k + s is across axis k, on the + side for
//   s = 1.
// - Triangles: edge k leads from corner k to the next; the face is 0.
// - Capsules: the ends are vertices 0 and 1; the side is edge 0.
// - Cylinders and cones: face 0 is the lower disc, 1 the upper. A disc's rim is edges 0 to 7 (lower) and 8 to 15, an
//   eighth of a turn each; its vertices have the same numbers. Edge 16 is that of the side, between vertices 16 (lower)
//   and 17.
// - Half-spaces: face 0.
enum class FeatureKind : std::uint8_t { vertex, edge, face };
struct Feature {
    FeatureKind kind;
    std::uint16_t index;
    auto operator<=>(const Feature&) const = default;
};

struct ContactPoint {
    glm::dvec3 position;  // midway between the surfaces, in the world
    double depth;         // along the normal; negative: a gap
    // Together the point's id. It stays the same while the same features touch. Features are those of the parts.
    Feature on_a, on_b;
    PartId part_a, part_b;
};

struct Manifold {
    glm::dvec3 normal{0.0};  // unit, from a to b
    double depth = 0.0;      // of the deepest point
    int count = 0;           // 0 when the shapes are farther apart than the margin
    ContactPoint points[8];  // the first `count` are set
};

struct ManifoldOptions {
    double margin = 0.0;  // ≥ 0: also returns points with a gap of up to this, with negative depth
    int max_points = 4;   // in [1, 8]: the deepest, and those that keep most of the area
};

// Returns where two shapes touch.
//
// The normal is that of `penetration` or `distance`, and the depth of the manifold is the same. The faces that look
// along the normal are clipped against each other (Sutherland, Hodgman); the deepest point is among the points. Shapes
// that overlap, as `intersects` decides, have at least one point; polytopes that do not overlap have none at a margin
// of 0.
//
// With a cache, the face of the last frame is kept while its normal is proved to be the least deep within 1e-4 of the
// pair's size. Normal and depth are then those of that face. If there are more points than wanted, those of the last
// frame stay, provided that one of them is as deep within 1e-4 of the size, and that they span nine tenths of the area.
//
// Both ends of a point, half of its depth from its position along the normal, are on the surfaces, also under faces
// that are tilted against the normal. Points are off by 1e-9 of the pair's size, by 1e-5 if a hull's face is not quite
// flat (HullOptions), and with cylinders and cones by as much as the depth may be. Round sides (of capsules, cylinders
// and cones, and edges of rounded shapes) that are parallel within 2 degrees have a point at each end of their common
// stretch, midway between them, also where they pass each other. Next to a sharp edge this holds if the two lie on each
// other.
//
// For shapes of parts it returns the deepest of the manifolds below; this allocates.
[[nodiscard]] Manifold contact_manifold(const ShapeAtPose& a, const ShapeAtPose& b, const ManifoldOptions& options = {},
                                        PairCache* cache = nullptr);

// One part of a shape, at its pose.
struct Part {
    Shape shape;  // convex
    RigidTransform pose;
    PartId id{};
    Sides sides = Sides::both;
};

// The contacts of two shapes with parts: one manifold for each direction. Keeps its memory from call to call.
class Manifolds {
  public:
    Manifolds();
    ~Manifolds();
    Manifolds(Manifolds&&) noexcept;
    Manifolds& operator=(Manifolds&&) noexcept;
    [[nodiscard]] std::span<const Manifold> all() const { return all_; }

  private:
    friend class ManifoldFinder;
    struct Scratch;
    Vector<Manifold> all_;
    std::unique_ptr<Scratch> scratch_;
};

// Replaces `found` by the contacts of two shapes. Two convex shapes have one manifold or none. No allocation once
// `found` has seen as many parts.
//
// Parts whose normals agree within 5 degrees share a manifold. The deepest part comes first. Each next part joins the
// manifold whose normal agrees best, within 5 degrees; otherwise it begins its own. So a point's own normal is within 5
// degrees of its manifold's, which is that of its deepest point, and no two manifolds agree as well. Each depth is
// along its own part's normal.
//
// On the edges and vertices of a surface the internal-edge rule holds. Let n be the direction in which a triangle
// touches the shape. One corner is above another if it is farther along n by more than 1e-3 of their distance. V are
// the triangle's farthest corners: from the farthest on, each that none of V is above. n belongs to the surface if it
// is the face's normal (the sine is at most 1e-3), if V are all three corners, or if no triangle with all of V has a
// corner above one of V. Triangles with vertices of equal position share them.
//
// Each triangle within the margin whose n belongs to the surface has its points, so two that share the edge below a
// shape have one point each. If n points into the neighbouring surface, the triangle pushes along its face's normal
// what lies straight above it; a sphere that it touches by an edge or a vertex does not. A shape that slides over a
// floor of many triangles therefore touches only the floor. If this leaves a shape that overlaps the surface without
// any point, each triangle that it meets pushes along its face's normal, by as much as the shape reaches below the
// triangle. Between triangles of two surfaces the second surface's rule holds.
//
// Convex children of compounds that overlap or are flush, within 2^-22 of their size, touch as their union does: a
// contact that its neighbours cover is replaced by one that separates the pair as well, or by the least deep face that
// is free. A shape that slides over a floor of flush boxes touches one plane; walls, steps and wider gaps push
// sideways. Deep within the parts, or if there is no other contact, the contact stays.
//
// Surfaces with Sides::front push to the front, and push only shapes whose center is there (the center of mass for
// hulls; otherwise the middle of the bounds). A triangle with Sides::both pushes the shorter way out, so a thin shape
// that has sunk into it by more than half comes out on the other side. If triangles of such a surface would push a
// shape in directions more than a right angle apart, its center decides: all triangles that are connected over edges
// push to the side of the surface where the triangle nearest to the center sees it. Winding does not matter.
//
// The cache serves two convex shapes.
void contact_manifolds(const ShapeAtPose& a, const ShapeAtPose& b, const ManifoldOptions& options, Manifolds& found,
                       PairCache* cache = nullptr);

// Neighbours: shapes that lie flush with a and touch b, and shapes that lie flush with b and touch a, as tiles of a
// floor do.
struct Beside {
    std::span<const ShapeAtPose> a, b;
};
// Does the same if a and its neighbours touch other shapes as their union does, like children of a compound, and so do
// b and its neighbours.
//
// Replaces `found` by the contacts of a and b, at least one if they overlap. If their way out is that of a neighbour's
// contact, they have the points that no neighbour covers, and the neighbour's contact is at least as deep as they
// overlap along it. If all points are covered, one is kept, with an end at the height of one surface.
// Call it for each pair, with the others as neighbours. Meshes, height fields, half-spaces, and shapes that overlap by
// more than the rounding to float are not treated as neighbours.
void contact_manifolds(const ShapeAtPose& a, const ShapeAtPose& b, const Beside& beside, const ManifoldOptions& options,
                       Manifolds& found, PairCache* cache = nullptr);

// Replaces `parts` by the parts of a shape that may be within `margin` ≥ 0 of another: all that are, and some more.
void parts_near(const ShapeAtPose& shape, const ShapeAtPose& other, double margin, Vector<Part>& parts);

// A contact point that persists from step to step.
struct TrackedPoint {
    ContactPoint contact{};
    glm::dvec3 normal{0.0};  // its manifold's
    bool began = true;       // its id did not exist in the last step
    float memory[4] = {};    // yours, such as impulses for a warm start: 0 when the point begins, kept while it stays
};
// Replaces `points`, those of the last step, by those of the manifolds. Points with the same id keep their memory.
// Returns the number of points that have ended. Allocates nothing once `points` has room for two steps.
std::size_t track(std::span<const Manifold> manifolds, Vector<TrackedPoint>& points);

// For debug drawing: called with lines in the world.
using LineVisitor = FunctionRef<void(const glm::dvec3& from, const glm::dvec3& to)>;
// Draws the edges of a shape and of its parts.
//
// Round shapes are drawn as circles, in pieces of a 24th. The faces of a rounded polytope are drawn at their true
// place, `radius` out. A half-space is drawn as its normal and a square of 20 around the point nearest to its frame's
// origin. Surfaces and compounds allocate.
void outline(const ShapeAtPose& shape, LineVisitor line);
// Draws at each point its normal from surface to surface, with a cross of size `size` across it.
void outline(std::span<const TrackedPoint> points, double size, LineVisitor line);

// ---- Casts ----

// The motion of a shape, from its pose on. Its `pivot` (in the shape's frame: the center of mass) moves by velocity ·
// t. The shape turns about it by |spin| · t radians around `spin` (in world axes), by any number of turns. A motion of
// zero is rest.
struct Motion {
    glm::dvec3 velocity{0.0};
    glm::dvec3 spin{0.0};
    glm::dvec3 pivot{0.0};
};

// Returns the pose at time t, rounded: the translation to the last digits of its coordinates, the rotation by 1e-15 a
// radian.
[[nodiscard]] RigidTransform moved(const RigidTransform& pose, const Motion& motion, double time);

struct CastOptions {
    double duration = 1.0;    // ≥ 0, finite
    double tolerance = 1e-6;  // > 0, in lengths: how far apart the shapes may still be at the time of a hit
    int max_steps = 500;      // ≥ 1
    // Skips shapes, or parts of shapes, that overlap at time 0 or are within the tolerance then. They are skipped for
    // the whole cast, even if they separate and touch again.
    bool ignore_initial_overlaps = false;
    // Hits after this time are not searched for and are reported as a miss. To find the first hit among many shapes,
    // pass the time of the first hit so far. It changes no hit up to this time. ≥ 0.
    double early_out = HUGE_VAL;
};

enum class CastResult : std::uint8_t {
    miss,        // proved: the shapes do not touch in [0, duration]; for shapes that begin in contact see `cast`
    hit,         // at `time` they are within the tolerance and about to touch, and they do not touch earlier
    unresolved,  // max_steps was too small: they do not touch before `time`
};
struct Impact {
    CastResult result = CastResult::miss;
    double time = 0.0;  // of a miss: the duration, or early_out if that is less
    // The contact at that time; all 0 for a miss. The normal is the direction that separates the shapes, as in
    // `distance`, or in `penetration` if they overlap.
    glm::dvec3 normal{0.0};           // unit, from a to b
    glm::dvec3 on_a{0.0}, on_b{0.0};  // nearest points, on the surfaces: on_b − on_a = distance · normal
    double distance = 0.0;            // gap at that time; negative: how deep they overlap, from the start
    int steps = 0;                    // of shapes of parts: of the pair of parts that hit
    PartId part_a{}, part_b{};        // that hit
};

// Finds the first time at which two moving shapes touch, by conservative advancement (Mirtich 1996) with a bound of
// second order.
//
// Each step ends before any vertex can have crossed the plane that separates the shapes, by its velocity across the
// plane and a bound of its acceleration. So no wall is too thin. As with `intersects`, a hit may be off by 1e-7 of the
// size with cylinders and cones. "Touch" refers to the shapes as they move in real arithmetic from their stored poses,
// at any place; `moved` rounds. Rounding grows with the shapes, their gap, and their translations and rotations as seen
// from a: it stays below 1e-13 of (size + |pivot|) · (1 + angle) + way. A gap that small may be reported as a hit, but
// a touch is never reported as a miss.
//
// A hit is reported up to the tolerance before the touch, with half the tolerance between the shapes if they can be
// stopped there, so that a shape that stops at a hit can continue from there:
// - Shapes that begin within the tolerance, touching or overlapping by less than it, hit at time 0 if they move into
//   each other, with the normal and the true gap. If they separate or move along each other, within rounding, they do
//   not hit: a box slides, a wheel rolls, a top spins on the floor.
// - Shapes that begin overlapping by the tolerance or more hit at time 0, wherever they move. The normal and `distance`
//   are the shortest way out; for shapes with parts, that of the deepest parts.
// - For shapes at rest, and for casts of duration 0, the result says whether the shapes are within the tolerance.
// - Shapes that turn and stay within the tolerance hit if 32 steps do not prove that they pass.
//
// For shapes of parts it is the first time at which parts touch. A shape that begins in contact with a part and slides
// along it passes all parts that lie in the plane of that contact or behind it, within the tolerance or 2^-22 of their
// size. So no part of a floor of flush parts stops a slide, and a hit at time 0 has the normal of the floor. A shape
// passes through a one-sided triangle that it first touches from behind.
//
// Errors: NaN or infinite motions, a turn beyond 1e5 radians, options out of range, half-spaces that turn.
[[nodiscard]] Result<Impact> cast(const ShapeAtPose& a, const Motion& motion_a, const ShapeAtPose& b,
                                  const Motion& motion_b, const CastOptions& options = {}, PairCache* cache = nullptr);
// Does the same if b and its neighbours are one surface to slide on, like parts of one shape, and so are a and its
// neighbours. They move with the velocity of that shape. Call it for each pair, with the others that the cast begins in
// contact with as neighbours. A hit at time 0 that one of the neighbours describes better has the normal, distance and
// points of that neighbour, or is a miss if the shape slides on it.
[[nodiscard]] Result<Impact> cast(const ShapeAtPose& a, const Motion& motion_a, const ShapeAtPose& b,
                                  const Motion& motion_b, const CastOptions& options, const Beside& beside,
                                  PairCache* cache = nullptr);

}  // namespace crofton::convex
