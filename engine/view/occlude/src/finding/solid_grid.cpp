// SPDX-License-Identifier: MIT
#include "finding/solid_grid.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/vector_relational.hpp>

namespace crofton::occlude {
namespace {

// Where the line along x through (y, z) crosses the triangle: sign of the crossing, 0 for none, and its x. Half-open,
// as winding_around().
int crossing_along_x(const Triangle& t, double y, double z, double& x) {
    bool covers = false;
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec3 &p = t[k], &q = t[(k + 1) % 3];
        if ((p.z > z) == (q.z > z)) continue;
        const glm::dvec3 &lower = p.z < q.z ? p : q, &upper = p.z < q.z ? q : p;
        covers ^= (upper.y - lower.y) * (z - lower.z) - (upper.z - lower.z) * (y - lower.y) > 0.0;
    }
    if (!covers) return 0;
    const glm::dvec3 u = t[1] - t[0], v = t[2] - t[0];
    const glm::dvec3 n(u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x);
    if (n.x == 0.0) return 0;
    x = t[0].x - (n.y * (y - t[0].y) + n.z * (z - t[0].z)) / n.x;
    return n.x > 0.0 ? 1 : -1;
}

// std::popcount is a call where the baseline instruction set has none.
std::uint32_t count_bits(std::uint32_t bits) {
    bits -= bits >> 1 & 0x55555555u;
    bits = (bits & 0x33333333u) + (bits >> 2 & 0x33333333u);
    return ((bits + (bits >> 4)) & 0x0f0f0f0fu) * 0x01010101u >> 24;
}

std::uint32_t bits_between(std::uint32_t low, std::uint32_t high) {  // low to high, both included
    return (~std::uint32_t{0} >> (31 - (high - low))) << low;
}

}  // namespace

SolidGrid::SolidGrid(const FramedPiece& piece, Sides sides, std::uint32_t cells)
    : n_(cells),
      low_(piece.low),
      cell_((piece.high - piece.low) / static_cast<double>(cells)),
      free_(cells * cells, 0),
      covered_(cells * cells, 0),
      sums_(std::size_t{cells + 1} * (cells + 1) * (cells + 1), 0) {
    if (!(cell_.x > 0.0 && cell_.y > 0.0 && cell_.z > 0.0)) return;
    fill_inside(piece, sides);
    mark_surface(piece);
    count_uncovered();
}

std::uint32_t SolidGrid::cell_at(int axis, double coordinate) const {
    const double at = (coordinate - low_[axis]) / cell_[axis];
    return at > 0.0 ? std::min(static_cast<std::uint32_t>(at), n_ - 1) : 0;
}

void SolidGrid::fill_inside(const FramedPiece& piece, Sides sides) {
    // By row and cell: the change of the winding number by crossings right after the cell's centre.
    Vector<std::int32_t> steps(std::size_t{n_} * n_ * (n_ + 1), 0);
    for (const Triangle& t : piece.triangles) {
        const glm::dvec3 low = glm::min(t[0], glm::min(t[1], t[2])), high = glm::max(t[0], glm::max(t[1], t[2]));
        const std::uint32_t y1 = cell_at(1, high.y), z1 = cell_at(2, high.z);
        for (std::uint32_t z = cell_at(2, low.z); z <= z1; ++z)
            for (std::uint32_t y = cell_at(1, low.y); y <= y1; ++y) {
                double x = 0.0;
                const int sign = crossing_along_x(t, low_.y + (y + 0.5) * cell_.y, low_.z + (z + 0.5) * cell_.z, x);
                if (sign == 0) continue;
                const double before = std::floor((x - low_.x) / cell_.x + 0.5);  // centres below x
                const auto at = static_cast<std::size_t>(std::clamp(before, 0.0, static_cast<double>(n_)));
                steps[(std::size_t{z} * n_ + y) * (n_ + 1) + at] += sides == Sides::front ? sign : 1;
            }
    }
    for (std::uint32_t z = 0; z < n_; ++z)
        for (std::uint32_t y = 0; y < n_; ++y) {
            std::int32_t winding = 0;
            for (std::uint32_t x = n_; x-- > 0;) {
                winding += steps[(std::size_t{z} * n_ + y) * (n_ + 1) + x + 1];
                const bool inside = sides == Sides::front ? winding > 0 : winding % 2 != 0;
                if (inside) row(y, z) |= 1u << x;
            }
        }
}

