// SPDX-License-Identifier: MIT
// A cluster's triangles in the picture, eight at a time. Compiled once per instruction set (Highway).
#include <hwy/highway.h>
#include <cstdint>
#include <limits>

#include "culler_data.hpp"
#include "projection-inl.hpp"
#include "tiles-inl.hpp"

#if defined(CROFTON_DEPTH_FACES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_DEPTH_FACES_INL
#undef CROFTON_DEPTH_FACES_INL
#else
#define CROFTON_DEPTH_FACES_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::depth::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// A cluster's vertices: in pixels and nearness, or in clip coordinates where it reaches the near plane.
struct PatchVertices {
    alignas(64) float x[kMaxPatchVertices], y[kMaxPatchVertices], z[kMaxPatchVertices], w[kMaxPatchVertices];
};

// A line through the picture's rows: a row's samples on it are at at_x + per_row · (y − at_y), where at_x is `low` for
// those that what is right of it may cover, and `high` for what is left.
struct Line {
    float per_row, at_y;
    float low, high;  // −∞ and ∞ where the line is no limit
};

// What is known of eight triangles.
struct Faces {
    static constexpr std::uint32_t kCount = kTile;

    enum Flag : std::int32_t {
        drawn = 1,  // by the renderer: not a back face that it drops
        solid = 2,  // surely covers the samples well inside of it
        front = 4,  // neither: seen so nearly edge-on that its side is unknown
        back = 8,
        closable = 16,  // and the two bits beyond: whether edge k may be closed
        always = 128,   // visible, whatever the tiles say
        longest = 256,  // times the longest edge's number
    };
    alignas(32) std::int32_t flags[kCount];

    // Edge k leads from corner k to k + 1. Two triangles that share an edge have the same line.
    alignas(32) float per_row[3][kCount], at_x[3][kCount], at_y[3][kCount];
    alignas(32) float low[3][kCount], high[3][kCount];          // samples between them are surely inside
    alignas(32) float ask_low[3][kCount], ask_high[3][kCount];  // those beyond are surely outside
    alignas(32) float corner[3][kCount];  // at corner k neither neighbour is surely there within this many pixels

    alignas(32) std::int32_t x0[kCount], y0[kCount], x1[kCount], y1[kCount];  // samples; within the picture
    alignas(32) float middle_x[kCount], middle_y[kCount];                     // a sample near the middle
    // nearness = base + across · (x − plane_x) + up · (y − plane_y)
    alignas(32) float across[kCount], up[kCount], plane_x[kCount], plane_y[kCount], base[kCount];
    alignas(32) float below[kCount];    // the picture's nearness is at most this much less
    alignas(32) float above[kCount];    // and at most this much more
    alignas(32) float nearest[kCount];  // and never more than this
    alignas(32) float steps[kCount];    // what it may change by within the grid
};

// Depth differences across an edge that are not worth a hole there.
inline constexpr float kSmoothShare = 0x1p-7f;
inline constexpr float kMaxCorner = 0.5f;
// Lines are at most this flat, in rows per column.
inline constexpr float kFlattest = 0x1p-22f;

// Sets up the triangles of a cluster that lies before the near plane.
class FaceSetup {
  public:
    // move: by how many pixels a vertex may lie elsewhere. Its nearness may be off by depth_error, and by depth_share
    // of itself.
    FaceSetup(const PictureData& picture, const ObjectData& object, const Projection& projection,
              const PatchVertices& vertices, float move, float depth_error, float depth_share)
        : picture_(picture),
          object_(object),
          projection_(projection),
          vertices_(vertices),
          move_(move),
          depth_error_(depth_error),
          depth_share_(depth_share + 0x1p-19f) {}

    HWY_INLINE void run(const PatchBlock& block, Faces& faces) const {
        const DF d;
        for (std::size_t i = 0; i < Faces::kCount; i += hn::Lanes(d)) set(block, faces, i);
    }

  private:
    using DI = hn::RebindToSigned<DF>;
    using VI = hn::Vec<DI>;
    using Mask = hn::Mask<DF>;

