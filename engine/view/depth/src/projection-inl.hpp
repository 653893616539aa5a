// SPDX-License-Identifier: MIT
// Projects the boxes of objects and clusters into the picture, eight at a time. Compiled once per instruction set
// (Highway).
#include <hwy/highway.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "culler_data.hpp"
#include "tiles-inl.hpp"

#if defined(CROFTON_DEPTH_PROJECTION_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_DEPTH_PROJECTION_INL
#undef CROFTON_DEPTH_PROJECTION_INL
#else
#define CROFTON_DEPTH_PROJECTION_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::depth::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Of |product computed − product of reals|, for a vertex as the renderer and as we compute it, in any order: each is at
// most 4 · 2^-24 · Σ |terms|, and no coordinate of the cluster is larger than its box's reach. The rounding of the sum
// itself is in the last factor.
inline constexpr float kErrorShare = 0x1.00002p-21f;

HWY_INLINE ClipErrors clip_errors(const ObjectData& object, const ClusterBox& box) {
    float reach[3], errors[4];
    for (int k = 0; k < 3; ++k)
        reach[k] = (std::abs((&box.center.x)[k]) + std::abs((&box.half_edges[0].x)[k])) +
                   (std::abs((&box.half_edges[1].x)[k]) + std::abs((&box.half_edges[2].x)[k]));
    for (int i = 0; i < 4; ++i) {
        const float terms = (std::abs(object.columns[0][i]) * reach[0] + std::abs(object.columns[1][i]) * reach[1]) +
                            (std::abs(object.columns[2][i]) * reach[2] + std::abs(object.columns[3][i]));
        errors[i] = kErrorShare * terms + object.moved[i];
    }
    return {errors[0], errors[1], errors[2], errors[3]};
}

// Pixels by which errors of clip coordinates may move a vertex, at a distance w from the eye, in or near the picture.
HWY_INLINE float pixel_error(const PictureData& picture, const ClipErrors& errors, float w) {
    const float x = (errors.x + 2.0f * errors.w) * picture.half_width;
    const float y = (errors.y + 2.0f * errors.w) * picture.half_height;
    return std::max(x, y) / w;
}

// A cluster whose vertices may move by more is drawn in clip coordinates, and listed always.
inline constexpr float kMaxPixelError = 0.25f;

// Half-open coordinates to the samples within, which lie at halves.
HWY_INLINE std::int32_t first_sample(float low, float limit) {
    return static_cast<std::int32_t>(std::ceil(std::min(std::max(low - 0.5f, 0.0f), limit)));
}
HWY_INLINE std::int32_t last_sample(float high, float limit) {
    return static_cast<std::int32_t>(std::floor(std::min(std::max(high - 0.5f, -1.0f), limit - 1.0f)));
}

HWY_INLINE VF first_samples(VF low, VF limit) {
    const DF d;
    return hn::Ceil(hn::Min(hn::Max(hn::Sub(low, hn::Set(d, 0.5f)), hn::Zero(d)), limit));
}
HWY_INLINE VF last_samples(VF high, VF limit) {
    const DF d;
    const VF one = hn::Set(d, 1.0f);
    return hn::Floor(hn::Min(hn::Max(hn::Sub(high, hn::Set(d, 0.5f)), hn::Neg(one)), hn::Sub(limit, one)));
}

// A box in each lane, and the matrix that takes it to clip coordinates.
struct BoxLanes {
    VF columns[4][4], moved[4];
    VF center[3], half_edges[3][3];
};

