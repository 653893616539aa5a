// SPDX-License-Identifier: MIT
// Many lines at once through the tree: each node takes the list of those that come to it. Included once per
// instruction set.
#if defined(CROFTON_RADIOSITY_STREAM) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_RADIOSITY_STREAM
#undef CROFTON_RADIOSITY_STREAM
#else
#define CROFTON_RADIOSITY_STREAM
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>
#include <bit>
#include <crofton/simd/compress-inl.hpp>
#include <crofton/simd/gather_rows-inl.hpp>
#include <cstring>
#include <utility>

#include "line_tests-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::lines::detail::HWY_NAMESPACE {

// Writes those of eight numbers whose bits are set to `to`, which has room for all eight. Returns their number.
HWY_INLINE std::size_t put_eight(const std::uint16_t* from, std::size_t bits, std::uint16_t* to) {
#if HWY_TARGET == HWY_SCALAR
    std::size_t count = 0;
    for (; bits != 0; bits &= bits - 1) to[count++] = from[std::countr_zero(bits)];
    return count;
#else
    const hn::FixedTag<std::uint8_t, 16> d;
    const auto order = hn::Load(d, crofton::simd::kCompressBytes16<2>.bytes[bits]);
    const auto all = hn::LoadU(d, reinterpret_cast<const std::uint8_t*>(from));
    hn::StoreU(hn::TableLookupBytes(all, order), d, reinterpret_cast<std::uint8_t*>(to));
    return static_cast<std::size_t>(std::popcount(bits));
#endif
}

HWY_INLINE void flatten(const double* lines, std::size_t count, const double* origin, StreamLine* flat) {
    using D2 = hn::CappedTag<double, 2>;
    const D2 d;
    const hn::Rebind<float, D2> df;
    constexpr std::size_t kStep = hn::MaxLanes(D2());
    alignas(16) const double middle[6] = {origin[0], origin[1], origin[2], 0.0, 0.0, 0.0};
    alignas(16) const float least[6] = {0.0f, 0.0f, 0.0f, 1e-20f, 1e-20f, 1e-20f};
    const auto minus_one = hn::Set(df, -1.0f);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t k = 0; k < 6; k += kStep) {
            const auto x = hn::DemoteTo(df, hn::Sub(hn::LoadU(d, lines + 6 * i + k), hn::Load(d, middle + k)));
            // A direction's component of zero would make 0 · ∞; this one bends the line by less than a float's
            // resolution.
            const auto smallest = hn::Load(df, least + k);
            const auto y = hn::IfThenElse(hn::Lt(hn::Abs(x), smallest), hn::CopySign(smallest, x), x);
            hn::StoreU(y, df, flat[i].values + k);
            hn::StoreU(hn::Div(minus_one, y), df, flat[i].values + 8 + k);
        }
}

// Numbers of a stream's line, from `first` on, each in all lanes.
HWY_INLINE void spread(D d, const StreamLine& line, std::size_t first, V* out) {
    for (std::size_t k = 0; k < 3; ++k) out[k] = hn::Set(d, line.values[first + k]);
}

// The bounds of a node that lines reach first along each axis: rows of BoxNode::bounds, both the lower and the upper
// one if the lines' directions differ.
struct Rows {
    unsigned first[3] = {0, 1, 2}, second[3] = {3, 4, 5};
};

// Where lines cross the slabs of boxes, lane by lane: whether they pass. The arithmetic of `children`, with both signs
// turned; `inverse` is −1 over the direction. kSame: all come to `first` before `second`, as rounding keeps the order.
template <bool kSame, class T, class U = hn::Vec<T>>
HWY_INLINE unsigned passing(T d, const U* first, const U* second, const U* point, const U* inverse) {
    U enter, leave;
    for (int k = 0; k < 3; ++k) {
        const U a = hn::Mul(hn::Sub(point[k], first[k]), inverse[k]);
        const U b = hn::Mul(hn::Sub(point[k], second[k]), inverse[k]);
        const U near = kSame ? a : hn::Min(a, b), far = kSame ? b : hn::Max(a, b);
        enter = k == 0 ? near : hn::Max(enter, near);
        leave = k == 0 ? far : hn::Min(leave, far);
    }
    const U error_bound = hn::Mul(hn::Set(d, 0x1p-21f), hn::Max(hn::Abs(enter), hn::Abs(leave)));
    return simd::mask_bits(d, hn::Le(enter, hn::Add(leave, error_bound)));
}

