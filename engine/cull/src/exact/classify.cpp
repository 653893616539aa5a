// SPDX-License-Identifier: MIT
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

template <class Box>
Verdict classify_box(const Frustum& frustum, const Box& box, CullMode mode) {
    Constraint constraints[Frustum::kMaxPlanes];
    for (std::uint32_t i = 0; i < frustum.plane_count; ++i) {
        constraints[i] = constraint_of(frustum.planes[i], frustum.origin, box);
        if (innermost_sign(constraints[i], frustum.planes[i], frustum.origin, box) < 0) return Verdict::outside;
    }
    bool inside = true;
    for (std::uint32_t i = 0; i < frustum.plane_count && inside; ++i)
        inside = outermost_sign(constraints[i], frustum.planes[i], frustum.origin, box) >= 0;
    if (inside) return Verdict::inside;
    return mode == CullMode::conservative || meets(frustum, box, constraints) ? Verdict::straddling : Verdict::outside;
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
