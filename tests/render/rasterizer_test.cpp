// SPDX-License-Identifier: MIT
#include <cmath>
#include <crofton/render/clip_space.hpp>
#include <error_of.hpp>
#include <random>

#include "test_device.hpp"

using namespace crofton;
using namespace crofton::render;

namespace {

// Two triangles over the square [-1, 1]² at z = 0, and a small one.
constexpr Vertex kVertices[] = {
    {{-1, -1, 0}, {0, 0, 1}, {1, 0, 0}},   {{1, -1, 0}, {0, 0, 1}, {1, 0, 0}}, {{1, 1, 0}, {0, 0, 1}, {1, 0, 0}},
    {{-1, 1, 0}, {0, 0, 1}, {1, 0, 0}},    {{0, 0, 0}, {0, 0, 1}, {0, 1, 0}},  {{0.25f, 0, 0}, {0, 0, 1}, {0, 1, 0}},
    {{0, 0.25f, 0}, {0, 0, 1}, {0, 1, 0}},
};
constexpr std::uint32_t kIndices[] = {0, 1, 2, 0, 2, 3, 4, 5, 6};

// Looks at the square from z = distance with a view exactly as wide as it.
Camera camera_at(double distance) {
    Camera camera;
    camera.position = {0, 0, distance};
    camera.projection = Projection::orthographic;
    camera.height = 2.0;
    camera.aspect = 1.0;
    camera.near_distance = 0.5;
    camera.far_distance = 100.0;
    return camera;
}

DrawTransform flat_transform(const Camera& camera, const glm::dvec3& translation, const glm::vec3& color,
                             double scale = 1.0) {
    const glm::dmat3 linear(scale);
    DrawTransform transform = draw_transform(ModelToClip(camera)(linear, translation), linear);
    set_tint(transform, color);
    transform.unlit = 1.0f;
    return transform;
}

std::uint64_t count_color(const Image& image, int r, int g, int b) {
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < image.rgba.size(); i += 4)
        count += image.rgba[i] == r && image.rgba[i + 1] == g && image.rgba[i + 2] == b;
    return count;
}

Rasterizer make_rasterizer(Device& device, std::uint32_t size = 64) {
    auto rasterizer = Rasterizer::create(device, {size, size}).value();
    REQUIRE(rasterizer.set_geometry(kVertices, kIndices));
    return rasterizer;
}

}  // namespace

