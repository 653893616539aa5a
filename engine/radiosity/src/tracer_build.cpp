// SPDX-License-Identifier: MIT
// Surface-area splits in sixteen bins: for uniform lines the chance to meet a box inside another is the ratio of their
// surface areas (theory.md section 2), exactly, so this is the one criterion that fits.
#include "tracer_build.hpp"

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <limits>
#include <numeric>

namespace crofton::radiosity::detail {
namespace {

constexpr std::size_t kBins = 16;
// From this depth on ranges are halved by number: 2^30 triangles then need no more than 30 further levels.
constexpr int kMaxUnevenDepth = 30;

struct Box {
    glm::vec3 low{std::numeric_limits<float>::infinity()}, high{-std::numeric_limits<float>::infinity()};
    void include(const glm::vec3& p) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    void include(const Box& b) {
        low = glm::min(low, b.low);
        high = glm::max(high, b.high);
    }
    [[nodiscard]] double half_area() const {
        const glm::dvec3 d = glm::dvec3(high) - glm::dvec3(low);
        return d.x >= 0.0 ? d.x * d.y + d.y * d.z + d.z * d.x : 0.0;
    }
};

struct Range {
    std::uint32_t begin = 0, end = 0;
    int depth = 0;
    Box box;
    [[nodiscard]] std::uint32_t size() const { return end - begin; }
};

class Builder {
  public:
    Builder(const TriangleMesh& mesh, const glm::dvec3& origin)
        : mesh_(mesh), order_(mesh.triangle_count()), boxes_(order_.size()) {
        std::iota(order_.begin(), order_.end(), 0u);
        points_.reserve(mesh.positions.size());
        for (const glm::vec3& p : mesh.positions) points_.emplace_back(glm::dvec3(p) - origin);
        for (std::size_t t = 0; t < boxes_.size(); ++t)
            for (std::size_t k = 0; k < 3; ++k) boxes_[t].include(points_[mesh.indices[3 * t + k]]);
    }

    void build(Vector<TracerNode>& nodes, Vector<TracerLeaf>& leaves) {
        struct Todo {
            Range range;
            std::uint32_t node;
        };
        Vector<Todo> stack;
        nodes.assign(1, {});
        stack.push_back({whole(), 0});
        while (!stack.empty()) {
            const Todo todo = stack.back();
            stack.pop_back();
            std::array<Range, kLanes> parts;
            const std::size_t count = split_into_eight(todo.range, parts);
            for (std::size_t lane = 0; lane < kLanes; ++lane) {
                std::uint32_t child = 0;
                if (lane < count && parts[lane].size() <= kLanes) {
                    child = static_cast<std::uint32_t>(leaves.size()) | kLeaf;
                    leaves.push_back(leaf_of(parts[lane]));
                } else if (lane < count) {
                    child = static_cast<std::uint32_t>(nodes.size());
                    nodes.push_back({});
                    stack.push_back({parts[lane], child});
                }
                TracerNode& node = nodes[todo.node];
                node.count = static_cast<std::uint32_t>(count);
                node.child[lane] = child;
                const Box box = lane < count ? parts[lane].box : Box{};
                for (int k = 0; k < 3; ++k) {
                    node.low[k][lane] = lane < count ? box.low[k] : 1.0f;
                    node.high[k][lane] = lane < count ? box.high[k] : -1.0f;
                }
            }
        }
    }

  private:
    [[nodiscard]] float middle(std::uint32_t t, int axis) const {
        return 0.5f * boxes_[t].low[axis] + 0.5f * boxes_[t].high[axis];
    }

    Range whole() const {
        Range range{0, static_cast<std::uint32_t>(order_.size()), 0, {}};
        for (const Box& box : boxes_) range.box.include(box);
        return range;
    }

    // Splits the part of most area that is still too large for a leaf, until there are eight.
    std::size_t split_into_eight(const Range& range, std::array<Range, kLanes>& parts) {
        parts[0] = range;
        std::size_t count = 1;
        while (count < kLanes) {
            std::size_t widest = kLanes;
            for (std::size_t i = 0; i < count; ++i)
                if (parts[i].size() > kLanes &&
                    (widest == kLanes || parts[i].box.half_area() > parts[widest].box.half_area()))
                    widest = i;
            if (widest == kLanes) break;
            const Range old = parts[widest];
            split(old, parts[widest], parts[count]);
            ++count;
        }
        return count;
    }

