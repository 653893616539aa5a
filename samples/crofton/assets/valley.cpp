// SPDX-License-Identifier: MIT
// The built-in valley: a terrain of hills with woods, bushes, rocks and grass, and a path along its bottom.
#include <array>
#include <cmath>
#include <numbers>

#include "assets/scene_maker.hpp"

namespace crofton::assets {
namespace valley {
namespace {

constexpr double kHalf = 320.0;  // of the terrain's side
constexpr double kCell = 2.0;    // of its grid
constexpr int kPatch = 16;       // cells along the side of a patch
constexpr int kPatches = static_cast<int>(2.0 * kHalf / (kCell * kPatch));
constexpr double kEyeHeight = 1.7;
constexpr double kPathWidth = 1.6;

double path_at(double z) {
    return 70.0 * std::sin(z / 75.0) + 18.0 * std::sin(z / 31.0 + 1.0);
}

// Hills on both sides of the path, rough away from it.
double height_at(double x, double z) {
    const double d = x - path_at(z), rough = d * d / (d * d + 200.0);
    const double hill = 46.0 * d * d / (d * d + 110.0 * 110.0) * (1.0 + 0.35 * std::sin(z / 58.0 + 0.02 * x));
    const double waves = 3.2 * std::sin(x / 19.0 + 1.0) * std::cos(z / 23.0) + 1.1 * std::sin(x / 7.3 + z / 9.1) +
                         0.4 * std::sin(x / 3.1 - z / 2.7);
    return hill + rough * waves + 4.0 * std::sin(z / 90.0);
}

glm::dvec3 ground(double x, double z) {
    return {x, height_at(x, z), z};
}

double slope_at(double x, double z) {
    const double dx = height_at(x + 0.5, z) - height_at(x - 0.5, z), dz = height_at(x, z + 0.5) - height_at(x, z - 0.5);
    return std::sqrt(dx * dx + dz * dz);
}

glm::vec3 color_at(double x, double z) {
    const double tone = 0.88 + 0.12 * std::sin(x / 11.0) * std::sin(z / 13.0 + 2.0);
    if (std::abs(x - path_at(z)) < kPathWidth) return scaled(srgb(158, 136, 100), tone);
    if (slope_at(x, z) > 0.85) return scaled(srgb(132, 126, 118), tone);
    return scaled(srgb(104, 132, 66), tone);
}

void add_terrain(SceneMaker& maker) {
    for (int pz = 0; pz < kPatches; ++pz)
        for (int px = 0; px < kPatches; ++px) {
            MeshBuilder b;
            for (int j = 0; j < kPatch; ++j)
                for (int i = 0; i < kPatch; ++i) {
                    const double x0 = -kHalf + kCell * (px * kPatch + i), z0 = -kHalf + kCell * (pz * kPatch + j);
                    const glm::dvec3 a = ground(x0, z0), c = ground(x0 + kCell, z0), d = ground(x0, z0 + kCell),
                                     e = ground(x0 + kCell, z0 + kCell);
                    const glm::vec3 color = color_at(x0 + 0.5 * kCell, z0 + 0.5 * kCell);
                    b.triangle(a, d, e, color);
                    b.triangle(a, e, c, color);
                }
            maker.place(b, "terrain");
        }
}

scene::MeshId make_bush(town::Library& library) {
    MeshBuilder b;
    auto& random = library.random;
    const glm::vec3 leaves = scaled(srgb(82, 112, 54), random.uniform(0.8, 1.2));
    for (int k = 0; k < 4; ++k) {
        const double x = random.uniform(-0.5, 0.5), z = random.uniform(-0.5, 0.5), size = random.uniform(0.4, 0.7);
        b.blob({x, 0.6 * size, z}, {size, 0.8 * size, size}, scaled(leaves, random.uniform(0.85, 1.1)), 0.15);
    }
    return library.add(b, "bush");
}

scene::MeshId make_rock(town::Library& library) {
    MeshBuilder b;
    auto& random = library.random;
    const double x = random.uniform(0.5, 1.3), y = random.uniform(0.4, 0.9), z = random.uniform(0.5, 1.3);
    b.blob({0.0, 0.3 * y, 0.0}, {x, y, z}, scaled(srgb(140, 134, 126), random.uniform(0.8, 1.1)), 0.22);
    return library.add(b, "rock");
}

// Blades that stand in a tuft; each is one triangle, seen from both sides.
scene::MeshId make_grass(town::Library& library) {
    MeshBuilder b;
    auto& random = library.random;
    const glm::vec3 green = scaled(srgb(120, 150, 70), random.uniform(0.8, 1.15));
    for (int k = 0; k < 24; ++k) {
        const double angle = random.uniform(0.0, 2.0 * std::numbers::pi), reach = random.uniform(0.0, 0.35),
                     tall = random.uniform(0.2, 0.55), lean = random.uniform(-0.15, 0.15);
        const glm::dvec3 foot(reach * std::cos(angle), -0.03, reach * std::sin(angle)),
            wide(0.025 * std::sin(3.0 * angle), 0.0, 0.025 * std::cos(3.0 * angle));
        b.triangle(foot - wide, foot + wide, foot + glm::dvec3(lean, tall, lean),
                   scaled(green, random.uniform(0.8, 1.1)));
    }
    return library.add(b, "grass");
}

// Where something of this radius may stand: off the path, not on a cliff.
std::array<double, 2> any_place(SceneMaker& maker, double from_path, double steepest, double widest) {
    auto& random = maker.library.random;
    for (int tries = 0;; ++tries) {
        const double z = random.uniform(-kHalf + 4.0, kHalf - 4.0), aside = random.uniform(-1.0, 1.0);
        // More of them near the path, where one walks.
        const double d = widest * aside * std::abs(aside), x = path_at(z) + d + (d < 0.0 ? -from_path : from_path);
        if (tries < 50 && (std::abs(x) > kHalf - 4.0 || slope_at(x, z) > steepest)) continue;
        return {std::min(std::max(x, -kHalf + 4.0), kHalf - 4.0), z};
    }
}

Result<SceneSource> make(const LoadOptions& options) {
    SceneMaker maker("valley", options);
    auto& library = maker.library;
    add_terrain(maker);
    struct Kind {
        std::vector<scene::MeshId> meshes;
        int count;
        double from_path, steepest, widest, least, most, sunk;
    };
    const auto some = [&](int count, auto make) {
        std::vector<scene::MeshId> meshes;
        for (int k = 0; k < count; ++k) meshes.push_back(make(library));
        return meshes;
    };
    const std::vector<scene::MeshId> grass = some(4, make_grass);
    const Kind kinds[] = {
        {some(8, town::make_broadleaf), 1500, 4.0, 0.8, 260.0, 0.8, 1.7, 0.05},
        {some(6, town::make_conifer), 1500, 5.0, 1.1, 300.0, 0.7, 1.6, 0.05},
        {some(5, make_bush), 1200, 2.6, 1.0, 200.0, 0.6, 1.5, 0.0},
        {some(5, make_rock), 500, 2.8, 9.0, 280.0, 0.4, 2.2, 0.1},
        {grass, 3000, 1.8, 0.8, 60.0, 0.8, 1.6, 0.0},
    };
    for (const scene::MeshId mesh : grass) maker.show_both_sides(mesh);
    for (const Kind& kind : kinds)
        for (int k = 0; k < kind.count; ++k) {
            const auto [x, z] = any_place(maker, kind.from_path, kind.steepest, kind.widest);
            const auto which = static_cast<std::size_t>(library.pick(static_cast<int>(kind.meshes.size())));
            const double turn = library.random.uniform(0.0, 6.28),
                         scale = library.random.uniform(kind.least, kind.most);
            maker.place(kind.meshes[which], ground(x, z) - glm::dvec3(0.0, kind.sunk, 0.0), turn, scale);
        }
    std::vector<glm::dvec3> walk;
    for (double z = -280.0; z <= 280.0; z += 4.0)
        walk.push_back(ground(path_at(z), z) + glm::dvec3(0.0, kEyeHeight, 0.0));
    return maker.take(walk);
}

}  // namespace
}  // namespace valley

Result<SceneSource> make_valley(const LoadOptions& options) {
    return valley::make(options);
}

}  // namespace crofton::assets
