// SPDX-License-Identifier: MIT
// Queries of attached regions: searches the tree of regions first, then the trees of those that may answer.
#include <hwy/cache_control.h>
#include <algorithm>
#include <bit>
#include <cmath>
#include <crofton/collide/moved_tree.hpp>
#include <crofton/geometry/finite.hpp>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "region_view.hpp"
#include "regions.hpp"

namespace crofton::world {

namespace {

void prefetch(const Attachment& region) {
    for (std::size_t at = 0; at < sizeof(Attachment); at += 64)
        hwy::Prefetch(reinterpret_cast<const char*>(&region) + at);
}

}  // namespace

collide::MovedTree Regions::tree_of(boxtree::ItemId item) const {
    const Attachment& region = attachments_[slot_of_item_[item]];
    return region.alive ? collide::MovedTree{&region.tree.arrays, &region.move} : collide::MovedTree{};
}

void Regions::visit_along(const Ray& ray, std::uint32_t layers, collide::RayVisitor visit) const {
    if (tree_.item_count() == 0) return;
    double end = ray.max_t;
    collide::visit_along(
        ray, tree_, [&](boxtree::ItemId item) { return tree_of(item); },
        [&](boxtree::ItemId item, boxtree::ItemId object, double t) {
            const Attachment& region = attachments_[slot_of_item_[item]];
            if (region.is_shown(object)) end = visit(region.first + object, t);
            return end;
        },
        layers);
}

void Regions::visit_swept(const Ray& path, const glm::dvec3& half_size, std::uint32_t layers,
                          collide::NearVisitor visit) const {
    if (tree_.item_count() == 0) return;
    double end = path.max_t;
    collide::visit_swept(
        path, half_size, tree_, [&](boxtree::ItemId item) { return tree_of(item); },
        [&](boxtree::ItemId item, boxtree::ItemId object) {
            const Attachment& region = attachments_[slot_of_item_[item]];
            if (region.is_shown(object)) end = visit(region.first + object);
            return end;
        },
        layers);
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

// No object is farther from the eye, in radii, or smaller, than the limits allow: as far as the bounds tell.
bool Regions::may_be_within(const cull::DrawLimits& limits, const Attachment& region) const {
    const auto counts = [](double limit) { return std::abs(limit) <= kMaxCoordinate; };
    if (!is_finite(limits.eye)) return true;
    constexpr double kRounding = 1.0 + 1e-9;
    const double longer = std::max(1.0, limits.hysteresis) * kRounding, most = region.data().most_radius * longer;
    if (counts(limits.least_radius) && limits.least_radius > most) return false;
    if (!counts(limits.max_distance_in_radii)) return true;
    const glm::dvec3 apart = glm::abs(region.bounds.center - limits.eye),
                     rounding = 1e-15 * (glm::abs(region.bounds.center) + glm::abs(limits.eye));
    const glm::dvec3 gap = glm::max(apart - glm::dvec3(region.bounds.half_extents) - rounding, 0.0);
    return glm::length(gap) <= std::max(0.0, limits.max_distance_in_radii) * most;
}

// In the order of their objects' indices, if the answer is.
void Regions::list_seen(const RegionQuery& query, WholeView& result) const {
    cull::find_visible(tree_, query.view, result.regions,
                       {.mode = cull::CullMode::conservative, .order = cull::ResultOrder::tree});
    result.seen.clear();
    const auto add = [&](std::uint32_t slot, bool is_inside) {
        const Attachment& region = attachments_[slot];
        if (query.limits != nullptr && !may_be_within(*query.limits, region)) return;
        if (query.buffer != nullptr && !query.list_occluded && query.buffer->hides(region.bounds)) return;
        result.seen.push_back({&region, is_inside});
    };
    const std::span<const boxtree::ItemId> items = result.regions.ids();
    const std::size_t inside_count = result.regions.inside_count();
    if (query.order == cull::ResultOrder::tree) {
        for (std::size_t i = 0; i < items.size(); ++i) add(slot_of_item_[items[i]], i < inside_count);
        return;
    }
    result.pages.assign((page_slots_.size() + 63) / 64, 0);
    result.inside_pages.assign(result.pages.size(), 0);
    for (std::size_t i = 0; i < items.size(); ++i) {
        const std::uint32_t page = (attachments_[slot_of_item_[items[i]]].first - kFirstRegionIndex) / kPage;
        const std::uint64_t bit = std::uint64_t{1} << page % 64;
        result.pages[page / 64] |= bit;
        if (i < inside_count) result.inside_pages[page / 64] |= bit;
    }
    for (std::size_t w = 0; w < result.pages.size(); ++w)
        for (std::uint64_t rest = result.pages[w]; rest != 0; rest &= rest - 1)
            add(page_slots_[64 * w + static_cast<std::size_t>(std::countr_zero(rest))],
                (result.inside_pages[w] & rest & (~rest + 1)) != 0);
}

void Regions::find_visible(const RegionQuery& query, WholeView& result) const {
    constexpr std::size_t kMostItems = std::size_t{1} << 20;  // asked at once, unless one region has more
    constexpr std::size_t kAhead = 8;
    result.query.start(query.view);
    list_seen(query, result);
    WholeView::Batch& batch = result.batch;
    batch.clear();
    const auto ask = [&] {
        add_visible(query, result);
        batch.clear();
    };
    for (std::size_t i = 0; i < result.seen.size(); ++i) {
        if (i + kAhead < result.seen.size()) prefetch(*result.seen[i + kAhead].region);
        const auto& [region, is_inside] = result.seen[i];
        const std::uint32_t planes = is_inside ? 0 : result.query.planes_that_may_cut(region->bounds);
        const bool is_whole = planes == 0 && region->shown.empty() && !query.asks_each() &&
                              (region->common_layers & query.view.layer_mask) != 0;
        batch.parts.push_back({region, is_whole});
        if (is_whole) continue;
        batch.trees.push_back({&region->tree, planes});
        batch.items += region->tree.arrays.item_count;
        if (batch.trees.size() == cull::MovedTreesQuery::kMost || batch.items >= kMostItems) ask();
    }
    ask();
    result.statistics += result.query.statistics();
    result.ids.add(result.straddling.values());
}

void Regions::add_visible(const RegionQuery& query, WholeView& result) const {
    const WholeView::Batch& batch = result.batch;
    const bool by_tree = query.order == cull::ResultOrder::tree;
    // In tree order there is nothing to sort, unless single objects are looked at.
    const bool all_together =
        by_tree && !query.asks_each() &&
        std::all_of(batch.parts.begin(), batch.parts.end(),
                    [](const WholeView::Batch::Part& part) { return part.region->shown.empty(); });
    if (all_together)
        result.inside_count += result.query.find_visible(batch.trees, query.mode, result.ids, result.straddling);
    else
        result.query.find_visible(batch.trees, query.mode);
    std::size_t tree = 0;
    for (const WholeView::Batch::Part& part : batch.parts) {
        if (part.is_whole)
            add_whole(*part.region, by_tree, result);
        else if (!all_together)
            add_listed(*part.region, tree++, query, result);
    }
}

void Regions::add_whole(const Attachment& region, bool by_tree, WholeView& result) {
    const std::size_t count = region.tree.arrays.item_count;
    cull::MovedTreesQuery::list_all(region.tree, result.ids);
    if (!by_tree) std::fill_n(result.verdicts.extend(count), count, cull::Verdict::inside);
    result.inside_count += count;
    if (cull::kCountStatistics) result.statistics.accepted_whole += count;
}

// What the query has found in its tree of that number.
void Regions::add_listed(const Attachment& region, std::size_t tree, const RegionQuery& query,
                         WholeView& result) const {
    if (query.order == cull::ResultOrder::ascending && !query.asks_each()) {
        result.inside_count += result.query.list(tree, region.shown, result.ids, result.verdicts);
        return;
    }
    result.found.clear();
    result.found_verdicts.clear();
    (void)result.query.list(tree, region.shown, result.found, result.found_verdicts);
    const std::span<const std::uint32_t> found = result.found.values();
    const std::span<const std::uint32_t> layer_masks = region.data().tree.layer_masks();
    result.boxes.clear();
    result.kept.clear();
    result.kept_verdicts.clear();
    for (std::size_t i = 0; i < found.size(); ++i) {
        const std::uint32_t id = found[i], item = id - region.first;
        const Obb box = region.box(item);
        const std::uint32_t common = layer_masks[item] & query.view.layer_mask;
        if (query.limits != nullptr && !cull::is_worth_drawing(*query.limits, box, id, common)) continue;
        result.boxes.push_back(box);
        result.kept.push_back(id);
        result.kept_verdicts.push_back(result.found_verdicts.values()[i]);
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
