#include "builder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace crofton::tree {
namespace {

constexpr unsigned kBins = 16;

struct Range {
    std::uint32_t begin, end;
    [[nodiscard]] std::uint32_t size() const { return end - begin; }
};

struct Bounds {
    float low[3] = {kHuge, kHuge, kHuge};
    float high[3] = {-kHuge, -kHuge, -kHuge};
    static constexpr float kHuge = std::numeric_limits<float>::max();

    template <class Box>
    void include(const Box& other) {
        for (int j = 0; j < 3; ++j) {
            low[j] = std::min(low[j], other.low[j]);
            high[j] = std::max(high[j], other.high[j]);
        }
    }
};

// The criterion's value for a box, without a call per candidate.
struct Cost {
    double volume, area, edges;
    explicit Cost(const measure::Criterion& c)
        : volume(c.volume_weight), area(2.0 * c.area_weight), edges(std::numbers::pi * c.mean_curvature_weight) {}
    [[nodiscard]] double operator()(const Bounds& b) const {
        const double x = double{b.high[0]} - double{b.low[0]}, y = double{b.high[1]} - double{b.low[1]},
                     z = double{b.high[2]} - double{b.low[2]};
        return volume * (x * y * z) + area * (x * y + y * z + z * x) + edges * (x + y + z);
    }
};

float centroid(const BuildItem& item, int axis) {
    return 0.5f * item.low[axis] + 0.5f * item.high[axis];
}

struct Split {
    int axis = 0;
    std::uint32_t left = 0;  // how many items
    double cost = std::numeric_limits<double>::infinity();
};

class TopologyBuilder {
  public:
    TopologyBuilder(Vector<BuildItem> items, const measure::Criterion& criterion)
        : items_(std::move(items)), cost_(criterion) {}

    Topology run() {
        struct Task {
            Range range;
            NodeId parent;
            std::uint32_t lane;
            unsigned depth;
        };
        Vector<Task> tasks;
        tasks.push_back({{0, static_cast<std::uint32_t>(items_.size())}, kNone, 0, 1});
        while (!tasks.empty()) {
            const Task task = tasks.back();
            tasks.pop_back();
            if (task.parent != kNone && task.range.size() <= kWidth) {
                const auto leaf = static_cast<LeafId>(result_.leaves.size());
                result_.leaves.push_back({task.range.begin, task.range.size(), task.parent, task.lane});
                result_.nodes[task.parent].child[task.lane] = leaf | kLeafBit;
                continue;
            }
            const auto node = static_cast<NodeId>(result_.nodes.size());
            result_.nodes.emplace_back();
            result_.height = std::max(result_.height, task.depth);
            Topology::NodeRecord& record = result_.nodes.back();
            record.parent = task.parent;
            record.lane_in_parent = task.lane;
            if (task.parent != kNone) result_.nodes[task.parent].child[task.lane] = node;
            std::array<Range, kWidth> children;
            record.count = divide(task.range, children);
            // Last in, first out: leaves come out in the order of the lanes.
            for (std::uint32_t lane = record.count; lane-- > 0;)
                tasks.push_back({children[lane], node, lane, task.depth + 1});
        }
        number_leaves();
        for (const BuildItem& item : items_) result_.order.push_back(item.id);
        return std::move(result_);
    }

  private:
    // Cuts a range into as few full children as hold it: each but the last of 16^k items, so that all leaves but one
    // are full.
    std::uint32_t divide(Range range, std::array<Range, kWidth>& children) {
        if (range.size() == 0) return 0;
        std::uint64_t capacity = kWidth;
        while (capacity * kWidth < range.size()) capacity *= kWidth;
        children[0] = range;
        std::uint32_t count = 1;
        for (;;) {
            std::uint32_t largest = 0;
            for (std::uint32_t i = 1; i < count; ++i)
                if (children[i].size() > children[largest].size()) largest = i;
            if (children[largest].size() <= capacity) return count;
            const Range whole = children[largest];
            const std::uint32_t middle = whole.begin + partition(whole, static_cast<std::uint32_t>(capacity));
            for (std::uint32_t i = count; i > largest + 1; --i) children[i] = children[i - 1];
            children[largest] = {whole.begin, middle};
            children[largest + 1] = {middle, whole.end};
            ++count;
        }
    }

