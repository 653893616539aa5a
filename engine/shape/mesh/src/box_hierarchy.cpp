// SPDX-License-Identifier: MIT
#include <crofton/mesh/box_hierarchy.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <glm/common.hpp>
#include <limits>
#include <numeric>
#include <utility>

#include "wide_box.hpp"

namespace crofton::mesh {
namespace {

constexpr std::size_t kWidth = kBoxNodeWidth;
constexpr std::size_t kBins = 16;
// From this depth on ranges are halved by number: 2^30 triangles then need no more than 30 further levels.
constexpr int kMaxUnevenDepth = 30;

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
        : leaf_size_(leaf_size), items_(boxes.size()), others_(boxes.size()), order_(boxes.size()) {
        std::iota(order_.begin(), order_.end(), 0u);
        other_order_.resize(boxes.size());
        for (std::size_t i = 0; i < boxes.size(); ++i)
            for (int k = 0; k < 3; ++k) items_[i].low[k] = boxes[i].low[k], items_[i].high[k] = boxes[i].high[k];
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
    static FloatBox narrow(const WideBox& box) {
        return {{box.low[0], box.low[1], box.low[2]}, {box.high[0], box.high[1], box.high[2]}};
    }

    BoxRange range_of(std::uint32_t begin, std::uint32_t end, int depth) const {
        BoxRange range;
        range.begin = begin, range.end = end, range.depth = depth;
        for (std::uint32_t i = begin; i < end; ++i) {
            const WideBox item = items_[i];
            const detail::Lanes4 middle = item.middle();
            range.box.include(item);
            range.middles.include(middle, middle);
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

    // Within a range items ascend, before and after: so the tree does not depend on how a library sorts. Boxes move
    // with their items: what is split further lies side by side.
    void split(const BoxRange& range, BoxRange& left, BoxRange& right) {
        std::uint32_t cut = range.begin;
        Plane plane;
        if (range.depth < kMaxUnevenDepth && best_plane(range, plane))
            cut = part(range, [&](std::uint32_t i) { return items_[i].middle()[plane.axis] < plane.at; });
        if (cut == range.begin || cut == range.end) cut = part_by_number(range);
        left = range_of(range.begin, cut, range.depth + 1);
        right = range_of(cut, range.end, range.depth + 1);
    }

    // Those that are left first; returns where the others begin.
    template <class IsLeft>
    std::uint32_t part(const BoxRange& range, const IsLeft& is_left) {
        std::uint32_t cut = range.begin, others = 0;
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
            const bool to_left = is_left(i);
            const WideBox item = items_[i];
            const std::uint32_t t = order_[i];
            items_[cut] = others_[others] = item;
            order_[cut] = other_order_[others] = t;
            cut += to_left;
            others += !to_left;
        }
        std::copy_n(others_.begin(), others, items_.begin() + cut);
        std::copy_n(other_order_.begin(), others, order_.begin() + cut);
        return cut;
    }

    // Halves along the longest side.
    std::uint32_t part_by_number(const BoxRange& range) {
        const FloatBox box = narrow(range.box);
        const glm::vec3 d = box.high - box.low;
        const int axis = d.x >= d.y && d.x >= d.z ? 0 : (d.y >= d.z ? 1 : 2);
        Vector<std::uint32_t> ranked(range.size());
        std::iota(ranked.begin(), ranked.end(), range.begin);
        const auto half = ranked.begin() + range.size() / 2;
        std::nth_element(ranked.begin(), half, ranked.end(), [&](std::uint32_t a, std::uint32_t b) {
            const float x = items_[a].middle()[axis], y = items_[b].middle()[axis];
            return x != y ? x < y : a < b;
        });
        Vector<std::uint8_t> is_left(range.size(), 0);
        for (auto i = ranked.begin(); i != half; ++i) is_left[*i - range.begin] = 1;
        return part(range, [&](std::uint32_t i) { return is_left[i - range.begin] != 0; });
    }

    struct Bins {
        std::array<WideBox, kBins> boxes;
        std::array<std::uint32_t, kBins> counts;
        std::uint32_t used;  // bits of those with items

        void clear() {
            for (WideBox& box : boxes) box = WideBox();
            for (std::uint32_t& count : counts) count = 0;
            used = 0;
        }
        void add(std::int32_t bin, const WideBox& item) {
            boxes[static_cast<std::size_t>(bin)].include(item);
            ++counts[static_cast<std::size_t>(bin)];
        }
        void add(const Bins& other) {
            for (std::size_t b = 0; b < kBins; ++b) {
                boxes[b].include(other.boxes[b]);
                counts[b] += other.counts[b];
            }
        }
        void find_used() {
            used = 0;
            for (std::size_t b = 0; b < kBins; ++b) used |= (counts[b] != 0 ? 1u : 0u) << b;
        }
    };

    // The bin border of least Σ area · count; false where all middles coincide.
    bool best_plane(const BoxRange& range, Plane& plane) {
        detail::Lanes4 scale = detail::all_lanes(0.0f);
        for (int axis = 0; axis < 3; ++axis) {
            const float width = range.middles.high[axis] - range.middles.low[axis];
            scale[axis] = width > 0.0f ? static_cast<float>(kBins) / width : 0.0f;
        }
        fill_bins(range, scale);
        double best = std::numeric_limits<double>::infinity();
        for (int axis = 0; axis < 3; ++axis) {
            if (scale[axis] == 0.0f) continue;
            const std::size_t border = best_border(bins_[static_cast<std::size_t>(axis)], best);
            if (border == 0) continue;
            plane = {axis, range.middles.low[axis] + static_cast<float>(border) / scale[axis]};
        }
        return best < std::numeric_limits<double>::infinity();
    }

    void fill_bins(const BoxRange& range, const detail::Lanes4& scale) {
        const bool many = range.size() > kManyItems;
        for (std::size_t i = 0; i < (many ? 6u : 3u); ++i) bins_[i].clear();
        const detail::Lanes4 low = range.middles.low, zero = detail::all_lanes(0.0f);
        const detail::Lanes4 last = detail::all_lanes(static_cast<float>(kBins - 1));
        const auto add = [&](std::uint32_t i, Bins* bins) {
            const WideBox item = items_[i];
            // The scale of a width near the smallest float is infinite: bounded before it becomes an integer.
            const detail::Lanes4 bin = detail::lesser(detail::larger((item.middle() - low) * scale, zero), last);
            for (int axis = 0; axis < 3; ++axis) bins[axis].add(static_cast<std::int32_t>(bin[axis]), item);
        };
        std::uint32_t i = range.begin;
        for (; many && i + 1 < range.end; i += 2) {
            add(i, bins_.data());
            add(i + 1, bins_.data() + 3);
        }
        for (; i < range.end; ++i) add(i, bins_.data());
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (many) bins_[axis].add(bins_[axis + 3]);
            bins_[axis].find_used();
        }
    }

    // The first bin behind the best border, 0 where none is better than `best`. Borders in front of an empty bin are as
    // good as the one behind it.
    static std::size_t best_border(const Bins& bins, double& best) {
        std::array<double, kBins> right_cost;
        WideBox right, left;
        std::uint32_t right_count = 0, left_count = 0;
        for (std::uint32_t rest = bins.used; rest != 0;) {
            const auto b = static_cast<std::size_t>(std::bit_width(rest)) - 1;
            rest ^= 1u << b;
            right.include(bins.boxes[b]);
            right_cost[b] = half_area(right) * (right_count += bins.counts[b]);
        }
        std::size_t border = 0;
        for (std::uint32_t rest = bins.used; (rest & (rest - 1)) != 0;) {
            const auto b = static_cast<std::size_t>(std::countr_zero(rest));
            rest &= rest - 1;
            left.include(bins.boxes[b]);
            left_count += bins.counts[b];
            const double cost =
                half_area(left) * left_count + right_cost[static_cast<std::size_t>(std::countr_zero(rest))];
            if (cost < best) best = cost, border = b + 1;
        }
        return border;
    }

    std::uint32_t leaf_size_;
    Vector<WideBox> items_, others_;  // their boxes, in order
    Vector<std::uint32_t> order_, other_order_;
    // By axis, twice: of many items the odd ones go to the second three. An item waits for the one before it in its
    // bin.
    static constexpr std::uint32_t kManyItems = 128;
    std::array<Bins, 6> bins_;
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
