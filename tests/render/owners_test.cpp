// SPDX-License-Identifier: MIT
// Which triangle owns which pixel, against rays through pixel centres that are told nothing of rasterization.
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/render/clip_space.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <random>
#include <vector>

#include "test_device.hpp"

using namespace crofton;
using namespace crofton::render;

namespace {

constexpr std::uint32_t kSide = 64;

struct WorldTriangle {
    std::array<glm::dvec3, 3> corners;
    bool one_sided = false;
};

// Some meshes in one buffer, some drawn twice, from one camera.
struct OwnerScene {
    Camera camera;
    Vector<Vertex> vertices;
    Vector<std::uint32_t> indices;
    std::vector<DrawTransform> transforms;
    std::vector<DrawRange> ranges;
    std::vector<WorldTriangle> triangles;  // as draw_owners() counts them
};

OwnerScene random_scene(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const auto point = [&](double size) {
        const double x = unit(random), y = unit(random), z = unit(random);
        return size * glm::dvec3(x, y, z);
    };
    OwnerScene scene;
    scene.camera.position = point(1000.0);
    scene.camera.forward = glm::normalize(point(1.0) + glm::dvec3(0.1, 0.0, 1.5));
    scene.camera.aspect = 1.0;
    scene.camera.near_distance = 1.0;
    scene.camera.far_distance = seed % 3 == 0 ? std::numeric_limits<double>::infinity() : 60.0;
    if (seed % 4 == 1) {
        scene.camera.projection = Projection::orthographic;
        scene.camera.height = 24.0;
        scene.camera.far_distance = 60.0;
    }
    const double triangle_size = seed % 2 == 0 ? 2.0 : 12.0;
    const ModelToClip to_clip(scene.camera);
    for (int mesh = 0; mesh < 8; ++mesh) {
        const auto first_vertex = static_cast<std::uint32_t>(scene.vertices.size());
        const auto first_index = static_cast<std::uint32_t>(scene.indices.size());
        Aabb bounds;
        for (int t = 0; t < 30; ++t) {
            const glm::dvec3 middle = point(8.0);
            for (int k = 0; k < 3; ++k) {
                const glm::vec3 corner(middle + point(triangle_size));
                bounds.include(corner);
                scene.indices.push_back(static_cast<std::uint32_t>(scene.vertices.size()));
                scene.vertices.push_back({corner, {0, 0, 1}, {1, 1, 1}});
            }
        }
        for (int copy = 0; copy <= mesh % 2; ++copy) {
            glm::dmat3 linear(point(1.0), point(1.0), point(1.0));
            linear += glm::dmat3(1.5);
            const glm::dvec3 place = scene.camera.position + 25.0 * scene.camera.forward + point(15.0);
            const glm::mat4 matrix = to_clip(linear, place);
            scene.ranges.push_back({first_index, static_cast<std::uint32_t>(scene.indices.size()) - first_index,
                                    static_cast<std::uint32_t>(scene.transforms.size()), mesh % 3 != 0,
                                    inside_clip_planes(bounds, matrix)});
            scene.transforms.push_back(draw_transform(matrix, linear));
            for (std::uint32_t v = first_vertex; v < scene.vertices.size(); v += 3) {
                WorldTriangle triangle{{}, mesh % 3 != 0};
                for (std::uint32_t k = 0; k < 3; ++k)
                    triangle.corners[k] = linear * glm::dvec3(scene.vertices[v + k].position) + place;
                scene.triangles.push_back(triangle);
            }
        }
    }
    return scene;
}

struct FirstHit {
    std::uint32_t triangle = kNoTriangle;
    double depth = std::numeric_limits<double>::infinity();
    double second = std::numeric_limits<double>::infinity();  // depth of what lies behind
};

// By view depth along the ray through a point of the picture, in pixels from the upper left.
FirstHit first_hit(const OwnerScene& scene, double x, double y) {
    const Camera& camera = scene.camera;
    const bool perspective = camera.projection == Projection::perspective;
    const glm::dvec3 forward = glm::normalize(camera.forward);
    const glm::dvec3 right = glm::normalize(glm::cross(forward, camera.up)), up = glm::cross(right, forward);
    const double half = perspective ? std::tan(0.5 * camera.fov_y) : 0.5 * camera.height;
    const glm::dvec3 sideways = half * ((2.0 * x / kSide - 1.0) * camera.aspect * right + (1.0 - 2.0 * y / kSide) * up);
    const glm::dvec3 origin = perspective ? camera.position : camera.position + sideways;
    const glm::dvec3 direction = perspective ? forward + sideways : forward;
    FirstHit hit;
    for (std::uint32_t i = 0; i < scene.triangles.size(); ++i) {
        const auto& [a, b, c] = scene.triangles[i].corners;
        const glm::dvec3 normal = glm::cross(b - a, c - a);
        const double slope = glm::dot(normal, direction);
        if (slope == 0.0 || (scene.triangles[i].one_sided && slope > 0.0)) continue;
        const double depth = glm::dot(normal, a - origin) / slope;
        if (depth < camera.near_distance || depth > camera.far_distance) continue;
        const glm::dvec3 p = origin + depth * direction;
        if (glm::dot(glm::cross(b - a, p - a), normal) < 0.0 || glm::dot(glm::cross(c - b, p - b), normal) < 0.0 ||
            glm::dot(glm::cross(a - c, p - c), normal) < 0.0)
            continue;
        if (depth < hit.depth) {
            hit.second = hit.depth;
            hit.depth = depth;
            hit.triangle = i;
        } else {
            hit.second = std::min(hit.second, depth);
        }
    }
    return hit;
}

// The owner, where neither the rounding of vertices to 1/256 pixel nor that of depth can change it.
struct Expected {
    std::uint32_t triangle = kNoTriangle;
    bool clear = false;
};
Expected expected_owner(const OwnerScene& scene, std::uint32_t px, std::uint32_t py) {
    const FirstHit middle = first_hit(scene, px + 0.5, py + 0.5);
    Expected result{middle.triangle, middle.second > 1.003 * middle.depth};
    constexpr double kAround = 0.02;  // pixels
    for (const double dx : {-kAround, kAround})
        for (const double dy : {-kAround, kAround})
            result.clear = result.clear && first_hit(scene, px + 0.5 + dx, py + 0.5 + dy).triangle == middle.triangle;
    return result;
}

}  // namespace

