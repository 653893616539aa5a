// SPDX-License-Identifier: MIT
#include "ear/reflex_tree.hpp"

#include <algorithm>
#include <cmath>

namespace crofton::triangulate {
namespace {
constexpr Index kLeafSize = 8;
// So few are looked through one by one.
constexpr std::size_t kFewVertices = 24;
}  // namespace

void ReflexTree::build(std::span<const glm::dvec2> points, std::span<const Index> vertices) {
    points_ = points;
    leaf_size_ = vertices.size() <= kFewVertices ? kFewVertices : kLeafSize;
    nodes_.clear();
    vertices_.assign(vertices.begin(), vertices.end());
    positions_.resize(vertices_.size());
    if (place_.size() < points.size()) {
        place_.resize(points.size());
        leaf_.resize(points.size());
    }
    if (!vertices_.empty()) split(0, static_cast<Index>(vertices_.size()), kNone);
}

// Halves along the longer side, but first along the shorter one: of a straight band that parts its two sides.
void ReflexTree::split(Index begin, Index end, Index parent) {
    const auto node = static_cast<Index>(nodes_.size());
    nodes_.push_back({{}, begin, end, kNone, parent, end - begin});
    for (Index i = begin; i < end; ++i) positions_[i] = points_[vertices_[i]];
    const Box box = box_of(std::span(positions_).subspan(begin, end - begin));
    nodes_[node].box = box;
    if (end - begin <= leaf_size_) {
        for (Index i = begin; i < end; ++i) {
            place_[vertices_[i]] = i;
            leaf_[vertices_[i]] = node;
        }
        return;
    }
    const bool taller = box.high.y - box.low.y > box.high.x - box.low.x;
    const bool along_y = parent == kNone ? !taller : taller;
    const Index middle = begin + (end - begin) / 2;
    const auto less = [&](Index a, Index b) {
        const double at_a = along_y ? points_[a].y : points_[a].x, at_b = along_y ? points_[b].y : points_[b].x;
        return at_a != at_b ? at_a < at_b : a < b;
    };
    std::nth_element(vertices_.begin() + begin, vertices_.begin() + middle, vertices_.begin() + end, less);
    split(begin, middle, node);
    nodes_[node].right = static_cast<Index>(nodes_.size());
    split(middle, end, node);
}

void ReflexTree::remove(Index vertex) {
    vertices_[place_[vertex]] = kNone;
    for (Index node = leaf_[vertex]; node != kNone; node = nodes_[node].parent) --nodes_[node].count;
}

ReflexTree::Box ReflexTree::box_of(std::span<const glm::dvec2> points) {
    Box box{points[0], points[0]};
    for (const glm::dvec2& p : points) {
        box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y)};
        box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y)};
    }
    return box;
}

// Whether the box lies strictly beyond one side, by more than rounding: each cross product errs by less than 8 units
// of 2^-53 of its two products.
bool ReflexTree::misses(const Box& box, const std::array<glm::dvec2, 3>& triangle) {
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec2 &a = triangle[k], &b = triangle[k == 2 ? 0 : k + 1];
        const double dx = b.x - a.x, dy = b.y - a.y;
        // The box's corner that is farthest to the left.
        const double up = dx * ((dx > 0.0 ? box.high.y : box.low.y) - a.y);
        const double across = dy * ((dy > 0.0 ? box.low.x : box.high.x) - a.x);
        if (up - across < -0x1p-50 * (std::fabs(up) + std::fabs(across))) return true;
    }
    return false;
}

}  // namespace crofton::triangulate
