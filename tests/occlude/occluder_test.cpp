// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <box_mesh.hpp>
#include <crofton/occlude/occluder.hpp>
#include <error_of.hpp>
#include <limits>

using namespace crofton;

TEST_SUITE("occlude/occluder") {
    TEST_CASE("boxes that are not boxes are refused by name and hide nothing") {
        occlude::OccluderSet set;
        Obb box;
        box.half_extents = {1.0f, 1.0f, 1.0f};
        CHECK(*set.place(box) == 0);
        Obb bad = box;
        bad.center.y = std::numeric_limits<double>::quiet_NaN();
        const auto refused = set.place(bad);
        CHECK(error_of(refused).code == ErrorCode::non_finite);
        CHECK(error_of(refused).item == 1);
        bad = box;
        bad.half_extents.z = 0.0f;
        CHECK(error_of(set.place(bad)).code == ErrorCode::degenerate);
        CHECK(set.size() == 1);
        CHECK(error_of(set.move(0, bad)).code == ErrorCode::degenerate);
        CHECK(error_of(set.move(1, box)).code == ErrorCode::out_of_range);
        CHECK(error_of(set.move(0, scene::Transform{})).code == ErrorCode::invalid_argument);
    }

    TEST_CASE("meshes that are open, inside out, flat or not finite are refused by name") {
        occlude::OccluderSet set;
        CHECK(set.add_mesh(testing::box_mesh(glm::vec3(0.0f), glm::vec3(1.0f))));
        TriangleMesh open = testing::box_mesh(glm::vec3(0.0f), glm::vec3(1.0f));
        open.indices.resize(open.indices.size() - 3);
        CHECK(error_of(set.add_mesh(open)).code == ErrorCode::invalid_argument);
        CHECK(error_of(set.add_mesh(open)).item == 0);  // {1, 3, 7}, across the edge from 3 to 1
        TriangleMesh inside_out = testing::box_mesh(glm::vec3(0.0f), glm::vec3(1.0f));
        for (std::size_t i = 0; i < inside_out.indices.size(); i += 3)
            std::swap(inside_out.indices[i], inside_out.indices[i + 1]);
        CHECK(error_of(set.add_mesh(inside_out)).code == ErrorCode::invalid_argument);
        TriangleMesh flat = testing::box_mesh(glm::vec3(0.0f), glm::vec3(1.0f));
        for (glm::vec3& p : flat.positions) p.z = 0.5f;
        CHECK(error_of(set.add_mesh(flat)).code == ErrorCode::degenerate);
        TriangleMesh bad = testing::box_mesh(glm::vec3(0.0f), glm::vec3(1.0f));
        bad.positions[3].x = std::numeric_limits<float>::infinity();
        CHECK(error_of(set.add_mesh(bad)).code == ErrorCode::non_finite);
        CHECK(error_of(set.add_mesh(bad)).item == 3);
        CHECK(error_of(set.add_mesh(testing::box_mesh(glm::vec3(0.0f), glm::vec3(2e30f)))).code ==
              ErrorCode::out_of_range);
        bad = testing::box_mesh(glm::vec3(0.0f), glm::vec3(1.0f));
        bad.indices[5] = 8;
        CHECK(error_of(set.add_mesh(bad)).code == ErrorCode::out_of_range);
        CHECK(error_of(set.add_mesh(TriangleMesh{})).code == ErrorCode::degenerate);
        CHECK(set.add_surface(open, occlude::Sides::front));
        CHECK(error_of(set.add_convex(flat.positions)).code == ErrorCode::degenerate);
        CHECK(set.add_convex(bad.positions));
        CHECK(set.shape_count() == 3);
    }

    TEST_CASE("a transform that flattens a shape is refused") {
        occlude::OccluderSet set;
        const auto shape = *set.add_mesh(testing::box_mesh(glm::vec3(0.0f), glm::vec3(1.0f)));
        scene::Transform transform;
        transform.linear[1] = glm::dvec3(0.0);
        CHECK(error_of(set.place(shape, transform)).code == ErrorCode::degenerate);
        CHECK(error_of(set.place(shape + 1, {})).code == ErrorCode::out_of_range);
        CHECK(set.size() == 0);
        CHECK(*set.place(shape, {}) == 0);
        CHECK(error_of(set.move(0, Obb{})).code == ErrorCode::invalid_argument);
    }
}
