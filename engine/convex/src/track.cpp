// SPDX-License-Identifier: MIT
#include <algorithm>
#include <crofton/convex/query.hpp>

namespace crofton::convex {
namespace {

bool same_id(const ContactPoint& a, const ContactPoint& b) {
    return a.on_a == b.on_a && a.on_b == b.on_b && a.part_a == b.part_a && a.part_b == b.part_b;
}

}  // namespace

std::size_t track(std::span<const Manifold> manifolds, Vector<TrackedPoint>& points) {
    const std::size_t before = points.size();
    std::size_t kept = 0;  // old points that have stayed come first
    for (const Manifold& manifold : manifolds)
        for (int i = 0; i < manifold.count; ++i) {
            TrackedPoint now;
            now.contact = manifold.points[i];
            now.normal = manifold.normal;
            for (std::size_t old = kept; old < before; ++old) {
                if (!same_id(points[old].contact, now.contact)) continue;
                now.began = false;
                std::copy_n(points[old].memory, 4, now.memory);
                std::swap(points[old], points[kept++]);
                break;
            }
            points.push_back(now);
        }
    points.erase(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(before));
    return before - kept;
}

}  // namespace crofton::convex
