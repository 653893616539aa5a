// SPDX-License-Identifier: MIT
// Regions: what is done away from the game's thread.
#include <crofton/world/region.hpp>

#include <algorithm>
#include <crofton/boxtree/structure.hpp>
#include <crofton/core/recovery.hpp>
#include <crofton/core/stop_signal.hpp>
#include <glm/geometric.hpp>
#include <utility>

#include "bound_rules.hpp"
#include "region_data.hpp"

namespace crofton {
namespace {

Result<void> cancelled() {
    return fail(ErrorCode::cancelled, kNoItem, "region: the callback asked to stop");
}

Result<void> read(Strided<RegionObject> objects, detail::StopSignal& stop, Vector<Obb>& boxes,
                  Vector<std::uint32_t>& layers, Vector<world::RegionData::Item>& items) {
    constexpr std::size_t kBetweenQuestions = 4096;
    for (std::size_t i = 0; i < objects.size(); ++i) {
        if (i % kBetweenQuestions == 0 &&
            stop.is_raised(0.1 * static_cast<double>(i) / static_cast<double>(objects.size())))
            return cancelled();
        const RegionObject& object = objects[i];
        if (auto valid = world::validate(object.bound, i, "region: an object needs a bound"); !valid) return valid;
        boxes.push_back(object.bound.box);
        layers.push_back(object.layers);
        items.push_back({object.user, object.bound.radius, object.collides_with, object.bound.kind});
    }
    return {};
}

}  // namespace

Result<Region> Region::prepare(Strided<RegionObject> objects, const RegionOptions& options, Executor& executor) {
    if (objects.size() > options.max_objects)
        return fail(ErrorCode::out_of_range, options.max_objects,
                    {"region: ", objects.size(), " objects are more than max_objects: prepare several regions"});
    return detail::recover([&]() -> Result<Region> {
        detail::StopSignal stop(options.should_stop, options.stop_user);
        Vector<Obb> boxes;
        Vector<std::uint32_t> layers;
        Vector<world::RegionData::Item> items;
        boxes.reserve(objects.size());
        layers.reserve(objects.size());
        items.reserve(objects.size());
        if (auto done = read(objects, stop, boxes, layers, items); !done) return tl::unexpected(done.error());
        Region region;
        if (boxes.empty()) return region;
        auto tree = boxtree::BoxTree::build(boxes, layers, {.orientation = options.tree}, executor);
        if (!tree) return tl::unexpected(tree.error());
        auto data = Owner<world::RegionData>::make(std::move(*tree));
        data->items = std::move(items);
        data->common_layers = ~0u;
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            data->bounds.include(aabb_of(boxes[i]));
            data->most_radius = std::max(data->most_radius, glm::length(glm::dvec3(boxes[i].half_extents)));
            data->any_layers |= layers[i];
            data->common_layers &= layers[i];
        }
        data->most_radius *= 1.0 + 0x1p-40;  // of the root's rounding
        if (stop.is_raised(1.0)) return tl::unexpected(cancelled().error());
        region.data_ = data.release();
        return region;
    });
}

Region::Region() = default;
Region::~Region() {
    if (data_ == nullptr || data_->owners.fetch_sub(1, std::memory_order_acq_rel) != 1) return;
    Destroy<world::RegionData>()(const_cast<world::RegionData*>(data_));
}
Region::Region(const Region& other) : data_(other.data_) {
    if (data_ != nullptr) data_->owners.fetch_add(1, std::memory_order_relaxed);
}
Region& Region::operator=(const Region& other) {
    return *this = Region(other);
}
Region::Region(Region&& other) noexcept : data_(std::exchange(other.data_, nullptr)) {}
Region& Region::operator=(Region&& other) noexcept {
    const Region old(std::move(*this));
    data_ = std::exchange(other.data_, nullptr);
    return *this;
}

std::size_t Region::object_count() const {
    return data_ != nullptr ? data_->items.size() : 0;
}

const Aabb& Region::bounds() const {
    static const Aabb kEmpty;
    return data_ != nullptr ? data_->bounds : kEmpty;
}

std::size_t Region::bytes() const {
    if (data_ == nullptr) return 0;
    const boxtree::Structure& tree = data_->tree.structure();
    return sizeof(world::RegionData) + data_->items.size() * sizeof(world::RegionData::Item) +
           data_->tree.boxes().size_bytes() + data_->tree.layer_masks().size_bytes() + tree.nodes().size_bytes() +
           tree.leaves().size_bytes() + tree.slot_items().size_bytes() + tree.leaf_counts().size_bytes() +
           tree.leaf_ranges().size_bytes() + tree.leaf_radii().size_bytes() + tree.node_radii().size_bytes() +
           tree.item_slots().size_bytes() + tree.axes().size_bytes();
}

}  // namespace crofton