    std::uint32_t partition(Range range, std::uint32_t capacity) {
        Split split = best_split(range);
        const std::uint32_t parts = (range.size() + capacity - 1) / capacity;
        const std::uint32_t left_parts = std::clamp((split.left + capacity / 2) / capacity, 1u, parts - 1);
        const std::uint32_t left = left_parts * capacity;
        const auto first = items_.begin() + range.begin;
        std::nth_element(first, first + left, items_.begin() + range.end,
                         [axis = split.axis](const BuildItem& a, const BuildItem& b) {
                             const float x = centroid(a, axis), y = centroid(b, axis);
                             return x != y ? x < y : a.id < b.id;
                         });
        return left;
    }

    // The cut at a bin's border that minimises Σ criterion(side) · items(side): what a uniformly random query pays
    // below here.
    Split best_split(Range range) const {
        const std::span<const BuildItem> items = std::span<const BuildItem>(items_).subspan(range.begin, range.size());
        float low[3], high[3];
        for (int j = 0; j < 3; ++j) low[j] = high[j] = centroid(items[0], j);
        for (const BuildItem& item : items)
            for (int j = 0; j < 3; ++j) {
                low[j] = std::min(low[j], centroid(item, j));
                high[j] = std::max(high[j], centroid(item, j));
            }
        struct Bin {
            Bounds bounds;
            std::uint32_t count = 0;
        };
        std::array<std::array<Bin, kBins>, 3> bins{};
        float scale[3];
        for (int j = 0; j < 3; ++j) {
            const float extent = high[j] - low[j];
            scale[j] = extent > 1e-30f ? (kBins - 0.01f) / extent : 0.0f;
        }
        for (const BuildItem& item : items)
            for (int j = 0; j < 3; ++j) {
                const float position = (centroid(item, j) - low[j]) * scale[j];
                Bin& bin = bins[static_cast<unsigned>(j)][std::min(kBins - 1, static_cast<unsigned>(position))];
                bin.bounds.include(item);
                ++bin.count;
            }
        Split best{0, range.size() / 2, std::numeric_limits<double>::infinity()};
        for (int j = 0; j < 3; ++j) {
            const auto& axis = bins[static_cast<unsigned>(j)];
            std::array<double, kBins> right_cost{};
            Bounds bounds;
            std::uint32_t count = 0;
            for (unsigned i = kBins - 1; i > 0; --i) {
                bounds.include(axis[i].bounds);
                count += axis[i].count;
                right_cost[i] = count ? cost_(bounds) * count : 0.0;
            }
            bounds = {};
            count = 0;
            for (unsigned i = 0; i + 1 < kBins; ++i) {
                bounds.include(axis[i].bounds);
                count += axis[i].count;
                if (count == 0 || count == range.size()) continue;
                const double cost = cost_(bounds) * count + right_cost[i + 1];
                if (cost < best.cost) best = {j, count, cost};
            }
        }
        return best;
    }

    void number_leaves() {
        for (NodeId n = static_cast<NodeId>(result_.nodes.size()); n-- > 0;) {
            Topology::NodeRecord& node = result_.nodes[n];
            if (node.count == 0) continue;
            const auto first_leaf = [&](std::uint32_t child) {
                return child & kLeafBit ? LeafRange{child & ~kLeafBit, 1} : result_.nodes[child].leaves;
            };
            const LeafRange last = first_leaf(node.child[node.count - 1]);
            node.leaves.first = first_leaf(node.child[0]).first;
            node.leaves.count = last.first + last.count - node.leaves.first;
        }
    }

    Vector<BuildItem> items_;
    Cost cost_;
    Topology result_;
};

}  // namespace

Topology build_topology(std::span<const Obb> boxes, std::span<const ItemId> items,
                        const measure::Criterion& criterion) {
    Aabb scene;
    for (const ItemId id : items) scene.include(boxes[id].center);
    const glm::dvec3 middle = items.empty() ? glm::dvec3(0.0) : scene.center();
    Vector<BuildItem> build_items;
    build_items.reserve(items.size());
    for (const ItemId id : items) {
        const Aabb box = aabb_of(boxes[id]);
        BuildItem item{{}, {}, id};
        for (int j = 0; j < 3; ++j) {
            item.low[j] = static_cast<float>(box.min[j] - middle[j]);
            item.high[j] = static_cast<float>(box.max[j] - middle[j]);
        }
        build_items.push_back(item);
    }
    return TopologyBuilder(std::move(build_items), criterion).run();
}

}  // namespace crofton::tree
