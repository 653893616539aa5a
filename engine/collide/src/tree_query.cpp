#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/collide/obb_obb.hpp>
#include <crofton/collide/tree_query.hpp>
#include <glm/common.hpp>
#include <limits>

namespace crofton::collide {
namespace {

using tree::kWidth;

// What waits to be visited: room enough for the heights that builds give, and memory beyond for those that they do not.
template <class Step>
class Stack {
  public:
    explicit Stack(const tree::BoxTree& tree) {
        const std::size_t needed = std::size_t{tree.height()} * kWidth;
        if (needed > few_.size()) {
            many_.resize(needed);
            steps_ = many_.data();
        }
    }
    [[nodiscard]] bool is_empty() const { return size_ == 0; }
    [[nodiscard]] std::size_t size() const { return size_; }
    void push(const Step& step) { steps_[size_++] = step; }
    Step pop() { return steps_[--size_]; }
    Step* begin() { return steps_; }
    Step* end() { return steps_ + size_; }

  private:
    std::array<Step, 16 * kWidth> few_;
    Vector<Step> many_;
    Step* steps_ = few_.data();
    std::size_t size_ = 0;
};

template <class Visit>
void for_each_item(const tree::BoxTree& tree, tree::LeafId leaf, std::uint32_t layers, Visit visit) {
    const tree::ItemId* items = tree.slot_items().data() + std::size_t{leaf} * kWidth;
    for (unsigned lane = 0; lane < tree.leaf_counts()[leaf]; ++lane)
        if (tree.layer_masks()[items[lane]] & layers) visit(items[lane]);
}

// `box` in the units of a node's children, rounded outward by at least one: nothing that touches is lost to the
// rounding of the differences, which is below 2^-52 of them. Numbers beyond what children can have are cut off.
struct NodeBox {
    std::array<std::int32_t, 3> low, high;

    NodeBox(const tree::Node& node, const Aabb& box) {
        constexpr double kBeyond = 65536.0;
        for (int k = 0; k < 3; ++k) {
            const auto i = static_cast<std::size_t>(k);
            const double unit = static_cast<double>(node.unit);
            const double from = std::floor((box.min[k] - node.origin[k]) / unit) - 1.0;
            const double to = std::ceil((box.max[k] - node.origin[k]) / unit) + 1.0;
            low[i] = static_cast<std::int32_t>(std::clamp(from, -kBeyond, kBeyond));
            high[i] = static_cast<std::int32_t>(std::clamp(to, -kBeyond, kBeyond));
        }
    }
    [[nodiscard]] bool meets(const tree::Node& node, unsigned lane) const {
        bool result = true;
        for (unsigned k = 0; k < 3; ++k)
            result = result && tree::low_of(node, lane, k) <= high[k] && low[k] <= tree::high_of(node, lane, k);
        return result;
    }
};

template <class Meets>
void collect(const tree::BoxTree& tree, const Aabb& bounds, std::uint32_t layers, Vector<tree::ItemId>& items,
             const Meets& meets) {
    items.clear();
    if (!std::isfinite(bounds.min.x + bounds.min.y + bounds.min.z + bounds.max.x + bounds.max.y + bounds.max.z)) return;
    Stack<std::uint32_t> stack(tree);
    stack.push(0);
    while (!stack.is_empty()) {
        const std::uint32_t child = stack.pop();
        if (child & tree::kLeafBit) {
            for_each_item(tree, child & ~tree::kLeafBit, layers, [&](tree::ItemId item) {
                if (meets(tree.boxes()[item])) items.push_back(item);
            });
            continue;
        }
        const tree::Node& node = tree.nodes()[child];
        const NodeBox box(node, bounds);
        for (unsigned lane = 0; lane < node.count; ++lane)
            if (node.layers_any[lane] & layers && box.meets(node, lane)) stack.push(node.child[lane]);
    }
    std::sort(items.begin(), items.end());
}

// Around points in double that carry a few roundings.
Aabb around(const glm::dvec3& center, const glm::dvec3& reach) {
    const glm::dvec3 slack = 1e-14 * (glm::abs(center) + reach);
    return {center - reach - slack, center + reach + slack};
}

// Boxes are visited where the ray meets their bounds grown by `slop`: 1e-13 of the coordinates' size, far above the
// roundings here and in raycast(ray, box), each a few 2^-53 of it. 1e-100 gives rays that run within a face room too.
struct RayLine {
    glm::dvec3 origin, inverse;
    double size;

