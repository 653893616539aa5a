// SPDX-License-Identifier: MIT
// Cutting a crowd of boxes into compact parts by a criterion.
#pragma once
#include <array>
#include <bit>
#include <crofton/boxtree/layout.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/measure/measure.hpp>
#include <limits>
#include <numbers>
#include <span>

namespace crofton::boxtree {

// An item, or a cluster of them, as the builder sees it: its axis-aligned box in float around the scene's middle. It is
// stored as (−low, high), so that a union is one maximum over eight numbers. It only decides who sits beside whom; the
// bounds themselves are computed from the boxes. Entry 3 holds the id's bits, entry 7 nothing.
struct alignas(16) BuildItem {
    float extreme[8];

    [[nodiscard]] std::uint32_t id() const { return std::bit_cast<std::uint32_t>(extreme[3]); }
    void set_id(std::uint32_t id) { extreme[3] = std::bit_cast<float>(id); }  // below 2^30: never NaN
    [[nodiscard]] float twice_center(unsigned axis) const { return extreme[4 + axis] - extreme[axis]; }
    void include(const BuildItem& other) {
        for (int k = 0; k < 8; ++k) extreme[k] = other.extreme[k] > extreme[k] ? other.extreme[k] : extreme[k];
    }
};

inline constexpr float kHuge = std::numeric_limits<float>::max();
inline constexpr BuildItem kNothing{{-kHuge, -kHuge, -kHuge, 0.0f, -kHuge, -kHuge, -kHuge, 0.0f}};

// The criterion's value for a box, without a call per candidate.
struct Cost {
    double volume, area, edges;
    explicit Cost(const measure::Criterion& c)
        : volume(c.volume_weight), area(2.0 * c.area_weight), edges(std::numbers::pi * c.mean_curvature_weight) {}
    [[nodiscard]] double of(double x, double y, double z) const {
        return volume * (x * y * z) + area * (x * y + y * z + z * x) + edges * (x + y + z);
    }
    [[nodiscard]] double operator()(const BuildItem& b) const {
        const auto edge = [&](int j) { return double{b.extreme[4 + j]} + double{b.extreme[j]}; };
        return of(edge(0), edge(1), edge(2));
    }
};

struct Range {
    std::uint32_t begin = 0, end = 0;
    [[nodiscard]] std::uint32_t size() const { return end - begin; }
};

struct Children {
    std::array<Range, kWidth> ranges;
    std::uint32_t count = 0;
};

// How many items each part of divide() holds, but for the last one: the least unit · 16^k of which 16 are enough.
[[nodiscard]] inline std::uint64_t items_a_part(std::uint64_t items, std::uint64_t unit) {
    while (unit * kWidth < items) unit *= kWidth;
    return unit;
}

// Divides a crowd of items into parts. Keeps the items in three orders, by their centres along each axis. Cuts keep all
// three sorted, so that items are sorted only once. Memory is kept from crowd to crowd.
class Splitter {
  public:
    // `items` stay where they are, and are read until the last divide().
    void start(std::span<const BuildItem> items);

    // Cuts the items order()[range] into the fewest parts of items_a_part() items each, the last of which may be
    // smaller: at most 16. A part is a range of order() then. Cuts are chosen to minimise Σ criterion(part) ·
    // items(part), what a uniformly random query pays below here.
    [[nodiscard]] Children divide(Range range, std::uint32_t unit, const Cost& cost);

    // order()[range] becomes that of another splitter's items, whose item i is indices[i] here, in all three orders.
    void take(Range range, const Splitter& from, std::span<const std::uint32_t> indices);

    // Indices into the items.
    [[nodiscard]] std::span<const std::uint32_t> order() const { return sorted_[0]; }

  private:
    struct Cut {
        unsigned axis = 0;
        std::uint32_t left = 0;  // how many items
    };
    struct Key {
        std::uint32_t value, index;
    };

    void sort(unsigned axis);
    [[nodiscard]] Cut best_cut(Range range, std::uint32_t capacity, const Cost& cost) const;
    [[nodiscard]] unsigned longest_axis(Range range) const;
    void cut(Range range, const Cut& cut);

    std::span<const BuildItem> items_;
    Vector<std::uint32_t> sorted_[3], right_;
    Vector<std::uint8_t> is_left_;
    Vector<Key> keys_, keys_next_;
};

// Cuts sixteen items in halves across the axis along which their centres spread farthest, and puts the first half
// first. Each half is in the order of its centres along x.
void halve(std::span<BuildItem, kWidth> items);

}  // namespace crofton::boxtree
