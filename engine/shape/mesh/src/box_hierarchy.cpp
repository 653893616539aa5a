// SPDX-License-Identifier: MIT
#include <crofton/mesh/box_hierarchy.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <crofton/core/recovery.hpp>
#include <crofton/geometry/float_lanes.hpp>
#include <limits>
#include <span>
#include <utility>

namespace crofton::mesh {
namespace {

// A box as four floats at a time. The fourth ones are no part of it.
struct WideBox {
    detail::Lanes4 low = detail::all_lanes(std::numeric_limits<float>::infinity());
    detail::Lanes4 high = detail::all_lanes(-std::numeric_limits<float>::infinity());

    void include(const detail::Lanes4& low_corner, const detail::Lanes4& high_corner) {
        low = detail::lesser(low_corner, low);
        high = detail::larger(high_corner, high);
    }
    void include(const WideBox& box) { include(box.low, box.high); }
    [[nodiscard]] detail::Lanes4 middle() const {
        return detail::all_lanes(0.5f) * low + detail::all_lanes(0.5f) * high;
    }
    // The same bits, of one lane.
    [[nodiscard]] float middle(int axis) const { return 0.5f * low[axis] + 0.5f * high[axis]; }
};

// 0 of an empty box.
[[nodiscard]] double half_area(const WideBox& box) {
    double d[3];
    for (int k = 0; k < 3; ++k) d[k] = static_cast<double>(box.high[k]) - static_cast<double>(box.low[k]);
    return d[0] >= 0.0 ? d[0] * d[1] + d[1] * d[2] + d[2] * d[0] : 0.0;
}

// An item's number lies with its box, in the fourth float. With this bit it is no denormal number, which some
// processors multiply slowly.
constexpr std::uint32_t kItemBit = 0x40000000u;
[[nodiscard]] std::uint32_t number_of(const WideBox& item) {
    return std::bit_cast<std::uint32_t>(static_cast<float>(item.low[3])) & ~kItemBit;
}

constexpr std::size_t kWidth = kBoxNodeWidth;
constexpr std::size_t kBins = 16;
// From this depth on ranges are halved by number: 2^30 triangles then need no more than 30 further levels.
constexpr int kMaxUnevenDepth = 30;

struct BoxRange {
    std::uint32_t begin = 0, end = 0;
    int depth = 0;
    bool second = false;  // where its items are: in the second array
    WideBox box, middles;
    [[nodiscard]] std::uint32_t size() const { return end - begin; }
    void include(const WideBox& item) {
        const detail::Lanes4 middle = item.middle();
        box.include(item);
        middles.include(middle, middle);
    }
};

// The border of a bin. Asks as the bins do, and so agrees with their counts.
struct Plane {
    int axis = 0;
    float low = 0.0f, scale = 0.0f, border = 0.0f;
    std::uint32_t below = 0;  // items below it
    WideBox boxes[2];         // of those below and of the others
    double cost = 0.0;
    [[nodiscard]] float bin_of(const WideBox& item) const { return (item.middle(axis) - low) * scale; }
    [[nodiscard]] bool is_above(const WideBox& item) const { return bin_of(item) >= border; }
};

// A range of items. Its halves stand side by side, behind it.
struct BinaryNode {
    WideBox box;
    std::uint32_t begin = 0, end = 0;
    std::uint32_t halves = 0;  // 0: a leaf
};

// The least cost of a subtree that is handed to at most k lanes, k = 1 … 8, and how many of them its first half gets: 0
// where one lane fewer is as good.
struct LaneCosts {
    std::array<double, kWidth + 1> cost{};
    std::array<std::uint8_t, kWidth + 1> first{};
};

FloatBox narrow(const WideBox& box) {
    return {{box.low[0], box.low[1], box.low[2]}, {box.high[0], box.high[1], box.high[2]}};
}

// Items that are split: a range is in one of the arrays, and its halves in the other.
struct SplitItems {
    Vector<WideBox> boxes[2];
    Vector<std::uint32_t> order;
};

// Splits ranges of items. Ranges without common items may be split at once, by a Splitter each.
class Splitter {
  public:
    Splitter(SplitItems& items, std::uint32_t leaf_size, std::uint32_t granule)
        : leaf_size_(leaf_size), granule_(granule), items_(items) {}

