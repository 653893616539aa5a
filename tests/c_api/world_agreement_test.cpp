// SPDX-License-Identifier: MIT
// World in C answers what World in C++ answers, bit for bit.
#include <cmath>
#include <crofton/convex/query.hpp>
#include <crofton/world/object_manifold.hpp>
#include <cstring>
#include <limits>

#include "../view_request.hpp"
#include "both_worlds.hpp"

using namespace crofton;
using namespace crofton::capi_test;
using oracle::NearMisses;

namespace {

bool same_ref(const BothWorlds& both, const crofton_object_ref& a, const ObjectRef& b) {
    return both.twin<ObjectHandle>(a.object) == b.object && a.user == b.user;
}
bool same_vector(const double* a, const glm::dvec3& b) {
    return a[0] == b.x && a[1] == b.y && a[2] == b.z;
}
bool same_hit(const BothWorlds& both, const crofton_object_hit& a, const ObjectHit& b) {
    return same_ref(both, {a.object, a.user}, {b.object, b.user}) && a.t == b.t && same_vector(a.point, b.point) &&
           a.triangle == b.triangle && a.child == b.child && same_vector(a.normal, b.normal) &&
           (a.started_inside == 1) == b.started_inside;
}

void compare_objects(const BothWorlds& both) {
    for (std::size_t i = 0; i < both.objects.size(); ++i) {
        crofton_box box{};
        crofton_transform transform{};
        std::uint64_t user = 0;
        int contains = 0;
        REQUIRE(world_contains(both.c.get(), both.objects[i], &contains) == CROFTON_OK);
        REQUIRE((contains == 1) == both.world.contains(both.object(i)));
        const auto expected = both.world.box_of(both.object(i));
        REQUIRE((world_get_box(both.c.get(), both.objects[i], &box) == CROFTON_OK) == expected.has_value());
        if (!contains) continue;
        if (expected) CHECK(std::memcmp(&box, &*expected, sizeof box) == 0);
        REQUIRE(world_get_user(both.c.get(), both.objects[i], &user) == CROFTON_OK);
        CHECK(user == both.world.user_of(both.object(i)).value());
        const auto place = both.world.transform_of(both.object(i));
        REQUIRE((world_get_transform(both.c.get(), both.objects[i], &transform) == CROFTON_OK) == place.has_value());
        if (place) CHECK(std::memcmp(&transform, &*place, sizeof transform) == 0);
    }
}

std::size_t compare_contacts(const BothWorlds& both) {
    const crofton_object_pair* pairs = nullptr;
    std::size_t count = 0;
    REQUIRE(crofton_world_pairs(both.c.get(), &pairs, &count) == CROFTON_OK);
    REQUIRE(count == both.world.pairs().size());
    for (std::size_t i = 0; i < count; ++i) {
        CHECK(same_ref(both, pairs[i].first, both.world.pairs()[i].first));
        CHECK(same_ref(both, pairs[i].second, both.world.pairs()[i].second));
    }
    REQUIRE(world_contact_count(both.c.get(), &count) == CROFTON_OK);
    REQUIRE(count == both.world.contacts().size());
    for (std::size_t i = 0; i < count; ++i) {
        const Contact& expected = both.world.contacts()[i];
        crofton_object_contact contact{};
        REQUIRE(world_contact(both.c.get(), i, &contact) == CROFTON_OK);
        CHECK(same_ref(both, contact.first, expected.first));
        CHECK(same_ref(both, contact.second, expected.second));
        CHECK(contact.phase == static_cast<std::uint32_t>(expected.phase));
        CHECK(contact.inside == static_cast<std::uint32_t>(expected.inside));
        CHECK(same_vector(contact.normal, expected.normal));
        CHECK(contact.depth == expected.depth);
        REQUIRE(contact.point_count == expected.points.size());
        for (std::size_t k = 0; k < contact.point_count; ++k) {
            CHECK(same_vector(contact.points[k].position, expected.points[k].position));
            CHECK(contact.points[k].depth == expected.points[k].depth);
        }
        REQUIRE(contact.triangle_count == expected.triangles.size());
        for (std::size_t k = 0; k < contact.triangle_count; ++k) {
            CHECK(contact.triangles[k].triangles.first == expected.triangles[k].triangles.first);
            CHECK(contact.triangles[k].triangles.second == expected.triangles[k].triangles.second);
            CHECK(same_vector(contact.triangles[k].begin, expected.triangles[k].segment.begin));
            CHECK(same_vector(contact.triangles[k].end, expected.triangles[k].segment.end));
            CHECK(same_vector(contact.triangles[k].normal, expected.triangles[k].normal));
        }
    }
    return count;
}

void compare_visible(const BothWorlds& both, const crofton_view_result* c, const ViewResult& expected) {
    const std::uint32_t* ids = nullptr;
    const std::uint8_t* verdicts = nullptr;
    std::size_t count = 0, inside = 0;
    REQUIRE(crofton_view_result_ids(c, &ids, &count, &verdicts, &inside) == CROFTON_OK);
    REQUIRE(count == expected.size());
    CHECK(inside == expected.inside_count());
    CHECK((verdicts == nullptr) == expected.verdicts().empty());
    std::vector<crofton_object_ref> refs(count);
    const std::size_t half = count / 2;
    REQUIRE(crofton_view_result_list(c, both.c.get(), 0, refs.data(), nullptr, half) == CROFTON_OK);
    REQUIRE(crofton_view_result_list(c, both.c.get(), half, refs.data() + half, nullptr, count) == CROFTON_OK);
    for (std::size_t i = 0; i < count; ++i) {
        CHECK(ids[i] == expected.ids()[i]);
        CHECK(same_ref(both, refs[i], expected[i]));
        if (verdicts) CHECK(verdicts[i] == static_cast<std::uint8_t>(expected.verdicts()[i]));
    }
    auto statistics = sized<crofton_view_info>();
    REQUIRE(crofton_view_result_get_view(c, 0, &statistics) == CROFTON_OK);
    CHECK(statistics.boxes_tested == expected.statistics().boxes_tested);
    CHECK(statistics.straddling == expected.statistics().straddling);
}

std::size_t compare_views(const BothWorlds& both, NearMisses& random) {
    const ViewResultHandle seen = make_view_result();
    ViewResult visible;
    std::array<cull::View, 3> views{};
    std::array<View, 3> c_views{};
    std::size_t total = 0;
    for (std::size_t v = 0; v < views.size(); ++v) {
        const Camera camera = random.camera();
        auto c_camera = sized<crofton_camera>();
        std::memcpy(c_camera.position, &camera.position, sizeof c_camera.position);
        std::memcpy(c_camera.forward, &camera.forward, sizeof c_camera.forward);
        std::memcpy(c_camera.up, &camera.up, sizeof c_camera.up);
        c_camera.projection = static_cast<std::uint32_t>(camera.projection);
        c_camera.fov_y = camera.fov_y;
        c_camera.height = camera.height;
        c_camera.aspect = camera.aspect;
        c_camera.near_distance = camera.near_distance;
        c_camera.far_distance = camera.far_distance;
        crofton_view_request request = request_of(c_camera);
        request.tree_order = v % 2;
        const cull::CullOptions cull_options{.order = v % 2 ? cull::ResultOrder::tree : cull::ResultOrder::ascending};
        REQUIRE(crofton_world_view(both.c.get(), &request, 1, &both.jobs, seen.get()) == CROFTON_OK);
        REQUIRE(both.world.view({.camera = camera, .order = cull_options.order}, visible).has_value());
        compare_visible(both, seen.get(), visible);
        total += visible.size();
        views[v] = {.frustum = frustum_of(camera).value(), .layer_mask = 1u << random.index(4) | 1u};
        c_views[v] = View();
        c_views[v].layer_mask = views[v].layer_mask;
        c_views[v].frustum.size = sizeof(crofton_frustum);
        REQUIRE(crofton_frustum_from_camera(&c_camera, &c_views[v].frustum) == CROFTON_OK);
        request = request_of(c_views[v]);
        request.tree_order = v % 2;
        REQUIRE(crofton_world_view(both.c.get(), &request, 1, nullptr, seen.get()) == CROFTON_OK);
        REQUIRE(both.world.view(request_of(views[v], cull_options.order), visible).has_value());
        compare_visible(both, seen.get(), visible);
    }
    const ViewResultHandle in_views = make_view_result();
    MultiViewResult expected;
    REQUIRE(look_at_many(both.c.get(), c_views, in_views.get()) == CROFTON_OK);
    REQUIRE(both.world.view(requests_of(views), expected).has_value());
    const std::uint32_t* ids = nullptr;
    std::size_t count = 0;
    REQUIRE(crofton_view_result_ids(in_views.get(), &ids, &count, nullptr, nullptr) == CROFTON_OK);
    REQUIRE(count == expected.size());
    std::vector<crofton_object_ref> refs(count);
    std::vector<std::uint32_t> masks(count);
    REQUIRE(crofton_view_result_list(in_views.get(), both.c.get(), 0, refs.data(), masks.data(), count) == CROFTON_OK);
    for (std::size_t i = 0; i < count; ++i) {
        CHECK(ids[i] == expected.ids()[i]);
        CHECK(same_ref(both, refs[i], expected[i]));
        CHECK(masks[i] == expected.view_mask(i));
    }
    return total;
}

std::size_t compare_rays(const BothWorlds& both, NearMisses& random) {
    const Found found = make_found();
    Vector<ObjectHit> expected;
    std::array<Ray, 12> rays{};
    std::array<crofton_ray, 12> c_rays{};
    std::array<crofton_object_hit, 12> hits{};
    for (std::size_t i = 0; i < rays.size(); ++i) {
        rays[i].origin = 30.0 * random.direction();
        rays[i].direction = -rays[i].origin + 4.0 * random.direction();
        if (random.index(3) == 0) rays[i].max_t = random.number(0.0, 2.0);
        c_rays[i] = same_bytes<crofton_ray>(rays[i]);
    }
    const std::uint32_t layers = random.index(15) + 1;
    const crofton_query_filter filter = in_layers(layers);
    REQUIRE(crofton_world_raycast(both.c.get(), c_rays.data(), rays.size(), &filter, hits.data()) == CROFTON_OK);
    std::size_t total = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const auto nearest = both.world.raycast(rays[i], {layers});
        CHECK((hits[i].object.index != CROFTON_NONE) == nearest.has_value());
        CHECK((nearest ? same_hit(both, hits[i], *nearest) : std::isinf(hits[i].t)));
        int any = 7;
        REQUIRE(crofton_world_raycast_any(both.c.get(), &c_rays[i], &filter, &any) == CROFTON_OK);
        CHECK(any == (nearest ? 1 : 0));
        REQUIRE(crofton_world_raycast_all(both.c.get(), &c_rays[i], &filter, found.get()) == CROFTON_OK);
        both.world.raycast_all(rays[i], expected, {layers});
        const crofton_object_hit* all = nullptr;
        std::size_t count = 0;
        REQUIRE(crofton_found_hits(found.get(), &all, &count) == CROFTON_OK);
        REQUIRE(count == expected.size());
        for (std::size_t k = 0; k < count; ++k) CHECK(same_hit(both, all[k], expected[k]));
        total += count;
    }
    return total;
}

