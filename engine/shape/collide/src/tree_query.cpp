// SPDX-License-Identifier: MIT
// Queries of a BoxTree: the items that a ray hits, or that a shape overlaps.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/structure.hpp>
#include <crofton/collide/broadphase.hpp>
#include <crofton/collide/moved_tree.hpp>
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/geometry/finite.hpp>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/ray_box.hpp>
#include "bound_blocks.hpp"
#include "tree_lanes.hpp"

namespace crofton::collide {
namespace {

using boxtree::kWidth;

constexpr float kFar = std::numeric_limits<float>::max();

// What waits to be visited: room enough for the heights that builds give, and memory beyond for those that they do not.
template <class Step>
class Stack {
  public:
    explicit Stack(unsigned height) {
        const std::size_t needed = (std::size_t{height} + 1) * kWidth;  // items below the leaves as well
        if (needed > few_.size()) {
            many_.resize(needed);
            steps_ = many_.data();
        }
    }
    [[nodiscard]] bool is_empty() const { return size_ == 0; }
    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] Step& operator[](std::size_t i) { return steps_[i]; }
    void push(const Step& step) { steps_[size_++] = step; }
    Step pop() { return steps_[--size_]; }

  private:
    std::array<Step, 16 * kWidth> few_;
    Vector<Step> many_;
    Step* steps_ = few_.data();
    std::size_t size_ = 0;
};

template <class Visit>
void for_each_lane(std::uint32_t lanes, Visit visit) {
    for (; lanes != 0; lanes &= lanes - 1) visit(static_cast<unsigned>(std::countr_zero(lanes)));
}

// The items of some of a leaf's lanes.
template <class Visit>
void for_each_item(const boxtree::TreeArrays& tree, boxtree::LeafId leaf, std::uint32_t lanes, std::uint32_t layers,
                   Visit visit) {
    for_each_lane(lanes, [&](unsigned lane) {
        if (tree.leaves[leaf].layers[lane] & layers) visit(tree.slot_items[std::size_t{leaf} * kWidth + lane]);
    });
}

// Keeps the order of numbers, which is what the comparison with lanes needs (tree_lanes.cpp).
float to_float(double x) {
    return static_cast<float>(std::clamp(x, -1e38, 1e38));
}

template <class Block>
LaneBox box_for(const Block& block, const Aabb& bounds) {
    LaneBox box;
    for (int k = 0; k < 3; ++k) {
        box.low[k] = to_float(bounds.min[k] - block.origin[k]);
        box.high[k] = to_float(bounds.max[k] - block.origin[k]);
    }
    return box;
}

// The least box along a node's axes around `bounds`; what products round by is far below `rounding`.
LaneBox box_for(const boxtree::Node& node, const boxtree::Axes& axes, const Aabb& bounds) {
    if (axes.rounding == 0.0) return box_for(node, bounds);
    double low[3], high[3], size = 0.0;
    for (int j = 0; j < 3; ++j) {
        low[j] = bounds.min[j] - node.origin[j];
        high[j] = bounds.max[j] - node.origin[j];
        size += std::abs(low[j]) + std::abs(high[j]);
    }
    LaneBox box;
    for (unsigned k = 0; k < 3; ++k) {
        double least = 0.0, most = 0.0;
        for (unsigned j = 0; j < 3; ++j) {
            const double a = axes.rows[k][j] * low[j], b = axes.rows[k][j] * high[j];
            least += std::min(a, b);
            most += std::max(a, b);
        }
        box.low[k] = to_float(least - axes.rounding * size);
        box.high[k] = to_float(most + axes.rounding * size);
    }
    return box;
}

LaneBox seen_from(const boxtree::Node& node, const boxtree::TreeArrays& tree, const Aabb& bounds) {
    return box_for(node, tree.axes[node.axes], bounds);
}
LaneBox seen_from(const boxtree::Leaf& leaf, const boxtree::TreeArrays&, const Aabb& bounds) {
    return box_for(leaf, bounds);
}

template <class Shape>
void collect(const boxtree::BoxTree& tree, const Shape& shape, const Aabb& bounds, std::uint32_t layers,
             Vector<boxtree::ItemId>& items) {
    items.clear();
    visit_near(
        bounds, 0.0, tree,
        [&](boxtree::ItemId item) {
            if (intersects(tree.boxes()[item], shape)) items.push_back(item);
            return 0.0;
        },
        layers);
    std::sort(items.begin(), items.end());
}

// Rounded outward: the sums by 2^-53 of themselves.
Aabb grown(const Aabb& bounds, double distance) {
    if (distance == 0.0) return bounds;
    const double near = std::min(distance, 1e300);
    const glm::dvec3 by = near + 1e-15 * (glm::abs(bounds.min) + glm::abs(bounds.max) + near);
    return {bounds.min - by, bounds.max + by};
}

// Around points in double that carry a few roundings.
Aabb around(const glm::dvec3& center, const glm::dvec3& half_size) {
    const glm::dvec3 error_bound = 1e-14 * (glm::abs(center) + half_size);
    return {center - half_size - error_bound, center + half_size + error_bound};
}

// A ray, or a box whose center moves along it, seen from nodes and leaves. Where it runs nearly within a slab, it
// counts as hardly moving across. What it moves across before it leaves the filter's range is below the filter's error
// bound.
class Traveller {
  public:
    explicit Traveller(const Ray& ray, const glm::dvec3& half_size = glm::dvec3(0.0))
        : origin_(ray.origin), half_size_(half_size), unit_(unit_of(ray.direction)) {
        const glm::dvec3 direction = ray.direction / unit_;
        length_ = glm::length(direction);
        speed_ = direction / length_;
        for (int k = 0; k < 3; ++k) inverse_[static_cast<std::size_t>(k)] = inverse_of(speed_[k]);
    }
    // The same ray from another origin, which is off by `slack` at most.
    [[nodiscard]] Traveller from(const glm::dvec3& origin, double slack) const {
        Traveller other = *this;
        other.origin_ = origin;
        other.slack_ = static_cast<float>(slack * 0x1.1p20);
        return other;
    }
    // In the filter's distances; what it rounds is below the filter's error bound.
    [[nodiscard]] float distance(double t) const {
        return static_cast<float>(std::min(t * unit_ * length_, static_cast<double>(kFar)));
    }
    // Along a node's axes where they are not the world's: what turning rounds is below the filter's error bound as
    // well.
    [[nodiscard]] LaneRay seen_from(const boxtree::Node& node, const boxtree::TreeArrays& tree, float limit) const {
        const boxtree::Axes& axes = tree.axes[node.axes];
        if (axes.rounding == 0.0) return seen_from(node, limit);
        double offset[3];
        for (int k = 0; k < 3; ++k) offset[k] = origin_[k] - node.origin[k];
        LaneRay ray;
        for (unsigned k = 0; k < 3; ++k) {
            ray.origin[k] = static_cast<float>(boxtree::along(axes, k, offset));
            ray.inverse[k] = inverse_of(boxtree::along(axes, k, &speed_.x));
            ray.wide[k] = 0.0f;
            for (int j = 0; j < 3; ++j) ray.wide[k] += static_cast<float>(std::abs(axes.rows[k][j]) * half_size_[j]);
        }
        ray.limit = limit;
        ray.slack = slack_;
        return ray;
    }
    [[nodiscard]] LaneRay seen_from(const boxtree::Leaf& leaf, const boxtree::TreeArrays&, float limit) const {
        return seen_from(leaf, limit);
    }

