// SPDX-License-Identifier: MIT
// Small scenes in which every corner, edge and depth is aimed at a sample, so that each margin is needed somewhere.
// Meshes are in clip coordinates, or in pixels times w.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "depth_scenes.hpp"

namespace crofton::testing {

// A place in the picture, its nearness, and w.
struct Aimed {
    double x, y, z, w = 1.0;
};

class MarginScenes {
  public:
    MarginScenes(std::uint32_t width, std::uint32_t height, oracle::NearMisses& random)
        : width_(width), height_(height), random_(random) {}

    // Aims at this place of each pixel, in sixteenths, instead of its centre.
    void aim_at(glm::ivec2 sample) { shift_ = glm::dvec2(sample - glm::ivec2(8)) / 16.0; }

    // A coordinate next to a sample's: by about as much as vertices are moved.
    double next_to(double sample) {
        const double side = random_.index(2) == 0 ? 1.0 : -1.0;
        switch (random_.index(6)) {
            case 0:
                return sample;
            case 1:
                return sample + side / 512.0;  // halfway between two steps of the grid
            case 2:
                return sample + side * (1.0 / 512.0 + random_.number(-1.0, 1.0) * 0x1p-17);
            case 3:
                return sample + side * random_.number(0.0, 2.0) / 512.0;
            case 4:
                return sample + side * std::exp(random_.number(std::log(1e-4), std::log(0.3)));
            default:
                return sample + random_.number(-0.5, 0.5);
        }
    }
    double sample(std::uint32_t size) { return random_.index(size) + 0.5; }
    double some(double low, double high) { return std::exp(random_.number(std::log(low), std::log(high))); }
    double sign() { return random_.index(2) == 0 ? 1.0 : -1.0; }

    // A flat wall over the whole picture, or nearly flat.
    TriangleMesh wall(double z, double slope) {
        TriangleMesh mesh;
        const double w = width_ + 4.0, h = height_ + 4.0;
        const auto at = [&](double x, double y) { add(mesh, {x, y, z + slope * (x - 0.5 * width_), 1.0}); };
        at(-4.0, -4.0), at(2.0 * w, -4.0), at(-4.0, 2.0 * h);
        mesh.indices = {0, 1, 2};
        return mesh;
    }

    // Small triangles beside the picture, or nearly.
    TriangleMesh beside(std::uint32_t count) {
        TriangleMesh mesh;
        for (std::uint32_t i = 0; i < 3 * count; ++i) {
            const double away = sign() * some(1e-3, 8.0);
            double x = random_.number(0.0, 1.0) * width_, y = random_.number(0.0, 1.0) * height_;
            if (i / 3 % 2 == 0)
                x = i / 3 % 4 == 0 ? away : width_ + away;
            else
                y = i / 3 % 4 == 1 ? away : height_ + away;
            add(mesh, {x, y, random_.number(0.1, 0.9)});
            mesh.indices.push_back(i);
        }
        return mesh;
    }

    // Small steep triangles, each over about one sample, whose planes cross the nearness z there, or nearly.
    TriangleMesh specks(double z, std::uint32_t count) {
        TriangleMesh mesh;
        for (std::uint32_t i = 0; i < count; ++i) {
            const double sx = sample(width_), sy = sample(height_);
            const double turn = random_.number(0.0, 6.3), slope = some(1e-6, 0.3);
            const double gx = slope * std::cos(turn), gy = slope * std::sin(turn);
            const double off = random_.index(4) == 0
                                   ? random_.number(-0.1, 0.2)
                                   : random_.number(-1.5, 1.5) / 512.0 * (std::abs(gx) + std::abs(gy));
            const double reach = some(0.003, 1.0);
            const bool beside = random_.index(2) == 0;
            const double mx = beside ? next_to(sx) : sx, my = beside ? next_to(sy) : sy;
            const double first = random_.number(0.0, 6.3);
            for (int k = 0; k < 3; ++k) {
                const double a = first + 2.1 * k + random_.number(-0.9, 0.9), r = reach * random_.number(0.3, 1.0);
                double x = mx + r * std::cos(a), y = my + r * std::sin(a);
                if (random_.index(4) == 0) x = next_to(sx);
                if (random_.index(4) == 0) y = next_to(sy);
                add(mesh, {x, y, z + off + gx * (x - sx) + gy * (y - sy)});
                mesh.indices.push_back(3 * i + static_cast<std::uint32_t>(k));
            }
        }
        return mesh;
    }