    // Splits down to leaves. The range itself is the first of the nodes.
    Vector<BinaryNode> split_all(const BoxRange& all) {
        struct Todo {
            BoxRange range;
            std::uint32_t node;
        };
        Vector<BinaryNode> nodes;
        nodes.reserve(2 * (all.size() / std::max(granule_, (leaf_size_ + 1) / 2)) + 1);
        Vector<Todo> stack;
        const auto add = [&](const BoxRange& range) {
            const auto node = static_cast<std::uint32_t>(nodes.size());
            nodes.push_back({range.box, range.begin, range.end});
            if (range.size() > leaf_size_)
                stack.push_back({range, node});
            else
                for (std::uint32_t i = range.begin; i < range.end; ++i) items_.order[i] = number_of(items_of(range)[i]);
        };
        add(all);
        while (!stack.empty()) {
            const Todo todo = stack.back();
            stack.pop_back();
            nodes[todo.node].halves = static_cast<std::uint32_t>(nodes.size());
            BoxRange left, right;
            split(todo.range, left, right);
            add(left);
            add(right);
        }
        return nodes;
    }

    // Within a range items ascend, before and after: so the tree does not depend on how a library sorts.
    void split(const BoxRange& range, BoxRange& left, BoxRange& right) {
        left = right = BoxRange();
        left.begin = range.begin, right.end = range.end;
        left.depth = right.depth = range.depth + 1;
        Plane plane;
        if (range.depth >= kMaxUnevenDepth) {
            part_by_number(range, left, right);
        } else if (granule_ > 1 && range.size() <= kMostFew) {
            part_few(range, left, right);
        } else if (best_plane(range, plane)) {
            const std::uint32_t cut =
                range.size() > kMostAligned ? plane.below : whole_granules(range.size(), plane.below);
            if (cut == plane.below || cost_of_moving(range, plane, cut) > kDearer * plane.cost)
                part(range, plane.below, left, right,
                     [&](std::uint32_t, const WideBox& item) { return !plane.is_above(item); });
            else
                part_at(range, cut, left, right, plane.axis, near_.back().middle);
        } else {
            part_by_number(range, left, right);
        }
    }

  private:
    [[nodiscard]] const WideBox* items_of(const BoxRange& range) const {
        return items_.boxes[range.second ? 1 : 0].data();
    }

    // The multiple of the granule that is nearest to `below`, with something on either side of it.
    [[nodiscard]] std::uint32_t whole_granules(std::uint32_t size, std::uint32_t below) const {
        const std::uint32_t nearest = (below + granule_ / 2) / granule_;
        return std::clamp(nearest, 1u, (size - 1) / granule_) * granule_;
    }

    // An item's middle along an axis. No two are equal.
    struct Middle {
        float at;
        std::uint32_t item;
        friend bool operator<(const Middle& a, const Middle& b) {
            return a.at < b.at || (a.at == b.at && a.item < b.item);
        }
    };
    static Middle middle_of(const WideBox& item, int axis) { return {item.middle(axis), number_of(item)}; }
    struct PlacedMiddle {
        Middle middle;
        std::uint32_t place;
    };

    // What the split costs if not `plane.below` but `cut` items are to be below. Those that change sides are next to
    // the plane: `near_`. The last of these is the last item below the cut, in the order along the axis.
    double cost_of_moving(const BoxRange& range, const Plane& plane, std::uint32_t cut) {
        const bool up = cut > plane.below;
        near_.clear();
        const std::size_t count = up ? cut - plane.below : plane.below - cut + 1;
        const float farthest = farthest_bin(plane, up, count);
        const WideBox* const items = items_of(range);
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
            const float bin = plane.bin_of(items[i]);
            const bool too_far = up ? bin >= farthest + 1.0f : bin < farthest;
            if (((bin >= plane.border) != up) | too_far) continue;
            const PlacedMiddle middle{middle_of(items[i], plane.axis), i};
            const auto nearer = [up](const PlacedMiddle& a, const PlacedMiddle& b) {
                return up ? a.middle < b.middle : b.middle < a.middle;
            };
            if (near_.size() == count && !nearer(middle, near_.back())) continue;
            if (near_.size() == count) near_.pop_back();
            near_.insert(std::upper_bound(near_.begin(), near_.end(), middle, nearer), middle);
        }
        WideBox below = plane.boxes[0], above = plane.boxes[1];
        for (std::size_t i = 0; i < (up ? count : count - 1); ++i) (up ? below : above).include(items[near_[i].place]);
        return half_area(below) * granules(cut) + half_area(above) * granules(range.size() - cut);
    }

