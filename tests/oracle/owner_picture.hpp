// SPDX-License-Identifier: MIT
// Which triangle owns each sample of a picture, by a renderer that does what Vulkan allows: vertices snapped to 1/256
// of a pixel, each to a neighbour of its place; samples covered by exact integers, each edge by one of its triangles;
// depth by the triangle's plane.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace crofton::oracle {

struct DrawnMesh {
    std::span<const glm::vec3> positions;
    std::span<const std::uint32_t> indices;
    glm::mat4 to_clip;
    bool one_sided = false;
};

struct OwnerPicture {
    static constexpr std::uint64_t kNobody = ~std::uint64_t{0};
    std::uint32_t width, height;
    std::vector<std::uint64_t> owners;  // mesh · 2^32 + triangle; row 0 is at the bottom
    std::vector<double> depths;         // −∞ where nobody is

    OwnerPicture(std::uint32_t w, std::uint32_t h)
        : width(w), height(h), owners(std::size_t{w} * h, kNobody), depths(owners.size(), -HUGE_VAL) {}
};

// How a renderer rounds.
struct Rounding {
    double wobble = 0.0;  // pixels by which a vertex is moved, at most, before it is snapped; differently at each place
    // The share of a triangle's steepest slope of depth, from one pixel to the next, by which it is drawn farther away
    // (the depth bias that the guide asks for is 1/256).
    double bias = 0.0;
    double clip_share = 0.0;   // of the sum of its terms, by which a clip coordinate is off, at most
    double depth_share = 0.0;  // of itself, by which a depth is off, at most
    bool snaps_plane = true;   // depth is that of the plane of the snapped vertices; otherwise of the vertices' places
};

// Reversed-Z matrices.
class OwnerRenderer {
  public:
    // `sample`: where in each pixel, in sixteenths, from its lower left corner.
    OwnerRenderer(OwnerPicture& picture, const Rounding& rounding, std::uint64_t seed, glm::ivec2 sample = {8, 8})
        : picture_(picture), rounding_(rounding), seed_(seed), sample_(sample) {}

    void draw(const DrawnMesh& mesh, std::uint32_t number) {
        for (std::uint32_t t = 0; 3 * t + 2 < mesh.indices.size(); ++t) {
            std::array<glm::dvec4, 3> clip;
            for (std::size_t k = 0; k < 3; ++k) clip[k] = rounded_clip(mesh, mesh.positions[mesh.indices[3 * t + k]]);
            std::vector<glm::dvec4> polygon = before_near(clip);
            for (std::size_t k = 2; k < polygon.size(); ++k)
                draw_triangle({polygon[0], polygon[k - 1], polygon[k]}, mesh.one_sided,
                              std::uint64_t{number} << 32 | t);
        }
    }

  private:
    struct Point {
        std::int64_t x, y;  // 1/256 pixel
        double z;
        double at_x, at_y;  // before it was snapped
    };

    [[nodiscard]] glm::dvec4 rounded_clip(const DrawnMesh& mesh, const glm::vec3& position) const {
        glm::dvec4 clip = glm::dmat4(mesh.to_clip) * glm::dvec4(position, 1.0);
        if (rounding_.clip_share == 0.0) return clip;
        for (glm::length_t i = 0; i < 4; ++i) {
            double terms = std::abs(double(mesh.to_clip[3][i]));
            for (glm::length_t c = 0; c < 3; ++c) terms += std::abs(double(mesh.to_clip[c][i]) * double(position[c]));
            clip[i] += rounding_.clip_share * terms * random(clip[i], 3 + static_cast<std::uint64_t>(i));
        }
        return clip;
    }