// The children that one line passes, unused lanes too.
template <bool kSame>
HWY_INLINE unsigned passed_by(D d, const mesh::BoxNode& node, const Rows& rows, const StreamLine& line) {
    V point[3], inverse[3], first[3], second[3];
    spread(d, line, 0, point);
    spread(d, line, 11, inverse);
    unsigned bits = 0;
    for (std::size_t i = 0; i < kLanes; i += hn::Lanes(d)) {
        for (int k = 0; k < 3; ++k) {
            first[k] = hn::Load(d, node.bounds[rows.first[k]] + i);
            second[k] = hn::Load(d, node.bounds[rows.second[k]] + i);
        }
        bits |= passing<kSame>(d, first, second, point, inverse) << i;
    }
    return bits;
}

// Takes as many lines of a list together as a vector has lanes, and at least eight.
using W = hn::CappedTag<float, 16>;
using WV = hn::Vec<W>;
constexpr std::size_t kGroup = hn::MaxLanes(W()) > 8 ? hn::MaxLanes(W()) : 8;
struct Group {
    alignas(2 * kGroup) std::uint16_t line[kGroup];  // the first one stands in for those that are missing
    unsigned valid;                                  // bits

    HWY_INLINE Group(const std::uint16_t* list, std::size_t count) {
        std::memcpy(line, list, sizeof(line));
        valid = (1u << kGroup) - 1u;
        if (count >= kGroup) return;
        valid = (1u << count) - 1u;
        for (std::size_t i = count; i < kGroup; ++i) line[i] = line[0];
    }
    // Writes those whose bits are set to `to`, which has room for all. Returns their number.
    HWY_INLINE std::size_t put_selected(unsigned bits, std::uint16_t* to) const {
        std::size_t count = 0;
        for (std::size_t i = 0; i < kGroup; i += 8) count += put_eight(line + i, bits >> i & 255u, to + count);
        return count;
    }
};

// Four numbers of each line, from `first` on, side by side.
HWY_INLINE void gather(W d, const StreamLine* lines, const std::uint16_t* group, std::size_t first, WV (&out)[4]) {
    simd::gather_rows(
        d,
        [&](std::size_t l)
            HWY_ATTR { return simd::load_row(reinterpret_cast<const unsigned char*>(lines[group[l]].values + first)); },
        out);
}

// Adds the lines that pass child l to the list that ends at to[l].
template <bool kSame>
HWY_INLINE void pass_many(const mesh::BoxNode& node, const Rows& rows, const StreamLine* lines,
                          const std::uint16_t* list, std::size_t count, std::uint16_t** to) {
    const W d;
    const std::size_t children = node.count;
    for (std::size_t begin = 0; begin < count; begin += kGroup) {
        const Group group(list + begin, count - begin);
        unsigned bits[kLanes];
        for (std::size_t i = 0; i < kGroup; i += hn::Lanes(d)) {
            WV point[4], inverse[4], first[3], second[3];
            gather(d, lines, group.line + i, 0, point);
            gather(d, lines, group.line + i, 11, inverse);
            for (std::size_t lane = 0; lane < children; ++lane) {
                for (int k = 0; k < 3; ++k) {
                    first[k] = hn::Set(d, node.bounds[rows.first[k]][lane]);
                    second[k] = hn::Set(d, node.bounds[rows.second[k]][lane]);
                }
                const unsigned pass = passing<kSame>(d, first, second, point, inverse) << i;
                bits[lane] = i == 0 ? pass : bits[lane] | pass;
                if (i + hn::Lanes(d) < kGroup) continue;
                to[lane] += group.put_selected(bits[lane] & group.valid, to[lane]);
            }
        }
    }
}

using DU = hn::RebindToUnsigned<D>;

// Keeps the crossings in the lanes of `inside`.
template <class T, class U = hn::Vec<hn::RebindToUnsigned<T>>>
HWY_INLINE void keep(T d, hn::Mask<T> inside, hn::Vec<T> t, U triangle, hn::Vec<T> determinant, U line,
                     StreamCrossings& found) {
    const hn::RebindToUnsigned<T> du;
    const auto front = hn::IfThenElseZero(hn::RebindMask(du, hn::Gt(determinant, hn::Zero(d))), hn::Set(du, kFront));
    const auto chosen = hn::RebindMask(du, inside);
    hn::StoreU(simd::compress(du, line, chosen), du, found.line + found.count);
    hn::StoreU(simd::compress(du, hn::Or(triangle, front), chosen), du, found.triangle + found.count);
    found.count += simd::compress_store(d, t, inside, found.t + found.count);
}

