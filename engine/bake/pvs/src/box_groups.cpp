// SPDX-License-Identifier: MIT
#include "box_groups.hpp"

#include <algorithm>
#include <numeric>

namespace crofton::pvs {

BoxGroups::BoxGroups(std::span<const Aabb> boxes) {
    if (boxes.empty()) return;
    items_.resize(boxes.size());
    std::iota(items_.begin(), items_.end(), 0u);
    groups_.reserve(2 * boxes.size());
    groups_.push_back({{}, 0, static_cast<std::uint32_t>(boxes.size()), 0});
    for (std::uint32_t g = 0; g < groups_.size(); ++g) {
        Group group = groups_[g];
        Aabb centers;
        const auto begin = items_.begin() + group.first, end = begin + group.count;
        for (auto i = begin; i != end; ++i) {
            group.box.include(boxes[*i]);
            centers.include(boxes[*i].center());
        }
        if (group.count > 1) {
            const glm::dvec3 e = centers.max - centers.min;
            const int k = e.x >= e.y ? (e.x >= e.z ? 0 : 2) : (e.y >= e.z ? 1 : 2);
            const auto middle = begin + group.count / 2;
            std::nth_element(begin, middle, end, [&](std::uint32_t a, std::uint32_t b) {
                const double x = boxes[a].center()[k], y = boxes[b].center()[k];
                return x != y ? x < y : a < b;
            });
            group.child = static_cast<std::uint32_t>(groups_.size());
            groups_.push_back({{}, group.first, group.count / 2, 0});
            groups_.push_back({{}, group.first + group.count / 2, group.count - group.count / 2, 0});
        }
        groups_[g] = group;
    }
}

}  // namespace crofton::pvs