// The corners of boxes in clip coordinates, each off by at most 6 · 2^-24 · Σ |terms|. As vertices of the renderer are
// off by 4, they are within 1.25 times ClipErrors of the corners' hull.
class ClipBoxes {
  public:
    // kAligned: half_edges[k] is along axis k, and its other coordinates are not read.
    template <bool kAligned>
    static HWY_INLINE ClipBoxes of(const BoxLanes& box) {
        const DF d;
        ClipBoxes clip;
        VF reach[3];
        for (int k = 0; k < 3; ++k)
            if constexpr (kAligned)
                reach[k] = hn::Add(hn::Abs(box.center[k]), hn::Abs(box.half_edges[k][k]));
            else
                reach[k] = hn::Add(hn::Add(hn::Abs(box.center[k]), hn::Abs(box.half_edges[0][k])),
                                   hn::Add(hn::Abs(box.half_edges[1][k]), hn::Abs(box.half_edges[2][k])));
        for (int i = 0; i < 4; ++i) {
            clip.middle_[i] = hn::Add(product(box, box.center, i), box.columns[3][i]);
            for (int k = 0; k < 3; ++k)
                if constexpr (kAligned)
                    clip.edges_[k][i] = hn::Mul(box.columns[k][i], box.half_edges[k][k]);
                else
                    clip.edges_[k][i] = product(box, box.half_edges[k], i);
            const VF terms = hn::Add(
                hn::Add(hn::Mul(hn::Abs(box.columns[0][i]), reach[0]), hn::Mul(hn::Abs(box.columns[1][i]), reach[1])),
                hn::Add(hn::Mul(hn::Abs(box.columns[2][i]), reach[2]), hn::Abs(box.columns[3][i])));
            clip.errors_[i] = hn::Add(hn::Mul(hn::Set(d, kErrorShare), terms), box.moved[i]);
        }
        return clip;
    }

    // As clip_errors().
    [[nodiscard]] HWY_INLINE const VF (&errors() const)[4] { return errors_; }

    // Calls visit(x, y, z, w) for each corner.
    template <class Visit>
    HWY_INLINE void each_corner(const Visit& visit) const {
        VF near[4][2], across[4][2];  // middle ± the first edge; the second edge ± the third
        for (int i = 0; i < 4; ++i) {
            near[i][0] = hn::Sub(middle_[i], edges_[0][i]), near[i][1] = hn::Add(middle_[i], edges_[0][i]);
            across[i][0] = hn::Sub(edges_[1][i], edges_[2][i]), across[i][1] = hn::Add(edges_[1][i], edges_[2][i]);
        }
        for (int a = 0; a < 2; ++a)
            for (int b = 0; b < 2; ++b) {
                VF less[4], more[4];
                for (int i = 0; i < 4; ++i)
                    less[i] = hn::Sub(near[i][a], across[i][b]), more[i] = hn::Add(near[i][a], across[i][b]);
                visit(less[0], less[1], less[2], less[3]);
                visit(more[0], more[1], more[2], more[3]);
            }
    }

    // True of boxes beyond a side of the picture or before the near plane. Unlike a rectangle in the picture this is
    // known of boxes behind the eye, too. The renderer's grid needs no margin: the outermost samples are a
    // sixteenth of a pixel from the side, or farther.
    [[nodiscard]] auto are_outside(float near_share) const {
        const DF d;
        const VF infinity = hn::Set(d, std::numeric_limits<float>::infinity()), two = hn::Set(d, 2.0f);
        VF right = infinity, left = infinity, above = infinity, below = infinity, behind = hn::Neg(infinity);
        each_corner([&](VF x, VF y, VF z, VF w) {
            right = hn::Min(right, hn::Sub(x, w)), left = hn::Min(left, hn::Sub(hn::Neg(x), w));
            above = hn::Min(above, hn::Sub(y, w)), below = hn::Min(below, hn::Sub(hn::Neg(y), w));
            behind = hn::Max(behind, hn::Sub(hn::Mul(hn::Set(d, near_share), w), z));
        });
        const VF limit = hn::Mul(two, hn::Add(hn::Max(errors_[0], errors_[1]), errors_[3]));
        const VF most = hn::Max(hn::Max(right, left), hn::Max(above, below));
        return hn::Or(hn::Gt(most, limit), hn::Lt(behind, hn::Mul(hn::Neg(two), hn::Add(errors_[2], errors_[3]))));
    }

  private:
    static HWY_INLINE VF product(const BoxLanes& box, const VF (&v)[3], int i) {
        return hn::Add(hn::Add(hn::Mul(box.columns[0][i], v[0]), hn::Mul(box.columns[1][i], v[1])),
                       hn::Mul(box.columns[2][i], v[2]));
    }

    VF middle_[4], edges_[3][4], errors_[4];
};

