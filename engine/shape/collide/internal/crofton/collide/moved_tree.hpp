// SPDX-License-Identifier: MIT
// A ray at a tree whose boxes are stored relative to an origin.
#pragma once
#include <crofton/collide/broadphase.hpp>
#include <crofton/geometry/move.hpp>

namespace crofton::collide {

// As visit_along() of a tree, with each box moved: t is that of raycast(ray, moved box), and no such box is missed.
void visit_along(const Ray& ray, const boxtree::BoxTree& tree, const Move& move, RayVisitor visit,
                 std::uint32_t layers = ~0u);

}  // namespace crofton::collide
