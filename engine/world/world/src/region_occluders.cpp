// SPDX-License-Identifier: MIT
// Places and removes the occluders of regions' objects, a few in each update.
#include <algorithm>
#include <crofton/core/recovery.hpp>

#include "occluders.hpp"
#include "require_ok.hpp"

namespace crofton::world {
namespace {

using occlude::FoundOccluder;
using occlude::OccluderId;
using occlude::ShapeId;

constexpr std::size_t kBudget = 256, kCostOfShape = 16;  // in placed occluders, about: some 0.3 ms an update

}  // namespace

std::size_t Occluders::shapes_of(const Region& region) {
    const auto is_same = [&](const RegionShapes& shapes) { return shapes.region.data() == region.data(); };
    auto found = std::find_if(region_shapes_.begin(), region_shapes_.end(), is_same);
    if (found == region_shapes_.end()) {
        const auto is_free = [](const RegionShapes& shapes) { return shapes.users == 0; };
        found = std::find_if(region_shapes_.begin(), region_shapes_.end(), is_free);
        if (found == region_shapes_.end()) found = region_shapes_.insert(found, RegionShapes());
        found->region = region;
        found->of_mesh.assign(region.data()->meshes.size(), {});
    }
    ++found->users;
    return static_cast<std::size_t>(found - region_shapes_.begin());
}

void Occluders::release_shapes(std::size_t place) {
    RegionShapes& shapes = region_shapes_[place];
    if (--shapes.users > 0) return;
    for (Vector<ShapeId>& of_mesh : shapes.of_mesh) remove_shapes(of_mesh);
    shapes = {};
}

// The region was prepared with occluders that are checked: only one that cannot be placed is left out.
std::size_t Occluders::add_some(RegionHolder& holder, std::size_t budget) {
    RegionShapes& shapes = region_shapes_[holder.shapes];
    const RegionData& data = *shapes.region.data();
    std::size_t cost = 0;
    while (holder.first.size() < data.occluding.size() && cost < budget) {
        const std::uint32_t item = data.occluding[holder.first.size()];
        const RegionData::Solid& solid = *data.solid(item);
        const Vector<FoundOccluder>& occluders = data.meshes[solid.mesh].occluders;
        Vector<ShapeId>& of_mesh = shapes.of_mesh[solid.mesh];
        while (of_mesh.size() < occluders.size() && cost < budget) {
            of_mesh.push_back(detail::value_or_give_up(add_shape(occluders[of_mesh.size()])));
            cost += kCostOfShape;
        }
        if (of_mesh.size() < occluders.size()) return cost;
        Transform transform = solid.transform;
        transform.translation += holder.origin;
        Placed placed{holder.first_object.index + item};
        placed.generation = holder.first_object.generation;
        OccluderId& first = holder.first.emplace_back(kNoIndex);
        for (std::size_t i = occluders.size(); i-- > 0; ++cost) {
            placed.place = static_cast<std::uint32_t>(i);
            place_one(of_mesh[i], occluders[i], transform, solid.occluding_layers, placed, first);
        }
    }
    return cost;
}

std::size_t Occluders::take_some(RegionHolder& holder, std::size_t budget) {
    std::size_t cost = 0;
    for (; !holder.first.empty() && cost < budget; ++cost) {
        take_away_chain(holder.first.back());
        holder.first.pop_back();
    }
    return cost;
}

bool Occluders::update_regions(const Regions& regions) {
    for (const std::uint32_t slot : regions.changed()) {
        const Attachment& attached = regions.at_slot(slot);
        const RegionHandle handle{slot, attached.generation};
        const auto is_known = [&](const RegionHolder& holder) { return holder.handle == handle; };
        if (!regions.contains(handle) || attached.size() == 0 || attached.data().occluding.empty()) continue;
        if (std::any_of(region_holders_.begin(), region_holders_.end(), is_known)) continue;
        region_holders_.push_back(
            {handle, {attached.first, attached.generation}, attached.move.by, shapes_of(attached.region), {}});
        region_holders_.back().first.reserve(attached.data().occluding.size());
        any_ = true;
    }
    // What has gone gets half of the time, so that it does not pile up while regions keep coming.
    std::size_t left = kBudget;
    for (RegionHolder& holder : region_holders_)
        if (!regions.contains(holder.handle)) left -= std::min(take_some(holder, left - kBudget / 2), left);
    waiting_count_ = 0;
    for (RegionHolder& holder : region_holders_) {
        if (!regions.contains(holder.handle)) continue;
        left -= std::min(add_some(holder, left), left);
        waiting_count_ += region_shapes_[holder.shapes].region.data()->occluding.size() - holder.first.size();
    }
    const auto is_done = [&](const RegionHolder& holder) {
        const bool done = holder.first.empty() && !regions.contains(holder.handle);
        if (done) release_shapes(holder.shapes);
        return done;
    };
    region_holders_.erase(std::remove_if(region_holders_.begin(), region_holders_.end(), is_done),
                          region_holders_.end());
    return left < kBudget;
}

}  // namespace crofton::world
