// SPDX-License-Identifier: MIT
// Cutting a crowd of boxes into compact parts by a criterion.
#pragma once
#include <array>
#include <bit>
#include <crofton/boxtree/layout.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/float_lanes.hpp>
#include <crofton/measure/measure.hpp>
#include <limits>
#include <numbers>
#include <span>

namespace crofton::boxtree {

// An item, or a cluster of them, as the builder sees it: its axis-aligned box in float around the scene's middle. It is
// stored as (−low, high), so that a union is one maximum over eight numbers. It only decides which items are
// neighbours; the bounds themselves are computed from the boxes. Entry 3 holds the id's bits, entry 7 nothing.
struct alignas(16) BuildItem {
    float extreme[8];

    [[nodiscard]] std::uint32_t id() const { return std::bit_cast<std::uint32_t>(extreme[3]); }
    void set_id(std::uint32_t id) { extreme[3] = std::bit_cast<float>(id); }  // below 2^30: never NaN
    [[nodiscard]] float twice_center(unsigned axis) const { return extreme[4 + axis] - extreme[axis]; }
    void include(const BuildItem& other) {
        for (int k = 0; k < 8; k += 4) {
            const detail::Lanes4 larger = detail::larger(other.lanes(k), lanes(k));
            std::memcpy(extreme + k, &larger, sizeof larger);
        }
    }
    [[nodiscard]] detail::Lanes4 lanes(int first) const {
        return detail::load4(reinterpret_cast<const char*>(extreme + first));
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
//
// Both can be done in steps, each of about `work`, which is lessened by what was spent: in sixteenths of what an item
// costs in Builder::add().
class Splitter {
  public:
    // `items` stay where they are, and are read until the last divide().
    void start(std::span<const BuildItem> items);
    // The same in steps: then sort_on() until it is true.
    void begin(std::span<const BuildItem> items);
    bool sort_on(std::size_t& work);

    // Cuts the items order()[range] into the fewest parts of items_a_part() items each, the last of which may be
    // smaller: at most 16. A part is a range of order() then. Cuts are chosen to minimise Σ criterion(part) ·
    // items(part), what a uniformly random query pays below here.
    [[nodiscard]] Children divide(Range range, std::uint32_t unit, const Cost& cost);
    // The same in steps: then divide_on() until it is true, and children() are the parts.
    void begin_division(Range range, std::uint32_t unit);
    bool divide_on(const Cost& cost, std::size_t& work);
    [[nodiscard]] const Children& children() const { return division_.children; }

    // order()[range] becomes that of another splitter's items, whose item i is indices[i] here, in all three orders.
    void take(Range range, const Splitter& from, std::span<const std::uint32_t> indices);

    // How often an item has been looked at.
    [[nodiscard]] std::size_t visits() const { return visits_; }

    // Indices into the items.
    [[nodiscard]] std::span<const std::uint32_t> order() const { return std::span(sorted_[0]).first(items_.size()); }

  private:
    struct Cut {
        unsigned axis = 0;
        std::uint32_t left = 0;  // how many items
    };
    struct Key {
        std::uint32_t value, index;
    };

    // Sorting along an axis: its keys, a pass for each digit, then the order.
    enum class Pass : std::uint8_t { keys, digits, order };
    // A division is a row of cuts, each of the largest part there is: the axes are rated, one is chosen, and the other
    // two orders are parted.
    enum class Stage : std::uint8_t { choose, rate, mark, part };
    static constexpr unsigned kDigitBits = 8, kDigits = 4, kDigitValues = 1u << kDigitBits;
    struct Division {
        Children children;
        std::uint32_t capacity = 0;
        Stage stage = Stage::choose;
        std::uint32_t largest = 0;  // which of the children is cut
        Cut cut;
        double least = 0.0;  // the cost of the cut
        unsigned axis = 0;   // that is rated or parted
        std::uint32_t at = 0;
        BuildItem bounds[kWidth];           // along the axis, of each part of `capacity` items
        std::uint32_t left = 0, right = 0;  // where the next items of either side go
    };

    template <class Visit>
    bool run_some(std::uint32_t& at, std::uint32_t end, std::size_t cost, std::size_t& work, Visit visit);
    bool sort_pass(std::size_t& work);
    void write_keys(std::uint32_t begin, std::uint32_t end);
    bool choose_part();
    bool rate_axis(const Cost& cost, std::size_t& work);
    void rate_cuts(const Cost& cost);
    bool mark_sides(std::size_t& work);
    bool part_axis(std::size_t& work);
    void finish_cut();
    [[nodiscard]] unsigned longest_axis(Range range) const;

    std::span<const BuildItem> items_;
    Vector<std::uint32_t> sorted_[3], right_;
    Vector<std::uint8_t> is_left_;
    Vector<Key> keys_, keys_next_;
    unsigned axis_ = 0;  // that is sorted; 3: all are
    Pass pass_ = Pass::keys;
    unsigned digit_ = 0;
    std::uint32_t at_ = 0;
    std::array<std::array<std::uint32_t, kDigitValues>, kDigits>
        starts_;  // how often each digit occurs, then its place
    Division division_;
    std::size_t visits_ = 0;
};

// Cuts sixteen items in halves across the axis along which their centres spread farthest, and puts the first half
// first. Each half is in the order of its centres along x.
void halve(std::span<BuildItem, kWidth> items);

}  // namespace crofton::boxtree
