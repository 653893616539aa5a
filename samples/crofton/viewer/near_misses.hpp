// SPDX-License-Identifier: MIT
// Separating planes of shapes that nearly touch, in world coordinates.
#pragma once
#include <crofton/geometry/box.hpp>
#include <crofton/scene/scene.hpp>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace crofton::viewer {

struct Segment {
    glm::dvec3 begin{0.0}, end{0.0};
};

// The gap between two boxes along the axis by which the separating-axis test tells them apart, as a segment midway
// between their centres from a's side to b's. Absent where they meet.
[[nodiscard]] std::optional<Segment> separation(const Obb& a, const Obb& b);

// Pairs among `instances` whose boxes are disjoint, but nearer than the smaller one's size: at most `limit`.
[[nodiscard]] std::vector<std::pair<scene::InstanceId, scene::InstanceId>> near_pairs(
    std::span<const Obb> boxes, std::span<const scene::InstanceId> instances, std::size_t limit);

}  // namespace crofton::viewer