    // The bins from the plane to this one hold `count` items, or nothing lies beyond.
    [[nodiscard]] float farthest_bin(const Plane& plane, bool up, std::size_t count) const {
        const Bins& bins = bins_[static_cast<std::size_t>(plane.axis)];
        std::size_t bin = static_cast<std::size_t>(plane.border) - (up ? 0 : 1), found = bins.counts[bin];
        while (found < count && bin != (up ? kBins - 1 : 0)) found += bins.counts[up ? ++bin : --bin];
        // The outermost bins hold whatever lies beyond them: nothing is farther than NaN.
        const bool outermost = bin == 0 || bin == kBins - 1;
        return outermost ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(bin);
    }

    // Those that are left first: as many as lie below the cut. They go to the other array.
    template <class IsLeft>
    void part(const BoxRange& range, std::uint32_t cut, BoxRange& left, BoxRange& right, const IsLeft& is_left) {
        const WideBox* const from = items_of(range);
        WideBox* const to = items_.boxes[range.second ? 0 : 1].data();
        left.second = right.second = !range.second;
        left.end = right.begin = range.begin + cut;
        std::uint32_t next_left = range.begin, next_right = right.begin;
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
            const WideBox item = from[i];
            const std::uint32_t to_left = is_left(i, item) ? 1 : 0;
            to[to_left != 0 ? next_left : next_right] = item;
            next_left += to_left;
            next_right += 1 - to_left;
        }
        for (std::uint32_t i = left.begin; i < left.end; ++i) left.include(to[i]);
        for (std::uint32_t i = right.begin; i < right.end; ++i) right.include(to[i]);
    }

    void part_at(const BoxRange& range, std::uint32_t cut, BoxRange& left, BoxRange& right, int axis,
                 const Middle& last) {
        part(range, cut, left, right,
             [&](std::uint32_t, const WideBox& item) { return !(last < middle_of(item, axis)); });
    }

    // Halves along the longest side.
    void part_by_number(const BoxRange& range, BoxRange& left, BoxRange& right) {
        const FloatBox box = narrow(range.box);
        const glm::vec3 d = box.high - box.low;
        const int axis = d.x >= d.y && d.x >= d.z ? 0 : (d.y >= d.z ? 1 : 2);
        Vector<Middle> middles;
        middles.reserve(range.size());
        for (std::uint32_t i = range.begin; i < range.end; ++i) middles.push_back(middle_of(items_of(range)[i], axis));
        const std::uint32_t cut = whole_granules(range.size(), range.size() / 2);
        const auto last = middles.begin() + (cut - 1);
        std::nth_element(middles.begin(), last, middles.end());
        part_at(range, cut, left, right, axis, *last);
    }

    // A number that orders as `at` does to 18 bits of its fraction, and then as `place`: no two are equal.
    static std::int32_t rough_order(float at, std::uint32_t place) {
        constexpr std::int32_t kMagnitude = 0x7fffffff, kPlaces = kMostFew - 1;
        const auto bits = std::bit_cast<std::int32_t>(at);
        return ((bits < 0 ? bits ^ kMagnitude : bits) & ~kPlaces) | static_cast<std::int32_t>(place);
    }

    // How many of `count` numbers are less than each. Loops of fixed length become vectors.
    static void find_ranks(const std::int32_t* order, std::uint32_t count, std::int32_t* ranks) {
        std::fill(ranks, ranks + kMostFew, 0);
        for (std::uint32_t i = 0; i < count; ++i) {
            const std::int32_t here = order[i];
            if (count <= kMostFew / 2)
                for (std::uint32_t j = 0; j < kMostFew / 2; ++j) ranks[j] += here < order[j] ? 1 : 0;
            else
                for (std::uint32_t j = 0; j < kMostFew; ++j) ranks[j] += here < order[j] ? 1 : 0;
        }
    }

