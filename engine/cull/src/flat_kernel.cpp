#include "flat_kernel.hpp"

#include <algorithm>

// Vectors of unknown size cannot be members.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flat_kernel.cpp"
// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using DF = hn::CappedTag<float, 16>;
using DU = hn::RebindToUnsigned<DF>;
using VF = hn::Vec<DF>;
using MF = hn::Mask<DF>;

template <class M>
HWY_INLINE std::uint32_t bits_of(M mask) {
    alignas(8) std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(DF(), mask, bytes);
    return static_cast<std::uint32_t>(bytes[0]) | static_cast<std::uint32_t>(bytes[1]) << 8;
}

// The planes as seen from a chunk, one a lane; lanes beyond the last plane hold one that everything is inside of.
struct Planes {
    alignas(64) float x[16], y[16], z[16], offset[16], slack[16];
    unsigned count;
    float largest_slack = 0.0f;

    HWY_INLINE explicit Planes(const FlatKernelInput& in) : count(in.view->plane_count) {
        const LocalOrigin at = local_origin(*in.view, in.origin, 0.0f);
        for (unsigned i = 0; i < 16; ++i) {
            x[i] = y[i] = z[i] = slack[i] = 0.0f;
            offset[i] = 3e38f;
            if (i >= count) continue;
            const KernelPlane& plane = in.view->planes[i];
            LocalOrigin with_reach = at;
            with_reach.reach = in.reach;
            const LocalPlane local = local_plane(plane, with_reach);
            x[i] = plane.normal_f[0];
            y[i] = plane.normal_f[1];
            z[i] = plane.normal_f[2];
            offset[i] = local.offset;
            slack[i] = local.slack;
            largest_slack = std::max(largest_slack, local.slack);
        }
    }
};

// min over the planes of their values at 4 · N centres, then radius above or below: 16 · 4 boxes are one word of
// verdicts. Normals are at most 1.001 long; the radii were grown by 2^-9 for that.
HWY_INLINE void test_spheres(const float* blocks, const Planes& planes, std::uint64_t& maybe, std::uint64_t& inside) {
    const DF d;
    const VF slack = hn::Set(d, planes.largest_slack), below = hn::Neg(slack);
    maybe = inside = 0;
    for (std::size_t l = 0; l < 16; l += hn::Lanes(d)) {
        const float *b0 = blocks + l, *b1 = b0 + 64, *b2 = b0 + 128, *b3 = b0 + 192;
        const VF x0 = hn::Load(d, b0), x1 = hn::Load(d, b1), x2 = hn::Load(d, b2), x3 = hn::Load(d, b3);
        const VF y0 = hn::Load(d, b0 + 16), y1 = hn::Load(d, b1 + 16), y2 = hn::Load(d, b2 + 16),
                 y3 = hn::Load(d, b3 + 16);
        const VF z0 = hn::Load(d, b0 + 32), z1 = hn::Load(d, b1 + 32), z2 = hn::Load(d, b2 + 32),
                 z3 = hn::Load(d, b3 + 32);
        VF least0 = hn::Set(d, 3e38f), least1 = least0, least2 = least0, least3 = least0;
        for (unsigned i = 0; i < planes.count; ++i) {
            const VF nx = hn::Set(d, planes.x[i]), ny = hn::Set(d, planes.y[i]), nz = hn::Set(d, planes.z[i]),
                     offset = hn::Set(d, planes.offset[i]);
            least0 = hn::Min(least0, hn::MulAdd(nx, x0, hn::MulAdd(ny, y0, hn::MulAdd(nz, z0, offset))));
            least1 = hn::Min(least1, hn::MulAdd(nx, x1, hn::MulAdd(ny, y1, hn::MulAdd(nz, z1, offset))));
            least2 = hn::Min(least2, hn::MulAdd(nx, x2, hn::MulAdd(ny, y2, hn::MulAdd(nz, z2, offset))));
            least3 = hn::Min(least3, hn::MulAdd(nx, x3, hn::MulAdd(ny, y3, hn::MulAdd(nz, z3, offset))));
        }
        const VF r0 = hn::Load(d, b0 + 48), r1 = hn::Load(d, b1 + 48), r2 = hn::Load(d, b2 + 48),
                 r3 = hn::Load(d, b3 + 48);
        const auto add = [&](VF least, VF r, std::size_t shift) {
            maybe |= std::uint64_t{bits_of(hn::Ge(hn::Add(least, r), below))} << shift;
            inside |= std::uint64_t{bits_of(hn::Ge(hn::Sub(least, r), slack))} << shift;
        };
        add(least0, r0, l);
        add(least1, r1, l + 16);
        add(least2, r2, l + 32);
        add(least3, r3, l + 48);
    }
    inside &= maybe;
}

