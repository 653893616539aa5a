// SPDX-License-Identifier: MIT
// Which of many boxes does a body or a ray meet? Asked of the tree that culling uses.
#pragma once
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/collide/convex_query.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <cstdint>
#include <optional>

namespace crofton::collide {

// All queries leave out items whose layers share no bit with `layers`, and want a tree whose moves have been refitted.
// const, thread-safe; no allocation beyond the growth of the caller's vector.

// Replaces `items` by those whose boxes meet the body, ascending. Right as intersects(box, body) is: exactly for boxes.
// A body that is not finite or fails validate(Obb) meets nothing.
void overlapping(const boxtree::BoxTree& tree, const Obb& body, Vector<boxtree::ItemId>& items,
                 std::uint32_t layers = ~0u);
void overlapping(const boxtree::BoxTree& tree, const Sphere& body, Vector<boxtree::ItemId>& items,
                 std::uint32_t layers = ~0u);
void overlapping(const boxtree::BoxTree& tree, const Capsule& body, Vector<boxtree::ItemId>& items,
                 std::uint32_t layers = ~0u);

// Told of an item whose box may be near; answers how near others must be to be of interest still: the distance of the
// nearest so far, for instance, or a negative number to stop.
using NearVisitor = FunctionRef<double(boxtree::ItemId item)>;

// Visits all items whose boxes are no farther from `bounds` than `distance` ≥ 0 and the visitor's last answer, and some
// that are a little farther, always in the same order. Bounds that are empty or not finite are near to nothing.
void visit_near(const Aabb& bounds, double distance, const boxtree::BoxTree& tree, NearVisitor visit,
                std::uint32_t layers = ~0u);

// Told of an item whose box the ray enters at t; answers how far along the ray boxes are still of interest: the t of
// the nearest hit so far, for instance, or a negative number to stop.
using RayVisitor = FunctionRef<double(boxtree::ItemId item, double t)>;

// Visits items whose boxes the ray meets (t as raycast(ray, box) gives it) no farther than the visitor's last answer;
// before the first, than max_t. Near ones come first as far as the tree's nodes tell, and always in the same order.
void visit_along(const Ray& ray, const boxtree::BoxTree& tree, RayVisitor visit, std::uint32_t layers = ~0u);

struct BoxHit {
    double t = 0.0;
    boxtree::ItemId item = 0;
};
// The box that the ray enters first; of boxes with equal t that of the lowest item.
[[nodiscard]] std::optional<BoxHit> raycast(const Ray& ray, const boxtree::BoxTree& tree, std::uint32_t layers = ~0u);

}  // namespace crofton::collide
