// SPDX-License-Identifier: MIT
#include "pair_neighbors.hpp"

#include <algorithm>
#include <glm/geometric.hpp>

#include "object_table.hpp"

namespace crofton::world {
namespace {

constexpr double kFlush = 1e-6;  // of the size

double size_of(const Aabb& bounds) {
    return glm::distance(bounds.min, bounds.max);
}

constexpr auto is_slot_before = [](const auto& slot, std::uint32_t object) { return slot.object < object; };

}  // namespace

std::uint32_t PairNeighbors::slot_of(std::uint32_t object) const {
    if (object < slot_of_.size()) return slot_of_[object];
    if (object < kFirstRegionIndex) return kNoIndex;
    const auto at = std::lower_bound(region_slots_.begin(), region_slots_.end(), object, is_slot_before);
    return at != region_slots_.end() && at->object == object ? at->slot : kNoIndex;
}

std::uint32_t& PairNeighbors::take_slot(std::uint32_t object) {
    if (object < kFirstRegionIndex) {
        if (object >= slot_of_.size()) resize(slot_of_, object + std::size_t{1}, kNoIndex);
        return slot_of_[object];
    }
    auto at = std::lower_bound(region_slots_.begin(), region_slots_.end(), object, is_slot_before);
    if (at == region_slots_.end() || at->object != object) at = region_slots_.insert(at, {object, kNoIndex});
    return at->slot;
}

void PairNeighbors::give_back_slot(std::uint32_t object) {
    if (object < kFirstRegionIndex)
        slot_of_[object] = kNoIndex;
    else
        region_slots_.erase(std::lower_bound(region_slots_.begin(), region_slots_.end(), object, is_slot_before));
}

void PairNeighbors::add(const Pair& pair) {
    const auto insert = [&](std::uint32_t object, std::uint32_t partner) {
        std::uint32_t& slot = take_slot(object);
        if (slot == kNoIndex) {
            if (free_.empty()) {
                free_.push_back(static_cast<std::uint32_t>(slots_.size()));
                slots_.emplace_back();
            }
            slot = free_.back();
            free_.pop_back();
        }
        Vector<std::uint32_t>& partners = slots_[slot].partners;
        partners.insert(std::lower_bound(partners.begin(), partners.end(), partner), partner);
        if (partners.size() == kCrowd + 1) crowds_.push_back(object);
    };
    insert(pair.first, pair.second);
    insert(pair.second, pair.first);
}

void PairNeighbors::remove(const Pair& pair) {
    const auto erase = [&](std::uint32_t object, std::uint32_t partner) {
        Vector<std::uint32_t>& partners = slots_[slot_of(object)].partners;
        partners.erase(std::lower_bound(partners.begin(), partners.end(), partner));
        if (partners.size() == kCrowd) crowds_.erase(std::find(crowds_.begin(), crowds_.end(), object));
        if (!partners.empty()) return;
        free_.push_back(slot_of(object));
        give_back_slot(object);
    };
    erase(pair.first, pair.second);
    erase(pair.second, pair.first);
}

void PairNeighbors::place(std::uint32_t object, const Obb& box, double margin,
                          const std::optional<RigidTransform>& pose) {
    Slot& slot = slots_[slot_of(object)];
    slot.pose = pose;
    slot.bounds = aabb_of(box);
    const glm::dvec3 size = slot.bounds.max - slot.bounds.min;
    const double wider = margin + kFlush * (size.x + size.y + size.z);
    slot.bounds.min -= wider;
    slot.bounds.max += wider;
}

void PairNeighbors::find_beside(std::uint32_t own, std::uint32_t other, Vector<std::uint32_t>& objects) const {
    objects.clear();
    const auto meeting = partners_of(other), own_meeting = partners_of(own);
    // Of what meets a much larger object, as a ground, only what is near takes part.
    const bool far_reaching = size_of(bounds_of(other)) > 4.0 * size_of(bounds_of(own));
    const bool crowd = meeting.size() > kCrowd && own_meeting.size() < meeting.size();
    for (const std::uint32_t object : crowd ? own_meeting : meeting) {
        if (object == own || object == other) continue;
        if (crowd && !std::binary_search(meeting.begin(), meeting.end(), object)) continue;
        if (!far_reaching || intersects(bounds_of(object), bounds_of(own))) objects.push_back(object);
    }
}

void PairNeighbors::find(const Pair& pair, Neighbors& neighbors) const {
    find_beside(pair.first, pair.second, neighbors.objects[0]);
    find_beside(pair.second, pair.first, neighbors.objects[1]);
    neighbors.name = 0;
    for (const Vector<std::uint32_t>& objects : neighbors.objects) {
        for (const std::uint32_t object : objects)
            neighbors.name = (neighbors.name ^ (object + std::uint64_t{1})) * 0x9e3779b97f4a7c15u + 1;
        neighbors.name = (neighbors.name ^ objects.size() << 32) * 0x9e3779b97f4a7c15u;
    }
}

}  // namespace crofton::world