  private:
    template <class Block>
    [[nodiscard]] LaneRay seen_from(const Block& block, float limit) const {
        LaneRay ray;
        for (int k = 0; k < 3; ++k) {
            ray.origin[k] = static_cast<float>(origin_[k] - block.origin[k]);
            ray.inverse[k] = inverse_[static_cast<std::size_t>(k)];
            ray.wide[k] = static_cast<float>(half_size_[k]);
        }
        ray.limit = limit;
        ray.slack = slack_;
        return ray;
    }
    [[nodiscard]] static float inverse_of(double speed) {
        return static_cast<float>(std::abs(speed) < 1e-18 ? std::copysign(1e18, speed) : 1.0 / speed);
    }

    // A power of two, by which squares of the direction do not leave the range of doubles.
    [[nodiscard]] static double unit_of(const glm::dvec3& direction) {
        const glm::dvec3 m = glm::abs(direction);
        return std::max(m.x, std::max(m.y, m.z)) < 0x1p500 ? 1.0 : 0x1p600;
    }

    glm::dvec3 origin_, half_size_;
    double unit_, length_;  // of the direction; the length in units
    glm::dvec3 speed_;
    std::array<float, 3> inverse_;
    float slack_ = 0.0f;
};

// A block or item that waits to be visited, and the distance at which it begins.
struct Step {
    float entry;
    std::uint32_t child;
};
// Beside kLeafBit, in Step::child: the rest is an item.
constexpr std::uint32_t kItemBit = 0x40000000u;

// Visits what begins before the limit, nearest first; what is visited may lessen the limit. lanes_of(block, limit,
// entries): those that may begin before it, and where. visit_leaf(leaf, lanes, entries, push): push(entry, item) has
// the item visited in its turn, by visit_item(item). Both end the walk by returning a negative limit.
template <class LanesOf, class VisitLeaf, class VisitItem>
void walk_nearest_first(const boxtree::TreeArrays& tree, float limit, std::uint32_t layers, LanesOf lanes_of,
                        VisitLeaf visit_leaf, VisitItem visit_item) {
    Stack<Step> stack(tree.height);
    stack.push({0.0f, 0});
    while (!stack.is_empty()) {
        const Step step = stack.pop();
        if (step.entry > limit) continue;
        const std::size_t base = stack.size();
        const auto push = [&](float entry, std::uint32_t child) {  // the nearest goes on top
            stack.push({});
            std::size_t place = stack.size() - 1;
            for (; place > base && stack[place - 1].entry < entry; --place) stack[place] = stack[place - 1];
            stack[place] = {entry, child};
        };
        std::array<float, kWidth> entry;
        if (step.child & boxtree::kLeafBit) {
            const boxtree::LeafId id = step.child & ~boxtree::kLeafBit;
            if (id & kItemBit) {
                limit = visit_item(id & ~kItemBit);
            } else {
                const std::uint32_t lanes = lanes_of(tree.leaves[id], limit, entry.data());
                limit = visit_leaf(id, lanes, entry, push);
            }
            if (!(limit >= 0.0f)) return;
            continue;
        }
        const boxtree::Node& node = tree.nodes[step.child];
        for_each_lane(lanes_of(node, limit, entry.data()), [&](unsigned lane) {
            if ((node.layers_any[lane] & layers) != 0) push(entry[lane], node.child[lane]);
        });
    }
}

// Has each item of a leaf's lanes visited in its turn.
template <class Push>
void push_items(const boxtree::TreeArrays& tree, boxtree::LeafId id, std::uint32_t lanes, std::uint32_t layers,
                const std::array<float, kWidth>& entry, Push push) {
    for_each_lane(lanes, [&](unsigned lane) {
        if (tree.leaves[id].layers[lane] & layers)
            push(entry[lane], tree.slot_items[std::size_t{id} * kWidth + lane] | boxtree::kLeafBit | kItemBit);
    });
}

}  // namespace

