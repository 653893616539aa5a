// SPDX-License-Identifier: MIT
// Worlds of regions: as if each object had been added by itself.
#include <doctest/doctest.h>
#include <algorithm>
#include <bit>
#include <chrono>
#include <counting_memory.hpp>
#include <crofton/convex/query.hpp>
#include <crofton/crofton.hpp>
#include <crofton/world/object_manifold.hpp>
#include <error_of.hpp>
#include <map>
#include <oracle/random_boxes.hpp>
#include <thread>
#include <tuple>
#include <vector>

#include "box_at.hpp"
#include "occlusion_town.hpp"

using namespace crofton;
using oracle::NearMisses;
using testing::box_at;

namespace {

// Worlds with the same objects: one has regions, another has each object by itself, where the region puts it, and a
// third has, for each object with a mesh or a shape in a region, the box that the region gave it: views and pairs ask
// that box. An object has the same number in all: its user data.
struct TwoWorlds {
    struct Attached {
        RegionHandle handle;
        std::vector<ObjectHandle> singles, boxes;
        std::vector<std::uint64_t> numbers;
        glm::dvec3 origin;
    };
    struct Own {
        ObjectHandle with, single, boxed;
    };
    World with, single, boxes;
    std::vector<MeshHandle> single_meshes;  // by the places of a region's meshes
    std::vector<bool> is_solid;             // by number
    std::map<RegionHandle, Attached> attached;
    std::map<ObjectHandle, std::uint64_t> numbers;  // of regions' objects, also of those that are gone
    std::vector<Own> own;
    std::uint64_t next_number = 1;

    explicit TwoWorlds(const WorldOptions& options = {.pairs = false})
        : with(options), single(options), boxes(options) {}

    RegionHandle attach(const Region& region, const std::vector<RegionObject>& objects, const glm::dvec3& origin) {
        Attached added{with.attach(region, origin).value(), {}, {}, {}, origin};
        for (const RegionObject& object : objects) {
            ObjectDescription description{.bound = object.bound,
                                          .shape = object.shape,
                                          .user = next_number,
                                          .layers = object.layers,
                                          .collides_with = object.collides_with,
                                          .occludes = object.occludes,
                                          .only_occludes = object.only_occludes};
            description.bound.box.center += origin;
            if (object.mesh != kNoIndex) description.mesh = single_meshes[object.mesh];
            if (object.bound.kind == BoundKind::none) {
                description.transform = object.transform;
                description.transform->translation += origin;
            }
            added.numbers.push_back(next_number);
            const auto place = static_cast<std::uint32_t>(added.singles.size());
            const ObjectHandle in_region = with.object_in(added.handle, place).value();
            numbers[in_region] = next_number;
            added.singles.push_back(single.add(description).value());
            const Obb box = with.box_of(in_region).value();
            const bool stays = description.bound.kind != BoundKind::none &&
                               box.center == description.bound.box.center &&
                               box.half_extents == description.bound.box.half_extents;
            const bool is_hidden = object.only_occludes || object.transform.linear == glm::dmat3(0.0);
            added.boxes.push_back(boxes
                                      .add({.bound = stays ? description.bound : Bound(box),
                                            .user = next_number,
                                            .layers = is_hidden ? 0 : object.layers,
                                            .collides_with = object.collides_with})
                                      .value());
            is_solid.resize(next_number + 1, false);
            is_solid[next_number++] = object.mesh != kNoIndex || object.shape != nullptr;
        }
        const RegionHandle handle = added.handle;
        attached.emplace(handle, std::move(added));
        return handle;
    }
    void detach(RegionHandle region) {
        with.detach(region).value();
        for (const ObjectHandle object : attached.at(region).singles) single.remove(object).value();
        for (const ObjectHandle object : attached.at(region).boxes) boxes.remove(object).value();
        attached.erase(region);
    }
    void add(const Bound& bound, std::uint32_t layers) {
        const ObjectDescription description{.bound = bound, .user = next_number++, .layers = layers};
        own.push_back({with.add(description).value(), single.add(description).value(), boxes.add(description).value()});
    }
    void hide(RegionHandle region, std::size_t place, bool hidden) {
        const ObjectHandle object = with.object_in(region, static_cast<std::uint32_t>(place)).value();
        with.set_hidden(object, hidden).value();
        single.set_hidden(attached.at(region).singles[place], hidden).value();
        boxes.set_hidden(attached.at(region).boxes[place], hidden).value();
    }
    void update() {
        with.update().value();
        single.update().value();
        boxes.update().value();
    }
    // Of an answer of the World with regions.
    [[nodiscard]] std::uint64_t number(const ObjectRef& ref) const {
        if (ref.object.index < kFirstRegionIndex) return ref.user;
        if (!with.contains(ref.object)) return numbers.at(ref.object);
        const RegionPlace place = with.place_of(ref.object).value();
        CHECK(with.object_in(place.region, place.index).value() == ref.object);
        return attached.at(place.region).numbers[place.index];
    }
};

std::vector<std::uint64_t> numbers_of(const TwoWorlds& worlds, const Vector<ObjectRef>& found) {
    std::vector<std::uint64_t> numbers;
    for (const ObjectRef& ref : found) numbers.push_back(worlds.number(ref));
    std::sort(numbers.begin(), numbers.end());
    return numbers;
}

// Boxes and spheres on a grid, so that they touch each other and planes, and some off it.
RegionObject random_object(NearMisses& random, double place) {
    const auto number = [&] { return 0.5 * std::floor(random.number(-2.0 * place, 2.0 * place)); };
    RegionObject object;
    Obb box;
    const double x = number(), y = number(), z = number();
    box.center = {x, y, z};
    const unsigned a = random.index(3), b = random.index(3), c = random.index(3);
    box.half_extents = 0.5f * glm::vec3(a, b, c + 1);
    object.bound = box;
    const unsigned kind = random.index(6);
    if (kind == 0) object.bound = Sphere{box.center, 0.5 * random.index(4)};
    if (kind == 1) object.bound = oracle::random_box(random, box.center + random.number(-1.0, 1.0), 1.0);
    if (kind == 2) object.bound = Aabb{box.center - 0.75, box.center + 0.25};
    object.user = random.index(1000);
    if (random.index(4) == 0) object.layers = 1u << random.index(3);
    return object;
}

// Meshes and shapes that objects of regions have: closed and open, round and flat.
struct Solids {
    std::vector<TriangleMesh> triangles{testing::cuboid({0.75f, 0.5f, 1.0f}), testing::cuboid({0.3f, 1.5f, 0.25f}), {}};
    convex::Hull wedge =
        convex::Hull::build(std::vector<glm::vec3>{{0, 0, 0}, {1.5f, 0, 0}, {0, 1, 0}, {0, 0, 1}}).value();
    std::vector<convex::Shape> shapes{convex::Shape::capsule(0.5f, 0.25f).value(), convex::Shape::sphere(0.75).value(),
                                      convex::Shape::box({0.5f, 1.0f, 0.25f}).value(), convex::Shape::hull(wedge)};
    std::vector<RegionMesh> meshes;

