// SPDX-License-Identifier: MIT
// The example of docs/convex.md, compiled and run.
#include <doctest/doctest.h>

#include <crofton/convex/query.hpp>
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

    // Once: what the bodies are.
    const Result<convex::Hull> rock = convex::Hull::build(points, {.max_vertices = 32});
    if (!rock) return report(rock.error());  // which point is bad, and why
    const convex::Body body = convex::Body::hull(*rock);  // a view: keep `rock`
    const convex::Body floor = convex::Body::box({10.0f, 1.0f, 10.0f}).value();
    const double mass = 2700.0 * rock->mass().volume;

    // Each frame: where they stand, and what the pair remembers.
    RigidTransform place{glm::dmat3(1.0), {0.0, 1.99, 0.0}}, ground;
    convex::PairCache cache;  // one a pair, kept from frame to frame
    const auto contact = convex::contact_manifold({floor, ground}, {body, place}, {.margin = 0.02}, &cache);
    for (int i = 0; i < contact.count; ++i)
        std::printf("%g deep, id %u/%u\n", contact.points[i].depth, contact.points[i].on_a.index, contact.points[i].on_b.index);

    // A fast body: when does it touch?
    const convex::Motion flight{.velocity = {0.0, -200.0, 0.0}, .spin = {0.0, 0.0, 30.0}};
    place.translation.y = 50.0;
    const auto impact = convex::cast({body, place}, flight, {floor, ground}, {});
    if (!impact) return report(impact.error());
    if (impact->result != convex::CastResult::miss) std::printf("hit after %g s\n", impact->time);
    // clang-format on
    return mass > 0.0 && impact->result == convex::CastResult::hit ? contact.count : -1;
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
}
