// SPDX-License-Identifier: MIT
// Compounds: shapes made of placed children, with a tree over the children's boxes.
#include <algorithm>
#include <cmath>
#include <crofton/convex/shape.hpp>
#include <crofton/core/recovery.hpp>

#include "parts.hpp"
#include "ray.hpp"

namespace crofton::convex {
namespace {

constexpr std::uint32_t kLeafSize = 4;

Result<void> check(const CompoundChild& child, std::uint64_t item) {
    if (Result<void> good = validate_pose(child.pose, item); !good) return good;
    if (child.shape.compound() != nullptr && child.shape.compound()->depth() >= kMaxCompoundDepth)
        return fail(ErrorCode::out_of_range, item,
                    {"compound: child ", item, " holds compounds ", kMaxCompoundDepth,
                     " deep; put its children into fewer levels"});
    return {};
}

}  // namespace

Result<Compound> Compound::build(std::span<const CompoundChild> children) {
    if (children.empty()) return fail(ErrorCode::empty, kNoItem, "compound: no children");
    return detail::recover([&]() -> Result<Compound> {
        Compound result;
        result.children_.assign(children.begin(), children.end());
        result.depth_ = 1;
        Vector<Aabb> boxes;
        std::uint64_t parts = 0;
        for (std::size_t i = 0; i < children.size(); ++i) {
            const CompoundChild& child = children[i];
            if (Result<void> good = check(child, i); !good) return good.error();
            result.first_part_.push_back(static_cast<std::uint32_t>(parts));
            const Compound* const inner = child.shape.compound();
            parts += inner != nullptr ? inner->part_count() : 1;
            if (parts >= (std::uint64_t{1} << 31))
                return fail(ErrorCode::out_of_range, i, "compound: 2^31 parts or more");
            if (inner != nullptr) result.depth_ = std::max(result.depth_, inner->depth() + 1);
            result.has_surfaces_ = result.has_surfaces_ || has_surfaces(child.shape);
            boxes.push_back(bounds_of(box_around({child.shape, child.pose}, {})));
            (child.shape.is_bounded() ? result.order_ : result.unbounded_).push_back(static_cast<std::uint32_t>(i));
        }
        result.part_count_ = static_cast<std::uint32_t>(parts);
        if (!result.order_.empty()) {
            result.split(0, static_cast<std::uint32_t>(result.order_.size()), boxes);
            result.bounds_ = result.nodes_.front().box;
        }
        if (!result.unbounded_.empty()) result.bounds_ = {glm::dvec3(-HUGE_VAL), glm::dvec3(HUGE_VAL)};
        return result;
    });
}

// In halves, along the longest side of the centres' box.
void Compound::split(std::uint32_t begin, std::uint32_t end, std::span<const Aabb> boxes) {
    const std::size_t at = nodes_.size();
    nodes_.emplace_back();
    Aabb box, centers;
    for (std::uint32_t i = begin; i < end; ++i) {
        box.include(boxes[order_[i]]);
        centers.include(boxes[order_[i]].center());
    }
    nodes_[at].box = box;
    nodes_[at].begin = begin;
    nodes_[at].end = end;
    if (end - begin <= kLeafSize) return;
    const glm::dvec3 size = centers.max - centers.min;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::sort(order_.begin() + begin, order_.begin() + end, [&](std::uint32_t a, std::uint32_t b) {
        const double x = boxes[a].center()[axis], y = boxes[b].center()[axis];
        return x != y ? x < y : a < b;
    });
    split(begin, middle, boxes);
    nodes_[at].right = static_cast<std::uint32_t>(nodes_.size());
    split(middle, end, boxes);
}

const CompoundChild& Compound::part(std::uint32_t part) const {
    const auto after = std::upper_bound(first_part_.begin(), first_part_.end(), part);
    const auto child = static_cast<std::size_t>(after - first_part_.begin()) - 1;
    const Compound* const inner = children_[child].shape.compound();
    return inner != nullptr ? inner->part(part - first_part_[child]) : children_[child];
}

class CompoundSearch {
  public:
    CompoundSearch(const Compound& compound, const QueryBox& box, const PartSearch& search)
        : compound_(compound), box_(box), bounds_(bounds_of(box)), search_(search) {}