    static HWY_INLINE VF l1(VF x, VF y) { return hn::Add(hn::Abs(x), hn::Abs(y)); }

    HWY_INLINE void set(const PatchBlock& block, Faces& f, std::size_t i) const {
        const DF d;
        const DI integers;
        VI number[3];
        VF x[3], y[3], z[3];
        for (int k = 0; k < 3; ++k) {
            number[k] = hn::PromoteTo(integers, hn::LoadU(hn::Rebind<std::uint8_t, DI>(), block.corners[k] + i));
            x[k] = hn::GatherIndex(d, vertices_.x, number[k]);
            y[k] = hn::GatherIndex(d, vertices_.y, number[k]);
            z[k] = hn::GatherIndex(d, vertices_.z, number[k]);
        }
        const VF low_x = hn::Min(hn::Min(x[0], x[1]), x[2]), high_x = hn::Max(hn::Max(x[0], x[1]), x[2]);
        const VF low_y = hn::Min(hn::Min(y[0], y[1]), y[2]), high_y = hn::Max(hn::Max(y[0], y[1]), y[2]);
        const VF size = hn::Add(hn::Sub(high_x, low_x), hn::Sub(high_y, low_y));
        // Edges reach far beyond the picture: their rounding grows with that.
        const VF move = hn::Add(hn::Set(d, move_), hn::Mul(size, hn::Set(d, 0x1p-20f)));
        const VF dx1 = hn::Sub(x[1], x[0]), dy1 = hn::Sub(y[1], y[0]);
        const VF dx2 = hn::Sub(x[2], x[0]), dy2 = hn::Sub(y[2], y[0]);
        const VF area = hn::Sub(hn::Mul(dx1, dy2), hn::Mul(dx2, dy1));
        const VF thin =
            hn::Add(hn::Mul(hn::Mul(hn::Set(d, 4.0f), move), size), hn::Mul(hn::Mul(hn::Set(d, 16.0f), move), move));
        const Mask front = hn::Gt(area, thin), back = hn::Lt(area, hn::Neg(thin)), faced = hn::Or(front, back);
        const auto equal =
            hn::Or(hn::Or(hn::Eq(number[0], number[1]), hn::Eq(number[1], number[2])), hn::Eq(number[2], number[0]));
        const Mask given = hn::Not(hn::RebindMask(d, equal));
        const Mask drawn = object_.one_sided ? hn::AndNot(back, given) : given;
        if (hn::AllFalse(d, drawn)) return hn::Store(hn::Zero(integers), integers, f.flags + i);

        set_rectangle(f, i, hn::Sub(low_x, move), hn::Add(high_x, move), hn::Sub(low_y, move), hn::Add(high_y, move));
        const VF third = hn::Set(d, 1.0f / 3.0f);
        set_middle(f, i, hn::Mul(hn::Add(hn::Add(x[0], x[1]), x[2]), third),
                   hn::Mul(hn::Add(hn::Add(y[0], y[1]), y[2]), third));

        const VF nearest = hn::Max(hn::Max(z[0], z[1]), z[2]), farthest = hn::Min(hn::Min(z[0], z[1]), z[2]);
        const VF rounding = hn::Add(hn::Set(d, depth_error_),
                                    hn::Mul(hn::Set(d, depth_share_), hn::Max(hn::Abs(nearest), hn::Abs(farthest))));
        hn::Store(hn::Min(hn::Add(nearest, rounding), hn::Set(d, projection_.nearest)), d, f.nearest + i);

        // Of triangles thinner than the grid only the rectangle is known, and the nearest corner.
        const VF inverse = hn::Div(hn::Set(d, 1.0f), area);
        const VF z1 = hn::Sub(z[1], z[0]), z2 = hn::Sub(z[2], z[0]);
        const VF across = hn::IfThenElseZero(faced, hn::Mul(hn::Sub(hn::Mul(z1, dy2), hn::Mul(z2, dy1)), inverse));
        const VF up = hn::IfThenElseZero(faced, hn::Mul(hn::Sub(hn::Mul(z2, dx1), hn::Mul(z1, dx2)), inverse));
        hn::Store(across, d, f.across + i);
        hn::Store(up, d, f.up + i);
        hn::Store(x[0], d, f.plane_x + i);
        hn::Store(y[0], d, f.plane_y + i);
        hn::Store(hn::IfThenElse(faced, z[0], nearest), d, f.base + i);
        const VF steps = hn::Mul(hn::Mul(hn::Set(d, 8.0f), move), l1(across, up));
        hn::Store(steps, d, f.steps + i);
        // Finite wherever the plane is asked.
        const Mask solid = hn::And(drawn, hn::And(faced, hn::Lt(steps, hn::Set(d, 1e18f))));
        // The plane's own rounding, which narrow triangles magnify.
        const VF narrow = hn::Add(hn::Set(d, 1.0f), hn::Mul(hn::Mul(size, size), hn::Abs(inverse)));
        const VF plane =
            hn::IfThenElseZero(faced, hn::Mul(hn::Mul(hn::Set(d, 0x1p-19f), hn::Sub(nearest, farthest)), narrow));
        const VF below = hn::Add(rounding, plane);
        hn::Store(below, d, f.below + i);
        hn::Store(hn::Add(below, hn::Mul(hn::Set(d, 0.5f), steps)), d, f.above + i);

        const VF lengths[3] = {l1(dx1, dy1), l1(hn::Sub(x[2], x[1]), hn::Sub(y[2], y[1])), l1(dx2, dy2)};
        const VF share = hn::Mul(hn::Mul(hn::Set(d, 4.0f), move), hn::Abs(inverse));
        const VF corners[3] = {hn::Mul(share, hn::Mul(lengths[0], lengths[2])),
                               hn::Mul(share, hn::Mul(lengths[1], lengths[0])),
                               hn::Mul(share, hn::Mul(lengths[2], lengths[1]))};
        for (int k = 0; k < 3; ++k) hn::Store(corners[k], d, f.corner[k] + i);
        for (int k = 0; k < 3; ++k) set_edge(f, i, k, number, x, y, move, front, faced);

        const VF far = hn::Set(d, picture_.infinitely_far);
        const VF depth = hn::Max(hn::Sub(hn::Add(nearest, rounding), far),
                                 hn::Sub(far, hn::Sub(hn::Sub(farthest, rounding), steps)));
        const Mask smooth = hn::And(solid, hn::Lt(steps, hn::Mul(hn::Set(d, kSmoothShare), depth)));
        Mask sharp[3];
        for (int k = 0; k < 3; ++k) sharp[k] = hn::Le(corners[k], hn::Set(d, kMaxCorner));
        VI flags = flag_where(drawn, Faces::drawn);
        flags = hn::Or(flags, flag_where(solid, Faces::solid));
        flags = hn::Or(flags, flag_where(front, Faces::front));
        flags = hn::Or(flags, flag_where(back, Faces::back));
        for (int k = 0; k < 3; ++k)
            flags = hn::Or(
                flags, flag_where(hn::And(smooth, hn::And(sharp[k], sharp[k == 2 ? 0 : k + 1])), Faces::closable << k));
        const Mask last = hn::Gt(lengths[2], hn::Max(lengths[0], lengths[1])), middle = hn::Gt(lengths[1], lengths[0]);
        flags = hn::Or(flags, flag_where(last, 2 * Faces::longest));
        flags = hn::Or(flags, flag_where(hn::AndNot(last, middle), Faces::longest));
        hn::Store(flags, DI(), f.flags + i);
    }

