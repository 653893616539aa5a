// SPDX-License-Identifier: MIT
#include "list/direct_kernel.hpp"

#include <algorithm>
#include <crofton/geometry/box.hpp>
#include <cstddef>
#include <cstring>

// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include "list/open_records-inl.hpp"
#include "list/row_tests-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {

static_assert(sizeof(Obb) == 72 && offsetof(Obb, axes) == 24 && offsetof(Obb, half_extents) == 60);

// The caller's boxes, and the view's origin.
struct DirectBox {
    const unsigned char* bytes;
    const double* origin;
};
struct DirectBoxes {
    const unsigned char* bytes;
    const double* origin;

    HWY_INLINE DirectBox operator[](std::size_t i) const { return {bytes + sizeof(Obb) * i, origin}; }
};

// Rows of four: the centre relative to the view's origin, rounded, and one number without meaning; the axes and half
// extents.
HWY_INLINE simd::Row row_of(const DirectBox& box, std::size_t q) {
    if (q == 0) return simd::load_difference(box.bytes, box.origin);
    return simd::load_row(box.bytes + 8 + 16 * q);
}

HWY_INLINE void prefetch_record(const DirectBoxes&, std::uint32_t) {}  // read a moment ago

struct DirectLanes {
    VF center[3], axis[9], half[3];

    // rows(q, out): numbers 4 q to 4 q + 3 of the boxes.
    template <class Rows>
    HWY_INLINE explicit DirectLanes(const Rows& rows) {
        VF out[4];
        rows(0, out);
        for (int k = 0; k < 3; ++k) center[k] = out[k];
        rows(1, out);
        for (int k = 0; k < 4; ++k) axis[k] = out[k];
        rows(2, out);
        for (int k = 0; k < 4; ++k) axis[4 + k] = out[k];
        rows(3, out);
        axis[8] = out[0];
        for (int k = 0; k < 3; ++k) half[k] = out[1 + k];
    }
    HWY_INLINE VF distance() const { return size_of(center); }
    HWY_INLINE VF extent() const { return size_of(half); }
    // No corner is farther than |Σ ±h_k a_k|² ≤ Σ h_k² a_k · a_k + 2 Σ |h_i h_j a_i · a_j|, whatever the axes a are.
    HWY_INLINE VF square_of_radius() const {
        const DF d;
        VF square = hn::Zero(d), skew = hn::Zero(d);
        for (unsigned k = 0; k < 3; ++k) {
            const unsigned next = (k + 1) % 3;
            square = hn::MulAdd(hn::Mul(half[k], half[k]), product(k, k), square);
            skew = hn::Add(skew, hn::Abs(hn::Mul(hn::Mul(half[k], half[next]), product(k, next))));
        }
        return hn::MulAdd(skew, hn::Set(d, 2.0f), square);
    }
    // A radius of the sphere around the box, for any axes: 2^-18 covers twenty roundings, 1e-18 squares that underflow.
    HWY_INLINE VF radius(float scale) const {
        const DF d;
        return hn::MulAdd(hn::Sqrt(square_of_radius()), hn::Set(d, scale * (1.0f + 0x1p-18f)), hn::Set(d, 1e-18f));
    }
    // Bounds |x| + |y| + |z| + Σ|edge components|: no component of an axis exceeds 2.
    HWY_INLINE VF size() const { return hn::MulAdd(extent(), hn::Set(DF(), 6.0f), distance()); }
    HWY_INLINE VF sum_of_squares() const { return hn::Add(hn::Add(product(0, 0), product(1, 1)), product(2, 2)); }

  private:
    HWY_INLINE VF product(unsigned i, unsigned j) const {
        const VF *a = axis + 3 * i, *b = axis + 3 * j;
        return hn::MulAdd(a[0], b[0], hn::MulAdd(a[1], b[1], hn::Mul(a[2], b[2])));
    }
    static HWY_INLINE VF size_of(const VF (&v)[3]) {
        return hn::Add(hn::Add(hn::Abs(v[0]), hn::Abs(v[1])), hn::Abs(v[2]));
    }
};

