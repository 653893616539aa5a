// SPDX-License-Identifier: MIT
#include "assets/mesh_builder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

#include "assets/srgb.hpp"

namespace crofton::assets {
namespace {

float linear_from_byte(int byte) {
    return linear_from_srgb(static_cast<float>(byte) / 255.0f);
}

// Two directions that make a right-handed frame with the unit vector `axis`.
void complete(const glm::dvec3& axis, glm::dvec3& side, glm::dvec3& up) {
    side = glm::normalize(glm::cross(std::abs(axis.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0), axis));
    up = glm::cross(axis, side);
}

struct Sphere {
    std::vector<glm::dvec3> points;
    std::vector<std::array<std::size_t, 3>> faces;
};

// An icosahedron with each face cut into four.
Sphere make_sphere() {
    const double g = std::numbers::phi;
    Sphere s;
    for (const double a : {-1.0, 1.0})
        for (const double b : {-g, g}) {
            s.points.push_back({0, a, b});
            s.points.push_back({a, b, 0});
            s.points.push_back({b, 0, a});
        }
    for (glm::dvec3& p : s.points) p = glm::normalize(p);
    std::vector<std::array<std::size_t, 3>> coarse;
    // Twelve points at one distance: every triple of mutual neighbours is a face.
    const auto near = [&](std::size_t i, std::size_t j) { return glm::distance(s.points[i], s.points[j]) < 1.2; };
    for (std::size_t i = 0; i < 12; ++i)
        for (std::size_t j = i + 1; j < 12; ++j)
            for (std::size_t k = j + 1; k < 12; ++k) {
                if (!near(i, j) || !near(j, k) || !near(i, k)) continue;
                const bool outward =
                    glm::dot(glm::cross(s.points[j] - s.points[i], s.points[k] - s.points[i]), s.points[i]) > 0;
                coarse.push_back(outward ? std::array{i, j, k} : std::array{i, k, j});
            }
    for (const auto& f : coarse) {
        std::array<std::size_t, 3> middle;
        for (std::size_t e = 0; e < 3; ++e) {
            middle[e] = s.points.size();
            s.points.push_back(glm::normalize(s.points[f[e]] + s.points[f[(e + 1) % 3]]));
        }
        for (std::size_t e = 0; e < 3; ++e) s.faces.push_back({f[e], middle[e], middle[(e + 2) % 3]});
        s.faces.push_back(middle);
    }
    return s;
}

// A number in [−1, 1] that depends on the point alone, so that shared corners move together.
double noise(const glm::dvec3& p) {
    const double x = std::floor(p.x * 64.0 + 0.5) * 12.9898 + std::floor(p.y * 64.0 + 0.5) * 78.233 +
                     std::floor(p.z * 64.0 + 0.5) * 37.719;
    const double s = x * 0.31830988618379067 + 0.5 * x * x * 1e-3;
    return 2.0 * (s - std::floor(s)) - 1.0;
}

}  // namespace

glm::vec3 srgb(int red, int green, int blue) {
    return {linear_from_byte(red), linear_from_byte(green), linear_from_byte(blue)};
}

glm::vec3 scaled(const glm::vec3& color, double factor) {
    return color * static_cast<float>(factor);
}

void MeshBuilder::glow(const glm::vec3& emission) {
    changes_.push_back({mesh_.triangle_count(), emission});
}

std::vector<glm::vec3> MeshBuilder::take_emission() {
    std::vector<glm::vec3> result;
    if (!changes_.empty()) result.resize(mesh_.triangle_count(), glm::vec3(0.0f));
    for (const Change& change : changes_)
        std::fill(result.begin() + static_cast<std::ptrdiff_t>(change.first), result.end(), change.emission);
    changes_.clear();
    return result;
}

void MeshBuilder::triangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::vec3& color) {
    for (const glm::dvec3& p : {a, b, c}) {
        mesh_.indices.push_back(static_cast<std::uint32_t>(mesh_.positions.size()));
        mesh_.positions.emplace_back(frame * p);
        mesh_.colors.push_back(color);
    }
}

void MeshBuilder::quad(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d,
                       const glm::vec3& color) {
    const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
    for (const glm::dvec3& p : {a, b, c, d}) {
        mesh_.positions.emplace_back(frame * p);
        mesh_.colors.push_back(color);
    }
    for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) mesh_.indices.push_back(first + i);
}

