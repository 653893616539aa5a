// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/study/light_field.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

using namespace crofton;

namespace {

void add_box(TriangleMesh& mesh, const glm::vec3& low, const glm::vec3& high, bool inward) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (unsigned c = 0; c < 8; ++c)
        mesh.positions.push_back({c & 1 ? high.x : low.x, c & 2 ? high.y : low.y, c & 4 ? high.z : low.z});
    constexpr std::uint32_t faces[] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                       2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    for (std::size_t i = 0; i < std::size(faces); i += 3) {
        mesh.indices.push_back(first + faces[i]);
        mesh.indices.push_back(first + faces[inward ? i + 2 : i + 1]);
        mesh.indices.push_back(first + faces[inward ? i + 1 : i + 2]);
    }
}

// A room of 4 × 3 × 5 with a column in it.
TriangleMesh room() {
    TriangleMesh mesh;
    add_box(mesh, {0, 0, 0}, {4, 3, 5}, true);
    add_box(mesh, {1.8f, 0.5f, 1.8f}, {2.4f, 2.5f, 2.4f}, false);
    return mesh;
}

glm::vec3 normal_of(const TriangleMesh& mesh, std::uint32_t triangle) {
    const auto at = [&](std::size_t k) { return mesh.positions[mesh.indices[3 * std::size_t{triangle} + k]]; };
    return glm::normalize(glm::cross(at(1) - at(0), at(2) - at(0)));
}

// Another light on each side, and a ramp along z.
study::Leaving shade(const TriangleMesh& mesh, std::uint32_t triangle, const glm::dvec3& point) {
    const glm::vec3 side(static_cast<float>(triangle / 2 + 1));
    return {side + 0.2f * static_cast<float>(point.z), normal_of(mesh, triangle)};
}

Camera camera_in_room() {
    Camera camera;
    camera.position = {1.0, 1.5, 4.5};
    camera.forward = {0.3, -0.1, -1.0};
    camera.aspect = 1.5;
    return camera;
}

}  // namespace

