// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <crofton/core/error.hpp>
#include <crofton/geometry/model_to_clip.hpp>
#include <crofton/render/clip_space.hpp>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>
#include <limits>

namespace crofton::render {
namespace {

constexpr unsigned kPlanes = 6;
// A convex polygon gains at most one vertex per plane, but rounding can bend one; the clipper stops at this many.
constexpr std::size_t kMaxPolygon = 29;

// Mesa runs its vertex and clipping stages with denormal results taken as zero.
inline float flush(float value) {
    return std::fabs(value) < std::numeric_limits<float>::min() ? 0.0f : value;
}
inline float add(float a, float b) {
    return flush(a + b);
}
inline float multiply(float a, float b) {
    return flush(a * b);
}

inline float transform_row(float m0, float m1, float m2, float m3, float x, float y, float z) {
    return add(add(add(multiply(m0, x), multiply(m1, y)), multiply(m2, z)), m3);
}

inline glm::vec4 to_clip(const glm::mat4& m, const glm::vec3& p) {
    const float x = flush(p.x), y = flush(p.y), z = flush(p.z);
    return {transform_row(m[0][0], m[1][0], m[2][0], m[3][0], x, y, z),
            transform_row(m[0][1], m[1][1], m[2][1], m[3][1], x, y, z),
            transform_row(m[0][2], m[1][2], m[2][2], m[3][2], x, y, z),
            transform_row(m[0][3], m[1][3], m[2][3], m[3][3], x, y, z)};
}

// The planes' order is the clipper's: right, left, top, bottom, then z ≥ 0 and z ≤ w. Not comparable (NaN) is outside.
inline std::uint8_t clip_code(const glm::vec4& p) {
    return static_cast<std::uint8_t>((p.x <= p.w ? 0 : 1) | (add(p.x, p.w) >= 0.0f ? 0 : 2) | (p.y <= p.w ? 0 : 4) |
                                     (add(p.y, p.w) >= 0.0f ? 0 : 8) | (p.z >= 0.0f ? 0 : 16) | (p.z <= p.w ? 0 : 32));
}

// A four-term dot product with the plane, as the clipper takes it: infinities times zero make NaN, which discards.
inline float plane_distance(unsigned plane, const glm::vec4& p) {
    static constexpr float kPlane[kPlanes][4] = {{-1, 0, 0, 1}, {1, 0, 0, 1}, {0, -1, 0, 1},
                                                 {0, 1, 0, 1},  {0, 0, 1, 0}, {0, 0, -1, 1}};
    const float* n = kPlane[plane];
    return add(add(add(multiply(p.x, n[0]), multiply(p.y, n[1])), multiply(p.z, n[2])), multiply(p.w, n[3]));
}

inline glm::vec4 interpolate(float t, const glm::vec4& from, const glm::vec4& to) {
    glm::vec4 result;
    for (int k = 0; k < 4; ++k) result[k] = add(from[k], multiply(t, add(to[k], -from[k])));
    return result;
}

// The point where the edge meets the plane, measured from the end that is nearer to it.
inline glm::vec4 crossing(const glm::vec4& a, float distance_a, const glm::vec4& b, float distance_b) {
    const float difference = add(distance_b, -distance_a);
    const bool from_b = distance_b < 0.0f ? -distance_b < distance_a : !(-distance_a < distance_b);
    return from_b ? interpolate(flush(distance_b / difference), b, a)
                  : interpolate(flush(-distance_a / difference), a, b);
}

// Sutherland and Hodgman (1974), plane by plane; the number of triangles in a fan of the result.
std::uint64_t clipped_triangles(const std::array<glm::vec4, 3>& triangle, unsigned planes) {
    std::array<glm::vec4, kMaxPolygon> input, output;
    std::array<float, kMaxPolygon> distance;
    std::size_t n = 3;
    for (std::size_t i = 0; i < 3; ++i) input[i] = triangle[i];
    while (planes != 0 && n >= 3) {
        const auto plane = static_cast<unsigned>(std::countr_zero(planes));
        planes &= planes - 1;
        for (std::size_t i = 0; i < n; ++i) {
            distance[i] = plane_distance(plane, input[i]);
            if (!std::isfinite(distance[i])) return 0;
        }
        std::size_t kept = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const std::size_t next = i + 1 == n ? 0 : i + 1;
            const bool inside = distance[i] >= 0.0f;
            if (inside) output[kept++] = input[i];
            if (inside != (distance[next] >= 0.0f))
                output[kept++] = crossing(input[i], distance[i], input[next], distance[next]);
            if (kept + 2 > output.size()) return 0;
        }
        std::copy_n(output.begin(), kept, input.begin());
        n = kept;
    }
    return n >= 3 ? n - 2 : 0;
}

enum class ClipSide : std::uint8_t { undecided, inside, outside };

// Where the float pipeline will find every point of a box. A row of to_clip() is off by at most 4u/(1 − 4u) · S with
// u = 2⁻²⁴ and S = Σ|m_k||x_k| + |m_3| (three products deep in three sums), and by a few of the smallest normal floats
// for what is flushed; a plane compares two rows. 2⁻²¹ · ΣS + 2⁻¹⁰⁰ · (1 + Σ|m|) covers both, and double's own
// rounding. Above 2¹²⁰ floats may overflow, and NaN compares false: both stay undecided.
ClipSide clip_side(const glm::mat4& m, const Aabb& box) {
    const glm::dvec3 center = box.center(), half = box.half_extents();
    const glm::dvec3 max_abs = glm::max(glm::abs(box.min), glm::abs(box.max));
    const glm::dmat4 rows = glm::transpose(glm::dmat4(m));
    const auto size = [&](const glm::dvec4& row) {
        const glm::dvec4 a = glm::abs(row);
        return 0x1p-21 * (a.x * max_abs.x + a.y * max_abs.y + a.z * max_abs.z + a.w) +
               0x1p-100 * (1.0 + a.x + a.y + a.z + a.w);
    };
    const glm::dvec4 sizes(size(rows[0]), size(rows[1]), size(rows[2]), size(rows[3]));
    if (!(sizes.x + sizes.y + sizes.z + sizes.w < 0x1p99)) return ClipSide::undecided;
    const struct {
        glm::dvec4 row;
        double margin;
    } planes[kPlanes] = {{rows[3] - rows[0], sizes.w + sizes.x},
                         {rows[3] + rows[0], sizes.w + sizes.x},
                         {rows[3] - rows[1], sizes.w + sizes.y},
                         {rows[3] + rows[1], sizes.w + sizes.y},
                         {rows[2], sizes.z},
                         {rows[3] - rows[2], sizes.w + sizes.z}};
    bool inside = true;
    for (const auto& plane : planes) {
        const glm::dvec3 normal(plane.row);
        const double middle = glm::dot(normal, center) + plane.row.w, radius = glm::dot(glm::abs(normal), half);
        if (middle + radius < -plane.margin) return ClipSide::outside;
        inside = inside && middle - radius > plane.margin;
    }
    return inside ? ClipSide::inside : ClipSide::undecided;
}

}  // namespace

