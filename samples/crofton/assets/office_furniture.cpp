// SPDX-License-Identifier: MIT
#include "assets/office_furniture.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace crofton::assets::office {
namespace {

using town::Library;

// A round bar with ends, upright.
void post(MeshBuilder& b, const glm::dvec3& foot, double radius, double height, int sides, const glm::vec3& color) {
    const std::array line{foot, foot + glm::dvec3(0.0, height, 0.0)};
    b.pipe(line, radius, sides, color);
}

}  // namespace

scene::MeshId make_desk(Library& library) {
    static const std::array tops = {srgb(214, 190, 154), srgb(232, 228, 220), srgb(150, 108, 74)};
    MeshBuilder b;
    const glm::vec3 top = tops[static_cast<std::size_t>(library.pick(tops.size()))], metal = srgb(150, 152, 156);
    b.box({-0.8, 0.71, -0.4}, {0.8, 0.74, 0.4}, top);
    for (const double x : {-0.74, 0.70}) {
        b.box({x, 0.03, -0.03}, {x + 0.04, 0.71, 0.03}, metal);
        b.box({x - 0.01, 0.0, -0.36}, {x + 0.05, 0.03, 0.36}, metal);
    }
    b.box({0.28, 0.06, -0.3}, {0.68, 0.69, 0.3}, scaled(top, 0.9));
    for (int k = 0; k < 3; ++k) {
        b.box({0.295, 0.09 + 0.2 * k, 0.3}, {0.665, 0.27 + 0.2 * k, 0.315}, top);
        b.box({0.42, 0.17 + 0.2 * k, 0.315}, {0.54, 0.19 + 0.2 * k, 0.335}, metal);
    }
    b.box({-0.7, 0.3, -0.37}, {0.28, 0.66, -0.35}, scaled(top, 0.85));
    return library.add(b, "desk");
}

scene::MeshId make_chair(Library& library) {
    static const std::array cloths = {srgb(52, 60, 72), srgb(120, 44, 40), srgb(44, 90, 110), srgb(70, 96, 62)};
    MeshBuilder b;
    const glm::vec3 cloth = cloths[static_cast<std::size_t>(library.pick(cloths.size()))], dark = srgb(40, 41, 44);
    for (int k = 0; k < 5; ++k) {
        const double angle = 2.0 * std::numbers::pi * k / 5.0;
        const glm::dvec3 out(std::cos(angle), 0.0, std::sin(angle));
        const std::array leg{glm::dvec3(0.0, 0.12, 0.0), 0.2 * out + glm::dvec3(0.0, 0.10, 0.0),
                             0.32 * out + glm::dvec3(0.0, 0.08, 0.0)};
        b.pipe(leg, 0.022, 8, dark);
        const std::array axle{0.32 * out + glm::dvec3(-0.015, 0.03, 0.0), 0.32 * out + glm::dvec3(0.015, 0.03, 0.0)};
        b.pipe(axle, 0.03, 10, dark);
    }
    post(b, {0.0, 0.1, 0.0}, 0.03, 0.34, 10, srgb(170, 172, 176));
    constexpr glm::dvec2 kSeat[] = {{0.0, 0.44}, {0.22, 0.44}, {0.26, 0.47}, {0.26, 0.50}, {0.22, 0.53}, {0.0, 0.54}};
    b.lathe(kSeat, 20, cloth);
    // The back is bent around the sitter.
    for (int row = 0; row < 5; ++row) {
        std::array<glm::dvec3, 9> line;
        for (std::size_t k = 0; k < line.size(); ++k) {
            const double s = (static_cast<double>(k) - 4.0) / 4.0;
            line[k] = {0.22 * s, 0.66 + 0.085 * row, -0.27 - 0.015 * row + 0.07 * s * s};
        }
        b.pipe(line, 0.045, 8, cloth);
    }
    const std::array spine{glm::dvec3(0.0, 0.45, -0.2), glm::dvec3(0.0, 0.5, -0.3), glm::dvec3(0.0, 0.9, -0.36)};
    b.pipe(spine, 0.02, 8, dark);
    for (const double x : {-0.29, 0.29}) {
        const std::array arm{glm::dvec3(x, 0.48, -0.05), glm::dvec3(x, 0.68, -0.1), glm::dvec3(x, 0.70, 0.14)};
        b.pipe(arm, 0.02, 8, dark);
    }
    return library.add(b, "office chair");
}

