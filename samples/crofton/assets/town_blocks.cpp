// SPDX-License-Identifier: MIT
#include "assets/town_blocks.hpp"

#include <cmath>
#include <numbers>

namespace crofton::assets::town {
namespace {

constexpr int kHousesPerWidth = 12;
constexpr double kCraneHeight = 30.0;
constexpr double kCableLength = 14.0;

Transform turned(double x, double y, double z, double turn, double scale = 1.0) {
    return *from_trs({x, y, z}, glm::angleAxis(turn, glm::dvec3(0, 1, 0)), glm::dvec3(scale));
}

}  // namespace

Builder::Builder(scene::Scene& scene, Library& library, scene::NodeId root)
    : scene_(scene), library_(library), root_(root) {
    for (int width = kLeastWidth; width <= kMostWidth; ++width)
        for (int k = 0; k < kHousesPerWidth; ++k) houses_[width].push_back(make_house(library, width));
    for (int k = 0; k < 7; ++k) trees_.push_back(make_broadleaf(library));
    for (int k = 0; k < 3; ++k) conifers_.push_back(make_conifer(library));
    for (int k = 0; k < 4; ++k) {
        fences_.push_back(make_fence(library, 6.0));
        hedges_.push_back(make_hedge(library, 6.0));
        stalls_.push_back(make_stall(library));
        sheds_.push_back(make_shed(library));
        poles_.push_back(make_poles(library));
    }
    for (int k = 0; k < 10; ++k) people_.push_back(make_person(library));
    for (int k = 0; k < 2; ++k) signs_.push_back(make_sign(library));
    lamp_ = make_lamp(library);
    bench_ = make_bench(library);
    ladder_ = make_ladder(library);
    cable_ = make_cable(library, kCableLength, 0.9);
    scaffold_ = make_scaffold(library, 12.0, 8.0);
    fountain_ = make_fountain(library);
    tower_ = make_crane_tower(library, kCraneHeight);
    jib_ = make_crane_jib(library, 30.0);
    church_ = make_church(library);
}

scene::MeshId Builder::any(const std::vector<scene::MeshId>& list) {
    return list[static_cast<std::size_t>(library_.pick(static_cast<int>(list.size())))];
}

scene::NodeId Builder::place(const Parts& parts, const Transform& transform, scene::NodeId parent) {
    if (status_ && !library_.status()) status_ = library_.status();
    if (!status_) return scene::kNone;
    const auto node = scene_.add_node(parent == scene::kNone ? root_ : parent, transform);
    if (!node) {
        status_ = node.error();
        return scene::kNone;
    }
    for (const scene::MeshId mesh : parts)
        if (auto added = scene_.add_instance(*node, mesh); !added) status_ = added.error();
    return *node;
}

scene::NodeId Builder::place(scene::MeshId mesh, double x, double z, double turn, double scale) {
    return place(Parts{mesh}, turned(x, kKerb, z, turn, scale));
}

void Builder::place_tree(double x, double z, double least, double most) {
    const double scale = library_.random.uniform(least, most), turn = library_.random.uniform(0.0, 6.28);
    place(any(trees_), x, z, turn, scale);
}

void Builder::add_row(double length, const Transform& frame) {
    double x = 0.0;
    while (length - x >= kLeastWidth) {
        const int left = static_cast<int>(std::lround(length - x));
        int width = std::min(left, kLeastWidth + library_.pick(kMostWidth - kLeastWidth + 1));
        // The rest must hold a house, or be empty.
        while (left - width != 0 && left - width < kLeastWidth && width > kLeastWidth) --width;
        if (left <= kMostWidth) width = left;
        const auto& types = houses_[width];
        place(types[static_cast<std::size_t>(library_.pick(kHousesPerWidth))],
              frame * Transform{glm::dmat3(1.0), {x, 0.0, 0.0}});
        x += width;
    }
}

void Builder::add_terraces(const Block& b) {
    const Ground& g = ground(b, true);
    place(Parts{g.paving, g.lawn, g.gravel, g.kerb}, turned(b.center().x, kKerb, b.center().z, 0.0));
    const double quarter = 0.5 * std::numbers::pi;
    auto& random = library_.random;
    add_row(b.width(), turned(b.x0, kKerb, b.z1, 0.0));
    add_row(b.width(), turned(b.x1, kKerb, b.z0, 2.0 * quarter));
    const double inner = b.depth() - 2.0 * kHouseDepth;
    add_row(inner, turned(b.x0, kKerb, b.z0 + kHouseDepth, -quarter));
    add_row(inner, turned(b.x1, kKerb, b.z1 - kHouseDepth, quarter));
    // Gardens behind the long rows, divided by fences; a court in the middle.
    const double back0 = b.z0 + kHouseDepth + 0.4, back1 = b.z1 - kHouseDepth - 0.4;
    for (double x = b.x0 + 15.0; x < b.x1 - 14.0; x += 6.5) {
        place(any(library_.chance(0.6) ? fences_ : hedges_), x, back0 + 6.0, quarter);
        place(any(library_.chance(0.6) ? fences_ : hedges_), x + 2.0, back1, quarter);
        for (const double shed : {back0 + 3.0, back1 - 3.0})
            if (library_.chance(0.35)) {
                const double turn = library_.pick(4) * quarter;
                place(any(sheds_), x + (shed < b.center().z ? 2.5 : 4.5), shed, turn);
            }
        for (const bool front : {true, false})
            if (library_.chance(0.7)) {
                const double scale = random.uniform(0.7, 1.0), turn = random.uniform(0.0, 6.28),
                             in = random.uniform(4.0, 6.5);
                place(any(trees_), front ? x + 3.5 : x - 1.0, front ? back0 + in : back1 - in, turn, scale);
            }
    }
    place(ladder_, b.x0 + 12.0 + random.uniform(0.0, 20.0), back0 + 1.7, 0.0);
    const double poles = b.x1 - 14.0 - random.uniform(0.0, 18.0);
    place(any(poles_), poles, back1, std::numbers::pi);
    place(bench_, b.center().x, b.center().z, library_.random.uniform(0.0, 6.28));
    if (library_.chance(0.4)) {
        const glm::dvec3 at(b.x0 + 14.0 + library_.random.uniform(0.0, b.width() - 28.0), 0.0, b.z1 + 0.3);
        place(scaffold_, at.x, at.z, 0.0);
    }
}

void Builder::add_park(const Block& b) {
    const Ground& g = ground(b, false);
    place(Parts{g.paving, g.lawn, g.gravel, g.kerb}, turned(b.center().x, kKerb, b.center().z, 0.0));
    auto& random = library_.random;
    for (int k = 0; k < 46; ++k) {
        const double x = random.uniform(b.x0 + 3.0, b.x1 - 3.0), z = random.uniform(b.z0 + 3.0, b.z1 - 3.0);
        if (std::hypot(x - b.center().x, z - b.center().z) < 11.0) continue;
        const double scale = random.uniform(0.85, 1.35), turn = random.uniform(0.0, 6.28);
        place(any(library_.chance(0.25) ? conifers_ : trees_), x, z, turn, scale);
    }
    for (int k = 0; k < 8; ++k) {
        const double angle = (k + 0.5) * std::numbers::pi / 4.0;
        const glm::dvec3 c = b.center();
        place(k % 2 == 0 ? bench_ : lamp_, c.x + 9.4 * std::sin(angle), c.z + 9.4 * std::cos(angle),
              angle + std::numbers::pi);
    }
    place(fountain_, b.center().x, b.center().z, 0.0);
    for (double x = b.x0 + 1.0; x + 6.0 < b.x1; x += 6.0) {
        if (std::abs(x + 3.0 - b.center().x) < 5.0) continue;
        place(any(hedges_), x, b.z0 + 0.8, 0.0);
        place(any(hedges_), x, b.z1 - 0.8, 0.0);
    }
}

void Builder::add_market(const Block& b) {
    const Ground& g = ground(b, false);
    place(Parts{g.paving, g.setts, g.gravel, g.kerb}, turned(b.center().x, kKerb, b.center().z, 0.0));
    place(church_, turned(b.x0 + 11.0, kKerb, b.center().z + 1.0, 0.0));
    place(fountain_, b.center().x + 4.0, b.center().z, 0.0);
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            const double x = b.center().x + 11.0 + 4.4 * i, z = b.z0 + 7.0 + 8.0 * j;
            if (x < b.x1 - 3.0 && z < b.z1 - 3.0) place(any(stalls_), x, z, j % 2 == 0 ? 0.0 : std::numbers::pi);
        }
    for (double x = b.x0 + 4.0; x < b.x1 - 2.0; x += 7.0) {
        place_tree(x, b.z0 + 2.0, 0.8, 1.0);
        place_tree(x, b.z1 - 2.0, 0.8, 1.0);
    }
    for (const double dz : {-8.0, 8.0})
        place(bench_, b.center().x + 4.0, b.center().z + dz, dz > 0.0 ? std::numbers::pi : 0.0);
}