// The same search as has_witness() of the trees' leaves, for one box: planes as lanes of arrays.
HWY_NOINLINE bool has_witness(const float* box, float radius, const Planes& planes) {
    float t[3] = {0.0f, 0.0f, 0.0f};
    for (int round = 0; round < 3; ++round) {
        float worst = 3e38f, worst_slope[3] = {0.0f, 0.0f, 0.0f};
        bool inside = true;
        for (unsigned i = 0; i < planes.count; ++i) {
            float slope[3];
            for (unsigned k = 0; k < 3; ++k)
                slope[k] = planes.x[i] * box[3 + 3 * k] + planes.y[i] * box[4 + 3 * k] + planes.z[i] * box[5 + 3 * k];
            const float value = planes.x[i] * box[0] + planes.y[i] * box[1] + planes.z[i] * box[2] + planes.offset[i] +
                                slope[0] * t[0] + slope[1] * t[1] + slope[2] * t[2];
            inside = inside && value >= planes.slack[i] + radius * 0x1p-18f;
            if (value < worst) {
                worst = value;
                for (unsigned k = 0; k < 3; ++k) worst_slope[k] = slope[k];
            }
        }
        if (inside) return true;
        const float square =
            worst_slope[0] * worst_slope[0] + worst_slope[1] * worst_slope[1] + worst_slope[2] * worst_slope[2];
        if (!(square > 1e-30f)) return false;
        const float reach = std::fabs(worst_slope[0]) + std::fabs(worst_slope[1]) + std::fabs(worst_slope[2]);
        const float step = (0.05f * reach - worst) / square;
        for (unsigned k = 0; k < 3; ++k) t[k] = std::max(-1.0f, std::min(1.0f, t[k] + step * worst_slope[k]));
    }
    return false;
}

enum class Filtered { outside, straddling, inside, undecided };

