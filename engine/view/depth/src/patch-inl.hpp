// SPDX-License-Identifier: MIT
// A cluster's triangles, asked and drawn. Compiled once per instruction set (Highway).
//
// A renderer covers a sample by some triangle of a closed surface, but which one is known only up to its grid. So what
// is drawn here is
// - inside all edges that end the surface in this picture, by more than the grid;
// - up to the very edge between two triangles that both cover the picture;
// - not where a sample lies so close to a corner of such an end that a neighbour may be missing there;
// - not nearer than the triangle and those neighbours may be.
#include <hwy/highway.h>
#include <algorithm>
#include <bit>
#include <cmath>
#include <crofton/simd/mask_bits-inl.hpp>
#include <cstdint>
#include <limits>

#include "culler_data.hpp"
#include "faces-inl.hpp"
#include "near_faces-inl.hpp"
#include "projection-inl.hpp"
#include "raster-inl.hpp"
#include "tiles-inl.hpp"
#include "unpack-inl.hpp"

#if defined(CROFTON_DEPTH_PATCH_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_DEPTH_PATCH_INL
#undef CROFTON_DEPTH_PATCH_INL
#else
#define CROFTON_DEPTH_PATCH_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::depth::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

class PatchDrawer {
  public:
    PatchDrawer(const PictureData& picture, const ObjectData& object, const PatchData& patch)
        : picture_(picture),
          object_(object),
          projection_(patch.projection),
          patch_(patch.patch),
          unclear_(projection_.is_unclear()),
          errors_(clip_errors(object, patch.bound)) {}

    std::uint64_t run() {
        PatchUnpacker(patch_).read();
        if (unclear_)
            set_near_faces();
        else
            set_clear_faces();
        for (std::uint64_t left = drawn_; left != 0; left &= left - 1)
            visit(static_cast<std::uint32_t>(std::countr_zero(left)));
        return visible_;
    }

    // Asks which triangles of an unclear cluster show. Triangles well before the near plane are asked as those of other
    // clusters. The cluster is drawn already, but triangles of the nearest surface still show against it.
    std::uint64_t ask() {
        PatchUnpacker(patch_).read();
        float least_w = std::numeric_limits<float>::infinity();
        const std::uint64_t clear = find_clear(least_w);
        if (clear == 0) return ~std::uint64_t{0};
        set_places(least_w);
        set_faces(least_w - 2.0f * errors_.w);
        std::uint64_t shown = ~clear;
        for (std::uint64_t left = clear & drawn_; left != 0; left &= left - 1) {
            const auto t = static_cast<std::uint32_t>(std::countr_zero(left));
            if (shows(t)) shown |= bit_of(t);
        }
        return shown;
    }

  private:
    [[nodiscard]] Faces& faces(std::uint32_t t) { return faces_[t / Faces::kCount]; }
    static constexpr std::uint8_t kUnknown = 0xff;

    static std::uint64_t bit_of(std::uint32_t t) { return std::uint64_t{1} << t; }
    static std::uint32_t lane(std::uint32_t t) { return t % Faces::kCount; }

    template <class Place>
    HWY_INLINE void transform(const Place& place) {
        const DF d;
        const auto& coordinates = patch_.coordinates;
        for (std::size_t i = 0; i < padded(patch_.vertex_count); i += hn::Lanes(d)) {
            const VF x = hn::Load(d, coordinates[0] + i), y = hn::Load(d, coordinates[1] + i);
            const VF z = hn::Load(d, coordinates[2] + i);
            VF clip[4];
            for (int k = 0; k < 4; ++k)
                clip[k] = hn::Add(hn::Add(hn::Add(hn::Mul(hn::Set(d, object_.columns[0][k]), x),
                                                  hn::Mul(hn::Set(d, object_.columns[1][k]), y)),
                                          hn::Mul(hn::Set(d, object_.columns[2][k]), z)),
                                  hn::Set(d, object_.columns[3][k]));
            place(clip, i);
        }
    }

    // In pixels; the vertices that are wanted are at least `least_w` before the eye.
    HWY_INLINE void set_places(float least_w) {
        const DF d;
        const VF half_width = hn::Set(d, picture_.half_width), half_height = hn::Set(d, picture_.half_height);
        const VF middle_x = hn::Set(d, picture_.middle_x), middle_y = hn::Set(d, picture_.middle_y);
        const VF least = hn::Set(d, least_w);
        transform([&](const VF(&clip)[4], std::size_t i) {
            const VF inverse = hn::Div(hn::Set(d, 1.0f), hn::Max(clip[3], least));
            hn::Store(hn::Add(hn::Mul(hn::Mul(clip[0], inverse), half_width), middle_x), d, vertices_.x + i);
            hn::Store(hn::Add(hn::Mul(hn::Mul(clip[1], inverse), half_height), middle_y), d, vertices_.y + i);
            hn::Store(hn::Mul(clip[2], inverse), d, vertices_.z + i);
        });
    }