    [[nodiscard]] static bool has_surfaces(const Compound& compound) { return compound.has_surfaces_; }
    // How far its bounded children reach from its origin along each axis.
    [[nodiscard]] static glm::dvec3 reach_of(const Compound& compound) {
        if (compound.nodes_.empty()) return glm::dvec3(0.0);
        const Aabb& box = compound.nodes_.front().box;
        return (glm::max)(glm::abs(box.min), glm::abs(box.max));
    }

    bool run() const {
        for (const std::uint32_t child : compound_.unbounded_)
            if (visit(child)) return true;
        return !compound_.nodes_.empty() && descend(0);
    }

  private:
    bool descend(std::uint32_t at) const {
        const Compound::Node& node = compound_.nodes_[at];
        if (distance_between(node.box, bounds_) > search_.limit) return false;
        if (node.right == 0) {
            for (std::uint32_t i = node.begin; i < node.end; ++i)
                if (visit(compound_.order_[i])) return true;
            return false;
        }
        std::uint32_t near = at + 1, far = node.right;
        if (search_.nearest_first && distance_between(compound_.nodes_[far].box, bounds_) <
                                         distance_between(compound_.nodes_[near].box, bounds_))
            std::swap(near, far);
        return descend(near) || descend(far);
    }

    bool visit(std::uint32_t index) const {
        const CompoundChild& child = compound_.children_[index];
        const RigidTransform pose = within(search_.pose, child.pose);
        const PartSearch inner{pose,
                               child.shape.sides(),
                               search_.child + compound_.first_part_[index],
                               search_.nearest_first,
                               search_.limit,
                               search_.visit,
                               &child.shape,
                               search_.on_triangle};
        const QueryBox box = seen_from(box_, child.pose);
        if (child.shape.is_bounded() && distance_between(child.shape.bounds(), bounds_of(box)) > search_.limit)
            return false;
        return search_parts({child.shape, pose}, box, inner);
    }

    const Compound& compound_;
    const QueryBox& box_;  // of the caller
    Aabb bounds_;
    const PartSearch& search_;
};

bool has_surfaces(const Shape& shape) {
    return shape.kind() == Kind::mesh || shape.kind() == Kind::height_field ||
           (shape.kind() == Kind::compound && CompoundSearch::has_surfaces(*shape.compound()));
}

// The children stand at rounded products of poses, which the box, told in the compound's frame, knows nothing of. With
// u = 2^-53, a product is off by 4u of its terms.
bool search_compound(const Compound& compound, const QueryBox& box, const PartSearch& search) {
    const glm::dvec3 size = glm::abs(search.pose.translation) + CompoundSearch::reach_of(compound);
    QueryBox wider = box;
    wider.rounding += 0x1p-49 * (size.x + size.y + size.z);
    return CompoundSearch(compound, wider, search).run();
}

class CompoundRay {
  public:
    CompoundRay(const Compound& compound, const NearRay& ray, ChildVisitor visit)
        : compound_(compound), ray_(ray), visit_(visit) {}

    void run() const {
        for (const std::uint32_t child : compound_.unbounded_) visit(child);
        if (!compound_.nodes_.empty()) descend(0);
    }

  private:
    void visit(std::uint32_t child) const { visit_(compound_.children_[child], compound_.first_part_[child]); }

    void descend(std::uint32_t at) const {
        const Compound::Node& node = compound_.nodes_[at];
        // A child stands at a rounded product of poses, as far as that from its box.
        const glm::dvec3 size = glm::abs(node.box.min) + glm::abs(node.box.max);
        double from = 0.0;
        if (!passes_box(ray_, node.box, ray_.error + 1e-14 * (size.x + size.y + size.z), from)) return;
        if (node.right != 0) {
            descend(at + 1);
            return descend(node.right);
        }
        for (std::uint32_t i = node.begin; i < node.end; ++i) visit(compound_.order_[i]);
    }

    const Compound& compound_;
    const NearRay& ray_;
    ChildVisitor visit_;
};

void visit_children_along(const Compound& compound, const NearRay& ray, ChildVisitor visit) {
    CompoundRay(compound, ray, visit).run();
}

}  // namespace crofton::convex
