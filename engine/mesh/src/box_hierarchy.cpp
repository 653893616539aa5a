// SPDX-License-Identifier: MIT
#include <crofton/mesh/box_hierarchy.hpp>

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <limits>
#include <numeric>
#include <utility>

namespace crofton::mesh {
namespace {

constexpr std::size_t kWidth = kBoxNodeWidth;
constexpr std::size_t kBins = 16;
// From this depth on ranges are halved by number: 2^30 triangles then need no more than 30 further levels.
constexpr int kMaxUnevenDepth = 30;

double half_area(const FloatBox& box) {
    const glm::dvec3 d = glm::dvec3(box.high) - glm::dvec3(box.low);
    return d.x >= 0.0 ? d.x * d.y + d.y * d.z + d.z * d.x : 0.0;
}

struct BoxRange {
    std::uint32_t begin = 0, end = 0;
    int depth = 0;
    FloatBox box;
    [[nodiscard]] std::uint32_t size() const { return end - begin; }
};

class Builder {
  public:
    Builder(std::span<const FloatBox> boxes, std::uint32_t leaf_size)
        : boxes_(boxes), leaf_size_(leaf_size), order_(boxes.size()) {
        std::iota(order_.begin(), order_.end(), 0u);
    }

    BoxHierarchy build() {
        struct Todo {
            BoxRange range;
            std::uint32_t node;
        };
        BoxHierarchy result;
        Vector<Todo> stack;
        result.nodes.assign(1, {});
        stack.push_back({whole(), 0});
        while (!stack.empty()) {
            const Todo todo = stack.back();
            stack.pop_back();
            std::array<BoxRange, kWidth> parts;
            const std::size_t count = split_into_eight(todo.range, parts);
            BoxNode node{};
            node.count = static_cast<std::uint32_t>(count);
            for (std::uint32_t lane = 0; lane < kWidth; ++lane)
                set_bounds(node, lane, lane < count ? parts[lane].box : FloatBox{});
            for (std::size_t lane = 0; lane < count; ++lane) {
                if (parts[lane].size() <= leaf_size_) {
                    node.child[lane] = static_cast<std::uint32_t>(result.leaves.size()) | kMeshLeaf;
                    result.leaves.push_back({parts[lane].begin, parts[lane].end});
                } else {
                    node.child[lane] = static_cast<std::uint32_t>(result.nodes.size());
                    result.nodes.push_back({});
                    stack.push_back({parts[lane], node.child[lane]});
                }
            }
            result.nodes[todo.node] = node;
        }
        result.order = std::move(order_);
        return result;
    }

  private:
    [[nodiscard]] float middle(std::uint32_t t, int axis) const {
        return 0.5f * boxes_[t].low[axis] + 0.5f * boxes_[t].high[axis];
    }

    BoxRange whole() const {
        BoxRange range{0, static_cast<std::uint32_t>(order_.size()), 0, {}};
        for (const FloatBox& box : boxes_) range.box.include(box);
        return range;
    }

    // Splits the part of most area that is still too large for a leaf, until there are eight.
    std::size_t split_into_eight(const BoxRange& range, std::array<BoxRange, kWidth>& parts) {
        parts[0] = range;
        std::size_t count = 1;
        while (count < kWidth) {
            std::size_t widest = kWidth;
            for (std::size_t i = 0; i < count; ++i)
                if (parts[i].size() > leaf_size_ &&
                    (widest == kWidth || half_area(parts[i].box) > half_area(parts[widest].box)))
                    widest = i;
            if (widest == kWidth) break;
            const BoxRange old = parts[widest];
            split(old, parts[widest], parts[count]);
            ++count;
        }
        return count;
    }

    void split(const BoxRange& range, BoxRange& left, BoxRange& right) {
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
            BoxRange part{begin, end, range.depth + 1, {}};
            for (std::uint32_t i = begin; i < end; ++i) part.box.include(boxes_[order_[i]]);
            return part;
        };
        left = make(range.begin, cut);
        right = make(cut, range.end);
    }

    // The bin border of least Σ area · count; false where all middles coincide.
    bool best_plane(const BoxRange& range, int& best_axis, float& best_at) const {
        FloatBox middles;
        for (std::uint32_t i = range.begin; i < range.end; ++i)
            middles.include(glm::vec3(middle(order_[i], 0), middle(order_[i], 1), middle(order_[i], 2)));
        double best = std::numeric_limits<double>::infinity();
        for (int axis = 0; axis < 3; ++axis) {
            const float low = middles.low[axis], width = middles.high[axis] - low;
            if (!(width > 0.0f)) continue;
            std::array<FloatBox, kBins> boxes;
            std::array<std::uint32_t, kBins> counts{};
            const float scale = static_cast<float>(kBins) / width;
            for (std::uint32_t i = range.begin; i < range.end; ++i) {
                const std::uint32_t t = order_[i];
                // The scale of a width near the smallest float is infinite: bounded before it becomes an integer.
                const float place = std::max(0.0f, (middle(t, axis) - low) * scale);
                const auto bin = static_cast<std::size_t>(std::min(static_cast<float>(kBins - 1), place));
                boxes[bin].include(boxes_[t]);
                ++counts[bin];
            }
            std::array<double, kBins> right_cost{};
            FloatBox right;
            std::uint32_t right_count = 0;
            for (std::size_t b = kBins - 1; b > 0; --b) {
                right.include(boxes[b]);
                right_cost[b] = half_area(right) * (right_count += counts[b]);
            }
            FloatBox left;
            std::uint32_t left_count = 0;
            for (std::size_t b = 1; b < kBins; ++b) {
                left.include(boxes[b - 1]);
                left_count += counts[b - 1];
                if (left_count == 0 || left_count == range.size()) continue;
                const double cost = half_area(left) * left_count + right_cost[b];
                if (cost < best) {
                    best = cost;
                    best_axis = axis;
                    best_at = low + static_cast<float>(b) / scale;
                }
            }
        }
        return best < std::numeric_limits<double>::infinity();
    }

    std::span<const FloatBox> boxes_;
    std::uint32_t leaf_size_;
    Vector<std::uint32_t> order_;
};

}  // namespace

void FloatBox::include(const glm::vec3& point) {
    low = glm::min(low, point);
    high = glm::max(high, point);
}

void FloatBox::include(const FloatBox& box) {
    low = glm::min(low, box.low);
    high = glm::max(high, box.high);
}

void set_bounds(BoxNode& node, std::uint32_t lane, const FloatBox& box) {
    for (int i = 0; i < 3; ++i) {
        node.bounds[i][lane] = box.low[i];
        node.bounds[i + 3][lane] = box.high[i];
    }
}

BoxHierarchy build_box_hierarchy(std::span<const FloatBox> boxes, std::uint32_t leaf_size) {
    return Builder(boxes, leaf_size).build();
}

}  // namespace crofton::mesh
