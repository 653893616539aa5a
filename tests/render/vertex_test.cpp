// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <box_mesh.hpp>

#include <cmath>
#include <crofton/render/vertex.hpp>
#include <glm/geometric.hpp>

using namespace crofton;
using namespace crofton::render;

TEST_SUITE("render/vertex") {
    TEST_CASE("an empty mesh appends nothing, and triangles without area get a finite normal") {
        Vector<Vertex> vertices;
        Vector<std::uint32_t> indices;
        const IndexRange nothing = append_mesh({}, {1, 1, 1}, vertices, indices);
        CHECK(nothing.index_count == 0);
        CHECK(vertices.empty());
        TriangleMesh point;
        point.positions = {{1, 2, 3}, {1, 2, 3}, {1, 2, 3}};
        point.indices = {0, 1, 2};
        append_mesh(point, {1, 1, 1}, vertices, indices);
        REQUIRE(vertices.size() == 3);
        for (const Vertex& vertex : vertices) CHECK(glm::length(vertex.normal) == doctest::Approx(1.0));
    }
    TEST_CASE("a cube keeps its edges: three normals a corner, each along an axis and outward") {
        Vector<Vertex> vertices;
        Vector<std::uint32_t> indices;
        const IndexRange range = append_mesh(testing::cube_mesh(), {0.5f, 0.5f, 0.5f}, vertices, indices);
        CHECK(range.index_count == 36);
        CHECK(vertices.size() == 24);
        for (const Vertex& vertex : vertices) {
            CHECK(glm::dot(vertex.normal, vertex.position) == doctest::Approx(1.0));
            CHECK(glm::length(vertex.normal) == doctest::Approx(1.0));
        }
    }
    TEST_CASE("with a wide crease angle corners are shared and point along the diagonal") {
        Vector<Vertex> vertices;
        Vector<std::uint32_t> indices;
        append_mesh(testing::cube_mesh(), {1, 1, 1}, vertices, indices, 3.0f);
        CHECK(vertices.size() <= 16);  // the diagonals of the faces weight some corners unevenly
        for (const Vertex& vertex : vertices) CHECK(glm::dot(vertex.normal, glm::normalize(vertex.position)) > 0.9f);
    }
    TEST_CASE("appending keeps the triangles' order and their exact positions, and the colours of the mesh") {
        TriangleMesh mesh = testing::cube_mesh();
        for (const glm::vec3& p : mesh.positions) mesh.colors.push_back(0.5f * p + 0.5f);
        Vector<Vertex> vertices;
        Vector<std::uint32_t> indices;
        append_mesh(testing::cube_mesh(), {1, 1, 1}, vertices, indices);
        const IndexRange range = append_mesh(mesh, {1, 1, 1}, vertices, indices);
        CHECK(range.first_index == 36);
        for (std::uint32_t i = 0; i < 36; ++i) {
            const Vertex& vertex = vertices[indices[range.first_index + i]];
            CHECK(vertex.position == mesh.positions[mesh.indices[i]]);
            CHECK(vertex.color == mesh.colors[mesh.indices[i]]);
        }
    }
}
