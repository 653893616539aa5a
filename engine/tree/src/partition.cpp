#include "partition.hpp"

#include <algorithm>

namespace crofton::tree {
namespace {

constexpr unsigned kBins = 16;

struct Split {
    unsigned axis = 0;
    std::uint32_t left = 0;  // how many items
};

struct Bin {
    BuildItem bounds = kNothing;
    std::uint32_t count = 0;
};
using Bins = std::array<std::array<Bin, kBins>, 3>;

// Equal cells of the centres' range along each axis; monotone in the centre.
struct Cells {
    float low[3], scale[3];

    explicit Cells(std::span<const BuildItem> items) {
        float high[3];
        for (unsigned j = 0; j < 3; ++j) low[j] = high[j] = items[0].twice_center(j);
        for (const BuildItem& item : items)
            for (unsigned j = 0; j < 3; ++j) {
                const float c = item.twice_center(j);
                low[j] = c < low[j] ? c : low[j];
                high[j] = c > high[j] ? c : high[j];
            }
        for (unsigned j = 0; j < 3; ++j) {
            const float extent = high[j] - low[j];
            scale[j] = extent > 1e-30f && extent < kHuge ? (kBins - 0.01f) / extent : 0.0f;
        }
    }
    // Do all centres coincide?
    [[nodiscard]] bool is_point() const { return !(scale[0] > 0.0f || scale[1] > 0.0f || scale[2] > 0.0f); }
    // The axis along which the centres spread farthest: the scale is smallest there, unless it is 0.
    [[nodiscard]] unsigned longest() const {
        unsigned best = 0;
        for (unsigned j = 1; j < 3; ++j)
            if (scale[j] > 0.0f && (scale[best] <= 0.0f || scale[j] < scale[best])) best = j;
        return best;
    }
    [[nodiscard]] unsigned of(const BuildItem& item, unsigned j) const {
        const auto cell = static_cast<unsigned>(static_cast<int>((item.twice_center(j) - low[j]) * scale[j]));
        return cell < kBins ? cell : kBins - 1;
    }
};

void fill(Bins& bins, std::span<const BuildItem> items, const Cells& cells) {
    for (const BuildItem& item : items)
        for (unsigned j = 0; j < 3; ++j) {
            Bin& bin = bins[j][cells.of(item, j)];
            bin.bounds.include(item);
            ++bin.count;
        }
}

// The best cut at a border of bins.
Split best_split(std::span<const BuildItem> items, const Cells& cells, const Cost& cost) {
    const auto count = static_cast<std::uint32_t>(items.size());
    Split best{0, count / 2};
    Bins bins;
    fill(bins, items, cells);
    double best_cost = std::numeric_limits<double>::infinity();
    for (unsigned j = 0; j < 3; ++j) {
        std::array<double, kBins> right_cost{};
        BuildItem bounds = kNothing;
        std::uint32_t n = 0;
        for (unsigned i = kBins - 1; i > 0; --i) {
            bounds.include(bins[j][i].bounds);
            n += bins[j][i].count;
            right_cost[i] = n ? cost(bounds) * n : 0.0;
        }
        bounds = kNothing;
        n = 0;
        for (unsigned i = 0; i + 1 < kBins; ++i) {
            bounds.include(bins[j][i].bounds);
            n += bins[j][i].count;
            if (n == 0 || n == count) continue;
            const double value = cost(bounds) * n + right_cost[i + 1];
            if (value < best_cost) {
                best_cost = value;
                best = {j, n};
            }
        }
    }
    return best;
}

// Moves the items for which `first` holds to the front; returns how many. Without a branch on what cannot be guessed.
template <class First>
std::uint32_t gather(std::span<BuildItem> items, const First& first) {
    std::uint32_t front = 0;
    for (std::uint32_t i = 0; i < items.size(); ++i) {
        const BuildItem item = items[i];
        items[i] = items[front];
        items[front] = item;
        front += first(item) ? 1u : 0u;
    }
    return front;
}

// The `left` items with the least centres (and ids, where centres are equal) to the front.
void select(std::span<BuildItem> items, std::uint32_t left, unsigned axis, const Cells& cells) {
    const auto before = [axis](const BuildItem& a, const BuildItem& b) {
        const float x = a.twice_center(axis), y = b.twice_center(axis);
        return x != y ? x < y : a.id() < b.id();
    };
    // By cells first: only the one that the cut goes through is to be looked at more closely.
    std::uint32_t begin = 0, end = static_cast<std::uint32_t>(items.size());
    if (end > 4 * kBins) {
        std::array<std::uint32_t, kBins> counts{};
        for (const BuildItem& item : items) ++counts[cells.of(item, axis)];
        unsigned cut = 0;
        std::uint32_t smaller = 0;
        while (smaller + counts[cut] <= left) smaller += counts[cut++];
        begin = gather(items, [&](const BuildItem& item) { return cells.of(item, axis) < cut; });
        end = begin + gather(items.subspan(begin), [&](const BuildItem& item) { return cells.of(item, axis) == cut; });
    }
    const auto at = [&](std::uint32_t i) { return items.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(left), at(end), before);
}

// Puts the items before and behind the cut; returns how many are before it, a multiple of `capacity`.
std::uint32_t partition(std::span<BuildItem> items, std::uint32_t capacity, const Cost& cost) {
    const auto count = static_cast<std::uint32_t>(items.size());
    const std::uint32_t parts = (count + capacity - 1) / capacity;
    const Cells cells(items);
    Split split{cells.longest(), count / 2};
    // Where only one place is possible, the axis is all there is to choose.
    if (parts > 2 && !cells.is_point()) split = best_split(items, cells, cost);
    const std::uint32_t left = capacity * std::clamp((split.left + capacity / 2) / capacity, 1u, parts - 1);
    select(items, left, split.axis, cells);
    return left;
}

}  // namespace

Children divide(std::span<BuildItem> items, Range range, std::uint32_t unit, const Cost& cost) {
    Children children;
    if (range.size() == 0) return children;
    std::uint64_t capacity = unit;
    while (capacity * kWidth < range.size()) capacity *= kWidth;
    children.ranges[0] = range;
    children.count = 1;
    for (;;) {
        std::uint32_t largest = 0;
        for (std::uint32_t i = 1; i < children.count; ++i)
            if (children.ranges[i].size() > children.ranges[largest].size()) largest = i;
        const Range whole = children.ranges[largest];
        if (whole.size() <= capacity) return children;
        const std::uint32_t middle = whole.begin + partition(items.subspan(whole.begin, whole.size()),
                                                             static_cast<std::uint32_t>(capacity), cost);
        for (std::uint32_t i = children.count; i > largest + 1; --i) children.ranges[i] = children.ranges[i - 1];
        children.ranges[largest] = {whole.begin, middle};
        children.ranges[largest + 1] = {middle, whole.end};
        ++children.count;
    }
}

}  // namespace crofton::tree
