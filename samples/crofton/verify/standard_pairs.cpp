// SPDX-License-Identifier: MIT
#include "standard_pairs.hpp"

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace crofton::cli {
namespace {

using std::numbers::pi;

void add_triangle(StandardPair& pair, std::uint32_t patch, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const auto first = static_cast<std::uint32_t>(pair.mesh.positions.size());
    pair.mesh.positions.insert(pair.mesh.positions.end(), {a, b, c});
    pair.mesh.indices.insert(pair.mesh.indices.end(), {first, first + 1, first + 2});
    pair.patch_of_triangle.push_back(patch);
}

// Counter-clockwise seen from where it shines.
void add_rectangle(StandardPair& pair, std::uint32_t patch, const glm::vec3& corner, const glm::vec3& x,
                   const glm::vec3& y) {
    add_triangle(pair, patch, corner, corner + x, corner + x + y);
    add_triangle(pair, patch, corner, corner + x + y, corner + y);
}

// A regular polygon of the disc's area, facing up or down.
void add_disc(StandardPair& pair, std::uint32_t patch, double height, double radius, bool up) {
    constexpr int kSides = 96;
    const double r = radius * std::sqrt(2.0 * pi / kSides / std::sin(2.0 * pi / kSides));
    const auto at = [&](int i) {
        const double angle = 2.0 * pi * i / kSides;
        return glm::vec3(glm::dvec3(r * std::cos(angle), r * std::sin(angle), height));
    };
    const glm::vec3 middle(0.0f, 0.0f, static_cast<float>(height));
    for (int i = 0; i < kSides; ++i)
        up ? add_triangle(pair, patch, middle, at(i), at(i + 1)) : add_triangle(pair, patch, middle, at(i + 1), at(i));
}

// A sphere of longitudes and latitudes; returns its area.
double add_sphere(StandardPair& pair, std::uint32_t patch, double radius, bool outward) {
    constexpr int kRows = 12, kColumns = 24;
    double area = 0.0;
    const auto at = [&](int row, int column) {
        const double t = pi * row / kRows, p = 2.0 * pi * column / kColumns;
        return glm::vec3(radius * glm::dvec3(std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)));
    };
    const auto add = [&](const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
        area += 0.5 * glm::length(glm::cross(glm::dvec3(b - a), glm::dvec3(c - a)));
        outward ? add_triangle(pair, patch, a, b, c) : add_triangle(pair, patch, a, c, b);
    };
    for (int row = 0; row < kRows; ++row)
        for (int column = 0; column < kColumns; ++column) {
            const glm::vec3 a = at(row, column), b = at(row + 1, column), c = at(row + 1, column + 1),
                            d = at(row, column + 1);
            if (row + 1 < kRows) add(a, b, c);
            if (row > 0) add(a, c, d);
        }
    return area;
}

// C-11: rectangles a × b, opposite each other at distance c.
double opposed_rectangles(double a, double b, double c) {
    const double x = a / c, y = b / c, p = 1.0 + x * x, q = 1.0 + y * y;
    return 2.0 / (pi * x * y) *
           (std::log(std::sqrt(p * q / (p + y * y))) + x * std::sqrt(q) * std::atan(x / std::sqrt(q)) +
            y * std::sqrt(p) * std::atan(y / std::sqrt(p)) - x * std::atan(x) - y * std::atan(y));
}

// C-14: from a rectangle w × l to one h × l at right angles, along the common edge l.
double rectangles_at_right_angles(double width, double height, double length) {
    const double w = width / length, h = height / length, w2 = w * w, h2 = h * h, s = w2 + h2;
    return (w * std::atan(1.0 / w) + h * std::atan(1.0 / h) - std::sqrt(s) * std::atan(1.0 / std::sqrt(s)) +
            0.25 * std::log((1.0 + w2) * (1.0 + h2) / (1.0 + s) * std::pow(w2 * (1.0 + s) / ((1.0 + w2) * s), w2) *
                            std::pow(h2 * (1.0 + s) / ((1.0 + h2) * s), h2))) /
           (pi * w);
}

// C-41: coaxial discs of radii r and s at distance h.
double coaxial_discs(double r, double s, double h) {
    const double x = 1.0 + (1.0 + (s / h) * (s / h)) / ((r / h) * (r / h));
    return 0.5 * (x - std::sqrt(x * x - 4.0 * (s / r) * (s / r)));
}

StandardPair rectangles(const char* name, float a, float b, float c) {
    StandardPair pair{name, "Howell C-11", {}, {}, opposed_rectangles(double{a}, double{b}, double{c})};
    add_rectangle(pair, 0, {0, 0, 0}, {a, 0, 0}, {0, b, 0});
    add_rectangle(pair, 1, {0, 0, c}, {0, b, 0}, {a, 0, 0});
    return pair;
}

StandardPair corner(const char* name, float w, float h, float l) {
    StandardPair pair{name, "Howell C-14", {}, {}, rectangles_at_right_angles(double{w}, double{h}, double{l})};
    add_rectangle(pair, 0, {0, 0, 0}, {w, 0, 0}, {0, l, 0});
    add_rectangle(pair, 1, {0, 0, 0}, {0, l, 0}, {0, 0, h});
    return pair;
}

}  // namespace

std::vector<StandardPair> standard_pairs() {
    std::vector<StandardPair> pairs;
    pairs.push_back(rectangles("unit squares, opposite at distance 1", 1.0f, 1.0f, 1.0f));
    pairs.push_back(rectangles("rectangles 2 × 1, opposite at distance 0.5", 2.0f, 1.0f, 0.5f));
    pairs.push_back(corner("unit squares at right angles, a common edge", 1.0f, 1.0f, 1.0f));
    pairs.push_back(corner("rectangles 2 × 1 and 0.5 × 1 at right angles", 2.0f, 0.5f, 1.0f));
    pairs.push_back(
        {"discs of radius 1 and 1.5, coaxial at distance 1", "Howell C-41", {}, {}, coaxial_discs(1.0, 1.5, 1.0)});
    add_disc(pairs.back(), 0, 0.0, 1.0, true);
    add_disc(pairs.back(), 1, 1.0, 1.5, false);
    // All that leaves the inner one reaches the outer one, which by reciprocity sends back A_in / A_out.
    pairs.push_back({"outer to inner of two concentric spheres", "reciprocity", {}, {}, 0.0});
    const double outer = add_sphere(pairs.back(), 0, 1.0, false), inner = add_sphere(pairs.back(), 1, 0.5, true);
    pairs.back().factor = inner / outer;
    return pairs;
}

Result<PairFactor> factor_by_global_lines(const StandardPair& pair, std::uint64_t blocks, std::uint64_t seed) {
    const Vector<radiosity::Material> materials(2);
    auto patches = radiosity::make_patches(pair.mesh, pair.patch_of_triangle, materials);
    if (!patches) return patches.error();
    const auto tracer = lines::LineTracer::build(pair.mesh);
    if (!tracer) return tracer.error();
    const lines::LineSource source(tracer->bounds(), lines::LineMethod::walls, seed);
    const auto matrix = radiosity::factors_by_global_lines(*tracer, *patches, source, blocks);
    if (!matrix) return matrix.error();
    return PairFactor{matrix->factor(0, 1), matrix->standard_error(0, 1), matrix->rays[0]};
}

}  // namespace crofton::cli
