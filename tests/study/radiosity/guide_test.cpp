// SPDX-License-Identifier: MIT
// The example of docs/radiosity.md, compiled and run.
#include <doctest/doctest.h>

#include <crofton/core/executor.hpp>
#include <crofton/radiosity/solver.hpp>
#include <cstdio>
#include <vector>

#include "shapes.hpp"

namespace {

int report(const crofton::Error& error) {
    std::printf("%s\n", error.message.c_str());
    return static_cast<int>(error.item) + 1;
}

int light_room(const crofton::TriangleMesh& room, const std::vector<crofton::radiosity::Material>& materials,
               std::vector<glm::vec3>& result) {
    crofton::Executor& jobs = crofton::serial_executor();
    // clang-format off
    using namespace crofton;

    // Triangles with their emission and reflectance.
    const Result<radiosity::Patches> patches = radiosity::make_patches(room, materials);
    if (!patches) return report(patches.error());  // which triangle, and why
    Result<radiosity::Solver> solver = radiosity::Solver::create(*patches, {.lines = 1 << 14});
    if (!solver) return report(solver.error());

    // Usable after the first run, better with each.
    do solver->run(jobs);
    while (solver->runs() < 2 || (solver->relative_error() > 0.01 && solver->runs() < 32));
    const Vector<glm::vec3> colors = radiosity::corner_values(*patches, solver->radiosity());
    // clang-format on
    result.assign(colors.begin(), colors.end());
    return 0;
}

// The inside of a cube of edge 1.
crofton::TriangleMesh inside_of_cube() {
    shapes::Shape cube;
    const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1), o(0, 0, 0);
    cube.parallelogram(o, y, z, 0);
    cube.parallelogram(x, z, y, 0);
    cube.parallelogram(o, z, x, 0);
    cube.parallelogram(y, x, z, 0);
    cube.parallelogram(o, x, y, 0);
    cube.parallelogram(z, y, x, 0);
    return cube.mesh;
}

}  // namespace

TEST_SUITE("radiosity/guide") {
    TEST_CASE("the example of the guide finds the light of a furnace: emission / (1 − reflectance) everywhere") {
        const std::vector<crofton::radiosity::Material> materials(12, {glm::vec3(1.0f), glm::vec3(0.5f)});
        std::vector<glm::vec3> colors;
        REQUIRE(light_room(inside_of_cube(), materials, colors) == 0);
        REQUIRE(colors.size() == 36);
        for (const glm::vec3& color : colors)
            for (int k = 0; k < 3; ++k) CHECK(color[k] == doctest::Approx(2.0).epsilon(0.03));
    }

    TEST_CASE("the example of the guide names the triangle whose light would never end") {
        std::vector<crofton::radiosity::Material> materials(12, {glm::vec3(1.0f), glm::vec3(0.5f)});
        materials[5].reflectance = glm::vec3(1.0f);
        std::vector<glm::vec3> colors;
        CHECK(light_room(inside_of_cube(), materials, colors) == 6);
    }
}
