// SPDX-License-Identifier: MIT
// Views of a World in C that list the triangles of a picture.
#include <crofton/geometry/camera.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>

#include "world_fixture.hpp"

using namespace crofton::capi_test;

namespace {

// n × n squares over [-half, half]² of the plane z = 0, seen from +z.
struct Wall {
    std::vector<float> positions;
    std::vector<std::uint32_t> indices;

    Wall(std::uint32_t n, float half) {
        for (std::uint32_t y = 0; y <= n; ++y)
            for (std::uint32_t x = 0; x <= n; ++x)
                for (const float at : {static_cast<float>(x), static_cast<float>(y), 0.5f * static_cast<float>(n)})
                    positions.push_back(half * (2.0f * at / static_cast<float>(n) - 1.0f));
        for (std::uint32_t y = 0; y < n; ++y)
            for (std::uint32_t x = 0; x < n; ++x) {
                const std::uint32_t a = y * (n + 1) + x, b = a + n + 1;
                indices.insert(indices.end(), {a, a + 1, b + 1, a, b + 1, b});
            }
    }
    [[nodiscard]] crofton_mesh_data data() const {
        auto result = sized<crofton_mesh_data>();
        result.positions = positions.data();
        result.position_count = positions.size() / 3;
        result.indices = indices.data();
        result.index_count = indices.size();
        result.clusters = 1;
        return result;
    }
    [[nodiscard]] crofton_mesh mesh() const {
        return {sizeof(crofton_mesh), positions.data(), positions.size() / 3, indices.data(), indices.size(), nullptr};
    }
};

// Object, cluster and triangles of each.
using List = std::vector<std::array<std::uint64_t, 3>>;

List list_of(const crofton_visible_cluster* clusters, std::size_t count) {
    List list;
    for (std::size_t i = 0; i < count; ++i)
        list.push_back({clusters[i].object, clusters[i].cluster, clusters[i].triangles});
    return list;
}

// A wall, a smaller one before it and one behind it; a box beside them.
struct Walls {
    Wall large{10, 4.0f}, small{4, 1.0f};
    WorldHandle world = make_world();
    crofton_world_mesh meshes[2] = {};
    crofton_object objects[3] = {}, box{};
    double depths[3] = {-10, -5, -20};
    crofton_camera camera = crofton_default_camera();
    crofton_picture_view picture = crofton_default_picture_view();

    explicit Walls(std::uint32_t one_sided = 0) {
        crofton_mesh_data data[2] = {large.data(), small.data()};
        for (int i = 0; i < 2; ++i) {
            data[i].one_sided = one_sided;
            REQUIRE(crofton_world_add_mesh(world.get(), &data[i], &meshes[i]) == CROFTON_OK);
        }
        for (std::size_t i = 0; i < 3; ++i) objects[i] = add(meshes[i == 0 ? 0 : 1], translation(0, 0, depths[i]));
        box = add_bound(world, box_bound(box_at(6, 0, -8)));
        update(world);
        picture.width = 160;
        picture.height = 90;
    }
    crofton_object add(crofton_world_mesh mesh, const crofton_transform& place) {
        auto description = sized<crofton_object_description>();
        description.has_mesh = 1;
        description.mesh = mesh;
        description.transform = &place;
        crofton_object object{};
        REQUIRE(crofton_world_add(world.get(), &description, &object) == CROFTON_OK);
        return object;
    }
    [[nodiscard]] crofton_view_request request() const {
        crofton_view_request result = request_of(camera);
        result.picture = &picture;
        return result;
    }
    // What the depth culler lists of the walls, with the objects' indices in place of its own.
    [[nodiscard]] List expected(std::uint32_t one_sided = 0, std::uint32_t first_two_hide = 1) const {
        ClusteredMesh cut[2];
        for (int i = 0; i < 2; ++i) {
            const crofton_mesh mesh = i == 0 ? large.mesh() : small.mesh();
            crofton_clustered_mesh* made = nullptr;
            REQUIRE(crofton_clustered_mesh_create(&mesh, 0, &made) == CROFTON_OK);
            cut[i] = ClusteredMesh(made);
        }
        std::vector<crofton_depth_object> asked(3, crofton_default_depth_object());
        for (std::size_t i = 0; i < 3; ++i) {
            const glm::mat4 matrix(crofton::world_to_clip(crofton::Camera{}) *
                                   glm::translate(glm::dmat4(1.0), {0, 0, depths[i]}));
            asked[i].mesh = cut[i == 0 ? 0 : 1].get();
            asked[i].one_sided = one_sided;
            if (i < 2) asked[i].hides = first_two_hide;
            std::memcpy(asked[i].to_clip, &matrix[0][0], sizeof asked[i].to_clip);
        }
        const DepthCuller culler = make_depth_culler();
        const crofton_visible_cluster* clusters = nullptr;
        std::size_t count = 0;
        REQUIRE(crofton_depth_culler_find_visible(culler.get(), asked.data(), 3, &picture, nullptr, &clusters, &count,
                                                  nullptr) == CROFTON_OK);
        List list = list_of(clusters, count);
        for (auto& c : list) c[0] = objects[c[0]].index;
        return list;
    }
};

crofton_view_info info_of(const ViewResultHandle& result, std::size_t view = 0) {
    auto info = sized<crofton_view_info>();
    REQUIRE(crofton_view_result_get_view(result.get(), view, &info) == CROFTON_OK);
    return info;
}

List listed(const crofton_view_info& info) {
    return list_of(info.triangles, info.triangle_cluster_count);
}

std::vector<std::uint32_t> ids_of(const ViewResultHandle& result) {
    const std::uint32_t* ids = nullptr;
    std::size_t count = 0;
    REQUIRE(crofton_view_result_ids(result.get(), &ids, &count, nullptr, nullptr) == CROFTON_OK);
    return {ids, ids + count};
}

}  // namespace