// Bounds the error of a plane's value at the centre, plus or minus the box's extent along the normal, for each unit of
// |x| + |y| + |z| + Σ|edge components|. With u = 2^-24 these are local_plane's ten roundings of the evaluation, one of
// the centre and one of each edge; 12 u < 20 u.
inline constexpr float kDirectError = 0x1.4p-20f;

HWY_INLINE DirectLanes lanes_of_picked(const Picked<DirectBoxes>& picked) {
    return DirectLanes([&](std::size_t q, VF(&out)[4]) HWY_ATTR { picked.load(q, out[0], out[1], out[2], out[3]); });
}

HWY_INLINE BoxLanes lanes_of(const Picked<DirectBoxes>& picked, std::size_t count) {
    const DF d;
    const DU du;
    const DirectLanes in = lanes_of_picked(picked);
    BoxLanes boxes;
    boxes.x = in.center[0];
    boxes.y = in.center[1];
    boxes.z = in.center[2];
    boxes.present = hn::FirstN(d, count);
    // The unit: the power of two below the largest half extent, so that dividing by it is exact.
    const VF a = hn::Abs(in.half[0]), b = hn::Abs(in.half[1]), c = hn::Abs(in.half[2]);
    const VF largest = hn::Max(hn::Max(hn::Max(a, b), c), hn::Set(d, 0x1p-100f));
    const VU exponent = hn::And(hn::BitCast(du, largest), hn::Set(du, 0x7f800000u));
    boxes.unit = hn::BitCast(d, exponent);
    const VF inverse = hn::BitCast(d, hn::Sub(hn::Set(du, 0x7f000000u), exponent));
    for (unsigned k = 0; k < 3; ++k) {
        const VF half = hn::Mul(in.half[k], inverse);
        for (unsigned j = 0; j < 3; ++j) boxes.edge[3 * k + j] = hn::Mul(in.axis[3 * k + j], half);
    }
    boxes.edge_error_bound = hn::Mul(in.size(), hn::Set(d, kDirectError));
    return boxes;
}