void MeshBuilder::box(const glm::dvec3& min, const glm::dvec3& max, const glm::vec3& color, bool open_bottom) {
    const auto p = [&](int i) {
        return glm::dvec3((i & 1) ? max.x : min.x, (i & 2) ? max.y : min.y, (i & 4) ? max.z : min.z);
    };
    quad(p(4), p(5), p(7), p(6), color);
    quad(p(1), p(0), p(2), p(3), color);
    quad(p(5), p(1), p(3), p(7), color);
    quad(p(0), p(4), p(6), p(2), color);
    quad(p(6), p(7), p(3), p(2), color);
    if (!open_bottom) quad(p(0), p(1), p(5), p(4), color);
}

void MeshBuilder::bar(const glm::dvec3& a, const glm::dvec3& b, double thickness, const glm::vec3& color) {
    tube(a, b, thickness * std::numbers::sqrt2 / 2.0, thickness * std::numbers::sqrt2 / 2.0, 4, color);
}

void MeshBuilder::tube(const glm::dvec3& a, const glm::dvec3& b, double ra, double rb, int sides,
                       const glm::vec3& color, bool open) {
    glm::dvec3 side, up;
    complete(glm::normalize(b - a), side, up);
    const auto rim = [&](int k, double radius) {
        const double angle = 2.0 * std::numbers::pi * (k + 0.5) / sides;
        return radius * (std::cos(angle) * side + std::sin(angle) * up);
    };
    for (int k = 0; k < sides; ++k) {
        const glm::dvec3 a0 = a + rim(k, ra), a1 = a + rim(k + 1, ra), b0 = b + rim(k, rb), b1 = b + rim(k + 1, rb);
        if (rb == 0.0)
            triangle(a0, a1, b, color);
        else if (ra == 0.0)
            triangle(a, b1, b0, color);
        else
            quad(a0, a1, b1, b0, color);
        if (open || k == 0 || k + 1 == sides) continue;
        if (ra > 0.0) triangle(a + rim(0, ra), a1, a0, color);
        if (rb > 0.0) triangle(b + rim(0, rb), b0, b1, color);
    }
}

void MeshBuilder::blob(const glm::dvec3& center, const glm::dvec3& radii, const glm::vec3& color, double ragged) {
    static const Sphere sphere = make_sphere();
    const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
    for (const glm::dvec3& p : sphere.points) {
        mesh_.positions.emplace_back(frame * (center + p * radii * (1.0 + ragged * noise(p + center))));
        mesh_.colors.push_back(scaled(color, 0.80 + 0.28 * p.y + 0.08 * noise(p - center)));
    }
    for (const auto& face : sphere.faces)
        for (const std::size_t i : face) mesh_.indices.push_back(first + static_cast<std::uint32_t>(i));
}

void MeshBuilder::sweep(std::span<const glm::dvec2> profile, double depth, const glm::vec3& sides,
                        const glm::vec3& caps) {
    const double z = 0.5 * depth;
    const std::size_t n = profile.size();
    for (std::size_t i = 0; i < n; ++i) {
        const glm::dvec2 a = profile[i], b = profile[(i + 1) % n];
        quad({a.x, a.y, z}, {a.x, a.y, -z}, {b.x, b.y, -z}, {b.x, b.y, z}, sides);
        if (i == 0 || i + 1 == n) continue;
        const glm::dvec2 o = profile[0];
        triangle({o.x, o.y, z}, {a.x, a.y, z}, {b.x, b.y, z}, caps);
        triangle({o.x, o.y, -z}, {b.x, b.y, -z}, {a.x, a.y, -z}, caps);
    }
}

std::uint32_t MeshBuilder::vertex(const glm::dvec3& point, const glm::vec3& color) {
    mesh_.positions.emplace_back(frame * point);
    mesh_.colors.push_back(color);
    return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
}

void MeshBuilder::face(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    for (const std::uint32_t i : {a, b, c}) mesh_.indices.push_back(i);
}

void MeshBuilder::face(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    face(a, b, c);
    face(a, c, d);
}

