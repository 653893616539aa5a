// SPDX-License-Identifier: MIT
#include "list/direct_kernel.hpp"

#include <algorithm>
#include <crofton/geometry/box.hpp>
#include <cstddef>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "list/direct_kernel.cpp"
// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include "list/open_records-inl.hpp"
#include "list/row_tests-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {

static_assert(sizeof(Obb) == 72 && offsetof(Obb, axes) == 24 && offsetof(Obb, half_extents) == 60);

// A box of the caller's, and where the view is.
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
template <>
struct Batch<DirectBox> {
    alignas(64) float quads[4][kBatch][4];

    HWY_INLINE void copy(std::size_t to, const DirectBox& box) {
#if HWY_TARGET == HWY_SCALAR
        for (std::size_t j = 0; j < 3; ++j) {
            double center;
            std::memcpy(&center, box.bytes + 8 * j, 8);
            quads[0][to][j] = static_cast<float>(center - box.origin[j]);
        }
#else
        const hn::CappedTag<double, 4> d;
        const hn::Rebind<float, decltype(d)> df;
        for (std::size_t j = 0; j < 4; j += hn::Lanes(d)) {
            const auto center = hn::LoadU(d, reinterpret_cast<const double*>(box.bytes) + j);
            hn::StoreU(hn::DemoteTo(df, hn::Sub(center, hn::LoadU(d, box.origin + j))), df, quads[0][to] + j);
        }
#endif
        for (std::size_t q = 0; q < 3; ++q) std::memcpy(quads[q + 1][to], box.bytes + 24 + 16 * q, 16);
    }
    HWY_INLINE void load(std::size_t quad, std::size_t at, VF& a, VF& b, VF& c, VF& d) const {
        hn::LoadInterleaved4(DF(), quads[quad][at], a, b, c, d);
    }
};

struct DirectLanes {
    VF center[3], axis[9], half[3];

    HWY_INLINE DirectLanes(const Batch<DirectBox>& batch, std::size_t at) {
        VF unused;
        batch.load(0, at, center[0], center[1], center[2], unused);
        batch.load(1, at, axis[0], axis[1], axis[2], axis[3]);
        batch.load(2, at, axis[4], axis[5], axis[6], axis[7]);
        batch.load(3, at, axis[8], half[0], half[1], half[2]);
    }
    HWY_INLINE VF distance() const {
        return hn::Add(hn::Add(hn::Abs(center[0]), hn::Abs(center[1])), hn::Abs(center[2]));
    }
};

// What a plane's value at the centre, with the box's extent along the normal added or taken away, may be off by for
// each unit of |x| + |y| + |z| + Σ|edge components|: with u = 2^-24, local_plane's ten roundings of the evaluation, one
// of the centre and one of each edge; 12 u < 20 u.
inline constexpr float kDirectError = 0x1.4p-20f;

HWY_INLINE BoxLanes lanes_of(const Batch<DirectBox>& batch, std::size_t at, std::size_t count) {
    const DF d;
    const DU du;
    const DirectLanes in(batch, at);
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
    // No component of an axis exceeds 2.
    const VF edges = hn::Mul(hn::Add(hn::Add(a, b), c), hn::Set(d, 6.0f));
    boxes.edge_slack = hn::Mul(hn::Add(in.distance(), edges), hn::Set(d, kDirectError));
    return boxes;
}

namespace {

// Spheres around the boxes: decide most.
struct SphereBits {
    std::uint32_t outside, inside, valid;
};

HWY_INLINE SphereBits test_spheres(const DirectLanes& boxes, const KernelView& view, const LocalPlane* planes,
                                   float most_slack) {
    const DF d;
    VF least = hn::Set(d, 3e38f);
    for (std::uint32_t i = 0; i < view.plane_count; ++i)
        least = hn::Min(
            least, plane_value(view.planes[i], boxes.center[0], boxes.center[1], boxes.center[2], planes[i].offset));
    // No corner is farther than |Σ ±edge|² ≤ Σ |edge_k|² + 2 Σ |edge_i · edge_k|, whatever the axes are.
    VF edge[9], square = hn::Zero(d), largest_axis = hn::Zero(d);
    for (unsigned k = 0; k < 3; ++k)
        for (unsigned j = 0; j < 3; ++j) {
            edge[3 * k + j] = hn::Mul(boxes.axis[3 * k + j], boxes.half[k]);
            square = hn::MulAdd(edge[3 * k + j], edge[3 * k + j], square);
            largest_axis = hn::Max(largest_axis, hn::Abs(boxes.axis[3 * k + j]));
        }
    VF skew = hn::Zero(d);
    for (unsigned k = 0; k < 3; ++k) {
        const VF* a = edge + 3 * k;
        const VF* b = edge + 3 * ((k + 1) % 3);
        skew = hn::Add(skew, hn::Abs(hn::MulAdd(a[0], b[0], hn::MulAdd(a[1], b[1], hn::Mul(a[2], b[2])))));
    }
    square = hn::MulAdd(skew, hn::Set(d, 2.0f), square);
    // Normals are up to 1.0005 long; 2^-18 covers fifteen roundings, 1e-18 squares that underflow.
    const VF radius = hn::MulAdd(hn::Sqrt(square), hn::Set(d, 1.0005f * (1.0f + 0x1p-18f)), hn::Set(d, 1e-18f));
    const VF distance = boxes.distance();
    const VF slack = hn::MulAdd(distance, hn::Set(d, kDirectError), hn::Set(d, most_slack));
    const VF margin = hn::Add(radius, slack);
    // A number that is not finite makes `square` or `distance` one as well.
    const VF largest_half = hn::Max(hn::Max(hn::Abs(boxes.half[0]), hn::Abs(boxes.half[1])), hn::Abs(boxes.half[2]));
    MF valid = hn::And(hn::Lt(square, hn::Set(d, 1e36f)), hn::Lt(distance, hn::Set(d, 8e29f)));
    valid = hn::And(valid, hn::And(hn::Le(largest_axis, hn::Set(d, 2.0f)), hn::Le(largest_half, hn::Set(d, 9e29f))));
    return {bits_of(hn::Lt(least, hn::Neg(margin))), bits_of(hn::Ge(least, margin)), bits_of(valid)};
}

class DirectQuery {
  public:
    DirectQuery(const DirectKernelInput& input, ListKernelOutput& output)
        : in_(input), out_(output), boxes_{input.boxes, origin_} {
        std::copy_n(in_.view->origin, 3, origin_);
    }

