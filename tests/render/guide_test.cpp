// SPDX-License-Identifier: MIT
// The example of docs/render.md, compiled and run.
#include <crofton/render/clip_space.hpp>
#include <cstdio>

#include "test_device.hpp"

namespace {

int report(const crofton::Error& error) {
    std::printf("%s\n", error.message.c_str());
    return 1;
}

int draw_crate(const crofton::TriangleMesh& crate_mesh, const glm::dvec3& translation,
               crofton::render::GpuCounters& result) {
    const crofton::Camera camera;
    const glm::dmat3 linear(1.0);
    // clang-format off
    using namespace crofton;
    using namespace crofton::render;

    Result<Device> device = Device::create({.kind = DeviceKind::cpu});  // lavapipe: the same counts everywhere
    if (!device) return report(device.error());                          // what to install
    Result<Rasterizer> rasterizer = Rasterizer::create(*device, {.width = 320, .height = 200});
    if (!rasterizer) return report(rasterizer.error());

    // Once: all meshes in one buffer.
    Vector<Vertex> vertices;
    Vector<std::uint32_t> indices;
    const IndexRange crate = append_mesh(crate_mesh, glm::vec3(0.6f, 0.4f, 0.2f), vertices, indices);
    if (const auto set = rasterizer->set_geometry(vertices, indices); !set) return report(set.error());

    // Each frame: a transform and a range for each visible object.
    const ModelToClip to_clip(camera);
    const DrawTransform transforms[] = {draw_transform(to_clip(linear, translation), linear)};
    const DrawRange ranges[] = {{.first_index = crate.first_index, .index_count = crate.index_count, .transform = 0}};
    const Result<GpuCounters> counters =
        rasterizer->draw({.camera = camera, .transforms = transforms, .ranges = ranges});
    if (!counters) return report(counters.error());
    Image image;
    if (const auto read = rasterizer->read_pixels(image); !read) return report(read.error());
    // clang-format on
    CHECK(image.rgba.size() == 320u * 200u * 4u);
    result = *counters;
    return 0;
}

}  // namespace

TEST_SUITE("render/guide") {
    TEST_CASE("the example of the guide counts the triangles of a crate in view, and of one behind the camera") {
        CROFTON_REQUIRE_LAVAPIPE(device);
        crofton::TriangleMesh square;  // two triangles across −z, a metre wide
        square.positions = {{-0.5f, -0.5f, 0.0f}, {0.5f, -0.5f, 0.0f}, {0.5f, 0.5f, 0.0f}, {-0.5f, 0.5f, 0.0f}};
        square.indices = {0, 1, 2, 0, 2, 3};
        crofton::render::GpuCounters counters;
        REQUIRE(draw_crate(square, {0.0, 0.0, -5.0}, counters) == 0);
        CHECK(counters.input_assembly_primitives == 2);
        CHECK(counters.clipping_primitives == 2);
        CHECK(counters.samples_passed > 0);
        REQUIRE(draw_crate(square, {0.0, 0.0, 5.0}, counters) == 0);
        CHECK(counters.input_assembly_primitives == 2);
        CHECK(counters.clipping_primitives == 0);
        CHECK(counters.samples_passed == 0);
    }
}
