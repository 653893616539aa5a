// SPDX-License-Identifier: MIT
#include "bounds.hpp"

#include <crofton/geometry/float_lanes.hpp>

#include <algorithm>
#include <cmath>

namespace crofton::boxtree {
namespace {

constexpr double kMost = 32767.0;
constexpr int kLeastExponent = -100;  // units stay normal numbers, and so do their products

// The nearest integer for |value| < 2^51: adding 1.5 · 2^52 leaves no fraction.
double nearest(double value) {
    return (value + 0x1.8p52) - 0x1.8p52;
}

// The least power of two that is at least value / 2^bits, in float.
float unit_for(double value, int bits) {
    int exponent = 0;
    std::frexp(value, &exponent);  // value < 2^exponent
    return std::ldexp(1.0f, std::max(exponent - bits, kLeastExponent));
}

bool is_unit(float unit) {
    int exponent = 0;
    return std::frexp(unit, &exponent) == 0.5f && exponent - 1 >= kLeastExponent && exponent < 120;
}

// How many edge_units a position_unit is, as a power of two.
int edge_shift_of(const Leaf& leaf) {
    return std::min(31, std::ilogb(leaf.position_unit) - std::ilogb(leaf.edge_unit));
}

constexpr int kEmptyHalf = -32767;  // of an empty lane

// By shifts, which vectors have.
void unpack(const Int16x2 (&pairs)[kWidth], int (&lower)[kWidth], int (&upper)[kWidth]) {
    for (unsigned lane = 0; lane < kWidth; ++lane) {
        lower[lane] = static_cast<int>(pairs[lane] << 16) >> 16;
        upper[lane] = static_cast<int>(pairs[lane]) >> 16;
    }
}

}  // namespace

void clear(Node& node) {
    node = {};
    node.parent = kNone;
    node.layers_every = ~std::uint32_t{0};
    std::fill_n(node.middle_half_z, kWidth, pair_of(0, kEmptyHalf));
    std::fill_n(node.half_xy, kWidth, pair_of(kEmptyHalf, kEmptyHalf));
    std::fill_n(node.child, kWidth, kNone);
}

void clear(Leaf& leaf) {
    leaf = {};
    leaf.parent = kNone;
}

void clear_lane(Leaf& leaf, unsigned lane) {
    leaf.xy[lane] = leaf.z_edge2_z[lane] = leaf.edge01_z[lane] = 0;
    for (auto& row : leaf.edge_xy) row[lane] = 0;
    leaf.layers[lane] = 0;
}

void clear_lane(Node& node, unsigned lane) {
    (void)write_lane(node, lane, Aabb{}, Axes{});
    node.child[lane] = kNone;
    node.layers_any[lane] = node.layers_all[lane] = 0;
}

// A rebuild may still read a box that keep_box() was given, whose half extents have other signs.
double longest_edge(const Obb& box) {
    double longest = 0.0;
    for (int k = 0; k < 3; ++k) longest = std::max(longest, std::abs(double{box.half_extents[k]}));
    return longest * (1.0 + kMaxAxisDeviation);
}

void fit_frame(Leaf& leaf, const Aabb& centers, double longest) {
    double farthest = 0.0;
    for (int j = 0; j < 3; ++j) {
        leaf.origin[j] = centers.is_empty() ? 0.0 : centers.center()[j];
        if (!centers.is_empty()) farthest = std::max(farthest, centers.half_extents()[j]);
    }
    leaf.edge_unit = unit_for(longest * (32768.0 / 32766.0), 15);
    leaf.position_unit = std::max(leaf.edge_unit, unit_for(farthest, 14));  // boxes may move as far again
    leaf.per_quantum = 0x1p14f / leaf.position_unit;
    leaf.edge_shift = edge_shift_of(leaf);
    leaf.l1_radius = 0.0f;
    leaf.rounding = rounding_of(leaf);
}

bool is_frame(const Leaf& leaf) {
    return is_unit(leaf.position_unit) && is_unit(leaf.edge_unit) && leaf.edge_unit <= leaf.position_unit &&
           leaf.per_quantum == 0x1p14f / leaf.position_unit && leaf.edge_shift == edge_shift_of(leaf) &&
           leaf.rounding == rounding_of(leaf);
}

bool write_lane(Leaf& leaf, unsigned lane, const Obb& box) {
    // Scaling by a power of two is exact, and so is a product of two floats in double.
    const double per_position = 1.0 / double{leaf.position_unit}, per_edge = 1.0 / double{leaf.edge_unit};
    double position[3], edge[9], l1_radius = 0.0;
    bool fits = true;
    for (int j = 0; j < 3; ++j) {
        position[j] = nearest((box.center[j] - leaf.origin[j]) * per_position);
        fits = fits && std::fabs(position[j]) <= kMost;
        l1_radius += std::fabs(position[j]);
    }
    for (int k = 0; k < 3; ++k) {
        const double half = double{box.half_extents[k]} * per_edge;
        for (int j = 0; j < 3; ++j) {
            edge[3 * k + j] = nearest(double{box.axes[k][j]} * half);
            fits = fits && std::fabs(edge[3 * k + j]) <= kMost;
        }
    }
    if (!fits) return false;
    const auto pair = [](double lower, double upper) {
        return pair_of(static_cast<int>(lower), static_cast<int>(upper));
    };
    leaf.xy[lane] = pair(position[0], position[1]);
    leaf.z_edge2_z[lane] = pair(position[2], edge[8]);
    leaf.edge01_z[lane] = pair(edge[2], edge[5]);
    for (int k = 0; k < 3; ++k) leaf.edge_xy[k][lane] = pair(edge[3 * k], edge[3 * k + 1]);
    leaf.l1_radius = std::max(leaf.l1_radius, static_cast<float>(l1_radius) * leaf.position_unit);  // exact: below 2^17
    leaf.rounding = rounding_of(leaf);
    return true;
}

void write_layers(Leaf& leaf, unsigned lane, std::uint32_t layers) {
    leaf.layers[lane] = layers;
    leaf.layers_every = ~std::uint32_t{0};
    for (unsigned i = 0; i < leaf.count; ++i) leaf.layers_every &= leaf.layers[i];
}

void write_layers(Node& node, unsigned lane, const std::uint32_t* any, const std::uint32_t* all, std::uint32_t count) {
    std::uint32_t some = 0, every = ~std::uint32_t{0};
    for (std::uint32_t i = 0; i < count; ++i) {
        some |= any[i];
        every &= all[i];
    }
    node.layers_any[lane] = some;
    node.layers_all[lane] = every;
}

namespace {

double size_of(const double* vector) {
    return std::fabs(vector[0]) + std::fabs(vector[1]) + std::fabs(vector[2]);
}

// An error bound of bounds along the axes, relative to the node's origin.
double error_bound_of(const Axes& axes, const Node& node, const Aabb& bounds) {
    return axes.rounding * (size_of(node.origin) + size_of(&bounds.min.x) + size_of(&bounds.max.x));
}

}  // namespace

void fit_frame(Node& node, const Aabb& whole, const Axes& axes) {
    double farthest = 0.0;
    for (int j = 0; j < 3; ++j) node.origin[j] = 0.0;
    if (!whole.is_empty()) {
        const glm::dvec3 center = whole.center();
        for (unsigned k = 0; k < 3; ++k)
            for (int j = 0; j < 3; ++j) node.origin[j] += axes.rows[k][j] * center[static_cast<int>(k)];
        for (int j = 0; j < 3; ++j) farthest = std::max(farthest, whole.half_extents()[j]);
        farthest += 2.0 * error_bound_of(axes, node, whole);
    }
    node.unit = unit_for(farthest, 14);  // as far again is left for roundings and moves
    node.per_quantum = 0x1p14f / node.unit;
    node.l1_radius = 0.0f;
    node.rounding = rounding_of(node);
}

bool is_frame(const Node& node) {
    return is_unit(node.unit) && node.per_quantum == 0x1p14f / node.unit && node.rounding == rounding_of(node);
}

bool write_lane(Node& node, unsigned lane, const Aabb& bounds, const Axes& axes) {
    int middle[3] = {}, half[3] = {kEmptyHalf, kEmptyHalf, kEmptyHalf}, l1_radius = 0;
    if (!bounds.is_empty()) {
        const double per_unit = 1.0 / double{node.unit}, error_bound = error_bound_of(axes, node, bounds);
        for (int j = 0; j < 3; ++j) {
            const double origin = along(axes, static_cast<unsigned>(j), node.origin);
            const double from = (bounds.min[j] - origin - error_bound) * per_unit,
                         to = (bounds.max[j] - origin + error_bound) * per_unit;
            // Half a unit outward, then to the nearest; the 0.01 is for the roundings, 2^-38 units at most.
            const double low = nearest(from - 0.51), high = nearest(to + 0.51);
            if (!(std::fabs(low) < kMost && std::fabs(high) < kMost)) return false;
            const int first = static_cast<int>(low), last = static_cast<int>(high);
            middle[j] = (first + last) / 2;
            half[j] = std::max(last - middle[j], middle[j] - first);
            l1_radius += std::abs(middle[j]) + half[j];
        }
    }
    node.middle_xy[lane] = pair_of(middle[0], middle[1]);
    node.middle_half_z[lane] = pair_of(middle[2], half[2]);
    node.half_xy[lane] = pair_of(half[0], half[1]);
    node.l1_radius = std::max(node.l1_radius, static_cast<float>(l1_radius) * node.unit);  // exact: below 2^17
    node.rounding = rounding_of(node);
    return true;
}

// Relative to the origin; grown by the rounding of the sums.
Aabb around(const Axes& axes, const double* origin, const double (&low)[3], const double (&high)[3], double rounding) {
    const double off = rounding * (size_of(origin) + size_of(low) + size_of(high));
    Aabb result;
    for (int j = 0; j < 3; ++j) {
        const double middle = along(axes, static_cast<unsigned>(j), origin);
        const double error_bound = (std::fabs(middle) + std::fabs(low[j]) + std::fabs(high[j])) * 0x1p-52 + off;
        result.min[j] = middle + low[j] - error_bound;
        result.max[j] = middle + high[j] + error_bound;
    }
    return result;
}

Aabb bounds_of_lane(const Node& node, unsigned lane, const Axes& axes) {
    if (half_of(node, lane, 0) < 0) return {};
    double low[3], high[3];
    for (unsigned j = 0; j < 3; ++j) {
        low[j] = double{node.unit} * low_of(node, lane, j);
        high[j] = double{node.unit} * high_of(node, lane, j);
    }
    return around(axes, node.origin, low, high, axes.rounding);
}

ChildEnds ends_of(const Node& node) {
    int middle[3][kWidth], half[3][kWidth];
    unpack(node.middle_xy, middle[0], middle[1]);
    unpack(node.middle_half_z, middle[2], half[2]);
    unpack(node.half_xy, half[0], half[1]);
    ChildEnds ends;
    for (unsigned j = 0; j < 3; ++j)
        for (unsigned lane = 0; lane < kWidth; ++lane) {
            ends.low[j][lane] = static_cast<float>(middle[j][lane] - half[j][lane]);
            ends.high[j][lane] = static_cast<float>(middle[j][lane] + half[j][lane]);
        }
    return ends;
}

Aabb bounds_of(const Node& node, const Axes& axes) {
    const ChildEnds ends = ends_of(node);
    double low[3], high[3];
    for (unsigned j = 0; j < 3; ++j) {
        const auto lanes = [](const float* from) { return detail::load4(reinterpret_cast<const char*>(from)); };
        detail::Lanes4 least = lanes(ends.low[j]), most = lanes(ends.high[j]);
        for (unsigned lane = 4; lane < kWidth; lane += 4) {
            least = detail::lesser(least, lanes(ends.low[j] + lane));
            most = detail::larger(most, lanes(ends.high[j] + lane));
        }
        const float first = std::min(std::min<float>(least[0], least[1]), std::min<float>(least[2], least[3])),
                    last = std::max(std::max<float>(most[0], most[1]), std::max<float>(most[2], most[3]));
        if (first > last) return {};
        low[j] = double{node.unit} * double{first};
        high[j] = double{node.unit} * double{last};
    }
    return around(axes, node.origin, low, high, axes.rounding);
}

Aabb bounds_of(const Leaf& leaf, const LeafExtent& extent) {
    if (leaf.count == 0) return {};
    // Positions are within half a unit of the truth (and the difference's rounding, 2^-38 units), and so is each of the
    // three edges' components.
    const double error_bound = 0.51 * double{leaf.position_unit} + 1.51 * double{leaf.edge_unit};
    double low[3], high[3];
    for (int j = 0; j < 3; ++j) {
        low[j] = double{extent.low[j]} - std::fabs(double{extent.low[j]}) * 0x1p-23 - error_bound;
        high[j] = double{extent.high[j]} + std::fabs(double{extent.high[j]}) * 0x1p-23 + error_bound;
    }
    return around(Axes{}, leaf.origin, low, high, 0.0);
}

Aabb bounds_of(const Leaf& leaf) {
    const LeafId first = 0;
    LeafExtent extent;
    leaf_extents(&leaf, std::span(&first, 1), &extent);
    return bounds_of(leaf, extent);
}

}  // namespace crofton::boxtree
