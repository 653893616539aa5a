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

// A FloatBox with a fourth number, which is never read: four at a time are one instruction.
struct alignas(16) WideBox {
    static constexpr float kNone = std::numeric_limits<float>::infinity();
    float low[4] = {kNone, kNone, kNone, kNone}, high[4] = {-kNone, -kNone, -kNone, -kNone};

    void include(const float (&low_corner)[4], const float (&high_corner)[4]) {
        for (int k = 0; k < 4; ++k) {
            low[k] = low_corner[k] < low[k] ? low_corner[k] : low[k];
            high[k] = high[k] < high_corner[k] ? high_corner[k] : high[k];
        }
    }
    void include(const WideBox& box) { include(box.low, box.high); }
};

double half_area(const WideBox& box) {
    double d[3];
    for (int k = 0; k < 3; ++k) d[k] = static_cast<double>(box.high[k]) - static_cast<double>(box.low[k]);
    return d[0] >= 0.0 ? d[0] * d[1] + d[1] * d[2] + d[2] * d[0] : 0.0;
}

struct BoxRange {
    std::uint32_t begin = 0, end = 0;
    int depth = 0;
    WideBox box, middles;
    double area = 0.0;
    [[nodiscard]] std::uint32_t size() const { return end - begin; }
};

struct Plane {
    int axis = 0;
    float at = 0.0f;
};

class Builder {
  public:
    Builder(std::span<const FloatBox> boxes, std::uint32_t leaf_size)
        : leaf_size_(leaf_size),
          boxes_(boxes.size()),
          middles_(boxes.size()),
          order_(boxes.size()),
          right_(boxes.size()) {
        std::iota(order_.begin(), order_.end(), 0u);
        for (std::size_t i = 0; i < boxes.size(); ++i)
            for (int k = 0; k < 3; ++k) {
                boxes_[i].low[k] = boxes[i].low[k];
                boxes_[i].high[k] = boxes[i].high[k];
                middles_[i].at[k] = 0.5f * boxes[i].low[k] + 0.5f * boxes[i].high[k];
            }
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
                set_bounds(node, lane, lane < count ? narrow(parts[lane].box) : FloatBox{});
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
    struct alignas(16) Middle {
        float at[4] = {};
    };

    static FloatBox narrow(const WideBox& box) {
        return {{box.low[0], box.low[1], box.low[2]}, {box.high[0], box.high[1], box.high[2]}};
    }

    BoxRange range_of(std::uint32_t begin, std::uint32_t end, int depth) const {
        BoxRange range;
        range.begin = begin, range.end = end, range.depth = depth;
        for (std::uint32_t i = begin; i < end; ++i) {
            range.box.include(boxes_[order_[i]]);
            range.middles.include(middles_[order_[i]].at, middles_[order_[i]].at);
        }
        range.area = half_area(range.box);
        return range;
    }

    BoxRange whole() const { return range_of(0, static_cast<std::uint32_t>(order_.size()), 0); }

    // Splits the part of most area that is still too large for a leaf, until there are eight.
    std::size_t split_into_eight(const BoxRange& range, std::array<BoxRange, kWidth>& parts) {
        parts[0] = range;
        std::size_t count = 1;
        while (count < kWidth) {
            std::size_t widest = kWidth;
            for (std::size_t i = 0; i < count; ++i)
                if (parts[i].size() > leaf_size_ && (widest == kWidth || parts[i].area > parts[widest].area))
                    widest = i;
            if (widest == kWidth) break;
            const BoxRange old = parts[widest];
            split(old, parts[widest], parts[count]);
            ++count;
        }
        return count;
    }

    // Within a range items ascend, before and after: so the tree does not depend on how a library sorts.
    void split(const BoxRange& range, BoxRange& left, BoxRange& right) {
        std::uint32_t cut = range.begin;
        Plane plane;
        if (range.depth < kMaxUnevenDepth && best_plane(range, plane)) cut = part_by(range, plane);
        if (cut == range.begin || cut == range.end) cut = part_by_number(range);
        left = range_of(range.begin, cut, range.depth + 1);
        right = range_of(cut, range.end, range.depth + 1);
    }

    // Those below the plane first; returns where the others begin.
    std::uint32_t part_by(const BoxRange& range, const Plane& plane) {
        std::uint32_t cut = range.begin, others = 0;
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
            const std::uint32_t t = order_[i];
            const bool is_left = middles_[t].at[plane.axis] < plane.at;
            order_[cut] = t;
            right_[others] = t;
            cut += is_left;
            others += !is_left;
        }
        std::copy_n(right_.begin(), others, order_.begin() + cut);
        return cut;
    }