void compare_found(const BothWorlds& both, const Found& found, const Vector<ObjectRef>& expected) {
    const crofton_object_ref* objects = nullptr;
    const crofton_object_hit* hits = nullptr;
    std::size_t count = 0;
    REQUIRE(crofton_found_objects(found.get(), &objects, &count) == CROFTON_OK);
    REQUIRE(count == expected.size());
    for (std::size_t i = 0; i < count; ++i) CHECK(same_ref(both, objects[i], expected[i]));
    REQUIRE(crofton_found_hits(found.get(), &hits, &count) == CROFTON_OK);
    CHECK(count == 0);
}

void compare_closest(const BothWorlds& both, const crofton_closest_object& c,
                     const std::optional<ClosestObject>& expected) {
    CHECK((c.object.index != CROFTON_NONE) == expected.has_value());
    if (!expected) return;
    CHECK(same_ref(both, {c.object, c.user}, {expected->object, expected->user}));
    CHECK(c.distance == expected->distance);
    CHECK(same_vector(c.on_shape, expected->on_shape));
    CHECK(same_vector(c.on_object, expected->on_object));
    CHECK(c.triangle == expected->triangle);
    CHECK(c.child == expected->child);
}

bool same_shape_hit(const BothWorlds& both, const crofton_shape_hit& a, const ShapeHit& b) {
    return same_ref(both, {a.object, a.user}, {b.object, b.user}) && a.time == b.time &&
           same_vector(a.normal, b.normal) && same_vector(a.point, b.point) && a.triangle == b.triangle &&
           a.child == b.child && (a.result == CROFTON_CAST_HIT) == b.resolved && a.distance == b.distance;
}