// The crossings of a list of lines with a leaf, line by line.
HWY_INLINE void cross_few(D d, const TracerLeaf& leaf, const StreamLine* lines, const std::uint16_t* list,
                          std::size_t count, StreamCrossings& found) {
    const DU du;
    for (std::size_t n = 0; n < count; ++n) {
        V point[3], direction[3];
        spread(d, lines[list[n]], 0, point);
        spread(d, lines[list[n]], 3, direction);
        for (std::size_t i = 0; i < kLanes; i += hn::Lanes(d)) {
            V determinant, t;
            const auto inside = meet_lanes(d, leaf, i, point, direction, &determinant, &t);
            keep(d, inside, t, hn::Load(du, leaf.triangle + i), determinant, hn::Set(du, list[n]), found);
        }
    }
}

// The same, triangle by triangle.
HWY_INLINE void cross_many(const TracerLeaf& leaf, const StreamLine* lines, const std::uint16_t* list,
                           std::size_t count, StreamCrossings& found) {
    const W d;
    const hn::RebindToUnsigned<W> du;
    const hn::Rebind<std::uint16_t, W> ds;
    for (std::size_t begin = 0; begin < count; begin += kGroup) {
        const Group group(list + begin, count - begin);
        for (std::size_t i = 0; i < kGroup; i += hn::Lanes(d)) {
            WV start[4], rest[4], corner[3], e1[3], e2[3];
            gather(d, lines, group.line + i, 0, start);
            gather(d, lines, group.line + i, 4, rest);
            const WV direction[3] = {start[3], rest[0], rest[1]};
            const auto line = hn::PromoteTo(du, hn::Load(ds, group.line + i));
            const auto valid = simd::mask_from_bits(d, group.valid >> i);
            for (std::size_t lane = 0; lane < kLanes && leaf.triangle[lane] != kMiss; ++lane) {
                for (int k = 0; k < 3; ++k) {
                    corner[k] = hn::Set(d, leaf.corner[k][lane]);
                    e1[k] = hn::Set(d, leaf.first[k][lane]);
                    e2[k] = hn::Set(d, leaf.second[k][lane]);
                }
                WV determinant, t;
                const auto inside = hn::And(valid, meet(d, corner, e1, e2, start, direction, &determinant, &t));
                keep(d, inside, t, hn::Set(du, leaf.triangle[lane]), determinant, line, found);
            }
        }
    }
}

// A child, and the lines that come to it: few of them stand here.
constexpr std::size_t kFew = 4;
struct Visit {
    std::uint32_t child;
    std::uint32_t count;
    union {
        std::uint16_t few[kFew];
        std::uint32_t begin;  // of a list
    };
};

HWY_INLINE void prefetch(const TracerView& tree, std::uint32_t child) {
    const char* const from = child & kLeaf ? reinterpret_cast<const char*>(tree.leaves + (child & ~kLeaf))
                                           : reinterpret_cast<const char*>(tree.nodes + child);
    for (std::size_t i = 0; i < 5 * 64; i += 64) hwy::Prefetch(from + i);
}

// kSame: the directions of all lines have the signs that `rows` are for.
template <bool kSame>
class Stream {
  public:
    HWY_INLINE Stream(const TracerView& tree, const Rows& rows, const StreamLine* lines, std::uint16_t* lists,
                      std::size_t capacity, StreamCrossings& found)
        : tree_(tree), rows_(rows), lines_(lines), lists_(lists), capacity_(capacity), found_(found) {}

    HWY_INLINE StreamEnd trace(std::size_t count) {
        for (std::size_t i = 0; i < count; ++i) lists_[i] = static_cast<std::uint16_t>(i);
        Visit all{0, static_cast<std::uint32_t>(count), {}};
        all.begin = 0;
        if (count <= kFew)
            for (std::size_t i = 0; i < kFew; ++i) all.few[i] = static_cast<std::uint16_t>(i);
        stack_[top_++] = all;
        Visit later[kLater] = {};
        std::size_t turn = 0, waiting = 0;
        while (top_ + waiting > 0) {
            Visit next{};
            if (top_ > 0) {
                next = stack_[--top_];
                if (next.count > kFew) {
                    const StreamEnd end = visit_many(next);
                    if (end != StreamEnd::done) return end;
                    continue;
                }
                prefetch(tree_, next.child);
                ++waiting;
            }
            const Visit now = later[turn];
            later[turn] = next;
            turn = (turn + 1) % kLater;
            if (now.count == 0) continue;
            --waiting;
            if (!visit_few(now)) return StreamEnd::crossings_full;
        }
        return StreamEnd::done;
    }

