// SPDX-License-Identifier: MIT
// ClipPredictor against lavapipe's own counter. The predictor is the CPU's half of `crofton frames --verify`.
#include <crofton/render/clip_space.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <random>

#include "test_device.hpp"

using namespace crofton;
using namespace crofton::render;

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Soup {
    Vector<glm::vec3> positions;
    Vector<std::uint32_t> indices;

    void triangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
        for (const glm::vec3& p : {a, b, c}) {
            indices.push_back(static_cast<std::uint32_t>(positions.size()));
            positions.push_back(p);
        }
    }
};

// Counts on the GPU and on the CPU, and finds the first triangle where they differ.
class Comparison {
  public:
    explicit Comparison(Device& device) : rasterizer_(std::move(*Rasterizer::create(device, {64, 64}))) {}

    void upload(const Soup& soup) {
        Vector<Vertex> vertices;
        for (const glm::vec3& p : soup.positions) vertices.push_back({p, {0, 1, 0}, {1, 1, 1}});
        REQUIRE(rasterizer_.set_geometry(vertices, soup.indices));
    }
    std::uint64_t gpu(const glm::mat4& matrix, std::uint32_t first, std::uint32_t count, bool one_sided = false,
                      bool unclipped = false) {
        const DrawTransform transform = draw_transform(matrix, glm::dmat3(1.0));
        const DrawRange range{first, count, 0, one_sided, unclipped};
        Frame frame{.camera = {}, .transforms = {&transform, 1}, .ranges = {&range, 1}, .environment = {}};
        frame.environment.sky = false;
        const auto counters = rasterizer_.draw(frame).value();
        CHECK(counters.input_assembly_primitives == count / 3);
        return counters.clipping_primitives;
    }
    void check(const Soup& soup, const glm::mat4& matrix) {
        upload(soup);
        ClipPredictor predictor;
        const auto total = static_cast<std::uint32_t>(soup.indices.size());
        CHECK(gpu(matrix, 0, total, true) == gpu(matrix, 0, total));
        if (gpu(matrix, 0, total) == predictor.count(soup.positions, soup.indices, matrix)) return;
        std::uint32_t begin = 0, end = total / 3;
        while (end - begin > 1) {
            const std::uint32_t middle = begin + (end - begin) / 2;
            const auto half = std::span(soup.indices).subspan(3 * begin, 3 * (middle - begin));
            const bool differs =
                gpu(matrix, 3 * begin, 3 * (middle - begin)) != predictor.count(soup.positions, half, matrix);
            (differs ? end : begin) = middle;
        }
        const auto culprit = std::span(soup.indices).subspan(3 * begin, 3);
        for (const std::uint32_t i : culprit) {
            const glm::vec3 p = soup.positions[i];
            MESSAGE("vertex " << p.x << " " << p.y << " " << p.z);
        }
        CAPTURE(begin);
        CHECK(gpu(matrix, 3 * begin, 3) == predictor.count(soup.positions, culprit, matrix));
        FAIL_CHECK("the counts differ");
    }

  private:
    Rasterizer rasterizer_;
};

glm::mat4 some_matrix(Projection projection = Projection::perspective, double far = 50.0) {
    Camera camera;
    camera.position = {1.0, 2.0, 3.0};
    camera.forward = {0.3, -0.2, -1.0};
    camera.projection = projection;
    camera.far_distance = far;
    return ModelToClip(camera)(glm::dmat3(1.0), glm::dvec3(0.0));
}

// Snapped coordinates put many vertices on planes and make many degenerate triangles.
glm::vec3 random_point(std::mt19937_64& random, float half_width, float snap) {
    std::uniform_real_distribution<float> coordinate(-half_width, half_width);
    glm::vec3 p(coordinate(random), coordinate(random), coordinate(random));
    return snap > 0.0f ? glm::round(p / snap) * snap : p;
}

Soup random_soup(std::uint64_t seed, int count, float half_width, float size, float snap) {
    std::mt19937_64 random(seed);
    Soup soup;
    for (int i = 0; i < count; ++i) {
        const glm::vec3 base = random_point(random, half_width, snap);
        soup.triangle(base, base + random_point(random, size, snap), base + random_point(random, size, snap));
    }
    return soup;
}

}  // namespace