TEST_SUITE("study/light_field") {
    TEST_CASE("a light field of no lines draws nothing, and says so") {
        CHECK(error_of(study::LightField().draw(Camera{}, 4, 4, {})).code == ErrorCode::empty);
        CHECK(study::LightField().arrivals({0.0, 0.0, 0.0}, 1.0).empty());
    }

    TEST_CASE("bad options, cameras and pictures are refused") {
        const TriangleMesh mesh = room();
        const auto tracer = *lines::LineTracer::build(mesh);
        const auto light = [&](std::uint32_t t, const glm::dvec3& p) { return shade(mesh, t, p); };
        CHECK(study::LightField::record(tracer, light, {.lines = 0}).error().code == ErrorCode::out_of_range);
        CHECK(study::LightField::record(tracer, light, {.lines = (std::uint64_t{1} << 28) + 1}).error().code ==
              ErrorCode::out_of_range);
        const auto field = study::LightField::record(tracer, light, {.lines = 1000}).value();
        Camera camera = camera_in_room();
        CHECK(field.draw(camera, 0, 9, {}).error().code == ErrorCode::out_of_range);
        CHECK(field.draw(camera, 1 << 13, 1 << 13, {}).error().code == ErrorCode::out_of_range);
        CHECK(field.draw(camera, 9, 6, {.samples = 0.0}).error().code == ErrorCode::out_of_range);
        CHECK(field.draw(camera, 9, 6, {.blend = 13}).error().code == ErrorCode::out_of_range);
        camera.projection = Projection::orthographic;
        CHECK(field.draw(camera, 9, 6, {}).error().code == ErrorCode::unsupported);
        camera.fov_y = std::nan("");
        camera.projection = Projection::perspective;
        CHECK_FALSE(field.draw(camera, 9, 6, {}).has_value());
        CHECK_FALSE(study::direct_picture(tracer, light, {}, camera, 9, 6).has_value());
    }

    TEST_CASE("recording ends when the caller asks it to") {
        const lines::LineTracer tracer = lines::LineTracer::build(room()).value();
        const auto light = [](std::uint32_t, const glm::dvec3&) { return study::Leaving{glm::vec3(1.0f), {0, 1, 0}}; };
        int asked = 0;
        study::LightFieldOptions options;
        options.should_stop = [](void* user, double share) { return share == 0.0 && ++*static_cast<int*>(user) > 0; };
        options.user = &asked;
        CHECK(error_of(study::LightField::record(tracer, light, options)).code == ErrorCode::cancelled);
        CHECK(asked == 1);
    }

    TEST_CASE("a closed room that glows alike everywhere gives that light in every pixel") {
        TriangleMesh mesh;
        add_box(mesh, {0, 0, 0}, {4, 3, 5}, true);
        const auto tracer = *lines::LineTracer::build(mesh);
        const auto light = [&](std::uint32_t t, const glm::dvec3&) {
            return study::Leaving{glm::vec3(0.5f, 1.0f, 2.0f), normal_of(mesh, t)};
        };
        const auto field = *study::LightField::record(tracer, light, {.lines = 20000});
        const auto drawn = field.draw(camera_in_room(), 48, 32, {}).value();
        for (const glm::vec3& pixel : drawn.picture.pixels)
            CHECK(glm::distance(pixel, glm::vec3(0.5f, 1.0f, 2.0f)) < 1e-6f);
        const auto row = field.draw(camera_in_room(), 48, 1, {}), column = field.draw(camera_in_room(), 1, 32, {});
        for (const auto* line : {&row, &column})
            for (const glm::vec3& pixel : (*line)->picture.pixels)
                CHECK(glm::distance(pixel, glm::vec3(0.5f, 1.0f, 2.0f)) < 1e-6f);
        // Every line crosses the box twice, and its surface sees lines at the density asked for.
        CHECK(field.crossings() == 2 * field.lines());
        CHECK(static_cast<double>(field.lines()) == doctest::Approx(20000.0).epsilon(0.03));
    }

    TEST_CASE("arrivals are the first hits of rays along the lines, and none near the eye is missed") {
        const TriangleMesh mesh = room();
        const auto tracer = *lines::LineTracer::build(mesh);
        const auto light = [&](std::uint32_t t, const glm::dvec3& p) { return shade(mesh, t, p); };
        const auto field = *study::LightField::record(tracer, light, {.lines = 30000, .seed = 5});
        const glm::dvec3 eye(1.0, 1.5, 4.0);
        const auto near = field.arrivals(eye, 0.4), all = field.arrivals(eye, 100.0);
        REQUIRE(near.size() > 100);
        CHECK(near.size() == static_cast<std::size_t>(std::count_if(
                                 all.begin(), all.end(), [](const auto& a) { return !a.sky && a.offset <= 0.4; })));
        for (const auto& arrival : near) {
            CHECK(arrival.offset <= 0.4);
            // In the convex part around the eye: seen straight from it, the place is there, with that light.
            const double distance = glm::length(arrival.point);
            lines::Hit hit;
            const lines::FirstHitQuery query{{eye, arrival.point / distance}};
            tracer.first_hits({&query, 1}, {&hit, 1});
            if (static_cast<double>(hit.t) < distance - 1e-3) continue;  // hidden by the column
            CHECK(static_cast<double>(hit.t) == doctest::Approx(distance).epsilon(1e-4));
            CHECK(glm::distance(arrival.light, shade(mesh, hit.triangle, eye + arrival.point).light) < 0.01f);
        }
    }

    TEST_CASE("with more lines the picture comes nearer to the scene's own, depths and light") {
        const TriangleMesh mesh = room();
        const auto tracer = *lines::LineTracer::build(mesh);
        const auto light = [&](std::uint32_t t, const glm::dvec3& p) { return shade(mesh, t, p); };
        const Camera camera = camera_in_room();
        const auto truth = *study::direct_picture(tracer, light, glm::vec3(0.0f), camera, 96, 64);
        double before = 1.0, aperture = 100.0;
        for (const std::uint64_t lines : {10'000u, 100'000u, 1'000'000u}) {
            const auto drawn =
                study::LightField::record(tracer, light, {.lines = lines})->draw(camera, 96, 64, {}).value();
            const double error = study::relative_difference(drawn.picture, truth);
            CHECK(error < before);
            CHECK(drawn.aperture < aperture);
            before = error, aperture = drawn.aperture;
        }
        CHECK(before < 0.035);  // the column's edges are a pixel off
    }

    TEST_CASE("beyond the scene is the sky, and the bits are the same for any number of threads") {
        TriangleMesh mesh;
        add_box(mesh, {-1, -1, -1}, {1, 1, 1}, false);
        const auto tracer = *lines::LineTracer::build(mesh);
        const auto light = [&](std::uint32_t t, const glm::dvec3& p) { return shade(mesh, t, p); };
        Camera camera;
        camera.position = {0.0, 0.0, 2.5};
        camera.aspect = 1.0;
        camera.fov_y = 1.6;
        ThreadPool pool(3);
        const study::LightFieldOptions options{.lines = 300'000, .sky = glm::vec3(0.25f)};
        const auto field = *study::LightField::record(tracer, light, options);
        // The eye sees only one face of the box: no line, however far from the eye, shows another.
        for (const auto& arrival : field.arrivals(camera.position, 100.0))
            if (!arrival.sky) CHECK(arrival.point.z == doctest::Approx(-1.5));
        const auto drawn = field.draw(camera, 60, 60, {});
        const auto other = study::LightField::record(tracer, light, options, pool)->draw(camera, 60, 60, {});
        REQUIRE(drawn.has_value());
        CHECK(std::equal(drawn->picture.pixels.begin(), drawn->picture.pixels.end(), other->picture.pixels.begin()));
        CHECK(drawn->picture.pixels.front() == glm::vec3(0.25f));
        CHECK(drawn->picture.depths.front() == std::numeric_limits<double>::infinity());
        CHECK(drawn->picture.depths[30 * 60 + 30] == doctest::Approx(1.5).epsilon(0.01));
    }

    TEST_CASE("the difference of pictures is the mean absolute one over the truth's mean") {
        const study::LightPicture a{1, 2, {glm::vec3(1.0f), glm::vec3(3.0f)}, {1.0, 1.0}},
            b{1, 2, {glm::vec3(1.0f), glm::vec3(2.0f)}, {1.0, 1.0}};
        CHECK(study::relative_difference(a, a) == 0.0);
        CHECK(study::relative_difference(b, a) == doctest::Approx(0.25));
    }
}