namespace {

// Bit l for lane l.
struct DirectBits {
    std::uint32_t outside, inside, needs_edge_test, undecided;
};

// A plane with its numbers side by side.
struct DirectPlane {
    float normal[3], offset;
};

// A plane's value at the centres.
HWY_INLINE VF value_at(const DirectPlane& plane, const VF (&at)[3]) {
    const DF d;
    const VF rest = hn::MulAdd(hn::Set(d, plane.normal[2]), at[2], hn::Set(d, plane.offset));
    return hn::MulAdd(hn::Set(d, plane.normal[0]), at[0], hn::MulAdd(hn::Set(d, plane.normal[1]), at[1], rest));
}

// Whether the kernel can take the boxes, from the sum of the squares of their axes' components. If that does not exceed
// 4, none of them exceeds 2. Numbers that are not finite make `squares` or `size` one as well.
HWY_INLINE MF are_valid(const DirectLanes& boxes) {
    const VF squares = boxes.sum_of_squares(), size = boxes.size();
    return hn::And(hn::Le(squares, hn::Set(DF(), 4.0f)), hn::Lt(size, hn::Set(DF(), 8e29f)));
}

// By spheres around the boxes, which decide most of many boxes. `error_bound` is the largest of the planes'.
HWY_INLINE DirectBits test_spheres(const DirectLanes& boxes, const DirectPlane* planes, std::uint32_t count,
                                   float error_bound) {
    const DF d;
    const VF center_error = hn::MulAdd(boxes.distance(), hn::Set(d, kDirectError), hn::Set(d, error_bound));
    const VF margin = hn::Add(boxes.radius(1.0005f), center_error);  // normals are up to 1.0005 long
    VF least = hn::Set(d, 3e38f);
    for (std::uint32_t i = 0; i < count; ++i) least = hn::Min(least, value_at(planes[i], boxes.center));
    const std::uint32_t valid = bits_of(are_valid(boxes));
    return {bits_of(hn::Lt(least, hn::Neg(margin))) & valid, bits_of(hn::Ge(least, margin)) & valid, 0, 0};
}

// By the boxes themselves. `cut` are the planes that a box is not certainly inside of, as PlaneBits.
HWY_INLINE DirectBits test_planes(const DirectLanes& boxes, const DirectPlane* planes, std::uint32_t count,
                                  float error_bound, bool exact, VU& cut) {
    const DF d;
    const DU du;
    VF edge[9];
    for (unsigned k = 0; k < 9; ++k) edge[k] = hn::Mul(boxes.axis[k], boxes.half[k / 3]);
    const VF error = hn::MulAdd(boxes.size(), hn::Set(d, kDirectError), hn::Set(d, error_bound)),
             beyond = hn::Neg(error);
    const VF most = hn::Set(d, 3e38f);
    VF top = most, bottom = most, middle = most;  // the least of all planes
    cut = hn::Zero(du);
    for (std::uint32_t i = 0; i < count; ++i) {
        const VF x = hn::Set(d, planes[i].normal[0]), y = hn::Set(d, planes[i].normal[1]),
                 z = hn::Set(d, planes[i].normal[2]);
        const VF value = value_at(planes[i], boxes.center);
        VF slope[3];
        for (unsigned k = 0; k < 3; ++k)
            slope[k] = hn::Abs(hn::MulAdd(x, edge[3 * k], hn::MulAdd(y, edge[3 * k + 1], hn::Mul(z, edge[3 * k + 2]))));
        const VF projected_radius = hn::Add(hn::Add(slope[0], slope[1]), slope[2]);
        const VF low = hn::Sub(value, projected_radius);
        top = hn::Min(top, hn::Add(value, projected_radius));
        bottom = hn::Min(bottom, low);
        middle = hn::Min(middle, value);
        const auto open = hn::RebindMask(du, hn::Lt(low, error)), out = hn::RebindMask(du, hn::Lt(value, error));
        const VU bit = hn::IfThenElse(out, hn::Set(du, PlaneBits::bit(i + 1)), hn::Set(du, PlaneBits::late_bit(i + 1)));
        cut = hn::Or(cut, hn::IfThenElseZero(open, bit));
    }
    const MF outside = hn::Lt(top, beyond), inside = hn::Ge(bottom, error);
    const MF crossing = hn::And(hn::Ge(top, error), hn::Lt(bottom, beyond));
    // A box that crosses one plane and lies inside all others meets the frustum; so does one whose centre is inside.
    const auto once = hn::Eq(hn::And(cut, hn::Sub(cut, hn::Set(du, 1))), hn::Zero(du));
    const MF meets = hn::Or(hn::RebindMask(d, once), hn::Ge(middle, error));
    const std::uint32_t valid = bits_of(are_valid(boxes)), out = bits_of(outside) & valid, in = bits_of(inside) & valid,
                        cross = bits_of(crossing) & valid;
    return {out, in, exact ? cross & ~bits_of(meets) : 0, ~(out | in | cross)};
}

// Most of fewer boxes than this are near the view's surface, so that spheres around them would decide few.
constexpr std::size_t kFew = 256;

class DirectQuery {
  public:
    DirectQuery(const DirectKernelInput& input, ListKernelOutput& output)
        : in_(input), out_(output), boxes_{input.boxes, origin_} {
        std::copy_n(in_.view->origin, 3, origin_);
    }

    void run() {
        out_.undecided_count = out_.resolved_count = 0;
        out_.false_positives = 0;
        const std::size_t straddling = test_all();
        OpenCounts counts;
        if (resolve_count_ > 0) {
            ListChunk chunk{};  // the view's origin as the boxes'
            std::copy_n(origin_, 3, chunk.origin);
            const std::uint32_t planes = (1u << in_.view->plane_count) - 1;
            OpenRecords<DirectBox, DirectQuery, DirectBoxes> records(*in_.view, chunk, boxes_, planes, in_.exact,
                                                                     *this);
            counts = PlaneTable::takes(planes) ? records.resolve(resolve_, resolve_count_, resolve_cuts_)
                                               : records.resolve(resolve_, resolve_count_);
        }
        out_.resolved_count = resolve_count_;
        out_.false_positives = counts.false_positives;
        out_.open = straddling + counts.straddling + out_.undecided_count;
    }