TEST_SUITE("render/rasterizer") {
    TEST_CASE("bad sizes, geometry and ranges are refused by name, and the rasterizer works on") {
        CROFTON_REQUIRE_DEVICE(device);
        CHECK(error_of(Rasterizer::create(*device, {0, 10})).code == ErrorCode::out_of_range);
        CHECK(error_of(Rasterizer::create(*device, {10, 1u << 30})).code == ErrorCode::out_of_range);
        Rasterizer rasterizer = make_rasterizer(*device);
        const std::uint32_t bad_index[] = {0, 1, 7}, two[] = {0, 1};
        CHECK(error_of(rasterizer.set_geometry(kVertices, bad_index)).item == 2);
        CHECK(error_of(rasterizer.set_geometry(kVertices, two)).code == ErrorCode::invalid_argument);
        Image image;
        CHECK(error_of(rasterizer.read_pixels(image)).code == ErrorCode::empty);

        const Camera camera = camera_at(10.0);
        const DrawTransform transform = flat_transform(camera, {}, {0, 0, 1});
        const DrawRange bad_ranges[][2] = {
            {{0, 3, 0}, {3, 9, 0}}, {{0, 3, 0}, {0xfffffffd, 6, 0}}, {{0, 3, 0}, {0, 2, 0}}, {{0, 3, 0}, {0, 3, 1}}};
        for (const auto& ranges : bad_ranges) {
            const auto refused = rasterizer.draw({camera, {&transform, 1}, ranges});
            REQUIRE_FALSE(refused);
            CHECK(error_of(refused).item == 1);
        }
        const DrawRange good{0, 9, 0};
        const auto counters = rasterizer.draw({camera, {&transform, 1}, {&good, 1}}).value();
        CHECK(counters.input_assembly_primitives == 3);
        CHECK(device->validation_messages().empty());
    }
    TEST_CASE("a frame of nothing counts nothing and shows the background, even without geometry") {
        CROFTON_REQUIRE_DEVICE(device);
        auto rasterizer = Rasterizer::create(*device, {32, 16}).value();
        Frame frame{.camera = camera_at(10.0), .transforms = {}, .ranges = {}, .environment = {}};
        frame.environment.sky = false;
        frame.environment.horizon = {0.0f, 1.0f, 0.0f};
        const auto counters = rasterizer.draw(frame).value();
        CHECK(counters.input_assembly_primitives == 0);
        CHECK(counters.clipping_primitives == 0);
        CHECK(counters.samples_passed == 0);
        Image image;
        REQUIRE(rasterizer.read_pixels(image));
        CHECK(image.width == 32);
        CHECK(count_color(image, 0, 255, 0) == 32 * 16);
        CHECK(device->validation_messages().empty());
    }
    TEST_CASE("a square that fills the view covers every pixel, and half of it half of them") {
        CROFTON_REQUIRE_DEVICE(device);
        Rasterizer rasterizer = make_rasterizer(*device);
        const Camera camera = camera_at(10.0);
        const DrawTransform transforms[] = {flat_transform(camera, {}, {0, 0, 1}),
                                            flat_transform(camera, {1, 0, 0}, {1, 1, 0})};
        Frame frame{.camera = camera, .transforms = transforms, .ranges = {}, .environment = {}};
        frame.environment.sky = false;
        const DrawRange whole{0, 6, 0}, right_half{0, 6, 1};
        frame.ranges = {&whole, 1};
        auto counters = rasterizer.draw(frame);
        REQUIRE(counters);
        CHECK(counters->samples_passed == 64 * 64);
        CHECK(counters->clipping_primitives == 2);
        Image image;
        REQUIRE(rasterizer.read_pixels(image));
        CHECK(count_color(image, 0, 0, 255) == 64 * 64);
        frame.ranges = {&right_half, 1};
        counters = rasterizer.draw(frame);
        REQUIRE(counters);
        CHECK(counters->samples_passed == 32 * 64);
        REQUIRE(rasterizer.read_pixels(image));
        CHECK(count_color(image, 255, 255, 0) == 32 * 64);
        CHECK(image.rgba[4 * 63] == 255);  // the right end of the top row
        CHECK(image.rgba[0] != 255);
        CHECK(device->validation_messages().empty());
    }
    TEST_CASE("nearer wins whatever the order, up is up, and tints reach the draw they belong to") {
        CROFTON_REQUIRE_DEVICE(device);
        Rasterizer rasterizer = make_rasterizer(*device);
        const Camera camera = camera_at(10.0);
        // A quarter-size square above the middle, nearer than the full one.
        const DrawTransform transforms[] = {flat_transform(camera, {0, 0.5, 1}, {1, 0, 0}, 0.25),
                                            flat_transform(camera, {}, {0, 0, 1})};
        const DrawRange near_first[] = {{0, 6, 0}, {0, 6, 1}}, far_first[] = {{0, 6, 1}, {0, 6, 0}};
        for (const auto& ranges : {std::span(near_first), std::span(far_first)}) {
            Frame frame{.camera = camera, .transforms = transforms, .ranges = ranges, .environment = {}};
            frame.environment.sky = false;
            REQUIRE(rasterizer.draw(frame));
            Image image;
            REQUIRE(rasterizer.read_pixels(image));
            CHECK(count_color(image, 255, 0, 0) == 16 * 16);
            CHECK(count_color(image, 0, 0, 255) == 64 * 64 - 16 * 16);
            const std::size_t above_middle = 4 * (16 * 64 + 32);
            CHECK(image.rgba[above_middle] == 255);
        }
        CHECK(device->validation_messages().empty());
    }
    TEST_CASE("ranges that continue each other become one draw, others do not, and the counts are the same") {
        CROFTON_REQUIRE_DEVICE(device);
        Rasterizer rasterizer = make_rasterizer(*device);
        const Camera camera = camera_at(10.0);
        const DrawTransform transforms[] = {flat_transform(camera, {}, {0, 0, 1}),
                                            flat_transform(camera, {}, {1, 0, 0})};
        const DrawRange mergeable[] = {{0, 3, 0}, {3, 0, 1}, {3, 3, 0}, {6, 3, 0}},
                        separate[] = {{0, 3, 0}, {6, 3, 0}, {3, 3, 1}};
        const auto one = rasterizer.draw({camera, transforms, mergeable});
        CHECK(rasterizer.draw_count() == 1);
        const auto three = rasterizer.draw({camera, transforms, separate});
        // Software devices have the short draws of a transform copied together.
        CHECK(rasterizer.draw_count() == (device->counts_exactly() ? 2 : 3));
        REQUIRE(one);
        REQUIRE(three);
        CHECK(one->clipping_primitives == three->clipping_primitives);
    }
    TEST_CASE("short draws show and count the same in one copy as on their own, in the order given") {
        CROFTON_REQUIRE_DEVICE(device);
        Rasterizer rasterizer = make_rasterizer(*device, 64);
        const Camera camera = camera_at(10.0);
        std::mt19937 random(7);
        const auto number = [&](std::uint32_t below) { return static_cast<std::uint32_t>(random() % below); };
        Vector<Vertex> vertices;
        Vector<std::uint32_t> indices;
        // Many at the same depth, so that the order shows.
        for (std::uint32_t i = 0; i < 3 * 4000; ++i) {
            vertices.push_back(kVertices[0]);
            vertices.back().position = {0.02f * float(number(100)) - 1.0f, 0.02f * float(number(100)) - 1.0f,
                                        0.05f * float(i / 3 % 2)};
            vertices.back().color = {float(number(9)) / 8.0f, float(number(9)) / 8.0f, float(number(9)) / 8.0f};
            indices.push_back(i);
        }
        REQUIRE(rasterizer.set_geometry(vertices, indices));
        Vector<DrawRange> ranges;
        Vector<DrawTransform> transforms(2, flat_transform(camera, {}, {1, 1, 1}));
        transforms[0].tint_share = transforms[1].tint_share = 0.0f;
        // Runs of short draws, long ones between them; the last refer to what is drawn before.
        for (std::uint32_t i = 0; i < 1500; ++i) {
            const std::uint32_t most = i / 100 % 3 == 0 ? 300 : 5, first = number(4000 - most);
            ranges.push_back({3 * first, 3 * (1 + number(most)), i / 250 % 2, i / 130 % 2 == 0, i / 70 % 2 == 0});
        }
        // Each on its own: no two that follow each other have the same transform.
        Vector<DrawTransform> own;
        Vector<DrawRange> separate = ranges;
        for (DrawRange& range : separate) {
            own.push_back(transforms[range.transform]);
            range.transform = static_cast<std::uint32_t>(own.size() - 1);
        }
        for (const bool sky : {true, false}) {
            Frame frame{.camera = camera, .transforms = own, .ranges = separate, .environment = {}};
            frame.environment.sky = sky;
            const auto expected = rasterizer.draw(frame).value();
            CHECK(rasterizer.draw_count() == 1500);
            Image one, other;
            REQUIRE(rasterizer.read_pixels(one));
            frame.transforms = transforms, frame.ranges = ranges;
            frame.wire_ranges = std::span(ranges).first(1);
            const auto counters = rasterizer.draw(frame);
            frame.wire_ranges = {};
            REQUIRE(rasterizer.draw(frame));
            REQUIRE(counters);
            CHECK((rasterizer.draw_count() < 600) == device->counts_exactly());
            REQUIRE(rasterizer.read_pixels(other));
            CHECK(one.rgba == other.rgba);
            CHECK(counters->input_assembly_primitives == expected.input_assembly_primitives);
            CHECK(counters->clipping_primitives == expected.clipping_primitives);
            CHECK(counters->samples_passed == expected.samples_passed);
        }
        CHECK(device->validation_messages().empty());
    }
    TEST_CASE("5,000 draws, more than one multi-draw call takes, each use their own transform") {
        CROFTON_REQUIRE_DEVICE(device);
        Rasterizer rasterizer = make_rasterizer(*device, 128);
        const Camera camera = camera_at(10.0);
        // Draw i colours pixel (i mod 128, i / 128) by its own index.
        Vector<DrawTransform> transforms;
        Vector<DrawRange> ranges;
        const double pixel = 2.0 / 128;
        for (std::uint32_t i = 0; i < 5000; ++i) {
            const glm::dvec3 place((i % 128 + 0.5) * pixel - 1.0, 1.0 - (i / 128 + 0.5) * pixel, 0.0);
            const glm::vec3 display(static_cast<float>(i % 256) / 255.0f, static_cast<float>(i / 256) / 255.0f, 1.0f);
            transforms.push_back(flat_transform(camera, place, display * display, pixel / 2));
            ranges.push_back({0, 6, i});
        }
        Frame frame{.camera = camera, .transforms = transforms, .ranges = ranges, .environment = {}};
        const auto counters = rasterizer.draw(frame).value();
        CHECK(rasterizer.draw_count() == 5000);
        CHECK(counters.input_assembly_primitives == 10000);
        CHECK(counters.samples_passed == 5000);
        Image image;
        REQUIRE(rasterizer.read_pixels(image));
        std::uint32_t wrong = 0;
        for (std::uint32_t i = 0; i < 5000; ++i)
            wrong += image.rgba[4 * i] != i % 256 || image.rgba[4 * i + 1] != i / 256 || image.rgba[4 * i + 2] != 255;
        CHECK(wrong == 0);
        CHECK(device->validation_messages().empty());
    }
    TEST_CASE("back faces of one-sided ranges are counted but not seen, whether culled or dropped by the shader") {
        CROFTON_REQUIRE_DEVICE(device);
        Rasterizer rasterizer = make_rasterizer(*device);
        const std::uint32_t indices[] = {0, 1, 2, 0, 2, 3, 0, 2, 1, 0, 3, 2};  // the square's front, then its back
        REQUIRE(rasterizer.set_geometry(kVertices, indices));
        const Camera camera = camera_at(10.0);
        const DrawTransform transforms[] = {flat_transform(camera, {}, {0, 0, 1}),
                                            flat_transform(camera, {0, 0, 1}, {1, 0, 0}, 0.5)};
        for (const bool unclipped : {false, true}) {
            // A nearer half-size square, seen from its back, hides nothing.
            const DrawRange ranges[] = {{6, 6, 1, true, unclipped}, {0, 6, 0, true, unclipped}};
            Frame frame{.camera = camera, .transforms = transforms, .ranges = ranges, .environment = {}};
            frame.environment.sky = false;
            const auto counters = rasterizer.draw(frame).value();
            CHECK(rasterizer.draw_count() == 2);
            CHECK(counters.input_assembly_primitives == 4);
            CHECK(counters.clipping_invocations == 4);
            CHECK(counters.clipping_primitives == 4);
            CHECK(counters.samples_passed == 64 * 64);
            Image image;
            REQUIRE(rasterizer.read_pixels(image));
            CHECK(count_color(image, 0, 0, 255) == 64 * 64);
        }
        CHECK(device->validation_messages().empty());
    }
    TEST_CASE("ranges keep what they say of their faces when they are merged") {
        CROFTON_REQUIRE_DEVICE(device);
        Rasterizer rasterizer = make_rasterizer(*device);
        const Camera camera = camera_at(10.0);
        const DrawTransform transform = flat_transform(camera, {}, {0, 0, 1});
        const DrawRange alike[] = {{0, 3, 0, true, true}, {3, 3, 0, true, true}, {6, 3, 0, true, true}},
                        unlike[] = {{0, 3, 0, true, true}, {3, 3, 0, false, true}, {6, 3, 0, true, false}};
        REQUIRE(rasterizer.draw({camera, {&transform, 1}, alike}));
        CHECK(rasterizer.draw_count() == 1);
        REQUIRE(rasterizer.draw({camera, {&transform, 1}, unlike}));
        CHECK(rasterizer.draw_count() == 3);
    }
    TEST_CASE("a frame of 90,000 triangles, more than one portion, counts and shows as one") {
        CROFTON_REQUIRE_DEVICE(device);
        Rasterizer rasterizer = make_rasterizer(*device);
        const Camera camera = camera_at(10.0);
        const DrawTransform transforms[] = {flat_transform(camera, {0, 0, 1}, {0, 1, 0}),
                                            flat_transform(camera, {}, {0, 0, 1})};
        Vector<DrawRange> ranges(45'000, {6, 3, 0});
        ranges.push_back({0, 6, 1});
        ranges.insert(ranges.end(), 45'000, {6, 3, 0});
        Frame frame{.camera = camera, .transforms = transforms, .ranges = ranges, .environment = {}};
        frame.environment.sky = false;
        const auto counters = rasterizer.draw(frame).value();
        CHECK(counters.input_assembly_primitives == 90'002);
        CHECK(counters.clipping_primitives == 90'002);
        CHECK(counters.samples_passed == 64 * 64);  // the small triangle's first, then the rest of the square
        Image image;
        REQUIRE(rasterizer.read_pixels(image));
        const std::uint64_t green = count_color(image, 0, 255, 0);
        CHECK(green > 20);
        CHECK(count_color(image, 0, 0, 255) == 64 * 64 - green);
        CHECK(device->validation_messages().empty());
    }
    TEST_CASE("lines, wires and sky are seen but not counted") {
        CROFTON_REQUIRE_DEVICE(device);
        Rasterizer rasterizer = make_rasterizer(*device);
        const Camera camera = camera_at(10.0);
        const DrawTransform transforms[] = {flat_transform(camera, {}, {0, 0, 1}),
                                            flat_transform(camera, {}, {1, 1, 1})};
        const DrawRange whole{0, 6, 0}, wire{0, 6, 1};
        const LineVertex lines[] = {{{-1, 0.51f, -8}, 0xff00ff00u}, {{1, 0.51f, -8}, 0xff00ff00u}};
        const Frame frame{camera, transforms, {&whole, 1}, {&wire, 1}, lines, {}};
        const auto counters = rasterizer.draw(frame).value();
        CHECK(counters.input_assembly_primitives == 2);
        CHECK(counters.clipping_primitives == 2);
        CHECK(counters.samples_passed == 64 * 64);
        Image image;
        REQUIRE(rasterizer.read_pixels(image));
        CHECK(count_color(image, 0, 255, 0) == 64);      // one row
        CHECK(count_color(image, 255, 255, 255) >= 60);  // at least the square's diagonal
        CHECK(device->validation_messages().empty());
    }
    TEST_CASE("resizing keeps the geometry, and many sizes leave no message") {
        CROFTON_REQUIRE_DEVICE(device);
        Rasterizer rasterizer = make_rasterizer(*device);
        CHECK_FALSE(rasterizer.resize(0, 5));
        const Camera camera = camera_at(10.0);
        const DrawTransform transform = flat_transform(camera, {}, {0, 0, 1});
        const DrawRange whole{0, 6, 0};
        for (const std::uint32_t size : {1u, 7u, 64u, 333u, 64u}) {
            REQUIRE(rasterizer.resize(size, size));
            const auto counters = rasterizer.draw({camera, {&transform, 1}, {&whole, 1}}).value();
            CHECK(counters.samples_passed == std::uint64_t{size} * size);
        }
        CHECK(device->validation_messages().empty());
    }
    TEST_CASE("a lower resolution draws fewer pixels of the same triangles, and fills the picture with them") {
        CROFTON_REQUIRE_DEVICE(device);
        Rasterizer rasterizer = make_rasterizer(*device);
        for (const float bad : {0.0f, -1.0f, 1.5f, std::nanf("")}) CHECK_FALSE(rasterizer.resize(64, 64, 0, bad));
        const Camera camera = camera_at(10.0);
        const DrawTransform transform = flat_transform(camera, {}, {0, 0, 1});
        const DrawRange whole{0, 6, 0};
        for (const auto& [resolution, drawn] : {std::pair{0.5f, 32u}, {0.25f, 16u}, {0.001f, 1u}, {1.0f, 64u}}) {
            REQUIRE(rasterizer.resize(64, 64, 0, resolution));
            CHECK(rasterizer.width() == 64);
            Image image;
            CHECK_FALSE(rasterizer.read_pixels(image));
            const auto counters = rasterizer.draw({camera, {&transform, 1}, {&whole, 1}}).value();
            CHECK(counters.samples_passed == std::uint64_t{drawn} * drawn);
            CHECK(counters.input_assembly_primitives == 2);
            CHECK(counters.clipping_primitives == 2);
            REQUIRE(rasterizer.read_pixels(image));
            CHECK(image.width == 64);
            CHECK(count_color(image, 0, 0, 255) == 64 * 64);
        }
        CHECK(device->validation_messages().empty());
    }
    TEST_CASE("the same frame gives the same pixels") {
        CROFTON_REQUIRE_DEVICE(device);
        Rasterizer rasterizer = make_rasterizer(*device);
        Camera camera;
        camera.position = {0.3, 0.2, 2.0};
        const DrawTransform transform = draw_transform(ModelToClip(camera)(glm::dmat3(1.0), {}), glm::dmat3(1.0));
        const DrawRange whole{0, 9, 0};
        Image first, second;
        REQUIRE(rasterizer.draw({camera, {&transform, 1}, {&whole, 1}}));
        REQUIRE(rasterizer.read_pixels(first));
        REQUIRE(rasterizer.draw({camera, {&transform, 1}, {&whole, 1}}));
        REQUIRE(rasterizer.read_pixels(second));
        CHECK(first.rgba == second.rgba);
    }
}