    // Sets up the faces. All vertices must be at least w before the eye.
    HWY_INLINE void set_faces(float w) {
        const float move = picture_.grid + pixel_error(picture_, errors_, w);
        const FaceSetup setup(picture_, object_, projection_, vertices_, move, errors_.z / w, errors_.w / w);
        for (std::uint32_t b = 0; b * Faces::kCount < patch_.triangle_count; ++b) {
            setup.run(patch_.blocks[b], faces_[b]);
            note(b);
        }
    }

    // The triangles all of whose corners are before the near plane, and not so near that products move them by more
    // than those of other clusters; the least w of a corner.
    HWY_INLINE std::uint64_t find_clear(float& least_w) {
        const DF d;
        const float limit = pixel_error(picture_, errors_, kMaxPixelError) + 2.0f * errors_.w;
        const VF margin = hn::Set(d, 2.0f * (errors_.z + errors_.w)), share = hn::Set(d, picture_.near_share);
        transform([&](const VF(&clip)[4], std::size_t i) {
            const auto in_front = hn::Gt(hn::Sub(hn::Mul(share, clip[3]), clip[2]), margin);
            hn::Store(hn::IfThenElseZero(in_front, clip[3]), d, vertices_.w + i);
        });
        std::uint64_t clear = 0;
        for (std::uint32_t t = 0; t < patch_.triangle_count; ++t) {
            const auto w = [&](std::size_t k) { return vertices_.w[patch_.corner(t, k)]; };
            const float least = std::min({w(0), w(1), w(2)});
            if (!(least > limit)) continue;
            clear |= bit_of(t);
            least_w = std::min(least_w, least);
        }
        return clear;
    }

    // All vertices are in front of the near plane.
    HWY_INLINE void set_clear_faces() {
        set_places(std::numeric_limits<float>::min());
        set_faces(projection_.least_w - 2.0f * errors_.w);
    }

    void set_near_faces() {
        const DF d;
        transform([&](const VF(&clip)[4], std::size_t i) {
            hn::Store(clip[0], d, vertices_.x + i);
            hn::Store(clip[1], d, vertices_.y + i);
            hn::Store(clip[2], d, vertices_.z + i);
            hn::Store(clip[3], d, vertices_.w + i);
        });
        const NearFaceSetup setup(picture_, object_, errors_);
        for (std::uint32_t b = 0; b * Faces::kCount < patch_.triangle_count; ++b) {
            for (std::uint32_t i = 0; i < Faces::kCount; ++i)
                setup.set(patch_.blocks[b], i, vertices_, faces_[b], limits_[b * Faces::kCount + i]);
            note(b);
        }
    }

    // Which triangles of a block are drawn, and which are solid.
    HWY_INLINE void note(std::uint32_t block) {
        const hn::RebindToSigned<DF> d;
        const auto having = [&](std::int32_t flag) {
            std::uint64_t bits = 0;
            for (std::size_t i = 0; i < Faces::kCount; i += hn::Lanes(d)) {
                const auto flags = hn::And(hn::Load(d, faces_[block].flags + i), hn::Set(d, flag));
                bits |= std::uint64_t{simd::HWY_NAMESPACE::mask_bits(d, hn::Eq(flags, hn::Set(d, flag)))} << i;
            }
            return bits << block * Faces::kCount;
        };
        drawn_ |= having(Faces::drawn);
        solid_ |= having(Faces::solid);
    }

    // Asks a triangle, and draws it if it shows. Two that are drawn as one are drawn when the second has been asked, if
    // either shows: so strips in which only one of them shows have the same depth at each step.
    HWY_INLINE void visit(std::uint32_t t) {
        const bool shown = (faces(t).flags[lane(t)] & Faces::always) != 0 || shows(t);
        if (shown) visible_ |= bit_of(t);
        if (!hides(t)) return;
        if (shown)
            close_surface();
        else if (!surface_is_closed_ || partners_[t] >= t)  // else the first of two shows
            return;
        if (hides(t) && partner_of(t) <= t) draw(t, partners_[t]);
    }

