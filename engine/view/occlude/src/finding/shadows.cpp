// SPDX-License-Identifier: MIT
#include "finding/shadows.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace crofton::occlude {
namespace {

std::array<glm::dvec3, kShadowAxes> shadow_axes() {
    std::array<glm::dvec3, kShadowAxes> axes{glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)};
    const double golden = 0.5 * (1.0 + std::sqrt(5.0));
    std::size_t count = 3;
    for (int turn = 0; turn < 3; ++turn)
        for (const double s : {1.0, -1.0})
            for (const double t : {1.0, -1.0}) {
                const double size[3] = {0.5 * golden, 0.5 * s, 0.5 * t / golden};
                glm::dvec3& axis = axes[count++];
                for (int k = 0; k < 3; ++k) axis[(k + turn) % 3] = size[k];
            }
    return axes;
}

// Cells whose centres lie in [low, high).
std::uint64_t bits_of_span(double low, double high) {
    constexpr double kMost = kShadowRows;
    const double first = std::clamp(std::ceil(low - 0.5), 0.0, kMost),
                 end = std::clamp(std::ceil(high - 0.5), 0.0, kMost);
    if (!(first < end)) return 0;
    const auto from = static_cast<unsigned>(first), count = static_cast<unsigned>(end - first);
    return (~std::uint64_t{0} >> (64 - count)) << from;
}

// Set bits of 64 words beyond those of others. std::popcount is a call where the baseline instruction set has none;
// counts by bytes are added up over sixteen words at a time.
std::uint32_t count_beyond(const std::uint64_t* bits, const std::uint64_t* covered) {
    std::uint64_t sum = 0;
    for (std::size_t begin = 0; begin < kShadowRows; begin += 16) {
        std::uint64_t bytes = 0;
        for (std::size_t r = begin; r < begin + 16; ++r) {
            std::uint64_t word = bits[r] & ~covered[r];
            word -= word >> 1 & 0x5555555555555555u;
            word = (word & 0x3333333333333333u) + (word >> 2 & 0x3333333333333333u);
            bytes += (word + (word >> 4)) & 0x0f0f0f0f0f0f0f0fu;
        }
        sum += (bytes & 0x00ff00ff00ff00ffu) + (bytes >> 8 & 0x00ff00ff00ff00ffu);
    }
    return static_cast<std::uint32_t>(sum * 0x0001000100010001u >> 48);
}

void draw_rows(const std::array<glm::dvec2, 3>& corner, std::uint64_t* rows) {
    const double low = std::min({corner[0].y, corner[1].y, corner[2].y});
    const double high = std::max({corner[0].y, corner[1].y, corner[2].y});
    const double first = std::max(std::ceil(low - 0.5), 0.0);
    const double end = std::min(std::ceil(high - 0.5), static_cast<double>(kShadowRows));
    for (double row = first; row < end; row += 1.0) {
        const double y = row + 0.5;
        double from = 1e300, to = -1e300;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec2 &p = corner[k], &q = corner[(k + 1) % 3];
            if ((p.y > y) == (q.y > y)) continue;
            const double x = p.x + (q.x - p.x) * ((y - p.y) / (q.y - p.y));
            from = std::min(from, x);
            to = std::max(to, x);
        }
        rows[static_cast<std::size_t>(row)] |= bits_of_span(from, to);
    }
}

}  // namespace

ShadowCaster::ShadowCaster(const Aabb& bounds) : origin_(bounds.center()), views_() {
    const auto axes = shadow_axes();
    const glm::dvec3 half = glm::max(bounds.half_extents(), glm::dvec3(1e-300));
    for (std::size_t i = 0; i < kShadowAxes; ++i) {
        View& view = views_[i];
        glm::dvec3 other(0.0);
        other[std::abs(axes[i].x) < 0.5 ? 0 : (std::abs(axes[i].y) < 0.5 ? 1 : 2)] = 1.0;
        view.right = glm::normalize(glm::cross(other, axes[i]));
        view.up = glm::cross(axes[i], view.right);
        const double wide = 2.0 * glm::dot(glm::abs(view.right), half), high = 2.0 * glm::dot(glm::abs(view.up), half);
        const double cells = static_cast<double>(kShadowRows);
        view.cell_area = (wide / cells) * (high / cells);
        view.right *= cells / wide;
        view.up *= cells / high;
        view.low = glm::dvec2(-0.5 * cells);
    }
}

void ShadowCaster::draw(const Triangle& triangle, bool front_only, ShadowBits& bits) const {
    const std::array<glm::dvec3, 3> at{triangle[0] - origin_, triangle[1] - origin_, triangle[2] - origin_};
    for (std::size_t i = 0; i < kShadowAxes; ++i) {
        const View& view = views_[i];
        std::array<glm::dvec2, 3> corner;
        for (std::size_t k = 0; k < 3; ++k)
            corner[k] = glm::dvec2(glm::dot(view.right, at[k]), glm::dot(view.up, at[k])) - view.low;
        const glm::dvec2 u = corner[1] - corner[0], v = corner[2] - corner[0];
        const double turn = u.x * v.y - u.y * v.x;
        std::uint64_t* const rows = &bits.rows[2 * i * kShadowRows];
        if (turn > 0.0 || (!front_only && turn < 0.0)) draw_rows(corner, rows);
        if (turn < 0.0 || (!front_only && turn > 0.0)) draw_rows(corner, rows + kShadowRows);
    }
}

double ShadowCaster::mean_area(const ShadowBits& bits) const {
    return mean_area_beyond(bits, ShadowBits{});
}

double ShadowCaster::mean_area_beyond(const ShadowBits& bits, const ShadowBits& covered) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < kShadowAxes; ++i) {
        const std::size_t at = 2 * i * kShadowRows;
        const std::uint32_t count = count_beyond(&bits.rows[at], &covered.rows[at]) +
                                    count_beyond(&bits.rows[at + kShadowRows], &covered.rows[at + kShadowRows]);
        sum += count * views_[i].cell_area;
    }
    return sum / (2.0 * kShadowAxes);
}

}  // namespace crofton::occlude
