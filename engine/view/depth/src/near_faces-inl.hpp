// SPDX-License-Identifier: MIT
// The triangles of a cluster that reaches the near plane, in homogeneous coordinates (Olano and Greer, "Triangle scan
// conversion using 2D homogeneous coordinates", 1997): no clipping. They are drawn only, never asked. Compiled once per
// instruction set (Highway).
#include <hwy/highway.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "culler_data.hpp"
#include "faces-inl.hpp"
#include "projection-inl.hpp"

#if defined(CROFTON_DEPTH_NEAR_FACES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_DEPTH_NEAR_FACES_INL
#undef CROFTON_DEPTH_NEAR_FACES_INL
#else
#define CROFTON_DEPTH_NEAR_FACES_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::depth::HWY_NAMESPACE {

// Beyond these a triangle is not drawn: where it is too near, and where the near plane cuts it.
struct NearLimits {
    Line lines[2];
    std::uint32_t count;
};

// Only what is farther than least_w_ hides, since products move what is nearer by too many pixels.
class NearFaceSetup {
  public:
    NearFaceSetup(const PictureData& picture, const ObjectData& object, const ClipErrors& errors)
        : picture_(picture), object_(object), errors_(errors) {
        constexpr float kError = 0x1p-3f;
        least_w_ = std::max(pixel_error(picture_, errors_, kError), 1e-30f);  // at least 8 · errors_.w
        const auto size = static_cast<float>(std::max(picture.tiles.width, picture.tiles.height));
        grid_ = picture_.grid + 0x1p-20f * size;
        move_ = grid_ + kError;
        depth_error_ = 1.25f * (errors_.z + errors_.w);
    }