void Builder::add_building_site(const Block& b) {
    const Ground& g = ground(b, false);
    place(Parts{g.paving, g.setts, g.gravel, g.kerb}, turned(b.center().x, kKerb, b.center().z, 0.0));
    // A concrete frame under construction, with scaffolds on its long sides.
    MeshBuilder frame;
    const glm::vec3 concrete = srgb(176, 174, 168);
    for (int floor = 0; floor < 4; ++floor) {
        const double y = 3.2 * floor;
        frame.box({-14.0, y, -7.0}, {14.0 - (floor == 3 ? 10.0 : 0.0), y + 0.25, 7.0}, concrete);
        for (int i = 0; i < 5 && floor < 3; ++i)
            for (int j = 0; j < 3; ++j)
                frame.bar({-13.0 + 6.5 * i, y, -6.0 + 6.0 * j}, {-13.0 + 6.5 * i, y + 3.2, -6.0 + 6.0 * j}, 0.4,
                          scaled(concrete, 0.9));
    }
    for (int i = 0; i < 14; ++i)  // starter bars stick out of the top
        frame.tube({-13.0 + 0.7 * i, 9.8, -6.0}, {-13.0 + 0.7 * i + 0.1, 11.4, -6.1}, 0.02, 0.02, 4, srgb(130, 80, 56),
                   true);
    const glm::dvec3 c = b.center();
    place(library_.add(frame, "concrete frame"), c.x, c.z, 0.0);
    for (const double x : {-13.0, -1.0}) {
        place(scaffold_, c.x + x, c.z + 7.2, 0.0);
        place(scaffold_, c.x + x + 12.0, c.z - 7.2, std::numbers::pi);
    }
    const auto tower = place(tower_, c.x + 17.5, c.z - 10.0, 0.0);
    if (tower != scene::kNone)
        jibs_.push_back(place(Parts{jib_}, turned(0.0, kCraneHeight, 0.0, library_.random.uniform(0.0, 6.28)), tower));
    for (int k = 0; k < 5; ++k) place(any(sheds_), b.x0 + 4.0 + 3.0 * k, b.z0 + 3.0, 0.0);
    for (int k = 0; k < 4; ++k)
        place(any(poles_), b.x0 + 8.0 + 9.0 * k, b.z1 - 5.0, library_.random.uniform(0.0, 6.28));
    for (int k = 0; k < 4; ++k) place(ladder_, c.x - 10.0 + 6.0 * k, c.z + 9.9, 0.0);
    for (double x = b.x0; x + 6.0 <= b.x1; x += 6.0) {
        place(any(fences_), x, b.z0, 0.0);
        place(any(fences_), x, b.z1, 0.0);
    }
    for (double z = b.z0 + 6.0; z <= b.z1; z += 6.0) {
        place(any(fences_), b.x0, z, 0.5 * std::numbers::pi);
        if (std::abs(z - c.z) > 4.0) place(any(fences_), b.x1, z, 0.5 * std::numbers::pi);
    }
}

