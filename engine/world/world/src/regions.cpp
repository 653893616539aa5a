// SPDX-License-Identifier: MIT
// Attaches and detaches regions, and resolves handles of their objects.
#include "regions.hpp"

#include <algorithm>
#include <crofton/boxtree/structure.hpp>
#include <crofton/core/error.hpp>
#include <crofton/core/recovery.hpp>
#include <crofton/geometry/finite.hpp>
#include <glm/common.hpp>

#include "require_ok.hpp"

namespace crofton::world {
namespace {

// Around all objects of a region that is moved there: around the bounds' sums, which round, and the centers' too.
Obb bounds_in_world(const Region& region, const Move& move) {
    const double rounding = move.rounding(glm::dvec3(0.0));
    const Aabb& bounds = region.bounds();
    return obb_of(Aabb{bounds.min + move.by - rounding, bounds.max + move.by + rounding});
}

double largest(const Aabb& bounds) {
    const glm::dvec3 most = glm::max(glm::abs(bounds.min), glm::abs(bounds.max));
    return std::max({most.x, most.y, most.z});
}

}  // namespace

Object Attachment::object(std::uint32_t item_of_region) const {
    const RegionData::Item& of_item = data().items[item_of_region];
    Object result;
    result.kind = of_item.kind;
    result.alive = alive;
    result.layers = data().tree.layer_masks()[item_of_region];
    result.collides_with = of_item.collides_with;
    result.radius = of_item.radius;
    return result;
}

Regions::Regions(std::uint32_t first_generation)
    : tree_(detail::value_or_give_up(boxtree::BoxTree::build({}))), next_generation_(first_generation) {}

Result<std::uint32_t> Regions::take_pages(std::uint32_t count) {
    for (auto run = free_pages_.begin(); run != free_pages_.end(); ++run) {
        if (run->count < count) continue;
        const std::uint32_t first = run->first;
        run->first += count;
        run->count -= count;
        if (run->count == 0) free_pages_.erase(run);
        return first;
    }
    // The last page is left out: its last index is kNoIndex.
    constexpr std::uint32_t kMostPages = (kNoIndex - kFirstRegionIndex) / kPage;
    const auto used = static_cast<std::uint32_t>(page_slots_.size());
    if (count > kMostPages - used)
        return fail(ErrorCode::out_of_range, kNoItem,
                    "world: the regions that are attached have more than 2^31 objects: detach some, and update");
    page_slots_.resize(used + std::size_t{count}, kNoIndex);
    return used;
}

void Regions::give_back(Pages pages) {
    std::fill_n(page_slots_.begin() + pages.first, pages.count, kNoIndex);
    auto after = std::lower_bound(free_pages_.begin(), free_pages_.end(), pages,
                                  [](const Pages& a, const Pages& b) { return a.first < b.first; });
    if (after != free_pages_.end() && pages.first + pages.count == after->first) {
        pages.count += after->count;
        after = free_pages_.erase(after);
    }
    if (after != free_pages_.begin() && std::prev(after)->first + std::prev(after)->count == pages.first)
        std::prev(after)->count += pages.count;
    else
        free_pages_.insert(after, pages);
}

Result<RegionHandle> Regions::attach(const Region& region, const glm::dvec3& origin) {
    if (!is_finite(origin))
        return fail(ErrorCode::non_finite, kNoItem, "world: the region's origin is NaN or infinite");
    const double most = region.object_count() > 0 ? largest(region.bounds()) : 0.0;
    const glm::dvec3 far = glm::abs(origin) + most;
    if (std::max({far.x, far.y, far.z}) > 0.5 * kMaxCoordinate)
        return fail(ErrorCode::out_of_range, kNoItem, "world: the region's origin puts its objects out of range");
    const glm::dvec3 from_zero = glm::abs(origin);
    if (region.object_count() > 0 && !region.data()->solids.empty() &&
        std::max({from_zero.x, from_zero.y, from_zero.z}) > region.data()->max_origin)
        return fail(ErrorCode::out_of_range, kNoItem,
                    "world: the origin is beyond the region's RegionOptions::max_origin: prepare it with a larger one");
    const std::uint32_t pages = pages_of(region);
    std::uint32_t first = kNoIndex;
    if (pages > 0) {
        const auto taken = take_pages(pages);
        if (!taken) return taken.error();
        first = kFirstRegionIndex + *taken * kPage;
    }
    if (free_slots_.empty()) {
        free_slots_.push_back(static_cast<std::uint32_t>(attachments_.size()));
        attachments_.emplace_back();
    }
    const std::uint32_t slot = free_slots_.back();
    free_slots_.pop_back();
    if (pages > 0) std::fill_n(page_slots_.begin() + (first - kFirstRegionIndex) / kPage, pages, slot);
    Attachment& attachment = attachments_[slot];
    attachment.region = region;
    attachment.move = {origin, most};
    attachment.first = first;
    attachment.generation = next_generation_;
    attachment.alive = true;
    if (pages > 0) {
        attachment.bounds = bounds_in_world(region, attachment.move);
        attachment.tree = cull::moved_tree_of(region.data()->tree, attachment.move, first);
        attachment.common_layers = region.data()->common_layers;
    }
    renew(next_generation_);
    attached_.push_back(slot);
    object_count_ += region.object_count();
    return RegionHandle{slot, attachment.generation};
}

bool Regions::contains(RegionHandle region) const {
    return region.index < attachments_.size() && attachments_[region.index].alive &&
           attachments_[region.index].generation == region.generation;
}

bool Regions::contains(ObjectHandle object) const {
    if (!is_region_index(object.index)) return false;
    const std::uint32_t page = (object.index - kFirstRegionIndex) / kPage;
    if (page >= page_slots_.size() || page_slots_[page] == kNoIndex) return false;
    const Attachment& region = attachments_[page_slots_[page]];
    return region.alive && region.generation == object.generation && object.index - region.first < region.size();
}

Result<void> Regions::check(RegionHandle region) const {
    if (contains(region)) return {};
    if (region.is_null() || region.generation == 0)
        return fail(ErrorCode::stale_handle, region.index, "world: the handle of the region was never set");
    return fail(ErrorCode::stale_handle, region.index,
                {"world: region ", region.index, " of generation ", region.generation,
                 " has been detached, or is of another World"});
}

Result<void> Regions::check(ObjectHandle object, std::uint64_t item) const {
    if (contains(object)) return {};
    return fail(ErrorCode::stale_handle, item,
                {"world: the region of object ", object.index, " of generation ", object.generation,
                 " has been detached, or is of another World"});
}

Result<void> Regions::refuse_change(ObjectHandle object, std::uint64_t item) const {
    if (auto known = check(object, item); !known) return known;
    return fail(ErrorCode::unsupported, item,
                "world: a region's objects can only be hidden: hide this one, and add an object in its place");
}

Result<void> Regions::detach(RegionHandle region) {
    if (auto known = check(region); !known) return known;
    Attachment& attachment = attachments_[region.index];
    attachment.alive = false;
    object_count_ -= attachment.size();
    detached_.push_back(region.index);
    return {};
}

Result<void> Regions::set_hidden(ObjectHandle object, bool hidden) {
    if (auto known = check(object, object.index); !known) return known;
    hides_.push_back({object, hidden});
    return {};
}

void Regions::place(std::uint32_t slot) {
    Attachment& attachment = attachments_[slot];
    if (!attachment.alive || attachment.size() == 0) return;
    const auto item = tree_.insert(attachment.bounds, attachment.data().any_layers);
    attachment.item = detail::value_or_give_up(item);
    attachment.placed = true;
    if (slot_of_item_.size() <= attachment.item) slot_of_item_.resize(attachment.item + std::size_t{1}, kNoIndex);
    slot_of_item_[attachment.item] = slot;
    changed_.push_back(slot);
}

void Regions::drop(std::uint32_t slot) {
    Attachment& attachment = attachments_[slot];
    if (attachment.placed) require_ok(tree_.remove(attachment.item));
    if (attachment.size() > 0) give_back({(attachment.first - kFirstRegionIndex) / kPage, pages_of(attachment.region)});
    attachment = {};
    free_slots_.push_back(slot);
}

void Regions::apply(const StagedHide& change) {
    if (!contains(change.object)) return;
    Attachment& region = attachments_[slot_of(change.object.index)];
    const std::uint32_t item = change.object.index - region.first;
    if (region.is_shown(item) == !change.hidden) return;
    if (region.shown.empty()) region.shown.assign((region.size() + 63) / 64, ~std::uint64_t{0});
    region.shown[item / 64] ^= std::uint64_t{1} << item % 64;
    region.hidden_count += change.hidden ? 1 : std::size_t(-1);
    if (region.hidden_count == 0) region.shown = {};
    changed_.push_back(slot_of(change.object.index));
}

bool Regions::update() {
    constexpr std::size_t kRebuildBudget = 1024;  // about 25 µs
    const bool members = !attached_.empty() || !detached_.empty(), changed = members || !hides_.empty();
    changed_.clear();
    for (const std::uint32_t slot : detached_) drop(slot);
    for (const std::uint32_t slot : attached_) place(slot);
    for (const StagedHide& hide : hides_) apply(hide);
    attached_.clear();
    detached_.clear();
    hides_.clear();
    if (members) tree_.refit();
    // The first that ends may have begun before the last change.
    if (members) rebuilds_wanted_ = 2;
    if (rebuilds_wanted_ > 0 && tree_.item_count() > 0 && tree_.rebuild_step(kRebuildBudget)) --rebuilds_wanted_;
    return changed;
}

Aabb Regions::bounds() const {
    Aabb bounds;
    if (tree_.item_count() == 0) return bounds;
    const boxtree::Structure& structure = tree_.structure();
    for (unsigned lane = 0; lane < structure.nodes()[0].count; ++lane) bounds.include(structure.child_bounds(0, lane));
    return bounds;
}

ObjectRef Regions::ref(std::uint32_t index) const {
    const std::uint32_t slot = slot_of(index);
    if (slot == kNoIndex) return {};
    const Attachment& region = attachments_[slot];
    const std::uint32_t item = index - region.first;
    if (item >= region.size()) return {};
    return region.ref(item);
}

Object Regions::object(std::uint32_t index) const {
    const Attachment& region = of(index);
    return region.object(index - region.first);
}

PlacedMesh Regions::mesh(std::uint32_t index) const {
    const Attachment& region = of(index);
    const RegionData::Solid* const solid = region.data().solid(index - region.first);
    if (solid == nullptr || solid->mesh == kNoIndex) return {};
    const MeshShape& mesh = region.data().meshes[solid->mesh].shape;
    if (!mesh.is_usable) return {};
    return {&mesh, &solid->transform.linear, solid->transform.translation + region.move.by};
}

PictureView::Drawn Regions::drawn(std::uint32_t index) const {
    const Attachment& region = of(index);
    const RegionData::Solid* const solid = region.data().solid(index - region.first);
    if (solid == nullptr || solid->mesh == kNoIndex) return {.box = box(index)};
    const MeshClusters::Mesh& clusters = region.data().meshes[solid->mesh].clusters;
    if (!clusters.usable) return {.box = box(index)};
    return {.clusters = &clusters,
            .placed = {nullptr, &solid->transform.linear, solid->transform.translation + region.move.by},
            .occludes = solid->occludes};
}

std::optional<RigidTransform> Regions::pose(std::uint32_t index) const {
    std::optional<RigidTransform> pose = placed_shape(index)->pose;
    if (pose) pose->translation += of(index).move.by;
    return pose;
}

Transform Regions::transform(std::uint32_t index) const {
    Transform transform = solid(index)->transform;
    transform.translation += of(index).move.by;
    return transform;
}

}  // namespace crofton::world
