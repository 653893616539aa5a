// SPDX-License-Identifier: MIT
#include "manifold_list.hpp"

#include <algorithm>
#include <glm/geometric.hpp>

namespace crofton::convex {
namespace {

constexpr double kSameNormal = 0.9962;  // 5 degrees

}  // namespace

void ManifoldList::clear() {
    directions_.clear();
    points_.clear();
    direction_of_.clear();
}

void ManifoldList::add(const glm::dvec3& normal, std::span<const ContactPoint> points) {
    if (points.empty()) return;
    double depth = points[0].depth;
    for (const ContactPoint& p : points) depth = std::max(depth, p.depth);
    std::size_t at = 0;
    while (at < directions_.size() && glm::dot(directions_[at].normal, normal) < kSameNormal) ++at;
    if (at == directions_.size()) directions_.push_back({normal, depth, 0});
    Direction& direction = directions_[at];
    if (depth > direction.depth) {
        direction.normal = normal;
        direction.depth = depth;
    }
    direction.count += static_cast<std::uint32_t>(points.size());
    for (const ContactPoint& p : points) {
        points_.push_back(p);
        direction_of_.push_back(static_cast<std::uint32_t>(at));
    }
}

void ManifoldList::finish(int most, Vector<Manifold>& manifolds) {
    manifolds.resize(directions_.size());
    first_.clear();
    std::uint32_t sum = 0;
    for (const Direction& direction : directions_) {
        first_.push_back(sum);
        sum += direction.count;
    }
    const bool one = directions_.size() == 1;  // sorted already
    sorted_.resize(one ? 0 : points_.size());
    for (std::size_t i = 0; !one && i < points_.size(); ++i) sorted_[first_[direction_of_[i]]++] = points_[i];
    std::uint32_t begin = 0;
    for (std::size_t k = 0; k < directions_.size(); ++k) {
        manifolds[k].normal = directions_[k].normal;
        thin_out(manifolds[k], (one ? points_ : sorted_).data() + begin, static_cast<int>(directions_[k].count), most);
        begin += directions_[k].count;
    }
}

}  // namespace crofton::convex