    // As one, if there is another.
    HWY_INLINE void draw(std::uint32_t t, std::uint32_t other) {
        Line lines[Rasterizer::kMaxLines];
        std::uint32_t count = append_lines(t, other == t, lines);
        if (other != t) {
            count += append_lines(other, false, lines + count);
            widen(t, other);
        } else if (unclear_) {
            for (std::uint32_t k = 0; k < limits_[t].count; ++k) lines[count++] = limits_[t].lines[k];
        }
        rasterizer(t).draw(lines, count, excluded_);
    }

    [[nodiscard]] HWY_INLINE Rasterizer rasterizer(std::uint32_t t) {
        return {picture_.tiles, band_, picture_.infinitely_far, faces(t), lane(t)};
    }
    [[nodiscard]] HWY_INLINE bool shows(std::uint32_t t) {
        Rasterizer raster = rasterizer(t);
        return !raster.covers_nothing() && raster.shows();
    }

    [[nodiscard]] bool hides(std::uint32_t t) const { return object_.hides && (solid_ >> t & 1) != 0; }

    // Before the first triangle is drawn; clusters of which none shows do without.
    void close_surface() {
        if (surface_is_closed_) return;
        surface_is_closed_ = true;
        PatchUnpacker(patch_).find_neighbors(solid_);
        close_edges();
        exclude_corners();
        std::fill_n(partners_, patch_.triangle_count, kUnknown);
    }

    HWY_INLINE void close_edges() {
        for (std::uint32_t b = 0; b * Faces::kCount < patch_.triangle_count; ++b)
            for (std::size_t i = 0; i < Faces::kCount; i += hn::Lanes(DF())) close_edges_of(b, i);
    }

    // Of the triangles in the lanes from `i`.
    HWY_INLINE void close_edges_of(std::uint32_t block, std::size_t i) {
        const DF d;
        const hn::RebindToSigned<DF> integers;
        const auto all = [&](std::int32_t v) { return hn::Set(integers, v); };
        Faces& f = faces_[block];
        const auto flags = hn::Load(integers, f.flags + i);
        VF widest = hn::Load(d, f.steps + i);
        auto closed = hn::Zero(integers);
        for (int k = 0; k < 3; ++k) {
            const auto across = hn::PromoteTo(integers, hn::LoadU(hn::Rebind<std::uint8_t, decltype(integers)>(),
                                                                  patch_.blocks[block].neighbors[k] + i));
            // Where the neighbour's numbers are, counted from those of the first triangle.
            const auto at = hn::Add(hn::Mul(hn::ShiftRight<5>(across), all(sizeof(Faces) / sizeof(float))),
                                    hn::And(hn::ShiftRight<2>(across), all(Faces::kCount - 1)));
            const auto others = hn::GatherIndex(integers, faces_[0].flags, at);
            const VF steps = hn::GatherIndex(d, faces_[0].steps, at);
            const auto both = hn::And(hn::ShiftRightSame(flags, k), hn::Shr(others, hn::And(across, all(3))));
            const auto may_close = hn::Ne(hn::And(both, all(Faces::closable)), all(0));
            const auto alike = hn::Eq(hn::And(hn::Xor(flags, others), all(Faces::front | Faces::back)), all(0));
            const auto closes = hn::And(hn::Ne(across, all(kNoNeighbor)), hn::And(may_close, alike));
            closed = hn::Or(closed, hn::IfThenElseZero(closes, all(1 << k)));
            const auto here = hn::RebindMask(d, closes);
            widest = hn::IfThenElse(here, hn::Max(widest, steps), widest);
            const VF low = hn::Load(d, f.low[k] + i), high = hn::Load(d, f.high[k] + i), x = hn::Load(d, f.at_x[k] + i);
            const auto right = hn::Eq(high, hn::Set(d, std::numeric_limits<float>::infinity()));
            hn::Store(hn::IfThenElse(hn::And(here, right), x, low), d, f.low[k] + i);
            hn::Store(hn::IfThenElse(hn::AndNot(right, here), x, high), d, f.high[k] + i);
        }
        hn::Store(hn::Add(hn::Load(d, f.below + i), widest), d, f.below + i);
        // Corner k lies between the edges k and k − 1. If neither is closed, both keep the distance.
        const auto before = hn::Or(hn::ShiftLeft<1>(closed), hn::ShiftRight<2>(closed));
        const auto rounded = hn::Or(closed, before), ends = hn::AndNot(hn::And(closed, before), all(7));
        for (int k = 0; k < 3; ++k) {
            const auto keeps = hn::RebindMask(d, hn::Ne(hn::And(rounded, all(1 << k)), all(0)));
            hn::Store(hn::IfThenElseZero(keeps, hn::Load(d, f.corner[k] + i)), d, f.corner[k] + i);
        }
        hn::Store(hn::Or(closed, hn::ShiftLeft<kEnds>(ends)), integers, closed_ + block * Faces::kCount + i);
    }