    // The best of all cuts, by the boxes that they leave. A part that does not fill its granules costs as if it did.
    void part_few(const BoxRange& range, BoxRange& left, BoxRange& right) {
        const std::uint32_t count = range.size();
        const WideBox* const items = items_of(range) + range.begin;
        std::array<std::array<std::int32_t, kMostFew>, 3> order{};
        for (std::uint32_t i = 0; i < count; ++i) {
            const detail::Lanes4 middle = items[i].middle();
            for (int axis = 0; axis < 3; ++axis)
                order[static_cast<std::size_t>(axis)][i] = rough_order(middle[axis], i);
        }
        std::array<std::array<std::int32_t, kMostFew>, 3> ranks;
        float best = std::numeric_limits<float>::infinity();
        std::size_t best_axis = 0;
        std::uint32_t best_cut = granule_;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            find_ranks(order[axis].data(), count, ranks[axis].data());
            std::array<WideBox, kMostFew> boxes;
            for (std::uint32_t i = 0; i < count; ++i) boxes[static_cast<std::size_t>(ranks[axis][i])] = items[i];
            std::array<float, kMostFew> cost;
            WideBox below, above;
            for (std::uint32_t cut = 1; cut < count; ++cut) {
                below.include(boxes[cut - 1]);
                cost[cut] = half_area_of(below) * static_cast<float>(granules(cut));
            }
            for (std::uint32_t cut = count - 1; cut > 0; --cut) {
                above.include(boxes[cut]);
                const float both = cost[cut] + half_area_of(above) * static_cast<float>(granules(count - cut));
                if (both < best) best = both, best_axis = axis, best_cut = cut;
            }
        }
        if (best == 0.0f) return part_by_number(range, left, right);  // all along one line
        part(range, best_cut, left, right, [&](std::uint32_t i, const WideBox&) {
            return ranks[best_axis][i - range.begin] < static_cast<std::int32_t>(best_cut);
        });
    }

    static float half_area_of(const WideBox& box) {
        const detail::Lanes4 d = box.high - box.low, areas = d * detail::next(d);
        return areas[0] + areas[1] + areas[2];
    }

    [[nodiscard]] std::uint32_t granules(std::uint32_t items) const {
        return (items + granule_ - 1) >> std::countr_zero(granule_);
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
            std::uint32_t below = 0;
            const std::size_t border = best_border(bins_[static_cast<std::size_t>(axis)], best, below);
            if (border != 0)
                plane = {axis, range.middles.low[axis], scale[axis], static_cast<float>(border), below, {}, best};
        }
        if (!(best < std::numeric_limits<double>::infinity())) return false;
        const Bins& bins = bins_[static_cast<std::size_t>(plane.axis)];
        for (std::size_t b = 0; b < kBins; ++b)
            plane.boxes[static_cast<float>(b) < plane.border ? 0 : 1].include(bins.boxes[b]);
        return true;
    }

    void fill_bins(const BoxRange& range, const detail::Lanes4& scale) {
        const bool many = range.size() > kManyItems;
        for (std::size_t i = 0; i < (many ? 6u : 3u); ++i) bins_[i].clear();
        const detail::Lanes4 low = range.middles.low, zero = detail::all_lanes(0.0f);
        const detail::Lanes4 last = detail::all_lanes(static_cast<float>(kBins - 1));
        const WideBox* const items = items_of(range);
        const auto add = [&](std::uint32_t i, Bins* bins) {
            const WideBox item = items[i];
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
    std::size_t best_border(const Bins& bins, double& best, std::uint32_t& below) const {
        std::array<double, kBins> right_cost;
        WideBox right, left;
        std::uint32_t right_count = 0, left_count = 0;
        for (std::uint32_t rest = bins.used; rest != 0;) {
            const auto b = static_cast<std::size_t>(std::bit_width(rest)) - 1;
            rest ^= 1u << b;
            right.include(bins.boxes[b]);
            right_cost[b] = half_area(right) * granules(right_count += bins.counts[b]);
        }
        std::size_t border = 0;
        for (std::uint32_t rest = bins.used; (rest & (rest - 1)) != 0;) {
            const auto b = static_cast<std::size_t>(std::countr_zero(rest));
            rest &= rest - 1;
            left.include(bins.boxes[b]);
            left_count += bins.counts[b];
            const double cost =
                half_area(left) * granules(left_count) + right_cost[static_cast<std::size_t>(std::countr_zero(rest))];
            if (cost < best) best = cost, border = b + 1, below = left_count;
        }
        return border;
    }

    static constexpr std::uint32_t kMostFew = 32;
    static constexpr std::uint32_t kMostAligned = 1024;  // a leaf that is not full is one of many above that
    static constexpr double kDearer = 1.25;              // so much may whole granules cost
    std::uint32_t leaf_size_, granule_;
    SplitItems& items_;
    Vector<PlacedMiddle> near_;
    // By axis, twice: of many items the odd ones go to the second three. An item waits for the one before it in its
    // bin.
    static constexpr std::uint32_t kManyItems = 128;
    std::array<Bins, 6> bins_;
};

// The items' boxes, in the order of their numbers.
BoxRange fill(SplitItems& items, std::size_t count, BoxOfItem box_of, Executor& executor) {
    constexpr std::size_t kAtOnce = 16384;
    for (Vector<WideBox>& boxes : items.boxes) boxes.resize(count);
    items.order.resize(count);
    Vector<BoxRange> parts((count + kAtOnce - 1) / kAtOnce);
    crofton::detail::recoverable_for(executor, count, kAtOnce, [&](std::size_t begin, std::size_t end, unsigned) {
        BoxRange part;
        for (std::size_t i = begin; i < end; ++i) {
            const FloatBox box = box_of(i);
            WideBox& item = items.boxes[0][i];
            for (int k = 0; k < 3; ++k) item.low[k] = box.low[k], item.high[k] = box.high[k];
            item.low[3] = std::bit_cast<float>(static_cast<std::uint32_t>(i) | kItemBit);
            part.include(item);
        }
        parts[begin / kAtOnce] = part;
    });
    BoxRange all;
    all.end = static_cast<std::uint32_t>(count);
    for (const BoxRange& part : parts) {
        all.box.include(part.box);
        all.middles.include(part.middles);
    }
    return all;
}

// Splits all items down to leaves. Ranges are split side by side: large ones in rounds, small ones to their leaves.
// Children stand behind their parents.
Vector<BinaryNode> split_items(SplitItems& items, const BoxRange& all, std::uint32_t leaf_size, std::uint32_t granule,
                               Executor& executor) {
    constexpr std::uint32_t kMostAtOnce = 4096;
    struct Todo {
        BoxRange range;
        std::uint32_t node;
        BoxRange left, right;      // of a large one
        Vector<BinaryNode> below;  // of a small one
    };
    Vector<BinaryNode> nodes;
    Vector<Todo> round, next;
    const auto add = [&](const BoxRange& range) {
        next.push_back({range, static_cast<std::uint32_t>(nodes.size()), {}, {}, {}});
        nodes.push_back({range.box, range.begin, range.end});
    };
    add(all);
    while (!next.empty()) {
        round = std::exchange(next, {});
        crofton::detail::recoverable_for(executor, round.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
            Splitter splitter(items, leaf_size, granule);
            for (std::size_t i = begin; i < end; ++i) {
                Todo& todo = round[i];
                if (todo.range.size() <= std::max(kMostAtOnce, leaf_size))
                    todo.below = splitter.split_all(todo.range);
                else
                    splitter.split(todo.range, todo.left, todo.right);
            }
        });
        for (Todo& todo : round) {
            if (todo.below.empty()) {
                nodes[todo.node].halves = static_cast<std::uint32_t>(nodes.size());
                add(todo.left);
                add(todo.right);
                continue;
            }
            const auto moved = static_cast<std::uint32_t>(nodes.size()) - 1;
            for (BinaryNode& node : todo.below)
                if (node.halves != 0) node.halves += moved;
            nodes[todo.node] = todo.below.front();
            nodes.insert(nodes.end(), todo.below.begin() + 1, todo.below.end());
            todo.below = {};
        }
    }
    return nodes;
}