TEST_SUITE("render/owners") {
    TEST_CASE("each pixel is owned by the triangle that a ray through its centre hits first") {
        CROFTON_REQUIRE_DEVICE(device);
        auto rasterizer = Rasterizer::create(*device, {kSide, kSide}).value();
        Vector<std::uint32_t> owners;
        std::size_t compared = 0, owned = 0;
        for (std::uint64_t seed = 0; seed < 24; ++seed) {
            const OwnerScene scene = random_scene(seed);
            REQUIRE(rasterizer.set_geometry(scene.vertices, scene.indices));
            const Frame frame{.camera = scene.camera, .transforms = scene.transforms, .ranges = scene.ranges};
            REQUIRE(rasterizer.draw_owners(frame, owners));
            REQUIRE(owners.size() == kSide * kSide);
            for (std::uint32_t p = 0; p < owners.size(); ++p) {
                const Expected expected = expected_owner(scene, p % kSide, p / kSide);
                if (!expected.clear) continue;
                ++compared;
                owned += expected.triangle != kNoTriangle;
                if (owners[p] != expected.triangle)
                    FAIL("scene " << seed << ", pixel " << p % kSide << ", " << p / kSide << ": owner " << owners[p]
                                  << ", a ray hits " << expected.triangle);
            }
        }
        CHECK(compared > 60000);
        CHECK(owned > 30000);
        CHECK(device->validation_messages().empty());
    }
    TEST_CASE("triangles that own no pixel can be left out: the others own the same pixels") {
        CROFTON_REQUIRE_DEVICE(device);
        auto rasterizer = Rasterizer::create(*device, {kSide, kSide}).value();
        Vector<std::uint32_t> all, fewer;
        std::size_t owning = 0;
        for (std::uint64_t seed = 100; seed < 140; ++seed) {
            const OwnerScene scene = random_scene(seed);
            REQUIRE(rasterizer.set_geometry(scene.vertices, scene.indices));
            Frame frame{.camera = scene.camera, .transforms = scene.transforms, .ranges = scene.ranges};
            REQUIRE(rasterizer.draw_owners(frame, all));
            // Each triangle that owns a pixel as a range of its own, in the same order.
            std::vector<DrawRange> ranges;
            std::vector<std::uint32_t> kept;
            std::uint32_t number = 0;
            for (const DrawRange& range : scene.ranges)
                for (std::uint32_t i = 0; i < range.index_count; i += 3, ++number)
                    if (std::find(all.begin(), all.end(), number) != all.end()) {
                        ranges.push_back(range);
                        ranges.back().first_index += i;
                        ranges.back().index_count = 3;
                        kept.push_back(number);
                    }
            owning += kept.size();
            frame.ranges = ranges;
            REQUIRE(rasterizer.draw_owners(frame, fewer));
            for (std::uint32_t& owner : fewer)
                if (owner != kNoTriangle) owner = kept[owner];
            CHECK(static_cast<bool>(fewer == all));
        }
        CHECK(owning > 1000);
    }
    TEST_CASE("the picture of numbers has a pixel where the picture of colours has one") {
        CROFTON_REQUIRE_DEVICE(device);
        auto rasterizer = Rasterizer::create(*device, {kSide, kSide}).value();
        REQUIRE(rasterizer.resize(kSide, kSide, 1));
        Vector<std::uint32_t> owners;
        Image image;
        for (std::uint64_t seed = 200; seed < 210; ++seed) {
            OwnerScene scene = random_scene(seed);
            REQUIRE(rasterizer.set_geometry(scene.vertices, scene.indices));
            for (std::size_t t = 0; t < scene.transforms.size(); ++t) {
                scene.transforms[t].unlit = 1.0f;
                const float red = (static_cast<float>(t) + 1.0f) / 255.0f;
                set_tint(scene.transforms[t], {red * red, 1.0f, 0.0f});
            }
            Frame frame{.camera = scene.camera, .transforms = scene.transforms, .ranges = scene.ranges};
            frame.environment.haze_distance = 0.0f;
            REQUIRE(rasterizer.draw(frame));
            REQUIRE(rasterizer.draw_owners(frame, owners, 1));
            REQUIRE(rasterizer.read_pixels(image));
            for (std::size_t p = 0; p < owners.size(); ++p) {
                std::uint32_t transform = 0, number = owners[p];
                if (number == kNoTriangle) continue;
                for (const DrawRange& range : scene.ranges) {
                    transform = range.transform;
                    if (number < range.index_count / 3) break;
                    number -= range.index_count / 3;
                }
                if (image.rgba[4 * p] != transform + 1) FAIL("scene " << seed << ", pixel " << p);
            }
        }
    }
    TEST_CASE("numbers keep all their bits, and nothing owns the pixels of an empty frame") {
        CROFTON_REQUIRE_DEVICE(device);
        auto rasterizer = Rasterizer::create(*device, {kSide, kSide}).value();
        // Ahead of a camera at the origin; and far more triangles of no size.
        const Vertex vertices[] = {{{-50, -50, -5}, {0, 0, 1}, {1, 1, 1}},
                                   {{50, -50, -5}, {0, 0, 1}, {1, 1, 1}},
                                   {{0, 90, -5}, {0, 0, 1}, {}}};
        Vector<std::uint32_t> indices{0, 1, 2};
        indices.resize(3 * 300'000, 0u);
        REQUIRE(rasterizer.set_geometry(vertices, indices));
        Camera camera;
        camera.aspect = 1.0;
        const DrawTransform transform = draw_transform(ModelToClip(camera)(glm::dmat3(1.0), {}), glm::dmat3(1.0));
        Vector<std::uint32_t> owners;
        Frame frame{.camera = camera, .transforms = {&transform, 1}, .ranges = {}};
        REQUIRE(rasterizer.draw_owners(frame, owners));
        CHECK(owners == Vector<std::uint32_t>(kSide * kSide, kNoTriangle));
        const DrawRange nothing{3, 3 * 299'999, 0, true, true};
        for (const std::size_t before : {0u, 1u, 57u}) {
            std::vector<DrawRange> ranges(before, nothing);
            ranges.push_back({0, 3, 0, true, true});
            frame.ranges = ranges;
            REQUIRE(rasterizer.draw_owners(frame, owners));
            CHECK(owners == Vector<std::uint32_t>(kSide * kSide, static_cast<std::uint32_t>(299'999 * before)));
        }
        CHECK(device->validation_messages().empty());
    }
    TEST_CASE("the first of several triangles at the same place owns the pixels, whatever faces are shown") {
        CROFTON_REQUIRE_DEVICE(device);
        auto rasterizer = Rasterizer::create(*device, {kSide, kSide}).value();
        const Vertex vertices[] = {
            {{-1, -1, -5}, {0, 0, 1}, {1, 1, 1}}, {{1, -1, -5}, {0, 0, 1}, {1, 1, 1}}, {{0, 1, -5}, {0, 0, 1}, {}}};
        const std::uint32_t indices[] = {0, 1, 2};
        REQUIRE(rasterizer.set_geometry(vertices, indices));
        Camera camera;
        camera.aspect = 1.0;
        const DrawTransform transform = draw_transform(ModelToClip(camera)(glm::dmat3(1.0), {}), glm::dmat3(1.0));
        std::vector<DrawRange> ranges{{0, 3, 0, false, true}, {0, 3, 0, true, false}, {0, 3, 0, true, true}};
        for (std::size_t turn = 0; turn < 6; ++turn) {
            Vector<std::uint32_t> owners;
            REQUIRE(rasterizer.draw_owners({camera, {&transform, 1}, ranges}, owners));
            CHECK(std::count(owners.begin(), owners.end(), 0u) > 50);
            CHECK(std::count(owners.begin(), owners.end(), 1u) == 0);
            CHECK(std::count(owners.begin(), owners.end(), 2u) == 0);
            std::swap(ranges[turn % 2], ranges[turn % 2 + 1]);
        }
    }
    TEST_CASE("bad ranges are refused by name, and so is a picture of fewer pixels") {
        CROFTON_REQUIRE_DEVICE(device);
        auto rasterizer = Rasterizer::create(*device, {kSide, kSide}).value();
        const OwnerScene scene = random_scene(1);
        REQUIRE(rasterizer.set_geometry(scene.vertices, scene.indices));
        std::vector<DrawRange> ranges = scene.ranges;
        Frame frame{.camera = scene.camera, .transforms = scene.transforms, .ranges = ranges};
        Vector<std::uint32_t> owners;
        ranges[2].transform = static_cast<std::uint32_t>(scene.transforms.size());
        CHECK(error_of(rasterizer.draw_owners(frame, owners)).item == 2);
        ranges[2] = {0, 4, 0};
        CHECK(error_of(rasterizer.draw_owners(frame, owners)).code == ErrorCode::invalid_argument);
        ranges[2] = scene.ranges[2];
        REQUIRE(rasterizer.resize(kSide, kSide, 1, 0.5f));
        CHECK(error_of(rasterizer.draw_owners(frame, owners, 1)).code == ErrorCode::invalid_argument);
        CHECK(rasterizer.draw_owners(frame, owners));
    }
}