scene::MeshId make_screen(Library& library) {
    static const std::array glows = {srgb(70, 110, 170), srgb(210, 214, 220), srgb(60, 140, 100), srgb(30, 32, 40)};
    MeshBuilder b;
    const glm::vec3 dark = srgb(28, 29, 32);
    b.box({-0.12, 0.0, -0.2}, {0.12, 0.015, 0.02}, dark);
    b.box({-0.025, 0.015, -0.13}, {0.025, 0.18, -0.10}, dark);
    b.box({-0.30, 0.12, -0.10}, {0.30, 0.48, -0.07}, dark);
    b.box({-0.285, 0.14, -0.07}, {0.285, 0.465, -0.068}, glows[static_cast<std::size_t>(library.pick(glows.size()))]);
    b.box({-0.22, 0.0, 0.10}, {0.22, 0.012, 0.24}, srgb(58, 60, 64));
    for (int row = 0; row < 5; ++row)
        for (int key = 0; key < 14; ++key) {
            const double x = -0.21 + 0.03 * key, z = 0.108 + 0.026 * row;
            b.box({x, 0.012, z}, {x + 0.025, 0.02, z + 0.021}, srgb(36, 37, 40));
        }
    b.blob({0.30, 0.012, 0.17}, {0.03, 0.02, 0.055}, srgb(46, 47, 50), 0.0);
    return library.add(b, "screen and keyboard");
}

scene::MeshId make_computer(Library& library) {
    MeshBuilder b;
    b.box({-0.1, 0.02, -0.22}, {0.1, 0.45, 0.22}, srgb(48, 50, 54));
    for (int k = 0; k < 10; ++k)
        b.box({-0.08, 0.06 + 0.02 * k, 0.22}, {0.08, 0.07 + 0.02 * k, 0.225}, srgb(24, 25, 28));
    return library.add(b, "computer");
}

scene::MeshId make_desk_lamp(Library& library) {
    MeshBuilder b;
    const glm::vec3 paint = library.chance(0.5) ? srgb(190, 60, 48) : srgb(60, 62, 66);
    constexpr glm::dvec2 kFoot[] = {{0.0, 0.0}, {0.09, 0.0}, {0.09, 0.015}, {0.03, 0.03}, {0.0, 0.03}};
    b.lathe(kFoot, 20, paint);
    const std::array arm{glm::dvec3(0.0, 0.02, 0.0), glm::dvec3(-0.12, 0.24, 0.0), glm::dvec3(0.10, 0.42, 0.0)};
    b.pipe(arm, 0.01, 8, paint);
    b.frame = Transform{glm::dmat3(1.0), {0.12, 0.36, 0.0}};
    constexpr glm::dvec2 kShade[] = {{0.0, 0.02}, {0.06, 0.0}, {0.07, 0.0}, {0.03, 0.08}, {0.0, 0.09}};
    b.lathe(kShade, 16, paint);
    return library.add(b, "desk lamp");
}

scene::MeshId make_bookshelf(Library& library) {
    MeshBuilder b;
    auto& random = library.random;
    const glm::vec3 wood = scaled(srgb(168, 128, 88), random.uniform(0.7, 1.15));
    b.box({-0.5, 0.0, -0.16}, {-0.47, 2.0, 0.16}, wood);
    b.box({0.47, 0.0, -0.16}, {0.5, 2.0, 0.16}, wood);
    b.box({-0.47, 0.0, -0.16}, {0.47, 2.0, -0.145}, scaled(wood, 0.85));
    for (int shelf = 0; shelf < 6; ++shelf) {
        const double y = 0.05 + 0.386 * shelf;
        b.box({-0.47, y - 0.02, -0.145}, {0.47, y, 0.16}, wood);
        if (shelf == 5) break;
        const double end = random.uniform(0.1, 0.44);
        for (double x = -0.46; x < end;) {
            const double thick = random.uniform(0.018, 0.05), high = random.uniform(0.2, 0.31),
                         deep = random.uniform(0.16, 0.22);
            const double red = random.uniform(40.0, 200.0), green = random.uniform(40.0, 160.0),
                         blue = random.uniform(40.0, 160.0);
            b.box({x, y, -0.1}, {x + thick, y + high, -0.1 + deep},
                  srgb(static_cast<int>(red), static_cast<int>(green), static_cast<int>(blue)));
            x += thick + 0.002;
        }
    }
    return library.add(b, "bookshelf");
}

scene::MeshId make_cabinet(Library& library) {
    MeshBuilder b;
    const glm::vec3 paint = library.chance(0.5) ? srgb(196, 198, 196) : srgb(120, 128, 132);
    b.box({-0.4, 0.0, -0.25}, {0.4, 1.25, 0.25}, paint);
    for (int k = 0; k < 4; ++k) {
        b.box({-0.385, 0.03 + 0.305 * k, 0.25}, {0.385, 0.315 + 0.305 * k, 0.265}, scaled(paint, 1.06));
        b.box({-0.08, 0.2 + 0.305 * k, 0.265}, {0.08, 0.22 + 0.305 * k, 0.285}, srgb(90, 92, 96));
    }
    return library.add(b, "cabinet");
}

