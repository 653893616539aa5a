// SPDX-License-Identifier: MIT
// Members of structs and parameters that other tests leave at their defaults: each does what its header says.
#include <algorithm>
#include <array>
#include <climits>
#include <cmath>
#include <cstring>
#include <set>

#include "world_fixture.hpp"

using namespace crofton::capi_test;

namespace {

template <class Make>
ShapeHandle shape_of(Make make) {
    crofton_shape* shape = nullptr;
    REQUIRE(make(&shape) == CROFTON_OK);
    return ShapeHandle(shape);
}
ShapeHandle sphere(float radius) {
    return shape_of([&](crofton_shape** shape) { return shape_sphere(radius, shape); });
}

// A sphere of radius 0.25 moves from `from` by `velocity` in a time of 1.
crofton_impact cast_at(const ShapeHandle& target, std::array<double, 3> from, std::array<double, 3> velocity,
                       const crofton_cast_options* options = nullptr) {
    const ShapeHandle moving = sphere(0.25f);
    const crofton_transform start = translation(from[0], from[1], from[2]), origin = translation(0, 0, 0);
    const crofton_placed a{moving.get(), &start}, b{target.get(), &origin};
    crofton_motion motion{};
    std::copy(velocity.begin(), velocity.end(), motion.velocity);
    auto impact = sized<crofton_impact>();
    REQUIRE(crofton_shapes_cast(&a, &motion, &b, nullptr, options, &impact) == CROFTON_OK);
    return impact;
}

}  // namespace