void visit_near(const Aabb& bounds, double distance, const boxtree::BoxTree& tree, NearVisitor visit,
                std::uint32_t layers) {
    if (!is_finite(bounds.min) || !is_finite(bounds.max) || !(distance >= 0.0)) return;
    const boxtree::TreeArrays arrays = boxtree::arrays_of(tree);
    const glm::dvec3 size = bounds.max - bounds.min;
    if (distance > std::max({size.x, size.y, size.z})) {
        const auto limit = [&] { return square_of(distance); };
        walk_nearest_first(
            arrays, limit(), layers,
            [&](const auto& block, float most, float* squares) {
                return lanes_near(block, seen_from(block, arrays, bounds), most, squares);
            },
            [&](boxtree::LeafId id, std::uint32_t lanes, const auto& squares, const auto& push) {
                push_items(arrays, id, lanes, layers, squares, push);
                return limit();
            },
            [&](boxtree::ItemId item) {
                distance = std::min(distance, visit(item));
                return limit();
            });
        return;
    }
    const Aabb near = grown(bounds, distance);
    Stack<std::uint32_t> stack(arrays.height);
    stack.push(0);
    while (!stack.is_empty() && distance >= 0.0) {
        const std::uint32_t child = stack.pop();
        if (child & boxtree::kLeafBit) {
            const boxtree::LeafId id = child & ~boxtree::kLeafBit;
            const boxtree::Leaf& leaf = arrays.leaves[id];
            for_each_item(arrays, id, lanes_within(leaf, box_for(leaf, near)), layers, [&](boxtree::ItemId item) {
                if (distance >= 0.0) distance = std::min(distance, visit(item));
            });
            continue;
        }
        const boxtree::Node& node = arrays.nodes[child];
        for_each_lane(lanes_within(node, seen_from(node, arrays, near)), [&](unsigned lane) {
            if (node.layers_any[lane] & layers) stack.push(node.child[lane]);
        });
    }
}