    // Triangles around a corner next to a sample; some are missing, some needles, some folded over, some end just
    // there.
    TriangleMesh fan(double most_depth) {
        TriangleMesh mesh;
        const double sx = sample(width_), sy = sample(height_);
        const std::uint32_t n = 2 + random_.index(9);
        const double z = random_.number(0.3, 0.7), slope_x = most_depth * random_.number(-1, 1) / 8.0,
                     slope_y = most_depth * random_.number(-1, 1) / 8.0;
        const double bumps = random_.index(3) == 0 ? 0.0 : random_.number(0.0, most_depth);
        const auto put = [&](double x, double y) {
            const double bump = bumps * random_.number(-1, 1);
            add(mesh, {x, y, std::clamp(z + slope_x * (x - sx) + slope_y * (y - sy) + bump, 0.01, 0.99)});
        };
        const bool aimed = random_.index(3) != 0, needles = random_.index(3) == 0;
        const double mx = next_to(sx), my = next_to(sy);
        const double other_x = sx + random_.index(4) - 1.0, other_y = sy + random_.index(4) - 1.0;
        put(mx, my);
        double turn = random_.number(0.0, 6.3);
        const double narrow = some(1e-4, 1.0), reach = some(0.3, 30.0);
        for (std::uint32_t i = 0; i < n; ++i) {
            const double r = reach * random_.number(0.2, 1.0);
            double x = sx + r * std::cos(turn), y = sy + r * std::sin(turn);
            if (aimed && random_.index(2) == 0) x = next_to(std::floor(x) + 0.5), y = next_to(std::floor(y) + 0.5);
            if (needles && random_.index(4) != 0) {
                const double away = some(2.0, 60.0);
                x = mx + away * (next_to(other_x) - mx), y = my + away * (next_to(other_y) - my);
            }
            put(x, y);
            turn += random_.index(2) == 0 ? narrow : random_.number(0.1, 6.3 / n);
        }
        const std::uint32_t around = random_.index(2) == 0 ? n : n - 1;
        for (std::uint32_t i = 0; i < around; ++i) {
            if (random_.index(7) == 0) continue;
            const bool turned = random_.index(15) == 0;
            const std::uint32_t a = 1 + i, b = 1 + (i + 1) % n;
            for (const std::uint32_t v : {0u, turned ? b : a, turned ? a : b}) mesh.indices.push_back(v);
        }
        if (mesh.indices.empty()) mesh.indices = {0, 1, 2};
        return mesh;
    }

    // Two triangles with a common edge, whose four corners lie nearly in one plane, and form mostly a convex shape.
    TriangleMesh bent_square() {
        TriangleMesh mesh;
        const double sx = sample(width_), sy = sample(height_), z = random_.number(0.3, 0.7);
        const double slope = some(1e-7, 3e-2), slope_x = slope * random_.number(-1, 1),
                     slope_y = slope * random_.number(-1, 1);
        const double bend = random_.index(4) == 0 ? 0.0 : sign() * some(1e-8, 1e-3);
        const double reach = some(1.0, 30.0), first = random_.number(0.0, 6.3);
        for (std::uint32_t i = 0; i < 4; ++i) {
            const double a = first + 1.5708 * i + random_.number(-0.6, 0.6), r = reach * random_.number(0.3, 1.0);
            const double x = next_to(std::floor(sx + r * std::cos(a)) + 0.5);
            const double y = next_to(std::floor(sy + r * std::sin(a)) + 0.5);
            add(mesh, {x, y, z + slope_x * (x - sx) + slope_y * (y - sy) + (i == 3 ? bend : 0.0)});
        }
        mesh.indices =
            random_.index(2) == 0 ? Vector<std::uint32_t>{0, 1, 2, 0, 2, 3} : Vector<std::uint32_t>{2, 3, 0, 1, 2, 0};
        return mesh;
    }

    // A flat closed fan around a sample, of which one corner lies deep.
    TriangleMesh crown() {
        TriangleMesh mesh;
        const double sx = sample(width_), sy = sample(height_), z = random_.number(0.3, 0.7);
        const std::uint32_t n = 5 + random_.index(4), deep = random_.index(n);
        const double reach = random_.number(1.0, 6.0), depth = some(1e-3, 0.2), turn = random_.number(0.0, 6.3);
        const double x0 = sx + random_.number(-1.0, 1.0) / 400.0, y0 = sy + random_.number(-1.0, 1.0) / 400.0;
        add(mesh, {x0, y0, z});
        for (std::uint32_t i = 0; i < n; ++i) {
            const double a = turn + 6.283185 * i / n;
            add(mesh, {sx + reach * std::cos(a), sy + reach * std::sin(a), i == deep ? z - depth : z});
            for (const std::uint32_t v : {0u, 1 + i, 1 + (i + 1) % n}) mesh.indices.push_back(v);
        }
        return mesh;
    }