// Returns how many hits and manifolds there were.
std::size_t compare_probes(const BothWorlds& both, NearMisses& random) {
    const auto half_height = static_cast<float>(random.number(0.5, 4.0));
    crofton_shape* made = nullptr;
    REQUIRE(shape_round(CROFTON_SHAPE_CAPSULE, half_height, 1.5f, &made) == CROFTON_OK);
    const ShapeHandle c_probe(made);
    const convex::Shape probe = convex::Shape::capsule(half_height, 1.5f).value();
    const Transform place{glm::dmat3(1.0), 20.0 * random.direction()};
    const RigidTransform pose{place.linear, place.translation};
    const auto c_place = same_bytes<crofton_transform>(place);
    const crofton_placed placed{c_probe.get(), &c_place};
    const convex::Motion motion{-2.0 * place.translation};
    crofton_motion c_motion{};
    std::memcpy(c_motion.velocity, &motion.velocity, sizeof c_motion.velocity);
    const std::uint32_t layers = random.index(15) + 1;
    const crofton_query_filter filter = in_layers(layers);
    crofton_world* const c = both.c.get();

    auto hit = sized<crofton_shape_hit>();
    REQUIRE(crofton_world_cast(c, &placed, &c_motion, nullptr, &filter, &hit) == CROFTON_OK);
    const auto first = both.world.cast(probe, pose, motion, {}, {layers}).value();
    REQUIRE((hit.object.index != CROFTON_NONE) == first.has_value());
    if (first) CHECK(same_shape_hit(both, hit, *first));
    const Found found = make_found();
    std::size_t hit_count = 0, manifold_count = 0;
    const crofton_shape_hit* hits = nullptr;
    Vector<ShapeHit> expected;
    REQUIRE(crofton_world_cast_all(c, &placed, &c_motion, nullptr, &filter, found.get()) == CROFTON_OK);
    REQUIRE(crofton_found_shape_hits(found.get(), &hits, &hit_count) == CROFTON_OK);
    REQUIRE(both.world.cast_all(probe, pose, motion, {}, expected, {layers}).has_value());
    REQUIRE(hit_count == expected.size());
    for (std::size_t i = 0; i < hit_count; ++i) {
        CHECK(hits[i].size == sizeof *hits);
        CHECK(same_shape_hit(both, hits[i], expected[i]));
    }
    auto options = sized<crofton_manifold_options>();
    options.margin = 2.0;
    options.max_points = 6;
    const crofton_object_manifold* manifolds = nullptr;
    Vector<ObjectManifold> touched;
    REQUIRE(crofton_world_manifolds(c, &placed, &options, &filter, found.get()) == CROFTON_OK);
    REQUIRE(crofton_found_manifolds(found.get(), &manifolds, &manifold_count) == CROFTON_OK);
    REQUIRE(both.world.contact_manifolds(probe, pose, {2.0, 6}, touched, {layers}).has_value());
    REQUIRE(manifold_count == touched.size());
    for (std::size_t i = 0; i < manifold_count; ++i) {
        const convex::Manifold& manifold = touched[i].manifold;
        CHECK(same_ref(both, {manifolds[i].object, manifolds[i].user}, {touched[i].object, touched[i].user}));
        CHECK(same_vector(manifolds[i].normal, manifold.normal));
        CHECK(manifolds[i].depth == manifold.depth);
        REQUIRE(manifolds[i].point_count == static_cast<std::uint32_t>(manifold.count));
        for (int k = 0; k < manifold.count; ++k) {
            const crofton_shape_point& point = manifolds[i].points[k];
            CHECK(same_vector(point.position, manifold.points[k].position));
            CHECK(point.depth == manifold.points[k].depth);
            CHECK(point.part_b.triangle == manifold.points[k].part_b.triangle);
            CHECK(point.on_b.index == manifold.points[k].on_b.index);
        }
    }
    REQUIRE(crofton_found_shape_hits(found.get(), &hits, &hit_count) == CROFTON_OK);
    CHECK(hit_count == 0);
    return expected.size() + manifold_count;
}