TEST_SUITE("capi/members") {
    TEST_CASE("every status has a name of its own, other numbers have none") {
        std::set<std::string> names;
        for (int status = CROFTON_OK; status <= CROFTON_OUT_OF_MEMORY; ++status)
            names.insert(crofton_status_name(status));
        CHECK(names.size() == CROFTON_OUT_OF_MEMORY + 1);
        CHECK(names.count("unknown status") == 0);
        CHECK(names.count("") == 0);
        CHECK(crofton_status_name(CROFTON_BAD_HANDLE) == std::string("bad handle"));
        for (const int none : {-1, -2, CROFTON_OUT_OF_MEMORY + 1, 1 << 30, INT_MAX, INT_MIN})
            CHECK(crofton_status_name(none) == std::string("unknown status"));
    }

    TEST_CASE("memory hooks without allocate are refused, and memory still comes from where it came") {
        const crofton_memory_hooks hooks{sizeof hooks, nullptr, nullptr, [](void*, void*, std::size_t, std::size_t) {}};
        CHECK(crofton_set_memory_hooks(&hooks) == CROFTON_INVALID_ARGUMENT);
        const Scene scene = make_scene();
        CHECK(scene);
    }

    TEST_CASE("criteria: what has no measure is refused and changes nothing, boxes merge by the one that is given") {
        crofton_criterion criterion{1, 2, 3};
        crofton_camera camera = crofton_default_camera();
        camera.far_distance = kNoLimit;
        CHECK(crofton_criterion_for_frustum(&camera, &criterion) != CROFTON_OK);
        for (const double length : {-1.0, 2e30, kNoLimit, kNotANumber})
            CHECK(crofton_criterion_for_rays(length, &criterion) == CROFTON_OUT_OF_RANGE);
        CHECK((criterion.volume_weight == 1 && criterion.area_weight == 2 && criterion.mean_curvature_weight == 3));
        const std::array<crofton_box, 2> boxes{box_at(0, 0, 0), box_at(1, 0, 0)};
        const crofton_criterion volume{1, 0, 0}, nothing{0, 0, 0};
        crofton_box merged = box_at(9, 9, 9);
        CHECK(crofton_fit_boxes(boxes.data(), 2, &nothing, &merged) == CROFTON_INVALID_ARGUMENT);
        CHECK(merged.center[0] == 9);
        REQUIRE(crofton_fit_boxes(boxes.data(), 2, &volume, &merged) == CROFTON_OK);
        const double size = 8.0 * merged.half_extents[0] * merged.half_extents[1] * merged.half_extents[2];
        CHECK(size == doctest::Approx(2.0).epsilon(1e-5));
    }

    TEST_CASE("a matrix is relative to its origin, and one without an inverse leaves the frustum as it was") {
        // The cube [-1, 1]^3 in OpenGL's clip space, about (50, 0, 0).
        std::array<double, 16> matrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
        const double origin[3] = {50, 0, 0};
        auto frustum = sized<crofton_frustum>();
        REQUIRE(crofton_frustum_from_matrix(matrix.data(), CROFTON_DEPTH_MINUS_ONE_TO_ONE, origin, &frustum) ==
                CROFTON_OK);
        const std::array<crofton_box, 2> boxes{box_at(50, 0, 0), box_at(0, 0, 0)};
        std::uint8_t verdicts[2] = {9, 9};
        REQUIRE(crofton_classify(&frustum, boxes.data(), 2, verdicts) == CROFTON_OK);
        CHECK(verdicts[0] == CROFTON_INSIDE);
        CHECK(verdicts[1] == CROFTON_OUTSIDE);
        const crofton_frustum before = frustum;
        matrix[0] = matrix[1] = matrix[2] = matrix[3] = kNotANumber;
        CHECK(crofton_frustum_from_matrix(matrix.data(), CROFTON_DEPTH_MINUS_ONE_TO_ONE, origin, &frustum) !=
              CROFTON_OK);
        CHECK(std::memcmp(&before, &frustum, sizeof before) == 0);
        crofton_box result = box_at(1, 2, 3);
        const crofton_box large = box_at(0, 0, 0, 1e25f);
        crofton_transform scale = translation(0, 0, 0);
        scale.linear[0] = scale.linear[4] = scale.linear[8] = 1e25;
        CHECK(crofton_box_transform(&scale, &large, &result) != CROFTON_OK);
        CHECK((result.center[0] == 1 && result.half_extents[0] == 0.5f));
    }

    TEST_CASE("an ear's triangulation is not proven, a minimal one is") {
        const Triangulator triangulator = make_triangulator();
        // Seven corners in two arms: ears come out longer than the best diagonals.
        const double points[] = {0, 0, 9, 0, 9, 1, 8, 5, 4, 1.5, 1, 6, 0, 3};
        const std::uint32_t end = 7;
        crofton_polygon polygon{sizeof polygon, points, 7, &end, 1};
        auto ear = sized<crofton_triangulation>(), best = ear;
        REQUIRE(crofton_triangulate(triangulator.get(), &polygon, CROFTON_TRIANGULATE_EAR, &ear) == CROFTON_OK);
        REQUIRE(crofton_triangulate(triangulator.get(), &polygon, CROFTON_TRIANGULATE_MINIMUM_WEIGHT, &best) ==
                CROFTON_OK);
        CHECK(ear.optimal == 0);
        CHECK(best.optimal == 1);
        CHECK(best.triangle_count == 5);
        CHECK(best.weight <= ear.weight);
        CHECK(best.gap <= 1e-9);
    }

    TEST_CASE("the given tolerance separates a hull's faces") {
        // A cube whose top has a point in its middle, higher by a thousandth.
        const float points[] = {-1, -1, -1, 1, -1, -1, -1, 1, -1, 1, 1, -1, -1,    -1,
                                1,  1,  -1, 1, -1, 1,  1,  1, 1,  1, 0, 0,  1.001f};
        const auto faces = [&](float tolerance) {
            const ShapeHandle hull =
                shape_of([&](crofton_shape** shape) { return shape_hull(points, 9, shape, 0, tolerance); });
            auto info = sized<crofton_shape_info>();
            REQUIRE(crofton_shape_get_info(hull.get(), &info) == CROFTON_OK);
            return info.face_count;
        };
        CHECK(faces(0.0f) == 9);
        CHECK(faces(1e-2f) == 6);
    }

    TEST_CASE("casts pass one-sided surfaces from behind, and a height field has spacing, holes and two sides") {
        const float positions[] = {-5, -5, 0, 5, -5, 0, 0, 5, 0};
        const std::uint32_t indices[] = {0, 1, 2};  // seen from above, where z > 0
        const crofton_mesh mesh{sizeof mesh, positions, 3, indices, 3, nullptr};
        for (const std::uint32_t front : {0u, 1u}) {
            const ShapeHandle surface =
                shape_of([&](crofton_shape** shape) { return shape_mesh(&mesh, front, shape); });
            CHECK(cast_at(surface, {0, 0, 2}, {0, 0, -4}).time == doctest::Approx(1.75 / 4).epsilon(1e-4));
            const crofton_impact behind = cast_at(surface, {0, 0, -2}, {0, 0, 4});
            CHECK(behind.result == (front ? CROFTON_CAST_MISS : CROFTON_CAST_HIT));
        }
        const float heights[6] = {};
        const std::uint8_t materials[2] = {CROFTON_HOLE, 0};
        auto field = sized<crofton_height_field>();
        field.columns = 3;
        field.rows = 2;
        field.heights = heights;
        field.materials = materials;
        field.spacing[0] = 2.0;
        field.spacing[1] = 3.0;
        for (const std::uint32_t both : {0u, 1u}) {
            const ShapeHandle ground =
                shape_of([&](crofton_shape** shape) { return shape_height_field(&field, both, shape); });
            auto info = sized<crofton_shape_info>();
            REQUIRE(crofton_shape_get_info(ground.get(), &info) == CROFTON_OK);
            CHECK(info.max[0] == doctest::Approx(4.0));
            CHECK(info.max[2] == doctest::Approx(3.0));
            CHECK(cast_at(ground, {1, 2, 1.5}, {0, -4, 0}).result == CROFTON_CAST_MISS);
            CHECK(cast_at(ground, {3, 2, 1.5}, {0, -4, 0}).result == CROFTON_CAST_HIT);
            CHECK(cast_at(ground, {3, -2, 1.5}, {0, 4, 0}).result == (both ? CROFTON_CAST_HIT : CROFTON_CAST_MISS));
        }
        for (std::uint32_t crofton_height_field::*const side :
             {&crofton_height_field::columns, &crofton_height_field::rows}) {
            crofton_height_field empty = field;
            empty.*side = 0;
            crofton_shape* made = nullptr;
            CHECK(shape_height_field(&empty, 0, &made) == CROFTON_OUT_OF_RANGE);
            CHECK(made == nullptr);
        }
    }

    TEST_CASE("a manifold has as many points as are wanted, and casts end at the tolerance and the steps given") {
        const float half[3] = {1, 1, 1};
        const ShapeHandle box = shape_of([&](crofton_shape** shape) { return shape_box(half, shape); });
        const crofton_transform below = translation(0, 0, 0), above = translation(0, 1.999, 0);
        const crofton_placed a{box.get(), &below}, b{box.get(), &above};
        crofton_shape_contacts* made = nullptr;
        REQUIRE(crofton_shape_contacts_create(&made) == CROFTON_OK);
        const ShapeContactsHandle contacts(made);
        auto options = sized<crofton_manifold_options>();
        crofton_tracked_point* points = nullptr;
        std::size_t count = 0;
        for (const std::uint32_t most : {0u, 1u, 2u}) {
            options.max_points = most;
            REQUIRE(crofton_shape_contacts_update(contacts.get(), &a, &b, &options, &points, &count, nullptr) ==
                    CROFTON_OK);
            CHECK(count == (most ? most : 4));
        }
        for (const double margin : {kNotANumber, kNoLimit}) {
            options.margin = margin;
            CHECK(crofton_shape_contacts_update(contacts.get(), &a, &b, &options, &points, &count, nullptr) ==
                  CROFTON_NON_FINITE);
        }
        CHECK(count == 2);

        auto cast = sized<crofton_cast_options>();
        cast.duration = 1.0;
        const crofton_impact exact = cast_at(box, {0, 4, 0}, {0, -4, 0}, &cast);
        CHECK(exact.time == doctest::Approx(2.75 / 4).epsilon(1e-5));
        cast.tolerance = 0.5;
        const crofton_impact early = cast_at(box, {0, 4, 0}, {0, -4, 0}, &cast);
        CHECK(early.result == CROFTON_CAST_HIT);
        CHECK(early.time <= exact.time);
        CHECK(early.distance <= 0.5);
        // A box that turns three times on its way takes more than one step.
        const crofton_transform high = translation(0, 4, 0);
        const crofton_placed turning{box.get(), &high};
        const crofton_motion turn{{0, -1, 0}, {0, 0, 20}, {0, 0, 0}};
        auto impact = sized<crofton_impact>();
        for (const std::uint32_t most : {0u, 1u}) {
            cast.max_steps = most;
            REQUIRE(crofton_shapes_cast(&turning, &turn, &a, nullptr, &cast, &impact) == CROFTON_OK);
            CHECK((impact.result == CROFTON_CAST_UNRESOLVED) == (most == 1));
        }
        cast.max_steps = 1u << 31;
        impact.time = 42;
        CHECK(crofton_shapes_cast(&a, nullptr, &b, nullptr, &cast, &impact) == CROFTON_OUT_OF_RANGE);
        CHECK(impact.time == 42);
        auto distance = sized<crofton_shape_distance>();
        distance.distance = 42;
        for (std::size_t k = 0; k < 3; ++k) {
            double point[3] = {5, 5, 5};
            point[k] = kNotANumber;
            CHECK(crofton_shape_closest_point(&a, point, &distance) == CROFTON_NON_FINITE);
        }
        CHECK(distance.distance == 42);
    }

    TEST_CASE("planes alone keep a box near the frustum's edge, masks may be left out, and meshes have names") {
        const SmallWorld small;
        const View view = default_view();
        REQUIRE(look_at_many(small.world.get(), std::span(&view, 1), small.in_views.get()) == CROFTON_OK);
        crofton_object_ref listed[1] = {};
        REQUIRE(crofton_view_result_list(small.in_views.get(), small.world.get(), 0, listed, nullptr, 1) == CROFTON_OK);
        CHECK(listed[0].user == 7);
        // A sliver past the edge of the near and the right plane: each of them has one of its ends on its inner side.
        crofton_box sliver = box_at(0.113, 0.0, -0.082, 0.001f);
        const float length = std::sqrt(1.25f);
        const float axes[9] = {1 / length, 0, -0.5f / length, 0, 1, 0, 0.5f / length, 0, 1 / length};
        std::copy(axes, axes + 9, sliver.axes);
        sliver.half_extents[0] = 0.5f;
        const VisibleSet visible = make_visible_set();
        auto options = sized<crofton_view_request>();
        const auto kept = [&](std::uint32_t conservative) {
            options.conservative = conservative;
            REQUIRE(cull_boxes(&sliver, nullptr, 1, &view, &options, nullptr, visible.get()) == CROFTON_OK);
            const std::uint32_t* ids = nullptr;
            std::size_t count = 0;
            REQUIRE(visible_set_items(visible.get(), &ids, nullptr, &count) == CROFTON_OK);
            return count;
        };
        CHECK(kept(1) == 1);
        CHECK(kept(0) == 0);
        const Scene scene = make_scene();
        const Tetrahedron tetrahedron;
        crofton_mesh mesh = tetrahedron.mesh();
        mesh.name = nullptr;
        std::uint32_t id = 7;
        CHECK(crofton_scene_add_mesh(scene.get(), &mesh, &id) == CROFTON_OK);
        CHECK(id == 0);
    }
}