void MeshBuilder::lathe(std::span<const glm::dvec2> profile, int sides, const glm::vec3& color, bool ring) {
    // By profile point: its circle of vertices, or one at radius 0.
    std::vector<std::vector<std::uint32_t>> circles;
    for (const glm::dvec2& p : profile) {
        auto& circle = circles.emplace_back();
        for (int k = 0; k < (p.x > 0.0 ? sides : 1); ++k) {
            const double angle = 2.0 * std::numbers::pi * k / sides;
            circle.push_back(vertex({p.x * std::cos(angle), p.y, p.x * std::sin(angle)}, color));
        }
    }
    const auto at = [](const std::vector<std::uint32_t>& circle, int k) {
        return circle[static_cast<std::size_t>(k) % circle.size()];
    };
    for (std::size_t i = 0; i + (ring ? 0 : 1) < circles.size(); ++i) {
        const auto &low = circles[i], &high = circles[(i + 1) % circles.size()];
        for (int k = 0; k < sides; ++k) {
            if (low.size() == 1)
                face(low[0], at(high, k), at(high, k + 1));
            else if (high.size() == 1)
                face(at(low, k), high[0], at(low, k + 1));
            else
                face(at(low, k), at(high, k), at(high, k + 1), at(low, k + 1));
        }
    }
}

void MeshBuilder::gear(int teeth, double radius, double depth, double hole, double thickness, const glm::vec3& color) {
    struct Spoke {
        std::uint32_t outer_low, outer_high, inner_low, inner_high;
    };
    std::vector<Spoke> spokes;
    for (int k = 0; k < 4 * teeth; ++k) {
        const double angle = 2.0 * std::numbers::pi * k / (4 * teeth), r = k % 4 < 2 ? radius : radius + depth;
        const glm::dvec3 out(std::cos(angle), 0.0, std::sin(angle)), up(0.0, thickness, 0.0);
        const std::uint32_t a = vertex(r * out, color), b = vertex(r * out + up, color), c = vertex(hole * out, color),
                            d = vertex(hole * out + up, color);
        spokes.push_back({a, b, c, d});
    }
    for (std::size_t k = 0; k < spokes.size(); ++k) {
        const Spoke &s = spokes[k], &t = spokes[(k + 1) % spokes.size()];
        face(s.outer_low, s.outer_high, t.outer_high, t.outer_low);
        face(s.inner_high, s.inner_low, t.inner_low, t.inner_high);
        face(s.outer_high, s.inner_high, t.inner_high, t.outer_high);
        face(s.inner_low, s.outer_low, t.outer_low, t.inner_low);
    }
}

void MeshBuilder::pipe(std::span<const glm::dvec3> line, double radius, int sides, const glm::vec3& color) {
    glm::dvec3 side, up;
    complete(glm::normalize(line[1] - line[0]), side, up);
    std::vector<std::vector<std::uint32_t>> circles;
    for (std::size_t i = 0; i < line.size(); ++i) {
        // The frame is carried along: turned as little as the line turns.
        const glm::dvec3 before = i > 0 ? glm::normalize(line[i] - line[i - 1]) : glm::normalize(line[1] - line[0]);
        const glm::dvec3 after = i + 1 < line.size() ? glm::normalize(line[i + 1] - line[i]) : before;
        const glm::dvec3 axis = glm::normalize(before + after);
        side = glm::normalize(side - glm::dot(side, axis) * axis);
        up = glm::cross(axis, side);
        auto& circle = circles.emplace_back();
        for (int k = 0; k < sides; ++k) {
            const double angle = 2.0 * std::numbers::pi * k / sides;
            circle.push_back(vertex(line[i] + radius * (std::cos(angle) * side + std::sin(angle) * up), color));
        }
    }
    const auto n = static_cast<std::size_t>(sides);
    for (std::size_t i = 0; i + 1 < circles.size(); ++i)
        for (std::size_t k = 0; k < n; ++k)
            face(circles[i][k], circles[i][(k + 1) % n], circles[i + 1][(k + 1) % n], circles[i + 1][k]);
    for (std::size_t k = 1; k + 1 < n; ++k) {
        face(circles.front()[0], circles.front()[k + 1], circles.front()[k]);
        face(circles.back()[0], circles.back()[k], circles.back()[k + 1]);
    }
}

}  // namespace crofton::assets
