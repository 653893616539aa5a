// SPDX-License-Identifier: MIT
// The one question a renderer asks of a bound: is this worth drawing?
#pragma once
#include <crofton/geometry/aabb.hpp>
#include <crofton/geometry/frustum.hpp>
#include <crofton/geometry/obb.hpp>
#include <crofton/geometry/sphere.hpp>
#include <cstdint>
#include <span>

namespace crofton::cull {

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

}  // namespace crofton::cull
