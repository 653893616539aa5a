// SPDX-License-Identifier: MIT
// Shapes in C: drawn as lines; manifolds and parts of pairs beside those of C++.
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <utility>

#include "shapes_fixture.hpp"

using namespace crofton;
using namespace crofton::capi_test;

namespace {

using Lines = std::vector<std::array<double, 6>>;

void keep_line(void* user, const double from[3], const double to[3]) {
    static_cast<Lines*>(user)->push_back({from[0], from[1], from[2], to[0], to[1], to[2]});
}

}  // namespace

TEST_SUITE("capi/shape_pairs") {
    TEST_CASE("every kind of shape is drawn with the lines of C++, and so are contacts") {
        const std::vector<ShapeHandle> shapes = all_kinds();
        const std::size_t counts[] = {0, 0, 0, 0, 12, 3, 12, 5, 0, 12, 12, 24};
        const crofton_transform here = translation(3, 4, 5);
        for (std::size_t i = 0; i < shapes.size(); ++i) {
            CAPTURE(i);
            Lines lines;
            const crofton_placed placed{shapes[i].get(), &here};
            REQUIRE(crofton_shape_outline(&placed, keep_line, &lines) == CROFTON_OK);
            if (counts[i] != 0) CHECK(lines.size() == counts[i]);
            CHECK(lines.size() >= 3);
            auto info = sized<crofton_shape_info>();
            REQUIRE(crofton_shape_get_info(shapes[i].get(), &info) == CROFTON_OK);
            for (const auto& line : lines)
                for (int k = 0; k < 6 && std::isfinite(info.max[1]); ++k) {
                    const double at = line[static_cast<std::size_t>(k)] - here.translation[k % 3];
                    CHECK(at >= info.min[k % 3] - 1e-6);
                    CHECK(at <= info.max[k % 3] + 1e-6);
                }
        }
        Lines lines;
        const crofton_placed sphere{shapes[0].get(), &here};
        REQUIRE(crofton_shape_outline(&sphere, keep_line, &lines) == CROFTON_OK);
        const RigidTransform pose{glm::dmat3(1.0), {3, 4, 5}};
        std::size_t line = 0;
        convex::outline({convex::Shape::sphere(0.5f).value(), pose}, [&](const glm::dvec3& from, const glm::dvec3& to) {
            REQUIRE(line < lines.size());
            CHECK(lines[line++] == std::array<double, 6>{from.x, from.y, from.z, to.x, to.y, to.z});
        });
        CHECK(line == lines.size());

        crofton_shape_contacts* made = nullptr;
        REQUIRE(crofton_shape_contacts_create(&made) == CROFTON_OK);
        const ShapeContactsHandle contacts(made);
        const crofton_transform above = translation(3, 4.4, 5);
        const crofton_placed a{shapes[4].get(), &here}, b{shapes[4].get(), &above};
        REQUIRE(crofton_shape_contacts_update(made, &a, &b, nullptr, nullptr, nullptr, nullptr) == CROFTON_OK);
        lines.clear();
        REQUIRE(crofton_shape_contacts_outline(made, 0.25, keep_line, &lines) == CROFTON_OK);
        CHECK(lines.size() == 16);
        std::size_t upward = 0;
        for (const auto& l : lines) upward += std::fabs(l[4] - l[1] - 0.25) < 1e-9;
        CHECK(upward == 4);
        CHECK(crofton_shape_contacts_outline(made, -1, keep_line, &lines) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_shape_contacts_outline(made, NAN, keep_line, &lines) == CROFTON_NON_FINITE);
        CHECK(crofton_shape_contacts_outline(made, 1, nullptr, &lines) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_shape_contacts_outline(nullptr, 1, keep_line, &lines) == CROFTON_BAD_HANDLE);
        CHECK(crofton_shape_outline(&a, nullptr, &lines) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_shape_outline(nullptr, keep_line, &lines) == CROFTON_BAD_HANDLE);
        CHECK(lines.size() == 16);
    }

    TEST_CASE("manifolds and parts near are those of C++") {
        const std::vector<ShapeHandle> handles = all_kinds();
        const float heights[6] = {0, 1, 0, 1, 0, 1};
        const convex::HeightField field =
            convex::HeightField::build({.columns = 3, .rows = 2, .heights = heights}).value();
        const convex::Shape box = convex::Shape::box({0.5f, 0.25f, 1.0f}).value();
        const std::pair<std::size_t, convex::Shape> shapes[] = {
            {0, convex::Shape::sphere(0.5f).value()},
            {3, convex::Shape::cone(0.5f, 0.5f).value()},
            {4, box},
            {8, convex::Shape::rounded(box, 0.125f).value()},
            {10, convex::Shape::height_field(field, convex::Sides::front)}};
        const crofton_transform here = translation(0, 0, 0), there = translation(0.25, 0.5, 0.125);
        const RigidTransform pose_a{}, pose_b{glm::dmat3(1.0), {0.25, 0.5, 0.125}};
        int points = 0, parts_found = 0;
        for (const auto& [first, shape_a] : shapes)
            for (const auto& [second, shape_b] : shapes) {
                const crofton_placed a{handles[first].get(), &here}, b{handles[second].get(), &there};
                auto options = sized<crofton_manifold_options>();
                options.margin = 0.125;
                options.max_points = 8;
                auto manifold = sized<crofton_shape_manifold>();
                crofton_pair_cache cache{};
                REQUIRE(crofton_shapes_manifold(&a, &b, &options, &cache, &manifold) == CROFTON_OK);
                const convex::Manifold expected =
                    convex::contact_manifold({shape_a, pose_a}, {shape_b, pose_b}, {.margin = 0.125, .max_points = 8});
                REQUIRE(manifold.point_count == static_cast<std::uint32_t>(expected.count));
                CHECK(manifold.depth == expected.depth);
                for (int k = 0; k < 3; ++k) CHECK(manifold.normal[k] == expected.normal[k]);
                for (int i = 0; i < expected.count; ++i, ++points) {
                    const crofton_shape_point& point = manifold.points[i];
                    CHECK(point.position[1] == expected.points[i].position.y);
                    CHECK(point.depth == expected.points[i].depth);
                    CHECK(point.on_b.index == expected.points[i].on_b.index);
                    CHECK(point.part_a.triangle == expected.points[i].part_a.triangle);
                }
                Vector<convex::Part> parts;
                convex::parts_near({shape_a, pose_a}, {shape_b, pose_b}, 0.125, parts);
                crofton_part near[3] = {};
                std::size_t count = 77;
                REQUIRE(crofton_shape_parts_near(&a, &b, 0.125, near, 3, &count) == CROFTON_OK);
                REQUIRE(count == parts.size());
                for (std::size_t i = 0; i < std::min<std::size_t>(count, 3); ++i, ++parts_found) {
                    CHECK(near[i].child == parts[i].id.child);
                    CHECK(near[i].triangle == parts[i].id.triangle);
                }
            }
        CHECK(points > 40);
        CHECK(parts_found > 30);
    }

    TEST_CASE("manifolds and parts near refuse what is bad by name, and leave the result alone") {
        const ShapeHandle box = box_shape(1, 1, 1);
        const crofton_transform here = translation(0, 0, 0);
        const crofton_placed a{box.get(), &here};
        auto manifold = sized<crofton_shape_manifold>();
        auto options = sized<crofton_manifold_options>();
        options.max_points = 9;
        CHECK(crofton_shapes_manifold(&a, &a, &options, nullptr, &manifold) == CROFTON_OUT_OF_RANGE);
        CHECK(crofton_shapes_manifold(&a, nullptr, nullptr, nullptr, &manifold) == CROFTON_BAD_HANDLE);
        CHECK(crofton_shapes_manifold(&a, &a, nullptr, nullptr, nullptr) == CROFTON_INVALID_ARGUMENT);
        manifold.size += 8;
        CHECK(crofton_shapes_manifold(&a, &a, nullptr, nullptr, &manifold) == CROFTON_WRONG_SIZE);
        std::size_t count = 77;
        CHECK(crofton_shape_parts_near(&a, &a, -1.0, nullptr, 0, &count) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_shape_parts_near(&a, &a, 0.0, nullptr, 1, &count) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_shape_parts_near(&a, &a, 0.0, nullptr, 0, nullptr) == CROFTON_INVALID_ARGUMENT);
        CHECK(count == 77);
        REQUIRE(crofton_shape_parts_near(&a, &a, 0.0, nullptr, 0, &count) == CROFTON_OK);
        CHECK(count == 1);
    }
}
