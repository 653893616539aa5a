// SPDX-License-Identifier: MIT
// Tests of one bound or many against a view, draw limits, and statistics of queries.
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

namespace crofton::cull {

// ---- Verdicts ----

enum class Verdict : std::uint8_t { outside, straddling, inside };

enum class CullMode : std::uint8_t {
    conservative,  // outside iff one plane rejects the box, exactly; keeps some boxes near the frustum's edges and
                   // corners
    exact,         // outside iff box and frustum are disjoint
};

// Classifies a box against a frustum: `outside` by the mode's rule, `inside` iff the frustum contains the box, and
// `straddling` otherwise. A box that touches from outside is straddling.
//
// Exact for the stored numbers of box and planes: planes decide most boxes in double with a proven error bound; the
// rest go through the separating-axis test (Gottschalk, Lin, Manocha 1996), with exact arithmetic where rounding could
// still matter. A box or a frustum that is not finite or beyond 1e30 (a plane's offset: 1e50) is `straddling`, so it is
// never lost. So is every bound if a plane's normal has a component above 2 in magnitude; it need not have unit length,
// but divide normal and offset by its length.
[[nodiscard]] Verdict classify(const Frustum& frustum, const Obb& box, CullMode mode = CullMode::exact);

// Does the same for axis-aligned boxes and for spheres. An empty Aabb, a negative radius and a bound that is not finite
// are `straddling`.
//
// `inside` and `outside` are exact for a sphere too, with two exceptions, in which it may be `straddling` though an
// edge rejects it: the sphere or the view has nonzero numbers below 1e-60 in magnitude; or the view's half-spaces have
// no point in common although each three of them do. A camera's always have one.
[[nodiscard]] Verdict classify(const Frustum& frustum, const Aabb& box, CullMode mode = CullMode::exact);
[[nodiscard]] Verdict classify(const Frustum& frustum, const Sphere& sphere, CullMode mode = CullMode::exact);

// Classifies many boxes: writes verdicts[i] for boxes[i]. Allocates nothing; may run on any thread. Requires
// verdicts.size() == boxes.size().
void classify(const Frustum& frustum, std::span<const Obb> boxes, std::span<Verdict> verdicts,
              CullMode mode = CullMode::exact);

// ---- Statistics ----

#if defined(CROFTON_NO_STATISTICS)
inline constexpr bool kCountStatistics = false;  // every number below stays 0, and counting costs nothing
#else
inline constexpr bool kCountStatistics = true;
#endif

// Counts of a query. They are the same on every processor, except exact_tests: how many items are too close to call in
// floats depends on whether the processor fuses products with sums.
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

// The verdicts of a list. Bit i % 64 of word i / 64 belongs to bound i.
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

// Limits on the size and distance of items.
//
// An item's radius r is half the diagonal of its box, √(h₀² + h₁² + h₂²) of its half extents. Its distance d is that of
// its box's centre from `eye`. The item is dropped if d > max_distance_in_radii · r, if d > item_distances[id], if r <
// least_radius, or if d > layer_distances[l] for every layer l that it shares with the view. The tests are exact for
// the stored numbers taken as reals; an item on a limit is kept. Limits that are not finite or beyond 1e30 are ignored;
// so are all limits for a box or an eye that is not finite. Negative limits count as 0.
struct DrawLimits {
    static constexpr double kNone = std::numeric_limits<double>::infinity();
    glm::dvec3 eye{0.0};  // of the camera whose picture counts: for its shadows' views too
    double max_distance_in_radii = kNone;
    double least_radius = 0.0;
    std::span<const float> layer_distances = {};  // 32, or none
    std::span<const float> item_distances = {};   // one per item id, or none
    // Hysteresis: for items whose bit is set (id % 64 of word id / 64; none beyond the end), distances are multiplied
    // by `hysteresis` and least_radius is divided by it. Pass the visible items of the last frame (to_bits), so that
    // items near a limit do not flicker. Requires hysteresis ≥ 1.
    std::span<const std::uint64_t> drawn_before = {};
    double hysteresis = 1.0;
};

// Returns limits that drop items smaller than `pixels` in a picture that is `picture_height` pixels high.
//
// Perspective: an item's sphere of radius r is drawn at its distance in the middle of the picture, and the item is
// dropped if the diameter is less than `pixels`. Elsewhere in the picture a sphere is drawn larger, but is judged as in
// the middle. Orthographic: an item is dropped if its 2 r is less. `max_distance_in_radii` or `least_radius` is rounded
// by 2^-50. Errors: as validate(Camera); a height or size that is not positive and finite.
[[nodiscard]] Result<DrawLimits> limits_of(const Camera& camera, double picture_height, double pixels);

// Tests one item against the limits. `common_layers` are the layers that the item shares with the view.
[[nodiscard]] bool is_worth_drawing(const DrawLimits& limits, const Obb& box, boxtree::ItemId item,
                                    std::uint32_t common_layers = ~std::uint32_t{0});
// Does the same for an Aabb, by its centre and half extents rounded to double, and for a sphere.
[[nodiscard]] bool is_worth_drawing(const DrawLimits& limits, const Aabb& box, boxtree::ItemId item,
                                    std::uint32_t common_layers = ~std::uint32_t{0});
[[nodiscard]] bool is_worth_drawing(const DrawLimits& limits, const Sphere& sphere, boxtree::ItemId item,
                                    std::uint32_t common_layers = ~std::uint32_t{0});

}  // namespace crofton::cull