    void run() {
        out_.undecided_count = 0;
        const std::size_t count = test_all_spheres();
        OpenCounts counts;
        if (count > 0) {
            ListChunk chunk{};  // the view's origin as the boxes'
            std::copy_n(origin_, 3, chunk.origin);
            OpenRecords<DirectBox, DirectQuery, DirectBoxes> records(
                *in_.view, chunk, boxes_, (1u << in_.view->plane_count) - 1, in_.exact, *this);
            std::uint32_t needs_edge_test[kChunk + 16];
            counts = records.test(open_, count, needs_edge_test);
        }
        out_.resolved_count = counts.resolved;
        out_.improper = counts.improper;
        out_.open = counts.straddling + out_.undecided_count;
    }

    HWY_INLINE void outside(std::uint32_t i) { out_.visible[i / 64] &= ~bit(i); }
    HWY_INLINE void inside(std::uint32_t i) { out_.inside[i / 64] |= bit(i); }
    HWY_INLINE void undecided(std::uint32_t i) { out_.undecided[out_.undecided_count++] = i; }

  private:
    static HWY_INLINE std::uint64_t bit(std::uint32_t i) { return std::uint64_t{1} << (i % 64); }

    // Lists what the spheres leave open; returns how many.
    std::size_t test_all_spheres() {
        const KernelView& view = *in_.view;
        LocalPlane planes[KernelView::kMaxPlanes];
        const LocalOrigin at = local_origin(view, origin_, 0.0f);
        float most_slack = 0.0f;
        for (std::uint32_t i = 0; i < view.plane_count; ++i) {
            planes[i] = local_plane(view.planes[i], at);
            most_slack = std::max(most_slack, planes[i].slack);
        }
        Batch<DirectBox> batch;
        std::size_t open_count = 0;
        for (std::size_t first = 0; first < in_.count; first += 64) {
            const std::size_t size = std::min<std::size_t>(64, in_.count - first);
            for (std::size_t i = 0; i < size; ++i) batch.copy(i, boxes_[first + i]);
            std::uint64_t outside = 0, inside = 0, valid = 0;
            for (std::size_t l = 0; l < size; l += hn::Lanes(DF())) {
                const SphereBits bits = test_spheres(DirectLanes(batch, l), view, planes, most_slack);
                outside |= std::uint64_t{bits.outside} << l;
                inside |= std::uint64_t{bits.inside} << l;
                valid |= std::uint64_t{bits.valid} << l;
            }
            const std::uint64_t present = ~std::uint64_t{0} >> (64 - size);
            outside &= valid;
            inside &= valid;
            out_.visible[first / 64] = ~outside & present;
            out_.inside[first / 64] = inside & present;
            const auto base = static_cast<std::uint32_t>(first);
            const auto list = [&](std::uint64_t word, std::uint32_t* to) {
                for (; word; word &= word - 1)
                    *to++ = base + static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero64(word));
            };
            const std::uint64_t open = ~(outside | inside) & valid & present, invalid = ~valid & present;
            list(open, open_ + open_count);
            open_count += hwy::PopCount(open);
            list(invalid, out_.undecided + out_.undecided_count);
            out_.undecided_count += hwy::PopCount(invalid);
        }
        return open_count;
    }

    const DirectKernelInput& in_;
    ListKernelOutput& out_;
    double origin_[4] = {};
    DirectBoxes boxes_;
    std::uint32_t open_[kChunk + 16];
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
