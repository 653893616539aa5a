// SPDX-License-Identifier: MIT
// A cluster's triangles, made ready to be drawn. Compiled once per instruction set (Highway).
//
// A renderer covers a sample by some triangle of a closed surface, but which one is known only up to its grid. So what
// is drawn here is
// - inside all edges that end the surface in this picture, by more than the grid;
// - up to the very edge between two triangles that both cover the picture;
// - not where a sample lies so close to a corner of such an end that a neighbour may be missing there;
// - not nearer than the triangle and those neighbours may be.
#include <hwy/highway.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "culler_data.hpp"
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

enum class Facing : std::int8_t { back = -1, unclear = 0, front = 1 };

// What is known of a triangle before its neighbours are looked at.
struct Face {
    Raster raster;
    float steps;      // what the nearness may change by within the grid
    float corner[3];  // at corner k neither neighbour across the two edges is surely there within this many pixels
    Facing facing;
    bool drawn;  // by the renderer: not a back face that it drops
    bool solid;  // surely covers the samples well inside of it
    bool closed[3];
    float below, farthest;  // the raster's, with what closed edges add
};

class PatchDrawer {
  public:
    PatchDrawer(const PictureData& picture, const ObjectData& object, const PatchData& patch)
        : picture_(picture), object_(object), patch_(patch) {}

    std::uint64_t run() {
        transform();
        if (patch_.unclear)
            prepare_unclear();
        else
            prepare_all();
        if (object_.hides) {
            close_edges();
            exclude_corners();
        }
        std::uint64_t visible = 0;
        for (std::uint32_t i = 0; i < live_count_; ++i) {
            const std::uint32_t t = live_[i];
            Face& face = faces_[t];
            Raster& raster = face.raster;
            const bool own = t < patch_.own_triangles;
            raster.asks = own && !always_[t];
            raster.draws = object_.hides && face.solid && (own || is_drawn(t));
            if (own && always_[t]) visible |= std::uint64_t{1} << t;
            if (!raster.asks && !raster.draws) continue;
            if (raster.x0 > raster.x1 || raster.y0 > raster.y1) continue;
            if (!own && !keep_to_seam(t)) continue;
            if (!raster.asks)
                for (std::uint32_t k = 0; k < raster.edge_count; ++k) raster.edges[k].outer = raster.edges[k].inner;
            if (Rasterizer(picture_, raster, excluded_, excluded_count_).run() && own) visible |= std::uint64_t{1} << t;
        }
        return visible;
    }

  private:
    [[nodiscard]] ClusterState state_of(std::uint32_t t) const {
        return patch_.states[patch_.ring_clusters[t - patch_.own_triangles]];
    }
    [[nodiscard]] bool is_drawn(std::uint32_t t) const { return state_of(t) == ClusterState::drawn; }

    HWY_INLINE void transform() {
        const DF d;
        const std::size_t padded = (patch_.vertex_count + 7) / 8 * 8;
        const float* const xs = patch_.coordinates;
        const VF half_width = hn::Set(d, picture_.half_width), half_height = hn::Set(d, picture_.half_height);
        for (std::size_t i = 0; i < padded; i += hn::Lanes(d)) {
            const VF x = hn::Load(d, xs + i), y = hn::Load(d, xs + padded + i), z = hn::Load(d, xs + 2 * padded + i);
            VF clip[4];
            for (int k = 0; k < 4; ++k)
                clip[k] = hn::Add(hn::Add(hn::Add(hn::Mul(hn::Set(d, object_.columns[0][k]), x),
                                                  hn::Mul(hn::Set(d, object_.columns[1][k]), y)),
                                          hn::Mul(hn::Set(d, object_.columns[2][k]), z)),
                                  hn::Set(d, object_.columns[3][k]));
            hn::Store(clip[3], d, ws_ + i);
            if (patch_.unclear) {
                hn::Store(clip[0], d, xs_ + i);
                hn::Store(clip[1], d, ys_ + i);
                hn::Store(clip[2], d, zs_ + i);
                continue;
            }
            const VF inverse = hn::Div(hn::Set(d, 1.0f), clip[3]);
            hn::Store(hn::Add(hn::Mul(hn::Mul(clip[0], inverse), half_width), half_width), d, xs_ + i);
            hn::Store(hn::Add(hn::Mul(hn::Mul(clip[1], inverse), half_height), half_height), d, ys_ + i);
            hn::Store(hn::Mul(clip[2], inverse), d, zs_ + i);
        }
    }

