// SPDX-License-Identifier: MIT
#include "pair_neighbors.hpp"

#include <algorithm>
#include <glm/geometric.hpp>

namespace crofton::world {
namespace {

// What meets more objects than these, as a ground does, asks only those that meet the other of the pair as well.
constexpr std::size_t kCrowd = 64;
constexpr double kFlush = 1e-6;  // of the size

}  // namespace

void PairNeighbors::list(std::size_t count, const SpatialIndex& index, double margin) {
    first_.assign(count + 1, 0);
    for (const Pair& pair : pairs_)
        for (const std::uint32_t object : {pair.first, pair.second}) ++first_[object + std::size_t{1}];
    bounds_.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        if (first_[i + std::size_t{1}] > 0) {
            Aabb& box = bounds_[i];
            box = aabb_of(index.box(i));
            const glm::dvec3 size = box.max - box.min;
            const double wider = margin + kFlush * (size.x + size.y + size.z);
            box.min -= wider;
            box.max += wider;
        }
        first_[i + std::size_t{1}] += first_[i];
    }
    next_.assign(first_.begin(), first_.end());
    partners_.resize(2 * pairs_.size());
    for (const Pair& pair : pairs_) partners_[next_[pair.second]++] = pair.first;
    for (const Pair& pair : pairs_) partners_[next_[pair.first]++] = pair.second;
}

void PairNeighbors::find_beside(std::uint32_t own, std::uint32_t other, Vector<std::uint32_t>& objects) const {
    objects.clear();
    const auto meeting = partners_of(other), own_meeting = partners_of(own);
    // Of what meets a much larger object, as a ground, only what is near takes part.
    const bool far_reaching =
        glm::distance(bounds_[other].min, bounds_[other].max) > 4.0 * glm::distance(bounds_[own].min, bounds_[own].max);
    const bool crowd = meeting.size() > kCrowd && own_meeting.size() < meeting.size();
    for (const std::uint32_t object : crowd ? own_meeting : meeting) {
        if (object == own || object == other) continue;
        if (crowd && !std::binary_search(meeting.begin(), meeting.end(), object)) continue;
        if (!far_reaching || intersects(bounds_[object], bounds_[own])) objects.push_back(object);
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
