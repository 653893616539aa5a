// SPDX-License-Identifier: MIT
// Levels: surfaces of walls that meet, whose sides are cut to each other.
#include <doctest/doctest.h>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <crofton/occlude/occluder.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <crofton/sampling/sampling.hpp>
#include <error_of.hpp>
#include <limits>

using namespace crofton;
using namespace crofton::occlude;

namespace {

// Two triangles with four corners of their own.
void add_wall(TriangleMesh& mesh, const glm::vec3& from, const glm::vec3& to, float height) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const glm::vec3 up(0.0f, height, 0.0f);
    for (const glm::vec3& p : {from, to, to + up, from + up}) mesh.positions.push_back(p);
    for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) mesh.indices.push_back(first + i);
}

// A closed path of walls over a lattice, each in one to three storeys of random heights.
TriangleMesh random_level(sampling::Random& random) {
    TriangleMesh mesh;
    const auto lattice = [&] { return static_cast<float>(random.bits() % 17) - 8.0f; };
    glm::vec3 at(lattice(), 0.0f, lattice());
    for (int wall = 0; wall < 24; ++wall) {
        const glm::vec3 next(lattice(), 0.0f, lattice());
        if (next == at) continue;
        float y = 0.0f;
        for (std::uint64_t storey = 0, count = 1 + random.bits() % 3; storey < count; ++storey) {
            const auto height = static_cast<float>(1 + random.bits() % 4);
            const glm::vec3 base(0.0f, y, 0.0f);
            add_wall(mesh, at + base, next + base, height);
            y += height;
        }
        at = next;
    }
    return mesh;
}

TriangleMesh all_of(const FoundOccluders& found) {
    TriangleMesh all;
    for (const FoundOccluder& occluder : found.occluders) {
        const auto first = static_cast<std::uint32_t>(all.positions.size());
        for (const glm::vec3& p : occluder.surface.positions) all.positions.push_back(p);
        for (const std::uint32_t i : occluder.surface.indices) all.indices.push_back(first + i);
    }
    return all;
}

// Surfaces alone, without bodies.
Result<FoundOccluders> surfaces_of(const TriangleMesh& level, Sides sides = Sides::front, std::uint32_t most = 48) {
    return find_occluders(level, {.sides = sides, .max_occluders = 0, .level_triangles = most});
}

bool hides(const std::vector<FoundOccluder>& occluders, const Obb& box) {
    OccluderSet set;
    for (const FoundOccluder& occluder : occluders) {
        const auto shape = set.add_surface(occluder.surface, occluder.sides);
        REQUIRE(shape.has_value());
        REQUIRE(set.place(*shape, {}).has_value());
    }
    auto buffer = *OcclusionBuffer::create({320, 180});
    buffer.draw(set, *occlusion_view_of(Camera{}));
    return buffer.hides(box);
}

}  // namespace

