// SPDX-License-Identifier: MIT
// One bound, or many, against a view: outside, straddling, inside, exactly.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/cull/statistics.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/shapes.hpp>
#include <cstddef>
#include <cstdint>
#include <span>

namespace crofton::cull {

// The one question a renderer asks of a bound: is this worth drawing?

enum class Verdict : std::uint8_t { outside, straddling, inside };

enum class CullMode : std::uint8_t {
    conservative,  // outside iff one plane rejects the box, exactly; keeps some boxes near the frustum's edges and
                   // corners
    exact,         // outside iff box and frustum are disjoint
};

// Exact for the boxes' and planes' stored numbers: `outside` as the mode says, `inside` iff the frustum contains the
// box; touching from outside is straddling. A box or a frustum that is not finite, or beyond 1e30, is `straddling`:
// never lost. Planes decide most boxes in double with a proven error bound; the rest go through the separating-axis
// test (Gottschalk, Lin, Manocha 1996) and, where rounding could still matter, through exact arithmetic.
[[nodiscard]] Verdict classify(const Frustum& frustum, const Obb& box, CullMode mode = CullMode::exact);

// The same for axis-aligned boxes and for balls. An empty Aabb and a negative radius are `straddling`, as is what is
// not finite. `inside` and `outside` are exact for a ball too, except that one whose numbers (the view's as well)
// include some other than 0 below 1e-60 in magnitude may be `straddling` where no plane rejects it but an edge would.
[[nodiscard]] Verdict classify(const Frustum& frustum, const Aabb& box, CullMode mode = CullMode::exact);
[[nodiscard]] Verdict classify(const Frustum& frustum, const Sphere& sphere, CullMode mode = CullMode::exact);

// As above for many boxes: writes verdicts[i] for boxes[i]. Allocates nothing; may run on any thread.
// Requires verdicts.size() == boxes.size().
void classify(const Frustum& frustum, std::span<const Obb> boxes, std::span<Verdict> verdicts,
              CullMode mode = CullMode::exact);

// What a query of a list answers.

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

}  // namespace crofton::cull