scene::MeshId make_plant(Library& library) {
    auto& random = library.random;
    MeshBuilder b;
    constexpr glm::dvec2 kPot[] = {{0.0, 0.0},   {0.13, 0.0},  {0.18, 0.3}, {0.20, 0.3},
                                   {0.20, 0.34}, {0.16, 0.34}, {0.0, 0.31}};
    b.lathe(kPot, 20, library.chance(0.5) ? srgb(176, 96, 66) : srgb(224, 222, 216));
    const glm::vec3 green = scaled(srgb(66, 112, 56), random.uniform(0.8, 1.2));
    const int stems = 9 + library.pick(5);
    for (int k = 0; k < stems; ++k) {
        const double angle = 2.0 * std::numbers::pi * (k + random.uniform(0.0, 0.6)) / stems,
                     reach = random.uniform(0.15, 0.4), rise = random.uniform(0.5, 1.1);
        const glm::dvec3 out(std::cos(angle), 0.0, std::sin(angle));
        const std::array stem{glm::dvec3(0.0, 0.3, 0.0), 0.3 * reach * out + glm::dvec3(0.0, 0.3 + 0.7 * rise, 0.0),
                              reach * out + glm::dvec3(0.0, 0.3 + rise, 0.0)};
        b.pipe(stem, 0.008, 5, scaled(green, 0.7));
        const double size = random.uniform(0.08, 0.15);
        b.blob(stem[2], {size, 0.6 * size, size}, scaled(green, random.uniform(0.85, 1.15)), 0.15);
    }
    return library.add(b, "plant");
}

scene::MeshId make_sofa(Library& library) {
    static const std::array cloths = {srgb(88, 96, 110), srgb(150, 110, 70), srgb(70, 104, 96)};
    MeshBuilder b;
    const glm::vec3 cloth = cloths[static_cast<std::size_t>(library.pick(cloths.size()))];
    b.box({-1.0, 0.12, -0.4}, {1.0, 0.3, 0.4}, scaled(cloth, 0.85));
    for (const double x : {-0.82, 0.01}) {
        b.box({x, 0.3, -0.22}, {x + 0.81, 0.44, 0.4}, cloth);
        b.box({x, 0.44, -0.4}, {x + 0.81, 0.82, -0.2}, cloth);
    }
    for (const double x : {-1.0, 0.82}) b.box({x, 0.3, -0.4}, {x + 0.18, 0.62, 0.4}, scaled(cloth, 0.95));
    for (const double x : {-0.9, 0.9})
        for (const double z : {-0.32, 0.32}) post(b, {x, 0.0, z}, 0.03, 0.12, 8, srgb(60, 46, 36));
    return library.add(b, "sofa");
}

scene::MeshId make_meeting_table(Library& library) {
    MeshBuilder b;
    const glm::vec3 wood = srgb(140, 100, 70);
    b.box({-1.6, 0.70, -0.6}, {1.6, 0.74, 0.6}, wood);
    for (const double x : {-1.1, 1.1}) {
        post(b, {x, 0.03, 0.0}, 0.06, 0.67, 16, srgb(150, 152, 156));
        b.box({x - 0.06, 0.0, -0.45}, {x + 0.06, 0.03, 0.45}, srgb(150, 152, 156));
    }
    return library.add(b, "meeting table");
}

scene::MeshId make_whiteboard(Library& library) {
    MeshBuilder b;
    b.box({-1.0, 0.9, 0.0}, {1.0, 2.1, 0.02}, srgb(150, 152, 156));
    b.box({-0.97, 0.93, 0.02}, {0.97, 2.07, 0.025}, srgb(246, 246, 244));
    b.box({-0.5, 0.88, 0.02}, {0.5, 0.9, 0.1}, srgb(150, 152, 156));
    for (int k = 0; k < 14; ++k) {
        const double x = -0.85 + 0.6 * library.random.uniform(), y = 1.05 + 0.07 * k;
        const double length = library.random.uniform(0.3, 1.0);
        b.box({x, y, 0.025}, {x + length, y + 0.012, 0.026}, k % 3 == 0 ? srgb(180, 40, 40) : srgb(30, 40, 90));
    }
    return library.add(b, "whiteboard");
}

scene::MeshId make_bin(Library& library) {
    MeshBuilder b;
    constexpr glm::dvec2 kBin[] = {{0.0, 0.0}, {0.12, 0.0}, {0.15, 0.32}, {0.14, 0.32}, {0.115, 0.02}, {0.0, 0.02}};
    b.lathe(kBin, 16, srgb(62, 64, 68));
    return library.add(b, "waste bin");
}