    Solids() {
        // A curved sheet, and the same without triangles for queries.
        for (int i = 0; i <= 6; ++i)
            for (int j = 0; j <= 6; ++j)
                triangles[2].positions.push_back({0.4f * static_cast<float>(i) - 1.2f,
                                                  0.05f * static_cast<float>(i * j) - 0.5f,
                                                  0.4f * static_cast<float>(j) - 1.2f});
        for (std::uint32_t i = 0; i < 6; ++i)
            for (std::uint32_t j = 0; j < 6; ++j) {
                const std::uint32_t a = 7 * i + j;
                for (const std::uint32_t corner : {a, a + 1, a + 7, a + 1, a + 8, a + 7})
                    triangles[2].indices.push_back(corner);
            }
        for (const TriangleMesh& mesh : triangles) meshes.push_back({.mesh = testing::description_of(mesh, false)});
        for (RegionMesh& mesh : meshes) mesh.mesh.clusters = true;
    }
    void add_to(TwoWorlds& worlds) const {
        for (const RegionMesh& mesh : meshes) worlds.single_meshes.push_back(worlds.single.add_mesh(mesh.mesh).value());
    }
    [[nodiscard]] static Transform transform(NearMisses& random, double place, bool any_map) {
        const double x = random.number(-place, place), y = random.number(-place, place),
                     z = random.number(-place, place);
        Transform result{glm::dmat3(1.0), {x, y, z}};
        if (random.index(4) != 0) result.linear = glm::dmat3(oracle::random_box(random, {}, 1.0).axes);
        const unsigned scale = random.index(any_map ? 6 : 2);
        if (scale == 1) result.linear *= 1.5;
        if (scale == 2) result.linear[0] *= -1.0;
        if (scale == 3) result.linear[1] *= 0.4;
        if (scale == 4) result.linear[2] += 0.3 * result.linear[0];
        if (scale == 5 && random.index(8) == 0) result.linear = glm::dmat3(0.0);
        return result;
    }
    // Makes an object one with a mesh, a shape, or both.
    void change(NearMisses& random, RegionObject& object, double place) const {
        const unsigned kind = random.index(5);
        const bool has_mesh = kind <= 2, has_shape = kind >= 2;
        if (has_mesh) object.mesh = random.index(static_cast<unsigned>(meshes.size()));
        if (has_shape) object.shape = &shapes[random.index(static_cast<unsigned>(shapes.size()))];
        if (has_mesh || kind == 3) {
            object.bound = {};
            object.transform = transform(random, place, !has_shape);
        }
    }
};

std::vector<RegionObject> random_objects(NearMisses& random, std::size_t count, double place) {
    std::vector<RegionObject> objects;
    for (std::size_t i = 0; i < count; ++i) objects.push_back(random_object(random, place));
    return objects;
}

using Seen = std::vector<std::pair<std::uint64_t, occlude::Verdict>>;

Seen seen_with(const TwoWorlds& worlds, const ViewResult& visible) {
    Seen seen;
    for (std::size_t i = 0; i < visible.size(); ++i) {
        const auto verdict = !visible.verdicts().empty()  ? visible.verdicts()[i]
                             : i < visible.inside_count() ? cull::Verdict::inside
                                                          : cull::Verdict::straddling;
        seen.emplace_back(worlds.number(visible[i]), static_cast<occlude::Verdict>(verdict));
    }
    std::sort(seen.begin(), seen.end());
    return seen;
}

// Planes on the grid around a point.
Frustum grid_volume(NearMisses& random, const glm::dvec3& near) {
    Frustum volume;
    volume.origin = near;
    volume.plane_count = 6;
    for (std::uint32_t p = 0; p < 6; ++p) {
        glm::dvec3 normal(0.0);
        normal[static_cast<int>(p / 2)] = p % 2 ? 1.0 : -1.0;
        volume.planes[p] = {normal, 0.5 * random.index(14)};
    }
    return volume;
}

void check_views(const TwoWorlds& worlds, NearMisses& random, const glm::dvec3& near, ViewResult& with,
                 MultiViewResult& many_with) {
    Camera camera;
    const double x = random.number(-9.0, 9.0), y = random.number(-9.0, 9.0), z = random.number(-9.0, 9.0);
    camera.position = near + glm::dvec3(x, y, z);
    camera.near_distance = 0.1;
    camera.far_distance = 15.0;
    camera.fov_y = random.number(0.3, 1.5);
    const double yaw = random.number(-3.0, 3.0);
    camera.forward = {std::sin(yaw), 0.0, std::cos(yaw)};
    std::vector<ViewRequest> requests(4);
    requests[0].camera = camera;
    requests[1].volume = grid_volume(random, near);
    requests[2].volume = grid_volume(random, near);
    requests[2].layers = 1u << random.index(3);
    requests[3].camera = camera;
    requests[3].mode = cull::CullMode::conservative;
    cull::DrawLimits limits;
    limits.eye = camera.position;
    limits.max_distance_in_radii = 12.0;
    limits.least_radius = 0.5;
    ViewResult single;
    MultiViewResult many_single;
    std::map<std::uint64_t, std::uint32_t> masks;
    for (std::size_t v = 0; v < requests.size(); ++v) {
        for (const bool tree_order : {false, true})
            for (const bool limited : {false, true}) {
                ViewRequest request = requests[v];
                request.order = tree_order ? cull::ResultOrder::tree : cull::ResultOrder::ascending;
                if (limited) request.limits = &limits;
                worlds.with.view(request, with).value();
                worlds.boxes.view(request, single).value();
                const Seen expected = seen_with(worlds, single), found = seen_with(worlds, with);
                REQUIRE(found == expected);
                CHECK(with.inside_count() == single.inside_count());
                CHECK(with.statistics().straddling ==
                      (limited ? with.statistics().straddling : single.statistics().straddling));
                if (!tree_order) CHECK(std::is_sorted(with.ids().begin(), with.ids().end()));
                for (std::size_t i = 0; i < with.size(); ++i)
                    if (!tree_order || with.ids()[i] >= kFirstRegionIndex)
                        CHECK(with.verdict_of(with.ids()[i]) != occlude::Verdict::outside);
                if (!limited && !tree_order)
                    for (const auto& [number, verdict] : expected) masks[number] |= 1u << v;
            }
    }
    // In one walk where modes are equal, each by itself otherwise.
    for (const std::size_t count : {3u, 4u})
        for (const bool tree_order : {false, true}) {
            for (ViewRequest& request : requests)
                request.order = tree_order ? cull::ResultOrder::tree : cull::ResultOrder::ascending;
            worlds.with.view(std::span(requests).first(count), many_with).value();
            worlds.boxes.view(std::span(requests).first(count), many_single).value();
            REQUIRE(many_with.size() == many_single.size());
            std::map<std::uint64_t, std::uint32_t> found, expected;
            for (std::size_t i = 0; i < many_with.size(); ++i) {
                found[worlds.number(many_with[i])] = many_with.view_mask(i);
                expected[many_single[i].user] = many_single.view_mask(i);
            }
            REQUIRE(found == expected);
            for (const auto& [number, mask] : found) CHECK(mask == (masks[number] & ((1u << count) - 1)));
        }
}

void check_rays(const TwoWorlds& worlds, NearMisses& random, const glm::dvec3& near) {
    const auto on_grid = [&] { return 0.5 * std::floor(random.number(-20.0, 20.0)); };
    const bool off_grid = random.index(2) != 0;
    const auto coordinate = [&] { return off_grid ? random.number(-10.0, 10.0) : on_grid(); };
    const double x = coordinate(), y = coordinate(), z = coordinate();
    const double u = coordinate(), v = coordinate(), w = coordinate();
    Ray ray{near + glm::dvec3(x, y, z), {u, v, w}};
    for (int i = 0; i < 3; ++i)
        if (!off_grid && random.index(2) == 0) ray.direction[i] = 0.0;
    if (ray.direction == glm::dvec3(0.0)) ray.direction.x = -1.0;
    if (random.index(3) == 0) ray.max_t = random.number(0.0, 2.0);
    if (random.index(8) == 0) ray.direction *= 1e-120;
    const std::uint32_t layers = random.index(2) ? ~0u : 1u << random.index(3);
    Vector<ObjectHit> found, expected;
    worlds.with.raycast_all(ray, found, {layers});
    worlds.single.raycast_all(ray, expected, {layers});
    REQUIRE(found.size() == expected.size());
    const auto fields = [](std::uint64_t number, const ObjectHit& hit) {
        return std::tuple(hit.t, number, hit.point.x, hit.point.y, hit.point.z, hit.normal.x, hit.normal.y,
                          hit.normal.z, hit.triangle, hit.child, hit.started_inside);
    };
    std::vector<decltype(fields(0, {}))> found_fields, expected_fields;
    for (std::size_t i = 0; i < found.size(); ++i) {
        CHECK(found[i].user == worlds.with.user_of(found[i].object).value());
        found_fields.push_back(fields(worlds.number({found[i].object, found[i].user}), found[i]));
        expected_fields.push_back(fields(expected[i].user, expected[i]));
    }
    CHECK(std::is_sorted(found.begin(), found.end(), [](const ObjectHit& a, const ObjectHit& b) {
        return a.t != b.t ? a.t < b.t : a.object.index < b.object.index;
    }));
    std::sort(found_fields.begin(), found_fields.end());
    std::sort(expected_fields.begin(), expected_fields.end());
    CHECK(found_fields == expected_fields);
    const auto nearest = worlds.with.raycast(ray, {layers});
    REQUIRE(nearest.has_value() == !found.empty());
    if (nearest) {
        CHECK(nearest->object == found[0].object);
        CHECK(fields(0, *nearest) == fields(0, found[0]));
    }
    CHECK(worlds.with.raycast_any(ray, {layers}) == !found.empty());
}

// Of objects that are equally near, each World names that of its lowest index.
void check_closest(const TwoWorlds& worlds, const std::optional<ClosestObject>& found,
                   const std::optional<ClosestObject>& expected) {
    REQUIRE(found.has_value() == expected.has_value());
    if (!found) return;
    CHECK(found->distance == expected->distance);
    if (worlds.number({found->object, found->user}) != expected->user) return;
    CHECK(found->on_shape == expected->on_shape);
    CHECK(found->on_object == expected->on_object);
    CHECK(found->triangle == expected->triangle);
    CHECK(found->child == expected->child);
}

// Of one World, with the objects' numbers in place of their indices, in order of these.
std::vector<std::vector<double>> hits_of(const TwoWorlds& worlds, const Vector<ShapeHit>& hits) {
    std::vector<std::vector<double>> rows;
    for (const ShapeHit& h : hits)
        rows.push_back({static_cast<double>(worlds.number({h.object, h.user})), h.time, h.normal.x, h.normal.y,
                        h.normal.z, h.point.x, h.point.y, h.point.z, static_cast<double>(h.triangle),
                        static_cast<double>(h.child), h.distance, h.resolved ? 1.0 : 0.0});
    std::sort(rows.begin(), rows.end());
    return rows;
}

std::vector<std::vector<double>> manifolds_of(const TwoWorlds& worlds, const Vector<ObjectManifold>& found) {
    std::vector<std::vector<double>> rows;
    for (const auto& [object, user, m] : found) {
        rows.push_back(
            {static_cast<double>(worlds.number({object, user})), m.depth, m.normal.x, m.normal.y, m.normal.z});
        for (int i = 0; i < m.count; ++i)
            for (const double x :
                 {m.points[i].position.x, m.points[i].position.y, m.points[i].position.z, m.points[i].depth})
                rows.back().push_back(x);
    }
    std::sort(rows.begin(), rows.end());
    return rows;
}

// A shape that is no object: every hit of its cast, and where it touches.
void check_probe(const TwoWorlds& worlds, const convex::Shape& shape, const RigidTransform& pose,
                 const convex::Motion& motion, std::uint32_t layers) {
    Vector<ShapeHit> hits, expected_hits;
    worlds.with.cast_all(shape, pose, motion, {}, hits, {layers}).value();
    worlds.single.cast_all(shape, pose, motion, {}, expected_hits, {layers}).value();
    CHECK(hits_of(worlds, hits) == hits_of(worlds, expected_hits));
    CHECK(std::is_sorted(hits.begin(), hits.end(), [](const ShapeHit& a, const ShapeHit& b) {
        return a.time != b.time ? a.time < b.time : a.object.index < b.object.index;
    }));
    Vector<ObjectManifold> found, expected;
    worlds.with.contact_manifolds(shape, pose, {.margin = 0.1}, found, {layers}).value();
    worlds.single.contact_manifolds(shape, pose, {.margin = 0.1}, expected, {layers}).value();
    CHECK(manifolds_of(worlds, found) == manifolds_of(worlds, expected));
}

void check_shapes(const TwoWorlds& worlds, NearMisses& random, const glm::dvec3& near) {
    RegionObject probe = random_object(random, 10.0);
    probe.bound.box.center += near;
    const Obb& box = probe.bound.box;
    const Sphere sphere{box.center, 0.5 * random.index(6)};
    const collide::Capsule capsule{box.center, box.center + glm::dvec3(1.0, 0.5, 0.0), 0.5 * random.index(3)};
    const std::uint32_t layers = random.index(2) ? ~0u : 1u << random.index(3);
    Vector<ObjectRef> found, expected;
    const auto compare = [&](const auto& asked) {
        worlds.with.overlap(asked, found, {layers});
        worlds.single.overlap(asked, expected, {layers});
        CHECK(numbers_of(worlds, found) == numbers_of(worlds, expected));
        CHECK(std::is_sorted(found.begin(), found.end(),
                             [](const ObjectRef& a, const ObjectRef& b) { return a.object.index < b.object.index; }));
        for (const double limit : {0.5, 1e300})
            check_closest(worlds, worlds.with.closest(asked, limit, {layers}),
                          worlds.single.closest(asked, limit, {layers}));
    };
    compare(box);
    compare(sphere);
    compare(capsule);
    const auto shape = convex::Shape::capsule(0.5f, 0.5f).value();
    const RigidTransform pose{glm::dmat3(1.0), box.center};
    worlds.with.overlap(shape, pose, found, {layers});
    worlds.single.overlap(shape, pose, expected, {layers});
    CHECK(numbers_of(worlds, found) == numbers_of(worlds, expected));
    check_closest(worlds, worlds.with.closest(shape, pose, 5.0, {layers}),
                  worlds.single.closest(shape, pose, 5.0, {layers}));
    const double u = random.number(-4.0, 4.0), v = random.number(-4.0, 4.0), w = random.number(-4.0, 4.0);
    const convex::Motion motion{.velocity = {u, v, w}};
    check_probe(worlds, shape, pose, motion, layers);
    const auto hit = worlds.with.cast(shape, pose, motion, {}, {layers}).value(),
               expected_hit = worlds.single.cast(shape, pose, motion, {}, {layers}).value();
    REQUIRE(hit.has_value() == expected_hit.has_value());
    if (!hit) return;
    CHECK(hit->time == expected_hit->time);
    CHECK(hit->resolved == expected_hit->resolved);
    if (worlds.number({hit->object, hit->user}) != expected_hit->user) return;
    CHECK(hit->normal == expected_hit->normal);
    CHECK(hit->point == expected_hit->point);
    CHECK(hit->distance == expected_hit->distance);
    CHECK(hit->triangle == expected_hit->triangle);
    CHECK(hit->child == expected_hit->child);
}

void check_names(const TwoWorlds& worlds) {
    std::size_t count = worlds.own.size();
    for (const auto& [handle, region] : worlds.attached) {
        CHECK(worlds.with.contains(handle));
        count += region.singles.size();
        for (std::uint32_t i = 0; i < region.singles.size(); i += 7) {
            const ObjectHandle object = worlds.with.object_in(handle, i).value();
            CHECK(worlds.with.contains(object));
            const Obb box = worlds.with.box_of(object).value(), expected = worlds.boxes.box_of(region.boxes[i]).value();
            CHECK(box.center == expected.center);
            CHECK(box.half_extents == expected.half_extents);
            CHECK(box.axes == expected.axes);
        }
    }
    CHECK(worlds.with.object_count() == count);
    CHECK(worlds.with.statistics().objects == count);
    CHECK(worlds.single.object_count() == count);
}

struct Life {
    Solids solids;
    std::vector<std::vector<RegionObject>> objects;
    std::vector<Region> regions;  // of these
};

// A random life of regions and objects. After each update ask(worlds, life) compares the Worlds.
template <class Ask>
void live(const glm::dvec3& far, NearMisses& random, int steps, Ask ask) {
    TwoWorlds worlds;
    Life life;
    auto& [solids, objects, regions] = life;
    solids.add_to(worlds);
    for (const std::size_t count : {0u, 1u, 3u, 17u, 40u, 300u, 1500u}) {
        const double place = count > 1000 ? 20.0 : 6.0;
        objects.push_back(random_objects(random, count, place));
        for (RegionObject& object : objects.back())
            if (count != 17 && random.index(3) == 0) solids.change(random, object, place);
        regions.push_back(Region::prepare(objects.back(), {.tree = count % 3 == 0 ? boxtree::Orientation::oriented
                                                                                  : boxtree::Orientation::aligned,
                                                           .meshes = solids.meshes})
                              .value());
        CHECK(regions.back().object_count() == count);
    }
    for (int step = 0; step < steps; ++step) {
        const unsigned changes = random.index(4);
        for (unsigned c = 0; c < changes; ++c) {
            const std::size_t which = random.index(static_cast<unsigned>(regions.size()));
            const double x = random.number(-8.0, 8.0), y = random.number(-8.0, 8.0), z = random.number(-8.0, 8.0);
            glm::dvec3 origin = glm::dvec3(x, y, z);
            if (random.index(2) != 0) origin = 0.5 * glm::floor(2.0 * origin);
            const unsigned action = random.index(worlds.attached.size() > 8 ? 5 : 8);
            if (action >= 5) worlds.attach(regions[which], objects[which], far + origin);
            if (worlds.attached.empty()) continue;
            auto chosen = worlds.attached.begin();
            std::advance(chosen, random.index(static_cast<unsigned>(worlds.attached.size())));
            if (action <= 1) {
                worlds.detach(chosen->first);
            } else if (action <= 3 && !chosen->second.singles.empty()) {
                const unsigned place = random.index(static_cast<unsigned>(chosen->second.singles.size()));
                const bool hidden = random.index(3) != 0;
                worlds.hide(chosen->first, place, hidden);
            }
        }
        for (int i = 0; i < 3; ++i) {
            Bound bound = random_object(random, 8.0).bound;
            bound.box.center += far;
            if (worlds.own.size() < 40) {
                worlds.add(bound, random.index(2) ? ~0u : 2u);
            } else {
                const TwoWorlds::Own object = worlds.own[random.index(40)];
                worlds.with.set_bound(object.with, bound).value();
                worlds.single.set_bound(object.single, bound).value();
                worlds.boxes.set_bound(object.boxed, bound).value();
            }
        }
        worlds.update();
        ask(worlds, life);
    }
}

}  // namespace

