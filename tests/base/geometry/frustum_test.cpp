// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/geometry/camera.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <random>
#include <utility>

using namespace crofton;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool holds(const Frustum& frustum, const glm::dvec3& point) {
    for (const Plane& plane : frustum.view())
        if (glm::dot(plane.normal, point - frustum.origin) + plane.offset < 0.0) return false;
    return true;
}

// The clip volume itself, as the matrix defines it.
bool in_clip_volume(const glm::dmat4& matrix, DepthRange depth, const glm::dvec3& point) {
    const glm::dvec4 p = matrix * glm::dvec4(point, 1.0);
    const double low = depth == DepthRange::minus_one_to_one ? -p.w : 0.0;
    return std::abs(p.x) <= p.w && std::abs(p.y) <= p.w && low <= p.z && p.z <= p.w;
}

}  // namespace

TEST_SUITE("geometry/frustum") {
    TEST_CASE("bad cameras and matrices are refused by name") {
        Camera camera;
        camera.up = camera.forward;
        CHECK(error_of(frustum_of(camera)).code == ErrorCode::degenerate);
        camera = {};
        camera.position.y = std::nan("");
        CHECK(error_of(frustum_of(camera)).code == ErrorCode::non_finite);
        camera = {};
        camera.near_distance = 0.0;
        CHECK(error_of(frustum_of(camera)).code == ErrorCode::out_of_range);
        glm::dmat4 matrix(1.0);
        matrix[2][2] = 0.0;
        CHECK(error_of(frustum_of(matrix, DepthRange::zero_to_one)).code == ErrorCode::degenerate);
        matrix[1][3] = std::nan("");
        CHECK(error_of(frustum_of(matrix, DepthRange::zero_to_one)).code == ErrorCode::non_finite);
    }

    TEST_CASE("an up that is nearly forward is refused, a little farther off it is good") {
        Camera camera;
        camera.up = camera.forward + glm::dvec3(1e-10, 0.0, 0.0);
        CHECK(error_of(frustum_of(camera)).code == ErrorCode::degenerate);
        camera.up = camera.forward + glm::dvec3(1e-8, 0.0, 0.0);
        CHECK(frustum_of(camera).has_value());
    }

    TEST_CASE("a view matrix that is singular but for its last bits is refused, a nearly flat one is good") {
        const glm::dmat4 matrix = world_to_clip(Camera{});
        for (int r = 0; r < 3; ++r)
            for (const double off : {0.0, 1e-16, 1e-8}) {
                // Row r becomes that of w, but for a share of what it was.
                glm::dmat4 flat = matrix;
                for (int c = 0; c < 4; ++c) flat[c][r] = matrix[c][3] + off * matrix[c][r];
                const auto frustum = frustum_of(flat, DepthRange::minus_one_to_one);
                CHECK(frustum.has_value() == (off == 1e-8));
                if (!frustum) CHECK(error_of(frustum).code == ErrorCode::degenerate);
            }
    }

    TEST_CASE(
        "a view matrix with the translation of a camera 10,000 km away is not singular, nor is one of any length") {
        for (const double distance : {1e3, 1e5, 1e7})
            for (const double far : {1000.0, std::numeric_limits<double>::infinity()})
                for (const double length : {1e-60, 1.0, 1e60}) {
                    Camera camera;
                    camera.position = distance * glm::dvec3(1.0, 0.7, -0.3);
                    camera.forward = {0.3, -0.2, -0.9};
                    camera.far_distance = far;
                    const auto frustum =
                        frustum_of(length * world_to_clip(camera), DepthRange::reversed_zero_to_one).value();
                    const glm::dvec3 ahead = glm::normalize(camera.forward);
                    for (const auto& [along, inside] : {std::pair(0.05, false), std::pair(10.0, true)}) {
                        const glm::dvec3 at = camera.position + along * ahead;
                        bool within = true;
                        for (const Plane& plane : frustum.view())
                            within &= glm::dot(plane.normal, at) + plane.offset >= 0.0;
                        CHECK(within == inside);
                    }
                }
    }

    TEST_CASE("a view matrix whose volume is empty is refused: a side that lies beyond infinity") {
        // Rows x, y, z, w: w + x = (0, 0, 0, ∓1), which no point or every point satisfies.
        const auto with_side = [](double offset) {
            const glm::dvec4 rows[] = {{0, 0, 1, offset}, {0, 1, 0, 0}, {1, 0, 0, 0}, {0, 0, -1, 0}};
            glm::dmat4 matrix;
            for (int r = 0; r < 4; ++r)
                for (int c = 0; c < 4; ++c) matrix[c][r] = rows[r][c];
            return matrix;
        };
        CHECK(error_of(frustum_of(with_side(-1.0), DepthRange::zero_to_one)).code == ErrorCode::empty);
        const auto open = frustum_of(with_side(1.0), DepthRange::zero_to_one).value();
        CHECK(open.plane_count == 5);
    }

    TEST_CASE("parameters and matrices of every kind give the same volume as the clip conditions") {
        std::mt19937_64 random(3);
        std::uniform_real_distribution<double> number(-1.0, 1.0);
        for (const Projection projection : {Projection::perspective, Projection::orthographic})
            for (const DepthRange depth :
                 {DepthRange::reversed_zero_to_one, DepthRange::zero_to_one, DepthRange::minus_one_to_one})
                for (const double far : {30.0, kInfinity}) {
                    if (projection == Projection::orthographic && far == kInfinity) continue;
                    Camera camera;
                    camera.projection = projection;
                    camera.position = {3.0, -2.0, 5.0};
                    camera.forward = {0.3, 0.2, -0.9};
                    camera.near_distance = 0.5;
                    camera.far_distance = far;
                    const glm::dmat4 matrix = world_to_clip(camera, depth);
                    const auto from_camera = frustum_of(camera);
                    const auto from_matrix = frustum_of(matrix, depth);
                    REQUIRE(from_camera.has_value());
                    REQUIRE(from_matrix.has_value());
                    CHECK(from_camera->plane_count == (far == kInfinity ? 5 : 6));
                    CHECK(from_matrix->plane_count == from_camera->plane_count);
                    int inside = 0;
                    for (int trial = 0; trial < 4000; ++trial) {
                        const glm::dvec3 point =
                            camera.position + 20.0 * glm::dvec3(number(random), number(random), number(random));
                        const bool truth = in_clip_volume(matrix, depth, point);
                        inside += truth;
                        CHECK(holds(*from_camera, point) == truth);
                        CHECK(holds(*from_matrix, point) == truth);
                    }
                    CHECK(inside > 20);
                }
    }

    TEST_CASE("corners project to the corners of the clip volume") {
        Camera camera;
        camera.position = {1.0, 2.0, 3.0};
        const auto frustum = frustum_of(camera).value();
        const auto corners = frustum_corners(frustum).value();
        for (unsigned i = 0; i < 8; ++i) {
            const glm::dvec4 p = world_to_clip(camera) * glm::dvec4(camera.position + corners[i], 1.0);
            CHECK(p.x / p.w == doctest::Approx((i & 1) ? 1.0 : -1.0));
            CHECK(p.y / p.w == doctest::Approx((i & 2) ? 1.0 : -1.0));
            CHECK(p.z / p.w == doctest::Approx((i & 4) ? 0.0 : 1.0).epsilon(1e-6));
        }
    }
}