scene::MeshId make_mug(Library& library) {
    static const std::array paints = {srgb(232, 230, 224), srgb(60, 90, 150), srgb(190, 80, 50)};
    MeshBuilder b;
    const glm::vec3 paint = paints[static_cast<std::size_t>(library.pick(paints.size()))];
    constexpr glm::dvec2 kMug[] = {{0.0, 0.0}, {0.04, 0.0}, {0.042, 0.1}, {0.037, 0.1}, {0.035, 0.02}, {0.0, 0.02}};
    b.lathe(kMug, 18, paint);
    std::array<glm::dvec3, 7> handle;
    for (std::size_t k = 0; k < handle.size(); ++k) {
        const double angle = std::numbers::pi * static_cast<double>(k) / 6.0;
        handle[k] = {0.038 + 0.028 * std::sin(angle), 0.05 + 0.03 * std::cos(angle), 0.0};
    }
    b.pipe(handle, 0.005, 6, paint);
    return library.add(b, "mug");
}

scene::MeshId make_printer(Library& library) {
    MeshBuilder b;
    const glm::vec3 light = srgb(220, 220, 216), dark = srgb(70, 72, 76);
    b.box({-0.3, 0.0, -0.3}, {0.3, 0.8, 0.3}, light);
    b.box({-0.32, 0.8, -0.32}, {0.32, 1.0, 0.25}, dark);
    b.box({-0.28, 1.0, -0.3}, {0.28, 1.08, 0.2}, light);
    for (int k = 0; k < 3; ++k)
        b.box({-0.27, 0.08 + 0.22 * k, 0.3}, {0.27, 0.27 + 0.22 * k, 0.315}, scaled(light, 0.92));
    b.box({0.05, 1.0, 0.2}, {0.28, 1.06, 0.3}, srgb(40, 70, 100));
    return library.add(b, "printer");
}

scene::MeshId make_kitchen(Library& library) {
    MeshBuilder b;
    const glm::vec3 front = srgb(226, 224, 218), top = srgb(90, 86, 80), metal = srgb(160, 162, 166);
    b.box({-1.5, 0.1, -0.3}, {1.5, 0.86, 0.27}, front);
    b.box({-1.5, 0.0, -0.3}, {1.5, 0.1, 0.2}, srgb(60, 60, 62));
    b.box({-1.5, 0.86, -0.3}, {1.5, 0.9, 0.3}, top);
    b.box({-1.5, 1.45, -0.3}, {1.5, 2.1, 0.02}, front);
    for (int k = 0; k < 5; ++k) {
        const double x = -1.49 + 0.6 * k;
        b.box({x, 0.12, 0.27}, {x + 0.58, 0.84, 0.285}, scaled(front, 1.03));
        b.box({x + 0.5, 0.6, 0.285}, {x + 0.52, 0.78, 0.305}, metal);
        b.box({x, 1.46, 0.02}, {x + 0.58, 2.09, 0.035}, scaled(front, 1.03));
    }
    std::array<glm::dvec3, 9> tap;
    for (std::size_t k = 0; k < tap.size(); ++k) {
        const double angle = std::numbers::pi * static_cast<double>(k) / 8.0;
        tap[k] = {0.3, 1.1 + 0.1 * std::sin(angle), -0.12 + 0.1 * (1.0 - std::cos(angle))};
    }
    tap.front().y = 0.9;
    b.pipe(tap, 0.014, 10, metal);
    constexpr glm::dvec2 kBowl[] = {{0.0, 0.9}, {0.1, 0.9}, {0.16, 0.98}, {0.15, 0.98}, {0.09, 0.915}, {0.0, 0.915}};
    b.frame = Transform{glm::dmat3(1.0), {-0.9, 0.0, 0.0}};
    b.lathe(kBowl, 24, srgb(214, 190, 120));
    return library.add(b, "kitchen");
}

scene::MeshId make_ceiling_light(Library& library) {
    MeshBuilder b;
    for (const double x : {-0.5, 0.5}) b.box({x - 0.01, -0.35, -0.01}, {x + 0.01, 0.0, 0.01}, srgb(120, 122, 126));
    b.box({-0.65, -0.41, -0.1}, {0.65, -0.37, 0.1}, srgb(190, 192, 196));
    b.glow({9.0f, 8.6f, 8.0f});
    b.box({-0.63, -0.415, -0.085}, {0.63, -0.41, 0.085}, srgb(255, 252, 240));
    return library.add(b, "ceiling light");
}

scene::MeshId make_door(Library& library) {
    MeshBuilder b;
    b.box({0.0, 0.01, -0.02}, {0.96, 2.08, 0.02}, srgb(172, 134, 92));
    for (const double z : {-0.06, 0.06}) {
        const std::array handle{glm::dvec3(0.88, 1.05, z < 0.0 ? -0.02 : 0.02), glm::dvec3(0.88, 1.05, z),
                                glm::dvec3(0.76, 1.05, z)};
        b.pipe(handle, 0.012, 8, srgb(160, 162, 166));
    }
    return library.add(b, "door");
}

}  // namespace crofton::assets::office
