// SPDX-License-Identifier: MIT
// Landmarks: a church and a tower crane.
#include <array>
#include <cmath>
#include <numbers>

#include "assets/town_library.hpp"

namespace crofton::assets::town {
namespace {

std::vector<glm::dvec2> circle(double x, double y, double radius, int points) {
    std::vector<glm::dvec2> result;
    for (int k = 0; k < points; ++k) {
        const double angle = -2.0 * std::numbers::pi * k / points;
        result.emplace_back(x + radius * std::cos(angle), y + radius * std::sin(angle));
    }
    return result;
}

// A pointed arch with its foot at (x, y).
std::vector<glm::dvec2> lancet(double x, double y, double width, double height) {
    std::vector<glm::dvec2> result{{x + 0.5 * width, y}, {x - 0.5 * width, y}};
    for (int side = 0; side < 2; ++side)
        for (int k = 0; k <= 4; ++k) {
            if (side == 1 && k == 0) continue;
            const double t = side == 0 ? k / 4.0 : 1.0 - k / 4.0, s = side == 0 ? -1.0 : 1.0;
            result.emplace_back(x + s * 0.5 * width * std::cos(0.5 * std::numbers::pi * t),
                                y + height + width * std::sin(0.5 * std::numbers::pi * t));
        }
    return result;
}

void add_lattice(MeshBuilder& b, const glm::dvec3& from, const glm::dvec3& along, const glm::dvec3& u,
                 const glm::dvec3& v, int bays, const glm::vec3& color) {
    // Four chords, and in every bay and side a slanted strut.
    const auto corner = [&](int c, int bay) {
        return from + along * static_cast<double>(bay) + (c == 0 || c == 3 ? -u : u) + (c < 2 ? -v : v);
    };
    for (int c = 0; c < 4; ++c) {
        b.bar(corner(c, 0), corner(c, bays), 0.14, color);
        for (int bay = 0; bay < bays; ++bay) {
            const int next = (c + 1) % 4;
            b.bar(corner(bay % 2 == 0 ? c : next, bay), corner(bay % 2 == 0 ? next : c, bay + 1), 0.07, color);
        }
    }
}

}  // namespace

Parts make_church(Library& library) {
    const glm::vec3 stone = srgb(206, 194, 170), dark = srgb(62, 66, 84), slate = srgb(84, 88, 98);
    Parts parts;
    constexpr double kWidth = 12.0, kLength = 22.0, kWall = 9.0, kRidge = 15.0;
    const double x0 = -0.5 * kWidth, z0 = -0.5 * kLength;
    std::vector<std::vector<glm::dvec2>> front{
        {{0, 0}, {kWidth, 0}, {kWidth, kWall}, {0.5 * kWidth, kRidge}, {0, kWall}}};
    front.push_back(circle(0.5 * kWidth, 9.6, 1.7, 20));
    front.push_back(lancet(0.5 * kWidth, 0.1, 2.4, 3.0));
    front.push_back(lancet(2.2, 3.0, 1.0, 2.4));
    front.push_back(lancet(kWidth - 2.2, 3.0, 1.0, 2.4));
    parts.push_back(library.add_polygon(front, {x0, 0, -z0}, {1, 0, 0}, {0, 1, 0}, stone, "church front"));
    parts.push_back(
        library.add_polygon({front[0], front[1]}, {-x0, 0, z0}, {-1, 0, 0}, {0, 1, 0}, stone, "church back"));
    std::vector<std::vector<glm::dvec2>> side{{{0, 0}, {kLength, 0}, {kLength, kWall}, {0, kWall}}};
    for (int k = 0; k < 5; ++k) side.push_back(lancet(2.4 + 4.3 * k, 2.4, 1.3, 3.6));
    parts.push_back(library.add_polygon(side, {x0, 0, z0}, {0, 0, 1}, {0, 1, 0}, scaled(stone, 0.95), "church side"));
    parts.push_back(
        library.add_polygon(side, {-x0, 0, -z0}, {0, 0, -1}, {0, 1, 0}, scaled(stone, 0.95), "church side"));

    MeshBuilder b;
    b.box({x0 + 0.3, 0.0, z0 + 0.3}, {-x0 - 0.3, kWall - 0.1, -z0 - 0.3}, dark, true);  // the glass behind the holes
    b.triangle({x0 + 0.5, kWall - 0.2, -z0 - 0.3}, {-x0 - 0.5, kWall - 0.2, -z0 - 0.3}, {0, kRidge - 0.5, -z0 - 0.3},
               srgb(120, 84, 110));
    const double o = 0.5, drop = o * (kRidge - kWall) / (0.5 * kWidth);
    for (const double s : {-1.0, 1.0}) {
        const glm::dvec3 e0(s * (0.5 * kWidth + o), kWall - drop, s * -(0.5 * kLength + 0.3)), e1(e0.x, e0.y, -e0.z);
        const glm::dvec3 r0(0, kRidge + 0.1, e0.z), r1(0, kRidge + 0.1, e1.z);
        b.quad(e1, e0, r0, r1, slate);
        b.quad(e0, e1, r1, r0, scaled(slate, 0.5));
    }
    for (int k = 0; k < 6; ++k)
        for (const double s : {-1.0, 1.0}) {  // buttresses, slanted outward
            const double z = z0 + 0.25 + 4.3 * k;
            b.bar({s * (0.5 * kWidth + 1.2), 0.0, z}, {s * (0.5 * kWidth + 0.1), kWall - 1.5, z}, 0.6,
                  scaled(stone, 0.85));
        }
    parts.push_back(library.add(b, "church nave"));
    MeshBuilder tower;
    const double tz = z0 - 2.6;
    tower.box({-2.8, 0, tz - 2.8}, {2.8, 20.0, tz + 2.8}, scaled(stone, 0.96), true);
    tower.box({-3.0, 19.6, tz - 3.0}, {3.0, 20.2, tz + 3.0}, scaled(stone, 0.8));
    for (const double s : {-1.0, 1.0}) {
        for (const double x : {-1.1, 1.1}) {
            tower.box({x - 0.45, 14.5, tz + s * 2.8 - 0.05}, {x + 0.45, 18.2, tz + s * 2.8 + 0.05}, dark);
            tower.box({s * 2.8 - 0.05, 14.5, tz + x - 0.45}, {s * 2.8 + 0.05, 18.2, tz + x + 0.45}, dark);
        }
        tower.tube({s * 2.8, 11.5, tz}, {s * 2.92, 11.5, tz}, 1.2, 1.2, 16, srgb(226, 220, 200));
    }
    tower.tube({0, 20.2, tz}, {0, 34.0, tz}, 3.3, 0.0, 8, srgb(92, 118, 108));
    tower.bar({0, 33.6, tz}, {0, 35.6, tz}, 0.12, srgb(210, 176, 80));
    tower.bar({-0.5, 35.0, tz}, {0.5, 35.0, tz}, 0.12, srgb(210, 176, 80));
    parts.push_back(library.add(tower, "church tower"));
    return parts;
}

scene::MeshId make_crane_tower(Library& library, double height) {
    MeshBuilder b;
    const glm::vec3 yellow = srgb(226, 170, 36);
    b.box({-2.2, 0.0, -2.2}, {2.2, 0.7, 2.2}, srgb(150, 150, 146), true);
    const int bays = static_cast<int>(height / 1.8);
    add_lattice(b, {0, 0.7, 0}, {0, (height - 0.7) / bays, 0}, {0.8, 0, 0}, {0, 0, 0.8}, bays, yellow);
    return library.add(b, "crane tower");
}

scene::MeshId make_crane_jib(Library& library, double length) {
    MeshBuilder b;
    const glm::vec3 yellow = srgb(226, 170, 36), steel = srgb(70, 72, 76);
    b.tube({0, 0, 0}, {0, 0.6, 0}, 1.1, 1.1, 12, steel);
    b.box({-0.7, 0.6, 0.9}, {0.9, 2.5, 2.2}, srgb(236, 232, 220));
    const int bays = static_cast<int>(length / 1.8);
    add_lattice(b, {-9.0, 1.2, 0}, {(length + 9.0) / (bays + 5), 0, 0}, {0, 0.5, 0}, {0, 0, 0.55}, bays + 5, yellow);
    add_lattice(b, {0, 1.2, 0}, {0, 1.4, 0}, {0.5, 0, 0}, {0, 0, 0.5}, 4, yellow);
    b.bar({0, 6.6, 0}, {length * 0.75, 1.7, 0}, 0.07, steel);
    b.bar({0, 6.6, 0}, {-8.5, 1.7, 0}, 0.07, steel);
    b.box({-9.2, -0.6, -0.9}, {-7.0, 1.0, 0.9}, srgb(150, 150, 146));
    const double hook = length * 0.62;
    b.bar({hook, 0.7, 0}, {hook, -10.0, 0}, 0.05, steel);
    b.box({hook - 0.3, -10.6, -0.3}, {hook + 0.3, -10.0, 0.3}, srgb(196, 60, 40));
    b.box({hook - 2.4, -12.4, -0.5}, {hook + 2.4, -12.0, 0.5}, srgb(130, 118, 104));
    for (const double s : {-2.2, 2.2}) b.bar({hook, -10.6, 0}, {hook + s, -12.0, 0}, 0.04, steel);
    return library.add(b, "crane jib");
}

}  // namespace crofton::assets::town