void Builder::add_street_furniture(const Block& b) {
    auto& random = library_.random;
    const double edge = kSidewalk - 0.45;
    int k = 0;
    for (double x = b.x0 + 3.0; x < b.x1 - 2.0; x += 8.0, ++k) {
        if (k % 2 == 0) {
            place(lamp_, x, b.z1 + edge, 0.0);
            place(lamp_, x + 4.0, b.z0 - edge, std::numbers::pi);
        } else if (library_.chance(0.6)) {
            place_tree(x, b.z1 + edge, 0.6, 0.8);
            place_tree(x + 4.0, b.z0 - edge, 0.6, 0.8);
        }
    }
    for (double z = b.z0 + 5.0; z < b.z1 - 3.0; z += 15.0) {
        place(lamp_, b.x1 + edge, z, 0.5 * std::numbers::pi);
        place(lamp_, b.x0 - edge, z + 6.0, -0.5 * std::numbers::pi);
    }
    for (const double x : {b.x0 - 1.2, b.x1 + 1.2})
        for (const double z : {b.z0 - 1.6, b.z1 + 1.6}) {
            const double turn = random.uniform(-0.6, 0.6);
            place(any(signs_), x, z, turn);
        }
    for (int p = 0; p < 14; ++p) {  // strollers on the pavement
        const double along = random.uniform(-0.5, 0.5), off = random.uniform(0.7, 1.2),
                     s = library_.chance(0.5) ? 1.0 : -1.0;
        const bool on_x = library_.chance(0.6);
        const glm::dvec3 c = b.center();
        const bool looks_back = library_.chance(0.5);
        place(any(people_), on_x ? c.x + along * b.width() : c.x + s * (0.5 * b.width() + off),
              on_x ? c.z + s * (0.5 * b.depth() + off) : c.z + along * b.depth(),
              (on_x ? 1.57 : 0.0) + (looks_back ? 3.14 : 0.0));
    }
    // Cables across the street toward +z, slanted in plan and in height.
    const double across = kStreet, along = std::sqrt(kCableLength * kCableLength - across * across - 1.0);
    for (double x = b.x0 + 6.0; x + along < b.x1; x += 17.0) {
        const double s = library_.chance(0.5) ? 1.0 : -1.0, rise = random.uniform(-1.0, 1.0);
        const glm::dvec3 to = glm::normalize(glm::dvec3(s * along, rise, across));
        const glm::dvec3 side = glm::normalize(glm::cross(to, glm::dvec3(0, 1, 0)));
        place(Parts{cable_}, {glm::dmat3(to, glm::cross(side, to), side), {x + (s > 0.0 ? 0.0 : along), 6.2, b.z1}});
    }
}

}  // namespace crofton::assets::town
