// SPDX-License-Identifier: MIT
// Boxes behind walls, against exact rays.
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/occlude/occluder.hpp>
#include <glm/vector_relational.hpp>

#include "view/occlude/found_bodies.hpp"

using namespace crofton;
using namespace crofton::occlude;
using namespace crofton::testing;

namespace {

void add_quad(TriangleMesh& mesh, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {a, b, c, d});
    for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) mesh.indices.push_back(first + i);
}

// The four sides of a hollow house [0, 6] × [0, 4] × [0, 5], without floor or roof. In its front, z = 5, is a window
// [2, 4] × [1, 3], set back by 0.5: pane and reveals, the pane in two parts so that a reveal ends at a T-junction. A
// sill lies on the wall and ends at the window's edge.
TriangleMesh hollow_house(bool with_pane, bool with_reveals) {
    TriangleMesh m;
    add_quad(m, {6, 0, 0}, {0, 0, 0}, {0, 4, 0}, {6, 4, 0});
    add_quad(m, {0, 0, 0}, {0, 0, 5}, {0, 4, 5}, {0, 4, 0});
    add_quad(m, {6, 0, 5}, {6, 0, 0}, {6, 4, 0}, {6, 4, 5});
    add_quad(m, {0, 0, 5}, {6, 0, 5}, {4, 1, 5}, {2, 1, 5});
    add_quad(m, {6, 0, 5}, {6, 4, 5}, {4, 3, 5}, {4, 1, 5});
    add_quad(m, {6, 4, 5}, {0, 4, 5}, {2, 3, 5}, {4, 3, 5});
    add_quad(m, {0, 4, 5}, {0, 0, 5}, {2, 1, 5}, {2, 3, 5});
    if (with_reveals) {
        add_quad(m, {2, 1, 5}, {2, 1, 4.5}, {2, 3, 4.5}, {2, 3, 5});
        add_quad(m, {4, 1, 4.5}, {4, 1, 5}, {4, 3, 5}, {4, 3, 4.5});
        add_quad(m, {2, 1, 5}, {4, 1, 5}, {4, 1, 4.5}, {2, 1, 4.5});
        add_quad(m, {2, 3, 4.5}, {4, 3, 4.5}, {4, 3, 5}, {2, 3, 5});
    }
    if (with_pane) {
        add_quad(m, {2, 1, 4.5}, {4, 1, 4.5}, {4, 2, 4.5}, {2, 2, 4.5});
        add_quad(m, {2, 2, 4.5}, {4, 2, 4.5}, {4, 3, 4.5}, {2, 3, 4.5});
    }
    append(m, box_mesh({1.5, 0.75, 5}, {4.5, 1, 5.25}));
    return m;
}

// Whether the open segment pq meets a triangle that it comes upon from the front; touching counts. Exactly.
bool meets_a_front(const TriangleMesh& mesh, const glm::dvec3& p, const glm::dvec3& q) {
    const oracle::Vec3q from = oracle::rational(p), way = oracle::minus(oracle::rational(q), from);
    for (std::size_t i = 0; i < mesh.triangle_count(); ++i) {
        const oracle::TriangleQ t = oracle::rational_triangle(mesh, i);
        const oracle::Vec3q n = oracle::cross(oracle::minus(t[1], t[0]), oracle::minus(t[2], t[0]));
        const oracle::Rational along = oracle::dot(n, way), ahead = oracle::dot(n, oracle::minus(t[0], from));
        if (along >= 0 || ahead > 0 || ahead < along) continue;
        const oracle::Rational s = ahead / along;
        const oracle::Vec3q at{from[0] + s * way[0], from[1] + s * way[1], from[2] + s * way[2]};
        bool inside = true;
        for (std::size_t k = 0; k < 3; ++k)
            inside = inside &&
                     oracle::dot(n, oracle::cross(oracle::minus(t[(k + 1) % 3], t[k]), oracle::minus(at, t[k]))) >= 0;
        if (inside) return true;
    }
    return false;
}