// What Projection holds, of a box in each lane. Samples are integers.
struct Projections {
    VF x0, x1, y0, y1, nearest, least_w;

    // Where one of the two is unclear it has the samples and the nearness of the other.
    HWY_INLINE void intersect(const Projection& within) {
        const DF d;
        x0 = hn::Max(x0, hn::Set(d, static_cast<float>(within.x0)));
        x1 = hn::Min(x1, hn::Set(d, static_cast<float>(within.x1)));
        y0 = hn::Max(y0, hn::Set(d, static_cast<float>(within.y0)));
        y1 = hn::Min(y1, hn::Set(d, static_cast<float>(within.y1)));
        nearest = hn::Min(nearest, hn::Set(d, within.nearest));
    }

    // Writes the first `count`, or all.
    HWY_INLINE void store(Projection* to, std::size_t count = kTile) const {
        const DF d;
        const hn::RebindToSigned<DF> integers;
        const auto nothing = hn::Or(hn::Gt(x0, x1), hn::Gt(y0, y1));
        const auto pack = [&](VF low, VF high) {
            const auto bits = hn::Or(hn::ConvertTo(integers, low), hn::ShiftLeft<16>(hn::ConvertTo(integers, high)));
            return hn::BitCast(d, bits);
        };
        const VF zero = hn::Zero(d), one = hn::Set(d, 1.0f);
        const VF x = pack(hn::IfThenElse(nothing, one, x0), hn::IfThenElse(nothing, zero, x1));
        const VF y = pack(hn::IfThenElse(nothing, one, y0), hn::IfThenElse(nothing, zero, y1));
        static_assert(sizeof(Projection) == 4 * sizeof(float));
        if (count < hn::Lanes(d)) {
            alignas(32) float parts[4][kTile];
            hn::Store(x, d, parts[0]), hn::Store(y, d, parts[1]);
            hn::Store(nearest, d, parts[2]), hn::Store(least_w, d, parts[3]);
            for (std::size_t i = 0; i < count; ++i) {
                const float one_of_them[4] = {parts[0][i], parts[1][i], parts[2][i], parts[3][i]};
                std::memcpy(to + i, one_of_them, sizeof one_of_them);
            }
            return;
        }
        alignas(32) float raw[4 * kTile];
        hn::StoreInterleaved4(x, y, nearest, least_w, d, raw);
        std::memcpy(to, raw, hn::Lanes(d) * sizeof(Projection));
    }
};