    // The triangle with which `t` is drawn as one, or `t`: tiles along their common edge are then written once. The
    // edge is the longest of both, they form a convex shape, and one plane is within the margins of both.
    [[nodiscard]] HWY_INLINE std::uint32_t partner_of(std::uint32_t t) {
        if (partners_[t] != kUnknown) return partners_[t];
        partners_[t] = static_cast<std::uint8_t>(t);
        const std::uint32_t k = longest_edge(t), across = patch_.blocks[t / Faces::kCount].neighbors[k][lane(t)];
        if (unclear_ || (closed_[t] >> k & 1) == 0 || longest_edge(across / 4) != across % 4) return t;
        const std::uint32_t other = across / 4;
        const bool extended = t > other ? extends(t, k, other, across % 4) : extends(other, across % 4, t, k);
        partners_[other] = static_cast<std::uint8_t>(extended ? t : other);
        if (extended) partners_[t] = static_cast<std::uint8_t>(other);
        return partners_[t];
    }
    [[nodiscard]] std::uint32_t longest_edge(std::uint32_t t) {
        return static_cast<std::uint32_t>(faces(t).flags[lane(t)] / Faces::longest);
    }

    // Widens the margin of `t` so that its plane holds for the triangle across edge k, too; false if that is too much.
    HWY_INLINE bool extends(std::uint32_t t, std::uint32_t k, std::uint32_t other, std::uint32_t other_k) {
        const auto corner = [&](std::uint32_t of, std::uint32_t i) {
            return std::uint32_t{patch_.blocks[of / Faces::kCount].corners[i % 3][lane(of)]};
        };
        const std::uint32_t from = corner(t, k), to = corner(t, k + 1), tip = corner(t, k + 2);
        const std::uint32_t other_tip = corner(other, other_k + 2);
        const float *const x = vertices_.x, *const y = vertices_.y;
        const auto side = [&](std::uint32_t v) {
            return (x[other_tip] - x[tip]) * (y[v] - y[tip]) - (x[v] - x[tip]) * (y[other_tip] - y[tip]);
        };
        if (!(side(from) * side(to) < 0.0f)) return false;
        Faces& f = faces(t);
        const Faces& g = faces(other);
        const std::uint32_t i = lane(t), j = lane(other);
        const float right = f.across[i] * (x[other_tip] - f.plane_x[i]), up = f.up[i] * (y[other_tip] - f.plane_y[i]);
        const float off =
            std::abs(vertices_.z[other_tip] - ((f.base[i] + right) + up)) + 0x1p-20f * (std::abs(right) + std::abs(up));
        const float below = f.below[i] + g.below[j];
        if (!(off <= below)) return false;
        f.below[i] = below + off;
        return true;
    }

    // But for the common edge of two.
    HWY_INLINE std::uint32_t append_lines(std::uint32_t t, bool alone, Line* to) {
        const Faces& f = faces(t);
        const std::uint32_t i = lane(t), common = alone ? 3 : longest_edge(t);
        std::uint32_t count = 0;
        for (std::uint32_t k = 0; k < 3; ++k)
            if (k != common) to[count++] = {f.per_row[k][i], f.at_y[k][i], f.low[k][i], f.high[k][i]};
        return count;
    }

    HWY_INLINE void widen(std::uint32_t t, std::uint32_t other) {
        Faces& f = faces(t);
        const Faces& g = faces(other);
        const std::uint32_t i = lane(t), j = lane(other);
        f.x0[i] = std::min(f.x0[i], g.x0[j]), f.x1[i] = std::max(f.x1[i], g.x1[j]);
        f.y0[i] = std::min(f.y0[i], g.y0[j]), f.y1[i] = std::max(f.y1[i], g.y1[j]);
    }

