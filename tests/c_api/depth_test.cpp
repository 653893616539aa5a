// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <bit>
#include <crofton/depth/depth_culler.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/mesh.hpp>
#include <cstddef>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <random>

#include "../box_mesh.hpp"
#include "handles.hpp"

using namespace crofton::capi_test;
using crofton::TriangleMesh;

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

// n × n squares over [-half, half]² of the plane z = 0, seen from +z.
TriangleMesh wall(std::uint32_t n, float half) {
    TriangleMesh mesh;
    for (std::uint32_t j = 0; j <= n; ++j)
        for (std::uint32_t i = 0; i <= n; ++i)
            mesh.positions.push_back({half * (2.0f * static_cast<float>(i) / static_cast<float>(n) - 1.0f),
                                      half * (2.0f * static_cast<float>(j) / static_cast<float>(n) - 1.0f), 0.0f});
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t p = j * (n + 1) + i, q = p + n + 1;
            for (const std::uint32_t v : {p, p + 1, q + 1, p, q + 1, q}) mesh.indices.push_back(v);
        }
    return mesh;
}

crofton_mesh to_c(const TriangleMesh& mesh) {
    return {sizeof(crofton_mesh), &mesh.positions[0].x, mesh.positions.size(),
            mesh.indices.data(),  mesh.indices.size(),  "a mesh"};
}

ClusteredMesh cut(const TriangleMesh& mesh, std::uint32_t max_triangles = 0) {
    const crofton_mesh given = to_c(mesh);
    crofton_clustered_mesh* clustered = nullptr;
    REQUIRE(crofton_clustered_mesh_create(&given, max_triangles, &clustered) == CROFTON_OK);
    return ClusteredMesh(clustered);
}

crofton_clusters get(const ClusteredMesh& mesh) {
    crofton_clusters clusters{};
    REQUIRE(crofton_clustered_mesh_get(mesh.get(), &clusters) == CROFTON_OK);
    return clusters;
}

std::span<const crofton_cluster> clusters_of(const ClusteredMesh& mesh) {
    return {get(mesh).clusters, get(mesh).cluster_count};
}

std::vector<std::uint32_t> order_of(const ClusteredMesh& mesh) {
    return {get(mesh).triangle_order, get(mesh).triangle_order + get(mesh).triangle_count};
}

// By the default camera, which looks along -z from the origin.
glm::mat4 to_clip(const glm::dmat4& place, crofton::DepthRange depth = crofton::DepthRange::reversed_zero_to_one) {
    return glm::mat4(crofton::world_to_clip(crofton::Camera{}, depth) * place);
}
glm::dmat4 at(double x, double y, double z) {
    return glm::translate(glm::dmat4(1.0), glm::dvec3(x, y, z));
}

crofton_depth_object object_of(const ClusteredMesh& mesh, const glm::mat4& matrix) {
    crofton_depth_object object = crofton_default_depth_object();
    object.mesh = mesh.get();
    std::memcpy(object.to_clip, &matrix[0][0], sizeof object.to_clip);
    return object;
}

crofton_picture_view picture_of(std::uint32_t width, std::uint32_t height) {
    crofton_picture_view picture = crofton_default_picture_view();
    picture.width = width;
    picture.height = height;
    return picture;
}

std::span<const crofton_visible_cluster> find(const DepthCuller& culler, std::span<const crofton_depth_object> objects,
                                              const crofton_picture_view& picture,
                                              crofton_depth_statistics* statistics = nullptr,
                                              const crofton_jobs* jobs = nullptr) {
    const crofton_visible_cluster* clusters = nullptr;
    std::size_t count = 0;
    REQUIRE(crofton_depth_culler_find_visible(culler.get(), objects.data(), objects.size(), &picture, jobs, &clusters,
                                              &count, statistics) == CROFTON_OK);
    return {clusters, count};
}

// A job system that runs the last range first; `user` counts the ranges.
void run_backwards(void* user, std::size_t count, std::size_t grain, crofton_range_task task, void* data) {
    for (std::size_t range = (count + grain - 1) / grain; range-- > 0;) {
        task(data, range * grain, std::min(count, (range + 1) * grain), static_cast<std::uint32_t>(range % 3));
        ++*static_cast<std::size_t*>(user);
    }
}

int listed_of(std::span<const crofton_visible_cluster> found, std::uint32_t object) {
    int triangles = 0;
    for (const crofton_visible_cluster& c : found)
        if (c.object == object) triangles += std::popcount(c.triangles);
    return triangles;
}

}  // namespace