void compare_shapes(const BothWorlds& both, NearMisses& random) {
    const Found found = make_found();
    Vector<ObjectRef> expected;
    crofton_world* const c = both.c.get();
    const Obb box = oracle::random_box(random, {}, 20.0);
    const auto c_box = same_bytes<crofton_box>(box);
    const Sphere sphere{box.center, random.number(0.0, 6.0)};
    const collide::Capsule capsule{box.center, 10.0 * random.direction(), random.number(0.0, 3.0)};
    const std::uint32_t layers = random.index(15) + 1;
    const crofton_query_filter filter = in_layers(layers);
    const double limit = random.index(2) ? 1.0 : std::numeric_limits<double>::infinity();
    auto closest = sized<crofton_closest_object>();
    REQUIRE(world_overlap(c, &c_box, &filter, found.get()) == CROFTON_OK);
    both.world.overlap(box, expected, {layers});
    compare_found(both, found, expected);
    REQUIRE(world_overlap_sphere(c, &sphere.center.x, sphere.radius, &filter, found.get()) == CROFTON_OK);
    both.world.overlap(sphere, expected, {layers});
    compare_found(both, found, expected);
    REQUIRE(world_overlap_capsule(c, &capsule.begin.x, &capsule.end.x, capsule.radius, &filter, found.get()) ==
            CROFTON_OK);
    both.world.overlap(capsule, expected, {layers});
    compare_found(both, found, expected);
    REQUIRE(world_closest(c, &c_box, limit, &filter, &closest) == CROFTON_OK);
    compare_closest(both, closest, both.world.closest(box, limit, {layers}));
    REQUIRE(world_closest_to_sphere(c, &sphere.center.x, sphere.radius, limit, &filter, &closest) == CROFTON_OK);
    compare_closest(both, closest, both.world.closest(sphere, limit, {layers}));
    REQUIRE(world_closest_to_capsule(c, &capsule.begin.x, &capsule.end.x, capsule.radius, limit, &filter, &closest) ==
            CROFTON_OK);
    compare_closest(both, closest, both.world.closest(capsule, limit, {layers}));
}