TEST_SUITE("geometry/clip_space") {
    TEST_CASE("nothing, and triangles of NaN, infinity, denormals and zero size, count as on lavapipe") {
        ClipPredictor predictor;
        CHECK(predictor.count({}, {}, glm::mat4(1.0f)) == 0);
        CROFTON_REQUIRE_LAVAPIPE(device);
        Comparison comparison(*device);
        const float nan = std::nanf(""), tiny = std::numeric_limits<float>::denorm_min(), huge = 3e38f;
        const float values[] = {0.0f,  -0.0f,  1.0f,   -1.0f, 2.0f,  -2.0f,     0.5f,       tiny,
                                -tiny, 1e-38f, 1e-20f, huge,  -huge, kInfinity, -kInfinity, nan};
        std::mt19937_64 random(1);
        const auto pick = [&] { return values[random() % std::size(values)]; };
        const glm::mat4 matrices[] = {glm::mat4(1.0f), some_matrix(), some_matrix(Projection::orthographic)};
        for (const glm::mat4& matrix : matrices) {
            for (int i = 0; i < 300; ++i) {
                Soup soup;
                soup.triangle({pick(), pick(), pick()}, {pick(), pick(), pick()}, {pick(), pick(), pick()});
                comparison.check(soup, matrix);
            }
        }
        CHECK(device->validation_messages().empty());
    }
    TEST_CASE("a clip-space square cut by each plane counts as the formula says") {
        ClipPredictor predictor;
        const auto count = [&](const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
            const Vector<glm::vec3> points{a, b, c};
            const Vector<std::uint32_t> indices{0, 1, 2};
            return predictor.count(points, indices, glm::mat4(1.0f));
        };
        CHECK(count({0, 0, 0.5f}, {0.5f, 0, 0.5f}, {0, 0.5f, 0.5f}) == 1);   // inside
        CHECK(count({0, 0, 0.5f}, {3, 0, 0.5f}, {0, 0.5f, 0.5f}) == 2);      // one corner cut off: a quadrilateral
        CHECK(count({0, 0, 0.5f}, {3, 0, 0.5f}, {3, 0.5f, 0.5f}) == 1);      // two corners cut off: a triangle
        CHECK(count({2, 0, 0.5f}, {3, 0, 0.5f}, {3, 0.5f, 0.5f}) == 0);      // all beyond one plane
        CHECK(count({0, 0, -1}, {0, 0.5f, -1}, {0, 0, 2}) == 1 + 1);         // through both depth planes
        CHECK(count({-4, -4, 0.5f}, {4, -4, 0.5f}, {0, 8, 0.5f}) == 4 - 2);  // covers the whole square
        CHECK(count({1, 0, 0.5f}, {1, 1, 0.5f}, {1, -1, 0.5f}) == 1);        // lies in a plane: touching is inside
        CHECK(count({0, 0, 0.5f}, {0, 0, 0.5f}, {0, 0, 0.5f}) == 1);         // degenerate
    }
    TEST_CASE("the smallest normal number is not taken for 0, what is smaller is") {
        ClipPredictor predictor;
        const auto count = [&](float z) {
            const Vector<glm::vec3> points{{0, 0, z}, {0.5f, 0, z}, {0, 0.5f, z}};
            const Vector<std::uint32_t> indices{0, 1, 2};
            return predictor.count(points, indices, glm::mat4(1.0f));
        };
        constexpr float kLeast = std::numeric_limits<float>::min();
        CHECK(count(-kLeast) == 0);  // before the near plane
        CHECK(count(-std::nextafter(kLeast, 0.0f)) == 1);
        CHECK(count(kLeast) == 1);
    }
    TEST_CASE("the parts of a mesh count as much as the whole") {
        const Soup soup = random_soup(5, 3000, 3.0f, 4.0f, 0.5f);
        ClipPredictor predictor;
        for (const glm::mat4& matrix : {some_matrix(), some_matrix(Projection::orthographic), glm::mat4(1.0f)}) {
            const std::uint64_t whole = predictor.count(soup.positions, soup.indices, matrix);
            CHECK(whole > 100);
            for (const std::size_t triangles : {1u, 7u, 1000u}) {
                std::uint64_t sum = 0;
                for (std::size_t begin = 0; begin < soup.indices.size(); begin += 3 * triangles) {
                    const std::size_t count = std::min(3 * triangles, soup.indices.size() - begin);
                    sum += predictor.count(soup.positions, std::span(soup.indices).subspan(begin, count), matrix);
                }
                CHECK(sum == whole);
            }
        }
    }
    TEST_CASE("with bounds the count is the same, wherever the box lies: inside, outside, touching, huge, at 10⁷ m") {
        std::mt19937_64 random(11);
        std::uniform_real_distribution<double> unit(-1.0, 1.0);
        ClipPredictor predictor;
        const Vector<std::uint32_t> indices{0, 1, 2};
        int whole = 0, none = 0, clear = 0;
        for (int i = 0; i < 20000; ++i) {
            Camera camera;
            camera.position = {1e7 * unit(random), 0.0, 0.0};
            camera.projection = i % 3 == 0 ? Projection::orthographic : Projection::perspective;
            camera.far_distance = i % 5 == 0 ? std::numeric_limits<double>::infinity() : 50.0;
            if (camera.projection == Projection::orthographic) camera.far_distance = 50.0;
            const double half_width = std::exp2(6.0 * unit(random));
            const glm::dvec3 place(60.0 * unit(random), 60.0 * unit(random), 40.0 * unit(random) - 25.0);
            const glm::mat4 matrix = ModelToClip(camera)(glm::dmat3(half_width), camera.position + place);
            // Snapped corners land on the planes of cameras that look along an axis.
            const Soup soup = random_soup(static_cast<std::uint64_t>(i), 12, 2.0f, 2.0f, i % 2 == 0 ? 0.5f : 0.0f);
            Aabb bounds;
            for (const glm::vec3& p : soup.positions) bounds.include(p);
            const std::uint64_t counted = predictor.count(soup.positions, soup.indices, matrix);
            if (predictor.count(soup.positions, soup.indices, matrix, bounds) != counted) FAIL("differs in case " << i);
            whole += counted == 12;
            none += counted == 0;
            if (!inside_clip_planes(bounds, matrix)) continue;
            ++clear;
            for (const glm::vec3& p : soup.positions) {
                const glm::dvec4 at = glm::dmat4(matrix) * glm::dvec4(p, 1.0);
                if (!(std::abs(at.x) <= at.w && std::abs(at.y) <= at.w && 0.0 <= at.z && at.z <= at.w))
                    FAIL("not inside in case " << i);
            }
        }
        CHECK(clear > 500);
        CHECK(whole >= clear);
        CHECK(whole > 500);
        CHECK(none > 500);
        // Points within a few roundings of the right plane: their box is that point.
        int beyond = 0;
        for (int i = 0; i < 20000; ++i) {
            Camera camera;
            camera.position = {1e7, 0.0, -1e7};
            camera.forward = glm::normalize(glm::dvec3(unit(random), 0.3 * unit(random), unit(random)));
            const glm::dmat3 to_world = glm::transpose(world_to_view_rotation(camera));
            const double depth = 20.0 + 10.0 * unit(random),
                         edge = depth * std::tan(0.5 * camera.fov_y) * camera.aspect;
            const glm::vec3 point(to_world * glm::dvec3((1.0 + 4e-7 * unit(random)) * edge, 0.0, -depth));
            const Vector<glm::vec3> triangle(3, point);
            const Aabb bounds{point, point};
            const glm::mat4 matrix = ModelToClip(camera)(glm::dmat3(1.0), camera.position);
            const std::uint64_t counted = predictor.count(triangle, indices, matrix);
            if (predictor.count(triangle, indices, matrix, bounds) != counted) FAIL("differs at the plane, case " << i);
            beyond += counted == 0;
        }
        CHECK(beyond > 2000);
        CHECK(beyond < 18000);
        // What overflows or is not a number is looked at point by point.
        const Vector<glm::vec3> points{{kInfinity, 0, 0}, {0, 1, 0}, {0, 0, 1}},
            huge{{3e38f, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        for (const auto& list : {points, huge}) {
            Aabb bounds;
            for (const glm::vec3& p : list) bounds.include(p);
            const glm::mat4 matrix = 4.0f * some_matrix();
            CHECK(predictor.count(list, indices, matrix, bounds) == predictor.count(list, indices, matrix));
        }
    }
    TEST_CASE(
        "agrees with lavapipe on 600,000 random triangles: crossing planes, behind the camera, degenerate, touching") {
        CROFTON_REQUIRE_LAVAPIPE(device);
        Comparison comparison(*device);
        const glm::mat4 matrices[] = {some_matrix(),
                                      some_matrix(Projection::perspective, std::numeric_limits<double>::infinity()),
                                      some_matrix(Projection::orthographic), glm::mat4(1.0f)};
        std::uint64_t seed = 1;
        for (const glm::mat4& matrix : matrices) {
            comparison.check(random_soup(seed++, 50000, 30.0f, 3.0f, 0.0f), matrix);
            comparison.check(random_soup(seed++, 50000, 5.0f, 60.0f, 0.0f), matrix);
            comparison.check(random_soup(seed++, 50000, 2.0f, 2.0f, 0.5f), matrix);
        }
        CHECK(device->validation_messages().empty());
    }
    TEST_CASE(
        "back faces that are culled count all the same in meshes inside the clip planes, of one triangle or 50,000") {
        CROFTON_REQUIRE_LAVAPIPE(device);
        Comparison comparison(*device);
        const glm::mat4 matrix = some_matrix();
        const glm::dvec3 ahead = glm::dvec3(1.0, 2.0, 3.0) + 20.0 * glm::normalize(glm::dvec3(0.3, -0.2, -1.0));
        std::uint64_t seed = 40;
        for (const int count : {1, 5, 400, 2000, 50000}) {
            Soup soup = random_soup(seed++, count, 2.0f, 2.0f, 0.0f);
            Aabb bounds;
            for (glm::vec3& p : soup.positions) bounds.include(p += glm::vec3(ahead));
            REQUIRE(inside_clip_planes(bounds, matrix));
            comparison.upload(soup);
            const auto total = static_cast<std::uint32_t>(soup.indices.size());
            CHECK(comparison.gpu(matrix, 0, total, true, true) == static_cast<std::uint64_t>(count));
        }
        // The promise matters: where some of the mesh is clipped, lavapipe misses culled faces.
        Soup soup = random_soup(seed, 2000, 30.0f, 3.0f, 0.0f);
        comparison.upload(soup);
        CHECK(comparison.gpu(matrix, 0, 6000, true, true) < comparison.gpu(matrix, 0, 6000, true, false));
        CHECK(device->validation_messages().empty());
    }
    TEST_CASE("agrees with lavapipe for stretched, mirrored and far-off placements") {
        CROFTON_REQUIRE_LAVAPIPE(device);
        Comparison comparison(*device);
        Camera camera;
        camera.position = {1e7, 20.0, -1e7};
        camera.forward = {0.5, -0.1, 0.7};
        const ModelToClip to_clip(camera);
        std::mt19937_64 random(7);
        std::uniform_real_distribution<double> scale(-3.0, 3.0), shift(-40.0, 40.0);
        for (int i = 0; i < 20; ++i) {
            const glm::dmat3 linear(scale(random), scale(random), 0.1, 0.2, scale(random), 0.3, scale(random), 1e-3,
                                    scale(random));
            const glm::mat4 matrix =
                to_clip(linear, camera.position + glm::dvec3(shift(random), shift(random), shift(random)));
            comparison.check(random_soup(100 + static_cast<std::uint64_t>(i), 5000, 20.0f, 20.0f, 0.0f), matrix);
        }
    }
}