    HWY_INLINE void outside(std::uint32_t i) { out_.visible[i / 64] &= ~bit(i); }
    HWY_INLINE void sixteen(std::size_t, const std::uint32_t* which, std::uint32_t outside_bits, std::uint32_t) {
        for_each_bit(outside_bits, [&](unsigned i) { outside(which[i]); });
    }
    HWY_INLINE void undecided(std::uint32_t i) { out_.undecided[out_.undecided_count++] = i; }

  private:
    static constexpr std::size_t kLanes = hn::MaxLanes(DF());
    static HWY_INLINE std::uint64_t bit(std::uint32_t i) { return std::uint64_t{1} << (i % 64); }

    // Lists the boxes that the planes do not decide; returns how many certainly straddle.
    std::size_t test_all() {
        const KernelView& view = *in_.view;
        DirectPlane planes[KernelView::kMaxPlanes];
        float error_bound = 0.0f;
        for (std::uint32_t i = 0; i < view.plane_count; ++i) {
            // As local_plane() at the view's own origin.
            const double offset = view.planes[i].offset;
            std::copy_n(view.planes[i].normal_f, 3, planes[i].normal);
            planes[i].offset = static_cast<float>(offset);
            error_bound = std::max(error_bound, static_cast<float>(0x1.41p-20 * std::fabs(offset) + 1e-37));
        }
        const auto by_planes = [&](const DirectLanes& boxes, VU& cut) HWY_ATTR {
            return test_planes(boxes, planes, view.plane_count, error_bound, in_.exact, cut);
        };
        const auto by_spheres = [&](const DirectLanes& boxes)
                                    HWY_ATTR { return test_spheres(boxes, planes, view.plane_count, error_bound); };
        std::size_t straddling = 0;
        for (std::size_t w = 0; w < (in_.count + 63) / 64; ++w) {
            const std::size_t first = 64 * w, size = std::min<std::size_t>(64, in_.count - first);
            const std::uint64_t present = ~std::uint64_t{0} >> (64 - size);
            WordBits bits;
            if (in_.count < kFew) {
                for (std::size_t l = 0; l < size; l += kLanes) {
                    VU cut;
                    bits.add(by_planes(lanes_from(first + l), cut), l);
                    hn::StoreU(cut, DU(), cuts_ + l);
                }
            } else {
                for (std::size_t l = 0; l < size; l += kLanes) bits.add(by_spheres(lanes_from(first + l)), l);
                test_open(first, ~(bits.outside | bits.inside) & present, by_planes, bits);
            }
            out_.visible[w] = ~bits.outside & present;
            out_.inside[w] = bits.inside & present;
            const std::uint64_t needs_edge_test = bits.needs_edge_test & present, undecided = bits.undecided & present;
            straddling += hwy::PopCount(~(bits.outside | bits.inside | needs_edge_test | undecided) & present);
            const auto base = static_cast<std::uint32_t>(first);
            append_needing(needs_edge_test, base);
            append(undecided, base, out_.undecided, out_.undecided_count);
        }
        return straddling;
    }

    // Results for 64 boxes.
    struct WordBits {
        std::uint64_t outside = 0, inside = 0, needs_edge_test = 0, undecided = 0;

