// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <crofton/geometry/mesh.hpp>
#include <error_of.hpp>

using namespace crofton;

namespace {

TriangleMesh triangle_at(float x) {
    TriangleMesh mesh;
    mesh.positions = {{x, 0.0f, 0.0f}, {x + 1.0f, 0.0f, 0.0f}, {x, 1.0f, 0.0f}};
    mesh.indices = {0, 1, 2};
    return mesh;
}

}  // namespace

TEST_SUITE("geometry/mesh") {
    TEST_CASE("appended parts follow the existing ones, and their indices are shifted") {
        TriangleMesh mesh = triangle_at(0.0f);
        append(mesh, triangle_at(5.0f));
        append(mesh, TriangleMesh{});
        CHECK(validate(mesh).has_value());
        CHECK(mesh.positions.size() == 6);
        CHECK(mesh.positions[3] == glm::vec3(5.0f, 0.0f, 0.0f));
        CHECK(mesh.indices == Vector<std::uint32_t>{0, 1, 2, 3, 4, 5});
    }

    TEST_CASE("colours are one a vertex or none, else they are refused by their number") {
        TriangleMesh mesh = triangle_at(0.0f);
        mesh.colors.resize(2);
        CHECK(error_of(validate(mesh)).code == ErrorCode::invalid_argument);
        CHECK(error_of(validate(mesh)).item == 2);
        mesh.colors.resize(3);
        CHECK(validate(mesh).has_value());
        mesh.colors.resize(4);
        CHECK(error_of(validate(mesh)).item == 4);
    }

    TEST_CASE("memory behind the indices is not read") {
        TriangleMesh mesh = triangle_at(0.0f);
        mesh.indices.push_back(1000);
        CHECK_FALSE(validate(mesh).has_value());
        mesh.indices.pop_back();
        CHECK(validate(mesh).has_value());
    }

    TEST_CASE("colours are appended where both have them, and dropped where one has none") {
        TriangleMesh colored = triangle_at(0.0f), mesh;
        colored.colors = {glm::vec3(1.0f), glm::vec3(0.5f), glm::vec3(0.0f)};
        append(mesh, colored);
        append(mesh, colored);
        REQUIRE(mesh.colors.size() == 6);
        CHECK(mesh.colors[4] == glm::vec3(0.5f));
        append(mesh, triangle_at(0.0f));
        CHECK(mesh.colors.empty());
        CHECK(validate(mesh).has_value());
        append(mesh, colored);
        CHECK(mesh.colors.empty());
        CHECK(validate(mesh).has_value());
    }
}