ModelToClip::ModelToClip(const Camera& camera, DepthRange depth)
    : camera_position_(camera.position),
      from_camera_relative_(view_to_clip(camera, depth) * glm::dmat4(world_to_view_rotation(camera))) {}

glm::mat4 ModelToClip::operator()(const glm::dmat3& linear, const glm::dvec3& translation) const {
    glm::mat4 result = detail::model_to_clip(from_camera_relative_, camera_position_, linear, translation);
    // Denormal entries would be taken as zero on one side only.
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) result[column][row] = flush(result[column][row]);
    return result;
}

bool inside_clip_planes(const Aabb& bounds, const glm::mat4& model_to_clip) {
    return clip_side(model_to_clip, bounds) == ClipSide::inside;
}

std::uint64_t ClipPredictor::count(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                                   const glm::mat4& model_to_clip) {
    CROFTON_ASSERT(indices.size() % 3 == 0, "three indices a triangle");
    // For a part of a mesh, look at its corners only, not at all positions.
    const bool is_part = indices.size() < positions.size();
    if (!is_part) {
        if (codes_.size() < positions.size()) codes_.resize(positions.size());
        std::uint8_t any = 0, all = 0xff;
        for (std::size_t i = 0; i < positions.size(); ++i) {
            codes_[i] = clip_code(to_clip(model_to_clip, positions[i]));
            any |= codes_[i];
            all &= codes_[i];
        }
        if (any == 0) return indices.size() / 3;
        if (all != 0 && !positions.empty()) return 0;
    }
    const auto code_of = [&](std::uint32_t index) {
        return is_part ? clip_code(to_clip(model_to_clip, positions[index])) : codes_[index];
    };
    std::uint64_t total = 0;
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        CROFTON_ASSERT(
            indices[i] < positions.size() && indices[i + 1] < positions.size() && indices[i + 2] < positions.size(),
            "indices refer to positions");
        const std::uint8_t a = code_of(indices[i]), b = code_of(indices[i + 1]), c = code_of(indices[i + 2]);
        if ((a | b | c) == 0) {
            ++total;
        } else if ((a & b & c) == 0) {
            total += clipped_triangles(
                {to_clip(model_to_clip, positions[indices[i]]), to_clip(model_to_clip, positions[indices[i + 1]]),
                 to_clip(model_to_clip, positions[indices[i + 2]])},
                static_cast<unsigned>(a | b | c));
        }
    }
    return total;
}

std::uint64_t ClipPredictor::count(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                                   const glm::mat4& model_to_clip, const Aabb& bounds) {
    switch (clip_side(model_to_clip, bounds)) {
        case ClipSide::inside:
            return indices.size() / 3;
        case ClipSide::outside:
            return 0;
        default:
            return count(positions, indices, model_to_clip);
    }
}

}  // namespace crofton::render
