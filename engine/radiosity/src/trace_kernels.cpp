// SPDX-License-Identifier: MIT
#include "trace_kernels.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "trace_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <bit>
#include <crofton/simd/mask_bits-inl.hpp>

HWY_BEFORE_NAMESPACE();
namespace crofton::radiosity::detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
namespace simd = crofton::simd::HWY_NAMESPACE;
using D = hn::CappedTag<float, kLanes>;
using V = hn::Vec<D>;

struct Spread {
    V point[3], direction[3], inverse[3];
    HWY_INLINE Spread(D d, const FlatRay& ray) {
        for (int k = 0; k < 3; ++k) {
            point[k] = hn::Set(d, ray.point[k]);
            direction[k] = hn::Set(d, ray.direction[k]);
            inverse[k] = hn::Set(d, 1.0f / ray.direction[k]);
        }
    }
    // Of a beam.
    template <class Lines>
    HWY_INLINE Spread(D d, const Lines& lines, std::size_t line) {
        for (std::size_t k = 0; k < 3; ++k) {
            point[k] = hn::Set(d, lines.point[k][line]);
            direction[k] = hn::Set(d, lines.direction[k][line]);
            inverse[k] = hn::Set(d, lines.inverse[k][line]);
        }
    }
};

// Which children the line passes between t_low and t_high, and where it enters each. Each of the three steps of a
// plane's parameter rounds by 2^-24; widening the interval by 2^-21 of its ends covers them.
HWY_INLINE unsigned children(D d, const mesh::BoxNode& node, const Spread& ray, float t_low, float t_high,
                             float* entry) {
    unsigned bits = 0;
    for (std::size_t i = 0; i < kLanes; i += hn::Lanes(d)) {
        V enter = hn::Set(d, t_low), leave = hn::Set(d, t_high);
        for (int k = 0; k < 3; ++k) {
            const V a = hn::Mul(hn::Sub(hn::Load(d, node.bounds[k] + i), ray.point[k]), ray.inverse[k]);
            const V b = hn::Mul(hn::Sub(hn::Load(d, node.bounds[k + 3] + i), ray.point[k]), ray.inverse[k]);
            enter = hn::Max(enter, hn::Min(a, b));
            leave = hn::Min(leave, hn::Max(a, b));
        }
        const V error_bound = hn::Mul(hn::Set(d, 0x1p-21f), hn::Max(hn::Abs(enter), hn::Abs(leave)));
        hn::Store(enter, d, entry + i);
        bits |= simd::mask_bits(d, hn::Le(enter, hn::Add(leave, error_bound))) << i;
    }
    return bits & ((1u << node.count) - 1u);
}

// Möller and Trumbore, both sides. `front`: the line runs against the normal.
HWY_INLINE unsigned triangles(D d, const TracerLeaf& leaf, const Spread& ray, float* t_out, unsigned* front) {
    unsigned bits = 0;
    const V zero = hn::Zero(d);
    *front = 0;
    for (std::size_t i = 0; i < kLanes; i += hn::Lanes(d)) {
        V e1[3], e2[3], s[3], p[3], q[3];
        for (int k = 0; k < 3; ++k) {
            e1[k] = hn::Load(d, leaf.first[k] + i);
            e2[k] = hn::Load(d, leaf.second[k] + i);
            s[k] = hn::Sub(ray.point[k], hn::Load(d, leaf.corner[k] + i));
        }
        const auto cross = [](const V* a, const V* b, V* out) {
            out[0] = hn::Sub(hn::Mul(a[1], b[2]), hn::Mul(a[2], b[1]));
            out[1] = hn::Sub(hn::Mul(a[2], b[0]), hn::Mul(a[0], b[2]));
            out[2] = hn::Sub(hn::Mul(a[0], b[1]), hn::Mul(a[1], b[0]));
        };
        const auto dot = [](const V* a, const V* b) {
            return hn::Add(hn::Add(hn::Mul(a[0], b[0]), hn::Mul(a[1], b[1])), hn::Mul(a[2], b[2]));
        };
        cross(ray.direction, e2, p);
        const V determinant = dot(e1, p);
        const V scale = hn::Div(hn::Set(d, 1.0f), determinant);
        const V u = hn::Mul(dot(s, p), scale);
        cross(s, e1, q);
        const V v = hn::Mul(dot(ray.direction, q), scale);
        const V t = hn::Mul(dot(e2, q), scale);
        const auto inside = hn::And(hn::And(hn::Ge(u, zero), hn::Ge(v, zero)),
                                    hn::And(hn::Le(hn::Add(u, v), hn::Set(d, 1.0f)), hn::Ne(determinant, zero)));
        hn::Store(t, d, t_out + i);
        bits |= simd::mask_bits(d, inside) << i;
        *front |= simd::mask_bits(d, hn::Gt(determinant, zero)) << i;
    }
    return bits & ((1u << leaf.count) - 1u);
}

constexpr float kFar = 3e38f;

// Where two faces back to back coincide, rounding must not put the back one in front.
HWY_INLINE float sort_key(const FlatHit& hit, float tie) {
    return (hit.triangle & kFront) ? hit.t : hit.t + tie;
}