// One box against all planes at once, a plane a lane.
HWY_INLINE Filtered test_box(const float* box, float radius, const Planes& planes, bool exact) {
    const DF d;
    bool passes = true, crosses = false, center = true;
    std::size_t open = 0;
    for (std::size_t l = 0; l < planes.count; l += hn::Lanes(d)) {
        const VF x = hn::Load(d, planes.x + l), y = hn::Load(d, planes.y + l), z = hn::Load(d, planes.z + l);
        // The half edges' rounding and that of the sums over them: 5 · 2^-24 · √3 of the radius.
        const VF slack = hn::MulAdd(hn::Set(d, radius), hn::Set(d, 0x1p-19f), hn::Load(d, planes.slack + l));
        const VF middle = hn::MulAdd(
            hn::Set(d, box[0]), x,
            hn::MulAdd(hn::Set(d, box[1]), y, hn::MulAdd(hn::Set(d, box[2]), z, hn::Load(d, planes.offset + l))));
        const VF u =
            hn::MulAdd(hn::Set(d, box[3]), x, hn::MulAdd(hn::Set(d, box[4]), y, hn::Mul(hn::Set(d, box[5]), z)));
        const VF v =
            hn::MulAdd(hn::Set(d, box[6]), x, hn::MulAdd(hn::Set(d, box[7]), y, hn::Mul(hn::Set(d, box[8]), z)));
        const VF w =
            hn::MulAdd(hn::Set(d, box[9]), x, hn::MulAdd(hn::Set(d, box[10]), y, hn::Mul(hn::Set(d, box[11]), z)));
        const VF reach = hn::Add(hn::Add(hn::Abs(u), hn::Abs(v)), hn::Abs(w));
        const VF top = hn::Add(middle, reach), bottom = hn::Sub(middle, reach), below = hn::Neg(slack);
        if (!hn::AllFalse(d, hn::Lt(top, below))) return Filtered::outside;
        passes = passes && hn::AllTrue(d, hn::Ge(top, slack));
        crosses = crosses || !hn::AllFalse(d, hn::Lt(bottom, below));
        center = center && hn::AllTrue(d, hn::Ge(middle, slack));
        open += hn::Lanes(d) - hn::CountTrue(d, hn::Ge(bottom, slack));
    }
    if (open == 0) return Filtered::inside;
    // A box that crosses one plane and lies inside all others meets the frustum; so does one whose centre is inside.
    if (!passes || !crosses) return Filtered::undecided;
    return !exact || open == 1 || center || has_witness(box, radius, planes) ? Filtered::straddling
                                                                             : Filtered::undecided;
}

void RunFlat(const FlatKernelInput& in, FlatKernelOutput& out) {
    const Planes planes(in);
    for (std::size_t begin = 0; begin < in.count; begin += 64) {
        std::uint64_t maybe, inside;
        test_spheres(in.spheres + (in.first + begin) * 4, planes, maybe, inside);
        out.records_tested += hwy::PopCount(maybe & ~inside);
        for (std::uint64_t open = maybe & ~inside; open; open &= open - 1) {
            const std::size_t i = in.first + begin + hwy::Num0BitsBelowLS1Bit_Nonzero64(open);
            const std::uint64_t bit = open & ~(open - 1);
            switch (test_box(in.records + 12 * i, in.spheres[i / 16 * 64 + 48 + i % 16], planes, in.exact)) {
                case Filtered::outside:
                    maybe ^= bit;
                    break;
                case Filtered::inside:
                    inside |= bit;
                    break;
                case Filtered::undecided:
                    out.undecided[out.undecided_count++] = static_cast<std::uint32_t>(i);
                    break;
                default:
                    break;
            }
        }
        out.visible[(in.first + begin) / 64] = maybe;
        out.inside[(in.first + begin) / 64] = inside;
    }
}

std::size_t ListBits(const std::uint64_t* bits, std::size_t words, std::uint32_t* ids) {
    const DU du;
    std::size_t count = 0;
    for (std::size_t w = 0; w < words; ++w) {
        if (bits[w] == 0) continue;
        for (std::size_t l = 0; l < 64; l += hn::Lanes(du)) {
            alignas(8) std::uint8_t bytes[8] = {};
            const std::uint64_t part = bits[w] >> l;
            for (unsigned i = 0; i < 2; ++i) bytes[i] = static_cast<std::uint8_t>(part >> (8 * i));
            const auto mask = hn::LoadMaskBits(du, bytes);
            hn::StoreU(hn::Compress(hn::Iota(du, static_cast<std::uint32_t>(64 * w + l)), mask), du, ids + count);
            count += hn::CountTrue(du, mask);
        }
    }
    return count;
}

}  // namespace
}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::cull {

HWY_EXPORT(RunFlat);
HWY_EXPORT(ListBits);

void run_flat_kernel(const FlatKernelInput& input, FlatKernelOutput& output) {
    HWY_DYNAMIC_DISPATCH(RunFlat)(input, output);
}

std::size_t list_bits_kernel(const std::uint64_t* bits, std::size_t words, std::uint32_t* ids) {
    return HWY_DYNAMIC_DISPATCH(ListBits)(bits, words, ids);
}

}  // namespace crofton::cull
#endif
