// SPDX-License-Identifier: MIT
// Shapes in C: what they are, their answers beside those of C++, and what is refused.
#include <cmath>
#include <crofton/convex/query.hpp>
#include <cstring>
#include <limits>
#include <random>

#include "shapes_fixture.hpp"

using namespace crofton;
using namespace crofton::capi_test;

namespace {

const float kFloatNaN = std::numeric_limits<float>::quiet_NaN();

}  // namespace

TEST_SUITE("capi/shapes") {
    TEST_CASE("a shape of each kind says what it is, and outlives nothing that it is made of") {
        std::vector<ShapeHandle> shapes = all_kinds();
        const std::uint32_t kinds[] = {CROFTON_SHAPE_SPHERE, CROFTON_SHAPE_CAPSULE,      CROFTON_SHAPE_CYLINDER,
                                       CROFTON_SHAPE_CONE,   CROFTON_SHAPE_BOX,          CROFTON_SHAPE_TRIANGLE,
                                       CROFTON_SHAPE_HULL,   CROFTON_SHAPE_HALF_SPACE,   CROFTON_SHAPE_BOX,
                                       CROFTON_SHAPE_MESH,   CROFTON_SHAPE_HEIGHT_FIELD, CROFTON_SHAPE_COMPOUND};
        for (std::size_t i = 0; i < shapes.size(); ++i) {
            auto info = sized<crofton_shape_info>();
            REQUIRE(crofton_shape_get_info(shapes[i].get(), &info) == CROFTON_OK);
            CAPTURE(i);
            CHECK(info.kind == kinds[i]);
            CHECK(info.part_count == (i == 11 ? 2 : 1));
            CHECK(info.vertex_count == (i == 6 ? 6 : 0));
            CHECK(info.face_count == (i == 6 ? 8 : 0));
            if (i == 7) CHECK(std::isinf(info.max[1]));
            if (i == 8) CHECK(info.max[2] == doctest::Approx(1.125));
        }
        // The compound's children go first.
        const ShapeHandle compound = std::move(shapes.back());
        shapes.clear();
        const ShapeHandle probe = box_shape(0.1f, 0.1f, 0.1f);
        const crofton_transform here = translation(0, 0, 0), there = translation(1.9, 0, 0);
        const crofton_placed a{compound.get(), &here}, b{probe.get(), &there};
        int meet = 0;
        REQUIRE(crofton_shapes_meet(&a, &b, nullptr, &meet) == CROFTON_OK);
        CHECK(meet == 1);
        auto distance = sized<crofton_shape_distance>();
        const double point[3] = {3, 0, 0};
        REQUIRE(crofton_shape_closest_point(&a, point, &distance) == CROFTON_OK);
        CHECK(distance.distance == doctest::Approx(1.0));
    }

    TEST_CASE("a ray at a shape: its first point, from inside at once, a miss at infinity, and bad rays are refused") {
        const ShapeHandle box = box_shape(1, 2, 3);
        const crofton_transform there = translation(10, 0, 0);
        const crofton_placed placed{box.get(), &there};
        auto hit = sized<crofton_shape_ray_hit>();
        crofton_ray ray{{0, 0.5, 0}, {2, 0, 0}, std::numeric_limits<double>::infinity()};
        REQUIRE(crofton_shape_raycast(&placed, &ray, &hit) == CROFTON_OK);
        CHECK(hit.t == 4.5);
        CHECK(hit.point[0] == 9.0);
        CHECK(hit.normal[0] == -1.0);
        CHECK(hit.started_inside == 0);
        ray.origin[0] = 10.0;
        REQUIRE(crofton_shape_raycast(&placed, &ray, &hit) == CROFTON_OK);
        CHECK(hit.t == 0.0);
        CHECK(hit.normal[0] == 0.0);
        CHECK(hit.started_inside == 1);
        ray.origin[0] = 11.5;
        REQUIRE(crofton_shape_raycast(&placed, &ray, &hit) == CROFTON_OK);
        CHECK(std::isinf(hit.t));
        CHECK(hit.started_inside == 0);
        hit.t = 42.0;
        ray.direction[0] = 0.0;
        CHECK(crofton_shape_raycast(&placed, &ray, &hit) == CROFTON_DEGENERATE);
        ray.direction[0] = std::numeric_limits<double>::quiet_NaN();
        CHECK(crofton_shape_raycast(&placed, &ray, &hit) == CROFTON_NON_FINITE);
        CHECK(hit.t == 42.0);
    }

    TEST_CASE("a hull's surface and mass: an octahedron") {
        const ShapeHandle hull = hull_shape();
        auto info = sized<crofton_shape_info>();
        REQUIRE(crofton_shape_get_info(hull.get(), &info) == CROFTON_OK);
        CHECK(info.vertex_count == 6);
        CHECK(info.index_count == 24);
        for (std::size_t i = 0; i < info.index_count; ++i) CHECK(info.indices[i] < 6);
        for (std::size_t i = 0; i < info.vertex_count; ++i) {
            const float* v = info.vertices + 3 * i;
            CHECK(std::fabs(v[0]) + std::fabs(v[1]) + std::fabs(v[2]) == 1.0f);
        }
        auto mass = sized<crofton_mass_properties>();
        REQUIRE(crofton_shape_get_mass(hull.get(), &mass) == CROFTON_OK);
        CHECK(mass.volume == doctest::Approx(4.0 / 3.0));
        CHECK(mass.inertia[0] == doctest::Approx(4.0 / 15.0));
        REQUIRE(crofton_shape_get_info(box_shape(1, 1, 1).get(), &info) == CROFTON_OK);
        CHECK((info.vertices == nullptr && info.indices == nullptr && info.index_count == 0));
    }

    TEST_CASE("answers are the bits of C++") {
        const std::vector<float> points = octahedron();
        std::vector<glm::vec3> copies;
        for (std::size_t i = 0; i < points.size(); i += 3) copies.emplace_back(points[i], points[i + 1], points[i + 2]);
        const convex::Hull hull = convex::Hull::build(copies).value();
        const convex::Shape a = convex::Shape::hull(hull), b = convex::Shape::box({0.5f, 0.25f, 1.0f}).value();
        const ShapeHandle c_a = hull_shape(), c_b = box_shape(0.5f, 0.25f, 1.0f);
        const crofton_transform origin = translation(0, 0, 0);
        convex::PairCache cache;
        crofton_pair_cache c_cache{};
        std::mt19937 random(1);
        std::uniform_real_distribution<double> uniform(-1.5, 1.5);
        int met = 0;
        for (int i = 0; i < 200; ++i) {
            const double x = uniform(random), y = uniform(random), z = uniform(random);
            const crofton_transform c_pose = translation(x, y, z);
            const RigidTransform pose{glm::dmat3(1.0), {x, y, z}}, still;
            const crofton_placed placed_a{c_a.get(), &origin}, placed_b{c_b.get(), &c_pose};
            int meet = -1;
            REQUIRE(crofton_shapes_meet(&placed_a, &placed_b, &c_cache, &meet) == CROFTON_OK);
            CHECK((meet == 1) == convex::intersects({a, still}, {b, pose}, &cache));
            met += meet;
            auto distance = sized<crofton_shape_distance>();
            REQUIRE(crofton_shapes_distance(&placed_a, &placed_b, &c_cache, &distance) == CROFTON_OK);
            const convex::Distance expected = convex::distance({a, still}, {b, pose}, &cache);
            CHECK(distance.distance == expected.distance);
            CHECK(distance.on_b[1] == expected.on_b.y);
            auto overlap = sized<crofton_shape_penetration>();
            REQUIRE(crofton_shapes_penetration(&placed_a, &placed_b, &c_cache, &overlap) == CROFTON_OK);
            const convex::Penetration depth = convex::penetration({a, still}, {b, pose}, &cache);
            CHECK(overlap.overlapping == (depth.overlapping ? 1u : 0u));
            CHECK(overlap.upper == depth.upper);
            CHECK(overlap.normal[2] == depth.normal.z);
            const crofton_motion motion{{-x, -y, -z}, {0, 3, 0}, {0, 0, 0}};
            auto impact = sized<crofton_impact>();
            REQUIRE(crofton_shapes_cast(&placed_a, nullptr, &placed_b, &motion, nullptr, &impact) == CROFTON_OK);
            const auto first = convex::cast({a, still}, {}, {b, pose}, {{-x, -y, -z}, {0, 3, 0}, {}});
            CHECK(impact.time == first->time);
            CHECK(impact.result == static_cast<std::uint32_t>(first->result));
            CHECK(impact.distance == first->distance);
            for (int k = 0; k < 3; ++k) {
                CHECK(impact.normal[k] == first->normal[k]);
                CHECK(impact.on_a[k] == first->on_a[k]);
                CHECK(impact.on_b[k] == first->on_b[k]);
            }
            auto options = sized<crofton_cast_options>();
            options.duration = 1.0;
            options.ignore_initial_overlaps = 1;
            REQUIRE(crofton_shapes_cast(&placed_a, nullptr, &placed_b, &motion, &options, &impact) == CROFTON_OK);
            if (meet == 1) CHECK(impact.result == CROFTON_CAST_MISS);
            if (meet == 0) CHECK(impact.time == first->time);
        }
        CHECK(met > 20);
        CHECK(met < 180);
    }

    TEST_CASE("a pair's contacts keep the caller's numbers while they stay") {
        const ShapeHandle floor = box_shape(5, 1, 5), crate = box_shape(0.5f, 0.5f, 0.5f);
        crofton_shape_contacts* made = nullptr;
        REQUIRE(crofton_shape_contacts_create(&made) == CROFTON_OK);
        const ShapeContactsHandle contacts(made);
        const crofton_transform ground = translation(0, 0, 0);
        auto options = sized<crofton_manifold_options>();
        options.margin = 0.02;
        crofton_tracked_point* points = nullptr;
        std::size_t count = 0, ended = 7;
        for (int step = 0; step < 5; ++step) {
            const crofton_transform place = translation(0.01 * step, 1.49, 0);
            const crofton_placed a{floor.get(), &ground}, b{crate.get(), &place};
            REQUIRE(crofton_shape_contacts_update(made, &a, &b, &options, &points, &count, &ended) == CROFTON_OK);
            REQUIRE(count == 4);
            CHECK(ended == 0);
            for (std::size_t i = 0; i < 4; ++i) {
                CHECK(points[i].normal[1] == doctest::Approx(1.0));
                CHECK(points[i].depth == doctest::Approx(0.01));
                CHECK(points[i].began == (step == 0 ? 1 : 0));
                if (step == 0) points[i].memory[2] = static_cast<float>(points[i].on_b.index) + 0.5f;
                CHECK(points[i].memory[2] == static_cast<float>(points[i].on_b.index) + 0.5f);
            }
        }
        const crofton_transform high = translation(0, 3, 0);
        const crofton_placed a{floor.get(), &ground}, b{crate.get(), &high};
        REQUIRE(crofton_shape_contacts_update(made, &a, &b, &options, &points, &count, &ended) == CROFTON_OK);
        CHECK(count == 0);
        CHECK(ended == 4);
    }

    TEST_CASE("bad shapes are refused by name, and leave the result alone") {
        crofton_shape* none = nullptr;
        CHECK(shape_sphere(-1, &none) == CROFTON_INVALID_ARGUMENT);
        CHECK(shape_sphere(1, nullptr) == CROFTON_INVALID_ARGUMENT);
        CHECK(shape_round(CROFTON_SHAPE_CAPSULE, kFloatNaN, 1, &none) == CROFTON_NON_FINITE);
        const float inside_out[3] = {1, -1, 1};
        CHECK(shape_box(inside_out, &none) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_last_error_item() == 1);
        const float flat[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
        CHECK(shape_hull(flat, 4, &none) == CROFTON_DEGENERATE);
        CHECK(shape_hull(flat, 3, &none) != CROFTON_OK);
        CHECK(shape_hull(nullptr, 4, &none) == CROFTON_INVALID_ARGUMENT);
        CHECK(shape_hull(flat, SIZE_MAX / 4, &none) == CROFTON_OUT_OF_RANGE);
        const std::vector<float> points = octahedron();
        CHECK(shape_hull(points.data(), 7, &none, 3) == CROFTON_INVALID_ARGUMENT);
        auto field = sized<crofton_height_field>();
        field.columns = 4;
        field.rows = 1;
        field.heights = flat;
        CHECK(shape_height_field(&field, 0, &none) == CROFTON_OUT_OF_RANGE);
        // One bad triangle among good ones is an error too: C cannot ask which were left out.
        float corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
        std::uint32_t triangles[] = {0, 1, 2, 1, 3, 4};
        auto surface = sized<crofton_mesh>();
        surface.positions = corners;
        surface.vertex_count = 4;
        surface.indices = triangles;
        surface.index_count = 6;
        CHECK(shape_mesh(&surface, 0, &none) == CROFTON_OUT_OF_RANGE);
        CHECK(crofton_last_error_item() == 5);
        triangles[5] = 2;
        corners[9] = kFloatNaN;
        CHECK(shape_mesh(&surface, 0, &none) == CROFTON_NON_FINITE);
        CHECK(crofton_last_error_item() == 3);
        corners[9] = 2e12f;
        CHECK(shape_mesh(&surface, 0, &none) == CROFTON_OUT_OF_RANGE);
        CHECK(crofton_last_error_item() == 1);
        CHECK(shape_compound(nullptr, nullptr, 0, &none) == CROFTON_EMPTY);
        const crofton_transform here = translation(0, 0, 0);
        const crofton_shape* no_child = nullptr;
        CHECK(shape_compound(&no_child, &here, 1, &none) == CROFTON_BAD_HANDLE);
        CHECK(crofton_last_error_item() == 0);
        auto description = crofton_default_shape_description();
        description.kind = CROFTON_SHAPE_ROUNDED + 1;
        CHECK(crofton_shape_create(&description, &none) == CROFTON_INVALID_ARGUMENT);
        description.kind = CROFTON_SHAPE_ROUNDED;
        CHECK(crofton_shape_create(&description, &none) == CROFTON_BAD_HANDLE);
        for (const std::uint32_t kind : {CROFTON_SHAPE_MESH, CROFTON_SHAPE_HEIGHT_FIELD}) {
            description.kind = kind;
            CHECK(crofton_shape_create(&description, &none) == CROFTON_INVALID_ARGUMENT);
        }
        description.size += 8;
        CHECK(crofton_shape_create(&description, &none) == CROFTON_WRONG_SIZE);
        CHECK(crofton_shape_create(nullptr, &none) == CROFTON_INVALID_ARGUMENT);
        CHECK(none == nullptr);
    }

    TEST_CASE("compounds of compounds are refused where they are deeper than sixteen") {
        std::vector<ShapeHandle> nested;
        nested.push_back(box_shape(1, 1, 1));
        const crofton_transform here = translation(0, 0, 0);
        for (int depth = 1; depth <= 1000; ++depth) {
            const crofton_shape* child = nested.back().get();
            crofton_shape* made = nullptr;
            const crofton_status status = shape_compound(&child, &here, 1, &made);
            REQUIRE(status == (depth <= 16 ? CROFTON_OK : CROFTON_OUT_OF_RANGE));
            if (depth > 16) break;
            nested.emplace_back(made);
        }
        CHECK(crofton_last_error_item() == 0);
    }

    TEST_CASE("bad poses, caches, options and sizes of structs are refused") {
        const ShapeHandle shape = box_shape(1, 1, 1);
        const crofton_transform good = translation(0, 0, 0);
        crofton_transform mirror = good, stretched = good, lost = good;
        mirror.linear[0] = -1;
        stretched.linear[0] = 2;
        lost.translation[0] = std::numeric_limits<double>::quiet_NaN();
        const crofton_placed placed{shape.get(), &good};
        int meet = 5;
        for (const crofton_transform& pose : {mirror, stretched, lost}) {
            const crofton_placed bad{shape.get(), &pose};
            CHECK(crofton_shapes_meet(&placed, &bad, nullptr, &meet) != CROFTON_OK);
        }
        const crofton_placed nobody{nullptr, &good}, nowhere{shape.get(), nullptr};
        CHECK(crofton_shapes_meet(&placed, &nobody, nullptr, &meet) == CROFTON_BAD_HANDLE);
        CHECK(crofton_shapes_meet(&placed, nullptr, nullptr, &meet) == CROFTON_BAD_HANDLE);
        CHECK(crofton_shapes_meet(&placed, &nowhere, nullptr, &meet) == CROFTON_INVALID_ARGUMENT);
        CHECK(meet == 5);
        auto distance = sized<crofton_shape_distance>();
        distance.size += 8;
        CHECK(crofton_shapes_distance(&placed, &placed, nullptr, &distance) == CROFTON_WRONG_SIZE);
        auto impact = sized<crofton_impact>();
        auto options = sized<crofton_cast_options>();
        options.duration = -1;
        CHECK(crofton_shapes_cast(&placed, nullptr, &placed, nullptr, &options, &impact) != CROFTON_OK);
        options.duration = 1;
        const crofton_motion whirl{{0, 0, 0}, {0, 1e6, 0}, {0, 0, 0}};
        CHECK(crofton_shapes_cast(&placed, &whirl, &placed, nullptr, &options, &impact) == CROFTON_OUT_OF_RANGE);
        auto manifold = sized<crofton_manifold_options>();
        manifold.max_points = 9;
        crofton_shape_contacts* contacts = nullptr;
        REQUIRE(crofton_shape_contacts_create(&contacts) == CROFTON_OK);
        const ShapeContactsHandle owner(contacts);
        CHECK(crofton_shape_contacts_update(contacts, &placed, &placed, &manifold, nullptr, nullptr, nullptr) ==
              CROFTON_OUT_OF_RANGE);
        manifold.max_points = 0;
        manifold.margin = -0.5;
        CHECK(crofton_shape_contacts_update(contacts, &placed, &placed, &manifold, nullptr, nullptr, nullptr) ==
              CROFTON_INVALID_ARGUMENT);
    }
}