void overlapping(const boxtree::BoxTree& tree, const Obb& shape, Vector<boxtree::ItemId>& items, std::uint32_t layers) {
    items.clear();
    if (!validate(shape)) return;
    glm::dvec3 half_size(0.0);
    for (int k = 0; k < 3; ++k)
        half_size += static_cast<double>(shape.half_extents[k]) * glm::abs(glm::dvec3(shape.axes[k]));
    collect(tree, shape, around(shape.center, half_size), layers, items);
}

void overlapping(const boxtree::BoxTree& tree, const Sphere& shape, Vector<boxtree::ItemId>& items,
                 std::uint32_t layers) {
    collect(tree, shape, around(shape.center, glm::dvec3(shape.radius)), layers, items);
}

void overlapping(const boxtree::BoxTree& tree, const Capsule& shape, Vector<boxtree::ItemId>& items,
                 std::uint32_t layers) {
    Aabb bounds = around(shape.begin, glm::dvec3(shape.radius));
    bounds.include(around(shape.end, glm::dvec3(shape.radius)));
    collect(tree, shape, bounds, layers, items);
}

namespace {

// As walk_nearest_first() along a ray, up to `max_t`, which the visitors may lessen.
template <class VisitLeaf, class VisitItem>
void walk_along(const boxtree::TreeArrays& tree, const Traveller& traveller, const double& max_t, std::uint32_t layers,
                VisitLeaf visit_leaf, VisitItem visit_item) {
    const auto limit = [&] { return max_t >= 0.0 ? traveller.distance(max_t) : -1.0f; };
    walk_nearest_first(
        tree, limit(), layers,
        [&](const auto& block, float most, float* entry) {
            return lanes_along(block, traveller.seen_from(block, tree, most), entry);
        },
        [&](boxtree::LeafId id, std::uint32_t lanes, const auto& entry, const auto& push) {
            visit_leaf(id, lanes, entry, push);
            return limit();
        },
        [&](boxtree::ItemId item) {
            visit_item(item);
            return limit();
        });
}

// The traveller sees the tree's own boxes; box_of(item) is the item's box where the ray meets it. visit(item, t)
// returns how far along the ray others are of interest, which `rest` tells as well.
template <class BoxOf, class Visit>
void visit_along(Ray& rest, const Traveller& traveller, const boxtree::TreeArrays& tree, const BoxOf& box_of,
                 Visit visit, std::uint32_t layers) {
    walk_along(
        tree, traveller, rest.max_t, layers,
        [&](boxtree::LeafId id, std::uint32_t lanes, const auto&, const auto&) {
            for_each_item(tree, id, lanes, layers, [&](boxtree::ItemId item) {
                if (const auto t = mesh::entry_of(rest, box_of(item))) rest.max_t = visit(item, *t);
            });
        },
        [](boxtree::ItemId) {});
}

}  // namespace

