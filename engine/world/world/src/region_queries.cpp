// SPDX-License-Identifier: MIT
// What is asked of attached regions: first the tree of regions, then the trees of those that may answer.
#include <algorithm>
#include <cmath>
#include <crofton/collide/moved_tree.hpp>
#include <crofton/geometry/finite.hpp>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>

#include "region_view.hpp"
#include "regions.hpp"

namespace crofton::world {

namespace {

// Regions that a ray meets, of which the nearest comes first: most rays end in one of the first.
class RegionsAlong {
  public:
    [[nodiscard]] bool is_full() const { return count_ == kMost; }
    void add(boxtree::ItemId item, double t) {
        std::size_t place = count_++;
        for (; place > 0 && met_[place - 1].t > t; --place) met_[place] = met_[place - 1];
        met_[place] = {t, item};
    }
    // Visits them, the nearest first, as long as they begin before the end; visit_region(item) returns where it is now.
    template <class Visit>
    void visit(double end, Visit visit_region) {
        for (std::size_t i = 0; i < count_ && met_[i].t <= end; ++i) end = visit_region(met_[i].item);
        count_ = 0;
    }

  private:
    static constexpr std::size_t kMost = 32;
    struct Met {
        double t;
        boxtree::ItemId item;
    };
    Met met_[kMost];
    std::size_t count_ = 0;
};

}  // namespace

void Regions::visit_along(const Ray& ray, std::uint32_t layers, collide::RayVisitor visit) const {
    if (tree_.item_count() == 0) return;
    Ray rest = ray;
    const auto visit_region = [&](boxtree::ItemId item) {
        const Attachment& region = attachments_[slot_of_item_[item]];
        if (!region.alive) return rest.max_t;
        collide::visit_along(
            rest, region.data().tree, region.move,
            [&](boxtree::ItemId object, double t) {
                if (region.is_shown(object)) rest.max_t = visit(region.first + object, t);
                return rest.max_t;
            },
            layers);
        return rest.max_t;
    };
    RegionsAlong met;
    collide::visit_along(
        ray, tree_,
        [&](boxtree::ItemId item, double t) {
            if (met.is_full()) met.visit(rest.max_t, visit_region);
            if (t <= rest.max_t) met.add(item, t);
            return rest.max_t;
        },
        layers);
    met.visit(rest.max_t, visit_region);
}

void Regions::visit_near(const Aabb& bounds, double distance, std::uint32_t layers, collide::NearVisitor visit) const {
    if (tree_.item_count() == 0) return;
    const auto visit_region = [&](boxtree::ItemId item) {
        const Attachment& region = attachments_[slot_of_item_[item]];
        if (!region.alive) return distance;
        const double rounding = region.move.rounding(glm::max(glm::abs(bounds.min), glm::abs(bounds.max)));
        const Aabb back{region.move.back(bounds.min) - rounding, region.move.back(bounds.max) + rounding};
        collide::visit_near(
            back, distance, region.data().tree,
            [&](boxtree::ItemId object) {
                if (region.is_shown(object)) distance = visit(region.first + object);
                return distance;
            },
            layers);
        return distance;
    };
    collide::visit_near(bounds, distance, tree_, visit_region, layers);
}

void WholeView::clear() {
    ids.clear();
    occluded.clear();
    verdicts.clear();
    straddling.clear();
    inside_count = 0;
    statistics = {};
    occlusion = {};
}

void WholeView::add(std::uint32_t id, cull::Verdict verdict, cull::ResultOrder order_asked) {
    const bool inside = verdict == cull::Verdict::inside;
    inside_count += inside ? 1 : 0;
    if (order_asked == cull::ResultOrder::tree) return (inside ? ids : straddling).add(id);
    ids.add(id);
    verdicts.add(verdict);
}

namespace {

void add_moved(AnswerList<std::uint32_t>& list, std::span<const std::uint32_t> items, std::uint32_t first) {
    std::uint32_t* const to = list.extend(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) to[i] = first + items[i];
}

}  // namespace

// No object is farther from the eye, in radii, or smaller, than the limits allow: as far as the bounds tell.
bool Regions::may_be_within(const cull::DrawLimits& limits, const Attachment& region) const {
    const auto counts = [](double limit) { return std::abs(limit) <= kMaxCoordinate; };
    if (!is_finite(limits.eye)) return true;
    constexpr double kSlack = 1.0 + 1e-9;
    const double longer = std::max(1.0, limits.hysteresis) * kSlack, most = region.data().most_radius * longer;
    if (counts(limits.least_radius) && limits.least_radius > most) return false;
    if (!counts(limits.max_distance_in_radii)) return true;
    const glm::dvec3 apart = glm::abs(region.bounds.center - limits.eye),
                     rounding = 1e-15 * (glm::abs(region.bounds.center) + glm::abs(limits.eye));
    const glm::dvec3 gap = glm::max(apart - glm::dvec3(region.bounds.half_extents) - rounding, 0.0);
    return glm::length(gap) <= std::max(0.0, limits.max_distance_in_radii) * most;
}

void Regions::find_visible(const RegionQuery& query, WholeView& result) const {
    cull::find_visible(tree_, query.view, result.regions, {.mode = cull::CullMode::conservative});
    result.query.start(query.view);
    // By their objects' indices, which are distinct.
    result.order.clear();
    for (const boxtree::ItemId item : result.regions.ids()) {
        const std::uint32_t slot = slot_of_item_[item];
        result.order.push_back(std::uint64_t{attachments_[slot].first} << 32 | slot);
    }
    std::sort(result.order.begin(), result.order.end());
    for (const std::uint64_t entry : result.order) {
        const Attachment& region = attachments_[static_cast<std::uint32_t>(entry)];
        if (query.limits != nullptr && !may_be_within(*query.limits, region)) continue;
        if (query.buffer != nullptr && !query.list_occluded && query.buffer->hides(region.bounds)) continue;
        add_visible(region, query, result);
    }
    result.ids.add(result.straddling.values());
}

void Regions::add_visible(const Attachment& region, const RegionQuery& query, WholeView& result) const {
    const RegionData& data = region.data();
    const bool asks_each = query.limits != nullptr || query.buffer != nullptr;
    const bool by_tree = query.order == cull::ResultOrder::tree;
    const std::uint32_t planes = result.query.planes_that_may_cut(region.bounds);
    if (planes == 0 && region.shown.empty() && (data.common_layers & query.view.layer_mask) != 0 && !asks_each) {
        std::uint32_t* const to = result.ids.extend(data.items.size());
        std::iota(to, to + data.items.size(), region.first);
        if (!by_tree) std::fill_n(result.verdicts.extend(data.items.size()), data.items.size(), cull::Verdict::inside);
        result.inside_count += data.items.size();
        if (cull::kCountStatistics) result.statistics.accepted_whole += data.items.size();
        return;
    }
    const cull::CullOptions how{query.mode, asks_each ? cull::ResultOrder::ascending : query.order, nullptr,
                                region.shown};
    result.query.find_visible(data.tree, region.move, planes, result.found, how);
    result.statistics += result.found.statistics();
    const std::span<const std::uint32_t> found = result.found.ids();
    if (!asks_each) {
        const std::size_t inside = result.found.inside_count();
        result.inside_count += inside;
        add_moved(result.ids, by_tree ? found.first(inside) : found, region.first);
        if (by_tree) add_moved(result.straddling, found.subspan(inside), region.first);
        result.verdicts.add(result.found.verdicts());
        return;
    }
    result.boxes.clear();
    result.kept.clear();
    result.kept_verdicts.clear();
    for (std::size_t i = 0; i < found.size(); ++i) {
        const std::uint32_t id = region.first + found[i];
        const Obb box = region.box(found[i]);
        const std::uint32_t common = data.tree.layer_masks()[found[i]] & query.view.layer_mask;
        if (query.limits != nullptr && !cull::is_worth_drawing(*query.limits, box, id, common)) continue;
        result.boxes.push_back(box);
        result.kept.push_back(id);
        result.kept_verdicts.push_back(result.found.verdicts()[i]);
    }
    if (query.buffer == nullptr) {
        for (std::size_t i = 0; i < result.kept.size(); ++i)
            result.add(result.kept[i], result.kept_verdicts[i], query.order);
        return;
    }
    occlude::find_visible(result.boxes, {}, *query.buffer, result.not_hidden, {.mode = query.mode});
    const occlude::VisibleStatistics& asked = result.not_hidden.statistics();
    result.occlusion.asked.items_tested += asked.items_tested;
    result.occlusion.asked.items_hidden += asked.items_hidden;
    const std::span<const std::uint32_t> seen = result.not_hidden.ids();
    for (std::size_t i = 0, s = 0; i < result.kept.size(); ++i) {
        if (s < seen.size() && seen[s] == i) {
            result.add(result.kept[i], result.not_hidden.verdicts()[s], query.order);
            ++s;
        } else if (query.list_occluded) {
            result.occluded.add(result.kept[i]);
        }
    }
}

}  // namespace crofton::world