TEST_SUITE("world/regions") {
    TEST_CASE("in a random life of regions and objects, every answer is that of a World with each object by itself") {
        for (const glm::dvec3 far :
             {glm::dvec3(0.0), glm::dvec3(1e7, -2e6, 0.25), glm::dvec3(1e7 + 0.1, 3e6 + 0.3, 0.7),
              glm::dvec3(-0.99e9, 3e8 + 0.3, 0.99e9 + 0.1)}) {
            ViewResult visible;
            MultiViewResult many;
            NearMisses random(71);
            live(far, random, 60, [&](const TwoWorlds& worlds, const Life&) {
                check_names(worlds);
                check_views(worlds, random, far, visible, many);
                for (int i = 0; i < 12; ++i) check_rays(worlds, random, far);
                for (int i = 0; i < 3; ++i) check_shapes(worlds, random, far);
            });
        }
    }

    TEST_CASE("threads that ask at once, while another prepares and frees regions, get the answers of single objects") {
#ifdef __SANITIZE_THREAD__
        constexpr int kSteps = 12;
#else
        constexpr int kSteps = 30;
#endif
        const glm::dvec3 far(1e7, -2e6, 0.25);
        NearMisses random(77);
        unsigned seed = 0;
        live(far, random, kSteps, [&](const TwoWorlds& worlds, const Life& life) {
            std::vector<std::thread> threads;
            for (int t = 0; t < 3; ++t)
                threads.emplace_back([&worlds, &far, own_seed = ++seed] {
                    NearMisses own(own_seed);
                    ViewResult visible;
                    MultiViewResult many;
                    check_views(worlds, own, far, visible, many);
                    for (int i = 0; i < 4; ++i) check_rays(worlds, own, far);
                    check_shapes(worlds, own, far);
                });
            threads.emplace_back([&life, which = seed % life.regions.size()] {
                const Region copy = life.regions[which];
                const Region region = Region::prepare(life.objects[which], {.meshes = life.solids.meshes}).value();
                CHECK(region.object_count() == copy.object_count());
            });
            for (std::thread& thread : threads) thread.join();
        });
    }

    TEST_CASE("specks of a millimetre, ten thousand kilometres away, are seen and hit as if each were by itself") {
        NearMisses random(77);
        for (const double size : {1e-2, 1e-4, 1e-6}) {
            TwoWorlds worlds;
            const glm::dvec3 far(1e7 + 0.1, -9e6 - 0.3, 1e3 / 3.0);
            std::vector<RegionObject> objects;
            for (int i = 0; i < 200; ++i) {
                const double x = random.number(-size, size), y = random.number(-size, size),
                             z = random.number(-size, size);
                objects.push_back({.bound = box_at({x, y, z}, static_cast<float>(0.1 * size))});
            }
            worlds.attach(Region::prepare(objects).value(), objects, far);
            worlds.update();
            ViewResult with, single;
            Vector<ObjectHit> found, expected;
            std::size_t hits = 0, seen = 0;
            for (int i = 0; i < 400; ++i) {
                const Obb target =
                    worlds.single.box_of(worlds.attached.begin()->second.singles[random.index(200)]).value();
                // Through a corner of a box, and planes through it.
                const glm::dvec3 corner = corners(target)[random.index(8)];
                const double u = random.number(-1.0, 1.0), v = random.number(-1.0, 1.0), w = random.number(-1.0, 1.0);
                const double back = random.index(2) ? 0.5 * size : 1e3;
                const Ray ray{corner - back * glm::dvec3(u, v, w), {u, v, w}};
                worlds.with.raycast_all(ray, found);
                worlds.single.raycast_all(ray, expected);
                REQUIRE(found.size() == expected.size());
                for (std::size_t h = 0; h < found.size(); ++h) CHECK(found[h].t == expected[h].t);
                hits += found.size();
                Frustum volume;
                volume.origin = corner;
                volume.plane_count = 1 + random.index(3);
                for (std::uint32_t p = 0; p < volume.plane_count; ++p) {
                    glm::dvec3 normal(0.0);
                    normal[static_cast<int>(p)] = random.index(2) ? 1.0 : -1.0;
                    volume.planes[p] = {normal, 0.0};
                }
                const ViewRequest request{.volume = volume};
                worlds.with.view(request, with).value();
                worlds.single.view(request, single).value();
                CHECK(seen_with(worlds, with) == seen_with(worlds, single));
                seen += with.size();
            }
            CHECK(hits > 400);
            CHECK(seen > 400);
        }
    }

    TEST_CASE("pairs and contacts of moving objects with regions are those of single objects, with their phases") {
        const glm::dvec3 billion(-0.99e9, 3e8 + 0.3, 0.99e9 + 0.1);
        for (const auto& where :
             {std::pair(false, glm::dvec3(0.0)), {true, glm::dvec3(0.0)}, {false, billion}, {true, billion}}) {
            const bool deep = where.first;
            const glm::dvec3 far = where.second;
            NearMisses random(deep ? 78 : 79);
            TwoWorlds worlds({.contact_margin = deep ? 0.25 : 0.0, .mesh_depth = deep, .updates_to_rest = 3});
            const TriangleMesh crate = testing::cuboid({0.75f, 0.5f, 1.0f});
            const Solids solids;
            solids.add_to(worlds);
            World* const all[] = {&worlds.with, &worlds.single, &worlds.boxes};
            MeshHandle meshes[3];
            for (int w = 0; w < 3; ++w) meshes[w] = all[w]->add_mesh(testing::description_of(crate, false)).value();
            const auto capsule = convex::Shape::capsule(0.5f, 0.25f).value();
            const auto place = [&] {
                const double x = 0.25 * random.index(40), y = 0.25 * random.index(40), z = 0.25 * random.index(40);
                return far + (glm::dvec3(x, y, z) - 5.0);
            };
            const auto transform = [&] {
                Transform result{glm::dmat3(1.0), place()};
                if (random.index(2) != 0) result.linear = glm::dmat3(oracle::random_box(random, {}, 1.0).axes);
                if (random.index(3) == 0) result.linear[0] *= -1.5;
                return result;
            };
            const auto own_bound = [&] {
                Bound bound = random_object(random, 5.0).bound;
                bound.box.center += far;
                return bound;
            };
            for (int i = 0; i < 36; ++i) {
                ObjectDescription description{.user = worlds.next_number++, .layers = 2, .collides_with = 3};
                if (i % 3 == 0) description.bound = own_bound();
                if (i % 3 == 1) description.transform = transform();
                if (i % 3 == 2) description.bound = box_at(place(), 1.0f), description.shape = &capsule;
                ObjectHandle made[3];
                for (int w = 0; w < 3; ++w) {
                    if (i % 3 == 1) description.mesh = meshes[w];
                    made[w] = all[w]->add(description).value();
                }
                worlds.own.push_back({made[0], made[1], made[2]});
                worlds.is_solid.resize(worlds.next_number, false);
            }
            std::vector<RegionObject> objects = random_objects(random, 120, 5.0);
            for (RegionObject& object : objects)
                if (random.index(2) == 0) solids.change(random, object, 5.0);
            for (RegionObject& object : objects) {
                object.layers = random.index(4) != 0 ? 1u : 5u;
                object.collides_with = random.index(8) != 0 ? 2u : 8u;
            }
            const Region region = Region::prepare(objects, {.meshes = solids.meshes}).value();
            using Touching = std::tuple<std::uint64_t, std::uint64_t, ContactPhase, mesh::Containment, double, double,
                                        double, double, std::vector<double>, std::size_t>;
            std::size_t touched = 0, with_triangles = 0, ended = 0, of_shapes = 0;
            const auto contacts_of = [&](const World& world) {
                std::vector<Touching> result;
                for (const Contact& contact : world.contacts()) {
                    std::vector<double> points;
                    for (const convex::TrackedPoint& point : contact.shape_points) {
                        for (int k = 0; k < 3; ++k) points.push_back(point.contact.position[k]);
                        for (int k = 0; k < 3; ++k) points.push_back(point.normal[k]);
                        points.insert(points.end(), {point.contact.depth, point.began ? 1.0 : 0.0});
                    }
                    for (const collide::ContactPoint& point : contact.points) {
                        for (int k = 0; k < 3; ++k) points.push_back(point.position[k]);
                        points.push_back(point.depth);
                    }
                    const std::uint64_t a = worlds.number(contact.first), b = worlds.number(contact.second);
                    result.emplace_back(a, b, contact.phase, contact.inside, contact.normal.x, contact.normal.y,
                                        contact.normal.z, contact.depth, points, contact.triangles.size());
                    touched += b > 36;
                    with_triangles += b > 36 && !contact.triangles.empty();
                    ended += b > 36 && contact.phase == ContactPhase::ended;
                    of_shapes += b > 36 && !contact.shape_points.empty();
                }
                std::sort(result.begin(), result.end());
                return result;
            };
            for (int step = 0; step < 60; ++step) {
                if (step % 4 == 0 && worlds.attached.size() < 3) {
                    const glm::dvec3 origin = far + 0.2 * (place() - far);
                    worlds.attach(region, objects, origin);
                }
                if (step % 11 == 10) worlds.detach(worlds.attached.begin()->first);
                if (!worlds.attached.empty() && random.index(2) != 0) {
                    const unsigned which = random.index(120);
                    const bool hidden = random.index(2) != 0;
                    worlds.hide(worlds.attached.begin()->first, which, hidden);
                }
                const unsigned moves = step % 5 == 4 ? 0 : random.index(8);
                for (unsigned m = 0; m < moves; ++m) {
                    const std::size_t i = random.index(36);
                    const Transform moved = transform();
                    const Bound bound = i % 3 == 2 ? Bound(box_at(place(), 1.0f)) : own_bound();
                    const bool hidden = random.index(4) == 0;
                    for (int w = 0; w < 3; ++w) {
                        World& world = *all[w];
                        const TwoWorlds::Own& own = worlds.own[i];
                        const ObjectHandle object = w == 0 ? own.with : w == 1 ? own.single : own.boxed;
                        if (i % 3 == 1)
                            world.set_transform(object, moved).value();
                        else
                            world.set_bound(object, bound).value();
                        world.set_hidden(object, hidden).value();
                    }
                }
                worlds.update();
                std::vector<std::pair<std::uint64_t, std::uint64_t>> found, expected;
                // With a margin, two shapes are a pair also where their boxes are apart.
                const auto counts = [&](std::uint64_t b) { return !deep || !worlds.is_solid[b]; };
                for (const ObjectPair& pair : worlds.with.pairs()) {
                    const std::uint64_t a = worlds.number(pair.first), b = worlds.number(pair.second);
                    if (counts(b)) found.emplace_back(a, b);
                    CHECK(pair.first.object.index < pair.second.object.index);
                }
                for (const ObjectPair& pair : worlds.boxes.pairs())
                    if (counts(pair.second.user)) expected.emplace_back(pair.first.user, pair.second.user);
                CHECK(std::is_sorted(worlds.with.pairs().begin(), worlds.with.pairs().end(),
                                     [](const ObjectPair& a, const ObjectPair& b) {
                                         return std::pair(a.first.object.index, a.second.object.index) <
                                                std::pair(b.first.object.index, b.second.object.index);
                                     }));
                std::sort(found.begin(), found.end());
                std::sort(expected.begin(), expected.end());
                REQUIRE(found == expected);
                REQUIRE(contacts_of(worlds.with) == contacts_of(worlds.single));
            }
            CHECK(of_shapes > 100);
            CHECK(touched > 1000);
            CHECK(with_triangles > 100);
            CHECK(ended > 100);
            // An object that is removed ends its contacts; more pairs than allowed are an error, and then found again.
            for (const TwoWorlds::Own& object : worlds.own) {
                worlds.with.remove(object.with).value();
                worlds.single.remove(object.single).value();
                worlds.boxes.remove(object.boxed).value();
            }
            worlds.update();
            CHECK(contacts_of(worlds.with) == contacts_of(worlds.single));
            CHECK(worlds.with.pairs().empty());
            worlds.update();
            CHECK(worlds.with.contacts().empty());
        }
    }

    TEST_CASE("more pairs with regions than allowed are an error, and all are found once there are few enough") {
        World world({.max_pairs = 10});
        const std::vector<RegionObject> objects(11, RegionObject{.bound = box_at(glm::dvec3(0.0))});
        const RegionHandle region = world.attach(Region::prepare(objects).value(), glm::dvec3(0.0)).value();
        world.add({.bound = box_at(glm::dvec3(0.5))}).value();
        CHECK(error_of(world.update()).code == ErrorCode::budget_exceeded);
        CHECK(world.pairs().empty());
        world.set_hidden(world.object_in(region, 4).value(), true).value();
        world.update().value();
        CHECK(world.pairs().size() == 10);
        CHECK(world.contacts().size() == 10);
        world.detach(region).value();
        world.update().value();
        CHECK(world.pairs().empty());
        CHECK(world.contacts().size() == 10);  // which have ended
    }

    TEST_CASE("no ray or probe hits a detached region, and views show it until the next update") {
        World world({.pairs = false});
        const std::vector<RegionObject> objects{{.bound = box_at(glm::dvec3(0.0)), .user = 5}};
        const Region region = Region::prepare(objects).value();
        const RegionHandle handle = world.attach(region, {0.0, 0.0, -10.0}).value();
        const Ray ray{{0.0, 0.0, 0.0}, {0.0, 0.0, -1.0}};
        ViewResult visible;
        const ViewRequest request{.camera = Camera{}};
        CHECK(!world.raycast(ray));  // not before the update
        world.view(request, visible).value();
        CHECK(visible.size() == 0);
        const ObjectHandle object = world.object_in(handle, 0).value();
        CHECK(world.contains(object));
        world.update().value();
        CHECK(world.raycast(ray)->object == object);
        CHECK(world.raycast(ray)->user == 5);
        world.view(request, visible).value();
        CHECK(visible.size() == 1);
        world.detach(handle).value();
        CHECK(!world.contains(handle));
        CHECK(!world.contains(object));
        CHECK(!world.raycast(ray));
        Vector<ObjectRef> found;
        world.overlap(Sphere{{0.0, 0.0, -10.0}, 1.0}, found);
        CHECK(found.empty());
        world.view(request, visible).value();
        CHECK(visible.size() == 1);
        world.update().value();
        world.view(request, visible).value();
        CHECK(visible.size() == 0);
        CHECK(world.object_count() == 0);
    }

    TEST_CASE("handles of a detached region are stale, also after its indices are another's") {
        World world({.pairs = false});
        const std::vector<RegionObject> objects(3, RegionObject{.bound = box_at(glm::dvec3(0.0))});
        const Region region = Region::prepare(objects).value();
        const RegionHandle old_region = world.attach(region, glm::dvec3(0.0)).value();
        const ObjectHandle old_object = world.object_in(old_region, 1).value();
        world.update().value();
        world.detach(old_region).value();
        world.update().value();
        const RegionHandle new_region = world.attach(region, glm::dvec3(1.0)).value();
        CHECK(world.object_in(new_region, 1).value().index == old_object.index);
        CHECK(error_of(world.detach(old_region)).code == ErrorCode::stale_handle);
        CHECK(error_of(world.object_in(old_region, 0)).code == ErrorCode::stale_handle);
        CHECK(error_of(world.place_of(old_object)).code == ErrorCode::stale_handle);
        CHECK(error_of(world.set_hidden(old_object, true)).code == ErrorCode::stale_handle);
        CHECK(error_of(world.user_of(old_object)).code == ErrorCode::stale_handle);
        CHECK(error_of(world.box_of(old_object)).code == ErrorCode::stale_handle);
        CHECK(error_of(world.detach({})).code == ErrorCode::stale_handle);
        World other;
        CHECK(error_of(other.detach(new_region)).code == ErrorCode::stale_handle);
        CHECK(!other.contains(world.object_in(new_region, 0).value()));
        CHECK(error_of(world.object_in(new_region, 3)).code == ErrorCode::out_of_range);
    }

    TEST_CASE(
        "a region's object says what cannot be changed, and an object of the World's own that it is of no region") {
        World world;
        const std::vector<RegionObject> objects{{.bound = box_at(glm::dvec3(0.0))}};
        const RegionHandle region = world.attach(Region::prepare(objects).value(), glm::dvec3(0.0)).value();
        world.update().value();
        const ObjectHandle object = world.object_in(region, 0).value();
        const Obb box = box_at(glm::dvec3(1.0));
        CHECK(error_of(world.remove(object)).code == ErrorCode::unsupported);
        CHECK(error_of(world.set_transform(object, {})).code == ErrorCode::unsupported);
        CHECK(error_of(world.set_bound(object, box)).code == ErrorCode::unsupported);
        CHECK(error_of(world.set_bounds(std::span(&object, 1), std::span(&box, 1))).code == ErrorCode::unsupported);
        CHECK(error_of(world.set_layers(object, 1)).code == ErrorCode::unsupported);
        CHECK(error_of(world.set_collides_with(object, 1)).code == ErrorCode::unsupported);
        CHECK(error_of(world.set_user(object, 1)).code == ErrorCode::unsupported);
        CHECK(error_of(world.set_shape(object, nullptr)).code == ErrorCode::unsupported);
        CHECK(error_of(world.set_occludes(object, true)).code == ErrorCode::unsupported);
        CHECK(error_of(world.transform_of(object)).code == ErrorCode::invalid_argument);
        const ObjectHandle own = world.add({.bound = box}).value();
        CHECK(error_of(world.place_of(own)).code == ErrorCode::invalid_argument);
    }

    TEST_CASE(
        "bad objects are refused when a region is prepared, by their places, and bad origins when it is attached") {
        std::vector<RegionObject> objects(5, RegionObject{.bound = box_at(glm::dvec3(0.0))});
        const auto refused = [&](const Bound& bound, ErrorCode code) {
            objects[3].bound = bound;
            const Error error = error_of(Region::prepare(objects));
            CHECK(error.code == code);
            CHECK(error.item == 3);
        };
        refused(Bound(), ErrorCode::invalid_argument);
        refused(box_at(glm::dvec3(std::numeric_limits<double>::quiet_NaN())), ErrorCode::non_finite);
        refused(Sphere{{0.0, 0.0, 0.0}, -1.0}, ErrorCode::invalid_argument);
        refused(box_at(glm::dvec3(1e31)), ErrorCode::out_of_range);
        refused(Aabb(), ErrorCode::non_finite);
        objects[3].bound = box_at(glm::dvec3(1.0));
        CHECK(error_of(Region::prepare(objects, {.max_objects = 4})).code == ErrorCode::out_of_range);
        World world;
        const Region region = Region::prepare(objects).value();
        CHECK(error_of(world.attach(region, glm::dvec3(NAN))).code == ErrorCode::non_finite);
        CHECK(error_of(world.attach(region, glm::dvec3(1e30))).code == ErrorCode::out_of_range);
        CHECK(world.object_count() == 0);
    }

    TEST_CASE("preparing stops when the callback says so") {
        const std::vector<RegionObject> objects(10000, RegionObject{.bound = box_at(glm::dvec3(0.0))});
        int asked = 0;
        RegionOptions options;
        options.stop_user = &asked;
        options.should_stop = [](void* user, double) { return ++*static_cast<int*>(user) == 1; };
        CHECK(error_of(Region::prepare(objects, options)).code == ErrorCode::cancelled);
        CHECK(asked == 1);
        double last = -1.0;
        options.stop_user = &last;
        options.should_stop = [](void* user, double share) {
            CHECK(share >= *static_cast<double*>(user));
            *static_cast<double*>(user) = share;
            return false;
        };
        CHECK(Region::prepare(objects, options)->object_count() == 10000);
        CHECK(last >= 0.0);
    }

    TEST_CASE("preparing meshes, shapes and boxes stops at whichever question is answered yes, and leaves no memory") {
        NearMisses random(78);
        const Solids solids;
        std::vector<RegionObject> objects = random_objects(random, 3000, 20.0);
        for (std::size_t i = 0; i < objects.size(); i += 3) solids.change(random, objects[i], 20.0);
        struct Asked {
            int count = 0, stop_at = 0;
        };
        const auto prepare = [&](Asked& asked) {
            const auto should_stop = [](void* user, double) {
                Asked& its = *static_cast<Asked*>(user);
                std::this_thread::sleep_for(std::chrono::milliseconds(6));  // it is asked again after 5
                return ++its.count == its.stop_at;
            };
            return Region::prepare(objects, {.should_stop = should_stop, .stop_user = &asked, .meshes = solids.meshes});
        };
        Asked all;
        REQUIRE(prepare(all).has_value());
        // Before each of three meshes, among the objects, while the tree is built, before and after what follows it.
        REQUIRE(all.count > 7);
        for (int stop_at = 1; stop_at <= all.count; ++stop_at) {
            testing::CountingMemory memory;
            {
                Asked asked{.stop_at = stop_at};
                const auto region = prepare(asked);
                REQUIRE_FALSE(region);
                CHECK(region.error().code == ErrorCode::cancelled);
                CHECK(asked.count == stop_at);
            }
            CHECK(memory.bytes_in_use() == 0);
        }
    }

    TEST_CASE("a region that is attached several times at one place, and others across it, answer as singles") {
        NearMisses random(79);
        TwoWorlds worlds;
        const auto objects = random_objects(random, 300, 6.0), others = random_objects(random, 200, 6.0);
        const Region region = Region::prepare(objects).value(), other = Region::prepare(others).value();
        std::vector<RegionHandle> handles;
        const glm::dvec3 far(1e9, -3.0, 0.1);
        for (int copy = 0; copy < 3; ++copy) handles.push_back(worlds.attach(region, objects, far));
        for (const double apart : {0.0, 0.5, 6.0}) worlds.attach(other, others, far + glm::dvec3(apart, 0.0, 0.0));
        worlds.hide(handles[1], 7, true);
        ViewResult visible;
        MultiViewResult many;
        const auto check = [&] {
            worlds.update();
            check_names(worlds);
            check_views(worlds, random, far, visible, many);
            for (int i = 0; i < 30; ++i) check_rays(worlds, random, far);
            for (int i = 0; i < 5; ++i) check_shapes(worlds, random, far);
        };
        check();
        worlds.detach(handles[0]);  // the others stay
        check();
        CHECK(worlds.with.object_count() == 2 * objects.size() + 3 * others.size());
    }

    TEST_CASE("an empty region can be attached and detached, and has empty bounds") {
        World world;
        const Region empty = Region::prepare({}).value();
        CHECK(empty.bounds().is_empty());
        CHECK(empty.bytes() == 0);
        const RegionHandle a = world.attach(empty, glm::dvec3(1.0)).value(), b = world.attach(Region(), {}).value();
        CHECK(a != b);
        world.update().value();
        CHECK(world.contains(a));
        CHECK(error_of(world.object_in(a, 0)).code == ErrorCode::out_of_range);
        world.detach(a).value();
        world.update().value();
        CHECK(!world.contains(a));
        CHECK(world.contains(b));
    }

    TEST_CASE("ten thousand regions of one object, of which half go again, answer as singles") {
        NearMisses random(72);
        TwoWorlds worlds;
        const std::vector<RegionObject> objects{{.bound = box_at(glm::dvec3(0.0))}};
        const Region region = Region::prepare(objects).value();
        std::vector<RegionHandle> handles;
        for (int i = 0; i < 10000; ++i) {
            const glm::dvec3 origin(i % 100 - 50, (i / 100) % 10, i / 1000 - 5);
            handles.push_back(worlds.attach(region, objects, origin));
        }
        worlds.update();
        ViewResult visible;
        MultiViewResult many;
        check_views(worlds, random, glm::dvec3(0.0), visible, many);
        for (std::size_t i = 0; i < handles.size(); i += 2) worlds.detach(handles[i]);
        worlds.update();
        check_names(worlds);
        check_views(worlds, random, glm::dvec3(0.0), visible, many);
        for (int i = 0; i < 50; ++i) check_rays(worlds, random, glm::dvec3(0.0));
        for (int i = 0; i < 10; ++i) check_shapes(worlds, random, glm::dvec3(0.0));
    }

    TEST_CASE("views with occlusion leave out of a region what the World's occluders hide, and list it if asked") {
        World with({.pairs = false}), single({.pairs = false});
        NearMisses random(73);
        const TriangleMesh wall = testing::cuboid({6.0f, 6.0f, 0.5f});
        for (World* world : {&with, &single}) {
            const auto mesh = world->add_mesh(testing::description_of(wall, true)).value();
            world->add({.mesh = mesh, .transform = testing::at(0.0, 0.0, -10.0), .user = 5000}).value();
        }
        std::vector<RegionObject> objects;
        for (int i = 0; i < 600; ++i) {
            const double x = random.number(-20.0, 20.0), y = random.number(-8.0, 8.0), z = random.number(-30.0, 5.0);
            objects.push_back({.bound = box_at({x, y, z}, 0.3f), .user = static_cast<std::uint64_t>(i)});
        }
        const glm::dvec3 origin(0.125, 0.0, -0.1);
        with.attach(Region::prepare(objects).value(), origin).value();
        for (RegionObject& object : objects) {
            object.bound.box.center += origin;
            single.add({.bound = object.bound, .user = object.user}).value();
        }
        with.update().value();
        single.update().value();
        Camera camera;
        camera.far_distance = 60.0;
        for (const bool list_occluded : {false, true})
            for (const auto order : {cull::ResultOrder::ascending, cull::ResultOrder::tree}) {
                const ViewRequest request{
                    .camera = camera, .occlusion = OcclusionOptions{.list_occluded = list_occluded}, .order = order};
                ViewResult found, expected;
                with.view(request, found).value();
                single.view(request, expected).value();
                const auto users = [](const ViewResult& visible, std::span<const std::uint32_t> ids) {
                    std::vector<std::uint64_t> result;
                    for (const std::uint32_t id : ids) result.push_back(visible.ref(id).user);
                    std::sort(result.begin(), result.end());
                    return result;
                };
                CHECK(users(found, found.ids()) == users(expected, expected.ids()));
                CHECK(users(found, found.occluded_ids()) == users(expected, expected.occluded_ids()));
                CHECK(found.occluded_ids().empty() == !list_occluded);
                CHECK(found.inside_count() == expected.inside_count());
                if (!list_occluded) continue;
                for (const std::uint32_t id : found.occluded_ids())
                    CHECK(found.verdict_of(id) == occlude::Verdict::occluded);
                Vector<OccluderRef> occluders;
                with.hidden_by(found.ref(found.occluded_ids()[0]).object, found, occluders).value();
                REQUIRE(!occluders.empty());
                CHECK(occluders[0].user == 5000);
                MultiViewResult many;
                const ViewRequest both[] = {request, {.camera = camera, .order = order}};
                with.view(both, many).value();
                CHECK(many.occluded_ids(0).size() == found.occluded_ids().size());
                std::size_t in_first = 0;
                for (std::size_t i = 0; i < many.size(); ++i) in_first += many.view_mask(i) & 1u;
                CHECK(in_first == found.size());
            }
    }

    TEST_CASE("warm queries of regions allocate nothing") {
        testing::CountingMemory memory;
        NearMisses random(74);
        TwoWorlds worlds;
        const auto objects = random_objects(random, 2000, 20.0);
        const Region region = Region::prepare(objects).value();
        const RegionHandle first = worlds.attach(region, objects, glm::dvec3(0.0));
        worlds.attach(region, objects, glm::dvec3(30.0, 0.0, 0.0));
        worlds.update();
        worlds.hide(first, 3, true);
        worlds.update();
        Camera camera;
        camera.far_distance = 100.0;
        const ViewRequest request{.camera = camera};
        const ViewRequest both[] = {request, request};
        ViewResult visible;
        MultiViewResult many;
        Vector<ObjectHit> hits;
        Vector<ObjectRef> found;
        std::size_t before = 0;
        for (int round = 0; round < 3; ++round) {
            if (round == 2) before = memory.allocations();
            worlds.with.view(request, visible).value();
            worlds.with.view(both, many).value();
            worlds.with.raycast_all({{0.0, 0.0, 0.0}, {1.0, 0.1, 0.0}}, hits);
            worlds.with.overlap(Sphere{{0.0, 0.0, 0.0}, 5.0}, found);
            CHECK(worlds.with.closest(Sphere{{0.0, 0.0, 0.0}, 0.1}, 10.0).has_value());
        }
        CHECK(visible.size() > 0);
        CHECK(!hits.empty());
        CHECK(memory.allocations() == before);
    }

    TEST_CASE(
        "memory does not grow with the number of times that regions come and go, and a region outlives its World") {
        testing::CountingMemory memory;
        {
            NearMisses random(75);
            Region region;
            {
                World world({.pairs = false});
                const auto objects = random_objects(random, 100, 20.0);
                region = Region::prepare(objects).value();
                std::vector<RegionHandle> handles;
                std::size_t early = 0, late = 0;  // the most in use
                for (int i = 0; i < 100000; ++i) {
                    handles.push_back(world.attach(region, glm::dvec3(i % 1000, 0.0, 0.0)).value());
                    if (handles.size() > 50) {
                        const std::size_t which = random.index(50);
                        world.detach(handles[which]).value();
                        handles.erase(handles.begin() + static_cast<std::ptrdiff_t>(which));
                    }
                    world.update().value();
                    if (i < 5000) early = std::max(early, memory.bytes_in_use());
                    if (i >= 95000) late = std::max(late, memory.bytes_in_use());
                }
                CHECK(static_cast<double>(late) <= 1.05 * static_cast<double>(early));
            }
            CHECK(region.object_count() == 100);
            CHECK(region.bytes() > 100 * sizeof(Obb));
            const Region copy = region;
            region = Region();
            CHECK(copy.object_count() == 100);
        }
        CHECK(memory.bytes_in_use() == 0);
    }

    TEST_CASE("regions are prepared on another thread while the World is updated and queried") {
        World world({.pairs = false});
        NearMisses random(76);
        const auto objects = random_objects(random, 3000, 20.0);
        std::vector<Region> prepared(4);
        std::thread loader([&] {
            for (Region& region : prepared) region = Region::prepare(objects).value();
        });
        const Region mine = Region::prepare(objects).value();
        ViewResult visible;
        for (int i = 0; i < 50; ++i) {
            const RegionHandle region = world.attach(mine, glm::dvec3(i)).value();
            world.update().value();
            world.view({.camera = Camera{}}, visible).value();
            world.detach(region).value();
        }
        loader.join();
        for (const Region& region : prepared) world.attach(region, glm::dvec3(0.0)).value();
        world.update().value();
        CHECK(world.object_count() == 4 * objects.size());
    }
}