// Keeps the hits of one line sorted, ties by number: puts the one at `at` in its place among those from `first` on.
HWY_INLINE void put_in_order(FlatHit* hits, std::size_t first, std::size_t at, const FlatHit& hit, float tie) {
    const auto before = [&](const FlatHit& x, const FlatHit& y) {
        const float kx = sort_key(x, tie), ky = sort_key(y, tie);
        return kx != ky ? kx < ky : x.triangle < y.triangle;
    };
    for (; at > first && before(hit, hits[at - 1]); --at) hits[at] = hits[at - 1];
    hits[at] = hit;
}

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

std::size_t trace_all(const TracerView& tree, const FlatRay* rays, std::size_t count, FlatHit* hits,
                      std::size_t capacity, std::uint32_t* ends) {
    const D d;
    std::uint32_t stack[kMaxDepth * kLanes];
    alignas(64) float values[kLanes];
    std::size_t used = 0;
    std::size_t next_beam = 0;
    for (std::size_t r = 0; r < count; ++r) {
        if (r == next_beam && r + kBeamLines <= count) {
            next_beam += kBeamLines;
            const BeamEnd end = trace_beam(tree, rays + r, hits, capacity, used, ends + r);
            if (end == BeamEnd::full) return r;
            if (end == BeamEnd::done) {
                r = next_beam - 1;
                continue;
            }
        }
        const Spread ray(d, rays[r]);
        const std::size_t first = used;
        std::size_t top = 0;
        stack[top++] = 0;
        while (top > 0) {
            const std::uint32_t item = stack[--top];
            if (item & kLeaf) {
                const TracerLeaf& leaf = tree.leaves[item & ~kLeaf];
                unsigned front;
                unsigned bits = triangles(d, leaf, ray, values, &front);
                if (used + kLanes > capacity) return r;
                for (; bits != 0; bits &= bits - 1) {
                    const unsigned lane = static_cast<unsigned>(std::countr_zero(bits));
                    const FlatHit hit{values[lane], leaf.triangle[lane] | ((front >> lane & 1u) ? kFront : 0u)};
                    put_in_order(hits, first, used, hit, tree.tie);
                    ++used;
                }
                continue;
            }
            const mesh::BoxNode& node = tree.nodes[item];
            for (unsigned bits = children(d, node, ray, -kFar, kFar, values); bits != 0; bits &= bits - 1)
                stack[top++] = node.child[static_cast<unsigned>(std::countr_zero(bits))];
        }
        ends[r] = static_cast<std::uint32_t>(used);
    }
    return count;
}

void trace_first(const TracerView& tree, const FlatRay* rays, std::size_t count, FlatHit* hits) {
    const D d;
    struct Entry {
        std::uint32_t item;
        float enter;
    };
    Entry stack[kMaxDepth * kLanes];
    alignas(64) float values[kLanes];
    for (std::size_t r = 0; r < count; ++r) {
        const Spread ray(d, rays[r]);
        FlatHit best{kFar, kMiss};
        float best_key = kFar;
        std::size_t top = 0;
        stack[top++] = {0, 0.0f};
        while (top > 0) {
            const Entry entry = stack[--top];
            if (entry.enter > best_key) continue;
            if (entry.item & kLeaf) {
                const TracerLeaf& leaf = tree.leaves[entry.item & ~kLeaf];
                unsigned front;
                for (unsigned bits = triangles(d, leaf, ray, values, &front); bits != 0; bits &= bits - 1) {
                    const unsigned lane = static_cast<unsigned>(std::countr_zero(bits));
                    if (!(values[lane] > tree.tie) || leaf.triangle[lane] == rays[r].skip) continue;
                    const FlatHit hit{values[lane], leaf.triangle[lane] | ((front >> lane & 1u) ? kFront : 0u)};
                    const float key = sort_key(hit, tree.tie);
                    if (key < best_key || (key == best_key && hit.triangle < best.triangle)) {
                        best = hit;
                        best_key = key;
                    }
                }
                continue;
            }
            const mesh::BoxNode& node = tree.nodes[entry.item];
            const std::size_t base = top;
            for (unsigned bits = children(d, node, ray, 0.0f, best_key, values); bits != 0; bits &= bits - 1) {
                const unsigned lane = static_cast<unsigned>(std::countr_zero(bits));
                const Entry child{node.child[lane], values[lane]};
                std::size_t at = top++;  // the nearest on top
                for (; at > base && stack[at - 1].enter < child.enter; --at) stack[at] = stack[at - 1];
                stack[at] = child;
            }
        }
        hits[r] = best;
    }
}

}  // namespace crofton::radiosity::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::radiosity::detail {

HWY_EXPORT(trace_all);
HWY_EXPORT(trace_first);

std::size_t trace_all(const TracerView& tree, const FlatRay* rays, std::size_t count, FlatHit* hits,
                      std::size_t capacity, std::uint32_t* ends) {
    return HWY_DYNAMIC_DISPATCH(trace_all)(tree, rays, count, hits, capacity, ends);
}
void trace_first(const TracerView& tree, const FlatRay* rays, std::size_t count, FlatHit* hits) {
    HWY_DYNAMIC_DISPATCH(trace_first)(tree, rays, count, hits);
}

}  // namespace crofton::radiosity::detail
#endif