void SolidGrid::mark_surface(const FramedPiece& piece) {
    for (const Triangle& t : piece.triangles) {
        const glm::dvec3 low = glm::min(t[0], glm::min(t[1], t[2])), high = glm::max(t[0], glm::max(t[1], t[2]));
        const std::uint32_t y0 = cell_at(1, low.y), y1 = cell_at(1, high.y), z0 = cell_at(2, low.z),
                            z1 = cell_at(2, high.z);
        for (std::uint32_t z = z0; z <= z1; ++z) {
            CutPolygon layer(t);
            if (z > z0) layer.keep(2, low_.z + z * cell_.z, -1);
            if (z < z1) layer.keep(2, low_.z + (z + 1) * cell_.z, 1);
            for (std::uint32_t y = y0; y <= y1; ++y) {
                CutPolygon part = layer;
                if (y > y0) part.keep(1, low_.y + y * cell_.y, -1);
                if (y < y1) part.keep(1, low_.y + (y + 1) * cell_.y, 1);
                if (part.corners().empty()) continue;
                double from = high.x, to = low.x;
                for (const glm::dvec3& p : part.corners()) {
                    from = std::min(from, p.x);
                    to = std::max(to, p.x);
                }
                row(y, z) &= ~bits_between(cell_at(0, from), cell_at(0, std::max(from, to)));
            }
        }
    }
}

void SolidGrid::count_uncovered() {
    for (std::uint32_t z = 0; z < n_; ++z)
        for (std::uint32_t y = 0; y < n_; ++y) {
            const std::uint32_t bits = free_[z * n_ + y] & ~covered_[z * n_ + y];
            std::uint32_t count = 0;
            for (std::uint32_t x = 0; x < n_; ++x) {
                count += bits >> x & 1u;
                sums_[sum_at(x + 1, y + 1, z + 1)] = count + sums_[sum_at(x + 1, y, z + 1)] +
                                                     sums_[sum_at(x + 1, y + 1, z)] - sums_[sum_at(x + 1, y, z)];
            }
        }
}

std::uint32_t SolidGrid::uncovered(const std::uint32_t (&low)[3], const std::uint32_t (&high)[3]) const {
    const auto below = [&](std::uint32_t y, std::uint32_t z) {
        return sums_[sum_at(high[0], y, z)] - sums_[sum_at(low[0], y, z)];
    };
    return below(high[1], high[2]) - below(low[1], high[2]) - below(high[1], low[2]) + below(low[1], low[2]);
}

// All ranges of y and z, cut short where no cell is left; of the cells free in all rows each run of neighbours.
FrameBox SolidGrid::best_box(double least) const {
    double best = least;
    std::uint32_t best_low[3] = {0, 0, 0}, best_high[3] = {0, 0, 0};
    const auto shadow = [&](double a, double b, double c) {
        return 0.5 * (a * b * cell_.x * cell_.y + b * c * cell_.y * cell_.z + c * a * cell_.z * cell_.x);
    };
    std::uint32_t rows[kMaxCells];
    for (std::uint32_t z0 = 0; z0 < n_; ++z0) {
        std::copy_n(&free_[z0 * n_], n_, rows);
        for (std::uint32_t z1 = z0; z1 < n_; ++z1) {
            std::uint32_t any = 0;
            for (std::uint32_t y = 0; y < n_; ++y) any |= rows[y] &= free_[z1 * n_ + y];
            if (any == 0) break;
            for (std::uint32_t y0 = 0; y0 < n_; ++y0) {
                std::uint32_t common = rows[y0];
                for (std::uint32_t y1 = y0; y1 < n_ && (common &= rows[y1]) != 0; ++y1) {
                    const double most = shadow(count_bits(common), y1 + 1 - y0, z1 + 1 - z0);
                    if (most <= best) continue;
                    for (std::uint32_t bits = common; bits != 0;) {
                        const auto x0 = static_cast<std::uint32_t>(std::countr_zero(bits));
                        const auto x1 = x0 + static_cast<std::uint32_t>(std::countr_one(bits >> x0));
                        bits = x1 < 32 ? bits >> x1 << x1 : 0;
                        const std::uint32_t low[3] = {x0, y0, z0}, high[3] = {x1, y1 + 1, z1 + 1};
                        const double value = shadow(x1 - x0, y1 + 1 - y0, z1 + 1 - z0);
                        if (value <= best) continue;
                        const double cells = static_cast<double>((x1 - x0) * (y1 + 1 - y0) * (z1 + 1 - z0));
                        const double weighted = value * uncovered(low, high) / cells;
                        if (weighted <= best) continue;
                        best = weighted;
                        std::copy_n(low, 3, best_low);
                        std::copy_n(high, 3, best_high);
                    }
                }
            }
        }
    }
    const auto position = [&](const std::uint32_t(&at)[3]) { return low_ + cell_ * glm::dvec3(at[0], at[1], at[2]); };
    return {position(best_low), position(best_high)};
}

void SolidGrid::cover(const FrameBox& box) {
    for (std::uint32_t z = 0; z < n_; ++z)
        for (std::uint32_t y = 0; y < n_; ++y)
            for (std::uint32_t x = 0; x < n_; ++x) {
                const glm::dvec3 p = low_ + cell_ * (glm::dvec3(x, y, z) + 0.5);
                if (glm::all(glm::greaterThan(p, box.low)) && glm::all(glm::lessThan(p, box.high)))
                    covered_[z * n_ + y] |= 1u << x;
            }
    count_uncovered();
}

}  // namespace crofton::occlude