        HWY_INLINE void add(const DirectBits& bits, std::size_t shift) {
            outside |= std::uint64_t{bits.outside} << shift;
            inside |= std::uint64_t{bits.inside} << shift;
            needs_edge_test |= std::uint64_t{bits.needs_edge_test} << shift;
            undecided |= std::uint64_t{bits.undecided & kAllLanes} << shift;
        }
        // Bit n goes to the place of the n-th bit of `open`.
        HWY_INLINE void put(const WordBits& bits, std::uint64_t open) {
            outside |= simd::deposit_bits(bits.outside, open);
            inside |= simd::deposit_bits(bits.inside, open);
            needs_edge_test |= simd::deposit_bits(bits.needs_edge_test, open);
            undecided |= simd::deposit_bits(bits.undecided, open);
        }
    };

    template <class Test>
    HWY_INLINE void test_open(std::size_t first, std::uint64_t open, const Test& test, WordBits& bits) {
        std::uint32_t which[64 + 16];
        const std::size_t count = list_sparse_bits(&open, 1, which);
        if (count == 0) return;
        std::fill_n(which + count, kLanes, which[count - 1]);  // for lanes beyond the last
        const DirectBoxes boxes{in_.boxes + sizeof(Obb) * first, origin_};
        WordBits found;
        for (std::size_t i = 0; i < count; i += kLanes) {
            const Picked<DirectBoxes> picked{boxes, which + i};
            VU cut;
            const DirectBits tested = test(lanes_of_picked(picked), cut);
            found.add(tested, i);
            alignas(64) std::uint32_t cuts[kLanes];
            hn::Store(cut, DU(), cuts);
            for_each_bit(tested.needs_edge_test & kAllLanes, [&](unsigned l) { cuts_[which[i + l]] = cuts[l]; });
        }
        bits.put(found, open);
    }

    static HWY_INLINE void append(std::uint64_t bits, std::uint32_t base, std::uint32_t* list, std::size_t& count) {
        for (; bits; bits &= bits - 1)
            list[count++] = base + static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero64(bits));
    }

    // With the planes that each of them crosses.
    HWY_INLINE void append_needing(std::uint64_t bits, std::uint32_t base) {
        for (; bits; bits &= bits - 1) {
            const auto i = static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero64(bits));
            resolve_cuts_[resolve_count_] = cuts_[i];
            resolve_[resolve_count_++] = base + i;
        }
    }

    // The boxes from `first` on. If there are fewer than lanes, the last ones are copied, and zeros follow.
    HWY_INLINE DirectLanes lanes_from(std::size_t first) {
        const unsigned char* bytes = in_.boxes + sizeof(Obb) * first;
        if (HWY_UNLIKELY(first + kLanes > in_.count)) {
            const std::size_t size = sizeof(Obb) * (in_.count - first);
            std::memcpy(last_, bytes, size);
            std::memset(last_ + size, 0, sizeof(last_) - size);
            bytes = last_;
        }
        const DirectBoxes boxes{bytes, origin_};
        return DirectLanes([&](std::size_t q, VF(&out)[4]) HWY_ATTR {
            simd::gather_rows(
                DF(), [&](std::size_t l) HWY_ATTR { return row_of(boxes[l], q); }, out);
        });
    }

    static constexpr std::uint32_t kAllLanes = static_cast<std::uint32_t>((std::uint64_t{1} << kLanes) - 1);

    const DirectKernelInput& in_;
    ListKernelOutput& out_;
    alignas(64) unsigned char last_[sizeof(Obb) * kLanes];
    double origin_[4] = {0.0, 0.0, 0.0, 1.0};  // the last is taken from a pair of floats: keeps that from underflow
    DirectBoxes boxes_;
    std::size_t resolve_count_ = 0;
    std::uint32_t resolve_[kChunk + 16], resolve_cuts_[kChunk + 16];
    std::uint32_t cuts_[64];  // of 64 boxes, those that need an edge test
};

void run_direct(const DirectKernelInput& input, ListKernelOutput& output) {
    DirectQuery(input, output).run();
}

}  // namespace
}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::cull {

HWY_EXPORT(run_direct);

void run_direct_kernel(const DirectKernelInput& input, ListKernelOutput& output) {
    HWY_DYNAMIC_DISPATCH(run_direct)(input, output);
}

}  // namespace crofton::cull
#endif
