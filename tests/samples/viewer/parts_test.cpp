// SPDX-License-Identifier: MIT
// The viewer's parts that need no window: near misses, views, the frame history, shapes.
#include <doctest/doctest.h>

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <nlohmann/json.hpp>

#include "assets/retriangulate.hpp"
#include "viewer/camera_controller.hpp"
#include "viewer/frame_history.hpp"
#include "viewer/near_misses.hpp"
#include "viewer/overlay.hpp"
#include "viewer/shape_colors.hpp"

using namespace crofton;
using namespace crofton::viewer;

TEST_SUITE("assets/retriangulate") {
    // A rhombus with diagonals of 10 and 2, cut along the long one, facing −z.
    assets::SceneSource rhombus(bool as_polygon) {
        assets::SceneSource source{"rhombus", scene::Scene(), {}, {}, {}, {}};
        if (as_polygon) {
            scene::PlanarPolygon flat;
            flat.polygon = {{{-5, 0}, {0, -1}, {5, 0}, {0, 1}}, {4}};
            const std::array<std::uint32_t, 3> triangles[] = {{2, 1, 0}, {3, 2, 0}};
            REQUIRE(source.scene.add_polygon(flat, triangles));
        } else {
            TriangleMesh mesh;
            mesh.positions = {{-5, 0, 0}, {0, -1, 0}, {5, 0, 0}, {0, 1, 0}};
            mesh.indices = {2, 1, 0, 3, 2, 0};
            REQUIRE(source.scene.add_mesh(mesh));
        }
        REQUIRE(source.scene.add_node(scene::kNone, {}));
        REQUIRE(source.scene.add_instance(0, 0));
        return source;
    }
    TEST_CASE("the least weight takes the short diagonal, facing, area, ids and counts stay, for meshes and polygons") {
        for (const bool as_polygon : {false, true}) {
            CAPTURE(as_polygon);
            assets::SceneSource source = rhombus(as_polygon);
            REQUIRE(assets::retriangulate(source, {}, triangulate::Method::minimum_weight));
            REQUIRE(source.scene.instance_count() == 1);
            CHECK((source.scene.polygon(0) != nullptr) == as_polygon);
            const TriangleMesh& mesh = source.scene.mesh(0);
            REQUIRE(mesh.triangle_count() == 2);
            double area = 0.0;
            for (std::size_t t = 0; t < 6; t += 3) {
                int on_short_diagonal = 0;
                for (std::size_t k = 0; k < 3; ++k) on_short_diagonal += mesh.indices[t + k] % 2 == 1;
                CHECK(on_short_diagonal == 2);
                const glm::vec3 a = mesh.positions[mesh.indices[t]], b = mesh.positions[mesh.indices[t + 1]],
                                c = mesh.positions[mesh.indices[t + 2]];
                area += 0.5 * static_cast<double>(glm::cross(b - a, c - a).z);
            }
            CHECK(area == doctest::Approx(-10.0));
        }
    }
    TEST_CASE("a polygon that crosses itself, and a mesh without any flat patch, stay as they are") {
        assets::SceneSource source{"odd", scene::Scene(), {}, {}, {}, {}};
        scene::PlanarPolygon bow;
        bow.polygon = {{{0, 0}, {2, 2}, {2, 0}, {0, 2}}, {4}};
        const std::array<std::uint32_t, 3> one[] = {{0, 1, 2}};
        REQUIRE(source.scene.add_polygon(bow, one));
        TriangleMesh tent;
        tent.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3f, 0.3f, 1}};
        tent.indices = {0, 1, 3, 1, 2, 3, 2, 0, 3};
        REQUIRE(source.scene.add_mesh(tent));
        REQUIRE(source.scene.add_node(scene::kNone, {}));
        REQUIRE(source.scene.add_instance(0, 1));
        REQUIRE(assets::retriangulate(source, {}, triangulate::Method::ear));
        CHECK(source.scene.mesh(0).triangle_count() == 1);
        CHECK(source.scene.mesh(1).indices == tent.indices);
    }
}