    // The samples at corners where the surface ends: where an edge there is not closed.
    HWY_INLINE void exclude_corners() {
        std::fill_n(radius_, padded(patch_.vertex_count), 0.0f);
        std::fill_n(ends_, patch_.vertex_count, std::uint8_t{0});
        for (std::uint64_t left = solid_; left != 0; left &= left - 1) {
            const auto t = static_cast<std::uint32_t>(std::countr_zero(left));
            const PatchBlock& block = patch_.blocks[t / Faces::kCount];
            const Faces& f = faces(t);
            const auto ends = static_cast<std::uint32_t>(closed_[t]) >> kEnds;
            for (std::uint32_t k = 0; k < 3; ++k) {
                const std::uint8_t corner = block.corners[k][lane(t)];
                radius_[corner] = std::max(radius_[corner], f.corner[k][lane(t)]);
                ends_[corner] |= static_cast<std::uint8_t>(ends >> k & 1);
            }
        }
        const DF d;
        for (std::uint32_t v = 0; v < patch_.vertex_count; v += static_cast<std::uint32_t>(hn::Lanes(d)))
            if (has_samples(v))
                for (std::uint32_t i = v; i < std::min(v + hn::Lanes(d), std::size_t{patch_.vertex_count}); ++i)
                    if (radius_[i] > 0.0f) settle_corner(i);
    }

    // False if no sample is within the radius of one of the vertices at `v`.
    HWY_INLINE bool has_samples(std::uint32_t v) const {
        if (unclear_) return true;
        const DF d;
        const VF radius = hn::Min(hn::Load(d, radius_ + v), hn::Set(d, kMaxCorner)), half = hn::Set(d, 0.5f);
        const auto near = [&](const float* at) {
            const VF p = hn::Sub(hn::Load(d, at + v), half);
            return hn::Ge(hn::Floor(hn::Add(p, radius)), hn::Sub(p, radius));
        };
        return !hn::AllFalse(d, hn::And(hn::Gt(radius, hn::Zero(d)), hn::And(near(vertices_.x), near(vertices_.y))));
    }

    // Samples so near a corner that a renderer may take them from any of its triangles, or from none where the surface
    // ends.
    HWY_INLINE void settle_corner(std::uint32_t v) {
        float x = vertices_.x[v], y = vertices_.y[v];
        if (unclear_) {
            const float w = vertices_.w[v];
            if (!(w > 0.0f)) return;
            x = x / w * picture_.half_width + picture_.middle_x;
            y = y / w * picture_.half_height + picture_.middle_y;
        }
        const float r = std::min(radius_[v], kMaxCorner);
        const auto width = static_cast<float>(picture_.tiles.width), height = static_cast<float>(picture_.tiles.height);
        if (!(x > -1.0f && x < width + 1.0f && y > -1.0f && y < height + 1.0f)) return;
        const std::int32_t x0 = first_sample(x - r, width), x1 = last_sample(x + r, width);
        const std::int32_t y0 = first_sample(y - r, height), y1 = last_sample(y + r, height);
        if (x0 > x1 || y0 > y1) return;
        if (ends_[v] == 0) return take_steepest_around(v);
        for (std::int32_t j = y0; j <= y1; ++j)
            for (std::int32_t i = x0; i <= x1; ++i)
                if (excluded_.count < ExcludedSamples::kMax)
                    excluded_.add(i, j);
                else
                    solid_ = 0;
    }

    // No triangle around the corner says that it is nearer than any other of them may be there.
    void take_steepest_around(std::uint32_t v) {
        float widest = 0.0f;
        for_triangles_around(v, [&](Faces& f, std::uint32_t i) { widest = std::max(widest, f.steps[i]); });
        for_triangles_around(v, [&](Faces& f, std::uint32_t i) { f.below[i] += widest; });
    }
    template <class Use>
    void for_triangles_around(std::uint32_t v, const Use& use) {
        for (std::uint64_t left = solid_; left != 0; left &= left - 1) {
            const auto t = static_cast<std::uint32_t>(std::countr_zero(left));
            const PatchBlock& block = patch_.blocks[t / Faces::kCount];
            for (const auto& corners : block.corners)
                if (corners[lane(t)] == v) use(faces(t), lane(t));
        }
    }

    const PictureData& picture_;
    const ObjectData& object_;
    const Projection& projection_;
    Patch& patch_;
    const bool unclear_;  // in clip coordinates
    const ClipErrors errors_;
    std::uint64_t drawn_ = 0, solid_ = 0, visible_ = 0;  // triangles
    static constexpr int kEnds = 3;
    alignas(
        64) std::int32_t closed_[Cluster::kMaxTriangles];  // edges, one bit each; from kEnds, corners at other edges
    std::uint8_t partners_[Cluster::kMaxTriangles];
    bool surface_is_closed_ = false;
    ExcludedSamples excluded_;
    PatchVertices vertices_;
    Band band_;
    alignas(64) float radius_[kMaxPatchVertices];
    std::uint8_t ends_[kMaxPatchVertices];
    Faces faces_[Cluster::kMaxTriangles / Faces::kCount];
    NearLimits limits_[Cluster::kMaxTriangles];
};

}  // namespace crofton::depth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
