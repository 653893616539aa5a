// SPDX-License-Identifier: MIT
// Carries the memory of last step's contact points over to this step's.
#include <algorithm>
#include <crofton/convex/query.hpp>

#include "features.hpp"

namespace crofton::convex {

std::size_t track(std::span<const Manifold> manifolds, Vector<TrackedPoint>& points) {
    const std::size_t before = points.size();
    std::size_t kept = 0;  // old points that have stayed come first
    for (const Manifold& manifold : manifolds)
        for (int i = 0; i < manifold.count; ++i) {
            TrackedPoint& now = points.emplace_back();
            now.contact = manifold.points[i];
            now.normal = manifold.normal;
            std::size_t old = kept;
            while (old < before && !has_same_id(points[old].contact, now.contact)) ++old;
            if (old == before) continue;
            now.began = false;
            std::copy_n(points[old].memory, 4, now.memory);
            if (old != kept) std::swap(points[old], points[kept]);
            ++kept;
        }
    points.erase(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(before));
    return before - kept;
}

}  // namespace crofton::convex
