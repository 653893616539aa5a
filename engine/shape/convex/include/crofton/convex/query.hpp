// SPDX-License-Identifier: MIT
// Questions asked of two bodies: meet, distance, depth, contacts, casts.
#pragma once
#include <cmath>
#include <compare>
#include <crofton/convex/body.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

namespace crofton::convex {

// ---- Overlap, distance, depth ----

// A body where it stands: the image of its stored points under the stored pose, all taken as reals. Poses are valid
// and without reflection, as validate_pose tells. A rotation that is orthonormal to 1e-6 alone skews the stored points
// as it says; a body's rounding keeps its radius. Alive for the call only.
struct BodyAtPose {
    const Body& body;
    const RigidTransform& pose;
};

// As validate(RigidTransform), and refuses a pose that mirrors: it would turn the body inside out.
[[nodiscard]] Result<void> validate_pose(const RigidTransform& pose, std::uint64_t item = kNoItem);

// A pair's memory from one call to the next: it makes calls faster and changes no answer of `intersects`. Numbers
// stay within their stated bounds. Zero-initialised for a new pair; belongs to one pair in one order, and to one thread
// at a time.
struct PairCache {
    glm::dvec3 axis{0.0};  // from a to b, where the bodies were last apart or least deep
    std::uint16_t on_a[4] = {}, on_b[4] = {};
    std::uint16_t count = 0;
    // Of a manifold: whose face it lies on, that of a (1) or of b (2), and which.
    std::uint16_t reference = 0, face = 0;
    std::uint32_t chosen[4] = {};  // and its points, where there were more than were wanted
};

// Touching counts. Exact for two polytopes and for a polytope and a half-space. Where a body is round, a gap or overlap
// below 1e-11 of the size, with cylinders and cones 1e-7, may be told either way. It is told the same way by
// `intersects`, `distance`, `penetration` and manifolds, with a cache or without, and in either order of the bodies.
// The size of a pair is the sum of the bodies' reaches and of the offset between their origins. Two half-spaces: exact
// where the normals' rounded cross product is not 0, as they meet then. A body of parts meets what one of its parts
// meets: as exact as these. A pose with NaN meets nothing.
[[nodiscard]] bool intersects(const BodyAtPose& a, const BodyAtPose& b, PairCache* cache = nullptr);

struct Distance {
    double distance = 0.0;  // between on_a and on_b; 0 iff the bodies meet
    // Proven: the true distance lies between. Of round bodies that are told to meet (see intersects) both are 0, though
    // they may be 1e-11 of the size apart, cylinders and cones 1e-7.
    double lower = 0.0, upper = 0.0;
    glm::dvec3 on_a{0.0}, on_b{0.0};  // nearest points; of bodies that meet, a common point up to 1e-9 of the size
    glm::dvec3 normal{0.0};           // unit, from a to b; 0 of bodies that meet
    PartId part_a{}, part_b{};        // the nearest parts of bodies of parts
};
// upper − lower ≤ 1e-9 of the size for polytopes, also rounded ones. Gilbert, Johnson,
// Keerthi 1988; where double does not reach the bound, in exact arithmetic. Half-spaces that do not meet: parallel
// ones. Of bodies of parts: of the nearest parts; caches are not used.
[[nodiscard]] Distance distance(const BodyAtPose& a, const BodyAtPose& b, PairCache* cache = nullptr);

// The shortest motion of b that ends the overlap: depth · normal.
struct Penetration {
    bool overlapping = false;  // as `intersects`; all else is 0 where it is not
    double depth = 0.0;
    double lower = 0.0, upper = 0.0;  // proven: the true depth lies between
    glm::dvec3 normal{0.0};           // unit, from a to b
    glm::dvec3 on_a{0.0}, on_b{0.0};  // deepest points: on_a − on_b = depth · normal
    PartId part_a{}, part_b{};        // of bodies of parts: those that are deepest in each other
};
// upper − lower ≤ 1e-9 of the size for polytopes, also rounded ones. 1e-5 for cylinders and cones, but 1e-3 where all
// ways out around an axis are as long. Expanding polytope (van den Bergen 2001), checked afterwards from both sides;
// where that fails, all separating axes. A sphere whose center lies in a box, hull, cylinder or cone, and a capsule
// whose segment meets a box: in closed form. Two half-spaces overlap without end: depth, lower and upper are infinite.
// Of bodies of parts: of the two deepest. `lower` holds for the bodies; `upper` is infinite: parts may be pushed into
// others.
[[nodiscard]] Penetration penetration(const BodyAtPose& a, const BodyAtPose& b, PairCache* cache = nullptr);

// From a point (in the world) to the body: a is the point.
[[nodiscard]] Distance closest_point(const BodyAtPose& body, const glm::dvec3& point);

// Where a ray first meets a body.
struct RayHit {
    double t = 0.0;          // the ray's: in [0, max_t]
    glm::dvec3 point{0.0};   // at t; on the body's surface
    glm::dvec3 normal{0.0};  // unit, of the surface there, to the side that the ray comes from; 0 if it began inside
    bool started_inside = false;
    PartId part{};  // that is met; of several at the same t the lowest
};
// Returns the first point of the ray in the body, or nothing.
//
// A ray that begins in a solid body has started inside: t is 0, the point is its origin, the normal is 0. "In" is said
// as by `intersects` of a sphere of radius 0 at the origin, of cylinders and cones by their distance, within 1e-15 of
// the size. Triangles, meshes and height fields have no inside: a ray that begins within one hits the nearest triangle.
// A ray that lies in the plane of a triangle does not hit that triangle, as in mesh::raycast. One-sided triangles are
// passed from behind.
//
// The point is the ray's first in a body that is larger or smaller by at most 1e-13 of its size, where the size is
// core_radius() and radius() together (of half-spaces: the distances from the frame's origin to the ray's, and from
// there to the point). So a ray that passes the surface nearer than that may hit or miss, and t · |direction| is off by
// at most that by the cosine between the ray and the normal, and 2^-51 of itself. This holds however far away the ray
// begins, and for directions of any length. Rays within a surface meet its triangles exactly, so that nothing slips
// through between two that share an edge. No allocation. Nothing is hit by a ray whose origin or direction is NaN or
// infinite, whose direction is 0, or whose max_t is NaN or negative, nor at a pose that is not valid: validate(Ray) and
// validate_pose tell why.
[[nodiscard]] std::optional<RayHit> raycast(const BodyAtPose& body, const Ray& ray);

// ---- Contacts ----

// A vertex, edge or face of a body. Of hulls the indices are the hull's. Of boxes: a vertex is a corner number; edge 4k
// + j runs along axis k; face 2k + s is across axis k, on the + side for s = 1. Of a triangle: edge k leads from corner
// k to the next, the face is 0. Of capsules: the ends are vertices 0 and 1, the side is edge 0. Of cylinders and cones:
// face 0 is the lower disc, 1 the upper. A disc's rim is edges 0 to 7 (lower) and 8 to 15, an eighth of a turn each;
// its vertices have the same numbers. Edge 16 is that of the side, between vertices 16 (lower) and 17. Half-spaces:
// face 0.
enum class FeatureKind : std::uint8_t { vertex, edge, face };
struct Feature {
    FeatureKind kind;
    std::uint16_t index;
    auto operator<=>(const Feature&) const = default;
};

struct ContactPoint {
    glm::dvec3 position;  // midway between the surfaces, in the world
    double depth;         // along the normal; negative: a gap
    // Together the point's id: the same for as long as the same features touch. Features are those of the parts.
    Feature on_a, on_b;
    PartId part_a, part_b;
};

struct Manifold {
    glm::dvec3 normal{0.0};  // unit, from a to b
    double depth = 0.0;      // of the deepest point
    int count = 0;           // 0 when the bodies are farther apart than the margin
    ContactPoint points[8];  // of which the first `count` are set
};

struct ManifoldOptions {
    double margin = 0.0;  // ≥ 0: points with a gap of up to this are told, too, with negative depth
    int max_points = 4;   // in [1, 8]: the deepest, and those that keep most of the area
};

// The normal is that of `penetration` or `distance`, and the manifold as deep. The faces that look along it are clipped
// against each other (Sutherland, Hodgman); the deepest point is among the points. Bodies that meet, as `intersects`
// tells, have one point at least; polytopes that do not meet have none at a margin of 0. With a cache, the face of the
// frame before is kept while its normal is proven to be the least deep. That holds within 1e-4 of the pair's size.
// Normal and depth are then those of that face. With a cache and more points than are wanted, those of the frame
// before stay. One of them must be as deep within 1e-4 of the size, and they must span nine tenths of the area. Points
// are off by 1e-9 of the pair's size, by 1e-5 where a hull's face is not quite flat (HullOptions). With cylinders and
// cones they are off by as much as the depth may be. Round sides that are parallel within 2 degrees have a point at
// each end of their common stretch. It is midway between them, also where they pass each other. Round sides are those
// of capsules, cylinders and cones, and the edges of rounded bodies. Beside a sharp edge this holds where the two lie
// on each other. Of bodies of parts: the deepest of the manifolds below; this allocates.
[[nodiscard]] Manifold contact_manifold(const BodyAtPose& a, const BodyAtPose& b, const ManifoldOptions& options = {},
                                        PairCache* cache = nullptr);

// One part of a body, where it stands.
struct Part {
    Body body;  // convex
    RigidTransform pose;
    PartId id{};
    Sides sides = Sides::both;
};

// Where two bodies touch, one of them of parts: one manifold for each direction. Memory is kept from call to call.
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

// Replaces what `found` has. Parts whose normals agree within 5 degrees share a manifold. The deepest part comes first:
// each next part joins the manifold whose normal agrees best, within 5 degrees, else it begins its own. So a point's
// own normal is within 5 degrees of its manifold's, which is that of its deepest point, and no two manifolds agree as
// well. Each depth is along its own part's normal. Two convex bodies: one manifold, or none. On the edges and vertices
// of a surface the internal-edge rule holds. Where a contact's normal would point into the surface beside it, the
// triangle pushes along its face's normal. So what slides over a floor of many triangles meets the floor alone. Where
// the rule would leave a body that meets the surface without any point, it does not hold. Between triangles of two
// surfaces it is the second's rule. Neighbours are triangles of the same body that share vertices of equal position.
// Convex children of compounds that lie flush, within 2^-22 of their size, or overlap, touch as their union does: a
// contact that its neighbours cover gives way to one that parts the pair as well, or to the least deep face that is
// free. So what slides over a floor of flush boxes meets one plane; walls, steps and gaps wider than that push
// sideways. Deep within the parts, or where no other is found, the contact stays. Surfaces with Sides::front push to
// the front, and only bodies whose center is there (of mass for hulls; else the middle of the bounds). The cache serves
// two convex bodies. No allocation once `found` has seen as many parts.
void contact_manifolds(const BodyAtPose& a, const BodyAtPose& b, const ManifoldOptions& options, Manifolds& found,
                       PairCache* cache = nullptr);

// Bodies that lie flush with a and touch b, and the other way round, as tiles of a floor do.
struct Beside {
    std::span<const BodyAtPose> a, b;
};
// As above, where a and those beside it touch as their union does, like children of a compound; so do b and those
// beside it. Replaces `found` by the contacts of a and b, at least one where they meet. Ask each pair with the others
// beside it. Meshes, height fields, half-spaces and bodies that overlap by more than rounding to float take no part in
// it.
void contact_manifolds(const BodyAtPose& a, const BodyAtPose& b, const Beside& beside, const ManifoldOptions& options,
                       Manifolds& found, PairCache* cache = nullptr);

// Replaces `parts` by the parts of a body that may be within `margin` ≥ 0 of another: all that are, and some more.
void parts_near(const BodyAtPose& body, const BodyAtPose& other, double margin, Vector<Part>& parts);

// What a pair's contact points are from step to step.
struct TrackedPoint {
    ContactPoint contact{};
    glm::dvec3 normal{0.0};  // its manifold's
    bool began = true;       // its id was not there in the step before
    float memory[4] = {};    // the caller's, as impulses for a warm start: 0 when the point begins, kept while it stays
};
// Replaces `points`, of the step before, by those of the manifolds; of the same id they keep their memory. Returns how
// many have ended. Allocates nothing once `points` has room for two steps.
std::size_t track(std::span<const Manifold> manifolds, Vector<TrackedPoint>& points);

// For debug drawing: told of lines, in the world.
using LineVisitor = FunctionRef<void(const glm::dvec3& from, const glm::dvec3& to)>;
// The edges of a body and of its parts. What is round is drawn as circles, in pieces of a 24th. A rounded polytope's
// faces are drawn where they are, `radius` out. A half-space is drawn as its normal and a square of 20 around the point
// nearest to its frame's origin. Surfaces and compounds allocate.
void outline(const BodyAtPose& body, LineVisitor line);
// At each point its normal from surface to surface, with a cross of size `size` across it.
void outline(std::span<const TrackedPoint> points, double size, LineVisitor line);

// ---- Casts ----

// A body's motion from its pose on. Its `pivot` (in the body's frame: the center of mass) moves by velocity · t. The
// body turns about it by |spin| · t radians around `spin` (world axes). Zero: it rests. Any number of turns.
struct Motion {
    glm::dvec3 velocity{0.0};
    glm::dvec3 spin{0.0};
    glm::dvec3 pivot{0.0};
};

// Where the body is at time t, rounded: the translation to the last digits of its coordinates, the rotation by 1e-15 a
// radian.
[[nodiscard]] RigidTransform moved(const RigidTransform& pose, const Motion& motion, double time);

struct CastOptions {
    double duration = 1.0;    // ≥ 0, finite
    double tolerance = 1e-6;  // > 0, in lengths: how far apart the bodies may still be at the time of a hit
    int max_steps = 500;      // ≥ 1
    // Leaves out bodies, or parts of bodies, that overlap at time 0 or are within the tolerance then. They are left out
    // of the whole cast, also if they part and meet again.
    bool ignore_initial_overlaps = false;
    // Hits after this time are not sought, and are told as a miss. Whoever asks many bodies for the first hit passes
    // the time of the first hit so far. It changes no hit up to it. ≥ 0.
    double early_out = HUGE_VAL;
};

enum class CastResult : std::uint8_t {
    miss,        // proven: the bodies do not touch in [0, duration]; for bodies that begin in contact see `cast`
    hit,         // at `time` they are within the tolerance, at no time before do they touch, and they go on to touch
    unresolved,  // max_steps were not enough: before `time` they do not touch; later is not known
};
struct Impact {
    CastResult result = CastResult::miss;
    double time = 0.0;  // of a miss: the duration, or early_out if that is less
    // Where the bodies are at that time; all 0 for a miss. The normal is the direction that parts them, as `distance`
    // or, for overlapping bodies, `penetration` tells.
    glm::dvec3 normal{0.0};           // unit, from a to b
    glm::dvec3 on_a{0.0}, on_b{0.0};  // nearest points, on the surfaces: on_b − on_a = distance · normal
    double distance = 0.0;            // gap at that time; negative: how deep they overlap, from the start
    int steps = 0;                    // of bodies of parts: of the pair of parts that hit
    PartId part_a{}, part_b{};        // that hit
};

// Conservative advancement (Mirtich 1996) by a bound of second order. Each step ends before any vertex can have crossed
// the plane that parts the bodies. That follows from its velocity across the plane and a bound of its acceleration. So
// no wall is too thin. As `intersects`, a hit may be off by 1e-7 of the size with cylinders and cones. "Touch" is said
// of the bodies as they move in real arithmetic from their stored poses, wherever they are; `moved` rounds. Rounding
// grows with the bodies, their gap, and their ways and turns as seen from a: below 1e-13 of (size + |pivot|) · (1 +
// angle) + way. A gap that small may be told as a hit, never a touch as a miss.
//
// A hit is told up to the tolerance before the touch, with half the tolerance between the bodies where they can be
// stopped there. So a body that stops at a hit can go on from there:
// - Bodies that begin within the tolerance, touching or overlapping by less than it, hit at time 0 if they move into
//   each other, with the normal and the true gap. If they part or move along each other, within rounding, they do not
//   hit: a box slides, a wheel rolls, a top spins on the floor.
// - Bodies that begin overlapping by the tolerance or more hit at time 0, wherever they move. The normal and `distance`
//   are the shortest way out; of bodies with parts, that of the deepest parts.
// - Bodies that rest, and casts of duration 0, tell whether the bodies are within the tolerance.
// - Bodies that turn and stay within the tolerance hit where 32 steps do not prove that they pass.
//
// Bodies of parts: the first time at which parts touch. What begins in contact with a part, and slides along it, passes
// all parts that lie in the plane of that contact or behind it, within the tolerance or 2^-22 of their size. So nothing
// on a floor of flush parts stops a slide, and a hit at time 0 has the normal of the floor. A one-sided triangle that
// is first touched from behind is passed through. Errors: NaN or infinite motions, a turn beyond 1e5 radians, options
// out of range, half-spaces turned.
[[nodiscard]] Result<Impact> cast(const BodyAtPose& a, const Motion& motion_a, const BodyAtPose& b,
                                  const Motion& motion_b, const CastOptions& options = {}, PairCache* cache = nullptr);
// As above, where b and the bodies beside it are one surface to slide on, like parts of one body; so are a and those
// beside it. They move by the velocity of that body. Ask each pair with the others beside it that the cast begins in
// contact with. A hit at time 0 that one of these tells better is a miss.
[[nodiscard]] Result<Impact> cast(const BodyAtPose& a, const Motion& motion_a, const BodyAtPose& b,
                                  const Motion& motion_b, const CastOptions& options, const Beside& beside,
                                  PairCache* cache = nullptr);

}  // namespace crofton::convex