TEST_SUITE("capi/depth") {
    TEST_CASE("the order holds each triangle once, and each cluster's box holds its triangles") {
        const TriangleMesh mesh = wall(20, 3.0f);
        for (const std::uint32_t most : {1u, 7u, 64u}) {
            const ClusteredMesh clustered = cut(mesh, most);
            const std::vector<std::uint32_t> order = order_of(clustered);
            std::vector<std::uint32_t> sorted = order;
            std::sort(sorted.begin(), sorted.end());
            REQUIRE(order.size() == 800);
            for (std::uint32_t t = 0; t < 800; ++t) CHECK(sorted[t] == t);
            std::vector<std::uint32_t> permuted(mesh.indices.size());
            const crofton_clusters all = get(clustered);
            REQUIRE(crofton_permute_triangles(&all, mesh.indices.data(), mesh.indices.size(), permuted.data()) ==
                    CROFTON_OK);
            std::uint32_t next = 0;
            crofton_cluster_box box{};
            for (std::size_t i = 0; i < all.cluster_count; ++i) {
                const crofton_cluster& c = all.clusters[i];
                CHECK(c.first_triangle == next);
                CHECK((c.triangle_count >= 1 && c.triangle_count <= most));
                next += c.triangle_count;
                REQUIRE(crofton_clustered_mesh_box(clustered.get(), i, &box) == CROFTON_OK);
                for (std::uint32_t k = 3 * c.first_triangle; k < 3 * next; ++k) {
                    CHECK(permuted[k] == mesh.indices[3 * order[k / 3] + k % 3]);
                    // One edge of a flat box is nearly 0: its extent along an axis is the sum of the edges'.
                    const glm::vec3 p = mesh.positions[permuted[k]];
                    for (int axis = 0; axis < 3; ++axis) {
                        double extent = 0.0;
                        for (int edge = 0; edge < 3; ++edge)
                            extent += std::abs(double{box.half_edges[3 * edge + axis]});
                        CHECK(std::abs(double{p[axis]} - double{box.center[axis]}) <= extent);
                    }
                }
            }
            CHECK(next == 800);
            CHECK(crofton_clustered_mesh_box(clustered.get(), all.cluster_count, &box) == CROFTON_OUT_OF_RANGE);
            CHECK(crofton_clustered_mesh_box(clustered.get(), 0, nullptr) == CROFTON_INVALID_ARGUMENT);
        }
    }

    TEST_CASE("C lists the same clusters as C++, in every depth range and with the host's jobs") {
        std::mt19937 random(9);
        const auto uniform = [&](double low, double high) {
            return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
        };
        const std::array<TriangleMesh, 3> meshes{crofton::testing::cube_mesh(0.5f), wall(30, 4.0f), wall(8, 0.7f)};
        std::vector<ClusteredMesh> in_c;
        std::vector<crofton::depth::ClusteredMesh> in_cpp;
        for (const TriangleMesh& mesh : meshes) {
            in_c.push_back(cut(mesh, 24));
            in_cpp.push_back(
                crofton::depth::ClusteredMesh::cut(mesh.positions, mesh.indices, {.max_triangles = 24}).value());
            const auto& same = in_cpp.back();
            const auto clusters = clusters_of(in_c.back());
            REQUIRE(clusters.size() == same.clusters().size());
            for (std::size_t c = 0; c < clusters.size(); ++c) {
                CHECK(clusters[c].first_triangle == same.clusters()[c].first_triangle);
                CHECK(clusters[c].triangle_count == same.clusters()[c].triangle_count);
            }
            const auto order = order_of(in_c.back());
            CHECK(std::equal(order.begin(), order.end(), same.triangle_order().begin(), same.triangle_order().end()));
        }
        const DepthCuller culler = make_depth_culler();
        crofton::depth::DepthCuller same;
        for (std::size_t round = 0; round < 6; ++round) {
            const auto depth = std::array{crofton::DepthRange::reversed_zero_to_one, crofton::DepthRange::zero_to_one,
                                          crofton::DepthRange::minus_one_to_one}[round / 2];
            const bool by_jobs = round % 2 == 1;
            CAPTURE(round);
            std::vector<crofton_depth_object> objects;
            std::vector<crofton::depth::DepthObject> same_objects;
            for (int i = 0; i < 60; ++i) {
                const std::size_t which = random() % 3;
                const double z = uniform(-30.0, -3.0);
                const double x = uniform(-0.6, 0.6) * z, y = uniform(-0.4, 0.4) * z;
                const double angle = uniform(-3.1, 3.1);
                const glm::mat4 matrix = to_clip(glm::rotate(at(x, y, z), angle, glm::dvec3(0, 1, 0)), depth);
                crofton_depth_object object = object_of(in_c[which], matrix);
                object.one_sided = random() % 2;
                object.hides = random() % 4 != 0;
                object.position_error = random() % 3 == 0 ? 0.25f : 0.0f;
                objects.push_back(object);
                same_objects.push_back(
                    {&in_cpp[which], matrix, object.one_sided == 1, object.hides == 1, object.position_error});
            }
            crofton_picture_view picture = picture_of(192, 108);
            picture.depth = static_cast<std::uint32_t>(depth);
            picture.samples = 1u << random() % 3;
            auto statistics = sized<crofton_depth_statistics>();
            std::size_t ranges = 0;
            const crofton_jobs jobs{sizeof jobs, &ranges, 3, run_backwards};
            const auto found = find(culler, objects, picture, &statistics, by_jobs ? &jobs : nullptr);
            CHECK((ranges > 3) == by_jobs);
            const auto expected = same.find_visible(same_objects, {192, 108, depth, picture.samples}).value();
            REQUIRE(found.size() == expected.size());
            REQUIRE(found.size() > 20);
            CHECK(std::memcmp(found.data(), expected.data(), found.size_bytes()) == 0);
            CHECK(statistics.objects_listed == same.statistics().objects_listed);
            CHECK(statistics.objects_asked == same.statistics().objects_asked);
            CHECK(statistics.clusters_asked == same.statistics().clusters_asked);
            CHECK(statistics.clusters_drawn == same.statistics().clusters_drawn);
            CHECK(statistics.triangles_drawn == same.statistics().triangles_drawn);
            CHECK(statistics.triangles_listed == same.statistics().triangles_listed);
            CHECK(statistics.triangles_listed < statistics.triangles_drawn);
            for (std::uint32_t y = 0; y < 108; ++y)
                for (std::uint32_t x = 0; x < 192; ++x) {
                    float nearness = 0.0f;
                    REQUIRE(crofton_depth_culler_nearness(culler.get(), x, y, &nearness) == CROFTON_OK);
                    if (nearness != same.nearness(x, y)) FAIL_CHECK("nearness at " << x << ", " << y);
                }
        }
    }

    TEST_CASE("a wall hides what stands behind it, unless it does not hide, faces away or lies anywhere") {
        const TriangleMesh large = wall(10, 4.0f), small = wall(4, 1.0f);
        const ClusteredMesh front = cut(large), behind = cut(small);
        const DepthCuller culler = make_depth_culler();
        const crofton_picture_view picture = picture_of(320, 180);
        std::vector<crofton_depth_object> objects{object_of(front, to_clip(at(0, 0, -5))),
                                                  object_of(behind, to_clip(at(0, 0, -10)))};
        auto found = find(culler, objects, picture);
        CHECK(listed_of(found, 0) > 0);
        CHECK(listed_of(found, 1) == 0);
        float nearness = 0.0f;
        REQUIRE(crofton_depth_culler_nearness(culler.get(), 160, 90, &nearness) == CROFTON_OK);
        const auto depth_at = [](double z) {
            const glm::dvec4 p = crofton::world_to_clip(crofton::Camera{}) * glm::dvec4(0.0, 0.0, z, 1.0);
            return p.z / p.w;
        };
        CHECK(double{nearness} <= depth_at(-5.0));
        CHECK(double{nearness} >= depth_at(-5.01));

        objects[0].hides = 0;
        found = find(culler, objects, picture);
        CHECK(listed_of(found, 0) > 0);
        CHECK(listed_of(found, 1) == 32);
        objects[0].hides = 1;
        objects[0].position_error = 100.0f;
        CHECK(listed_of(find(culler, objects, picture), 1) == 32);
        objects[0].position_error = 0.0f;
        const glm::dmat4 turned = glm::rotate(at(0, 0, -5), 3.14159265358979, glm::dvec3(0, 1, 0));
        objects[0] = object_of(front, to_clip(turned));
        CHECK(listed_of(find(culler, objects, picture), 1) == 0);
        objects[0].one_sided = 1;
        found = find(culler, objects, picture);
        CHECK(listed_of(found, 0) == 0);
        CHECK(listed_of(found, 1) == 32);
        objects[0].to_clip[5] = kNaN;
        found = find(culler, objects, picture);
        CHECK(listed_of(found, 0) == 200);
        CHECK(listed_of(found, 1) == 32);
        CHECK(find(culler, {}, picture).empty());
        REQUIRE(crofton_depth_culler_nearness(culler.get(), 0, 0, &nearness) == CROFTON_OK);
        CHECK(nearness == -std::numeric_limits<float>::infinity());
    }

    TEST_CASE("C lists the same casters as C++, and refuses receivers that are not the camera's") {
        const TriangleMesh mesh = wall(20, 3.0f);
        const ClusteredMesh in_c = cut(mesh, 24);
        const auto in_cpp =
            crofton::depth::ClusteredMesh::cut(mesh.positions, mesh.indices, {.max_triangles = 24}).value();
        crofton::Camera lamp;
        lamp.position = {9, 5, 0};
        lamp.forward = {-1, -0.6, -1.2};
        const DepthCuller camera_culler = make_depth_culler(), light_culler = make_depth_culler();
        crofton::depth::DepthCuller same_camera, same_light;
        std::mt19937 random(5);
        std::vector<crofton_depth_object> drawn, casters;
        std::vector<crofton::depth::DepthObject> same_drawn, same_casters;
        std::vector<crofton_depth_receiver> receivers;
        std::vector<crofton::depth::DepthReceiver> same_receivers;
        for (int i = 0; i < 20; ++i) {
            const double z = -5.0 - static_cast<double>(random() % 20), x = static_cast<double>(random() % 9) - 4.0;
            const glm::dmat4 place = glm::rotate(at(x, -1, z), static_cast<double>(i), glm::dvec3(0, 1, 0));
            const glm::mat4 clip = to_clip(place), map(crofton::world_to_clip(lamp) * place);
            drawn.push_back(object_of(in_c, clip)), casters.push_back(object_of(in_c, map));
            same_drawn.push_back({&in_cpp, clip}), same_casters.push_back({&in_cpp, map});
            crofton_depth_receiver receiver{in_c.get(), {}, i % 7 == 0};
            std::memcpy(receiver.to_map, &map[0][0], sizeof receiver.to_map);
            receivers.push_back(receiver), same_receivers.push_back({&in_cpp, map, i % 7 == 0});
        }
        const crofton_picture_view picture = picture_of(160, 90), size = picture_of(128, 128);
        find(camera_culler, drawn, picture);
        REQUIRE(same_camera.find_visible(same_drawn, {160, 90}));
        crofton_depth_receivers given = crofton_default_depth_receivers();
        CHECK((given.seen == nullptr && given.objects == nullptr && given.object_count == 0 && given.radius == 1.0));
        given.seen = camera_culler.get();
        given.objects = receivers.data();
        given.object_count = receivers.size();
        const crofton_visible_cluster* clusters = nullptr;
        std::size_t count = 0;
        auto statistics = sized<crofton_depth_statistics>();
        const auto casters_of = [&](const crofton_depth_culler* seen) {
            given.seen = seen;
            return crofton_depth_culler_find_casters(light_culler.get(), casters.data(), casters.size(), &size, &given,
                                                     nullptr, &clusters, &count, &statistics);
        };
        for (const double radius : {0.5, 1.0, 20.0}) {
            given.radius = radius;
            REQUIRE(casters_of(camera_culler.get()) == CROFTON_OK);
            const auto expected =
                same_light
                    .find_casters(same_casters, {128, 128}, {&same_camera, same_receivers, static_cast<float>(radius)})
                    .value();
            REQUIRE(count == expected.size());
            CHECK(count > 3);
            CHECK(std::memcmp(clusters, expected.data(), count * sizeof *clusters) == 0);
            CHECK(statistics.triangles_listed == same_light.statistics().triangles_listed);
            float nearness = 0.0f;
            REQUIRE(crofton_depth_culler_nearness(light_culler.get(), 127, 127, &nearness) == CROFTON_OK);
            CHECK(nearness == same_light.nearness(127, 127));
        }
        const auto seen_mesh = [&](const crofton_clustered_mesh* seen) {
            for (crofton_depth_receiver& receiver : receivers) receiver.mesh = seen;
        };
        const ClusteredMesh other = cut(mesh, 24);
        for (const crofton_clustered_mesh* wrong : {static_cast<const crofton_clustered_mesh*>(nullptr),
                                                    static_cast<const crofton_clustered_mesh*>(other.get())}) {
            seen_mesh(wrong);
            CHECK(casters_of(camera_culler.get()) == CROFTON_INVALID_ARGUMENT);
        }
        seen_mesh(reinterpret_cast<const crofton_clustered_mesh*>(camera_culler.get()));
        CHECK(casters_of(camera_culler.get()) == CROFTON_BAD_HANDLE);
        seen_mesh(in_c.get());
        // A call that fails after it has begun to read objects leaves the camera's answer as it was.
        drawn[7].mesh = nullptr;
        CHECK(crofton_depth_culler_find_visible(camera_culler.get(), drawn.data(), drawn.size(), &picture, nullptr,
                                                &clusters, &count, nullptr) == CROFTON_BAD_HANDLE);
        CHECK(casters_of(camera_culler.get()) == CROFTON_OK);
        CHECK(casters_of(nullptr) == CROFTON_BAD_HANDLE);
        // With thread checks, too, which see the culler in use by this call.
        for (const int on : {1, 0}) {
            REQUIRE(crofton_set_thread_checks(on) == CROFTON_OK);
            CHECK(casters_of(light_culler.get()) == CROFTON_INVALID_ARGUMENT);
            CHECK(casters_of(camera_culler.get()) == CROFTON_OK);
        }
        given.radius = kNaN;
        CHECK(casters_of(camera_culler.get()) == CROFTON_OUT_OF_RANGE);
        given.radius = 1.0;
        given.object_count = 19;
        CHECK(casters_of(camera_culler.get()) == CROFTON_INVALID_ARGUMENT);
        given.object_count = SIZE_MAX;
        CHECK(casters_of(camera_culler.get()) == CROFTON_OUT_OF_RANGE);
        given.object_count = 20;
        given.size = 4;
        CHECK(casters_of(camera_culler.get()) == CROFTON_WRONG_SIZE);
        CHECK(crofton_depth_culler_find_casters(light_culler.get(), casters.data(), casters.size(), &size, nullptr,
                                                nullptr, &clusters, &count, nullptr) == CROFTON_INVALID_ARGUMENT);
    }

    TEST_CASE("defaults are those of C++, and a default object lacks its mesh") {
        const crofton_depth_object object = crofton_default_depth_object();
        const crofton_picture_view picture = crofton_default_picture_view();
        for (std::size_t k = 0; k < 16; ++k) CHECK(object.to_clip[k] == (k % 5 == 0 ? 1.0f : 0.0f));
        CHECK((object.size == sizeof object && !object.mesh && !object.one_sided && object.hides == 1));
        CHECK(object.position_error == 0.0f);
        CHECK((picture.size == sizeof picture && picture.width == 1280 && picture.height == 720));
        CHECK(picture.depth == CROFTON_DEPTH_REVERSED_ZERO_TO_ONE);
    }

    TEST_CASE("bad meshes are refused by their vertex and index, and make no handle") {
        TriangleMesh mesh = crofton::testing::cube_mesh();
        crofton_clustered_mesh* made = nullptr;
        const auto status = [&](std::uint32_t most = 0) {
            const crofton_mesh given = to_c(mesh);
            const crofton_status result = crofton_clustered_mesh_create(&given, most, &made);
            CHECK(made == nullptr);
            CHECK(mentions(crofton_last_error(), "crofton_clustered_mesh_create: "));
            return result;
        };
        CHECK(status(CROFTON_MAX_CLUSTER_TRIANGLES + 1) == CROFTON_INVALID_ARGUMENT);
        CHECK(mentions(crofton_last_error(), "max_triangles is 65"));
        mesh.indices[17] = 8;
        CHECK(status() == CROFTON_OUT_OF_RANGE);
        CHECK(crofton_last_error_item() == 17);
        mesh.indices[17] = 0;
        mesh.positions[3].y = kNaN;
        CHECK(status() == CROFTON_NON_FINITE);
        CHECK(crofton_last_error_item() == 3);
        mesh = crofton::testing::cube_mesh();
        mesh.indices.pop_back();
        CHECK(status() == CROFTON_INVALID_ARGUMENT);

        mesh = crofton::testing::cube_mesh();
        crofton_mesh given = to_c(mesh);
        CHECK(crofton_clustered_mesh_create(&given, 0, nullptr) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_clustered_mesh_create(nullptr, 0, &made) == CROFTON_INVALID_ARGUMENT);
        given.size = 8;
        CHECK(crofton_clustered_mesh_create(&given, 0, &made) == CROFTON_WRONG_SIZE);
        given = to_c(mesh);
        given.positions = nullptr;
        CHECK(crofton_clustered_mesh_create(&given, 0, &made) == CROFTON_INVALID_ARGUMENT);
        given = to_c(mesh);
        given.indices = nullptr;
        CHECK(crofton_clustered_mesh_create(&given, 0, &made) == CROFTON_INVALID_ARGUMENT);
        given.index_count = 0;
        CHECK(crofton_clustered_mesh_create(&given, 0, &made) == CROFTON_EMPTY);
        CHECK(made == nullptr);
    }

    TEST_CASE("a mesh comes back from its bytes without being cut, and damaged bytes are refused") {
        const ClusteredMesh mesh = cut(crofton::testing::cube_mesh(), 4);
        std::size_t count = 0, again = 0;
        REQUIRE(crofton_clustered_mesh_serialise(mesh.get(), nullptr, 0, &count) == CROFTON_OK);
        std::vector<std::uint8_t> bytes(count + 1, 77);
        REQUIRE(crofton_clustered_mesh_serialise(mesh.get(), bytes.data(), count - 1, &again) == CROFTON_OK);
        CHECK(again == count);
        CHECK(bytes.front() == 77);  // too little room: nothing is written
        REQUIRE(crofton_clustered_mesh_serialise(mesh.get(), bytes.data(), count, &again) == CROFTON_OK);
        CHECK(bytes.back() == 77);
        crofton_clustered_mesh* made = nullptr;
        REQUIRE(crofton_clustered_mesh_deserialise(bytes.data(), count, &made) == CROFTON_OK);
        const ClusteredMesh stored(made);
        CHECK(order_of(stored) == order_of(mesh));
        REQUIRE(clusters_of(stored).size() == clusters_of(mesh).size());
        CHECK(std::memcmp(get(stored).clusters, get(mesh).clusters, clusters_of(mesh).size_bytes()) == 0);

        crofton_clustered_mesh* none = nullptr;
        for (std::size_t short_of = 0; short_of < count; ++short_of)
            REQUIRE(crofton_clustered_mesh_deserialise(bytes.data(), short_of, &none) == CROFTON_PARSE);
        CHECK(crofton_clustered_mesh_deserialise(nullptr, 0, &none) == CROFTON_PARSE);
        CHECK(crofton_clustered_mesh_deserialise(nullptr, count, &none) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_clustered_mesh_deserialise(bytes.data(), count, nullptr) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_clustered_mesh_serialise(mesh.get(), nullptr, count, &again) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_clustered_mesh_serialise(mesh.get(), bytes.data(), count, nullptr) == CROFTON_INVALID_ARGUMENT);
        CHECK(none == nullptr);
    }

    TEST_CASE("arrays that are lent are read in place, and only those of the mesh can be lent") {
        TriangleMesh mesh = wall(8, 0.7f);
        const ClusteredMesh own = cut(mesh, 4), lent = cut(mesh, 4), original = cut(mesh, 4);
        const auto in_view = [&](const ClusteredMesh& of) {
            crofton_depth_object object = crofton_default_depth_object();
            object.mesh = of.get();
            const DepthCuller culler = make_depth_culler();
            const crofton_picture_view picture = crofton_default_picture_view();
            const crofton_visible_cluster* found = nullptr;
            std::size_t count = 0;
            REQUIRE(crofton_depth_culler_find_visible(culler.get(), &object, 1, &picture, nullptr, &found, &count,
                                                      nullptr) == CROFTON_OK);
            std::vector<std::uint64_t> numbers;
            for (std::size_t i = 0; i < count; ++i)
                numbers.insert(numbers.end(), {found[i].cluster, found[i].triangles});
            return numbers;
        };
        const auto expected = in_view(own);
        REQUIRE_FALSE(expected.empty());
        const crofton_mesh as_cut = to_c(mesh);
        std::vector<std::uint32_t> permuted(mesh.indices.size());
        const crofton_clusters clusters = get(own);
        REQUIRE(crofton_permute_triangles(&clusters, mesh.indices.data(), permuted.size(), permuted.data()) ==
                CROFTON_OK);
        crofton_mesh in_order = as_cut;
        in_order.indices = permuted.data();

        CHECK(crofton_clustered_mesh_lend(lent.get(), nullptr, CROFTON_INDEX_ORDER_PERMUTED) ==
              CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_clustered_mesh_lend(lent.get(), &as_cut, 2) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_clustered_mesh_lend(lent.get(), &as_cut, CROFTON_INDEX_ORDER_PERMUTED) ==
              CROFTON_INVALID_ARGUMENT);
        CHECK(mentions(crofton_last_error(), "crofton_clustered_mesh_lend: "));
        REQUIRE(crofton_clustered_mesh_lend(lent.get(), &in_order, CROFTON_INDEX_ORDER_PERMUTED) == CROFTON_OK);
        CHECK(get(lent).triangle_count == 0);
        CHECK(in_view(lent) == expected);
        CHECK(crofton_clustered_mesh_lend(lent.get(), &as_cut, CROFTON_INDEX_ORDER_ORIGINAL) ==
              CROFTON_INVALID_ARGUMENT);
        REQUIRE(crofton_clustered_mesh_lend(original.get(), &as_cut, CROFTON_INDEX_ORDER_ORIGINAL) == CROFTON_OK);
        CHECK(order_of(original) == order_of(own));
        CHECK(in_view(original) == expected);
    }

    TEST_CASE("lists without a place for the answer, and indices of another mesh or in place, are refused") {
        const TriangleMesh mesh = crofton::testing::cube_mesh();
        const ClusteredMesh clustered = cut(mesh);
        CHECK(crofton_clustered_mesh_get(clustered.get(), nullptr) == CROFTON_INVALID_ARGUMENT);
        crofton_clusters clusters = get(clustered);
        std::vector<std::uint32_t> indices(mesh.indices.begin(), mesh.indices.end()), permuted(36, 77);
        const auto permute = [&](const std::uint32_t* from, std::size_t n, std::uint32_t* to) {
            return crofton_permute_triangles(&clusters, from, n, to);
        };
        CHECK(permute(nullptr, 36, permuted.data()) == CROFTON_INVALID_ARGUMENT);
        CHECK(permute(indices.data(), 36, nullptr) == CROFTON_INVALID_ARGUMENT);
        CHECK(permute(indices.data(), 33, permuted.data()) == CROFTON_INVALID_ARGUMENT);
        CHECK(permute(indices.data(), SIZE_MAX, permuted.data()) == CROFTON_OUT_OF_RANGE);
        CHECK(crofton_permute_triangles(nullptr, indices.data(), 36, permuted.data()) == CROFTON_INVALID_ARGUMENT);
        std::vector<std::uint32_t> wrong = order_of(clustered);
        wrong.back() = 12;
        clusters.triangle_order = wrong.data();
        CHECK(permute(indices.data(), 36, permuted.data()) == CROFTON_OUT_OF_RANGE);
        CHECK(crofton_last_error_item() == 11);
        clusters.triangle_order = nullptr;
        CHECK(permute(indices.data(), 36, permuted.data()) == CROFTON_INVALID_ARGUMENT);
        clusters = get(clustered);
        CHECK(permuted == std::vector<std::uint32_t>(36, 77));
        indices.resize(72);
        for (const std::size_t shift : {0u, 1u, 35u})
            CHECK(permute(indices.data(), 36, indices.data() + shift) == CROFTON_INVALID_ARGUMENT);
        CHECK(mentions(crofton_last_error(), "overlap"));
        CHECK(permute(indices.data(), 36, indices.data() + 36) == CROFTON_OK);
    }

    TEST_CASE("a bad object is named, a bad picture refused, and the last answer stays") {
        const TriangleMesh mesh = wall(4, 1.0f);
        const ClusteredMesh clustered = cut(mesh);
        const DepthCuller culler = make_depth_culler();
        const crofton_depth_object good = object_of(clustered, to_clip(at(0, 0, -5)));
        std::vector<crofton_depth_object> objects(3, good);
        crofton_picture_view picture = picture_of(64, 36);
        float nearness = 7.0f;
        CHECK(crofton_depth_culler_nearness(culler.get(), 0, 0, &nearness) == CROFTON_OUT_OF_RANGE);
        const auto first = find(culler, objects, picture);
        const std::vector<std::uint64_t> listed{first[0].triangles, first.back().triangles};

        const crofton_visible_cluster* clusters = nullptr;
        std::size_t count = 77;
        std::size_t ranges = 0;
        crofton_jobs jobs{sizeof jobs, &ranges, 3, run_backwards};
        const auto ask = [&] {
            return crofton_depth_culler_find_visible(culler.get(), objects.data(), objects.size(), &picture, &jobs,
                                                     &clusters, &count, nullptr);
        };
        objects[1].mesh = nullptr;
        CHECK(ask() == CROFTON_BAD_HANDLE);
        CHECK(crofton_last_error_item() == 1);
        CHECK(mentions(crofton_last_error(), "crofton_depth_culler_find_visible: the handle is NULL"));
        objects[1].mesh = reinterpret_cast<const crofton_clustered_mesh*>(culler.get());
        CHECK(ask() == CROFTON_BAD_HANDLE);
        CHECK(crofton_last_error_item() == 1);
        objects[1] = good;
        objects[2].size = offsetof(crofton_depth_object, position_error);
        CHECK(ask() == CROFTON_WRONG_SIZE);
        CHECK(crofton_last_error_item() == 2);
        objects[2] = good;
        objects[0].size = 0;
        CHECK(ask() == CROFTON_WRONG_SIZE);
        objects[0] = good;
        for (const std::uint32_t bad : {0u, 16385u, ~0u}) {
            picture = picture_of(bad, 36);
            CHECK(ask() == CROFTON_OUT_OF_RANGE);
            picture = picture_of(64, bad);
            CHECK(ask() == CROFTON_OUT_OF_RANGE);
        }
        picture = picture_of(64, 36);
        picture.depth = 3;
        CHECK(ask() == CROFTON_INVALID_ARGUMENT);
        CHECK(mentions(crofton_last_error(), "unknown depth range"));
        picture = picture_of(64, 36);
        picture.size = sizeof picture + 8;
        CHECK(ask() == CROFTON_WRONG_SIZE);
        picture = picture_of(64, 36);
        jobs.concurrency = 0;
        CHECK(ask() == CROFTON_INVALID_ARGUMENT);
        CHECK(mentions(crofton_last_error(), "jobs need"));
        jobs = {sizeof jobs - 8, &ranges, 3, run_backwards};
        CHECK(ask() == CROFTON_WRONG_SIZE);
        CHECK(ranges == 0);
        jobs.size = sizeof jobs;
        const auto ask_with = [&](const crofton_depth_object* some, const crofton_picture_view* seen,
                                  const crofton_visible_cluster** answer, std::size_t* answer_count) {
            return crofton_depth_culler_find_visible(culler.get(), some, 3, seen, nullptr, answer, answer_count,
                                                     nullptr);
        };
        CHECK(ask_with(nullptr, &picture, &clusters, &count) == CROFTON_INVALID_ARGUMENT);
        CHECK(ask_with(objects.data(), nullptr, &clusters, &count) == CROFTON_INVALID_ARGUMENT);
        CHECK(ask_with(objects.data(), &picture, nullptr, &count) == CROFTON_INVALID_ARGUMENT);
        CHECK(ask_with(objects.data(), &picture, &clusters, nullptr) == CROFTON_INVALID_ARGUMENT);
        CHECK(clusters == nullptr);
        CHECK(count == 77);

        CHECK(first[0].triangles == listed[0]);
        CHECK(first.back().triangles == listed[1]);
        auto statistics = sized<crofton_depth_statistics>();
        statistics.size = 4;
        CHECK(crofton_depth_culler_find_visible(culler.get(), objects.data(), 3, &picture, nullptr, &clusters, &count,
                                                &statistics) == CROFTON_WRONG_SIZE);
        CHECK(count == 77);
        statistics.size = sizeof statistics;
        find(culler, objects, picture, &statistics);
        CHECK(statistics.objects_listed == 3);
        CHECK(crofton_depth_culler_nearness(culler.get(), 64, 0, &nearness) == CROFTON_OUT_OF_RANGE);
        CHECK(crofton_depth_culler_nearness(culler.get(), 0, 36, &nearness) == CROFTON_OUT_OF_RANGE);
        CHECK(nearness == 7.0f);
        CHECK(crofton_depth_culler_nearness(culler.get(), 0, 0, nullptr) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_depth_culler_nearness(culler.get(), 63, 35, &nearness) == CROFTON_OK);
        CHECK(crofton_depth_culler_create(nullptr) == CROFTON_INVALID_ARGUMENT);
    }

    TEST_CASE("arrays of older, smaller structs are read as far as they go, and older statistics are filled so") {
        const TriangleMesh mesh = wall(4, 1.0f);
        const ClusteredMesh clustered = cut(mesh);
        const DepthCuller culler = make_depth_culler();
        std::vector<crofton_depth_object> objects;
        for (const double z : {-5.0, -8.0, -11.0}) objects.push_back(object_of(clustered, to_clip(at(0.3 * z, 0, z))));
        crofton_picture_view picture = picture_of(320, 180);
        const auto found = find(culler, objects, picture);
        const std::vector<crofton_visible_cluster> expected(found.begin(), found.end());
        constexpr std::size_t kStride = offsetof(crofton_depth_object, position_error);
        static_assert(kStride % alignof(crofton_depth_object) == 0);
        alignas(crofton_depth_object) std::array<unsigned char, 3 * sizeof(crofton_depth_object)> packed;
        packed.fill(0xff);
        for (std::size_t i = 0; i < 3; ++i) {
            objects[i].size = kStride;
            std::memcpy(packed.data() + i * kStride, &objects[i], kStride);
        }
        picture.size = offsetof(crofton_picture_view, depth);
        picture.depth = 99;
        const crofton_visible_cluster* clusters = nullptr;
        std::size_t count = 0;
        crofton_depth_statistics statistics;
        std::memset(static_cast<void*>(&statistics), 0x5a, sizeof statistics);
        const std::uint64_t untouched = statistics.triangles_listed;
        statistics.size = offsetof(crofton_depth_statistics, triangles_listed);
        REQUIRE(crofton_depth_culler_find_visible(culler.get(),
                                                  reinterpret_cast<const crofton_depth_object*>(packed.data()), 3,
                                                  &picture, nullptr, &clusters, &count, &statistics) == CROFTON_OK);
        REQUIRE(count == expected.size());
        CHECK(std::memcmp(clusters, expected.data(), count * sizeof *clusters) == 0);
        CHECK(statistics.objects_asked == 3);
        CHECK(statistics.triangles_listed == untouched);
    }
}
