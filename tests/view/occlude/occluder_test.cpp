// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <gmpxx.h>
#include <box_mesh.hpp>
#include <cmath>
#include <crofton/occlude/occlusion.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "../../../engine/view/occlude/src/exact_turn.hpp"

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
        CHECK(error_of(set.move(0, Transform{})).code == ErrorCode::invalid_argument);
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

    TEST_CASE("an exact determinant detects a transform that flattens up to rounding") {
        // a, b and a + b, which is exact: in double the determinant comes to 1e-17.
        const glm::dvec3 a(-0x1.4d223a689f2fcp-3, -0x1.003a374ea656cp-1, -0x1.aa42dc616b644p-2),
            b(0x1.3683951aabdc2p-1, -0x1.a0414d6c909ap-5, -0x1.d729f50de481ap-2);
        occlude::OccluderSet set;
        TriangleMesh quad;  // faces +z
        quad.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
        quad.indices = {0, 1, 2, 0, 2, 3};
        const auto shape = set.add_surface(quad, occlude::Sides::front);
        REQUIRE(shape);
        CHECK(error_of(set.place(*shape, {glm::dmat3(a, b, a + b), glm::dvec3(0)})).code == ErrorCode::degenerate);
        // Determinant 8.5e-19, in double -8.7e-19: +z stays on the side that the third column leads to.
        const glm::dvec3 u(-0x1.df32729ba90cp-5, -0x1.b3c9ec1b903adp-1, 0x1.1e180b364f46p-3),
            v(0x1.14f41ae07224p-2, -0x1.a46661cb18044p-1, 0x1.cc37b0ce96c6p-4),
            w(0x1.8393a3497b07ep-3, -0x1.d7cf56b0a94p-10, -0x1.9f993b5020d18p-7);
        const glm::dvec3 normal = glm::normalize(glm::cross(u, v));
        for (const bool mirrored : {false, true}) {
            occlude::OccluderSet one;
            const auto same = one.add_surface(quad, occlude::Sides::front);
            REQUIRE(same);
            REQUIRE(one.place(*same, {32.0 * glm::dmat3(u, v, mirrored ? -w : w), glm::dvec3(0)}));
            for (const double side : {1.0, -1.0}) {
                Camera camera;
                camera.position = 5.0 * side * normal;
                camera.forward = -side * normal;
                camera.up = u;
                camera.fov_y = 0.5;
                auto buffer = *occlude::OcclusionBuffer::create({.width = 64, .height = 64});
                buffer.draw(one, *occlude::occlusion_view_of(camera));
                CHECK((buffer.count_covered() > 0) == ((side > 0.0) != mirrored));
            }
        }
    }

    TEST_CASE("the sign of a determinant that rounding hides is that of rationals") {
        std::mt19937_64 random(9);
        std::uniform_real_distribution<double> number(-1.0, 1.0);
        int wrong_in_double = 0;
        for (int i = 0; i < 20'000; ++i) {
            // The last row is a sum of the others, rounded.
            glm::dmat3 m;
            const double s = number(random), t = number(random);
            for (int k = 0; k < 3; ++k) {
                m[0][k] = number(random), m[1][k] = number(random);
                m[2][k] = s * m[0][k] + t * m[1][k];
            }
            mpq_class exact = 0;
            for (int k = 0; k < 3; ++k) {
                const int u = (k + 1) % 3, v = (k + 2) % 3;
                exact += mpq_class(m[0][k]) *
                         (mpq_class(m[1][u]) * mpq_class(m[2][v]) - mpq_class(m[1][v]) * mpq_class(m[2][u]));
            }
            if (glm::determinant(m) * sgn(exact) <= 0.0) ++wrong_in_double;
            REQUIRE(occlude::sign_of_determinant(m) == sgn(exact));
        }
        CHECK(wrong_in_double > 100);
    }

    TEST_CASE("whatever number of a box, mesh or transform is bad, it is refused, and the same is hidden as before") {
        occlude::OccluderSet set;
        Obb box;
        box.center = {0.0, 0.0, -10.0};
        box.half_extents = {1.0f, 1.0f, 1.0f};
        const auto placed = *set.place(box);
        TriangleMesh mesh = testing::box_mesh(glm::vec3(-5.0f, -5.0f, -25.0f), glm::vec3(5.0f, 5.0f, -15.0f));
        const auto shape = *set.add_mesh(mesh);
        auto buffer = *occlude::OcclusionBuffer::create({64, 36});
        const auto depth = [&] {
            std::vector<float> nearness(std::size_t{64} * 36);
            buffer.draw(set, *occlude::occlusion_view_of(Camera{}));
            buffer.read(nearness);
            return nearness;
        };
        const auto before = depth();
        const auto refuse = [&](auto& number, auto bad, ErrorCode code, auto... attempts) {
            const auto good = std::exchange(number, bad);
            for (const Error& error : {error_of(attempts())...}) CHECK(error.code == code);
            number = good;
        };
        const auto place = [&] { return set.place(box); };
        const auto move = [&] { return set.move(placed, box); };
        Transform transform;
        const auto transformed = [&] { return set.place(shape, transform); };
        const auto add_mesh = [&] { return set.add_mesh(mesh); };
        const auto add_surface = [&] { return set.add_surface(mesh, occlude::Sides::both); };
        const auto add_convex = [&] { return set.add_convex(mesh.positions); };
        for (const double bad : {std::numeric_limits<double>::quiet_NaN(), HUGE_VAL, -HUGE_VAL})
            for (int k = 0; k < 3; ++k) {
                const auto code = ErrorCode::non_finite;
                refuse(box.center[k], bad, code, place, move);
                refuse(box.half_extents[k], static_cast<float>(bad), code, place, move);
                for (int j = 0; j < 3; ++j) {
                    refuse(box.axes[k][j], static_cast<float>(bad), code, place, move);
                    refuse(transform.linear[k][j], bad, code, transformed);
                }
                refuse(transform.translation[k], bad, code, transformed);
                refuse(mesh.positions[7][k], static_cast<float>(bad), code, add_mesh, add_surface, add_convex);
            }
        for (int k = 0; k < 3; ++k) {
            refuse(box.half_extents[k], 0.0f, ErrorCode::degenerate, place, move);
            refuse(transform.linear[k], glm::dvec3(0.0), ErrorCode::degenerate, transformed);
        }
        std::swap(mesh.indices[0], mesh.indices[1]);  // one face is turned over
        std::swap(mesh.indices[3], mesh.indices[4]);
        CHECK(error_of(add_mesh()).code == ErrorCode::invalid_argument);
        for (glm::vec3& p : mesh.positions) p.y = p.x;
        for (glm::vec3& p : mesh.positions) p.z = p.x;
        CHECK(error_of(add_surface()).code == ErrorCode::degenerate);
        CHECK(depth() == before);
    }

    TEST_CASE("a transform that flattens a shape is refused") {
        occlude::OccluderSet set;
        const auto shape = *set.add_mesh(testing::box_mesh(glm::vec3(0.0f), glm::vec3(1.0f)));
        Transform transform;
        transform.linear[1] = glm::dvec3(0.0);
        CHECK(error_of(set.place(shape, transform)).code == ErrorCode::degenerate);
        CHECK(error_of(set.place(shape + 1, {})).code == ErrorCode::out_of_range);
        CHECK(set.size() == 0);
        CHECK(*set.place(shape, {}) == 0);
        CHECK(error_of(set.move(0, Obb{})).code == ErrorCode::invalid_argument);
    }
}
