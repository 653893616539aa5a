// SPDX-License-Identifier: MIT
#include <array>
#include <bit>
#include <cmath>
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/geometry/expansion.hpp>
#include <cstdint>
#include <cstring>
#include <glm/geometric.hpp>
#include <limits>

#include "block_filter.hpp"
#include "careful_axis.hpp"
#include "float_pair.hpp"
#include "integer_axis.hpp"

// Why fifteen axes suffice, for stored axes that are only nearly orthonormal and extents that may be zero.
// The boxes meet iff T = center_b − center_a lies in the zonotope Z = { Σ t_k h_k g_k : |t_k| ≤ 1 } of the six
// generators g (three axes of each box) with extents h. Let every h_k be positive: since the axes of one box are
// linearly independent Z has an interior, and each of its facets is spanned by two generators, so T ∈ Z iff
//     |T·n| ≤ Σ h_k |g_k·n|   for the 15 products n = g_p × g_q (those that vanish say 0 ≤ 0).
// For extents that may be zero, let Z_ε have h_k + ε: Z is the intersection of all Z_ε, ε > 0, by compactness, and the
// condition for all ε > 0 is the condition for ε = 0, by continuity. Face normals have to be the cross products of the
// stored edges, not the third edge, because the stored edges are not exactly perpendicular.
namespace crofton::collide {
namespace {

// The boxes as the exact tier reads them.
struct BoxPair {
    BoxPair(const Obb& a, const Obb& b) : center_a(a.center), center_b(b.center) {
        for (int k = 0; k < 6; ++k) {
            const Obb& box = k < 3 ? a : b;
            edge[k] = glm::dvec3(box.axes[k % 3]);
            half[k] = static_cast<double>(box.half_extents[k % 3]);
        }
    }
    glm::dvec3 center_a, center_b;
    glm::dvec3 edge[6];  // axes of a, then of b: exact
    double half[6];
};

using ExactNormal = std::array<Expansion<2>, 3>;

ExactNormal exact_cross(const glm::dvec3& a, const glm::dvec3& b) {
    const auto component = [&](int i, int j) { return exact(a[i] * b[j]) - exact(a[j] * b[i]); };
    return {component(1, 2), component(2, 0), component(0, 1)};
}

// Scaling by 2^600 keeps every product of the terms within the range that Expansion asks for: offsets may be as small
// as 2^-1074 and as large as 2e30, components of n are 0 or in [1e-90, 2], and extents in [1e-45, 1e30].
bool separated_exactly(const BoxPair& pair, const GeneratorPair axis) {
    constexpr double kScale = 0x1p600;
    const ExactNormal n = exact_cross(pair.edge[axis.p], pair.edge[axis.q]);
    if (n[0].count + n[1].count + n[2].count == 0) return false;  // parallel edges
    const auto offset_along = [&](int i) {
        return (exact_difference(pair.center_b[i], pair.center_a[i]) * kScale) * n[static_cast<std::size_t>(i)];
    };
    auto distance = offset_along(0) + offset_along(1) + offset_along(2);
    if (distance.sign() < 0) distance = -distance;
    Expansion<24> radius_part[4];
    std::size_t count = 0;
    for (int k = 0; k < 6; ++k) {
        if (k == axis.p || k == axis.q) continue;
        const glm::dvec3& g = pair.edge[k];
        radius_part[count] = (n[0] * g.x + n[1] * g.y + n[2] * g.z) * (pair.half[k] * kScale);
        if (radius_part[count].sign() < 0) radius_part[count] = -radius_part[count];
        ++count;
    }
    return (distance - ((radius_part[0] + radius_part[1]) + (radius_part[2] + radius_part[3]))).sign() > 0;
}

bool all_finite(const PairColumns& pair) {
    Lanes4 sum = {};
    for (const float* column :
         {pair.a[0], pair.a[1], pair.a[2], pair.b[0], pair.b[1], pair.b[2], pair.half_a, pair.half_b})
        sum = sum + magnitude(load4(reinterpret_cast<const char*>(column)));
    const double offset = std::abs(pair.offset[0]) + std::abs(pair.offset[1]) + std::abs(pair.offset[2]);
    return lanes_where(sum < all_lanes(std::numeric_limits<float>::infinity())) == 7u &&
           offset < std::numeric_limits<double>::infinity();
}

int first_of(std::uint32_t axes) {
    return std::countr_zero(axes);
}

// Axes of the world, as a box has them that is not turned.
bool is_straight(const Obb& box) {
    static const glm::mat3 kStraight(1.0f);
    return std::memcmp(&box.axes, &kStraight, sizeof kStraight) == 0;
}

// Of two straight boxes, which often touch exactly: a sum of four numbers along each axis. Not finite: 0.
int separating_straight_axis(const Obb& a, const Obb& b) {
    for (int k = 0; k < 3; ++k) {
        const double half_a = static_cast<double>(a.half_extents[k]), half_b = static_cast<double>(b.half_extents[k]);
        const double rough = std::abs(b.center[k] - a.center[k]), sum = half_a + half_b;
        if (!(rough + sum < std::numeric_limits<double>::infinity())) return 0;
        if (rough < sum * (1.0 - 0x1p-50)) continue;
        if (rough > sum * (1.0 + 0x1p-50)) return k;
        // Without rounding, but for that of what is below the rounding of either sum.
        const auto apart = detail::two_sum(b.center[k], -a.center[k]), radius = detail::two_sum(half_a, half_b);
        const double low = (apart.high < 0.0 ? -apart.low : apart.low) - radius.low;
        if (apart.low == 0.0 || radius.low == 0.0) {
            if ((rough - sum) + low > 0.0) return k;
            continue;
        }
        Expansion<2> way = exact_difference(b.center[k], a.center[k]);
        if (way.sign() < 0) way = -way;
        if ((way - exact_sum(half_a, half_b)).sign() > 0) return k;
    }
    return kNotSeparated;
}

int careful_axis(const Obb& a, const Obb& b, const PairColumns& columns, int hint) {
    const AxisVerdicts verdicts = judge_axes(columns);
    if (verdicts.separated != 0)
        return hint >= 0 && (verdicts.separated >> hint & 1u) != 0 ? hint : first_of(verdicts.separated);
    if (verdicts.unknown == 0) return kNotSeparated;
    if (!all_finite(columns)) return 0;
    if (const int axis = first_separating(a, b, columns, verdicts.unknown); axis != kTooWide) return axis;
    const BoxPair pair(a, b);
    for (std::uint32_t unknown = verdicts.unknown; unknown != 0; unknown &= unknown - 1)
        if (const int axis = first_of(unknown); separated_exactly(pair, kGenerators[axis])) return axis;
    return kNotSeparated;
}

// The errors of block_filter.cpp, for axes as far from orthonormal as they may be: measuring them costs more than it
// settles. In float nearly parallel edges stay open, unless they are far apart.
constexpr float kMostError = kRounding + 2.0f * kPerDeviation * static_cast<float>(kMaxAxisDeviation);

// kWhich: the first of the groups of axes that have one that surely separates, and its first such axis; else any axis.
//
// Boxes that are not finite never meet here. Where an offset or extent is not finite, neither is the error. Where axis
// p of a is not, lanes i ≠ p of the last group of edges are NaN, as both the distance and the projected radius along
// the product of edges i and i + 2 are infinite or NaN; where axis q of b is not, lane q + 1 is. `larger` keeps the
// last one's NaN.
template <bool kWhich>
int axis_of(const Obb& a, const Obb& b) {
    const FloatPair pair(a, b);
    const Lanes4 error = pair.size * all_lanes(kMostError) + all_lanes(1e-36f);
    if (const unsigned lanes = lanes_where(larger(pair.face_a, pair.face_b) > error); lanes != 0) {
        if constexpr (!kWhich) return 0;
        const unsigned by_a = lanes_where(pair.face_a > error);
        return by_a != 0 ? first_of(by_a) : 3 + first_of(lanes);
    }
    const Lanes4 edges[3] = {pair.edges(0), pair.edges(1), pair.edges(2)};
    const Lanes4 worst = larger(larger(larger(pair.face_a, pair.face_b), edges[0]), larger(edges[1], edges[2]));
    if (lanes_where(worst < -error) == 7u) return kNotSeparated;
    if (lanes_where(worst > error) != 0) {
        if constexpr (!kWhich) return 0;
        const std::uint32_t lanes[5] = {0, 0, lanes_where(edges[0] > error), lanes_where(edges[1] > error),
                                        lanes_where(edges[2] > error)};
        return first_of(axis_set(lanes));
    }
    if (is_straight(a) && is_straight(b)) return separating_straight_axis(a, b);
    return careful_axis(a, b, columns_of(pair.a, pair.b, b.center - a.center), kNotSeparated);
}

}  // namespace

int careful_axis(const Obb& a, const Obb& b, int hint) {
    if (hint == kNotSeparated && is_straight(a) && is_straight(b)) return separating_straight_axis(a, b);
    return careful_axis(a, b, columns_of(FloatBox(a), FloatBox(b), b.center - a.center), hint);
}

int separating_axis(const Obb& a, const Obb& b, int hint) {
    return hint >= 0 && hint < kAxisCount ? careful_axis(a, b, hint) : axis_of<true>(a, b);
}

bool intersects(const Obb& a, const Obb& b) {
    return axis_of<false>(a, b) == kNotSeparated;
}

}  // namespace crofton::collide
