// SPDX-License-Identifier: MIT
// The example of docs/convex.md, compiled and run.
#include <doctest/doctest.h>

#include <crofton/convex/query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <cstdio>
#include <vector>

namespace {

int report(const crofton::Error& error) {
    std::printf("%s\n", error.message.c_str());
    return -1;
}

int drop(const std::vector<glm::vec3>& points) {
    // clang-format off
    using namespace crofton;

    // Once: make the shapes.
    const Result<convex::Hull> rock = convex::Hull::build(points, {.max_vertices = 32});
    if (!rock) return report(rock.error());  // which point is bad, and why
    const convex::Shape shape = convex::Shape::hull(*rock);  // a view: keep `rock`
    const convex::Shape floor = convex::Shape::box({10.0f, 1.0f, 10.0f}).value();
    const double mass = 2700.0 * rock->mass().volume;

    // Each frame: their poses, and the cache of the pair.
    RigidTransform place{glm::dmat3(1.0), {0.0, 1.99, 0.0}}, ground;
    convex::PairCache cache;  // one per pair, kept from frame to frame
    const auto contact = convex::contact_manifold({floor, ground}, {shape, place}, {.margin = 0.02}, &cache);
    for (int i = 0; i < contact.count; ++i)
        std::printf("%g deep, id %u/%u\n", contact.points[i].depth, contact.points[i].on_a.index, contact.points[i].on_b.index);

    // When does a fast shape touch?
    const convex::Motion flight{.velocity = {0.0, -200.0, 0.0}, .spin = {0.0, 0.0, 30.0}};
    place.translation.y = 50.0;
    const auto impact = convex::cast({shape, place}, flight, {floor, ground}, {});
    if (!impact) return report(impact.error());
    if (impact->result != convex::CastResult::miss) std::printf("hit after %g s\n", impact->time);
    // clang-format on
    return mass > 0.0 && impact->result == convex::CastResult::hit ? contact.count : -1;
}

int rest(const crofton::TriangleMesh& level, const std::vector<float>& heights,
         const std::vector<std::uint8_t>& materials, const crofton::convex::Shape& crate) {
    using namespace crofton;
    const RigidTransform here, place{glm::dmat3(1.0), {4.0, 0.99, 4.0}};
    // clang-format off
    const Result<mesh::MeshTree> tree = mesh::MeshTree::build(level);
    if (!tree) return report(tree.error());
    const auto walls = convex::Shape::mesh(*tree, convex::Sides::front);  // pushes outward only
    if (!walls) return report(walls.error());

    const Result<convex::HeightField> hills =
        convex::HeightField::build({.columns = 3, .rows = 3, .heights = heights, .spacing = {10.0, 10.0}, .materials = materials});
    if (!hills) return report(hills.error());  // which height is NaN
    const convex::Shape ground = convex::Shape::height_field(*hills);  // a view: keep `hills`

    convex::Manifolds found;  // kept from frame to frame
    convex::contact_manifolds({ground, here}, {crate, place}, {.margin = 0.02}, found);
    for (const convex::Manifold& contact : found.all()) {
        const std::uint32_t cell = contact.points[0].part_a.triangle / 2;
        std::printf("%d points, on material %u\n", contact.count, hills->material(cell));
    }
    // clang-format on
    return convex::intersects({*walls, here}, {crate, place}) ? -2 : static_cast<int>(found.all().size());
}

}  // namespace

TEST_SUITE("convex/guide") {
    TEST_CASE("the example rests on four points, and hits") {
        std::vector<glm::vec3> cube;
        for (int i = 0; i < 8; ++i) cube.emplace_back(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
        CHECK(drop(cube) == 4);
        cube.resize(3);
        CHECK(drop(cube) == -1);
    }

    TEST_CASE("the example of surfaces rests on the ground and meets no wall") {
        crofton::TriangleMesh wall;
        wall.positions = {{9, 0, 0}, {9, 9, 0}, {9, 0, 9}};
        wall.indices = {0, 1, 2};
        const auto crate = crofton::convex::Shape::box({1, 1, 1}).value();
        CHECK(rest(wall, std::vector<float>(9, 0.0f), {1, 2, 3, crofton::convex::kHole}, crate) == 1);
        CHECK(rest(wall, std::vector<float>(8, 0.0f), {}, crate) == -1);
        CHECK(rest({}, std::vector<float>(9, 0.0f), {}, crate) == -1);
    }
}
