// SPDX-License-Identifier: MIT
// Furniture of streets, gardens and squares. Much of it is thin and slanted, so that axis-aligned bounds are bad.
#include <array>
#include <cmath>
#include <numbers>

#include "assets/town_library.hpp"

namespace crofton::assets::town {

scene::MeshId make_lamp(Library& library) {
    MeshBuilder b;
    const glm::vec3 iron = srgb(46, 54, 52);
    b.tube({0, 0, 0}, {0, 0.6, 0}, 0.14, 0.10, 6, iron, true);
    b.tube({0, 0.6, 0}, {0, 5.2, 0}, 0.065, 0.045, 6, iron, true);
    // The arm bends over the street, toward +z.
    glm::dvec3 from(0, 5.2, 0);
    for (int k = 1; k <= 4; ++k) {
        const double angle = 0.5 * std::numbers::pi * k / 4.0;
        const glm::dvec3 to(0.0, 5.2 + 0.7 * std::sin(angle), 1.5 * (1.0 - std::cos(angle)));
        b.tube(from, to, 0.045, 0.04, 5, iron, true);
        from = to;
    }
    b.tube(from, from + glm::dvec3(0, -0.12, 0), 0.06, 0.26, 8, iron);
    b.glow({260.0f, 190.0f, 110.0f});
    b.tube(from + glm::dvec3(0, -0.12, 0), from + glm::dvec3(0, -0.24, 0), 0.20, 0.12, 8, srgb(255, 240, 196));
    return library.add(b, "street lamp");
}

scene::MeshId make_person(Library& library) {
    static const std::array cloths = {srgb(150, 52, 48),  srgb(52, 76, 120), srgb(64, 92, 70),
                                      srgb(196, 160, 80), srgb(88, 74, 100), srgb(60, 62, 68)};
    const auto cloth = [&] { return cloths[static_cast<std::size_t>(library.pick(cloths.size()))]; };
    MeshBuilder b;
    const glm::vec3 skin = scaled(srgb(206, 160, 130), library.random.uniform(0.45, 1.1)), coat = cloth(),
                    legs = scaled(cloth(), 0.6);
    const double stride = library.random.uniform(0.05, 0.28);
    for (const double s : {-1.0, 1.0}) {
        b.tube({s * 0.1, 0.0, s * stride}, {s * 0.09, 0.85, 0.0}, 0.07, 0.1, 5, legs, true);
        b.tube({s * 0.22, 1.38, 0.0}, {s * 0.27, 0.85, -s * stride}, 0.07, 0.05, 5, scaled(coat, 0.9), true);
    }
    b.tube({0, 0.8, 0}, {0, 1.45, 0}, 0.17, 0.21, 7, coat);
    b.tube({0, 1.5, 0}, {0, 1.68, 0}, 0.09, 0.12, 6, skin, true);
    b.tube({0, 1.66, -0.01}, {0, 1.80, -0.01}, 0.14, 0.0, 7,
           scaled(srgb(90, 66, 48), library.random.uniform(0.4, 1.6)));
    return library.add(b, "person");
}

scene::MeshId make_sign(Library& library) {
    MeshBuilder b;
    b.tube({0, 0, 0}, {0.12, 2.6, 0.05}, 0.03, 0.03, 6, srgb(140, 142, 146), true);
    b.tube({0.11, 2.35, 0.03}, {0.11, 2.35, 0.09}, 0.3, 0.3, 12,
           library.chance(0.5) ? srgb(190, 36, 32) : srgb(36, 80, 160));
    return library.add(b, "road sign");
}

scene::MeshId make_bench(Library& library) {
    MeshBuilder b;
    const glm::vec3 wood = srgb(138, 94, 58), iron = srgb(50, 52, 54);
    for (int k = 0; k < 3; ++k) b.box({-0.8, 0.44, -0.22 + 0.16 * k}, {0.8, 0.48, -0.09 + 0.16 * k}, wood);
    for (int k = 0; k < 2; ++k)
        b.box({-0.8, 0.62 + 0.18 * k, -0.32 - 0.04 * k}, {0.8, 0.75 + 0.18 * k, -0.28 - 0.04 * k}, wood);
    for (const double x : {-0.65, 0.65}) {
        b.bar({x, 0, 0.2}, {x, 0.44, 0.18}, 0.06, iron);
        b.bar({x, 0, -0.2}, {x, 0.95, -0.38}, 0.06, iron);
    }
    return library.add(b, "bench");
}

scene::MeshId make_ladder(Library& library) {
    MeshBuilder b;
    const glm::vec3 metal = srgb(182, 176, 162);
    const glm::dvec3 foot(0, 0, 0), head(0, 5.6, -1.5);
    for (const double x : {-0.22, 0.22}) b.bar(foot + glm::dvec3(x, 0, 0), head + glm::dvec3(x, 0, 0), 0.06, metal);
    for (int k = 1; k < 18; ++k) {
        const glm::dvec3 at = foot + (head - foot) * (k / 18.0);
        b.tube(at - glm::dvec3(0.22, 0, 0), at + glm::dvec3(0.22, 0, 0), 0.02, 0.02, 5, metal, true);
    }
    return library.add(b, "ladder");
}

scene::MeshId make_poles(Library& library) {
    MeshBuilder b;
    auto& random = library.random;
    for (int k = 0; k < 7; ++k) {
        const double x = -0.9 + 0.3 * k, top = random.uniform(2.6, 4.2);
        const glm::vec3 color = scaled(srgb(150, 112, 70), random.uniform(0.75, 1.1));
        const double width = random.uniform(0.05, 0.1), lean = random.uniform(-0.8, 0.8),
                     foot = random.uniform(0.6, 1.1);
        b.bar({x, 0.0, foot}, {x + lean, top, -0.1}, width, color);
    }
    return library.add(b, "leaning poles");
}

scene::MeshId make_cable(Library& library, double length, double sag) {
    MeshBuilder b;
    constexpr int kPieces = 14;
    const auto at = [&](int k) {
        const double t = static_cast<double>(k) / kPieces;
        return glm::dvec3(t * length, -4.0 * sag * t * (1.0 - t), 0.0);
    };
    for (int k = 0; k < kPieces; ++k) b.tube(at(k), at(k + 1), 0.02, 0.02, 4, srgb(30, 30, 32), true);
    return library.add(b, "cable");
}

scene::MeshId make_scaffold(Library& library, double length, double height) {
    MeshBuilder b;
    const glm::vec3 tube = srgb(158, 160, 158), plank = srgb(178, 142, 92), brace = srgb(190, 120, 40);
    const int bays = static_cast<int>(length / 2.0), levels = static_cast<int>(height / 2.0);
    for (int i = 0; i <= bays; ++i)
        for (const double z : {0.0, 1.0})
            b.tube({i * 2.0, 0, z}, {i * 2.0, height + 0.8, z}, 0.03, 0.03, 5, tube, true);
    for (int level = 1; level <= levels; ++level) {
        const double y = level * 2.0;
        for (const double z : {0.0, 1.0}) b.tube({0, y, z}, {bays * 2.0, y, z}, 0.025, 0.025, 4, tube, true);
        for (int p = 0; p < 3; ++p) b.box({0, y + 0.04, 0.06 + 0.3 * p}, {bays * 2.0, y + 0.09, 0.32 + 0.3 * p}, plank);
        for (int i = 0; i < bays; ++i)
            if ((i + level) % 2 == 0)
                b.tube({i * 2.0, y - 2.0, 1.03}, {i * 2.0 + 2.0, y, 1.03}, 0.02, 0.02, 4, brace, true);
    }
    return library.add(b, "scaffold");
}

scene::MeshId make_stall(Library& library) {
    MeshBuilder b;
    const glm::vec3 cloth = std::array{srgb(186, 54, 48), srgb(52, 110, 150), srgb(214, 168, 60),
                                       srgb(74, 130, 84)}[static_cast<std::size_t>(library.pick(4))];
    const glm::vec3 wood = srgb(140, 100, 62), white = srgb(236, 230, 216);
    for (const double x : {-1.4, 1.4}) {
        b.bar({x, 0, 0.9}, {x, 2.5, 0.9}, 0.07, wood);
        b.bar({x, 0, -0.9}, {x, 2.1, -0.9}, 0.07, wood);
    }
    b.box({-1.4, 0.0, 0.2}, {1.4, 0.9, 0.85}, wood, true);
    for (int k = 0; k < 8; ++k) {
        const double x0 = -1.6 + 0.4 * k, x1 = x0 + 0.4;
        const glm::vec3 c = k % 2 == 0 ? cloth : white;
        b.quad({x0, 2.55, 1.3}, {x1, 2.55, 1.3}, {x1, 2.1, -1.2}, {x0, 2.1, -1.2}, c);
        b.quad({x1, 2.53, 1.3}, {x0, 2.53, 1.3}, {x0, 2.08, -1.2}, {x1, 2.08, -1.2}, scaled(c, 0.5));
        b.quad({x0, 2.3, 1.3}, {x1, 2.3, 1.3}, {x1, 2.55, 1.3}, {x0, 2.55, 1.3}, c);
    }
    for (int k = 0; k < 3; ++k)
        b.blob({-0.9 + 0.9 * k, 0.95, 0.5}, {0.38, 0.16, 0.25},
               std::array{srgb(196, 60, 40), srgb(226, 160, 50), srgb(110, 150, 60)}[static_cast<std::size_t>(k % 3)],
               0.1);
    return library.add(b, "market stall");
}

scene::MeshId make_fountain(Library& library) {
    MeshBuilder b;
    const glm::vec3 stone = srgb(188, 182, 168), water = srgb(92, 138, 160);
    constexpr int kSides = 16;
    const auto rim = [&](int k, double r, double y) {
        const double angle = 2.0 * std::numbers::pi * k / kSides;
        return glm::dvec3(r * std::cos(angle), y, -r * std::sin(angle));
    };
    for (int k = 0; k < kSides; ++k) {
        b.quad(rim(k, 3.0, 0), rim(k + 1, 3.0, 0), rim(k + 1, 3.0, 0.6), rim(k, 3.0, 0.6), stone);
        b.quad(rim(k, 3.0, 0.6), rim(k + 1, 3.0, 0.6), rim(k + 1, 2.6, 0.6), rim(k, 2.6, 0.6), scaled(stone, 1.1));
        b.quad(rim(k + 1, 2.6, 0.3), rim(k, 2.6, 0.3), rim(k, 2.6, 0.6), rim(k + 1, 2.6, 0.6), scaled(stone, 0.8));
        b.triangle({0, 0.45, 0}, rim(k, 2.6, 0.45), rim(k + 1, 2.6, 0.45), water);
    }
    b.tube({0, 0.3, 0}, {0, 2.0, 0}, 0.35, 0.22, 10, stone);
    b.tube({0, 2.0, 0}, {0, 2.2, 0}, 0.3, 1.1, 12, stone);
    b.tube({0, 2.2, 0}, {0, 3.0, 0}, 0.15, 0.1, 8, scaled(stone, 0.9));
    return library.add(b, "fountain");
}

scene::MeshId make_shed(Library& library) {
    MeshBuilder b;
    const glm::vec3 wood = scaled(srgb(132, 96, 66), library.random.uniform(0.8, 1.15)), roof = srgb(92, 90, 88);
    const std::array<glm::dvec2, 4> profile = {{{-1.2, 0.0}, {1.2, 0.0}, {1.2, 1.9}, {-1.2, 2.3}}};
    b.sweep(profile, 2.0, wood, scaled(wood, 0.92));
    b.quad({-1.35, 2.36, 1.15}, {1.35, 1.91, 1.15}, {1.35, 1.91, -1.15}, {-1.35, 2.36, -1.15}, roof);
    b.box({-0.4, 0.0, 1.0}, {0.4, 1.75, 1.04}, scaled(wood, 0.6), true);
    return library.add(b, "shed");
}

}  // namespace crofton::assets::town