    // Squares of one pixel, whose corners are at samples, more or less, with holes.
    TriangleMesh sieve() {
        TriangleMesh mesh;
        const double x0 = sample(width_), y0 = sample(height_), z = random_.number(0.3, 0.7);
        for (std::uint32_t j = 0; j <= 7; ++j)
            for (std::uint32_t i = 0; i <= 7; ++i) {
                const double x = x0 + i + random_.number(-1.0, 1.0) / 256.0;
                add(mesh, {x, y0 + j + random_.number(-1.0, 1.0) / 256.0, z});
            }
        for (std::uint32_t j = 0; j < 7; ++j)
            for (std::uint32_t i = 0; i < 7; ++i) {
                const std::uint32_t p = j * 8 + i, q = p + 8;
                for (const auto& t : {std::array{p, p + 1, q + 1}, std::array{p, q + 1, q}})
                    if (random_.index(3) != 0 && mesh.indices.size() < 192)
                        for (const std::uint32_t v : t) mesh.indices.push_back(v);
            }
        return mesh;
    }

    // A few squares whose corners are next to samples.
    TriangleMesh patch(double most_depth) {
        TriangleMesh mesh;
        const bool many = random_.index(8) == 0;
        const std::uint32_t n = many ? 6 : 1 + random_.index(4), m = many ? 6 : 1 + random_.index(4);
        const double step = many ? 1.5 : some(0.4, 8.0), x0 = sample(width_), y0 = sample(height_);
        const double z = random_.number(0.3, 0.7), slope_x = most_depth * random_.number(-1, 1),
                     slope_y = most_depth * random_.number(-1, 1);
        const double bumps = random_.index(3) == 0 ? 0.0 : random_.number(0.0, most_depth);
        for (std::uint32_t j = 0; j <= m; ++j)
            for (std::uint32_t i = 0; i <= n; ++i) {
                double x = x0 + i * step, y = y0 + j * step;
                if (random_.index(3) != 0) x = next_to(std::floor(x) + 0.5), y = next_to(std::floor(y) + 0.5);
                const double bump = bumps * random_.number(-1, 1);
                const double near = z + slope_x * (x - x0) / 16.0 + slope_y * (y - y0) / 16.0 + bump;
                add(mesh, {x, y, std::clamp(near, 0.01, 0.99)});
            }
        for (std::uint32_t j = 0; j < m; ++j)
            for (std::uint32_t i = 0; i < n; ++i) {
                const std::uint32_t p = j * (n + 1) + i, q = p + n + 1;
                for (const auto& t : {std::array{p, p + 1, q + 1}, std::array{p, q + 1, q}})
                    if (random_.index(12) != 0)
                        for (const std::uint32_t v : t) mesh.indices.push_back(v);
            }
        if (mesh.indices.empty()) mesh.indices = {0, 1, n + 1};
        return mesh;
    }

    // Triangles that reach far beyond the picture, along lines that pass next to samples.
    TriangleMesh far_lines(std::uint32_t count, double most) {
        TriangleMesh mesh;
        for (std::uint32_t i = 0; i < count; ++i) {
            const double ax = next_to(sample(width_)), ay = next_to(sample(height_));
            double bx = next_to(sample(width_)), by = next_to(sample(height_));
            if (random_.index(3) == 0) by = ay + sign() * some(1e-6, 1e-1);
            if (std::abs(ax - bx) < 0.2) bx += 1.0;
            const double length = std::hypot(ax - bx, ay - by);
            const double p = some(1.0, most) / length, q = some(1.0, most) / length;
            const double z = random_.number(0.2, 0.8), zs = random_.index(2) == 0 ? 0.0 : 1e-3;
            add(mesh, {ax + p * (ax - bx), ay + p * (ay - by), z});
            add(mesh, {bx + q * (bx - ax), by + q * (by - ay), z + zs * random_.number(-1, 1)});
            add(mesh, {random_.number(-1, 2) * width_, random_.number(-1, 2) * height_ + sign() * some(1.0, most),
                       z + zs * random_.number(-1, 1)});
            const bool turned = random_.index(2) == 0;
            for (const std::uint32_t k : {0u, turned ? 2u : 1u, turned ? 1u : 2u}) mesh.indices.push_back(3 * i + k);
        }
        return mesh;
    }

    // Long triangles, just wide enough to cover a sample, that are steep along their length.
    TriangleMesh long_needles(std::uint32_t count) {
        TriangleMesh mesh;
        for (std::uint32_t i = 0; i < count; ++i) {
            const double sx = sample(width_), sy = sample(height_), length = some(30.0, 3e4);
            const double turn = random_.index(2) == 0 ? random_.number(0.0, 6.3) : some(1e-6, 0.1);
            const double dx = std::cos(turn), dy = std::sin(turn), wide = some(0.01, 3.0),
                         at = random_.number(0.2, 0.8);
            const double z0 = random_.number(0.1, 0.9), z1 = random_.number(0.1, 0.9);
            const double shift = random_.number(-0.4, 0.4) * wide, third = random_.number(0.0, 1.0);
            const auto put = [&](double along, double across) {
                add(mesh, {sx + along * length * dx - across * dy, sy + along * length * dy + across * dx,
                           z0 + (z1 - z0) * (along + at)});
                mesh.indices.push_back(static_cast<std::uint32_t>(mesh.indices.size()));
            };
            put(-at, shift - 0.5 * wide), put(1.0 - at, shift - 0.5 * wide), put(third - at, shift + 0.5 * wide);
        }
        return mesh;
    }

