#include "flat_kernel.hpp"

#include <algorithm>

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

// The spheres decide most boxes: 16 a block. Normals are at most 1.001 long; the radii were grown by 2^-9 for that.
HWY_NOINLINE void test_spheres(const FlatKernelInput& in, const Planes& planes, FlatKernelOutput& out,
                               std::uint32_t* open, std::size_t& open_count) {
    const DF d;
    const DU du;
    const VF slack = hn::Set(d, planes.largest_slack);
    const std::size_t blocks = (in.count + 15) / 16;
    for (std::size_t b = 0; b < blocks; ++b) {
        const float* block = in.spheres + (in.first / 16 + b) * 64;
        std::uint32_t seen = 0, within = 0;
        for (std::size_t l = 0; l < 16; l += hn::Lanes(d)) {
            const VF x = hn::Load(d, block + l), y = hn::Load(d, block + 16 + l), z = hn::Load(d, block + 32 + l),
                     r = hn::Load(d, block + 48 + l);
            VF least = hn::Set(d, 3e38f);
            for (unsigned i = 0; i < planes.count; ++i) {
                const VF value =
                    hn::MulAdd(hn::Set(d, planes.x[i]), x,
                               hn::MulAdd(hn::Set(d, planes.y[i]), y,
                                          hn::MulAdd(hn::Set(d, planes.z[i]), z, hn::Set(d, planes.offset[i]))));
                least = hn::Min(least, value);
            }
            const MF maybe = hn::Ge(hn::Add(least, r), hn::Neg(slack));
            const MF inside = hn::And(maybe, hn::Ge(hn::Sub(least, r), slack));
            const MF undecided = hn::AndNot(inside, maybe);
            seen |= bits_of(maybe) << l;
            within |= bits_of(inside) << l;
            const auto mask = hn::RebindMask(du, undecided);
            hn::StoreU(hn::Compress(hn::Iota(du, static_cast<std::uint32_t>(in.first + 16 * b + l)), mask), du,
                       open + open_count);
            open_count += hn::CountTrue(du, mask);
        }
        const std::size_t word = (in.first + 16 * b) / 64, shift = 16 * b % 64;
        out.visible[word] |= std::uint64_t{seen} << shift;
        out.inside[word] |= std::uint64_t{within} << shift;
    }
}

// One box against all planes at once, a plane a lane.
HWY_NOINLINE void test_boxes(const FlatKernelInput& in, const Planes& planes, FlatKernelOutput& out,
                             const std::uint32_t* open, std::size_t open_count) {
    const DF d;
    const std::size_t lanes = hn::Lanes(d);
    for (std::size_t n = 0; n < open_count; ++n) {
        const std::uint32_t i = open[n];
        const float* box = in.records + std::size_t{12} * i;
        const float radius = in.spheres[i / 16 * 64 + 48 + i % 16];
        std::uint32_t out_bits = 0, pass_bits = 0, open_bits = 0, cross_bits = 0, center_bits = 0;
        for (std::size_t l = 0; l < planes.count; l += lanes) {
            const VF x = hn::Load(d, planes.x + l), y = hn::Load(d, planes.y + l), z = hn::Load(d, planes.z + l);
            // The half edges' rounding and that of the sums over them: 5 · 2^-24 · √3 of the radius.
            const VF slack = hn::MulAdd(hn::Set(d, radius), hn::Set(d, 0x1p-19f), hn::Load(d, planes.slack + l));
            const VF middle = hn::MulAdd(
                hn::Set(d, box[0]), x,
                hn::MulAdd(hn::Set(d, box[1]), y, hn::MulAdd(hn::Set(d, box[2]), z, hn::Load(d, planes.offset + l))));
            VF reach = hn::Abs(
                hn::MulAdd(hn::Set(d, box[3]), x, hn::MulAdd(hn::Set(d, box[4]), y, hn::Mul(hn::Set(d, box[5]), z))));
            for (unsigned k = 6; k < 12; k += 3)
                reach = hn::Add(reach, hn::Abs(hn::MulAdd(
                                           hn::Set(d, box[k]), x,
                                           hn::MulAdd(hn::Set(d, box[k + 1]), y, hn::Mul(hn::Set(d, box[k + 2]), z)))));
            const VF top = hn::Add(middle, reach), bottom = hn::Sub(middle, reach), below = hn::Neg(slack);
            out_bits |= bits_of(hn::Lt(top, below)) << l;
            pass_bits |= bits_of(hn::Ge(top, slack)) << l;
            open_bits |= bits_of(hn::Not(hn::Ge(bottom, slack))) << l;
            cross_bits |= bits_of(hn::Lt(bottom, below)) << l;
            center_bits |= bits_of(hn::Ge(middle, slack)) << l;
        }
        const std::uint32_t all = (1u << planes.count) - 1;
        const std::uint64_t bit = std::uint64_t{1} << (i % 64);
        open_bits &= all;
        if (out_bits & all) {
            out.visible[i / 64] &= ~bit;
        } else if (open_bits == 0) {
            out.inside[i / 64] |= bit;
        } else {
            // A box that crosses one plane and lies inside all others meets the frustum; so does one whose centre is
            // inside.
            const bool meets = !in.exact || (open_bits & (open_bits - 1)) == 0 || (center_bits & all) == all;
            if (!((pass_bits & all) == all && (cross_bits & all) && meets)) out.undecided[out.undecided_count++] = i;
        }
    }
}

void RunFlat(const FlatKernelInput& input, FlatKernelOutput& output) {
    const Planes planes(input);
    // Small pieces: the list of open boxes stays in the first-level cache.
    constexpr std::size_t kPiece = 1024;
    std::uint32_t open[kPiece + 16];
    FlatKernelInput piece = input;
    for (std::size_t begin = 0; begin < input.count; begin += kPiece) {
        piece.first = input.first + begin;
        piece.count = std::min(kPiece, input.count - begin);
        std::size_t open_count = 0;
        test_spheres(piece, planes, output, open, open_count);
        test_boxes(piece, planes, output, open, open_count);
        output.records_tested += open_count;
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
