// SPDX-License-Identifier: MIT
// Lines side by side, traced through the tree as one beam. Included once per instruction set.
#if defined(CROFTON_RADIOSITY_BEAM) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_RADIOSITY_BEAM
#undef CROFTON_RADIOSITY_BEAM
#else
#define CROFTON_RADIOSITY_BEAM
#endif

#include <hwy/highway.h>
#include <bit>
#include <crofton/simd/mask_bits-inl.hpp>

#include "line_tests-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::radiosity::detail::HWY_NAMESPACE {

using DL = hn::CappedTag<float, 16>;  // of lines side by side

// Lines side by side, whose directions have one sign along `axis`. At the coordinate x along it each line is between
// low + slope · (x − from) and high + slope · (x − from) along the other two axes. The slope is some number in
// [slope_low, slope_high].
struct Beam {
    alignas(64) float point[3][kBeamLines], direction[3][kBeamLines], inverse[3][kBeamLines];
    std::size_t axis = 0;
    float from = 0.0f, low[3], high[3], slope_low[3], slope_high[3];
};

HWY_INLINE float size_of(float x) {
    return x < 0.0f ? -x : x;
}

// Of the scene's shadow: wider beams, which lines that have nothing in common make, take longer than their lines alone.
constexpr float kWidestBeam = 0.3f;

// Requires the lines and `axis`. `scale`: of all coordinates. False: too wide.
HWY_INLINE bool bound_beam(const TracerView& tree, float scale, Beam& beam) {
    const std::size_t a = beam.axis;
    float share = 1.0f;
    beam.from = 0.0f;
    for (std::size_t i = 0; i < kBeamLines; ++i) beam.from += beam.point[a][i] * (1.0f / kBeamLines);
    for (std::size_t n = 1; n < 3; ++n) {
        const std::size_t k = (a + n) % 3;
        float low = kFar, high = -kFar, slope_low = kFar, slope_high = -kFar;
        for (std::size_t i = 0; i < kBeamLines; ++i) {
            const float slope = beam.direction[k][i] * beam.inverse[a][i];
            const float x = beam.point[k][i] + slope * (beam.from - beam.point[a][i]);
            low = x < low ? x : low;
            high = x > high ? x : high;
            slope_low = slope < slope_low ? slope : slope_low;
            slope_high = slope > slope_high ? slope : slope_high;
        }
        const float width = high - low + 2.0f * tree.half[a] * (slope_high - slope_low);
        share *= width / (2.0f * tree.half[k] + width);
        // Far above the rounding here and the error bound of `children`.
        const float error_bound = 1e-5f * scale * (1.0f + size_of(slope_low) + size_of(slope_high));
        beam.low[k] = low - error_bound;
        beam.high[k] = high + error_bound;
        beam.slope_low[k] = slope_low;
        beam.slope_high[k] = slope_high;
    }
    return share < kWidestBeam;
}

// False: the lines are too far apart, in place or direction.
HWY_INLINE bool make_beam(const TracerView& tree, const FlatRay* rays, Beam& beam) {
    float least[3], most[3], scale = 0.0f;
    for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t i = 0; i < kBeamLines; ++i) {
            beam.point[k][i] = rays[i].point[k];
            beam.direction[k][i] = rays[i].direction[k];
            beam.inverse[k][i] = 1.0f / rays[i].direction[k];
        }
        least[k] = kFar, most[k] = -kFar;
        scale = tree.half[k] > scale ? tree.half[k] : scale;
        for (std::size_t i = 0; i < kBeamLines; ++i) {
            const float x = beam.direction[k][i], p = size_of(beam.point[k][i]);
            least[k] = x < least[k] ? x : least[k];
            most[k] = x > most[k] ? x : most[k];
            scale = p > scale ? p : scale;
        }
    }
    const auto nearest_zero = [&](std::size_t k) {
        return least[k] > 0.0f ? least[k] : (most[k] < 0.0f ? -most[k] : 0.0f);
    };
    std::size_t a = 0;
    for (std::size_t k = 1; k < 3; ++k) a = nearest_zero(k) > nearest_zero(a) ? k : a;
    beam.axis = a;
    return nearest_zero(a) > 0.05f && bound_beam(tree, scale, beam);
}

// Children that any line of the beam may pass.
HWY_INLINE unsigned beam_children(D d, const mesh::BoxNode& node, const Beam& beam) {
    unsigned bits = 0;
    const std::size_t a = beam.axis;
    for (std::size_t i = 0; i < kLanes; i += hn::Lanes(d)) {
        const V from = hn::Set(d, beam.from);
        const V x = hn::Sub(hn::Load(d, node.bounds[a] + i), from),
                y = hn::Sub(hn::Load(d, node.bounds[a + 3] + i), from);
        auto passes = hn::Eq(from, from);
        for (std::size_t n = 1; n < 3; ++n) {
            const std::size_t k = a + n < 3 ? a + n : a + n - 3;
            const V s = hn::Set(d, beam.slope_low[k]), t = hn::Set(d, beam.slope_high[k]);
            const V sx = hn::Mul(s, x), tx = hn::Mul(t, x), sy = hn::Mul(s, y), ty = hn::Mul(t, y);
            const V low = hn::Add(hn::Set(d, beam.low[k]), hn::Min(hn::Min(sx, tx), hn::Min(sy, ty)));
            const V high = hn::Add(hn::Set(d, beam.high[k]), hn::Max(hn::Max(sx, tx), hn::Max(sy, ty)));
            passes = hn::And(passes, hn::And(hn::Le(low, hn::Load(d, node.bounds[k + 3] + i)),
                                             hn::Ge(high, hn::Load(d, node.bounds[k] + i))));
        }
        bits |= simd::mask_bits(d, passes) << i;
    }
    return bits & ((1u << node.count) - 1u);
}