    static HWY_INLINE VI flag_where(Mask where, std::int32_t flag) {
        const DI d;
        return hn::IfThenElseZero(hn::RebindMask(d, where), hn::Set(d, flag));
    }

    // Within the cluster's: what hides the cluster then hides its triangles, too.
    HWY_INLINE void set_rectangle(Faces& f, std::size_t i, VF low_x, VF high_x, VF low_y, VF high_y) const {
        const DF d;
        const DI integers;
        const auto from = [&](VF sample, std::uint16_t least) {
            return hn::Max(hn::ConvertTo(integers, sample), hn::Set(integers, least));
        };
        const auto to = [&](VF sample, std::uint16_t most) {
            return hn::Min(hn::ConvertTo(integers, sample), hn::Set(integers, most));
        };
        const VF width = hn::Set(d, static_cast<float>(picture_.tiles.width));
        const VF height = hn::Set(d, static_cast<float>(picture_.tiles.height));
        hn::Store(from(first_samples(low_x, width), projection_.x0), integers, f.x0 + i);
        hn::Store(to(last_samples(high_x, width), projection_.x1), integers, f.x1 + i);
        hn::Store(from(first_samples(low_y, height), projection_.y0), integers, f.y0 + i);
        hn::Store(to(last_samples(high_y, height), projection_.y1), integers, f.y1 + i);
    }

