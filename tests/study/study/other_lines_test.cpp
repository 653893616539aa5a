// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/radiosity/patches.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/mutual_information.hpp>
#include <crofton/study/other_lines.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

using namespace crofton;
using std::numbers::pi;

namespace {

// The inside of the unit cube: six patches, counter-clockwise seen from within.
TriangleMesh inside_of_cube() {
    TriangleMesh mesh;
    for (int c = 0; c < 8; ++c)
        mesh.positions.emplace_back(static_cast<float>(c & 1), static_cast<float>(c >> 1 & 1),
                                    static_cast<float>(c >> 2 & 1));
    const std::uint32_t quads[6][4] = {{0, 2, 6, 4}, {1, 5, 7, 3}, {0, 4, 5, 1},
                                       {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 6, 7, 5}};
    for (const auto& q : quads) mesh.indices.insert(mesh.indices.end(), {q[0], q[1], q[2], q[0], q[2], q[3]});
    // The normals above point outward or inward alike; turn those that point out.
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
        const glm::vec3 a = mesh.positions[mesh.indices[t]], b = mesh.positions[mesh.indices[t + 1]],
                        c = mesh.positions[mesh.indices[t + 2]];
        if (glm::dot(glm::cross(b - a, c - a), glm::vec3(0.5f) - a) < 0.0f)
            std::swap(mesh.indices[t + 1], mesh.indices[t + 2]);
    }
    return mesh;
}

}  // namespace

TEST_SUITE("study/other_lines") {
    TEST_CASE("lines through opposite faces: the mean weight is pi times the cube's form factor, 0.199825") {
        const Aabb cube{glm::dvec3(2.0), glm::dvec3(3.0)};
        for (int axis = 0; axis < 3; ++axis) {
            sampling::Random random(5, static_cast<std::uint64_t>(axis));
            double sum = 0.0;
            constexpr int kLines = 200'000;
            for (int i = 0; i < kLines; ++i) {
                const auto line = study::line_through_opposite_faces(cube, axis, random.point<4>());
                sum += line.weight;
                if (i >= 100) continue;
                CHECK(line.line.point[axis] == 2.0);
                CHECK(glm::length(line.line.direction) == doctest::Approx(1.0));
                const glm::dvec3 end = line.line.point + line.line.direction / line.line.direction[axis];
                for (int k = 0; k < 3; ++k) CHECK(std::abs(end[k] - 2.5) <= 0.5 + 1e-12);
            }
            CHECK(sum / kLines == doctest::Approx(pi * 0.199825).epsilon(5e-3));
        }
    }

    TEST_CASE(
        "bundles of parallelograms: one line in each cell, all in the sphere, pi R squared over the cell's area of "
        "them") {
        sampling::Random random(6);
        Vector<Line> lines;
        double count = 0.0;
        for (int i = 0; i < 400; ++i) {
            lines.clear();
            study::append_parallelogram_bundle({glm::dvec3(5.0), 2.0}, {0.3, 0.0}, {-0.5, 0.2}, random, lines);
            count += static_cast<double>(lines.size());
            for (const Line& line : lines) {
                CHECK(line.direction == lines[0].direction);
                CHECK(std::abs(glm::dot(line.point - glm::dvec3(5.0), line.direction)) < 1e-12);
                CHECK(glm::length(line.point - glm::dvec3(5.0)) <= 2.0 + 1e-12);
            }
        }
        CHECK(count / 400.0 == doctest::Approx(pi * 4.0 / 0.06).epsilon(1e-2));
    }
}

TEST_SUITE("study/mutual_information") {
    TEST_CASE("no rays are an error") {
        radiosity::FactorMatrix none;
        none.size = 2;
        none.transfers.assign(4, 0);
        none.rays.assign(2, 0);
        none.escaped.assign(2, 0);
        CHECK(error_of(study::mutual_information(none)).code == ErrorCode::empty);
    }

    TEST_CASE("two patches that see only each other have one bit, three that see all alike have none") {
        radiosity::FactorMatrix pair;
        pair.size = 2;
        pair.transfers = {0, 1000, 1000, 0};
        pair.rays = {1000, 1000};
        pair.escaped = {0, 0};
        const auto bit = study::mutual_information(pair).value();
        CHECK(bit.bits + bit.bias == doctest::Approx(1.0));
        CHECK(bit.entropy_bits == doctest::Approx(1.0));
        CHECK(bit.rays == 2000);
        CHECK(bit.pairs == 2);
        radiosity::FactorMatrix alike;
        alike.size = 3;
        alike.transfers.assign(9, 500);
        alike.rays.assign(3, 1500);
        alike.escaped.assign(3, 0);
        const auto nothing = study::mutual_information(alike).value();
        CHECK(nothing.bits + nothing.bias == doctest::Approx(0.0));
        // All escapes: sky and patch tell each other everything.
        radiosity::FactorMatrix open;
        open.size = 1;
        open.transfers = {0};
        open.rays = {1000};
        open.escaped = {1000};
        CHECK(study::mutual_information(open)->entropy_bits == doctest::Approx(1.0));
    }

    TEST_CASE("the inside of a cube has 0.26303 bits, from its form factors 0.199825 and 0.200044") {
        const TriangleMesh mesh = inside_of_cube();
        Vector<std::uint32_t> face;
        for (std::uint32_t t = 0; t < 12; ++t) face.push_back(t / 2);
        const Vector<radiosity::Material> materials(6);
        const auto patches = radiosity::make_patches(mesh, face, materials).value();
        const auto tracer = lines::LineTracer::build(mesh).value();
        const lines::LineSource source(tracer.bounds(), lines::LineMethod::walls, 3);
        const auto matrix = radiosity::factors_by_global_lines(tracer, patches, source, 400).value();
        const double opposite = 0.199825, adjacent = 0.25 * (1.0 - opposite);
        const double exact = opposite * std::log2(6.0 * opposite) + 4.0 * adjacent * std::log2(6.0 * adjacent);
        CHECK(exact == doctest::Approx(0.26303).epsilon(1e-4));
        CHECK(study::mutual_information(matrix)->bits == doctest::Approx(exact).epsilon(2e-3));
    }
}
