// SPDX-License-Identifier: MIT
// Prints digests of answers of the C API. The same program is compiled for this machine and for WebAssembly. That of
// triangulations is published in tests/determinism/triangulate_test.cpp. With `bench`: times of culling 100,000 boxes.
// With `bench SET FILE`: on x86 with no more than that instruction set (SSE4, AVX2, all); writes what was asked to
// FILE, for bindings/web/bench.js.
#include <crofton/capi/bake.h>
#include <crofton/capi/crofton.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#if defined(__x86_64__)
#include <hwy/targets.h>
#endif

#include "../../../tests/determinism/crowd.hpp"
#include "../../../tests/determinism/digest.hpp"

using namespace crofton;
using namespace crofton::test;

namespace {

void require_ok(crofton_status status) {
    if (status == CROFTON_OK) return;
    std::printf("%s\n", crofton_last_error());
    std::exit(1);
}

std::vector<crofton_box> boxes_of(const std::vector<Obb>& from) {
    static_assert(sizeof(crofton_box) == sizeof(Obb));
    std::vector<crofton_box> boxes(from.size());
    std::memcpy(boxes.data(), from.data(), from.size() * sizeof(Obb));
    return boxes;
}

struct View {
    crofton_frustum frustum;
};

crofton_view_request request_of(const View& view) {
    crofton_view_request request = crofton_default_view_request();
    request.volume = &view.frustum;
    return request;
}

View view_of(const Camera& camera) {
    crofton_camera given{};
    given.size = sizeof given;
    for (int i = 0; i < 3; ++i) {
        given.position[i] = camera.position[i];
        given.forward[i] = camera.forward[i];
        given.up[i] = camera.up[i];
    }
    given.projection = camera.projection == Projection::orthographic ? 1 : 0;
    given.fov_y = camera.fov_y, given.height = camera.height, given.aspect = camera.aspect;
    given.near_distance = camera.near_distance, given.far_distance = camera.far_distance;
    View view{};
    view.frustum.size = sizeof view.frustum;
    require_ok(crofton_frustum_from_camera(&given, &view.frustum));
    return view;
}

std::uint64_t culled(double offset) {
    Digest digest;
    Random random(11);
    const std::vector<crofton_box> boxes = boxes_of(crowd(3000, offset, 12));
    crofton_tree* tree = nullptr;
    crofton_view_result* visible = nullptr;
    require_ok(crofton_tree_create(boxes.data(), nullptr, boxes.size(), nullptr, &tree));
    require_ok(crofton_view_result_create(&visible));
    std::size_t seen = 0;
    for (int k = 0; k < 50; ++k) {
        const View view = view_of(random_camera(random, offset));
        for (const double x : view.frustum.origin) digest.add(x);
        for (const crofton_plane& plane : view.frustum.planes)
            for (const double x : {plane.normal[0], plane.normal[1], plane.normal[2], plane.offset}) digest.add(x);
        std::vector<std::uint8_t> verdicts(boxes.size());
        require_ok(crofton_classify(&view.frustum, boxes.data(), boxes.size(), verdicts.data()));
        digest.add(verdicts);
        for (const std::uint32_t tree_order : {0u, 1u}) {
            crofton_view_request request = request_of(view);
            request.tree_order = tree_order;
            require_ok(crofton_tree_view(tree, &request, nullptr, visible));
            const std::uint32_t* ids = nullptr;
            std::size_t count = 0;
            require_ok(crofton_view_result_ids(visible, &ids, &count, nullptr, nullptr));
            for (std::size_t i = 0; i < count; ++i) digest.add(ids[i]);
            seen += count;
        }
    }
    require_ok(crofton_view_result_destroy(visible));
    require_ok(crofton_tree_destroy(tree));
    if (seen < 1000) std::printf("too little is seen: %zu\n", seen), std::exit(1);
    return digest.value();
}

std::uint64_t fitted() {
    Digest digest;
    Random random(31);
    for (int cloud = 0; cloud < 6; ++cloud) {
        std::vector<float> points;
        for (int i = 0; i < 300; ++i) {
            const glm::dvec3 p = sampling::direction(random.point<2>());
            for (int k = 0; k < 3; ++k) points.push_back(static_cast<float>((k + cloud) * p[k]));
        }
        for (const std::uint32_t quality : {0u, 1u, 2u}) {
            crofton_fit_options options{sizeof options, quality, {0, 0, 0}};
            options.criterion = crofton_default_fit_options().criterion;
            crofton_box box;
            require_ok(crofton_fit_points(points.data(), 300, 0, &options, &box));
            for (const double x : box.center) digest.add(x);
            for (const float x : box.axes) digest.add(x);
            for (const float x : box.half_extents) digest.add(x);
        }
    }
    return digest.value();
}

std::uint64_t triangulated() {
    Digest digest;
    crofton_triangulator* triangulator = nullptr;
    require_ok(crofton_triangulator_create(&triangulator));
    for (const Polygon& polygon : polygons())
        for (const std::uint32_t method : {0u, 1u, 2u}) {
            const crofton_polygon given{sizeof given, &polygon.points[0].x, polygon.points.size(),
                                        polygon.ring_ends.data(), polygon.ring_ends.size()};
            crofton_triangulation result{};
            result.size = sizeof result;
            require_ok(crofton_triangulate(triangulator, &given, method, &result));
            std::vector<std::array<std::uint32_t, 3>> triangles(result.triangle_count);
            std::memcpy(triangles.data(), result.indices, 12 * result.triangle_count);
            digest.add(triangles).add(result.weight).add(result.gap);
        }
    require_ok(crofton_triangulator_destroy(triangulator));
    return digest.value();
}

// The boxes, then 52 doubles a view: how many planes, the origin, the planes.
void write_questions(const char* path, const std::vector<crofton_box>& boxes, const std::vector<View>& views) {
    std::FILE* file = std::fopen(path, "wb");
    if (file == nullptr) std::printf("cannot write %s\n", path), std::exit(1);
    std::fwrite(boxes.data(), sizeof boxes[0], boxes.size(), file);
    for (const View& view : views) {
        std::vector<double> numbers{static_cast<double>(view.frustum.plane_count)};
        numbers.insert(numbers.end(), view.frustum.origin, view.frustum.origin + 3);
        for (const crofton_plane& plane : view.frustum.planes)
            for (const double x : {plane.normal[0], plane.normal[1], plane.normal[2], plane.offset})
                numbers.push_back(x);
        numbers.resize(52);
        std::fwrite(numbers.data(), 8, numbers.size(), file);
    }
    std::fclose(file);
}

void bench(const char* path) {
    const std::vector<crofton_box> boxes = boxes_of(crowd(100000, 0.0, 12));
    crofton_tree* tree = nullptr;
    crofton_view_result* visible = nullptr;
    require_ok(crofton_tree_create(boxes.data(), nullptr, boxes.size(), nullptr, &tree));
    require_ok(crofton_view_result_create(&visible));
    Random random(5);
    std::vector<View> views;
    for (int k = 0; k < 20; ++k) views.push_back(view_of(random_camera(random, 0.0)));
    if (path != nullptr) write_questions(path, boxes, views);
    double least[2] = {1e9, 1e9};
    std::size_t seen = 0;
    for (int repeat = 0; repeat < 40; ++repeat)
        for (int kind = 0; kind < 2; ++kind) {
            seen = 0;
            const auto from = std::chrono::steady_clock::now();
            for (const View& view : views) {
                const crofton_view_request request = request_of(view);
                require_ok(kind == 0
                               ? crofton_tree_view(tree, &request, nullptr, visible)
                               : crofton_view_boxes(boxes.data(), nullptr, boxes.size(), &request, nullptr, visible));
                const std::uint32_t* ids = nullptr;
                std::size_t count = 0;
                require_ok(crofton_view_result_ids(visible, &ids, &count, nullptr, nullptr));
                seen += count;
            }
            const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - from;
            least[kind] = (std::min)(least[kind], took.count() / 20);
        }
    std::printf("tree %.1f us, list %.1f us a view, %zu seen\n", least[0], least[1], seen);
}

}  // namespace

int main(int count, char** given) {
#if defined(__x86_64__)
    // Lower bits are of better sets. Kernels do not have all of them: each takes the best that is left.
    const bool only_sse4 = count > 2 && std::strcmp(given[2], "SSE4") == 0,
               only_avx2 = count > 2 && std::strcmp(given[2], "AVX2") == 0;
    if (only_sse4 || only_avx2)
        hwy::SetSupportedTargetsForTest(hwy::SupportedTargets() & ~((only_sse4 ? HWY_SSE4 : HWY_AVX2) - 1));
#endif
    if (count > 1) return bench(count > 3 ? given[3] : nullptr), 0;
    std::printf("cull %llx\nfar %llx\nfit %llx\ntriangulate %llx\n", static_cast<unsigned long long>(culled(0.0)),
                static_cast<unsigned long long>(culled(1e6)), static_cast<unsigned long long>(fitted()),
                static_cast<unsigned long long>(triangulated()));
}
