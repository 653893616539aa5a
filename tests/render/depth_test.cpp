// SPDX-License-Identifier: MIT
// Depth of triangles that are seen edge-on: set up from vertices as given, covered by vertices snapped to the grid.
#include <array>
#include <cmath>
#include <crofton/render/clip_space.hpp>
#include <glm/common.hpp>
#include <limits>
#include <random>
#include <vector>

#include "test_device.hpp"

using namespace crofton;
using namespace crofton::render;

namespace {

constexpr std::uint32_t kWidth = 640, kHeight = 360;
constexpr double kWallDepth = 5.0;

// How far the corners of a sliver lie from a line of the picture, in its half height; or in space, exactly on one.
constexpr double kOnLineInSpace = -1.0;
constexpr double kWidths[] = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 0.0, kOnLineInSpace};

struct Slivers {
    Camera camera;
    Vector<Vertex> vertices;
    Vector<std::uint32_t> indices;  // the wall's six first
};

// A wall that fills the view, and behind it slivers that reach into the depth.
Slivers random_slivers(std::uint64_t seed, int count, double width) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    Slivers scene;
    scene.camera.aspect = static_cast<double>(kWidth) / kHeight;
    scene.camera.far_distance = seed % 2 == 0 ? 1000.0 : std::numeric_limits<double>::infinity();
    const bool orthographic = seed % 4 == 2;
    if (orthographic) {
        scene.camera.projection = Projection::orthographic;
        scene.camera.height = 10.0;
    }
    const double half = orthographic ? 0.5 * scene.camera.height : std::tan(0.5 * scene.camera.fov_y);
    // By place in the picture, in half its height and width, and depth.
    const auto at = [&](const glm::dvec2& place, double depth) {
        const double size = orthographic ? half : half * depth;
        return glm::dvec3(place.x * scene.camera.aspect * size, place.y * size, -depth);
    };
    const auto add = [&](const glm::dvec3& p) {
        scene.indices.push_back(static_cast<std::uint32_t>(scene.vertices.size()));
        scene.vertices.push_back({glm::vec3(p), {0, 0, 1}, {1, 1, 1}});
    };
    for (const glm::dvec2 corner : {glm::dvec2(-2, -2), {2, -2}, {2, 2}, {-2, -2}, {2, 2}, {-2, 2}})
        add(at(corner, kWallDepth));
    for (int i = 0; i < count; ++i) {
        const double x = unit(random), y = unit(random), u = unit(random), v = unit(random);
        const glm::dvec2 middle = 0.8 * glm::dvec2(x, y), along = 0.2 * glm::dvec2(u, v), across(-along.y, along.x);
        std::array<glm::dvec3, 3> corners;
        for (glm::dvec3& corner : corners) {
            const double s = unit(random), t = std::max(width, 0.0) * unit(random), log_depth = unit(random);
            const double depth = kWallDepth * (1.02 + std::exp(2.5 * log_depth + 2.0));
            corner = at(middle + s * along + t * across, std::min(depth, 900.0));
        }
        if (width == kOnLineInSpace) corners[2] = glm::mix(corners[0], corners[1], 0.5 + 0.5 * unit(random));
        for (const glm::dvec3& corner : corners) add(corner);
    }
    return scene;
}

// Pixels of slivers, in numbers and in colours, where the wall is drawn before or after them.
struct WrongPixels {
    std::size_t numbers = 0, colors = 0;
};

WrongPixels count_wrong(Rasterizer& rasterizer, const Slivers& scene, bool one_sided, bool unclipped) {
    DrawTransform wall = draw_transform(ModelToClip(scene.camera)(glm::dmat3(1.0), {}), glm::dmat3(1.0));
    wall.unlit = 1.0f;
    DrawTransform sliver = wall;
    set_tint(wall, {1, 0, 0});
    set_tint(sliver, {0, 1, 0});
    const DrawTransform transforms[] = {wall, sliver};
    const DrawRange of_wall{0, 6, 0},
        of_slivers{6, static_cast<std::uint32_t>(scene.indices.size()) - 6, 1, one_sided, unclipped};
    REQUIRE(rasterizer.set_geometry(scene.vertices, scene.indices));
    WrongPixels wrong;
    for (const bool wall_first : {true, false}) {
        const std::array ranges{wall_first ? of_wall : of_slivers, wall_first ? of_slivers : of_wall};
        const std::uint32_t first_of_wall = wall_first ? 0 : of_slivers.index_count / 3;
        Frame frame{.camera = scene.camera, .transforms = transforms, .ranges = ranges};
        frame.environment.haze_distance = 0.0f;
        Vector<std::uint32_t> owners;
        REQUIRE(rasterizer.draw_owners(frame, owners));
        for (const std::uint32_t owner : owners) wrong.numbers += owner - first_of_wall >= 2;
        Image image;
        REQUIRE(rasterizer.draw(frame));
        REQUIRE(rasterizer.read_pixels(image));
        for (std::size_t p = 0; p < image.rgba.size(); p += 4) wrong.colors += image.rgba[p] != 255;
    }
    return wrong;
}

}  // namespace

TEST_SUITE("render/depth") {
    TEST_CASE("a wall hides all that lies behind it: triangles seen edge-on, and those of three points on a line") {
        CROFTON_REQUIRE_DEVICE(device);
        auto rasterizer = Rasterizer::create(*device, {kWidth, kHeight}).value();
        for (const double width : kWidths)
            for (std::uint64_t seed = 0; seed < 10; ++seed) {
                const WrongPixels wrong =
                    count_wrong(rasterizer, random_slivers(seed, 2000, width), seed % 3 != 0, seed % 3 == 1);
                CAPTURE(width);
                CAPTURE(seed);
                CHECK(wrong.numbers == 0);
                CHECK(wrong.colors == 0);
            }
        CHECK(device->validation_messages().empty());
    }
    TEST_CASE("two sheets of nearly the same depth and slope keep their order") {
        CROFTON_REQUIRE_DEVICE(device);
        auto rasterizer = Rasterizer::create(*device, {kWidth, kHeight}).value();
        // They fall away from the eye; the second is nearer by a hundredth of what depth changes from pixel to pixel.
        Camera camera;
        camera.aspect = static_cast<double>(kWidth) / kHeight;
        const ModelToClip to_clip(camera);
        const Vertex vertices[] = {
            {{-50, -1, -2}, {0, 1, 0}, {}}, {{50, -1, -2}, {0, 1, 0}, {}}, {{0, -1, -400}, {0, 1, 0}, {}}};
        const std::uint32_t indices[] = {0, 1, 2};
        REQUIRE(rasterizer.set_geometry(vertices, indices));
        const double nearer = 1.0 - 0.01 / 180.0;
        const DrawTransform transforms[] = {draw_transform(to_clip(glm::dmat3(1.0), {}), glm::dmat3(1.0)),
                                            draw_transform(to_clip(glm::dmat3(nearer), {}), glm::dmat3(1.0))};
        const DrawRange ranges[] = {{0, 3, 0}, {0, 3, 1}};
        const Frame frame{.camera = camera, .transforms = transforms, .ranges = ranges};
        Vector<std::uint32_t> owners;
        REQUIRE(rasterizer.draw_owners(frame, owners));
        std::size_t first = 0, second = 0;
        for (const std::uint32_t owner : owners) {
            first += owner == 0;
            second += owner == 1;
        }
        CHECK(second > 10000);
        CHECK(first < 20);
    }
}