// Joins binary nodes to nodes of eight lanes, such that their areas sum up to the least: the nodes that a line is
// expected to visit (the dynamic programme of Ylitie, Karras, Laine 2017).
class Collapse {
  public:
    explicit Collapse(std::span<const BinaryNode> binary) : binary_(binary), costs_(binary.size()) {
        for (std::size_t n = binary.size(); n-- > 0;)
            if (binary[n].halves != 0) find_costs(n);
    }

    void run(BoxHierarchy& result) {
        struct Todo {
            std::uint32_t binary, node;
        };
        Vector<Todo> stack;
        result.nodes.assign(1, {});
        stack.push_back({0, 0});
        while (!stack.empty()) {
            const Todo todo = stack.back();
            stack.pop_back();
            BoxNode node{};
            count_ = 0;
            if (binary_[todo.binary].halves == 0)
                lanes_[count_++] = todo.binary;
            else
                spread(todo.binary, kWidth);
            node.count = count_;
            for (std::uint32_t lane = 0; lane < kWidth; ++lane)
                set_bounds(node, lane, lane < count_ ? narrow(binary_[lanes_[lane]].box) : FloatBox{});
            for (std::uint32_t lane = 0; lane < count_; ++lane) {
                const BinaryNode& child = binary_[lanes_[lane]];
                if (child.halves == 0) {
                    node.child[lane] = static_cast<std::uint32_t>(result.leaves.size()) | kMeshLeaf;
                    result.leaves.push_back({child.begin, child.end});
                } else {
                    node.child[lane] = static_cast<std::uint32_t>(result.nodes.size());
                    result.nodes.push_back({});
                    stack.push_back({lanes_[lane], node.child[lane]});
                }
            }
            result.nodes[todo.node] = node;
        }
    }

