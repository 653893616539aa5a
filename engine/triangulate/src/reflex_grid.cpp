#include "reflex_grid.hpp"

#include <algorithm>
#include <cmath>

namespace crofton::triangulate {
namespace {
// So few vertices are asked one by one.
constexpr std::size_t kFew = 12;
}  // namespace

void ReflexGrid::build(std::span<const glm::dvec2> points, std::span<const Index> vertices) {
    points_ = points;
    members_.assign(vertices.begin(), vertices.end());
    fill();
}

void ReflexGrid::fill() {
    left_ = members_.size();
    vertices_.assign(left_, kNone);
    positions_.resize(left_);
    if (left_ == 0) return;
    if (left_ <= kFew) {
        columns_ = rows_ = 1;
        per_unit_ = {0.0, 0.0};
        begin_.assign({0, static_cast<Index>(left_)});
        for (std::size_t i = 0; i < left_; ++i) {
            vertices_[i] = members_[i];
            positions_[i] = points_[members_[i]];
        }
        return;
    }
    glm::dvec2 low = points_[members_[0]], high = low;
    for (const Index v : members_) {
        const auto& p = points_[v];
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    low_ = low;
    const glm::dvec2 size = high - low;
    // Square cells where that gives about as many as there are vertices.
    const auto count = static_cast<double>(left_);
    const double side = std::max({std::sqrt(size.x * size.y / count), size.x / count, size.y / count});
    const auto along = [&](double extent) {
        return side > 0.0 ? static_cast<Index>(std::clamp(extent / side, 1.0, count)) : Index{1};
    };
    columns_ = along(size.x);
    rows_ = along(size.y);
    per_unit_ = {size.x > 0.0 ? columns_ / size.x : 0.0, size.y > 0.0 ? rows_ / size.y : 0.0};
    begin_.assign(std::size_t{columns_} * rows_ + 1, 0);
    for (const Index v : members_) ++begin_[cell_of(v)];
    for (std::size_t c = 1; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
    for (const Index v : members_) {
        const Index at = --begin_[cell_of(v)];
        vertices_[at] = v;
        positions_[at] = points_[v];
    }
}

void ReflexGrid::remove(Index vertex) {
    if (vertices_.empty()) return;
    const Index cell = cell_of(vertex);
    for (Index i = begin_[cell]; i < begin_[cell + 1]; ++i) {
        if (vertices_[i] != vertex) continue;
        vertices_[i] = kNone;
        --left_;
        break;
    }
    if (2 * left_ >= vertices_.size()) return;
    members_.clear();
    for (const Index v : vertices_) {
        if (v != kNone) members_.push_back(v);
    }
    fill();
}

}  // namespace crofton::triangulate
