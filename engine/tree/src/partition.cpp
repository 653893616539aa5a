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

// Fills the bins by centre; false if all centres coincide.
bool fill(Bins& bins, std::span<const BuildItem> items) {
    float low[3], high[3], scale[3];
    for (unsigned j = 0; j < 3; ++j) low[j] = high[j] = items[0].twice_center(j);
    for (const BuildItem& item : items)
        for (unsigned j = 0; j < 3; ++j) {
            const float c = item.twice_center(j);
            low[j] = c < low[j] ? c : low[j];
            high[j] = c > high[j] ? c : high[j];
        }
    bool spread = false;
    for (unsigned j = 0; j < 3; ++j) {
        const float extent = high[j] - low[j];
        scale[j] = extent > 1e-30f && extent < kHuge ? (kBins - 0.01f) / extent : 0.0f;
        spread = spread || scale[j] > 0.0f;
    }
    if (!spread) return false;
    for (const BuildItem& item : items)
        for (unsigned j = 0; j < 3; ++j) {
            const auto position = static_cast<unsigned>(static_cast<int>((item.twice_center(j) - low[j]) * scale[j]));
            Bin& bin = bins[j][position < kBins ? position : kBins - 1];
            bin.bounds.include(item);
            ++bin.count;
        }
    return true;
}

// The best cut at a border of bins.
Split best_split(std::span<const BuildItem> items, const Cost& cost) {
    const auto count = static_cast<std::uint32_t>(items.size());
    Split best{0, count / 2};
    Bins bins;
    if (!fill(bins, items)) return best;
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

// Puts the items before and behind the cut; returns how many are before it, a multiple of `capacity`.
std::uint32_t partition(std::span<BuildItem> items, std::uint32_t capacity, const Cost& cost) {
    const Split split = best_split(items, cost);
    const auto count = static_cast<std::uint32_t>(items.size());
    const std::uint32_t parts = (count + capacity - 1) / capacity;
    const std::uint32_t left = capacity * std::clamp((split.left + capacity / 2) / capacity, 1u, parts - 1);
    std::nth_element(items.begin(), items.begin() + left, items.end(),
                     [axis = split.axis](const BuildItem& a, const BuildItem& b) {
                         const float x = a.twice_center(axis), y = b.twice_center(axis);
                         return x != y ? x < y : a.id() < b.id();
                     });
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
