// SPDX-License-Identifier: MIT
// Trees, hedges and fences.
#include <array>
#include <cmath>
#include <numbers>

#include "assets/town_library.hpp"

namespace crofton::assets::town {

scene::MeshId make_broadleaf(Library& library) {
    static const std::array leaves = {srgb(92, 124, 52), srgb(74, 110, 50),  srgb(112, 134, 58),
                                      srgb(84, 116, 66), srgb(136, 132, 54), srgb(158, 104, 48)};
    static const std::array barks = {srgb(92, 74, 58), srgb(110, 96, 80), srgb(78, 62, 50)};
    auto& random = library.random;
    MeshBuilder b;
    const glm::vec3 bark = barks[static_cast<std::size_t>(library.pick(barks.size()))];
    const glm::vec3 leaf = leaves[static_cast<std::size_t>(library.pick(leaves.size()))];
    const double trunk = random.uniform(1.8, 2.6), size = random.uniform(1.3, 1.8);
    b.tube({0, -0.1, 0}, {0.1, trunk, 0.05}, 0.22, 0.15, 7, bark, true);
    const int limbs = 2 + library.pick(2);
    for (int k = 0; k < limbs; ++k) {
        const double angle = 2.0 * std::numbers::pi * (k + random.uniform(0.0, 0.5)) / limbs;
        const double spread = size * random.uniform(0.55, 0.95), rise = random.uniform(0.8, 2.0);
        const glm::dvec3 tip(spread * std::cos(angle), trunk + rise, spread * std::sin(angle));
        b.tube({0.08, trunk - 0.25, 0.04}, tip, 0.09, 0.05, 5, bark, true);
        const double r = size * random.uniform(0.68, 0.92);
        b.blob(tip, {r, 0.82 * r, r}, scaled(leaf, random.uniform(0.88, 1.1)), 0.10);
    }
    b.blob({0.0, trunk + 1.9 + 0.4 * size, 0.0}, {size, 0.9 * size, size}, leaf, 0.10);
    return library.add(b, "broadleaf tree");
}

scene::MeshId make_conifer(Library& library) {
    auto& random = library.random;
    MeshBuilder b;
    const glm::vec3 needles = scaled(srgb(52, 84, 56), random.uniform(0.8, 1.15));
    const double height = random.uniform(6.5, 9.5), radius = random.uniform(1.4, 1.9);
    b.tube({0, -0.1, 0}, {0, 0.25 * height, 0}, 0.2, 0.15, 7, srgb(84, 62, 46), true);
    constexpr int kTiers = 6;
    for (int k = 0; k < kTiers; ++k) {
        const double t = static_cast<double>(k) / kTiers;
        const double base = height * (0.12 + 0.78 * t), top = std::min(height, base + 0.30 * height);
        const double r = radius * (1.0 - 0.84 * t), turn = random.uniform(0.0, 1.0);
        b.frame = *from_trs({}, glm::angleAxis(turn, glm::dvec3(0, 1, 0)), glm::dvec3(1.0));
        b.tube({0, base, 0}, {0, top, 0}, r, 0.0, 11, scaled(needles, 0.85 + 0.3 * t), false);
    }
    return library.add(b, "conifer");
}

scene::MeshId make_fence(Library& library, double length) {
    static const std::array paints = {srgb(228, 222, 208), srgb(122, 88, 58), srgb(94, 110, 92), srgb(150, 118, 84)};
    MeshBuilder b;
    const glm::vec3 paint = paints[static_cast<std::size_t>(library.pick(paints.size()))];
    const int pickets = static_cast<int>(length / 0.5);
    for (int k = 0; k < pickets; ++k) {
        const double x = (k + 0.5) * length / pickets, top = 1.05 + 0.06 * (k % 2);
        b.box({x - 0.045, 0.1, -0.015}, {x + 0.045, top, 0.015}, scaled(paint, library.random.uniform(0.9, 1.05)),
              true);
    }
    for (const double y : {0.3, 0.85}) b.box({0.0, y, -0.05}, {length, y + 0.08, -0.015}, scaled(paint, 0.85));
    for (const double x : {0.0, length}) b.box({x - 0.06, 0.0, -0.09}, {x + 0.06, 1.2, 0.03}, scaled(paint, 0.8), true);
    return library.add(b, "fence");
}

scene::MeshId make_hedge(Library& library, double length) {
    MeshBuilder b;
    const glm::vec3 green = scaled(srgb(78, 108, 54), library.random.uniform(0.85, 1.15));
    const int count = static_cast<int>(length / 1.5);
    for (int k = 0; k < count; ++k) {
        const double x = (k + 0.5) * length / count;
        const glm::vec3 leaves = scaled(green, library.random.uniform(0.9, 1.1));
        const double height = library.random.uniform(0.6, 0.75);
        b.blob({x, 0.55, 0.0}, {0.95, height, 0.45}, leaves, 0.08);
    }
    return library.add(b, "hedge");
}

}  // namespace crofton::assets::town
