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
#include <cstdint>
#include <limits>

#include "culler_data.hpp"
#include "faces-inl.hpp"
#include "near_faces-inl.hpp"
#include "projection-inl.hpp"
#include "raster-inl.hpp"
#include "tiles-inl.hpp"

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
        : picture_(picture), object_(object), patch_(patch) {}

    std::uint64_t run() {
        if (patch_.unclear)
            set_near_faces();
        else
            set_faces();
        list_live();
        if (object_.hides) {
            close_edges();
            exclude_corners();
        }
        std::uint64_t visible = 0;
        std::uint32_t i = 0;
        for (; i < live_count_ && live_[i] < patch_.own_triangles; ++i)
            if (draw_own(live_[i])) visible |= std::uint64_t{1} << live_[i];
        for (; i < live_count_; ++i) draw_seam(live_[i]);
        return visible;
    }

  private:
    [[nodiscard]] Faces& faces(std::uint32_t t) { return faces_[t / Faces::kCount]; }
    [[nodiscard]] const Faces& faces(std::uint32_t t) const { return faces_[t / Faces::kCount]; }
    static std::uint32_t lane(std::uint32_t t) { return t % Faces::kCount; }
    [[nodiscard]] std::int32_t flags(std::uint32_t t) const { return faces(t).flags[lane(t)]; }

    [[nodiscard]] ClusterState state_of(std::uint32_t t) const {
        return patch_.states[patch_.ring_clusters[t - patch_.own_triangles]];
    }

    template <class Place>
    HWY_INLINE void transform(const Place& place) {
        const DF d;
        const std::size_t padded = (patch_.vertex_count + 7) / 8 * 8;
        const float* const xs = patch_.coordinates;
        for (std::size_t i = 0; i < padded; i += hn::Lanes(d)) {
            const VF x = hn::Load(d, xs + i), y = hn::Load(d, xs + padded + i), z = hn::Load(d, xs + 2 * padded + i);
            VF clip[4];
            for (int k = 0; k < 4; ++k)
                clip[k] = hn::Add(hn::Add(hn::Add(hn::Mul(hn::Set(d, object_.columns[0][k]), x),
                                                  hn::Mul(hn::Set(d, object_.columns[1][k]), y)),
                                          hn::Mul(hn::Set(d, object_.columns[2][k]), z)),
                                  hn::Set(d, object_.columns[3][k]));
            place(clip, i);
        }
    }

    // In pixels: all vertices are in front of the near plane.
    HWY_INLINE void set_faces() {
        const DF d;
        const VF half_width = hn::Set(d, picture_.half_width), half_height = hn::Set(d, picture_.half_height);
        // A triangle around the cluster is usable if no nearer than the cluster, whose margins hold for it then.
        const VF least_w = hn::Set(d, patch_.least_w), near_share = hn::Set(d, picture_.near_share);
        const VF front = hn::Set(d, 8.0f * (object_.errors[2] + object_.errors[3]));
        transform([&](const VF(&clip)[4], std::size_t i) {
            const VF inverse = hn::Div(hn::Set(d, 1.0f), clip[3]);
            hn::Store(hn::Add(hn::Mul(hn::Mul(clip[0], inverse), half_width), half_width), d, vertices_.x + i);
            hn::Store(hn::Add(hn::Mul(hn::Mul(clip[1], inverse), half_height), half_height), d, vertices_.y + i);
            hn::Store(hn::Mul(clip[2], inverse), d, vertices_.z + i);
            const auto usable =
                hn::And(hn::Ge(clip[3], least_w), hn::Gt(hn::Sub(hn::Mul(near_share, clip[3]), clip[2]), front));
            hn::Store(hn::IfThenElseZero(usable, hn::Set(d, 1.0f)), d, vertices_.usable + i);
        });
        const float w = patch_.least_w - 8.0f * object_.errors[3];
        move_ = picture_.grid + pixel_error(picture_, object_, w);
        gather();
        const FaceSetup setup(picture_, object_, move_, (object_.errors[2] + object_.errors[3]) / w);
        for (std::uint32_t t = 0; t < patch_.all_triangles; t += Faces::kCount) setup.run(faces(t));
    }

    // The corners of the triangles that may be drawn.
    void gather() {
        const std::uint32_t padded = (patch_.all_triangles + Faces::kCount - 1) / Faces::kCount * Faces::kCount;
        for (std::uint32_t t = 0; t < padded; ++t) {
            Faces& f = faces(t);
            const std::uint32_t i = lane(t);
            const std::uint16_t* const c = patch_.corners + 3 * std::min(t, patch_.all_triangles - 1);
            bool given = t < patch_.all_triangles && c[0] != c[1] && c[1] != c[2] && c[2] != c[0];
            if (t >= patch_.own_triangles && given)
                given = state_of(t) != ClusterState::undecided && vertices_.usable[c[0]] != 0.0f &&
                        vertices_.usable[c[1]] != 0.0f && vertices_.usable[c[2]] != 0.0f;
            f.flags[i] = given ? Faces::drawn : 0;
            for (int k = 0; k < 3; ++k) {
                f.number[k][i] = c[k];
                f.x[k][i] = vertices_.x[c[k]], f.y[k][i] = vertices_.y[c[k]], f.z[k][i] = vertices_.z[c[k]];
            }
        }
    }

    void set_near_faces() {
        const DF d;
        transform([&](const VF(&clip)[4], std::size_t i) {
            hn::Store(clip[0], d, vertices_.x + i);
            hn::Store(clip[1], d, vertices_.y + i);
            hn::Store(clip[2], d, vertices_.z + i);
            hn::Store(clip[3], d, vertices_.w + i);
        });
        const NearFaceSetup setup(picture_, object_);
        move_ = setup.move();
        for (std::uint32_t t = 0; t < patch_.all_triangles; ++t) {
            const bool own = t < patch_.own_triangles;
            for (std::uint32_t k = 0; k < 3; ++k) faces(t).number[k][lane(t)] = patch_.corners[3 * t + k];
            setup.set(faces(t), lane(t), vertices_, own || state_of(t) != ClusterState::undecided, limits_[t]);
        }
    }

    // Those that may ask or draw.
    HWY_INLINE void list_live() {
        for (std::uint32_t t = 0; t < patch_.all_triangles; ++t) {
            const std::int32_t needed =
                t < patch_.own_triangles ? Faces::drawn : std::int32_t{Faces::drawn} | Faces::solid;
            live_[live_count_] = static_cast<std::uint16_t>(t);
            live_count_ += (flags(t) & needed) == needed;
        }
    }

    // True if it may own a sample.
    HWY_INLINE bool draw_own(std::uint32_t t) {
        const std::int32_t f = flags(t);
        const bool always = (f & Faces::always) != 0, draws = object_.hides && (f & Faces::solid) != 0;
        if (always && !draws) return true;
        Rasterizer raster(picture_.tiles, picture_.infinitely_far, faces(t), lane(t));
        if (raster.covers_nothing()) return always;
        if (!always && !raster.shows()) return false;
        const NearLimits& limits = limits_[t];
        if (draws) raster.draw(limits.lines, always ? limits.count : 0, excluded_);
        return true;
    }

    // A triangle around the cluster has been drawn before, but for the seam between them: only that is left.
    HWY_INLINE void draw_seam(std::uint32_t t) {
        if (!object_.hides || state_of(t) != ClusterState::drawn) return;
        const Faces& f = faces(t);
        const std::uint32_t i = lane(t);
        if (closed_[t] == 0) return;
        Line lines[3];
        std::uint32_t count = 0;
        if ((flags(t) & Faces::always) != 0)
            for (; count < limits_[t].count; ++count) lines[count] = limits_[t].lines[count];
        if (std::has_single_bit(closed_[t])) {
            const auto k = static_cast<std::uint32_t>(std::countr_zero(closed_[t]));
            const float infinity = std::numeric_limits<float>::infinity();
            const float at = f.at_x[k][i], width = 8.0f * move_ * (1.0f + std::abs(f.per_row[k][i]));
            const bool right = f.high[k][i] == infinity;
            lines[count++] = {f.per_row[k][i], f.at_y[k][i], right ? -infinity : at - width,
                              right ? at + width : infinity};
        }
        Rasterizer raster(picture_.tiles, picture_.infinitely_far, f, i);
        if (!raster.covers_nothing()) raster.draw(lines, count, excluded_);
    }

    HWY_INLINE void close_edges() {
        for (std::uint32_t i = 0; i < live_count_; ++i) {
            closed_[live_[i]] = 0;
            widest_[live_[i]] = faces(live_[i]).steps[lane(live_[i])];
        }
        for (std::uint32_t i = 0; i < live_count_ && live_[i] < patch_.own_triangles; ++i) {
            const std::uint32_t t = live_[i];
            const std::int32_t f = flags(t);
            if ((f & 7 * Faces::closable) == 0) continue;
            for (std::uint32_t k = 0; k < 3; ++k) {
                if ((f & Faces::closable << k) == 0) continue;
                const std::uint32_t other = patch_.neighbors[3 * t + k];
                if (other == ClusteredMesh::kNone || (other < t && other < patch_.own_triangles)) continue;
                const std::int32_t g = flags(other);
                if (((f ^ g) & (Faces::front | Faces::back)) != 0) continue;
                const std::uint32_t back = edge_to(other, t);
                if (back == 3 || (g & Faces::closable << back) == 0) continue;
                close(t, k, other);
                close(other, back, t);
            }
        }
        for (std::uint32_t i = 0; i < live_count_; ++i) {
            Faces& f = faces(live_[i]);
            // Neighbours' are among them by now.
            f.below[lane(live_[i])] += widest_[live_[i]];
        }
    }

    HWY_INLINE void close(std::uint32_t t, std::uint32_t k, std::uint32_t other) {
        Faces& f = faces(t);
        const Faces& g = faces(other);
        const std::uint32_t i = lane(t), j = lane(other);
        closed_[t] = static_cast<std::uint8_t>(closed_[t] | 1u << k);
        f.farthest[i] = std::min(f.farthest[i], g.own_farthest[j]);
        widest_[t] = std::max(widest_[t], g.steps[j]);
        const bool right = f.high[k][i] == std::numeric_limits<float>::infinity();
        (right ? f.low : f.high)[k][i] = f.at_x[k][i];
    }

    [[nodiscard]] std::uint32_t edge_to(std::uint32_t t, std::uint32_t other) const {
        for (std::uint32_t k = 0; k < 3; ++k)
            if (patch_.neighbors[3 * t + k] == other) return k;
        return 3;
    }

    // The samples at corners where the surface ends.
    HWY_INLINE void exclude_corners() {
        bool closes = false;
        std::fill_n(radius_, (patch_.vertex_count + 7) / 8 * 8, 0.0f);
        for (std::uint32_t i = 0; i < live_count_; ++i) {
            const std::uint32_t t = live_[i];
            if (closed_[t] == 0) continue;  // all of its edges keep the distance
            closes = true;
            const Faces& f = faces(t);
            for (std::uint32_t k = 0; k < 3; ++k) {
                if ((closed_[t] & (1u << k | 1u << (k == 0 ? 2 : k - 1))) == 0) continue;
                float& radius = radius_[f.number[k][lane(t)]];
                radius = std::max(radius, f.corner[k][lane(t)]);
            }
        }
        if (!closes) return;
        std::fill_n(ends_, patch_.vertex_count, std::uint8_t{0});
        for (std::uint32_t t = 0; t < patch_.own_triangles; ++t) {
            const std::uint16_t* const c = patch_.corners + 3 * t;
            const std::uint32_t closed = (flags(t) & Faces::drawn) != 0 ? closed_[t] : 0u;
            for (std::uint32_t k = 0; k < 3; ++k)
                if ((closed >> k & 1) == 0) ends_[c[k]] = ends_[c[k == 2 ? 0 : k + 1]] = 1;
        }
        for (std::uint32_t v = 0; v < patch_.vertex_count; ++v)
            if (radius_[v] > 0.0f && (ends_[v] != 0 || patch_.enclosed[v] == 0)) exclude_near(v);
    }

    HWY_INLINE void exclude_near(std::uint32_t v) {
        float x = vertices_.x[v], y = vertices_.y[v];
        if (patch_.unclear) {
            const float w = vertices_.w[v];
            if (!(w > 0.0f)) return;
            x = x / w * picture_.half_width + picture_.half_width;
            y = y / w * picture_.half_height + picture_.half_height;
        }
        const float r = std::min(radius_[v], kMaxCorner);
        const auto width = static_cast<float>(picture_.tiles.width), height = static_cast<float>(picture_.tiles.height);
        if (!(x > -1.0f && x < width + 1.0f && y > -1.0f && y < height + 1.0f)) return;
        const std::int32_t x0 = first_sample(x - r, width), x1 = last_sample(x + r, width);
        if (x0 > x1) return;
        const std::int32_t y1 = last_sample(y + r, height);
        for (std::int32_t j = first_sample(y - r, height); j <= y1; ++j)
            for (std::int32_t i = x0; i <= x1; ++i)
                if (excluded_.count < ExcludedSamples::kMax)
                    excluded_.samples[excluded_.count++] = {static_cast<std::uint16_t>(i),
                                                            static_cast<std::uint16_t>(j)};
                else
                    for (std::uint32_t t = 0; t < patch_.all_triangles; ++t) faces(t).flags[lane(t)] &= ~Faces::solid;
    }

    const PictureData& picture_;
    const ObjectData& object_;
    const PatchData& patch_;
    float move_ = 0.0f;
    std::uint16_t live_[kMaxPatchTriangles + 1];
    std::uint32_t live_count_ = 0;
    std::uint8_t closed_[kMaxPatchTriangles];  // edges, one bit each
    float widest_[kMaxPatchTriangles];         // of its steps and those beyond closed edges
    ExcludedSamples excluded_;
    PatchVertices vertices_;
    alignas(32) float radius_[kMaxPatchVertices];
    std::uint8_t ends_[kMaxPatchVertices];
    Faces faces_[kMaxPatchTriangles / Faces::kCount];
    NearLimits limits_[kMaxPatchTriangles];
};

}  // namespace crofton::depth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
