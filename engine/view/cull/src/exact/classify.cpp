// SPDX-License-Identifier: MIT
// Exact verdicts on single bounds: a filter in doubles first, exact arithmetic where it cannot decide.
#include <crofton/core/error.hpp>
#include <crofton/cull/classify.hpp>

#include "exact/box_constraints.hpp"

namespace crofton::cull {

namespace {

template <class Bound>
Verdict classify_any(const Frustum& frustum, const Bound& bound, CullMode mode) {
    if (!is_usable(bound) || !is_usable(frustum)) return Verdict::straddling;
    return classify_usable(frustum, bound, mode);
}

// Decides by the box's extents along the axes, which suffices for far planes. Keeps the constraints of the others.
template <class Box>
Verdict classify_box(const Frustum& frustum, const Box& box, CullMode mode) {
    Constraint constraints[Frustum::kMaxPlanes];
    std::uint32_t open[Frustum::kMaxPlanes], count = 0;
    const glm::dvec3 extents = extents_of(box);
    for (std::uint32_t i = 0; i < frustum.plane_count; ++i) {
        const Plane& plane = frustum.planes[i];
        Constraint& constraint = constraints[count];
        set_base(constraint, plane, frustum.origin, box);
        const glm::dvec3 n = glm::abs(plane.normal);
        const double most = n.x * extents.x + n.y * extents.y + n.z * extents.z;
        // The base's 7u, 6u of `most`, and two additions.
        const double bound = 16.0 * kUnit * (constraint.base_size + most) + kTiny;
        if (constraint.base - most > bound) continue;
        if (constraint.base + most < -bound) return Verdict::outside;
        set_slopes(constraint, plane, box);
        if (innermost_sign(constraint, plane, frustum.origin, box) < 0) return Verdict::outside;
        open[count++] = i;
    }
    bool inside = true;
    for (std::uint32_t n = 0; n < count && inside; ++n)
        inside = outermost_sign(constraints[n], frustum.planes[open[n]], frustum.origin, box) >= 0;
    if (inside) return Verdict::inside;
    // A box that only one plane cuts has a part inside it.
    if (mode == CullMode::conservative || count == 1) return Verdict::straddling;
    Frustum crossed;
    crossed.origin = frustum.origin;
    for (; crossed.plane_count < count; ++crossed.plane_count)
        crossed.planes[crossed.plane_count] = frustum.planes[open[crossed.plane_count]];
    return meets(crossed, box, constraints) ? Verdict::straddling : Verdict::outside;
}

}  // namespace

Verdict classify(const Frustum& frustum, const Obb& box, CullMode mode) {
    return classify_any(frustum, box, mode);
}

Verdict classify(const Frustum& frustum, const Aabb& box, CullMode mode) {
    return classify_any(frustum, box, mode);
}

Verdict classify(const Frustum& frustum, const Sphere& sphere, CullMode mode) {
    return classify_any(frustum, sphere, mode);
}

Verdict classify_usable(const Frustum& frustum, const Obb& box, CullMode mode) {
    return classify_box(frustum, box, mode);
}

Verdict classify_usable(const Frustum& frustum, const Aabb& box, CullMode mode) {
    return classify_box(frustum, box, mode);
}

void classify(const Frustum& frustum, std::span<const Obb> boxes, std::span<Verdict> verdicts, CullMode mode) {
    CROFTON_ASSERT(verdicts.size() == boxes.size(), "classify needs one verdict per box");
    const bool usable = is_usable(frustum);
    for (std::size_t i = 0; i < boxes.size(); ++i)
        verdicts[i] = usable && is_usable(boxes[i]) ? classify_usable(frustum, boxes[i], mode) : Verdict::straddling;
}

}  // namespace crofton::cull