TEST_SUITE("occlude/level") {
    TEST_CASE("levels without triangles and bad triangles are named") {
        TriangleMesh mesh;
        CHECK(error_of(surfaces_of(mesh)).code == ErrorCode::empty);
        add_wall(mesh, {-1, 0, 0}, {1, 0, 0}, 1.0f);
        mesh.indices.push_back(0);
        CHECK(error_of(surfaces_of(mesh)).code == ErrorCode::invalid_argument);
        mesh.indices.pop_back();
        mesh.positions[3].x = std::numeric_limits<float>::quiet_NaN();
        const auto found = surfaces_of(mesh);
        REQUIRE(found.has_value());
        CHECK(found->rejected.size() == 1);
    }

    TEST_CASE("walls of other heights that meet leave no seam") {
        TriangleMesh mesh;
        add_wall(mesh, {-4, -3, -10}, {0, -3, -10}, 6.0f);
        add_wall(mesh, {0, -3, -10}, {4, -3, -10}, 2.0f);
        add_wall(mesh, {0, -1, -10}, {4, -1, -10}, 4.0f);
        Obb behind;
        behind.center = {0.0, 0.0, -20.0};
        behind.half_extents = {0.5f, 0.5f, 0.5f};
        const auto found = surfaces_of(mesh);
        REQUIRE(found.has_value());
        REQUIRE(found->occluders.size() == 1);
        CHECK(hides({found->occluders.begin(), found->occluders.end()}, behind));
        // As they are given, one side of the left wall is two of the right.
        FoundOccluder uncut = found->occluders[0];
        uncut.surface = mesh;
        CHECK_FALSE(hides({uncut}, behind));
        // From behind, where back faces are not drawn, it hides nothing.
        for (std::size_t t = 0; t < mesh.indices.size(); t += 3) std::swap(mesh.indices[t], mesh.indices[t + 1]);
        const auto turned = surfaces_of(mesh);
        CHECK_FALSE(hides({turned->occluders.begin(), turned->occluders.end()}, behind));
        const auto both = surfaces_of(mesh, Sides::both);
        CHECK(hides({both->occluders.begin(), both->occluders.end()}, behind));
    }

    TEST_CASE("the edges of a wall and of walls that meet are counted, and a doubled wall is one level") {
        TriangleMesh wall;
        add_wall(wall, {-4, -3, -10}, {0, -3, -10}, 6.0f);
        CHECK(surfaces_of(wall)->occluders[0].edges == 4);
        TriangleMesh two = wall;
        add_wall(two, {0, -3, -10}, {4, -3, -10}, 6.0f);
        CHECK(surfaces_of(two)->occluders[0].edges == 6);
        TriangleMesh doubled = wall;  // from behind as well: five sides of two triangles each side
        for (const std::uint32_t i : {0u, 2u, 1u, 0u, 3u, 2u}) doubled.indices.push_back(i);
        CHECK(surfaces_of(doubled)->occluders[0].edges == 4);
    }

    TEST_CASE("a triangle without area along many vertices adds nothing, and takes no longer") {
        for (const std::uint32_t columns : {1u, 7u, 5000u}) {
            TriangleMesh strip;
            for (std::uint32_t i = 0; i <= columns; ++i) {
                strip.positions.emplace_back(static_cast<float>(i), 0.0f, -10.0f);
                strip.positions.emplace_back(static_cast<float>(i), 1.0f, -10.0f);
            }
            for (std::uint32_t i = 0; i < columns; ++i)
                for (const std::uint32_t v : {0u, 2u, 3u, 0u, 3u, 1u}) strip.indices.push_back(2 * i + v);
            for (const std::uint32_t v : {0u, 2 * columns, 2 * (columns / 2)}) strip.indices.push_back(v);
            const auto found = surfaces_of(strip);
            REQUIRE(found.has_value());
            CHECK(all_of(*found).triangle_count() == 2 * columns);
        }
    }

    TEST_CASE("objects hidden by the occluders of a level are hidden by the level from every ray of the eye") {
        sampling::Random random(2);
        std::size_t hidden = 0;
        for (int trial = 0; trial < 30; ++trial) {
            const TriangleMesh level = random_level(random);
            const auto found = surfaces_of(level, Sides::both);
            const auto tree = mesh::MeshTree::build(level);
            REQUIRE(found.has_value());
            REQUIRE(tree.has_value());
            for (int n = 0; n < 20; ++n) {
                Obb box;
                box.center = {random.uniform(-8, 8), random.uniform(0, 3), random.uniform(-25, -3)};
                box.half_extents = glm::vec3(static_cast<float>(random.uniform(0.01, 0.4)));
                if (!hides({found->occluders.begin(), found->occluders.end()}, box)) continue;
                ++hidden;
                for (int r = 0; r < 20; ++r) {
                    const glm::dvec3 inside(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
                    const glm::dvec3 point = box.center + inside * glm::dvec3(box.half_extents);
                    CHECK(mesh::raycast({glm::dvec3(0.0), point, 1.0}, *tree).has_value());
                }
            }
        }
        CHECK(hidden > 60);
    }

    TEST_CASE("rays hit the occluders where they hit the level, in parts of the requested size") {
        sampling::Random random(1);
        std::size_t hits = 0, cut = 0;
        for (int trial = 0; trial < 50; ++trial) {
            const TriangleMesh level = random_level(random);
            const auto most = static_cast<std::uint32_t>(1 + random.bits() % 40);
            const auto found = surfaces_of(level, Sides::front, most);
            REQUIRE(found.has_value());
            for (const FoundOccluder& occluder : found->occluders) {
                CHECK(occluder.surface.triangle_count() <= most);
                CHECK(occluder.kind == OccluderKind::patch);
            }
            const TriangleMesh all = all_of(*found);
            cut += all.triangle_count() - level.triangle_count();
            const auto whole = mesh::MeshTree::build(level), parts = mesh::MeshTree::build(all);
            REQUIRE(whole.has_value());
            REQUIRE(parts.has_value());
            for (int n = 0; n < 500; ++n) {
                const glm::dvec3 from(random.uniform(-9, 9), random.uniform(0, 9), random.uniform(-9, 9));
                const Ray ray{from, sampling::direction(random.point<2>()), 100.0};
                const auto a = mesh::raycast(ray, *whole), b = mesh::raycast(ray, *parts);
                REQUIRE(a.has_value() == b.has_value());
                if (!a) continue;
                ++hits;
                CHECK(a->t == doctest::Approx(b->t).epsilon(1e-9));
            }
        }
        CHECK(hits > 5000);
        CHECK(cut > 500);
    }
}
