#include <doctest/doctest.h>
#include <crofton/radiosity/patches.hpp>
#include <limits>
#include <map>
#include <tuple>

#include "shapes.hpp"

using namespace crofton;
using namespace crofton::radiosity;

namespace {

double area_of(const TriangleMesh& mesh) {
    const std::vector<Material> materials(mesh.triangle_count());
    const auto patches = make_patches(mesh, materials);
    REQUIRE(patches.has_value());
    double sum = 0.0;
    for (const double a : patches->areas) sum += a;
    return sum;
}

// Edges used by one triangle only, as position pairs: a T-junction leaves unmatched ones inside a closed surface.
std::size_t unmatched_edges(const TriangleMesh& mesh) {
    using Point = std::tuple<float, float, float>;
    std::map<std::pair<Point, Point>, int> edges;
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
        for (std::size_t e = 0; e < 3; ++e) {
            const glm::vec3 &a = mesh.positions[mesh.indices[3 * t + e]],
                            &b = mesh.positions[mesh.indices[3 * t + (e + 1) % 3]];
            const Point p(a.x, a.y, a.z), q(b.x, b.y, b.z);
            p < q ? ++edges[{p, q}] : --edges[{q, p}];
        }
    std::size_t count = 0;
    for (const auto& [edge, balance] : edges) count += balance != 0 ? 1u : 0u;
    return count;
}

}  // namespace

TEST_SUITE("radiosity/patches") {
    TEST_CASE("bad materials, patch numbers and triangles are named") {
        shapes::Shape room;
        room.room({0, 0, 0}, {1, 1, 1}, 0);
        std::vector<Material> materials(6);
        CHECK(make_patches(room.mesh, room.patches, materials).has_value());
        materials[3].reflectance.y = 1.0f;
        const auto mirror = make_patches(room.mesh, room.patches, materials);
        REQUIRE_FALSE(mirror.has_value());
        CHECK(mirror.error().item == 3);
        CHECK(mirror.error().message.find("reflectance") != std::string::npos);
        materials[3].reflectance.y = -0.1f;
        CHECK(make_patches(room.mesh, room.patches, materials).error().item == 3);
        materials[3] = {};
        materials[5].emission.x = std::numeric_limits<float>::quiet_NaN();
        CHECK(make_patches(room.mesh, room.patches, materials).error().item == 5);
        materials[5] = {};
        materials.emplace_back();
        CHECK(make_patches(room.mesh, room.patches, materials).error().message.find("patch 6") != std::string::npos);
        materials.resize(5);
        CHECK(make_patches(room.mesh, room.patches, materials).error().code == ErrorCode::out_of_range);
        materials.resize(6);
        shapes::Shape flat = room;
        flat.mesh.positions[flat.mesh.indices[7]] = flat.mesh.positions[flat.mesh.indices[6]];
        const auto degenerate = make_patches(flat.mesh, flat.patches, materials);
        REQUIRE_FALSE(degenerate.has_value());
        CHECK(degenerate.error().code == ErrorCode::degenerate);
        CHECK(degenerate.error().item == 2);
        CHECK(make_patches({}, {}).error().code == ErrorCode::empty);
    }

    TEST_CASE("refining keeps area and closedness, knows its sources, and reaches the target") {
        shapes::Shape shape;
        shape.room({0, 0, 0}, {3, 1, 2}, 0);
        shape.sphere({1, 0.5f, 1}, 0.3f, 6, false, 6);
        REQUIRE(unmatched_edges(shape.mesh) == 0);
        for (const double longest : {5.0, 0.7, 0.11}) {
            const auto refined = refine(shape.mesh, longest);
            REQUIRE(refined.has_value());
            CHECK(unmatched_edges(refined->mesh) == 0);
            CHECK(area_of(refined->mesh) == doctest::Approx(area_of(shape.mesh)).epsilon(1e-6));
            REQUIRE(refined->source.size() == refined->mesh.triangle_count());
            std::vector<double> by_source(shape.mesh.triangle_count(), 0.0);
            const std::vector<Material> materials(refined->source.size());
            const auto patches = make_patches(refined->mesh, materials);
            for (std::size_t t = 0; t < refined->source.size(); ++t) by_source[refined->source[t]] += patches->areas[t];
            const std::vector<Material> coarse_materials(by_source.size());
            const auto coarse = make_patches(shape.mesh, coarse_materials);
            for (std::size_t t = 0; t < by_source.size(); ++t)
                CHECK(by_source[t] == doctest::Approx(coarse->areas[t]).epsilon(1e-5));
        }
        CHECK(refine(shape.mesh, 0.0).error().code == ErrorCode::out_of_range);
        CHECK(refine(shape.mesh, 1e-4, 1000).error().code == ErrorCode::budget_exceeded);
    }

    TEST_CASE("corner values are means over the face, and do not bleed across edges") {
        shapes::Shape room;
        room.room({0, 0, 0}, {1, 1, 1}, 0);
        const std::vector<Material> materials(12);
        const auto patches = make_patches(room.mesh, materials);
        std::vector<glm::vec3> values(12, glm::vec3(0.0f));
        values[0] = glm::vec3(2.0f);  // one half of a wall
        const auto corners = corner_values(*patches, values);
        CHECK(corners[0].x == doctest::Approx(1.0));  // shared by both halves
        CHECK(corners[1].x == doctest::Approx(2.0));  // its own
        CHECK(corners[3].x == doctest::Approx(1.0));
        for (std::size_t c = 6; c < corners.size(); ++c) CHECK(corners[c].x == 0.0f);
    }
}
