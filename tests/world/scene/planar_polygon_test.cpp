// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/scene/scene.hpp>
#include <error_of.hpp>
#include <limits>

using namespace crofton;
using namespace crofton::scene;

namespace {

PlanarPolygon square() {
    PlanarPolygon p;
    p.polygon.points = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    p.polygon.ring_ends = {4};
    return p;
}
constexpr std::array<std::array<std::uint32_t, 3>, 2> kTriangles = {{{0, 1, 2}, {0, 2, 3}}};

}  // namespace

TEST_SUITE("scene/planar_polygon") {
    TEST_CASE("polygons with bad rings, numbers or axes are refused by name") {
        PlanarPolygon p = square();
        CHECK(validate(p).has_value());
        CHECK(error_of(validate(PlanarPolygon{})).code == ErrorCode::empty);
        p.polygon.ring_ends.clear();
        CHECK(error_of(validate(p)).code == ErrorCode::empty);
        p.polygon.ring_ends = {0};
        p.polygon.points.clear();
        CHECK(error_of(validate(p)).code == ErrorCode::empty);
        p = square();
        p.polygon.ring_ends = {3, 9};
        CHECK(error_of(validate(p)).code == ErrorCode::out_of_range);
        CHECK(error_of(validate(p)).item == 1);
        p.polygon.ring_ends = {2, 4};
        CHECK(error_of(validate(p)).code == ErrorCode::degenerate);
        p.polygon.ring_ends = {3};
        REQUIRE(!validate(p).has_value());
        CHECK(error_of(validate(p)).code == ErrorCode::invalid_argument);
        p = square();
        p.polygon.points[2].x = std::numeric_limits<double>::quiet_NaN();
        CHECK(error_of(validate(p)).item == 2);
        p = square();
        p.color.y = std::numeric_limits<float>::quiet_NaN();
        CHECK(error_of(validate(p)).code == ErrorCode::non_finite);
        p = square();
        p.v = 2.0 * p.u;
        CHECK(error_of(validate(p)).code == ErrorCode::degenerate);
        p.v = p.u + 1e-10 * square().v;  // nearly parallel
        CHECK(error_of(validate(p)).code == ErrorCode::degenerate);
        p.v = p.u + 1e-8 * square().v;
        CHECK(validate(p).has_value());
        p.v = p.u + 1e-9 * square().v;  // at the limit, all of whose numbers are exact
        CHECK(error_of(validate(p)).code == ErrorCode::degenerate);
        p.v = glm::dvec3(0.0);
        CHECK(error_of(validate(p)).code == ErrorCode::degenerate);
        constexpr std::array<std::array<std::uint32_t, 3>, 1> beyond = {{{0, 1, 4}}};
        CHECK(error_of(to_mesh(square(), beyond)).code == ErrorCode::out_of_range);
    }

    TEST_CASE("its mesh stands where origin and axes say, vertex by vertex") {
        PlanarPolygon p = square();
        p.origin = {5.0, 1.0, 0.0};
        p.u = {0.0, 0.0, -1.0};
        p.v = {0.0, 2.0, 0.0};
        const TriangleMesh mesh = to_mesh(p, kTriangles).value();
        CHECK(mesh.positions[2] == glm::vec3(5.0f, 3.0f, -1.0f));
        CHECK(mesh.triangle_count() == 2);
        CHECK(mesh.colors.size() == 4);
    }
}
