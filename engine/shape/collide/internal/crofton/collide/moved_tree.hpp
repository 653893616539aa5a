// SPDX-License-Identifier: MIT
// Tests a ray, or a box that moves, against trees whose boxes may be stored relative to an origin.
#pragma once
#include <crofton/boxtree/tree_arrays.hpp>
#include <crofton/collide/broadphase.hpp>
#include <crofton/geometry/move.hpp>

namespace crofton::collide {

// A tree, and where its boxes are.
struct MovedTree {
    const boxtree::TreeArrays* tree = nullptr;  // nullptr: none
    const Move* move = nullptr;
};

// As visit_along() of the trees that stand at the items of a tree, whose boxes contain theirs: t is that of
// raycast(ray, moved box), and no such box is missed. tree_of(item) is asked for once the ray comes near it; nearer
// trees come first. visit(item, item of its tree, t).
void visit_along(const Ray& ray, const boxtree::BoxTree& trees, FunctionRef<MovedTree(boxtree::ItemId)> tree_of,
                 FunctionRef<double(boxtree::ItemId, boxtree::ItemId, double)> visit, std::uint32_t layers = ~0u);

// Visits all items whose boxes a box may meet whose center moves along a ray, up to the visitor's last result, and some
// that it does not meet. Near items come roughly first. A negative result stops the visit.
void visit_swept(const Ray& path, const glm::dvec3& half_size, const boxtree::BoxTree& tree, NearVisitor visit,
                 std::uint32_t layers = ~0u);
void visit_swept(const Ray& path, const glm::dvec3& half_size, const boxtree::BoxTree& trees,
                 FunctionRef<MovedTree(boxtree::ItemId)> tree_of,
                 FunctionRef<double(boxtree::ItemId, boxtree::ItemId)> visit, std::uint32_t layers = ~0u);

}  // namespace crofton::collide