    // Halves along the longest side.
    std::uint32_t part_by_number(const BoxRange& range) {
        std::uint32_t* const first = order_.data();
        const std::uint32_t cut = range.begin + range.size() / 2;
        const FloatBox box = narrow(range.box);
        const glm::vec3 d = box.high - box.low;
        const int axis = d.x >= d.y && d.x >= d.z ? 0 : (d.y >= d.z ? 1 : 2);
        std::nth_element(first + range.begin, first + cut, first + range.end, [&](std::uint32_t a, std::uint32_t b) {
            const float x = middles_[a].at[axis], y = middles_[b].at[axis];
            return x != y ? x < y : a < b;
        });
        std::sort(first + range.begin, first + cut);
        std::sort(first + cut, first + range.end);
        return cut;
    }

    struct Bins {
        std::array<WideBox, kBins> boxes;
        std::array<std::uint32_t, kBins> counts{};
    };

    // The bin border of least Σ area · count; false where all middles coincide.
    bool best_plane(const BoxRange& range, Plane& plane) const {
        std::array<Bins, 3> bins;
        float scale[3];
        for (int axis = 0; axis < 3; ++axis) {
            const float width = range.middles.high[axis] - range.middles.low[axis];
            scale[axis] = width > 0.0f ? static_cast<float>(kBins) / width : 0.0f;
        }
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
            const std::uint32_t t = order_[i];
            for (std::size_t axis = 0; axis < 3; ++axis) {
                // The scale of a width near the smallest float is infinite: bounded before it becomes an integer.
                const float place = std::max(0.0f, (middles_[t].at[axis] - range.middles.low[axis]) * scale[axis]);
                const auto bin = static_cast<std::size_t>(std::min(static_cast<float>(kBins - 1), place));
                bins[axis].boxes[bin].include(boxes_[t]);
                ++bins[axis].counts[bin];
            }
        }
        double best = std::numeric_limits<double>::infinity();
        for (int axis = 0; axis < 3; ++axis) {
            if (scale[axis] == 0.0f) continue;
            const std::size_t border = best_border(bins[static_cast<std::size_t>(axis)], range.size(), best);
            if (border == 0) continue;
            plane = {axis, range.middles.low[axis] + static_cast<float>(border) / scale[axis]};
        }
        return best < std::numeric_limits<double>::infinity();
    }

    // The first bin behind the best border, 0 where none is better than `best`.
    static std::size_t best_border(const Bins& bins, std::uint32_t size, double& best) {
        std::array<double, kBins> right_cost{};
        WideBox right, left;
        std::uint32_t right_count = 0, left_count = 0;
        for (std::size_t b = kBins - 1; b > 0; --b) {
            right.include(bins.boxes[b]);
            right_cost[b] = half_area(right) * (right_count += bins.counts[b]);
        }
        std::size_t border = 0;
        for (std::size_t b = 1; b < kBins; ++b) {
            left.include(bins.boxes[b - 1]);
            left_count += bins.counts[b - 1];
            if (left_count == 0 || left_count == size) continue;
            const double cost = half_area(left) * left_count + right_cost[b];
            if (cost < best) best = cost, border = b;
        }
        return border;
    }

    std::uint32_t leaf_size_;
    Vector<WideBox> boxes_;
    Vector<Middle> middles_;
    Vector<std::uint32_t> order_, right_;
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