  private:
    void find_costs(std::size_t n) {
        const LaneCosts &a = costs_[binary_[n].halves], &b = costs_[binary_[n].halves + 1];
        LaneCosts& here = costs_[n];
        std::array<double, kWidth + 1> spread;
        for (std::size_t k = 2; k <= kWidth; ++k) {
            spread[k] = std::numeric_limits<double>::infinity();
            for (std::size_t first = 1; first < k; ++first)
                if (const double cost = a.cost[first] + b.cost[k - first]; cost < spread[k])
                    spread[k] = cost, here.first[k] = static_cast<std::uint8_t>(first);
        }
        here.first[1] = here.first[kWidth];
        here.cost[1] = half_area(binary_[n].box) + spread[kWidth];
        for (std::size_t k = 2; k <= kWidth; ++k) {
            here.cost[k] = std::min(spread[k], here.cost[k - 1]);
            if (!(spread[k] < here.cost[k - 1])) here.first[k] = 0;
        }
    }

    // Gives the halves of a node their shares of `lanes`.
    void spread(std::uint32_t n, std::size_t lanes) {
        const std::uint32_t halves = binary_[n].halves;
        const std::size_t first = costs_[n].first[lanes == kWidth ? 1 : lanes];
        place(halves, first);
        place(halves + 1, lanes - first);
    }

    void place(std::uint32_t n, std::size_t lanes) {
        while (lanes > 1 && costs_[n].first[lanes] == 0) --lanes;
        if (binary_[n].halves == 0 || lanes == 1)
            lanes_[count_++] = n;
        else
            spread(n, lanes);
    }

    std::span<const BinaryNode> binary_;
    Vector<LaneCosts> costs_;  // zeros of leaves
    std::array<std::uint32_t, kWidth> lanes_{};
    std::uint32_t count_ = 0;
};

}  // namespace

void set_bounds(BoxNode& node, std::uint32_t lane, const FloatBox& box) {
    for (int i = 0; i < 3; ++i) {
        node.bounds[i][lane] = box.low[i];
        node.bounds[i + 3][lane] = box.high[i];
    }
}

BoxHierarchy build_box_hierarchy(std::size_t count, BoxOfItem box_of, std::uint32_t leaf_size, std::uint32_t granule,
                                 Executor& executor) {
    SplitItems items;
    const BoxRange all = fill(items, count, box_of, executor);
    const Vector<BinaryNode> binary = split_items(items, all, leaf_size, granule, executor);
    BoxHierarchy result;
    Collapse(binary).run(result);
    result.order = std::move(items.order);
    return result;
}

}  // namespace crofton::mesh