// From eyes that it is meant for, all that is beyond the box is hidden: random segments that end in it, many from near
// the walls or along them.
void check_walled_box(const TriangleMesh& mesh, const FoundOccluder& found, std::mt19937_64& random, int rays) {
    std::uniform_real_distribution<double> unit;
    const glm::dvec3 low = found.piece_bounds.min, high = found.piece_bounds.max, size = high - low;
    for (int i = 0; i < rays;) {
        const double around = std::pow(10.0, 2.0 * unit(random) - 2.0);
        glm::dvec3 eye =
            low - around * size + glm::dvec3(unit(random), unit(random), unit(random)) * (1.0 + 2.0 * around) * size;
        eye = glm::clamp(eye, found.eyes_within.min, found.eyes_within.max);
        if (glm::clamp(eye, low, high) == eye) continue;
        glm::dvec3 target = found.box.center;
        for (int k = 0; k < 3; ++k)
            target[k] += double(found.box.half_extents[k]) * (i % 2 == 0           ? 2.0 * unit(random) - 1.0
                                                              : unit(random) < 0.5 ? 0.999999
                                                                                   : -0.999999);
        CHECK(meets_a_front(mesh, eye, target));
        ++i;
    }
}

}  // namespace

TEST_SUITE("occlude/walled_boxes") {
    TEST_CASE("behind the walls of a house, windows set back and all, a box hides from eyes between floor and eaves") {
        std::mt19937_64 random(14);
        const TriangleMesh house = hollow_house(true, true);
        const FoundOccluders found = found_in(house);
        REQUIRE(count_of(found, OccluderKind::walled) == 1);
        const FoundOccluder& o = found.occluders[0];
        CHECK(o.kind == OccluderKind::walled);
        CHECK(o.eyes_within.min.y == 0.0);
        CHECK(o.eyes_within.max.y == 4.0);
        CHECK(std::isinf(o.eyes_within.min.x));
        CHECK(o.piece_bounds.max == glm::dvec3(6, 4, 5));
        CHECK(o.box.center == glm::dvec3(3, 2, 2.25));
        CHECK(glm::all(glm::lessThanEqual(glm::abs(o.box.half_extents - glm::vec3(3, 2, 2.25)), glm::vec3(1e-6f))));
        check_walled_box(house, o, random, 3000);
    }

    TEST_CASE("no box lies behind walls with a hole, a gap at the reveal, or walls that face inward") {
        CHECK(count_of(found_in(hollow_house(false, false)), OccluderKind::walled) == 0);
        CHECK(count_of(found_in(hollow_house(false, true)), OccluderKind::walled) == 0);
        CHECK(count_of(found_in(hollow_house(true, false)), OccluderKind::walled) == 0);
        CHECK(count_of(found_in(turned_inside_out(hollow_house(true, true))), OccluderKind::walled) == 0);
        for (std::size_t t = 0; t < hollow_house(true, true).triangle_count(); ++t) {
            TriangleMesh house = hollow_house(true, true);
            if (house.positions[house.indices[3 * t]].z > 5.0f || house.positions[house.indices[3 * t + 2]].z > 5.0f ||
                house.positions[house.indices[3 * t + 1]].z > 5.0f)
                continue;  // the sill
            bool sill = true;
            for (std::size_t k = 0; k < 3; ++k) {
                const glm::vec3 p = house.positions[house.indices[3 * t + k]];
                sill = sill && p.z == 5.0f && (p.x == 1.5f || p.x == 4.5f);
            }
            if (sill) continue;
            house.indices.erase(house.indices.begin() + std::ptrdiff_t(3 * t),
                                house.indices.begin() + std::ptrdiff_t(3 * t + 3));
            const FoundOccluders found = found_in(house);
            // Without one of the four walls' triangles three walls are left, and no box.
            CHECK(count_of(found, OccluderKind::walled) == 0);
        }
    }

    TEST_CASE("random clutter on the walls and in the house changes nothing that is promised") {
        std::mt19937_64 random(15);
        std::uniform_real_distribution<float> unit;
        int walled = 0;
        for (int trial = 0; trial < 40; ++trial) {
            TriangleMesh house = hollow_house(true, true);
            for (int i = 0; i < 10; ++i) {
                // Corners on multiples of a half: many touch walls, reveals and each other.
                const glm::vec3 low =
                    glm::round(2.0f * glm::vec3(6 * unit(random), 4 * unit(random), 5 * unit(random))) / 2.0f;
                const glm::vec3 high = low + glm::vec3(0.5f * float(1 + random() % 3), 0.5f, 0.5f);
                TriangleMesh box = box_mesh(low, high);
                if (trial % 2 == 1)
                    for (int cut = 0; cut < 3; ++cut) box.indices.resize(box.indices.size() - 3);
                if (trial % 4 == 2) box = turned_inside_out(box);
                append(house, box);
            }
            const FoundOccluders found = found_in(house, {.max_occluders = 64, .least_gain = 0.0});
            for (const FoundOccluder& o : found.occluders)
                if (o.kind == OccluderKind::walled) {
                    ++walled;
                    check_walled_box(house, o, random, 100);
                }
        }
        CHECK(walled > 10);
    }
}