    explicit RayLine(const Ray& ray) : origin(ray.origin) {
        for (int k = 0; k < 3; ++k)
            inverse[k] =
                std::abs(ray.direction[k]) < 1e-300 ? std::copysign(1e300, ray.direction[k]) : 1.0 / ray.direction[k];
        size = std::abs(origin.x) + std::abs(origin.y) + std::abs(origin.z);
    }

    // Where the ray enters each child's bounds; `last` is where it leaves them, or `limit`.
    void enter(const tree::Node& node, double limit, std::array<double, kWidth>& first,
               std::array<double, kWidth>& last) const {
        const double unit = static_cast<double>(node.unit);
        const double far = std::abs(node.origin[0]) + std::abs(node.origin[1]) + std::abs(node.origin[2]);
        const double slop = 1e-13 * (size + far + static_cast<double>(node.reach)) + 1e-100;
        first.fill(0.0);
        last.fill(limit);
        for (unsigned axis = 0; axis < 3; ++axis) {
            const int k = static_cast<int>(axis);
            const double base = node.origin[k] - origin[k], scale = inverse[k];
            for (unsigned l = 0; l < kWidth; ++l) {
                const double a = (base + unit * tree::low_of(node, l, axis) - slop) * scale;
                const double b = (base + unit * tree::high_of(node, l, axis) + slop) * scale;
                first[l] = std::max(first[l], std::min(a, b));
                last[l] = std::min(last[l], std::max(a, b));
            }
        }
    }
};

struct RayStep {
    double entry;
    std::uint32_t child;
};

}  // namespace

void overlapping(const tree::BoxTree& tree, const Obb& body, Vector<tree::ItemId>& items, std::uint32_t layers) {
    items.clear();
    if (!validate(body)) return;
    glm::dvec3 reach(0.0);
    for (int k = 0; k < 3; ++k) reach += static_cast<double>(body.half_extents[k]) * glm::abs(glm::dvec3(body.axes[k]));
    collect(tree, around(body.center, reach), layers, items, [&](const Obb& box) { return intersects(box, body); });
}

void overlapping(const tree::BoxTree& tree, const Sphere& body, Vector<tree::ItemId>& items, std::uint32_t layers) {
    collect(tree, around(body.center, glm::dvec3(body.radius)), layers, items,
            [&](const Obb& box) { return intersects(box, body); });
}

void overlapping(const tree::BoxTree& tree, const Capsule& body, Vector<tree::ItemId>& items, std::uint32_t layers) {
    Aabb bounds = around(body.begin, glm::dvec3(body.radius));
    bounds.include(around(body.end, glm::dvec3(body.radius)));
    collect(tree, bounds, layers, items, [&](const Obb& box) { return intersects(box, body); });
}

void visit_along(const Ray& ray, const tree::BoxTree& tree, RayVisitor visit, std::uint32_t layers) {
    if (!validate(ray)) return;
    const RayLine line(ray);
    Ray rest = ray;
    Stack<RayStep> stack(tree);
    stack.push({0.0, 0});
    while (!stack.is_empty() && rest.max_t >= 0.0) {
        const RayStep step = stack.pop();
        if (step.entry > rest.max_t) continue;
        if (step.child & tree::kLeafBit) {
            for_each_item(tree, step.child & ~tree::kLeafBit, layers, [&](tree::ItemId item) {
                if (const auto t = raycast(rest, tree.boxes()[item])) rest.max_t = visit(item, *t);
            });
            continue;
        }
        const tree::Node& node = tree.nodes()[step.child];
        std::array<double, kWidth> first, last;
        line.enter(node, rest.max_t, first, last);
        const std::size_t base = stack.size();
        for (unsigned lane = 0; lane < node.count; ++lane)
            if (first[lane] <= last[lane] && (node.layers_any[lane] & layers) != 0)
                stack.push({first[lane], node.child[lane]});
        // The nearest child goes on top.
        std::sort(stack.begin() + base, stack.end(), [](const RayStep& a, const RayStep& b) {
            return a.entry != b.entry ? a.entry > b.entry : a.child < b.child;
        });
    }
}

std::optional<BoxHit> raycast(const Ray& ray, const tree::BoxTree& tree, std::uint32_t layers) {
    std::optional<BoxHit> nearest;
    visit_along(
        ray, tree,
        [&](tree::ItemId item, double t) {
            if (!nearest || t < nearest->t || item < nearest->item) nearest = {t, item};
            return t;
        },
        layers);
    return nearest;
}

}  // namespace crofton::collide