    void split(const Range& range, Range& left, Range& right) {
        std::uint32_t* const first = order_.data();
        std::uint32_t cut = range.begin + range.size() / 2;
        int axis = 0;
        float at = 0.0f;
        if (range.depth < kMaxUnevenDepth && best_plane(range, axis, at)) {
            const auto* end = std::partition(first + range.begin, first + range.end,
                                             [&](std::uint32_t t) { return middle(t, axis) < at; });
            cut = static_cast<std::uint32_t>(end - first);
        }
        if (cut == range.begin || cut == range.end || range.depth >= kMaxUnevenDepth) {
            cut = range.begin + range.size() / 2;
            const glm::vec3 d = range.box.high - range.box.low;
            axis = d.x >= d.y && d.x >= d.z ? 0 : (d.y >= d.z ? 1 : 2);
            std::nth_element(first + range.begin, first + cut, first + range.end,
                             [&](std::uint32_t a, std::uint32_t b) {
                                 const float x = middle(a, axis), y = middle(b, axis);
                                 return x != y ? x < y : a < b;
                             });
        }
        const auto make = [&](std::uint32_t begin, std::uint32_t end) {
            std::sort(first + begin, first + end);  // the same tree whatever the library's partition does
            Range part{begin, end, range.depth + 1, {}};
            for (std::uint32_t i = begin; i < end; ++i) part.box.include(boxes_[order_[i]]);
            return part;
        };
        left = make(range.begin, cut);
        right = make(cut, range.end);
    }

    // The bin border of least Σ area · count; false where all middles coincide.
    bool best_plane(const Range& range, int& best_axis, float& best_at) const {
        Box middles;
        for (std::uint32_t i = range.begin; i < range.end; ++i)
            middles.include(glm::vec3(middle(order_[i], 0), middle(order_[i], 1), middle(order_[i], 2)));
        double best = std::numeric_limits<double>::infinity();
        for (int axis = 0; axis < 3; ++axis) {
            const float low = middles.low[axis], width = middles.high[axis] - low;
            if (!(width > 0.0f)) continue;
            std::array<Box, kBins> boxes;
            std::array<std::uint32_t, kBins> counts{};
            const float scale = static_cast<float>(kBins) / width;
            for (std::uint32_t i = range.begin; i < range.end; ++i) {
                const std::uint32_t t = order_[i];
                const std::size_t bin =
                    std::min(kBins - 1, static_cast<std::size_t>(std::max(0.0f, (middle(t, axis) - low) * scale)));
                boxes[bin].include(boxes_[t]);
                ++counts[bin];
            }
            std::array<double, kBins> right_cost{};
            Box right;
            std::uint32_t right_count = 0;
            for (std::size_t b = kBins - 1; b > 0; --b) {
                right.include(boxes[b]);
                right_cost[b] = right.half_area() * (right_count += counts[b]);
            }
            Box left;
            std::uint32_t left_count = 0;
            for (std::size_t b = 1; b < kBins; ++b) {
                left.include(boxes[b - 1]);
                left_count += counts[b - 1];
                if (left_count == 0 || left_count == range.size()) continue;
                const double cost = left.half_area() * left_count + right_cost[b];
                if (cost < best) {
                    best = cost;
                    best_axis = axis;
                    best_at = low + static_cast<float>(b) / scale;
                }
            }
        }
        return best < std::numeric_limits<double>::infinity();
    }

    TracerLeaf leaf_of(const Range& range) const {
        TracerLeaf leaf{};
        leaf.count = range.size();
        for (std::uint32_t lane = 0; lane < range.size(); ++lane) {
            const std::uint32_t t = order_[range.begin + lane];
            const glm::vec3 &a = points_[mesh_.indices[3 * t]], &b = points_[mesh_.indices[3 * t + 1]],
                            &c = points_[mesh_.indices[3 * t + 2]];
            leaf.triangle[lane] = t;
            for (int k = 0; k < 3; ++k) {
                leaf.corner[k][lane] = a[k];
                leaf.first[k][lane] = b[k] - a[k];
                leaf.second[k][lane] = c[k] - a[k];
            }
        }
        return leaf;
    }

    const TriangleMesh& mesh_;
    Vector<std::uint32_t> order_;
    Vector<Box> boxes_;  // by triangle
    Vector<glm::vec3> points_;
};

}  // namespace

void build_tracer(const TriangleMesh& mesh, const glm::dvec3& origin, Vector<TracerNode>& nodes,
                  Vector<TracerLeaf>& leaves) {
    Builder(mesh, origin).build(nodes, leaves);
}

}  // namespace crofton::radiosity::detail
