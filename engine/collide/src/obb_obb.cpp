#include <algorithm>
#include <bit>
#include <cmath>
#include <crofton/collide/obb_obb.hpp>
#include <crofton/geometry/expansion.hpp>
#include <cstdint>
#include <limits>

#include "box_pair.hpp"
#include "float_pair.hpp"

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

// (p, q) of the 15 axes: generators 0-2 are the axes of a, 3-5 those of b.
struct GeneratorPair {
    std::uint8_t p, q;
};
constexpr GeneratorPair kAxes[kAxisCount] = {{1, 2}, {2, 0}, {0, 1}, {4, 5}, {5, 3}, {3, 4}, {0, 3}, {0, 4},
                                             {0, 5}, {1, 3}, {1, 4}, {1, 5}, {2, 3}, {2, 4}, {2, 5}};

enum class Answer : std::uint8_t { separated, overlapping, unknown };

// n is exact up to one rounding per component, because products of two floats are exact in double. With u = 2^-53,
// T carries one rounding, T·n three more and the two of its sum: |error| ≤ 6u Σ|T_i n_i|. Each g·n carries
// 4 roundings, times h one, summing four at most 3: |error| ≤ 9u Σ h Σ|g_i n_i|; the last subtraction adds u of the
// difference. With W = |T| + Σ h |g| (componentwise) all stay below 16u·(|n|·W), the bound's own 8 roundings included.
// Underflow adds at most 1e-300: axes are floats, so no product without T can underflow.
Answer filter(const BoxPair& pair, const GeneratorPair axis) {
    const glm::dvec3 n = glm::cross(pair.edge[axis.p], pair.edge[axis.q]);
    if (n.x == 0.0 && n.y == 0.0 && n.z == 0.0) return Answer::overlapping;  // exactly zero: parallel edges
    double reach = 0.0;
    for (int k = 0; k < 6; ++k)
        if (k != axis.p && k != axis.q) reach += pair.half[k] * std::abs(glm::dot(pair.edge[k], n));
    const double gap = std::abs(glm::dot(pair.offset, n)) - reach;
    const double error = 0x1p-49 * glm::dot(glm::abs(n), pair.magnitude) + 1e-300;
    if (gap > error) return Answer::separated;
    return gap < -error ? Answer::overlapping : Answer::unknown;
}

using Exact3 = std::array<Expansion<2>, 3>;

Exact3 exact_cross(const glm::dvec3& a, const glm::dvec3& b) {
    const auto component = [&](int i, int j) { return exact(a[i] * b[j]) - exact(a[j] * b[i]); };
    return {component(1, 2), component(2, 0), component(0, 1)};
}

// Scaling by 2^600 keeps every product of the terms within the range that Expansion asks for: offsets may be as small
// as 2^-1074 and as large as 2e30, components of n are 0 or in [1e-90, 2], and extents in [1e-45, 1e30].
bool separated_exactly(const BoxPair& pair, const GeneratorPair axis) {
    constexpr double kScale = 0x1p600;
    const Exact3 n = exact_cross(pair.edge[axis.p], pair.edge[axis.q]);
    const auto offset_along = [&](int i) {
        return (exact_difference(pair.center_b[i], pair.center_a[i]) * kScale) * n[static_cast<std::size_t>(i)];
    };
    auto distance = offset_along(0) + offset_along(1) + offset_along(2);
    if (distance.sign() < 0) distance = -distance;
    Expansion<24> reach[4];
    std::size_t count = 0;
    for (int k = 0; k < 6; ++k) {
        if (k == axis.p || k == axis.q) continue;
        const glm::dvec3& g = pair.edge[k];
        reach[count] = (n[0] * g.x + n[1] * g.y + n[2] * g.z) * (pair.half[k] * kScale);
        if (reach[count].sign() < 0) reach[count] = -reach[count];
        ++count;
    }
    return (distance - ((reach[0] + reach[1]) + (reach[2] + reach[3]))).sign() > 0;
}