    static std::vector<glm::dvec4> before_near(const std::array<glm::dvec4, 3>& clip) {
        std::vector<glm::dvec4> result;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec4 &a = clip[k], &b = clip[(k + 1) % 3];
            const double da = a.w - a.z, db = b.w - b.z;
            if (da >= 0.0) result.push_back(a);
            if ((da >= 0.0) == (db >= 0.0)) continue;
            // From the same end, whoever owns the edge.
            result.push_back(da < 0.0 ? a + (b - a) * (da / (da - db)) : b + (a - b) * (db / (db - da)));
        }
        return result;
    }

    // From −1 to 1, always the same for the same number.
    [[nodiscard]] double random(double number, std::uint64_t salt) const {
        std::uint64_t bits = std::bit_cast<std::uint64_t>(number) ^ seed_ * 0x9e3779b97f4a7c15u ^ salt;
        bits = (bits ^ bits >> 31) * 0xbf58476d1ce4e5b9u;
        bits = (bits ^ bits >> 27) * 0x94d049bb133111ebu;
        return double(bits >> 11) * 0x1p-52 - 1.0;
    }
    [[nodiscard]] double moved(double pixels, std::uint64_t salt) const {
        return pixels + rounding_.wobble * random(pixels, salt);
    }

    [[nodiscard]] Point snapped(const glm::dvec4& p) const {
        const double x = (p.x / p.w * 0.5 + 0.5) * picture_.width, y = (p.y / p.w * 0.5 + 0.5) * picture_.height;
        return {std::llround(256.0 * std::clamp(moved(x, 1), -1e6, 1e6)),
                std::llround(256.0 * std::clamp(moved(y, 2), -1e6, 1e6)), p.z / p.w, x, y};
    }

    void draw_triangle(const std::array<glm::dvec4, 3>& clip, bool one_sided, std::uint64_t owner) {
        std::array<Point, 3> p = {snapped(clip[0]), snapped(clip[1]), snapped(clip[2])};
        std::int64_t area = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[2].x - p[0].x) * (p[1].y - p[0].y);
        if (area == 0 || (one_sided && area < 0)) return;
        if (area < 0) std::swap(p[1], p[2]), area = -area;
        const auto least = [&](auto get) { return std::min({get(p[0]), get(p[1]), get(p[2])}); };
        const auto most = [&](auto get) { return std::max({get(p[0]), get(p[1]), get(p[2])}); };
        const auto x_of = [](const Point& q) { return q.x; };
        const auto y_of = [](const Point& q) { return q.y; };
        const auto from = [](std::int64_t v, std::uint32_t size) {
            return std::clamp<std::int64_t>((v - 128) / 256 - 1, 0, size);
        };
        const std::int64_t x0 = from(least(x_of), picture_.width), x1 = from(most(x_of), picture_.width) + 2;
        const std::int64_t y0 = from(least(y_of), picture_.height), y1 = from(most(y_of), picture_.height) + 2;
        const double nearest = std::max({p[0].z, p[1].z, p[2].z});
        const double moved_back = rounding_.bias * steepest(p, double(area));
        for (std::int64_t y = y0; y <= std::min<std::int64_t>(y1, picture_.height - 1); ++y)
            for (std::int64_t x = x0; x <= std::min<std::int64_t>(x1, picture_.width - 1); ++x) {
                const std::int64_t sx = 256 * x + 16 * sample_.x, sy = 256 * y + 16 * sample_.y;
                std::array<double, 3> weights{};
                bool inside = true;
                for (std::size_t k = 0; k < 3; ++k) {
                    const Point &a = p[(k + 1) % 3], &b = p[(k + 2) % 3];
                    const std::int64_t e = (b.x - a.x) * (sy - a.y) - (b.y - a.y) * (sx - a.x);
                    const bool tie_inside = b.y < a.y || (b.y == a.y && b.x < a.x);
                    inside = inside && (e > 0 || (e == 0 && tie_inside));
                    weights[k] = double(e) / double(area);
                }
                if (!inside) continue;
                double z = rounding_.snaps_plane ? weights[0] * p[0].z + weights[1] * p[1].z + weights[2] * p[2].z
                                                 : plane_of_places(p, double(sx) / 256.0, double(sy) / 256.0);
                z += rounding_.depth_share * std::abs(z) * random(z, owner);
                z = std::min(z, nearest) - moved_back;
                const std::size_t at = std::size_t(y) * picture_.width + std::size_t(x);
                if (z < 0.0 || z <= picture_.depths[at]) continue;
                picture_.depths[at] = z;
                picture_.owners[at] = owner;
            }
    }

    static double plane_of_places(const std::array<Point, 3>& p, double x, double y) {
        const double x1 = p[1].at_x - p[0].at_x, y1 = p[1].at_y - p[0].at_y, z1 = p[1].z - p[0].z;
        const double x2 = p[2].at_x - p[0].at_x, y2 = p[2].at_y - p[0].at_y, z2 = p[2].z - p[0].z;
        const double area = x1 * y2 - x2 * y1;
        if (area == 0.0) return std::max({p[0].z, p[1].z, p[2].z});
        const double across = (z1 * y2 - z2 * y1) / area, up = (z2 * x1 - z1 * x2) / area;
        return p[0].z + across * (x - p[0].at_x) + up * (y - p[0].at_y);
    }

    // What the depth changes by from one pixel to the next.
    static double steepest(const std::array<Point, 3>& p, double area) {
        const double z1 = p[1].z - p[0].z, z2 = p[2].z - p[0].z;
        const double across = z1 * double(p[2].y - p[0].y) - z2 * double(p[1].y - p[0].y);
        const double up = z2 * double(p[1].x - p[0].x) - z1 * double(p[2].x - p[0].x);
        return 256.0 * std::max(std::abs(across), std::abs(up)) / area;
    }

    OwnerPicture& picture_;
    Rounding rounding_;
    std::uint64_t seed_;
    glm::ivec2 sample_;
};

}  // namespace crofton::oracle
