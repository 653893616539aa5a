// Cutting a crowd of boxes into compact parts by a criterion.
#pragma once
#include <array>
#include <bit>
#include <crofton/measure/criterion.hpp>
#include <crofton/tree/layout.hpp>
#include <limits>
#include <numbers>
#include <span>

namespace crofton::tree {

// An item, or a cluster of them, as the builder sees it: its axis-aligned box in float around the scene's middle, as
// (−low, high), so that a union is one maximum over eight numbers. It only decides who sits beside whom; the bounds
// themselves are computed from the boxes. Entry 3 holds the id's bits, entry 7 nothing.
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

// Reorders items[range] and cuts it into the fewest parts of unit · 16^k items each, the last of which may be smaller;
// cuts are chosen to minimise Σ criterion(part) · items(part), what a uniformly random query pays below here. At most
// 16 parts.
[[nodiscard]] Children divide(std::span<BuildItem> items, Range range, std::uint32_t unit, const Cost& cost);

}  // namespace crofton::tree