constexpr int kUndecided = -2;

// Clear cases only: the first axis that surely separates them (some such axis unless kWhich), or none; else `open` has
// a bit for every axis that may separate.
template <bool kWhich>
int decide_roughly(const Obb& first, const Obb& second, std::uint32_t& open) {
    FloatPair pair(first, second);
    const auto separates = [&](Lanes4 gap, int at, float error) {
        if (!(largest3(gap) > error)) return kUndecided;
        if constexpr (!kWhich) return at;
        return at + (gap[0] > error ? 0 : gap[1] > error ? 1 : 2);
    };
    const float most = pair.size * (kRounding + 2.0f * kPerDeviation * static_cast<float>(kMaxAxisDeviation)) + 1e-36f;
    if (const int axis = separates(pair.face_a, 0, most); axis != kUndecided) return axis;
    pair.face_normals_of_b();
    if (const int axis = separates(pair.face_b, 3, most); axis != kUndecided) return axis;
    pair.edges();
    const float error = pair.size * pair.share + 1e-36f;
    const Lanes4 gap[] = {pair.face_a, pair.face_b, pair.edge[0], pair.edge[1], pair.edge[2]};
    Lanes4 doubtful[] = {pair.face_a, pair.face_b, {}, {}, {}};
    for (int i = 0; i < 3; ++i) doubtful[2 + i] = smaller(pair.edge[i], pair.parallel[i]);
    const Lanes4 worst =
        larger(larger(larger(doubtful[0], doubtful[1]), larger(doubtful[2], doubtful[3])), doubtful[4]);
    if (largest3(worst) < -error) return kNotSeparated;
    for (int i = 0; i < 5; ++i)
        if (const int axis = separates(gap[i], 3 * i, error); axis != kUndecided) return axis;
    for (int i = 0; i < kAxisCount; ++i)
        if (!(doubtful[i / 3][i % 3] < -error)) open |= 1u << i;
    return kUndecided;
}

}  // namespace

BoxPair::BoxPair(const Obb& a, const Obb& b) : center_a(a.center), center_b(b.center), offset(b.center - a.center) {
    magnitude = glm::abs(offset);
    for (int k = 0; k < 6; ++k) {
        const Obb& box = k < 3 ? a : b;
        edge[k] = glm::dvec3(box.axes[k % 3]);
        half[k] = static_cast<double>(box.half_extents[k % 3]);
        magnitude += half[k] * glm::abs(edge[k]);
    }
}

namespace {

// The first of the axes in `open` that separates, those that double can tell before those that it cannot.
int decide_carefully(const Obb& a, const Obb& b, std::uint32_t open) {
    const BoxPair pair(a, b);
    if (!(pair.magnitude.x + pair.magnitude.y + pair.magnitude.z < std::numeric_limits<double>::infinity())) return 0;
    std::uint32_t unknown = 0;
    for (; open != 0; open &= open - 1) {
        const int i = std::countr_zero(open);
        const Answer answer = filter(pair, kAxes[i]);
        if (answer == Answer::separated) return i;
        if (answer == Answer::unknown) unknown |= 1u << i;
    }
    for (; unknown != 0; unknown &= unknown - 1)
        if (const int i = std::countr_zero(unknown); separated_exactly(pair, kAxes[i])) return i;
    return kNotSeparated;
}

}  // namespace

int separating_axis(const Obb& a, const Obb& b, int hint) {
    if (hint >= 0 && hint < kAxisCount && filter(BoxPair(a, b), kAxes[hint]) == Answer::separated) return hint;
    std::uint32_t open = 0;
    const int axis = decide_roughly<true>(a, b, open);
    return axis == kUndecided ? decide_carefully(a, b, open) : axis;
}

bool intersects(const Obb& a, const Obb& b) {
    std::uint32_t open = 0;
    const int axis = decide_roughly<false>(a, b, open);
    return (axis == kUndecided ? decide_carefully(a, b, open) : axis) == kNotSeparated;
}

}  // namespace crofton::collide