void visit_along(const Ray& ray, const boxtree::BoxTree& tree, RayVisitor visit, std::uint32_t layers) {
    if (!validate(ray)) return;
    Ray rest = ray;
    const boxtree::TreeArrays arrays = boxtree::arrays_of(tree);
    visit_along(
        rest, Traveller(ray), arrays, [&](boxtree::ItemId item) -> const Obb& { return arrays.boxes[item]; }, visit,
        layers);
}

void visit_along(const Ray& ray, const boxtree::BoxTree& trees, FunctionRef<MovedTree(boxtree::ItemId)> tree_of,
                 FunctionRef<double(boxtree::ItemId, boxtree::ItemId, double)> visit, std::uint32_t layers) {
    if (!validate(ray)) return;
    Ray rest = ray;
    const Traveller traveller(ray);
    const boxtree::TreeArrays upper = boxtree::arrays_of(trees);
    walk_along(
        upper, traveller, rest.max_t, layers,
        [&](boxtree::LeafId id, std::uint32_t lanes, const auto& entry, const auto& push) {
            push_items(upper, id, lanes, layers, entry, push);
        },
        [&](boxtree::ItemId item) {
            const auto [tree, move] = tree_of(item);
            if (tree == nullptr) return;
            visit_along(
                rest, traveller.from(move->back(ray.origin), move->rounding(ray.origin)), *tree,
                [&, boxes = tree->boxes, by = move](boxtree::ItemId in_tree) { return (*by)(boxes[in_tree]); },
                [&](boxtree::ItemId in_tree, double t) { return visit(item, in_tree, t); }, layers);
        });
}

namespace {

template <class Visit>
void visit_swept(double& max_t, const Traveller& traveller, const boxtree::TreeArrays& tree, Visit visit,
                 std::uint32_t layers) {
    walk_along(
        tree, traveller, max_t, layers,
        [&](boxtree::LeafId id, std::uint32_t lanes, const auto& entry, const auto& push) {
            push_items(tree, id, lanes, layers, entry, push);
        },
        [&](boxtree::ItemId item) { max_t = visit(item); });
}

}  // namespace

void visit_swept(const Ray& path, const glm::dvec3& half_size, const boxtree::BoxTree& tree, NearVisitor visit,
                 std::uint32_t layers) {
    if (!validate(path)) return;
    double max_t = path.max_t;
    visit_swept(max_t, Traveller(path, half_size), boxtree::arrays_of(tree), visit, layers);
}

void visit_swept(const Ray& path, const glm::dvec3& half_size, const boxtree::BoxTree& trees,
                 FunctionRef<MovedTree(boxtree::ItemId)> tree_of,
                 FunctionRef<double(boxtree::ItemId, boxtree::ItemId)> visit, std::uint32_t layers) {
    if (!validate(path)) return;
    double max_t = path.max_t;
    const Traveller traveller(path, half_size);
    const auto visit_tree = [&](boxtree::ItemId item) {
        if (const auto [tree, move] = tree_of(item); tree != nullptr)
            visit_swept(
                max_t, traveller.from(move->back(path.origin), move->rounding(path.origin)), *tree,
                [&](boxtree::ItemId in_tree) { return visit(item, in_tree); }, layers);
        return max_t;
    };
    visit_swept(max_t, traveller, boxtree::arrays_of(trees), visit_tree, layers);
}

std::optional<BoxHit> raycast(const Ray& ray, const boxtree::BoxTree& tree, std::uint32_t layers) {
    std::optional<BoxHit> nearest;
    visit_along(
        ray, tree,
        [&](boxtree::ItemId item, double t) {
            if (!nearest || t < nearest->t || item < nearest->item) nearest = {t, item};
            return t;
        },
        layers);
    return nearest;
}

}  // namespace crofton::collide