TEST_SUITE("capi/world_picture") {
    TEST_CASE("a mesh takes clusters that were cut before, and refuses those of another mesh") {
        const Wall wall{10, 4.0f}, other{10, 3.0f};
        crofton_clustered_mesh* made = nullptr;
        const crofton_mesh mesh = wall.mesh();
        REQUIRE(crofton_clustered_mesh_create(&mesh, 3, &made) == CROFTON_OK);
        const ClusteredMesh precut(made);
        crofton_clusters expected{};
        REQUIRE(crofton_clustered_mesh_get(precut.get(), &expected) == CROFTON_OK);
        const WorldHandle world = make_world();
        crofton_mesh_data data = wall.data();
        data.precut = precut.get();
        crofton_world_mesh added{};
        REQUIRE(crofton_world_add_mesh(world.get(), &data, &added) == CROFTON_OK);
        auto info = sized<crofton_mesh_info>();
        REQUIRE(crofton_world_get_mesh(world.get(), added, &info) == CROFTON_OK);
        CHECK(info.clusters.cluster_count == expected.cluster_count);
        CHECK(std::equal(expected.triangle_order, expected.triangle_order + expected.triangle_count,
                         info.clusters.triangle_order));
        data = other.data();
        data.precut = precut.get();
        CHECK(crofton_world_add_mesh(world.get(), &data, &added) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_world_replace_mesh(world.get(), added, &data) == CROFTON_INVALID_ARGUMENT);
        data.clusters = 0;  // not asked for
        CHECK(crofton_world_add_mesh(world.get(), &data, &added) == CROFTON_OK);
    }

    TEST_CASE("a limit of work lists no less, and says that it was exceeded") {
        Walls s;
        const ViewResultHandle result = make_view_result();
        crofton_view_request request = s.request();
        CHECK(s.picture.work_limit == 0);
        REQUIRE(crofton_world_view(s.world.get(), &request, 1, nullptr, result.get()) == CROFTON_OK);
        const crofton_view_info all = info_of(result);
        s.picture.work_limit = 1;
        REQUIRE(crofton_world_view(s.world.get(), &request, 1, nullptr, result.get()) == CROFTON_OK);
        const crofton_view_info some = info_of(result);
        CHECK(some.triangles_listed > all.triangles_listed);
        CHECK(some.clusters_asked + some.triangles_drawn > 1);
        CHECK(some.triangles_drawn < all.triangles_drawn);
    }

    TEST_CASE("a picture lists the triangles that the depth culler lists, in one view and in each of many") {
        for (const std::uint32_t one_sided : {0u, 1u}) {
            CAPTURE(one_sided);
            const Walls s(one_sided);
            const List expected = s.expected(one_sided);
            REQUIRE(expected.size() > 2);
            const ViewResultHandle result = make_view_result();
            crofton_view_request request = s.request();
            REQUIRE(crofton_world_view(s.world.get(), &request, 1, nullptr, result.get()) == CROFTON_OK);
            crofton_view_info info = info_of(result);
            CHECK(listed(info) == expected);
            CHECK(ids_of(result) == std::vector<std::uint32_t>{s.objects[0].index, s.objects[1].index, s.box.index});
            CHECK(info.objects_asked == 4);
            CHECK((info.depth_width == 0 && info.occluders_drawn == 0 && info.occluded_count == 0));
            std::uint64_t triangles = 0;
            for (const auto& c : expected) triangles += std::uint64_t(std::popcount(c[2]));
            CHECK(info.triangles_listed >= triangles);
            CHECK(crofton_view_result_depth(result.get(), 0, nullptr, 0) == CROFTON_EMPTY);

            const crofton_occlusion_options occlusion = crofton_default_occlusion_options();
            crofton_view_request many[4] = {request, request_of(s.camera), request, request_of(s.camera)};
            many[2].layers = 0;
            many[3].occlusion = &occlusion;
            REQUIRE(crofton_world_view(s.world.get(), many, 4, nullptr, result.get()) == CROFTON_OK);
            CHECK(listed(info_of(result, 0)) == expected);
            for (const std::size_t v : {1u, 2u, 3u}) CHECK(info_of(result, v).triangle_cluster_count == 0);
            CHECK(info_of(result, 0).triangles_listed == info.triangles_listed);
            std::uint32_t masks[4] = {};
            crofton_object_ref refs[4] = {};
            REQUIRE(crofton_view_result_list(result.get(), s.world.get(), 0, refs, masks, 4) == CROFTON_OK);
            CHECK((masks[0] == 11 && masks[1] == 11 && masks[2] == 10 && masks[3] == 11));

            // In the tree's order, with limits and with a mask the list of triangles is that of what is left.
            request.tree_order = 1;
            REQUIRE(crofton_world_view(s.world.get(), &request, 1, nullptr, result.get()) == CROFTON_OK);
            CHECK(listed(info_of(result)) == expected);
            auto limits = crofton_default_draw_limits();
            limits.least_radius = 2.0;
            request.limits = &limits;
            REQUIRE(crofton_world_view(s.world.get(), &request, 1, nullptr, result.get()) == CROFTON_OK);
            CHECK(ids_of(result) == std::vector<std::uint32_t>{s.objects[0].index});
            request.picture = nullptr;
            REQUIRE(crofton_world_view(s.world.get(), &request, 1, nullptr, result.get()) == CROFTON_OK);
            CHECK(info_of(result).triangles == nullptr);
        }
    }

    TEST_CASE("a light lists what throws a shadow on what the camera sees, and needs that answer") {
        const Walls s;
        crofton_camera lamp = crofton_default_camera();
        lamp.position[0] = 3;
        lamp.fov_y = 2.0;
        crofton_picture_view map = s.picture;
        crofton_shadow_receivers receivers = crofton_default_shadow_receivers();
        CHECK((receivers.size == sizeof receivers && receivers.seen == nullptr && receivers.radius == 1.0));
        crofton_view_request request = request_of(lamp), of_camera = s.request();
        request.picture = &map;
        const ViewResultHandle seen = make_view_result(), result = make_view_result();
        const auto view = [&](const crofton_view_request& asked, const ViewResultHandle& to) {
            return crofton_world_view(s.world.get(), &asked, 1, nullptr, to.get());
        };
        REQUIRE(view(of_camera, seen) == CROFTON_OK);
        REQUIRE(view(request, result) == CROFTON_OK);
        const std::uint64_t all = info_of(result).triangles_listed;
        request.receivers = &receivers;
        CHECK(view(request, result) == CROFTON_BAD_HANDLE);
        receivers.seen = seen.get();
        REQUIRE(view(request, result) == CROFTON_OK);
        // The small wall before the large one throws a shadow on it.
        CHECK(info_of(result).triangles_listed > 0);
        CHECK(info_of(result).triangles_listed <= all);
        const auto ids = ids_of(result);
        CHECK(std::count(ids.begin(), ids.end(), s.objects[1].index) == 1);
        CHECK(std::count(ids.begin(), ids.end(), s.objects[2].index) == 0);
        // A lamp behind the large wall shines on what the camera does not see.
        lamp.position[2] = -15;
        REQUIRE(view(request, result) == CROFTON_OK);
        CHECK(info_of(result).triangles_listed == 0);
        request.receivers = nullptr;
        REQUIRE(view(request, result) == CROFTON_OK);
        CHECK(info_of(result).triangles_listed > 0);
        request.receivers = &receivers;
        lamp.position[2] = 0;
        receivers.radius = 0.0;
        CHECK(view(request, result) == CROFTON_OUT_OF_RANGE);
        receivers.radius = 1.0;
        // With thread checks, too, which see the result in use by this call.
        for (const int on : {1, 0}) {
            REQUIRE(crofton_set_thread_checks(on) == CROFTON_OK);
            CHECK(view(request, seen) == CROFTON_INVALID_ARGUMENT);
            CHECK(view(request, result) == CROFTON_OK);
        }
        of_camera.picture = nullptr;
        REQUIRE(view(of_camera, seen) == CROFTON_OK);
        CHECK(view(request, result) == CROFTON_INVALID_ARGUMENT);
        // The World changes: the answer is of another.
        of_camera.picture = &s.picture;
        REQUIRE(view(of_camera, seen) == CROFTON_OK);
        REQUIRE(view(request, result) == CROFTON_OK);
        update(s.world);
        CHECK(view(request, result) == CROFTON_OK);
        const crofton_transform nearer = translation(0, 0, -3);
        REQUIRE(crofton_world_set_transforms(s.world.get(), &s.objects[1], 0, &nearer, 0, 1) == CROFTON_OK);
        update(s.world);
        CHECK(view(request, result) == CROFTON_INVALID_ARGUMENT);
        // Seen from behind the lamp's back.
        of_camera.picture = &s.picture;
        crofton_camera away = s.camera;
        away.forward[2] = 1;
        of_camera.camera = &away;
        REQUIRE(view(of_camera, seen) == CROFTON_OK);
        REQUIRE(view(request, result) == CROFTON_OK);
        CHECK(info_of(result).triangles_listed == 0);
    }

    TEST_CASE("objects behind something that hides nothing are drawn, and hidden objects come back") {
        Walls s;
        for (const int i : {0, 1}) REQUIRE(world_set_occludes(s.world.get(), s.objects[i], 0) == CROFTON_OK);
        update(s.world);
        const ViewResultHandle result = make_view_result();
        const crofton_view_request request = s.request();
        REQUIRE(crofton_world_view(s.world.get(), &request, 1, nullptr, result.get()) == CROFTON_OK);
        CHECK(listed(info_of(result)) == s.expected(0, 0));
        CHECK(ids_of(result).size() == 4);
        CHECK(s.expected(0, 0).size() > s.expected(0, 1).size());
    }

    TEST_CASE("a mesh tells its clusters: those of a mesh that is cut by itself, and another has none") {
        const Walls s;
        const crofton_mesh mesh = s.large.mesh();
        crofton_clustered_mesh* made = nullptr;
        REQUIRE(crofton_clustered_mesh_create(&mesh, 0, &made) == CROFTON_OK);
        const ClusteredMesh owner(made);
        crofton_clusters expected{};
        REQUIRE(crofton_clustered_mesh_get(made, &expected) == CROFTON_OK);
        auto info = sized<crofton_mesh_info>();
        REQUIRE(crofton_world_get_mesh(s.world.get(), s.meshes[0], &info) == CROFTON_OK);
        REQUIRE(info.clusters.cluster_count == expected.cluster_count);
        REQUIRE(info.clusters.triangle_count == 200);
        CHECK(std::memcmp(info.clusters.clusters, expected.clusters,
                          expected.cluster_count * sizeof *expected.clusters) == 0);
        CHECK(std::equal(expected.triangle_order, expected.triangle_order + 200, info.clusters.triangle_order));
        std::vector<std::uint32_t> permuted(600);
        REQUIRE(crofton_permute_triangles(&info.clusters, s.large.indices.data(), 600, permuted.data()) == CROFTON_OK);
        for (std::size_t k = 0; k < 600; ++k)
            CHECK(permuted[k] == s.large.indices[3 * info.clusters.triangle_order[k / 3] + k % 3]);
        const crofton_world_mesh plain = add_tetrahedron(s.world);
        update(s.world);
        REQUIRE(crofton_world_get_mesh(s.world.get(), plain, &info) == CROFTON_OK);
        CHECK((info.clusters.clusters == nullptr && info.clusters.cluster_count == 0 && info.occluder_count == 0));
        REQUIRE(crofton_world_remove_mesh(s.world.get(), plain) == CROFTON_OK);
        CHECK(crofton_world_get_mesh(s.world.get(), plain, &info) == CROFTON_STALE_HANDLE);
    }

    TEST_CASE("a picture that cannot be obeyed is refused by name, alone and among many") {
        Walls s;
        const ViewResultHandle result = make_view_result();
        crofton_view_request request = s.request();
        const auto ask = [&](crofton_status expected, const char* says) {
            CAPTURE(says);
            CHECK(crofton_world_view(s.world.get(), &request, 1, nullptr, result.get()) == expected);
            CHECK(mentions(crofton_last_error(), says));
            const crofton_view_request two[2] = {request_of(s.camera), request};
            CHECK(crofton_world_view(s.world.get(), two, 2, nullptr, result.get()) == expected);
            CHECK(crofton_last_error_item() == 1);
        };
        const crofton_occlusion_options occlusion = crofton_default_occlusion_options();
        request.occlusion = &occlusion;
        ask(CROFTON_INVALID_ARGUMENT, "`occlusion` or `picture`");
        request.occlusion = nullptr;
        const View view = default_view();
        request.camera = nullptr;
        request.volume = &view.frustum;
        ask(CROFTON_INVALID_ARGUMENT, "picture needs");
        request.volume = nullptr;
        const glm::dmat4 to_clip = crofton::world_to_clip(crofton::Camera{});
        crofton_view_matrix matrix = crofton_default_view_matrix();
        matrix.doubles = &to_clip[0][0];
        request.matrix = &matrix;
        CHECK(crofton_world_view(s.world.get(), &request, 1, nullptr, result.get()) == CROFTON_OK);
        CHECK(listed(info_of(result)) == s.expected());
        s.picture.depth = CROFTON_DEPTH_ZERO_TO_ONE;
        ask(CROFTON_INVALID_ARGUMENT, "depth range");
        s.picture.depth = 3;
        ask(CROFTON_INVALID_ARGUMENT, "depth range");
        s.picture.depth = 0;
        s.picture.width = 0;
        ask(CROFTON_OUT_OF_RANGE, "pixels");
        s.picture.width = 160;
        s.picture.size += 8;
        ask(CROFTON_WRONG_SIZE, "size");
        s.picture.size = sizeof s.picture;
        // A request of an older header ends before the picture.
        request.size = offsetof(crofton_view_request, picture);
        REQUIRE(crofton_world_view(s.world.get(), &request, 1, nullptr, result.get()) == CROFTON_OK);
        CHECK((info_of(result).triangle_cluster_count == 0 && ids_of(result).size() == 4));
    }

    TEST_CASE("an object that is added hidden is in no answer until it is shown, and members are set together") {
        Walls s;
        auto description = sized<crofton_object_description>();
        const crofton_bound bound = box_bound(box_at(0, 0, -3));
        description.bound = &bound;
        description.hidden = 1;
        description.user = 5;
        crofton_object object{};
        REQUIRE(crofton_world_add(s.world.get(), &description, &object) == CROFTON_OK);
        update(s.world);
        const ViewResultHandle result = make_view_result();
        const auto is_seen = [&](std::uint32_t layers) {
            crofton_view_request request = request_of(s.camera);
            request.layers = layers;
            REQUIRE(crofton_world_view(s.world.get(), &request, 1, nullptr, result.get()) == CROFTON_OK);
            const auto ids = ids_of(result);
            return std::find(ids.begin(), ids.end(), object.index) != ids.end();
        };
        CHECK_FALSE(is_seen(~0u));
        const crofton_bound away = box_bound(box_at(0, 0, 3));
        description.hidden = 0;
        description.layers = 4;
        description.user = 6;
        constexpr std::uint32_t kMembers = CROFTON_SET_HIDDEN | CROFTON_SET_LAYERS | CROFTON_SET_USER;
        REQUIRE(crofton_world_set(s.world.get(), object, kMembers, &description) == CROFTON_OK);
        update(s.world);
        CHECK((is_seen(4) && !is_seen(3)));
        // Refused as a whole: of the members that could be set none is.
        description.bound = &away;
        description.layers = 1;
        description.user = 7;
        description.has_mesh = 1;
        description.mesh = s.meshes[0];
        CHECK(crofton_world_set(s.world.get(), object, CROFTON_SET_MESH | CROFTON_SET_USER, &description) ==
              CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_world_set(s.world.get(), object, CROFTON_SET_OCCLUDES | CROFTON_SET_LAYERS, &description) ==
              CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_world_set(s.world.get(), {object.index, object.generation + 1}, CROFTON_SET_USER, &description) ==
              CROFTON_STALE_HANDLE);
        CHECK(crofton_world_set(s.world.get(), {object.index, object.generation + 1}, 0, &description) ==
              CROFTON_STALE_HANDLE);
        update(s.world);
        auto info = sized<crofton_object_info>();
        REQUIRE(crofton_world_get_object(s.world.get(), object, &info) == CROFTON_OK);
        CHECK(info.user == 6);
        CHECK((is_seen(4) && !is_seen(1)));
        REQUIRE(crofton_world_set(s.world.get(), object, CROFTON_SET_BOUND | CROFTON_SET_USER, &description) ==
                CROFTON_OK);
        update(s.world);
        REQUIRE(crofton_world_get_object(s.world.get(), object, &info) == CROFTON_OK);
        CHECK((info.user == 7 && info.box.center[2] == 3));
        CHECK_FALSE(is_seen(4));
    }
}