  private:
    // Visits of few lines wait for their node or leaf to come from memory.
    static constexpr std::size_t kLater = 8;

    HWY_INLINE bool visit_few(const Visit& visit) {
        const D d;
        if (visit.child & kLeaf) {
            if (found_.count + (visit.count + 1) * kLanes > found_.capacity) return false;
            cross_few(d, tree_.leaves[visit.child & ~kLeaf], lines_, visit.few, visit.count, found_);
            return true;
        }
        const mesh::BoxNode& node = tree_.nodes[visit.child];
        unsigned masks[kFew] = {}, any = 0;
        for (std::size_t i = 0; i < visit.count; ++i)
            any |= masks[i] = passed_by<kSame>(d, node, rows_, lines_[visit.few[i]]);
        for (any &= (1u << node.count) - 1u; any != 0; any &= any - 1) {
            const auto lane = static_cast<unsigned>(std::countr_zero(any));
            Visit& next = stack_[top_++];
            next.child = node.child[lane];
            std::uint32_t count = 0;
            for (std::size_t i = 0; i < kFew; ++i) {
                next.few[count] = visit.few[i];
                count += masks[i] >> lane & 1u;
            }
            next.count = count;
        }
        return true;
    }

    HWY_INLINE StreamEnd visit_many(const Visit& visit) {
        const std::uint16_t* const list = lists_ + visit.begin;
        if (visit.child & kLeaf) {
            if (found_.count + (visit.count + kGroup) * kLanes + kGroup > found_.capacity)
                return StreamEnd::crossings_full;
            cross_many(tree_.leaves[visit.child & ~kLeaf], lines_, list, visit.count, found_);
            return StreamEnd::done;
        }
        const mesh::BoxNode& node = tree_.nodes[visit.child];
        // Room for a group more behind each list.
        const std::size_t width = visit.count + kGroup, begin = visit.begin + width;
        if (begin + width * kLanes > capacity_) return StreamEnd::lists_full;
        std::uint16_t* to[kLanes];
        for (std::size_t lane = 0; lane < kLanes; ++lane) to[lane] = lists_ + begin + lane * width;
        pass_many<kSame>(node, rows_, lines_, list, visit.count, to);
        for (std::size_t lane = 0; lane < node.count; ++lane) {
            const std::size_t first = begin + lane * width;
            const auto count = static_cast<std::uint32_t>(to[lane] - (lists_ + first));
            if (count == 0) continue;
            Visit& next = stack_[top_++];
            next.child = node.child[lane];
            next.count = count;
            if (count <= kFew)
                std::memcpy(next.few, lists_ + first, sizeof(next.few));
            else
                next.begin = static_cast<std::uint32_t>(first);
        }
        return StreamEnd::done;
    }

    const TracerView& tree_;
    const Rows& rows_;
    const StreamLine* lines_;
    std::uint16_t* lists_;
    std::size_t capacity_;
    StreamCrossings& found_;
    std::size_t top_ = 0;
    // Each visit to a node puts one block of up to kLanes children here.
    // Blocks of visit_many: each that is here descends from the one below it, so there are at most kMaxDepth.
    // Blocks of visit_few: take the topmost, and the ancestors of its visit. When one of these ancestors was taken from
    // here, it was the top. What has come since lies above its place, and goes before the next ancestor is taken,
    // unless it came while the ancestor waited. While it waits, kLater + 1 visits are made, its own among them.
    Visit stack_[kMaxDepth * kLanes * (kLater + 2)];
};

StreamEnd trace_stream(const TracerView& tree, const StreamLine* lines, std::size_t count, std::uint16_t* lists,
                       std::size_t list_capacity, StreamCrossings& found) {
    found.count = 0;
    // Neighbours often look the same way.
    unsigned upward = 7, downward = 7;  // axes along which all lines do
    for (std::size_t i = 0; i < count; ++i)
        for (unsigned k = 0; k < 3; ++k) (lines[i].values[3 + k] > 0.0f ? downward : upward) &= ~(1u << k);
    Rows rows;
    if ((upward | downward) != 7) return Stream<false>(tree, rows, lines, lists, list_capacity, found).trace(count);
    for (unsigned k = 0; k < 3; ++k)
        if (downward >> k & 1u) std::swap(rows.first[k], rows.second[k]);
    return Stream<true>(tree, rows, lines, lists, list_capacity, found).trace(count);
}

}  // namespace crofton::lines::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