    HWY_INLINE void set_middle(Faces& f, std::size_t i, VF x, VF y) const {
        const DF d;
        const DI integers;
        const auto within = [&](VF v, const std::int32_t* low, const std::int32_t* high) {
            const VF from = hn::ConvertTo(d, hn::Load(integers, low + i));
            const VF to = hn::ConvertTo(d, hn::Load(integers, high + i));
            return hn::Add(hn::Max(from, hn::Min(hn::Floor(v), to)), hn::Set(d, 0.5f));
        };
        hn::Store(within(x, f.x0, f.x1), d, f.middle_x + i);
        hn::Store(within(y, f.y0, f.y1), d, f.middle_y + i);
    }

    // From the vertex with the lower number to the other, so that both triangles of an edge have the same line.
    HWY_INLINE void set_edge(Faces& f, std::size_t i, int k, const VI (&number)[3], const VF (&x)[3], const VF (&y)[3],
                             VF move, Mask front, Mask faced) const {
        const DF d;
        const int n = k == 2 ? 0 : k + 1;
        const Mask forward = hn::RebindMask(d, hn::Lt(number[k], number[n]));
        const VF from_x = hn::IfThenElse(forward, x[k], x[n]), from_y = hn::IfThenElse(forward, y[k], y[n]);
        const VF dx = hn::Sub(hn::IfThenElse(forward, x[n], x[k]), from_x);
        const VF dy = hn::Sub(hn::IfThenElse(forward, y[n], y[k]), from_y);
        const VF steep = hn::Max(hn::Abs(dy), hn::Max(hn::Mul(hn::Abs(dx), hn::Set(d, kFlattest)),
                                                      hn::Set(d, std::numeric_limits<float>::min())));
        const VF per_row = hn::Div(dx, hn::CopySign(steep, dy));
        // The triangle lies right of an edge that leads down, along the triangle's own turn.
        const Mask down = hn::Lt(dy, hn::Zero(d));
        const Mask right = hn::Xor(hn::Xor(forward, front), down);
        // Without an area the lines are no limit.
        const VF infinity = hn::Set(d, std::numeric_limits<float>::infinity());
        const VF offset = hn::Mul(move, hn::Add(hn::Set(d, 1.0f), hn::Abs(per_row)));
        const VF less = hn::Sub(from_x, offset), more = hn::Add(from_x, offset);
        const Mask limits_low = hn::And(right, faced), limits_high = hn::AndNot(right, faced);
        hn::Store(hn::IfThenElse(limits_low, more, hn::Neg(infinity)), d, f.low[k] + i);
        hn::Store(hn::IfThenElse(limits_low, less, hn::Neg(infinity)), d, f.ask_low[k] + i);
        hn::Store(hn::IfThenElse(limits_high, less, infinity), d, f.high[k] + i);
        hn::Store(hn::IfThenElse(limits_high, more, infinity), d, f.ask_high[k] + i);
        hn::Store(per_row, d, f.per_row[k] + i);
        hn::Store(from_x, d, f.at_x[k] + i);
        hn::Store(from_y, d, f.at_y[k] + i);
    }

    const PictureData& picture_;
    const ObjectData& object_;
    const Projection& projection_;
    const PatchVertices& vertices_;
    float move_, depth_error_, depth_share_;
};

}  // namespace crofton::depth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