    // In pixels: all vertices are in front of the near plane.
    void prepare_all() {
        const float w = patch_.least_w - 8.0f * object_.errors[3];
        move_ = picture_.grid + pixel_error(picture_, object_, w);
        depth_error_ = (object_.errors[2] + object_.errors[3]) / w;
        for (std::uint32_t t = 0; t < patch_.all_triangles; ++t) {
            prepare(t);
            note(t);
        }
    }

    // A triangle around the cluster: decided, and no nearer than the cluster, whose margins hold for it then.
    [[nodiscard]] bool is_usable(std::uint32_t t) const {
        if (state_of(t) == ClusterState::undecided) return false;
        const std::uint16_t* const c = patch_.corners + 3 * t;
        const float front = 8.0f * (object_.errors[2] + object_.errors[3]);
        for (int k = 0; k < 3; ++k) {
            const float w = ws_[c[k]];
            if (!(w >= patch_.least_w) || !((picture_.near_share - zs_[c[k]]) * w > front)) return false;
        }
        return true;
    }

    HWY_INLINE void prepare(std::uint32_t t) {
        Face& face = faces_[t];
        Raster& r = face.raster;
        const std::uint16_t* const c = patch_.corners + 3 * t;
        always_[t] = false;
        face.solid = false;
        face.drawn = c[0] != c[1] && c[1] != c[2] && c[2] != c[0];
        face.facing = Facing::unclear;
        if (!face.drawn || (t >= patch_.own_triangles && !is_usable(t))) return;
        const float x[3] = {xs_[c[0]], xs_[c[1]], xs_[c[2]]}, y[3] = {ys_[c[0]], ys_[c[1]], ys_[c[2]]},
                    z[3] = {zs_[c[0]], zs_[c[1]], zs_[c[2]]};
        const float low_x = std::min(std::min(x[0], x[1]), x[2]), high_x = std::max(std::max(x[0], x[1]), x[2]);
        const float low_y = std::min(std::min(y[0], y[1]), y[2]), high_y = std::max(std::max(y[0], y[1]), y[2]);
        // Edges reach far beyond the picture: their rounding grows with that.
        const float size = (high_x - low_x) + (high_y - low_y);
        const float move = move_ + size * 0x1p-21f;
        const float area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
        if (area > 4.0f * move * size + 16.0f * move * move)
            face.facing = Facing::front;
        else if (area < -(4.0f * move * size + 16.0f * move * move))
            face.facing = Facing::back;
        if (object_.one_sided && face.facing == Facing::back) {
            face.drawn = false;
            return;
        }
        const auto width = static_cast<float>(picture_.tiles.width), height = static_cast<float>(picture_.tiles.height);
        r.x0 = first_sample(low_x - move, width), r.x1 = last_sample(high_x + move, width);
        r.y0 = first_sample(low_y - move, height), r.y1 = last_sample(high_y + move, height);
        const float nearest = std::max(std::max(z[0], z[1]), z[2]), farthest = std::min(std::min(z[0], z[1]), z[2]);
        const float rounding = depth_error_ + 0x1p-19f * std::max(std::abs(nearest), std::abs(farthest));
        r.nearest = nearest + rounding, r.farthest = farthest - rounding;
        if (face.facing == Facing::unclear) {
            // Thinner than the grid: it may own any sample of its rectangle.
            r.across = r.up = 0.0f, r.at_x = r.at_y = 0.0f, r.base = nearest, r.above = rounding;
            set_whole_rectangle(r);
            return;
        }
        const float sign = face.facing == Facing::front ? 1.0f : -1.0f;
        r.edge_count = 3;
        float lengths[3];
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t n = k == 2 ? 0 : k + 1;
            const bool forward = c[k] < c[n];
            const std::uint32_t from = forward ? k : n, to = forward ? n : k;
            const float s = forward ? sign : -sign;
            Edge& e = r.edges[k];
            e.across = s * (y[from] - y[to]), e.up = s * (x[to] - x[from]);
            e.constant = 0.0f, e.at_x = x[from], e.at_y = y[from];
            lengths[k] = std::abs(e.across) + std::abs(e.up);
            e.inner = lengths[k] * move;
            e.outer = -e.inner;
        }
        const float inverse = 1.0f / area;
        const float z1 = z[1] - z[0], z2 = z[2] - z[0];
        r.across = (z1 * (y[2] - y[0]) - z2 * (y[1] - y[0])) * inverse;
        r.up = (z2 * (x[1] - x[0]) - z1 * (x[2] - x[0])) * inverse;
        r.at_x = x[0], r.at_y = y[0], r.base = z[0];
        face.steps = 8.0f * move * (std::abs(r.across) + std::abs(r.up));
        r.farthest -= face.steps;  // the bias moves the farthest vertex back as well
        // The plane's own rounding, which narrow triangles magnify.
        const float plane = 0x1p-19f * (nearest - farthest) * (1.0f + size * size * std::abs(inverse));
        r.below = rounding + plane;
        r.above = rounding + plane + 0.5f * face.steps;
        for (std::uint32_t k = 0; k < 3; ++k)
            face.corner[k] = 4.0f * move * lengths[k] * lengths[k == 0 ? 2 : k - 1] * std::abs(inverse);
        face.solid = true;
    }

    // Edges between the samples of the rectangle and those beside it; no sample is surely covered.
    static HWY_INLINE void set_whole_rectangle(Raster& r) {
        const float infinity = std::numeric_limits<float>::infinity();
        r.edge_count = 3;
        r.edges[2] = kEverywhere;
        r.edges[0] = {1.0f, 0.0f, 0.0f, static_cast<float>(r.x0), 0.0f, infinity, 0.0f};
        r.edges[1] = {-1.0f, 0.0f, 0.0f, static_cast<float>(r.x1 + 1), 0.0f, infinity, 0.0f};
        r.below = 0.0f;
    }

    // In homogeneous coordinates (Olano and Greer, "Triangle scan conversion using 2D homogeneous coordinates", 1997):
    // no clipping. Only what is farther than `near_w` hides, since products move what is nearer by too many pixels.
    void prepare_unclear() {
        constexpr float kError = 0x1p-6f;
        near_w_ = std::max(pixel_error(picture_, object_, kError), 64.0f * object_.errors[3]);
        near_w_ = std::max(near_w_, 1e-30f);
        move_ = picture_.grid + kError;
        depth_error_ = (object_.errors[2] + object_.errors[3]) / near_w_;
        for (std::uint32_t t = 0; t < patch_.all_triangles; ++t) {
            prepare_unclear(t);
            note(t);
        }
    }

    // Keeps it if it may ask or draw.
    HWY_INLINE void note(std::uint32_t t) {
        live_[live_count_] = static_cast<std::uint16_t>(t);
        live_count_ += faces_[t].drawn && (t < patch_.own_triangles || faces_[t].solid);
    }

    // Beyond a side of the picture or before the near plane, by more than products may be off.
    [[nodiscard]] bool is_outside(const std::uint16_t* c) const {
        const float side = 4.0f * (object_.errors[0] + object_.errors[1] + object_.errors[3]);
        const float front = 4.0f * (object_.errors[2] + object_.errors[3]);
        bool left = true, right = true, low = true, high = true, before = true;
        for (int k = 0; k < 3; ++k) {
            const float x = xs_[c[k]], y = ys_[c[k]], z = zs_[c[k]], w = ws_[c[k]];
            // A pixel's share, for the grid.
            const float edge = 1.01f * std::abs(w) + side;
            left = left && x < -edge, right = right && x > edge;
            low = low && y < -edge, high = high && y > edge;
            before = before && picture_.near_share * w - z < -front;
        }
        return left || right || low || high || before;
    }

    void prepare_unclear(std::uint32_t t) {
        Face& face = faces_[t];
        Raster& r = face.raster;
        const std::uint16_t* const c = patch_.corners + 3 * t;
        r.x0 = r.y0 = 0, r.x1 = r.y1 = -1;
        face.solid = false;
        face.facing = Facing::unclear;
        face.drawn = c[0] != c[1] && c[1] != c[2] && c[2] != c[0] && !is_outside(c);
        always_[t] = face.drawn;
        if (!face.drawn || !object_.hides) return;
        if (t >= patch_.own_triangles && state_of(t) == ClusterState::undecided) return;
        double p[3][3];
        for (int k = 0; k < 3; ++k) {
            const double w = ws_[c[k]];
            p[k][0] = xs_[c[k]] * double{picture_.half_width} + w * picture_.half_width;
            p[k][1] = ys_[c[k]] * double{picture_.half_height} + w * picture_.half_height;
            p[k][2] = w;
        }
        // Lines through two corners each, from the corner with the lower number to the other.
        double lines[3][3];
        bool forward[3];
        for (int k = 0; k < 3; ++k) {
            const int n = k == 2 ? 0 : k + 1;
            forward[k] = c[k] < c[n];
            const double* const a = forward[k] ? p[k] : p[n];
            const double* const b = forward[k] ? p[n] : p[k];
            lines[k][0] = a[1] * b[2] - a[2] * b[1];
            lines[k][1] = a[2] * b[0] - a[0] * b[2];
            lines[k][2] = a[0] * b[1] - a[1] * b[0];
        }
        const auto sign_of = [&](int k) { return forward[k] ? 1.0 : -1.0; };
        const double determinant =
            sign_of(0) * ((lines[0][0] * p[2][0] + lines[0][1] * p[2][1]) + lines[0][2] * p[2][2]);
        if (!(std::abs(determinant) > 0.0) || !(std::abs(determinant) < 1e300)) return;
        face.facing = determinant > 0.0 ? Facing::front : Facing::back;
        if (object_.one_sided && face.facing == Facing::back)
            return;  // listed all the same: near the plane it may show

        const double middle_x = picture_.half_width, middle_y = picture_.half_height;
        double depth[3] = {0, 0, 0}, inverse_w[3] = {0, 0, 0};
        r.edge_count = 3;
        std::fill(std::begin(r.edges), std::end(r.edges), kEverywhere);
        const float infinity = std::numeric_limits<float>::infinity();
        for (int k = 0; k < 3; ++k) {
            const double* const line = lines[k];
            const double length = std::abs(line[0]) + std::abs(line[1]);
            if (!(length > 0.0)) return;
            const double s = (determinant > 0.0 ? sign_of(k) : -sign_of(k));
            const double at = (line[0] * middle_x + line[1] * middle_y) + line[2];
            r.edges[k] = {static_cast<float>(s * line[0] / length),
                          static_cast<float>(s * line[1] / length),
                          static_cast<float>(s * at / length),
                          picture_.half_width,
                          picture_.half_height,
                          move_,
                          -infinity};
            const double z = zs_[c[k == 0 ? 2 : k - 1]];
            for (int i = 0; i < 3; ++i) {
                const double share = sign_of(k) * (i < 2 ? line[i] : at) / determinant;
                depth[i] += share * z;
                inverse_w[i] += share;
            }
        }
        for (int k = 0; k < 3; ++k) {
            const Edge &a = r.edges[k], &b = r.edges[k == 0 ? 2 : k - 1];
            const float turn = std::abs(a.across * b.up - a.up * b.across);
            face.corner[k] = ws_[c[k]] < near_w_ ? 0.0f : turn > 0.0f ? 4.0f * move_ / turn : infinity;
        }
        r.across = static_cast<float>(depth[0]), r.up = static_cast<float>(depth[1]);
        r.base = static_cast<float>(depth[2]), r.at_x = picture_.half_width, r.at_y = picture_.half_height;
        const float slope = std::abs(r.across) + std::abs(r.up);
        const float rounding =
            depth_error_ + 0x1p-20f * (std::abs(r.base) + slope * (picture_.half_width + picture_.half_height));
        face.steps = 8.0f * move_ * slope;
        r.below = rounding;
        r.above = 0.0f;
        r.nearest = picture_.near_share + depth_error_;
        r.farthest = kNothing;
        face.solid = add_limit(r, -inverse_w[0], -inverse_w[1], 1.0 / near_w_ - inverse_w[2]) &&
                     add_limit(r, -depth[0], -depth[1], picture_.near_share - depth[2] - double{4.0f * rounding}) &&
                     std::isfinite(r.below) && std::isfinite(face.steps);
        set_rectangle(r, p);
    }

    // Keeps across · (x − middle) + up · (y − middle) + constant ≥ 0; false if that is nowhere.
    bool add_limit(Raster& r, double across, double up, double constant) const {
        const double length = std::abs(across) + std::abs(up);
        if (!(length * (picture_.half_width + picture_.half_height) > 1e-6 * std::abs(constant))) return constant > 0.0;
        r.edges[r.edge_count++] = {static_cast<float>(across / length),
                                   static_cast<float>(up / length),
                                   static_cast<float>(constant / length),
                                   picture_.half_width,
                                   picture_.half_height,
                                   move_,
                                   -std::numeric_limits<float>::infinity()};
        return true;
    }

    // Around what of the triangle is farther than near_w_.
    void set_rectangle(Raster& r, const double (&p)[3][3]) const {
        double low[2] = {1e30, 1e30}, high[2] = {-1e30, -1e30};
        const auto include = [&](double x, double y, double w) {
            low[0] = std::min(low[0], x / w), high[0] = std::max(high[0], x / w);
            low[1] = std::min(low[1], y / w), high[1] = std::max(high[1], y / w);
        };
        const double limit = near_w_;
        for (int k = 0; k < 3; ++k) {
            const double *const a = p[k], *const b = p[k == 2 ? 0 : k + 1];
            if (a[2] >= limit) include(a[0], a[1], a[2]);
            if ((a[2] < limit) == (b[2] < limit)) continue;
            const double share = (limit - a[2]) / (b[2] - a[2]);
            include(a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), limit);
        }
        const auto width = static_cast<float>(picture_.tiles.width), height = static_cast<float>(picture_.tiles.height);
        r.x0 = first_sample(static_cast<float>(low[0]) - 1.0f, width);
        r.x1 = last_sample(static_cast<float>(high[0]) + 1.0f, width);
        r.y0 = first_sample(static_cast<float>(low[1]) - 1.0f, height);
        r.y1 = last_sample(static_cast<float>(high[1]) + 1.0f, height);
    }

    // Depth differences across an edge that are not worth a hole there.
    static constexpr float kSmoothShare = 0x1p-7f;
    static constexpr float kMaxCorner = 0.5f;

    [[nodiscard]] bool may_close(std::uint32_t t, std::uint32_t k) const {
        const Face& face = faces_[t];
        if (!face.drawn || !face.solid) return false;
        if (face.corner[k] > kMaxCorner || face.corner[k == 2 ? 0 : k + 1] > kMaxCorner) return false;
        if (patch_.unclear) return true;
        const Raster& r = face.raster;
        return face.steps <
               kSmoothShare * std::max(r.nearest - picture_.infinitely_far, picture_.infinitely_far - r.farthest);
    }

    void close_edges() {
        for (std::uint32_t i = 0; i < live_count_; ++i)
            for (bool& closed : faces_[live_[i]].closed) closed = false;
        for (std::uint32_t i = 0; i < live_count_ && live_[i] < patch_.own_triangles; ++i) {
            const std::uint32_t t = live_[i];
            if (!faces_[t].solid) continue;
            for (std::uint32_t k = 0; k < 3; ++k) {
                const std::uint32_t other = patch_.neighbors[3 * t + k];
                if (other == ClusteredMesh::kNone || (other < t && other < patch_.own_triangles)) continue;
                const Face& face = faces_[other];
                if (face.facing != faces_[t].facing || face.facing == Facing::unclear) continue;
                const std::uint32_t back = edge_to(other, t);
                if (back == 3 || !may_close(t, k) || !may_close(other, back)) continue;
                faces_[t].closed[k] = faces_[other].closed[back] = true;
            }
        }
        for (std::uint32_t i = 0; i < live_count_; ++i) {
            const std::uint32_t t = live_[i];
            Face& face = faces_[t];
            if (!face.solid) continue;
            float steps = face.steps;
            face.farthest = face.raster.farthest;
            for (std::uint32_t k = 0; k < 3; ++k) {
                if (!face.closed[k]) continue;
                const Face& other = faces_[patch_.neighbors[3 * t + k]];
                steps = std::max(steps, other.steps);
                face.farthest = std::min(face.farthest, other.raster.farthest);
                face.raster.edges[k].inner = 0.0f;
            }
            face.below = face.raster.below + steps;
        }
        for (std::uint32_t i = 0; i < live_count_; ++i)
            if (Face& face = faces_[live_[i]]; face.solid)
                face.raster.below = face.below, face.raster.farthest = face.farthest;
    }

    [[nodiscard]] std::uint32_t edge_to(std::uint32_t t, std::uint32_t other) const {
        for (std::uint32_t k = 0; k < 3; ++k)
            if (patch_.neighbors[3 * t + k] == other) return k;
        return 3;
    }

    // The samples at corners where the surface ends.
    void exclude_corners() {
        bool closes = false;
        excluded_count_ = 0;
        std::fill_n(radius_, patch_.vertex_count, 0.0f);
        for (std::uint32_t i = 0; i < live_count_; ++i) {
            const std::uint32_t t = live_[i];
            const Face& face = faces_[t];
            if (!face.solid) continue;
            const std::uint16_t* const c = patch_.corners + 3 * t;
            for (std::uint32_t k = 0; k < 3; ++k) {
                const bool before = face.closed[k == 0 ? 2 : k - 1], after = face.closed[k];
                if (!before && !after) continue;  // all of its edges there keep the distance
                radius_[c[k]] = std::max(radius_[c[k]], face.corner[k]);
                closes = true;
            }
        }
        if (!closes) return;
        for (std::uint32_t t = 0; t < patch_.own_triangles; ++t) {
            const Face& face = faces_[t];
            const std::uint16_t* const c = patch_.corners + 3 * t;
            for (std::uint32_t k = 0; k < 3; ++k)
                if (!face.drawn || !face.closed[k]) ends_[c[k]] = ends_[c[k == 2 ? 0 : k + 1]] = true;
        }
        for (std::uint32_t v = 0; v < patch_.vertex_count; ++v) {
            const bool ends = ends_[v] || patch_.enclosed[v] == 0;
            ends_[v] = false;
            if (ends && radius_[v] > 0.0f) exclude_near(v);
        }
    }

    void exclude_near(std::uint32_t v) {
        float x = xs_[v], y = ys_[v];
        if (patch_.unclear) {
            if (!(ws_[v] > 0.0f)) return;
            x = x / ws_[v] * picture_.half_width + picture_.half_width;
            y = y / ws_[v] * picture_.half_height + picture_.half_height;
        }
        const float r = std::min(radius_[v], kMaxCorner);
        const auto width = static_cast<float>(picture_.tiles.width), height = static_cast<float>(picture_.tiles.height);
        if (!(x > -1.0f && x < width + 1.0f && y > -1.0f && y < height + 1.0f)) return;
        const std::int32_t x1 = last_sample(x + r, width), y1 = last_sample(y + r, height);
        for (std::int32_t j = first_sample(y - r, height); j <= y1; ++j)
            for (std::int32_t i = first_sample(x - r, width); i <= x1; ++i)
                if (excluded_count_ < kMaxExcluded)
                    excluded_[excluded_count_++] = static_cast<std::uint32_t>(j) << 16 | static_cast<std::uint32_t>(i);
                else
                    for (std::uint32_t t = 0; t < patch_.all_triangles; ++t) faces_[t].solid = false;
    }

    // A triangle around the cluster has been drawn before, but for the seam between them: only that is left.
    [[nodiscard]] bool keep_to_seam(std::uint32_t t) {
        Raster& r = faces_[t].raster;
        const Edge* seam = nullptr;
        for (std::uint32_t k = 0; k < 3; ++k) {
            if (!faces_[t].closed[k]) continue;
            if (seam != nullptr) return true;
            seam = &r.edges[k];
        }
        if (seam == nullptr) return false;
        const float length = std::abs(seam->across) + std::abs(seam->up);
        r.edges[r.edge_count++] = {
            -seam->across, -seam->up, -seam->constant + 8.0f * move_ * length, seam->at_x, seam->at_y, 0.0f, 0.0f};
        return true;
    }

    static constexpr std::uint32_t kMaxExcluded = 32;

    const PictureData& picture_;
    const ObjectData& object_;
    const PatchData& patch_;
    float move_ = 0.0f, depth_error_ = 0.0f, near_w_ = 0.0f;
    Face faces_[kMaxPatchTriangles];
    std::uint16_t live_[kMaxPatchTriangles + 1];
    std::uint32_t live_count_ = 0;
    bool always_[kMaxPatchTriangles];  // visible, whatever the tiles say
    alignas(64) float xs_[kMaxPatchVertices], ys_[kMaxPatchVertices], zs_[kMaxPatchVertices], ws_[kMaxPatchVertices];
    float radius_[kMaxPatchVertices];
    bool ends_[kMaxPatchVertices]{};
    std::uint32_t excluded_[kMaxExcluded];
    std::uint32_t excluded_count_ = 0;
};

}  // namespace crofton::depth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