TEST_SUITE("viewer/near_misses") {
    TEST_CASE("the separation spans the gap along a line that has one box on each side, boxes that meet have none") {
        Obb a, b;
        a.half_extents = {1.0f, 2.0f, 1.0f};
        b.half_extents = {1.0f, 1.0f, 1.0f};
        b.center = {1.5, 0.0, 0.0};
        CHECK_FALSE(separation(a, b));
        b.center = {1.0, -3.5, 0.5};
        const auto gap = separation(a, b);
        REQUIRE(gap);
        // Only the y axis separates these; the gap is 3.5 − 2 − 1.
        CHECK(gap->begin.y == doctest::Approx(-2.0));
        CHECK(gap->end.y == doctest::Approx(-2.5));
        CHECK(gap->begin.x == doctest::Approx(0.5));
        CHECK(gap->end.x == doctest::Approx(0.5));
    }
    TEST_CASE("pairs that nearly meet are found once, those that meet or are far are not") {
        std::vector<Obb> boxes(5);
        const double x[] = {0.0, 2.5, 1.0, 30.0, 33.0};
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            boxes[i].center.x = x[i];
            boxes[i].half_extents = glm::vec3(1.0f);
        }
        const scene::InstanceId all[] = {0, 1, 2, 3, 4};
        const auto pairs = near_pairs(boxes, all, 100);
        REQUIRE(pairs.size() == 2);
        CHECK(pairs[0] == std::pair<scene::InstanceId, scene::InstanceId>(0, 1));
        CHECK(pairs[1] == std::pair<scene::InstanceId, scene::InstanceId>(3, 4));
        CHECK(near_pairs(boxes, all, 1).size() == 1);
        CHECK(near_pairs(boxes, {}, 100).empty());
    }
}

TEST_SUITE("viewer/overlay") {
    TEST_CASE("the views of a split cover the whole depth range without gaps") {
        Camera camera;
        camera.far_distance = 300.0;
        const auto views = split_view(camera, 4, 1e9);
        REQUIRE(views.size() == 4);
        CHECK(views.front().camera.near_distance == doctest::Approx(camera.near_distance));
        CHECK(views.back().camera.far_distance == doctest::Approx(camera.far_distance));
        for (std::size_t i = 1; i < views.size(); ++i)
            CHECK(views[i].camera.near_distance == views[i - 1].camera.far_distance);
        camera.far_distance = std::numeric_limits<double>::infinity();
        CHECK(split_view(camera, 3, 50.0).back().camera.far_distance == doctest::Approx(50.0));
    }
    TEST_CASE("a frustum's corners lie where its camera says") {
        Camera camera;
        camera.position = {1e6, 0.0, 0.0};
        camera.far_distance = 10.0;
        camera.aspect = 2.0;
        const auto corner = view_corners(camera, 1e9);
        CHECK(corner[7].z == doctest::Approx(-10.0));
        CHECK(corner[7].y == doctest::Approx(10.0 * std::tan(0.5 * camera.fov_y)));
        CHECK(corner[7].x - 1e6 == doctest::Approx(2.0 * corner[7].y));
        CHECK(corner[0].z == doctest::Approx(-camera.near_distance));
    }
}

TEST_SUITE("viewer/shape_colors") {
    TEST_CASE("quality is 0 without area, 1 when equilateral, and √3/2 for a half square") {
        CHECK(shape_quality({0, 0, 0}, {0, 0, 0}, {0, 0, 0}) == 0.0f);
        CHECK(shape_quality({0, 0, 0}, {1, 0, 0}, {2, 0, 0}) == doctest::Approx(0.0));
        CHECK(shape_quality({0, 0, 0}, {1, 0, 0}, {0.5f, std::sqrt(0.75f), 0}) == doctest::Approx(1.0));
        CHECK(shape_quality({0, 0, 0}, {1, 0, 0}, {0, 1, 0}) == doctest::Approx(std::sqrt(3.0) / 2.0));
    }
    TEST_CASE("colouring keeps the triangles, their order and their bits") {
        const render::Vertex vertices[] = {{{0, 0, 0}, {0, 0, 1}, {1, 1, 1}},
                                           {{1, 0, 0}, {0, 0, 1}, {1, 1, 1}},
                                           {{0, 1, 0}, {0, 0, 1}, {1, 1, 1}},
                                           {{9, 1, 0}, {0, 0, 1}, {1, 1, 1}}};
        const std::uint32_t indices[] = {0, 1, 2, 2, 1, 3};
        const ShapeColored colored = color_by_shape(vertices, indices);
        REQUIRE(colored.indices.size() == 6);
        for (std::size_t i = 0; i < 6; ++i)
            CHECK(colored.vertices[colored.indices[i]].position == vertices[indices[i]].position);
    }
}