void compare_statistics(const BothWorlds& both) {
    auto c = sized<crofton_world_statistics>();
    std::size_t count = 0;
    REQUIRE(crofton_world_get_statistics(both.c.get(), &c) == CROFTON_OK);
    REQUIRE(world_object_count(both.c.get(), &count) == CROFTON_OK);
    const WorldStatistics& expected = both.world.statistics();
    CHECK(count == both.world.object_count());
    CHECK(c.objects == expected.objects);
    CHECK(c.resting == expected.resting);
    CHECK(c.moving == expected.moving);
    CHECK(c.box_pairs_tested == expected.box_pairs_tested);
    CHECK(c.contact_pairs_tested == expected.contact_pairs_tested);
    CHECK(c.boxes_changed == expected.boxes_changed);
    CHECK(c.nodes_updated == expected.nodes_updated);
    CHECK(c.out_of_range == expected.out_of_range);
    CHECK(c.tree_built == (expected.tree_built ? 1u : 0u));
}

}  // namespace

TEST_SUITE("capi/world agreement") {
    TEST_CASE("a scene of meshes, nodes and bounds that changes is answered as in C++, bit for bit") {
        NearMisses random(71);
        BothWorlds both;
        const auto meshes = add_meshes(both);
        add_nodes(both, random, 12);
        for (int i = 0; i < 400; ++i) add_object(both, random, meshes);
        std::size_t seen = 0, hit = 0, touching = 0, probed = 0;
        for (int frame = 0; frame < 12; ++frame) {
            CAPTURE(frame);
            if (frame > 0) change(both, random);
            REQUIRE(crofton_world_update(both.c.get(), &both.jobs) == CROFTON_OK);
            REQUIRE(both.world.update().has_value());
            compare_statistics(both);
            compare_objects(both);
            touching += compare_contacts(both);
            seen += compare_views(both, random);
            hit += compare_rays(both, random);
            compare_shapes(both, random);
            for (int i = 0; i < 5; ++i) probed += compare_probes(both, random);
        }
        // The comparison is of something.
        CHECK(probed > 100);
        CHECK(seen > 100);
        CHECK(hit > 100);
        CHECK(touching > 100);
    }

    TEST_CASE("bounds, meshes and vertices are exchanged as in C++") {
        NearMisses random(72);
        BothWorlds both;
        const auto meshes = add_meshes(both);
        add_nodes(both, random, 3);
        for (int i = 0; i < 40; ++i) add_object(both, random, meshes);
        crofton_world* const c = both.c.get();
        for (int frame = 0; frame < 6; ++frame) {
            CAPTURE(frame);
            for (int i = 0; i < 5; ++i) {
                const std::size_t o = random.index(static_cast<unsigned>(both.objects.size()));
                crofton_bound bound{};
                Bound expected;
                random_bound(random, bound, expected);
                const crofton_world_mesh mesh = meshes[random.index(2)];
                CHECK((world_set_bound(c, both.objects[o], &bound) == CROFTON_OK) == !both.has_mesh[o]);
                CHECK(both.world.set_bound(both.object(o), expected).has_value() == !both.has_mesh[o]);
                CHECK((world_set_mesh(c, both.objects[o], mesh) == CROFTON_OK) == both.has_mesh[o]);
                CHECK(both.world.set_mesh(both.object(o), both.twin<MeshHandle>(mesh)).has_value() == both.has_mesh[o]);
            }
            std::vector<float> positions;
            for (int k = 0; k < 12; ++k) positions.push_back(static_cast<float>(random.number(-2, 2)));
            auto data = sized<crofton_mesh_data>();
            data.positions = positions.data();
            data.position_count = 4;
            const PointsView points(positions.data(), 4);
            REQUIRE(crofton_world_set_vertices(c, meshes[0], &data) == CROFTON_OK);
            REQUIRE(both.world.set_vertices(both.twin<MeshHandle>(meshes[0]), points).has_value());
            const std::vector<std::uint32_t> indices{0, 1, 2, 0, 2, 3};
            data.indices = indices.data();
            data.index_count = indices.size();
            data.triangles = frame % 2 == 0;
            REQUIRE(crofton_world_replace_mesh(c, meshes[1], &data) == CROFTON_OK);
            REQUIRE(both.world
                        .replace_mesh(both.twin<MeshHandle>(meshes[1]),
                                      {.positions = points, .indices = indices, .triangles = frame % 2 == 0})
                        .has_value());
            REQUIRE(crofton_world_update(c, nullptr) == CROFTON_OK);
            REQUIRE(both.world.update().has_value());
            compare_statistics(both);
            compare_objects(both);
            compare_contacts(both);
            compare_rays(both, random);
        }
        CHECK(crofton_world_remove_mesh(c, meshes[0]) != CROFTON_OK);  // in use
        int contains = 0;
        CHECK(world_contains_mesh(c, meshes[0], &contains) == CROFTON_OK);
        CHECK(contains == 1);
        REQUIRE(crofton_world_remove_node(c, both.nodes[0]) == CROFTON_OK);
        REQUIRE(both.world.remove(both.node(0)).has_value());
        CHECK(crofton_world_contains_node(c, both.nodes[0], &contains) == CROFTON_OK);
        CHECK(contains == 0);
        REQUIRE(crofton_world_update(c, nullptr) == CROFTON_OK);
        REQUIRE(both.world.update().has_value());
        compare_objects(both);
    }
}
