// SPDX-License-Identifier: MIT
// Parcels with courtyards, streets, and the country around.
#include <array>
#include <cmath>
#include <numbers>

#include "assets/town_blocks.hpp"

namespace crofton::assets::town {
namespace {

std::vector<glm::dvec2> rectangle(double half_x, double half_y) {
    return {{-half_x, -half_y}, {half_x, -half_y}, {half_x, half_y}, {-half_x, half_y}};
}

// With cut corners, as courtyards have.
std::vector<glm::dvec2> octagon(double hx, double hy, double cut) {
    return {{-hx + cut, -hy}, {hx - cut, -hy}, {hx, -hy + cut}, {hx, hy - cut},
            {hx - cut, hy},   {-hx + cut, hy}, {-hx, hy - cut}, {-hx, -hy + cut}};
}

std::vector<glm::dvec2> circle(double radius, int points) {
    std::vector<glm::dvec2> result;
    for (int k = 0; k < points; ++k) {
        const double angle = 2.0 * std::numbers::pi * (k + 0.5) / points;
        result.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    return result;
}

// Hills that begin gently outside the town.
double hill(double x, double z, double outside) {
    const double rise = std::min(outside / 400.0, 1.0);
    return rise *
               (16.0 + 12.0 * std::sin(0.008 * x + 1.0) * std::cos(0.009 * z) + 7.0 * std::sin(0.021 * x - 0.017 * z)) -
           0.05;
}

}  // namespace

const Builder::Ground& Builder::ground(const Block& b, bool courtyard) {
    const int w = static_cast<int>(std::lround(10.0 * b.width())), d = static_cast<int>(std::lround(10.0 * b.depth()));
    const auto [entry, added] = grounds_.try_emplace({courtyard ? -w : w, d});
    Ground& g = entry->second;
    if (!added) return g;
    const double hx = 0.5 * b.width() + kSidewalk, hz = 0.5 * b.depth() + kSidewalk;
    const double inset = courtyard ? kSidewalk + kHouseDepth + 0.1 : kSidewalk + 0.2;
    const auto court = octagon(hx - inset, hz - inset, courtyard ? 1.5 : 4.0);
    const auto plaza = circle(courtyard ? 3.2 : 10.0, 24);
    const glm::dvec3 u(1, 0, 0), v(0, 0, -1);
    g.paving = library_.add_polygon({rectangle(hx, hz), court}, {}, u, v, srgb(168, 162, 152), "parcel");
    g.lawn = library_.add_polygon({court, plaza}, {}, u, v, srgb(104, 128, 66), "lawn");
    g.setts = library_.add_polygon({court, plaza}, {}, u, v, srgb(150, 143, 134), "setts");
    g.gravel = courtyard ? library_.add_polygon({plaza}, {}, u, v, srgb(196, 180, 148), "court")
                         : library_.add_polygon({plaza, circle(2.8, 16)}, {}, u, v, srgb(196, 180, 148), "plaza");
    MeshBuilder kerb;
    const glm::vec3 stone = srgb(190, 188, 182);
    for (const double s : {-1.0, 1.0}) {
        kerb.box({-hx - 0.12, -kKerb, s * hz - 0.12}, {hx + 0.12, 0.015, s * hz + 0.12}, stone, true);
        kerb.box({s * hx - 0.12, -kKerb, -hz + 0.12}, {s * hx + 0.12, 0.015, hz - 0.12}, stone, true);
    }
    g.kerb = library_.add(kerb, "kerb");
    return g;
}

void Builder::add_streets(const Grid& grid) {
    std::map<int, scene::MeshId> streets;
    const auto street = [&](double length) {
        const auto [entry, added] = streets.try_emplace(static_cast<int>(std::lround(10.0 * length)));
        if (added) entry->second = make_street(library_, length, kCarriageway);
        return entry->second;
    };
    const double h = 0.5 * kCarriageway;
    const auto crossing =
        library_.add_polygon({rectangle(h, h)}, {}, {1, 0, 0}, {0, 0, -1}, srgb(90, 90, 92), "crossing");
    const auto at = [](double x, double z, double turn) {
        return *from_trs({x, 0.0, z}, glm::angleAxis(turn, glm::dvec3(0, 1, 0)), glm::dvec3(1.0));
    };
    for (std::size_t j = 0; j < grid.z_lines.size(); ++j)
        for (std::size_t i = 0; i < grid.x_lines.size(); ++i) {
            const double x = grid.x_lines[i], z = grid.z_lines[j];
            place(Parts{crossing}, at(x, z, 0.0));
            if (i + 1 < grid.x_lines.size())
                place(Parts{street(grid.x_lines[i + 1] - x - kCarriageway)}, at(x + h, z, 0.0));
            if (j + 1 < grid.z_lines.size())
                place(Parts{street(grid.z_lines[j + 1] - z - kCarriageway)}, at(x, z + h, -0.5 * std::numbers::pi));
        }
}

// Rings of ground around the town's outline, ever wider, and woods on them.
void Builder::add_countryside(const Grid& grid) {
    const double hx = 0.5 * (grid.x_lines.back() - grid.x_lines.front()) + 0.5 * kCarriageway;
    const double hz = 0.5 * (grid.z_lines.back() - grid.z_lines.front()) + 0.5 * kCarriageway;
    const double cx = 0.5 * (grid.x_lines.front() + grid.x_lines.back()),
                 cz = 0.5 * (grid.z_lines.front() + grid.z_lines.back());
    constexpr std::array<double, 8> kRings = {0.0, 6.0, 30.0, 70.0, 130.0, 220.0, 350.0, 560.0};
    constexpr int kSteps = 12;  // per side of the outline
    const auto point = [&](int k, double ring) {
        const int side = (k / kSteps) % 4;
        const double t = 2.0 * (k % kSteps) / kSteps - 1.0, x = hx + ring, z = hz + ring;
        const glm::dvec2 p = side == 0   ? glm::dvec2(x, -t * z)
                             : side == 1 ? glm::dvec2(-t * x, -z)
                             : side == 2 ? glm::dvec2(-x, t * z)
                                         : glm::dvec2(t * x, z);
        return glm::dvec3(cx + p.x, ring < 7.0 ? -0.05 : hill(p.x, p.y, ring), cz + p.y);
    };
    const std::array meadows = {srgb(112, 134, 70), srgb(126, 142, 76), srgb(150, 146, 84), srgb(98, 122, 62),
                                srgb(170, 156, 96)};
    for (int sector = 0; sector < 16; ++sector) {
        MeshBuilder b;
        for (std::size_t r = 0; r + 1 < kRings.size(); ++r)
            for (int k = 3 * sector; k < 3 * sector + 3; ++k) {
                const glm::vec3 color = r == 0
                                            ? srgb(150, 142, 126)
                                            : scaled(meadows[static_cast<std::size_t>(library_.pick(meadows.size()))],
                                                     0.9 + 0.02 * static_cast<double>(r));
                const glm::dvec3 p = point(k, kRings[r]), q = point(k + 1, kRings[r]), s = point(k + 1, kRings[r + 1]),
                                 t = point(k, kRings[r + 1]);
                b.triangle(p, t, q, color);
                b.triangle(q, t, s, scaled(color, 0.97));
            }
        place(Parts{library_.add(b, "meadow")}, {});
    }
    const int woods = 40 + static_cast<int>(0.05 * (hx + hz));
    auto& random = library_.random;
    for (int k = 0; k < woods; ++k) {
        const double ring = random.uniform(14.0, 260.0);
        const glm::dvec3 c = point(library_.pick(4 * kSteps), ring);
        for (int t = 0; t < 3; ++t) {
            const double x = c.x + random.uniform(-7.0, 7.0), z = c.z + random.uniform(-7.0, 7.0);
            const double outside = std::max(std::abs(x - cx) - hx, std::abs(z - cz) - hz);
            if (outside < 10.0) continue;
            const double y = hill(x - cx, z - cz, outside) - 1.0;
            const double scale = random.uniform(1.0, 1.6), turn = random.uniform(0.0, 6.28);
            place(Parts{any(library_.chance(0.5) ? conifers_ : trees_)},
                  *from_trs({x, y, z}, glm::angleAxis(turn, glm::dvec3(0, 1, 0)), glm::dvec3(scale)));
        }
    }
}

}  // namespace crofton::assets::town