// The lines that pass one child: the arithmetic of `children`. A line that passes a box passes all boxes around it,
// since each of the steps is monotone, rounding included. So a leaf gets the same lines by whichever way.
HWY_INLINE std::uint64_t lines_through(const Beam& beam, const mesh::BoxNode& node, std::size_t lane) {
    const DL d;
    using W = hn::Vec<DL>;
    std::uint64_t lines = 0;
    for (std::size_t i = 0; i < kBeamLines; i += hn::Lanes(d)) {
        W enter = hn::Set(d, -kFar), leave = hn::Set(d, kFar);
        for (std::size_t k = 0; k < 3; ++k) {
            const W point = hn::Load(d, beam.point[k] + i), inverse = hn::Load(d, beam.inverse[k] + i);
            const W a = hn::Mul(hn::Sub(hn::Set(d, node.bounds[k][lane]), point), inverse);
            const W b = hn::Mul(hn::Sub(hn::Set(d, node.bounds[k + 3][lane]), point), inverse);
            enter = hn::Max(enter, hn::Min(a, b));
            leave = hn::Min(leave, hn::Max(a, b));
        }
        const W error_bound = hn::Mul(hn::Set(d, 0x1p-21f), hn::Max(hn::Abs(enter), hn::Abs(leave)));
        lines |= std::uint64_t{simd::mask_bits(d, hn::Le(enter, hn::Add(leave, error_bound)))} << i;
    }
    return lines;
}

// The crossings of a beam, in any order.
struct Crossings {
    static constexpr std::size_t kMost = 4096;
    FlatHit hits[kMost];
    std::uint8_t lines[kMost];
    std::uint32_t counts[kBeamLines];
    std::size_t count;
};

// False: there is no room.
HWY_INLINE bool cross_leaf(const TracerLeaf& leaf, const Beam& beam, std::uint64_t lines, Crossings& found) {
    const D d;
    alignas(64) float values[kLanes];
    for (; lines != 0; lines &= lines - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(lines));
        if (found.count + kLanes > Crossings::kMost) return false;
        unsigned front;
        for (unsigned met = triangles(d, leaf, Spread(d, beam, i), values, &front); met != 0; met &= met - 1) {
            const unsigned t = static_cast<unsigned>(std::countr_zero(met));
            found.lines[found.count] = static_cast<std::uint8_t>(i);
            found.hits[found.count++] = {values[t], leaf.triangle[t] | ((front >> t & 1u) ? kFront : 0u)};
            ++found.counts[i];
        }
    }
    return true;
}

// Which of the lines pass each child. Many lines are taken side by side, few one by one.
HWY_INLINE void lines_to_children(const Beam& beam, const mesh::BoxNode& node, std::uint64_t lines,
                                  std::uint64_t* passing) {
    const D d;
    unsigned bits = beam_children(d, node, beam);
    for (std::size_t lane = 0; lane < kLanes; ++lane) passing[lane] = 0;
    // One by one all children take as long as a child takes with all lines, times a sixth of the lines.
    if (6 * std::popcount(bits) <= std::popcount(lines)) {
        for (; bits != 0; bits &= bits - 1) {
            const auto lane = static_cast<std::size_t>(std::countr_zero(bits));
            passing[lane] = lines & lines_through(beam, node, lane);
        }
        return;
    }
    alignas(64) float entry[kLanes];
    for (; lines != 0; lines &= lines - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(lines));
        const std::uint64_t line = lines & (~lines + 1);
        for (unsigned met = children(d, node, Spread(d, beam, i), -kFar, kFar, entry); met != 0; met &= met - 1)
            passing[std::countr_zero(met)] |= line;
    }
}

enum class BeamEnd { done, no_beam, full };

// All crossings of kBeamLines lines, as trace_all has them, behind `used` hits. `no_beam`: the lines are too far apart,
// or have too many crossings.
HWY_INLINE BeamEnd trace_beam(const TracerView& tree, const FlatRay* rays, FlatHit* hits, std::size_t capacity,
                              std::size_t& used, std::uint32_t* ends) {
    struct Entry {
        std::uint64_t lines;
        std::uint32_t node;
    };
    Entry stack[kMaxDepth * kLanes];
    std::uint64_t passing[kLanes];
    Beam beam;
    Crossings found;
    if (!make_beam(tree, rays, beam)) return BeamEnd::no_beam;
    for (std::uint32_t& count : found.counts) count = 0;
    found.count = 0;
    std::size_t top = 0;
    stack[top++] = {~std::uint64_t{0}, 0};
    while (top > 0) {
        const Entry entry = stack[--top];
        const mesh::BoxNode& node = tree.nodes[entry.node];
        lines_to_children(beam, node, entry.lines, passing);
        for (std::uint32_t lane = 0; lane < node.count; ++lane) {
            if (passing[lane] == 0) continue;
            const std::uint32_t child = node.child[lane];
            if (!(child & kLeaf))
                stack[top++] = {passing[lane], child};
            else if (!cross_leaf(tree.leaves[child & ~kLeaf], beam, passing[lane], found))
                return BeamEnd::no_beam;
        }
    }
    if (used + found.count > capacity) return BeamEnd::full;
    std::size_t first[kBeamLines];
    for (std::size_t i = 0; i < kBeamLines; ++i) {
        first[i] = used;
        ends[i] = static_cast<std::uint32_t>(used);
        used += found.counts[i];
    }
    for (std::size_t h = 0; h < found.count; ++h)
        put_in_order(hits, first[found.lines[h]], ends[found.lines[h]]++, found.hits[h], tree.tie);
    return BeamEnd::done;
}

}  // namespace crofton::radiosity::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