    // Moves a mesh away from the origin of its coordinates, so that products are large and cancel.
    void offset(TriangleMesh& mesh, glm::dmat4& to_clip, double least, double most) {
        glm::dvec3 off(0.0);
        for (glm::length_t k = 0; k < 3; ++k)
            if (random_.index(2) == 0) off[k] = sign() * std::exp2(std::round(std::log2(some(least, most))));
        for (glm::vec3& p : mesh.positions) p = glm::vec3(glm::dvec3(p) + off);
        to_clip[3] -= to_clip * glm::dvec4(off, 0.0);
    }

    // Triangles through the near plane, whose edges pass next to samples; in pixels times w, and w.
    TriangleMesh through_near(std::uint32_t count, double near) {
        TriangleMesh mesh;
        const auto aimed = [&] {
            const double w = random_.index(3) == 0 ? near * (1.0 + random_.number(-1.0, 1.0) * some(1e-8, 1e-3))
                                                   : near * some(0.9, 40.0);
            return glm::dvec3(next_to(sample(width_)) * w, next_to(sample(height_)) * w, w);
        };
        const auto put = [&](const glm::dvec3& p) { mesh.positions.push_back(to_ndc(p)); };
        for (std::uint32_t i = 0; i < count; ++i) {
            const auto first = static_cast<std::uint32_t>(mesh.positions.size());
            const glm::dvec3 a = aimed(), b = aimed(), c = aimed();
            put(a);
            put(random_.index(3) == 0 ? b : a + some(1.0, 30.0) * (b - a));
            put(random_.index(3) == 0 ? c : a + some(1.0, 30.0) * (c - a));
            for (const std::uint32_t k : {0u, 1u, 2u}) mesh.indices.push_back(first + k);
            if (random_.index(3) == 0) continue;
            const glm::dvec3 d = aimed();
            put(b + some(1.0, 5.0) * (d - b));
            for (const std::uint32_t k : {0u, 2u, 3u}) mesh.indices.push_back(first + k);
            if (random_.index(2) == 0) continue;
            put(aimed());
            for (const std::uint32_t k : {0u, 3u, 4u}) mesh.indices.push_back(first + k);
        }
        return mesh;
    }

    // A mesh at w = 1 with the same places in the picture, each vertex at a w of its own from `least` to `most`; some
    // are pulled through the near plane, along a line to the first.
    void deepen(TriangleMesh& mesh, double least, double most, bool pulls) {
        const auto put = [&](glm::vec3& p, double w) { p = glm::vec3(p.x * w, p.y * w, w); };
        for (glm::vec3& p : mesh.positions) put(p, some(least, most));
        if (!pulls) return;
        const glm::dvec3 first(mesh.positions[0]);
        for (std::size_t v = 1; v < mesh.positions.size(); ++v)
            if (random_.index(4) == 0)
                mesh.positions[v] = glm::vec3(first + some(1.0, 20.0) * (glm::dvec3(mesh.positions[v]) - first));
    }

    // Clip coordinates (x, y, z, 1) of a mesh of this class whose w are 1.
    static glm::dmat4 flat() { return glm::dmat4(1.0); }
    // Of those with w: z becomes w, and the near plane is where w is `near`.
    static glm::dmat4 deep(double near) {
        glm::dmat4 m(0.0);
        m[0][0] = m[1][1] = m[2][3] = 1.0;
        m[3][2] = double(float(near));
        return m;
    }

  private:
    void add(TriangleMesh& mesh, const Aimed& p) {
        mesh.positions.push_back(
            glm::vec3(2.0 * (p.x + shift_.x) / width_ - 1.0, 2.0 * (p.y + shift_.y) / height_ - 1.0, p.z));
    }
    [[nodiscard]] glm::vec3 to_ndc(const glm::dvec3& p) const {
        return {2.0 * (p.x + shift_.x * p.z) / width_ - p.z, 2.0 * (p.y + shift_.y * p.z) / height_ - p.z, p.z};
    }

    std::uint32_t width_, height_;
    glm::dvec2 shift_{0.0};
    oracle::NearMisses& random_;
};

}  // namespace crofton::testing