HWY_INLINE Projections project(const PictureData& picture, const ClipBoxes& boxes) {
    const DF d;
    const VF infinity = hn::Set(d, std::numeric_limits<float>::infinity()), two = hn::Set(d, 2.0f);
    VF least_w = infinity, before_near = infinity, low_x = infinity, low_y = infinity;
    VF high_x = hn::Neg(infinity), high_y = high_x, nearest = high_x;
    const VF near_share = hn::Set(d, picture.near_share);
    boxes.each_corner([&](VF x, VF y, VF z, VF w) {
        const VF inverse = hn::Div(hn::Set(d, 1.0f), w);
        least_w = hn::Min(least_w, w);
        before_near = hn::Min(before_near, hn::Sub(hn::Mul(near_share, w), z));
        x = hn::Mul(x, inverse), y = hn::Mul(y, inverse);
        low_x = hn::Min(low_x, x), high_x = hn::Max(high_x, x);
        low_y = hn::Min(low_y, y), high_y = hn::Max(high_y, y);
        nearest = hn::Max(nearest, hn::Mul(z, inverse));
    });
    const VF(&errors)[4] = boxes.errors();
    const VF half_width = hn::Set(d, picture.half_width), half_height = hn::Set(d, picture.half_height);
    const VF w = hn::Sub(least_w, hn::Mul(two, errors[3]));
    const auto in_front =
        hn::And(hn::Gt(w, hn::Zero(d)), hn::Gt(before_near, hn::Mul(two, hn::Add(errors[2], errors[3]))));
    // As pixel_error().
    const VF off_x = hn::Mul(hn::Add(errors[0], hn::Mul(two, errors[3])), half_width);
    const VF off_y = hn::Mul(hn::Add(errors[1], hn::Mul(two, errors[3])), half_height);
    const VF moved = hn::Div(hn::Max(off_x, off_y), w);
    const VF margin = hn::Mul(two, hn::Add(hn::Set(d, picture.grid), moved));
    const VF width = hn::Set(d, static_cast<float>(picture.tiles.width));
    const VF height = hn::Set(d, static_cast<float>(picture.tiles.height));
    const VF middle_x = hn::Set(d, picture.middle_x), middle_y = hn::Set(d, picture.middle_y);
    const auto low = [&](VF v, VF half, VF middle) { return hn::Sub(hn::Add(hn::Mul(v, half), middle), margin); };
    const auto high = [&](VF v, VF half, VF middle) { return hn::Add(hn::Add(hn::Mul(v, half), middle), margin); };
    const VF off_z = hn::Div(hn::Mul(two, hn::Add(errors[2], hn::Mul(hn::Abs(nearest), errors[3]))), w);
    nearest = hn::Add(nearest, hn::Add(off_z, hn::Mul(hn::Abs(nearest), hn::Set(d, 0x1p-20f))));
    const auto clear = hn::And(in_front, hn::And(hn::Lt(moved, hn::Set(d, kMaxPixelError)), hn::Lt(nearest, infinity)));
    const VF one = hn::Set(d, 1.0f);
    Projections result{
        hn::IfThenElseZero(clear, first_samples(low(low_x, half_width, middle_x), width)),
        hn::IfThenElse(clear, last_samples(high(high_x, half_width, middle_x), width), hn::Sub(width, one)),
        hn::IfThenElseZero(clear, first_samples(low(low_y, half_height, middle_y), height)),
        hn::IfThenElse(clear, last_samples(high(high_y, half_height, middle_y), height), hn::Sub(height, one)),
        hn::IfThenElse(clear, nearest, infinity),
        hn::IfThenElseZero(clear, least_w)};
    if (hn::AllTrue(d, clear)) return result;
    const auto outside = hn::AndNot(clear, boxes.are_outside(picture.near_share));
    result.x1 = hn::IfThenElse(outside, hn::Neg(one), result.x1);
    return result;
}

// Numbers of `stride` elements each: one of what lies at `base`, one a lane, those beyond `count` the last one's.
template <class Number>
class Gather {
  public:
    Gather(const Number* base, std::int32_t stride, std::size_t count) : base_(base) {
        alignas(32) std::int32_t at[kTile];
        for (std::size_t i = 0; i < kTile; ++i) at[i] = static_cast<std::int32_t>(std::min(i, count - 1)) * stride;
        at_ = hn::Load(hn::RebindToSigned<DF>(), at);
    }
    HWY_INLINE auto operator()(std::size_t element) const {
        return hn::GatherIndex(hn::Rebind<Number, DF>(), base_ + element, at_);
    }

  private:
    const Number* base_;
    hn::Vec<hn::RebindToSigned<DF>> at_;
};

HWY_INLINE void set_boxes(BoxLanes& box, const ClusterBox* boxes, std::size_t count) {
    static_assert(sizeof(ClusterBox) % sizeof(float) == 0);
    const Gather<float> gather(&boxes->center.x, sizeof(ClusterBox) / sizeof(float), count);
    for (std::size_t k = 0; k < 3; ++k) {
        box.center[k] = gather(k);
        for (std::size_t e = 0; e < 3; ++e) box.half_edges[e][k] = gather(3 + 3 * e + k);
    }
}

