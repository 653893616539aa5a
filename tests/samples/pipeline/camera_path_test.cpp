// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <unistd.h>
#include <cmath>
#include <cstdlib>
#include <error_of.hpp>
#include <filesystem>
#include <fstream>

#include "json/json.hpp"
#include "pipeline/camera_path.hpp"

using namespace crofton;
using namespace crofton::pipeline;

static Json parsed(const std::string& text) {
    Json document;
    REQUIRE(parse_json(text, document));
    return document;
}

TEST_SUITE("pipeline/camera_path") {
    TEST_CASE("entries that are no cameras are refused with their number") {
        CHECK(error_of(camera_from_json(parsed("[1]"), 4)).item == 4);
        CHECK(error_of(camera_from_json(parsed(R"({"position": [1, 2]})"), 5)).item == 5);
        CHECK(error_of(camera_from_json(parsed(R"({"near": -1})"), 6)).code == ErrorCode::out_of_range);
        CHECK(error_of(camera_from_json(parsed(R"({"up": [0, 0, 1]})"), 7)).code == ErrorCode::degenerate);
    }

    TEST_CASE("an empty scene, an unknown kind and a missing file are refused") {
        CHECK(error_of(make_camera_path({}, Aabb{}, {})).code == ErrorCode::empty);
        CHECK_FALSE(make_camera_path({.kind = "sideways"}, Aabb{{0, 0, 0}, {1, 1, 1}}, {}).has_value());
    }

    TEST_CASE("a camera survives its JSON bit for bit, an infinite far too") {
        Camera camera;
        camera.position = {1e7 + 0.1, -1.0 / 3.0, 2e-9};
        camera.forward = {0.1, 0.2, -0.7};
        camera.far_distance = INFINITY;
        const auto again = camera_from_json(parsed(to_json(camera).dump()), 0).value();
        CHECK(again.position == camera.position);
        CHECK(again.forward == camera.forward);
        CHECK(std::isinf(again.far_distance));
        CHECK(again.projection == Projection::perspective);
    }

    TEST_CASE("an orthographic camera survives its JSON, and its height must be one") {
        Camera camera;
        camera.projection = Projection::orthographic;
        camera.height = 1.0 / 3.0;
        const auto again = camera_from_json(parsed(to_json(camera).dump()), 0).value();
        CHECK(again.projection == Projection::orthographic);
        CHECK(again.height == camera.height);
        CHECK(error_of(camera_from_json(parsed(R"({"height": "tall"})"), 8)).code == ErrorCode::parse);
        CHECK(error_of(camera_from_json(parsed(R"({"height": -1})"), 9)).code == ErrorCode::out_of_range);
    }

    TEST_CASE("every built-in path gives the requested number of valid cameras, the same for the same seed") {
        for (const char* kind : {"orbit", "street", "random"})
            for (const Aabb& bounds : {Aabb{{-50, 0, -30}, {50, 20, 30}}, Aabb{{1e6, 5, 5}, {1e6, 5, 5}}}) {
                const PathOptions options{.kind = kind, .frames = 37, .seed = 3};
                const auto path = make_camera_path(options, bounds, {}).value();
                CHECK(path.cameras.size() == 37);
                CHECK(path.scene_frames.back() == 36);
                for (const Camera& camera : path.cameras) CHECK(validate(camera).has_value());
                CHECK(make_camera_path(options, bounds, {})->cameras.back().position == path.cameras.back().position);
            }
    }

    TEST_CASE("a recording that is shorter than the frames starts over, and the scene with it") {
        const auto name = std::filesystem::temp_directory_path() / ("crofton-short-" + std::to_string(getpid()));
        std::ofstream(name) << R"([{"scene_frame": 100}, {"scene_frame": 101}, {}])";
        const auto path = make_camera_path({.kind = name.string(), .frames = 7}, Aabb{{0, 0, 0}, {1, 1, 1}}, {});
        std::filesystem::remove(name);
        REQUIRE(path.has_value());
        CHECK(path->scene_frames == std::vector<std::uint32_t>{100, 101, 2, 100, 101, 2, 100});
    }

    TEST_CASE("a frame of the scene that is no 32-bit number is refused with its entry") {
        const std::string path = (std::filesystem::temp_directory_path() / "crofton-path-XXXXXX").string();
        std::string name = path;
        const int file = mkstemp(name.data());
        REQUIRE(file >= 0);
        close(file);
        for (const auto& [frame, good] : {std::pair("4294967295", true), {"4294967296", false}, {"-1", false}}) {
            std::ofstream(name) << "[{}, {\"scene_frame\": " << frame << "}]";
            const auto loaded = load_camera_path(name);
            REQUIRE(loaded.has_value() == good);
            if (good)
                CHECK(loaded->scene_frames[1] == 4294967295u);
            else
                CHECK(loaded.error().item == 1);
        }
        std::filesystem::remove(name);
    }
}