    void set(const PatchBlock& block, std::uint32_t i, const PatchVertices& vertices, Faces& f,
             NearLimits& limits) const {
        const std::uint8_t c[3] = {block.corners[0][i], block.corners[1][i], block.corners[2][i]};
        f.flags[i] = 0;
        f.x0[i] = f.y0[i] = 0, f.x1[i] = f.y1[i] = -1;
        if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0] || is_outside(vertices, c)) return;
        f.flags[i] = Faces::drawn | Faces::always;
        if (!object_.hides) return;
        Points p;
        for (int k = 0; k < 3; ++k) {
            const double w = vertices.w[c[k]];
            p.at[k][0] = vertices.x[c[k]] * double{picture_.half_width} + w * picture_.middle_x;
            p.at[k][1] = vertices.y[c[k]] * double{picture_.half_height} + w * picture_.middle_y;
            p.at[k][2] = w;
        }
        if (set_planes(f, i, vertices, c, p, limits)) f.flags[i] |= Faces::solid | 7 * Faces::closable;
        set_rectangle(f, i, p);
        for (int k = 0; k < 3; ++k)
            for (const int edge : {k, k == 2 ? 0 : k + 1})
                if (f.corner[edge][i] > kMaxCorner) f.flags[i] &= ~(Faces::closable << k);
    }

  private:
    struct Points {
        double at[3][3];  // pixels · w, and w
    };

    // Beyond a side of the picture or before the near plane, by more than products may be off.
    [[nodiscard]] bool is_outside(const PatchVertices& v, const std::uint8_t* c) const {
        const float side = 4.0f * (errors_.x + errors_.y + errors_.w);
        const float front = 4.0f * (errors_.z + errors_.w);
        bool left = true, right = true, low = true, high = true, before = true;
        for (int k = 0; k < 3; ++k) {
            const float x = v.x[c[k]], y = v.y[c[k]], z = v.z[c[k]], w = v.w[c[k]];
            const float edge = std::abs(w) + side;
            left = left && x < -edge, right = right && x > edge;
            low = low && y < -edge, high = high && y > edge;
            before = before && picture_.near_share * w - z < -front;
        }
        return left || right || low || high || before;
    }

    // True if it surely covers something.
    bool set_planes(Faces& f, std::uint32_t i, const PatchVertices& vertices, const std::uint8_t* c, const Points& p,
                    NearLimits& limits) const {
        // Lines through two corners each, from the corner with the lower number to the other.
        double lines[3][3];
        bool forward[3];
        for (int k = 0; k < 3; ++k) {
            const int n = k == 2 ? 0 : k + 1;
            forward[k] = c[k] < c[n];
            const double* const a = forward[k] ? p.at[k] : p.at[n];
            const double* const b = forward[k] ? p.at[n] : p.at[k];
            lines[k][0] = a[1] * b[2] - a[2] * b[1];
            lines[k][1] = a[2] * b[0] - a[0] * b[2];
            lines[k][2] = a[0] * b[1] - a[1] * b[0];
        }
        const auto sign_of = [&](int k) { return forward[k] ? 1.0 : -1.0; };
        const double determinant =
            sign_of(0) * ((lines[0][0] * p.at[2][0] + lines[0][1] * p.at[2][1]) + lines[0][2] * p.at[2][2]);
        if (!(std::abs(determinant) > 0.0) || !(std::abs(determinant) < 1e300)) return false;
        f.flags[i] |= determinant > 0.0 ? Faces::front : Faces::back;
        // Listed all the same: near the plane it may show.
        if (object_.one_sided && determinant < 0.0) return false;

        const double middle_x = picture_.half_width, middle_y = picture_.half_height;
        double depth[3] = {0, 0, 0}, inverse_w[3] = {0, 0, 0}, normals[3][2];
        for (int k = 0; k < 3; ++k) {
            const double* const line = lines[k];
            const double length = std::abs(line[0]) + std::abs(line[1]);
            if (!(length > 0.0)) return false;
            const double s = determinant > 0.0 ? sign_of(k) : -sign_of(k);
            const double at = (line[0] * middle_x + line[1] * middle_y) + line[2];
            normals[k][0] = s * line[0] / length, normals[k][1] = s * line[1] / length;
            set_edge(f, i, k, line[0] / length, line[1] / length, at / length, s > 0.0);
            const double share = sign_of(k) / determinant;
            const double z = vertices.z[c[k == 0 ? 2 : k - 1]];
            depth[0] += share * line[0] * z, depth[1] += share * line[1] * z, depth[2] += share * at * z;
            inverse_w[0] += share * line[0], inverse_w[1] += share * line[1], inverse_w[2] += share * at;
        }
        const double change = std::abs(inverse_w[0]) + std::abs(inverse_w[1]);  // of 1 / w, by pixels
        for (int k = 0; k < 3; ++k) {
            const double *const a = normals[k], *const b = normals[k == 0 ? 2 : k - 1];
            const auto turn = static_cast<float>(std::abs(a[0] * b[1] - a[1] * b[0]));
            const float w = vertices.w[c[k]];
            f.corner[k][i] = w < least_w_  ? 0.0f
                             : turn > 0.0f ? 4.0f * move_near(w, static_cast<float>(change)) / turn
                                           : std::numeric_limits<float>::infinity();
        }
        // Depth is off by depth_error_ / w, which is a plane, too.
        double plane[3], most[3];
        for (int k = 0; k < 3; ++k) {
            plane[k] = depth[k] - depth_error_ * inverse_w[k];
            most[k] = std::abs(depth[k]) + depth_error_ * std::abs(inverse_w[k]);
        }
        f.across[i] = static_cast<float>(plane[0]), f.up[i] = static_cast<float>(plane[1]);
        f.base[i] = static_cast<float>(plane[2]);
        f.plane_x[i] = picture_.half_width, f.plane_y[i] = picture_.half_height;
        const auto slope = static_cast<float>(most[0] + most[1]);
        // Vertices have a nearness of 1 at most, where the near plane clips them.
        f.below[i] =
            0x1p-20f * (1.0f + static_cast<float>(most[2]) + slope * (picture_.half_width + picture_.half_height));
        f.steps[i] = 8.0f * move_ * slope;
        const double before = 4.0 * (f.below[i] + depth_error_ / least_w_);
        limits.count = 0;
        return add_limit(limits, -inverse_w[0], -inverse_w[1], 1.0 / least_w_ - inverse_w[2]) &&
               add_limit(limits, -depth[0], -depth[1], picture_.near_share - depth[2] - before) &&
               std::isfinite(f.below[i]) && std::isfinite(f.steps[i]);
    }

    // By how many pixels vertices may lie elsewhere, half a pixel around a corner.
    [[nodiscard]] float move_near(float w, float change) const {
        return std::min(move_, grid_ + pixel_error(picture_, errors_, 1.0f) * (1.0f / w + 0.5f * change));
    }

    // What is right of `at`, or left of it, by the numbers that a line has where its normal is of length 1.
    struct Pivot {
        float per_row, at_x, at_y, offset;
        bool right;
    };
    // across · (x − middle) + up · (y − middle) + constant ≥ 0, |across| + |up| = 1. The line turns about a point near
    // the picture, so that being no flatter than kFlattest moves it by nothing that counts.
    [[nodiscard]] Pivot pivot_of(double across, double up, double constant) const {
        const bool steep = std::abs(across) > std::abs(up);
        const double limited = std::copysign(std::max(std::abs(across), double{kFlattest}), across);
        Pivot pivot{};
        pivot.per_row = static_cast<float>(-up / limited);
        pivot.at_x = static_cast<float>(picture_.half_width - (steep ? constant / across : 0.0));
        pivot.at_y = static_cast<float>(picture_.half_height - (steep ? 0.0 : constant / up));
        pivot.offset = move_ * (1.0f + std::abs(pivot.per_row));
        pivot.right = !std::signbit(across);
        return pivot;
    }

    // The numbers are alike for both triangles of an edge; `along`: the triangle is where the line's value is positive.
    void set_edge(Faces& f, std::uint32_t i, int k, double across, double up, double constant, bool along) const {
        const float infinity = std::numeric_limits<float>::infinity();
        const Pivot pivot = pivot_of(across, up, constant);
        const bool right = pivot.right == along;
        f.per_row[k][i] = pivot.per_row, f.at_x[k][i] = pivot.at_x, f.at_y[k][i] = pivot.at_y;
        f.low[k][i] = right ? pivot.at_x + pivot.offset : -infinity;
        f.high[k][i] = right ? infinity : pivot.at_x - pivot.offset;
    }

    // Keeps across · (x − middle) + up · (y − middle) + constant ≥ 0; false if that is nowhere.
    bool add_limit(NearLimits& limits, double across, double up, double constant) const {
        const float infinity = std::numeric_limits<float>::infinity();
        const double length = std::abs(across) + std::abs(up);
        if (!(length * (picture_.half_width + picture_.half_height) > 1e-6 * std::abs(constant))) return constant > 0.0;
        const Pivot pivot = pivot_of(across / length, up / length, constant / length);
        limits.lines[limits.count++] = {pivot.per_row, pivot.at_y, pivot.right ? pivot.at_x + pivot.offset : -infinity,
                                        pivot.right ? infinity : pivot.at_x - pivot.offset};
        return true;
    }

    // Around what of the triangle is farther than least_w_.
    void set_rectangle(Faces& f, std::uint32_t i, const Points& p) const {
        double low[2] = {1e30, 1e30}, high[2] = {-1e30, -1e30};
        const auto include = [&](double x, double y, double w) {
            low[0] = std::min(low[0], x / w), high[0] = std::max(high[0], x / w);
            low[1] = std::min(low[1], y / w), high[1] = std::max(high[1], y / w);
        };
        const double limit = least_w_;
        for (int k = 0; k < 3; ++k) {
            const double *const a = p.at[k], *const b = p.at[k == 2 ? 0 : k + 1];
            if (a[2] >= limit) include(a[0], a[1], a[2]);
            if ((a[2] < limit) == (b[2] < limit)) continue;
            const double share = (limit - a[2]) / (b[2] - a[2]);
            include(a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), limit);
        }
        const auto width = static_cast<float>(picture_.tiles.width), height = static_cast<float>(picture_.tiles.height);
        f.x0[i] = first_sample(static_cast<float>(low[0]) - 1.0f, width);
        f.x1[i] = last_sample(static_cast<float>(high[0]) + 1.0f, width);
        f.y0[i] = first_sample(static_cast<float>(low[1]) - 1.0f, height);
        f.y1[i] = last_sample(static_cast<float>(high[1]) + 1.0f, height);
    }

    const PictureData& picture_;
    const ObjectData& object_;
    const ClipErrors& errors_;
    float grid_, move_, depth_error_, least_w_;
};

}  // namespace crofton::depth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