HWY_INLINE void set_boxes(BoxLanes& box, const ClusteredMesh::PackedBox* boxes, std::size_t count) {
    constexpr auto kStride = static_cast<std::int32_t>(sizeof(*boxes) / sizeof(float));
    const DF d;
    const hn::RebindToSigned<DF> integers;
    const Gather<float> center(boxes->center, kStride, count);
    const Gather<std::int32_t> words(reinterpret_cast<const std::int32_t*>(boxes->words), kStride, count);
    for (std::size_t k = 0; k < 3; ++k) box.center[k] = center(k);
    const auto last = words(4);
    const auto exponent = hn::And(hn::ShiftRight<16>(last), hn::Set(integers, 0xff));
    const VF unit = hn::BitCast(d, hn::ShiftLeft<23>(exponent));
    const auto set = [&](std::size_t i, auto units) {
        box.half_edges[i / 3][i % 3] = hn::Mul(hn::ConvertTo(d, units), unit);
    };
    for (std::size_t i = 0; i < 8; i += 2) {
        const auto two = words(i / 2);
        set(i, hn::ShiftRight<16>(hn::ShiftLeft<16>(two)));
        set(i + 1, hn::ShiftRight<16>(two));
    }
    set(8, hn::ShiftRight<16>(hn::ShiftLeft<16>(last)));
}

template <class Box>
HWY_INLINE void project_some_boxes(const PictureData& picture, BoxLanes& box, const Projection& within,
                                   const Box* boxes, std::size_t count, Projection* to) {
    set_boxes(box, boxes, count);
    Projections found = project(picture, ClipBoxes::of<false>(box));
    found.intersect(within);
    found.store(to);
}

// Sets the matrices of objects; returns those that can be placed.
HWY_INLINE auto set_matrices(BoxLanes& box, const PictureData& picture, const DepthObject* objects, std::size_t count,
                             const VF (&largest)[3]) {
    static_assert(sizeof(DepthObject) % sizeof(float) == 0);
    const DF d;
    const Gather<float> gather(&objects->to_clip[0][0], sizeof(DepthObject) / sizeof(float), count);
    alignas(32) float errors[kTile];
    for (std::size_t i = 0; i < hn::Lanes(d); ++i) errors[i] = objects[std::min(i, count - 1)].position_error;
    const VF error = hn::Load(d, errors);
    VF sum = hn::Zero(d);
    for (std::size_t i = 0; i < 4; ++i) {
        VF size = hn::Zero(d), moved = hn::Zero(d);
        for (std::size_t c = 0; c < 4; ++c) {
            VF& v = box.columns[c][i];
            v = gather(4 * c + i);
            if (i == 2) v = hn::Mul(v, hn::Set(d, picture.z_sign));
            if (c == 3) continue;
            size = hn::Add(size, hn::Mul(hn::Abs(v), largest[c]));
            moved = hn::Add(moved, hn::Abs(v));
        }
        box.moved[i] = hn::Mul(moved, error);
        sum = hn::Add(sum, hn::Add(size, hn::Abs(box.columns[3][i])));
    }
    const VF limit = hn::Set(d, 1e30f);
    return hn::And(hn::Lt(sum, limit), hn::And(hn::Ge(error, hn::Zero(d)), hn::Lt(error, limit)));
}

HWY_INLINE void project_some_objects(const PictureData& picture, const DepthObject* objects, std::size_t count,
                                     Projection* to) {
    const DF d;
    alignas(32) float numbers[9][kTile];
    for (std::size_t i = 0; i < hn::Lanes(d); ++i) {
        const ClusteredMesh& mesh = *objects[std::min(i, count - 1)].mesh;
        const ClusterBox bound = mesh.bound();
        const glm::vec3 largest = mesh.largest();
        for (glm::length_t k = 0; k < 3; ++k) {
            numbers[k][i] = bound.center[k];
            numbers[3 + k][i] = bound.half_edges[static_cast<std::size_t>(k)][k];
            numbers[6 + k][i] = largest[k];
        }
    }
    BoxLanes box;
    VF largest[3];
    for (std::size_t k = 0; k < 3; ++k) {
        box.center[k] = hn::Load(d, numbers[k]), box.half_edges[k][k] = hn::Load(d, numbers[3 + k]);
        largest[k] = hn::Load(d, numbers[6 + k]);
    }
    const auto placed = set_matrices(box, picture, objects, count, largest);
    Projections found = project(picture, ClipBoxes::of<true>(box));
    found.x1 = hn::IfThenElse(placed, found.x1, hn::Set(d, -1.0f));
    found.least_w = hn::IfThenElse(placed, found.least_w, hn::Set(d, -1.0f));
    found.store(to, count);
}

}  // namespace crofton::depth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
