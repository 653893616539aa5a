// SPDX-License-Identifier: MIT
#include "domain/spatial_order.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace crofton::triangulate {
namespace {

constexpr std::uint32_t kMostDigitBits = 11;
constexpr double kLastCell = 65535.0;
constexpr double kCellsPerPoint = 16.0;
// So few are sorted lexicographically at once.
constexpr std::size_t kFew = 16;

std::uint32_t spread(std::uint32_t bits) {
    bits = (bits | bits << 8) & 0x00FF00FFu;
    bits = (bits | bits << 4) & 0x0F0F0F0Fu;
    bits = (bits | bits << 2) & 0x33333333u;
    return (bits | bits << 1) & 0x55555555u;
}

}  // namespace

std::span<const SpatialOrder::Entry> SpatialOrder::sort(std::span<const glm::dvec2> points) {
    encode(points);
    sort_by_code();
    const auto before = [&](const Entry& a, const Entry& b) {
        const auto &p = points[a.index], &q = points[b.index];
        if (p.x != q.x) return p.x < q.x;
        return p.y != q.y ? p.y < q.y : a.index < b.index;
    };
    for (std::size_t begin = 0; begin < entries_.size();) {
        std::size_t end = begin + 1;
        while (end < entries_.size() && entries_[end].code == entries_[begin].code) ++end;
        if (end - begin > 1) {
            std::sort(entries_.begin() + static_cast<std::ptrdiff_t>(begin),
                      entries_.begin() + static_cast<std::ptrdiff_t>(end), before);
        }
        begin = end;
    }
    return entries_;
}

// Rounded differences, products and their truncation are monotone in the coordinate, so cells separate strictly.
void SpatialOrder::encode(std::span<const glm::dvec2> points) {
    entries_.resize(points.size());
    double cells_per_unit = 0.0;
    glm::dvec2 low(0.0);
    if (points.size() > kFew) {
        glm::dvec2 high = low = points[0];
        for (const auto& p : points) {
            low = glm::dvec2(std::min(low.x, p.x), std::min(low.y, p.y));
            high = glm::dvec2(std::max(high.x, p.x), std::max(high.y, p.y));
        }
        const double width = high.x - low.x, height = high.y - low.y;
        const double side = std::sqrt(width / static_cast<double>(points.size()) * height / kCellsPerPoint);
        const double scale = 1.0 / std::max(side, std::max(width, height) / kLastCell);
        if (std::isfinite(scale)) cells_per_unit = scale;
    }
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        const auto x = static_cast<std::uint32_t>(std::min((points[i].x - low.x) * cells_per_unit, kLastCell));
        const auto y = static_cast<std::uint32_t>(std::min((points[i].y - low.y) * cells_per_unit, kLastCell));
        entries_[i] = {spread(x) << 1 | spread(y), i};
    }
}

// Least digit first, with about as many digits as points; the order of equal codes does not matter.
void SpatialOrder::sort_by_code() {
    std::uint32_t used = 0;
    for (const Entry& e : entries_) used |= e.code;
    if (used == 0) return;
    buffer_.resize(entries_.size());
    const auto digit_bits =
        static_cast<std::uint32_t>(std::min<std::size_t>(kMostDigitBits, std::bit_width(entries_.size())));
    const std::uint32_t digits = 1u << digit_bits;
    std::array<std::uint32_t, (1u << kMostDigitBits) + 1> begin;
    for (std::uint32_t shift = 0; shift < 32 && used >> shift != 0; shift += digit_bits) {
        std::fill_n(begin.begin(), digits + 1, 0u);
        for (const Entry& e : entries_) ++begin[(e.code >> shift & (digits - 1)) + 1];
        for (std::size_t d = 0; d < digits; ++d) begin[d + 1] += begin[d];
        for (const Entry& e : entries_) buffer_[begin[e.code >> shift & (digits - 1)]++] = e;
        std::swap(entries_, buffer_);
    }
}

}  // namespace crofton::triangulate
