// SPDX-License-Identifier: MIT
// One bound, or many, against a view: verdicts, limits of what is worth drawing, and what a query cost.
#pragma once
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/core/version.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/shapes.hpp>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <span>

namespace crofton::convex {
class Hull;
}

namespace crofton::cull {

// ---- Verdicts ----

enum class Verdict : std::uint8_t { outside, straddling, inside };

enum class CullMode : std::uint8_t {
    conservative,  // outside iff one plane rejects the box, exactly; keeps some boxes near the frustum's edges and
                   // corners
    exact,         // outside iff box and frustum are disjoint
};

// Exact for the boxes' and planes' stored numbers: `outside` as the mode says, `inside` iff the frustum contains the
// box; touching from outside is straddling. A box or a frustum that is not finite, or beyond 1e30 (a plane's
// offset: 1e50), is `straddling`: never lost. So is every bound where a plane's normal, which need not be of unit
// length, has a component above 2 in magnitude: divide normal and offset by its length. Planes decide most boxes in
// double with a proven error bound. The rest go through the separating-axis test (Gottschalk, Lin, Manocha 1996). Where
// rounding could still matter, exact arithmetic decides.
[[nodiscard]] Verdict classify(const Frustum& frustum, const Obb& box, CullMode mode = CullMode::exact);

// The same for axis-aligned boxes and for spheres. An empty Aabb and a negative radius are `straddling`, as is what is
// not finite. `inside` and `outside` are exact for a sphere too, with two exceptions. Numbers of the sphere or the view
// that are not 0 but below 1e-60 in magnitude may leave it `straddling` though an edge rejects it. So may a view whose
// half-spaces have no point in common while each three of them do: a camera's always have.
[[nodiscard]] Verdict classify(const Frustum& frustum, const Aabb& box, CullMode mode = CullMode::exact);
[[nodiscard]] Verdict classify(const Frustum& frustum, const Sphere& sphere, CullMode mode = CullMode::exact);

// The same for a convex hull, as where k-DOPs or other bounds of the user's are kept, in the frustum's coordinates:
// exact for its vertices. A microsecond where planes leave it open: for bounds that are tested once, not for lists.
[[nodiscard]] Verdict classify(const Frustum& frustum, const convex::Hull& hull, CullMode mode = CullMode::exact);

// As above for many boxes: writes verdicts[i] for boxes[i]. Allocates nothing; may run on any thread.
// Requires verdicts.size() == boxes.size().
void classify(const Frustum& frustum, std::span<const Obb> boxes, std::span<Verdict> verdicts,
              CullMode mode = CullMode::exact);

// ---- Statistics ----

#if defined(CROFTON_NO_STATISTICS)
inline constexpr bool kCountStatistics = false;  // every number below stays 0, and counting costs nothing
#else
inline constexpr bool kCountStatistics = true;
#endif

// The same on every processor but for exact_tests: how many items are too near to call in floats depends on whether the
// processor fuses products with sums.
struct Statistics {
    std::uint64_t nodes_tested = 0;     // bounds of inner nodes and leaves against planes
    std::uint64_t boxes_tested = 0;     // items' boxes against planes
    std::uint64_t accepted_whole = 0;   // items reported because a node above them is inside
    std::uint64_t straddling = 0;       // items reported as straddling
    std::uint64_t exact_tests = 0;      // items that went through the second stage
    std::uint64_t false_positives = 0;  // items that no plane rejects and that are outside all the same (mode exact)

    Statistics& operator+=(const Statistics& other) {
        nodes_tested += other.nodes_tested;
        boxes_tested += other.boxes_tested;
        accepted_whole += other.accepted_whole;
        straddling += other.straddling;
        exact_tests += other.exact_tests;
        false_positives += other.false_positives;
        return *this;
    }
};

// Bit i % 64 of word i / 64 is bound i's.
struct VerdictBits {
    Vector<std::uint64_t> visible;  // not outside
    Vector<std::uint64_t> inside;
    Statistics statistics;

    [[nodiscard]] Verdict verdict(std::size_t i) const {
        if (!(visible[i / 64] >> (i % 64) & 1)) return Verdict::outside;
        return inside[i / 64] >> (i % 64) & 1 ? Verdict::inside : Verdict::straddling;
    }

    Vector<Statistics> by_chunk;  // for the query's own use
};

// ---- Draw limits: leave out what is too small or too far ----

// An item's radius r is half its box's diagonal, √(h₀² + h₁² + h₂²) of its half extents; its distance d is that of its
// box's centre from `eye`. The item is dropped if d > max_distance_in_radii · r, if d > item_distances[id], if r <
// least_radius, or if d > layer_distances[l] for every layer l that it shares with the view. All of it exactly, for the
// stored numbers taken as reals; on a limit it is kept. Limits that are not finite or beyond 1e30 do not count, nor do
// any for a box or an eye that is not finite. Negative ones are 0.
struct DrawLimits {
    static constexpr double kNone = std::numeric_limits<double>::infinity();
    glm::dvec3 eye{0.0};  // of the camera whose picture counts: for its shadows' views too
    double max_distance_in_radii = kNone;
    double least_radius = 0.0;
    std::span<const float> layer_distances = {};  // 32, or none
    std::span<const float> item_distances = {};   // one per item id, or none
    // Hysteresis: for items whose bit is set (id % 64 of word id / 64; beyond the end none is) distances are
    // `hysteresis` times as long and least_radius as much smaller. Give the last frame's visible items (to_bits), and
    // what goes in and out at a limit flickers no more. Requires hysteresis ≥ 1.
    std::span<const std::uint64_t> drawn_before = {};
    double hysteresis = 1.0;
};

// Drops what is below `pixels` in a picture `picture_height` pixels high. In perspective: items whose sphere of radius
// r has a diameter of less than `pixels`. It is seen from its distance, in the middle of the picture. A sphere
// elsewhere in the picture is drawn larger, but is judged as if in its middle. Orthographic: items whose 2 r is less.
// Up to rounding of `max_distance_in_radii` or `least_radius` by 2^-50. Errors: as validate(Camera); a height or size
// that is not positive and finite.
[[nodiscard]] Result<DrawLimits> limits_of(const Camera& camera, double picture_height, double pixels);

// The test of one item, in these layers of it that the view sees.
[[nodiscard]] bool is_worth_drawing(const DrawLimits& limits, const Obb& box, boxtree::ItemId item,
                                    std::uint32_t common_layers = ~std::uint32_t{0});
// An Aabb counts by its centre and half extents, rounded to double.
[[nodiscard]] bool is_worth_drawing(const DrawLimits& limits, const Aabb& box, boxtree::ItemId item,
                                    std::uint32_t common_layers = ~std::uint32_t{0});
[[nodiscard]] bool is_worth_drawing(const DrawLimits& limits, const Sphere& sphere, boxtree::ItemId item,
                                    std::uint32_t common_layers = ~std::uint32_t{0});

}  // namespace crofton::cull