TEST_SUITE("viewer/eye") {
    TEST_CASE("a camera on a floor walks at 1.4 m/s, and a smaller eye proportionally slower") {
        CameraController eye;
        eye.stand({0, 1.7, 0}, {0, 1.7, -5}, 1.7);
        CHECK(eye.speed == doctest::Approx(1.4));
        eye.handle({Event::Kind::key_down, "W", 0, {}});
        eye.advance(2.0);
        CHECK(glm::distance(eye.camera.position, glm::dvec3(0, 1.7, -2.8)) < 1e-9);
        eye.stand({0, 0.17, 0}, {0, 0.17, -5}, 0.17);
        CHECK(eye.speed == doctest::Approx(0.14));
        const Aabb box{{-60, -60, -60}, {60, 60, 60}};
        eye.frame_all(box, box);
        CHECK(eye.speed == doctest::Approx(std::sqrt(3.0) * 10.0));
    }
    TEST_CASE("frame-all sees the whole focus, and keys move the camera by speed times time") {
        CameraController eye;
        eye.frame_all({}, {});  // empty: nothing happens
        const Aabb box{{-10, 0, -10}, {30, 20, 50}};
        eye.frame_all(box, box);
        const glm::dvec3 to_center = box.center() - eye.camera.position;
        CHECK(glm::length(glm::cross(glm::normalize(to_center), eye.camera.forward)) < 1e-12);
        CHECK(eye.camera.far_distance > glm::length(to_center));
        // All corners are in view, and one of them is near its edge.
        double widest = 0.0;
        for (int corner = 0; corner < 8; ++corner) {
            const glm::dvec3 p((corner & 1) != 0 ? box.max.x : box.min.x, (corner & 2) != 0 ? box.max.y : box.min.y,
                               (corner & 4) != 0 ? box.max.z : box.min.z);
            const glm::dvec3 view = world_to_view_rotation(eye.camera) * (p - eye.camera.position);
            const double tangent = std::tan(0.5 * eye.camera.fov_y);
            REQUIRE(view.z < 0.0);
            widest = std::max({widest, std::fabs(view.y / view.z) / tangent,
                               std::fabs(view.x / view.z) / (tangent * eye.camera.aspect)});
        }
        CHECK(widest < 1.0);
        CHECK(widest > 0.9);
        const glm::dvec3 before = eye.camera.position;
        eye.handle({Event::Kind::key_down, "W", 0, {}});
        eye.advance(0.5);
        eye.handle({Event::Kind::key_up, "W", 0, {}});
        eye.advance(0.5);
        CHECK(glm::distance(eye.camera.position, before + eye.camera.forward * (0.5 * eye.speed)) < 1e-9);
    }
    TEST_CASE("a bookmark brings the camera back, and an empty one changes nothing") {
        CameraController eye;
        eye.camera.position = {1, 2, 3};
        eye.store_bookmark(4);
        eye.camera.position = {7, 7, 7};
        CHECK_FALSE(eye.recall_bookmark(5));
        CHECK(eye.camera.position.x == 7.0);
        CHECK(eye.recall_bookmark(4));
        CHECK(eye.camera.position.x == 1.0);
    }
    TEST_CASE("orbiting keeps the distance from its centre") {
        CameraController eye;
        const Aabb box{{-1, -1, -1}, {1, 1, 1}};
        eye.frame_all(box, box);
        eye.mode = CameraMode::orbit;
        const double distance = glm::length(eye.camera.position);
        eye.handle({Event::Kind::button_down, "", 1, {100, 100}});
        eye.handle({Event::Kind::cursor, "", 0, {180, 130}});
        eye.handle({Event::Kind::button_up, "", 1, {180, 130}});
        CHECK(glm::length(eye.camera.position) == doctest::Approx(distance));
        CHECK(glm::dot(glm::normalize(-eye.camera.position), eye.camera.forward) == doctest::Approx(1.0));
    }
}

TEST_SUITE("viewer/frame_history") {
    TEST_CASE("an empty history of frames has no values, and exports valid files all the same") {
        const FrameHistory frame_history;
        CHECK(frame_history.history([](const HistoryEntry& e) { return e.frame_us; }).empty());
        CHECK(frame_history.json().find("frames")->size() == 0);
        CHECK(nlohmann::json::parse(frame_history.chrome_trace())["traceEvents"].empty());
    }
    TEST_CASE("history keeps the last frames, bins count them, and the trace's spans do not overlap") {
        FrameHistory frame_history;
        for (int i = 0; i < 300; ++i) {
            HistoryEntry entry;
            entry.frame_us = 1000.0 * i;
            entry.frame.cull_us = 10.0;
            frame_history.add(entry);
        }
        const auto history = frame_history.history([](const HistoryEntry& e) { return e.frame_us * 1e-3; });
        REQUIRE(history.size() == FrameHistory::kHistory);
        CHECK(history.front() == 60.0f);
        CHECK(history.back() == 299.0f);
        const auto bins = frame_history.frame_time_histogram();
        CHECK(bins[12] == 5.0f);            // 60 to 64 ms
        CHECK(bins[19] == 300.0f - 95.0f);  // 95 ms and more
        const auto trace = nlohmann::json::parse(frame_history.chrome_trace());
        double end = 0.0;
        for (const auto& event : trace["traceEvents"]) {
            if (event["name"] != "frame") continue;
            CHECK(event["ts"].get<double>() >= end);
            end = event["ts"].get<double>() + event["dur"].get<double>();
        }
    }
}
