// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <array>
#include <cmath>
#include <crofton/geometry/camera.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/sampling/sampling.hpp>
#include <error_of.hpp>
#include <numbers>
#include <vector>

using namespace crofton;
using namespace crofton::measure;
using namespace crofton::sampling;
using std::numbers::pi;

TEST_SUITE("measure/intrinsic_volumes") {
    TEST_CASE("criteria with NaN, negative or only zero weights are refused") {
        CHECK(error_of(validate(Criterion{std::nan(""), 1.0, 1.0})).item == 0);
        CHECK(error_of(validate(Criterion{1.0, -1.0, 1.0})).item == 1);
        CHECK(error_of(validate(Criterion{})).code == ErrorCode::invalid_argument);
        CHECK(validate(minimal_perimeter()).has_value());
    }

    TEST_CASE("a surface that is open, torn or not finite is no polytope, and the culprit is named") {
        const std::vector<glm::dvec3> v = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
        const std::vector<std::uint32_t> open = {0, 2, 1, 0, 1, 3, 1, 2, 3}, out = {0, 2, 9};
        CHECK(error_of(intrinsic_volumes_of_polytope(v, open)).code == ErrorCode::degenerate);
        CHECK(error_of(intrinsic_volumes_of_polytope(v, out)).item == 2);
        CHECK(error_of(intrinsic_volumes_of_polytope(v, {})).code == ErrorCode::invalid_argument);
        for (int k = 0; k < 3; ++k)
            for (const double number : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
                std::vector<glm::dvec3> bad = v;
                bad[3][k] = number;
                CHECK(error_of(intrinsic_volumes_of_polytope(bad, open)).item == 3);
                CHECK(error_of(intrinsic_volumes_of_polytope(bad, open)).code == ErrorCode::non_finite);
            }
    }

    TEST_CASE("tetrahedra that share an edge are no polytope, whether it comes first or last") {
        std::vector<glm::dvec3> v = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}};
        for (const bool last : {false, true}) {
            // The shared edge has the lowest numbers, or the highest.
            const auto number = [&](std::uint32_t i) { return last ? 5 - i : i; };
            std::vector<glm::dvec3> points(6);
            for (std::uint32_t i = 0; i < 6; ++i) points[number(i)] = v[i];
            std::vector<std::uint32_t> surface;
            for (const std::uint32_t other : {2u, 4u}) {
                const std::uint32_t corners[4] = {0, 1, other, other + 1};
                for (const std::array<int, 3>& face : {std::array{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}})
                    for (const int c : face) surface.push_back(number(corners[c]));
            }
            CAPTURE(last);
            CHECK(error_of(intrinsic_volumes_of_polytope(points, surface)).code == ErrorCode::degenerate);
            // Each by itself is one.
            CHECK(intrinsic_volumes_of_polytope(points, std::span(surface).first(12)).has_value());
            CHECK(intrinsic_volumes_of_polytope(points, std::span(surface).last(12)).has_value());
        }
    }

    TEST_CASE("a flat triangle given by both sides is a flat polygon") {
        const std::vector<glm::dvec3> v = {{0.0, 0.0, 0.0}, {3.0, 0.0, 0.0}, {0.0, 4.0, 0.0}};
        const std::vector<std::uint32_t> sides = {0, 1, 2, 0, 2, 1};
        const IntrinsicVolumes triangle = *intrinsic_volumes_of_polytope(v, sides),
                               flat = intrinsic_volumes_of_flat_polygon(6.0, 12.0);
        CHECK(triangle.volume == 0.0);
        CHECK(triangle.area == doctest::Approx(flat.area));
        CHECK(triangle.mean_curvature == doctest::Approx(flat.mean_curvature));
    }

    TEST_CASE("a regular tetrahedron has M = 3·edge·arccos(−1/3)") {
        const std::vector<glm::dvec3> v = {{1.0, 1.0, 1.0}, {1.0, -1.0, -1.0}, {-1.0, 1.0, -1.0}, {-1.0, -1.0, 1.0}};
        const std::vector<std::uint32_t> faces = {0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2};
        const double edge = std::sqrt(8.0);
        const IntrinsicVolumes k = *intrinsic_volumes_of_polytope(v, faces);
        CHECK(k.volume == doctest::Approx(8.0 / 3.0));
        CHECK(k.area == doctest::Approx(std::sqrt(3.0) * edge * edge));
        CHECK(k.mean_curvature == doctest::Approx(3.0 * edge * std::acos(-1.0 / 3.0)));
    }

    TEST_CASE("hulls of points, segments and flat clouds have the measures of their dimension") {
        CHECK(error_of(intrinsic_volumes_of_hull({})).code == ErrorCode::empty);
        const std::vector<glm::dvec3> same(5, glm::dvec3(3.0));
        CHECK(intrinsic_volumes_of_hull(same)->mean_curvature == 0.0);
        std::vector<glm::dvec3> line, plane;
        for (int i = 0; i < 7; ++i) line.push_back(static_cast<double>(i * i) * glm::dvec3(1.0, 2.0, 2.0));
        CHECK(intrinsic_volumes_of_hull(line)->mean_curvature ==
              doctest::Approx(intrinsic_volumes_of_segment(108.0).mean_curvature));
        for (int i = 0; i < 25; ++i) plane.emplace_back(i % 5, 3 * (i / 5), 4 * (i / 5));  // a rectangle of 4 by 20
        const IntrinsicVolumes flat = intrinsic_volumes_of_flat_polygon(80.0, 48.0);
        CHECK(intrinsic_volumes_of_hull(plane)->area == doctest::Approx(flat.area));
        CHECK(intrinsic_volumes_of_hull(plane)->mean_curvature == doctest::Approx(flat.mean_curvature));
        CHECK(intrinsic_volumes_of_hull(plane)->volume == 0.0);
    }

    TEST_CASE("the hull of a full grid is its box, and of points in a sphere nearly the sphere") {
        std::vector<glm::dvec3> grid;
        for (int i = 0; i < 5 * 4 * 3; ++i) grid.emplace_back(i % 5, (i / 5) % 4, i / 20);
        const IntrinsicVolumes box = intrinsic_volumes_of_box(4.0, 3.0, 2.0), hull = *intrinsic_volumes_of_hull(grid);
        CHECK(hull.volume == doctest::Approx(box.volume));
        CHECK(hull.area == doctest::Approx(box.area));
        CHECK(hull.mean_curvature == doctest::Approx(box.mean_curvature));
        Random random(1);
        std::vector<glm::dvec3> cloud;
        for (int i = 0; i < 2000; ++i) cloud.push_back(direction(random.point<2>()));
        CHECK(intrinsic_volumes_of_hull(cloud)->volume ==
              doctest::Approx(intrinsic_volumes_of_sphere(1.0).volume).epsilon(0.01));
        CHECK(intrinsic_volumes_of_hull(cloud)->area ==
              doctest::Approx(intrinsic_volumes_of_sphere(1.0).area).epsilon(0.01));
        CHECK(intrinsic_volumes_of_hull(cloud)->mean_curvature ==
              doctest::Approx(intrinsic_volumes_of_sphere(1.0).mean_curvature).epsilon(0.005));
        // Agrees with the frustum's own closed forms.
        Camera camera;
        camera.near_distance = 1.0, camera.far_distance = 9.0;
        const auto c = *frustum_corners(*frustum_of(camera));
        CHECK(intrinsic_volumes_of_hull(c)->mean_curvature ==
              doctest::Approx(intrinsic_volumes_of_frustum(camera)->mean_curvature));
    }

    TEST_CASE("measures are additive over a convex union, grow with the body and scale by their degree") {
        Random random(2);
        for (int trial = 0; trial < 20; ++trial) {
            std::vector<glm::dvec3> points, more;
            for (int i = 0; i < 12; ++i) points.push_back(ball_point(random.point<3>()));
            more = points;
            more.push_back(2.0 * direction(random.point<2>()));
            const IntrinsicVolumes k = *intrinsic_volumes_of_hull(points), larger = *intrinsic_volumes_of_hull(more);
            CHECK(larger.volume >= k.volume);
            CHECK(larger.area >= k.area);
            CHECK(larger.mean_curvature >= k.mean_curvature);
            const RigidTransform move{rotation(random.point<3>()), glm::dvec3(5.0)};
            for (glm::dvec3& p : points) p = transform(move, 3.0 * p);
            const IntrinsicVolumes moved = *intrinsic_volumes_of_hull(points);
            CHECK(moved.volume == doctest::Approx(27.0 * k.volume));
            CHECK(moved.area == doctest::Approx(9.0 * k.area));
            CHECK(moved.mean_curvature == doctest::Approx(3.0 * k.mean_curvature));
        }
        // A box cut in two: union and the common rectangle against the halves.
        const IntrinsicVolumes whole = intrinsic_volumes_of_box(5.0, 2.0, 1.0),
                               left = intrinsic_volumes_of_box(3.0, 2.0, 1.0),
                               right = intrinsic_volumes_of_box(2.0, 2.0, 1.0),
                               cut = intrinsic_volumes_of_flat_polygon(2.0, 6.0);
        CHECK(whole.volume + cut.volume == doctest::Approx(left.volume + right.volume));
        CHECK(whole.area + cut.area == doctest::Approx(left.area + right.area));
        CHECK(whole.mean_curvature + cut.mean_curvature == doctest::Approx(left.mean_curvature + right.mean_curvature));
    }

    TEST_CASE("a narrow view of a near-cube gives the cube's measures") {
        // An orthographic volume is a box: V, F and M are known in closed form.
        Camera camera;
        camera.projection = Projection::orthographic;
        camera.height = 2.0;
        camera.aspect = 1.5;
        camera.near_distance = 1.0;
        camera.far_distance = 5.0;
        const auto measures = intrinsic_volumes_of_frustum(camera).value();
        const IntrinsicVolumes box = intrinsic_volumes_of_box(3.0, 2.0, 4.0);
        CHECK(measures.volume == doctest::Approx(box.volume));
        CHECK(measures.area == doctest::Approx(box.area));
        CHECK(measures.mean_curvature == doctest::Approx(box.mean_curvature));
    }

    TEST_CASE("a perspective view volume has the volume and area of its truncated pyramid") {
        Camera camera;
        camera.fov_y = 0.5 * pi;  // half-tangent 1
        camera.aspect = 0.6;
        camera.near_distance = 0.1;
        camera.far_distance = 10.0;
        const auto measures = intrinsic_volumes_of_frustum(camera).value();
        const auto face = [](double d) { return 4.0 * 0.6 * d * d; };
        CHECK(measures.volume == doctest::Approx((face(10.0) * 10.0 - face(0.1) * 0.1) / 3.0));
        const double slant_x = 4.0 * 0.5 * std::sqrt(1.0 + 0.36) * (100.0 - 0.01);  // left and right: half-width 0.6
        const double slant_y = 4.0 * 0.5 * 0.6 * std::sqrt(2.0) * (100.0 - 0.01);
        CHECK(measures.area == doctest::Approx(face(10.0) + face(0.1) + slant_x + slant_y));
    }

    TEST_CASE("the kinematic formula is symmetric and gives Steiner's formula for a sphere") {
        const IntrinsicVolumes box = intrinsic_volumes_of_box(1.0, 2.0, 3.0);
        const double r = 0.5;
        const double steiner = box.volume + box.area * r + box.mean_curvature * r * r + 4.0 / 3.0 * pi * r * r * r;
        CHECK(kinematic_measure(intrinsic_volumes_of_sphere(r), box) == doctest::Approx(steiner));
        CHECK(kinematic_measure(box, intrinsic_volumes_of_sphere(r)) == doctest::Approx(steiner));
    }

    TEST_CASE("long rays rank boxes by area, large bodies by edge sum") {
        const Criterion rays = for_rays(1e9), body = for_partner(intrinsic_volumes_of_sphere(1e9));
        const auto cube = intrinsic_volumes_of_box(1.0, 1.0, 1.0), plate = intrinsic_volumes_of_box(2.4, 0.7, 0.05);
        CHECK(rays(cube) / rays(plate) == doctest::Approx(cube.area / plate.area));
        CHECK(body(cube) / body(plate) == doctest::Approx(cube.mean_curvature / plate.mean_curvature));
    }

    TEST_CASE("triangles met: any fan's triangles one by one add up to what its boundary, weight and area give") {
        Random random(71);
        for (int round = 0; round < 100; ++round) {
            std::vector<glm::dvec2> ring;
            const std::size_t n = 3 + static_cast<std::size_t>(round) % 9;
            for (std::size_t k = 0; k < n; ++k) {
                const double angle =
                    2.0 * pi * (static_cast<double>(k) + 0.9 * random.uniform()) / static_cast<double>(n);
                ring.emplace_back(3.0 * std::cos(angle), 1.3 * std::sin(angle));
            }
            TriangulationMeasures fan;
            std::vector<IntrinsicVolumes> triangles;
            for (std::size_t k = 0; k < n; ++k) fan.boundary += glm::distance(ring[k], ring[(k + 1) % n]);
            for (std::size_t k = 1; k + 1 < n; ++k) {
                const glm::dvec2 u = ring[k] - ring[0], v = ring[k + 1] - ring[0];
                const double area = 0.5 * std::abs(u.x * v.y - u.y * v.x);
                fan.triangles += 1.0;
                fan.area += area;
                if (k > 1) fan.weight += glm::length(u);
                triangles.push_back(intrinsic_volumes_of_flat_polygon(
                    area, glm::length(u) + glm::length(v) + glm::distance(ring[k], ring[k + 1])));
            }
            for (const IntrinsicVolumes& b : {intrinsic_volumes_of_box(1.0, 2.0, 0.5), intrinsic_volumes_of_sphere(0.7),
                                              intrinsic_volumes_of_segment(3.0)}) {
                double sum = 0.0;
                for (const IntrinsicVolumes& t : triangles) sum += kinematic_measure(b, t);
                CHECK(triangles_met(b, fan) == doctest::Approx(sum).epsilon(1e-12));
            }
        }
    }

    TEST_CASE("triangles met: the kinematic measures of a rectangle's two halves add up to formula (6)") {
        const IntrinsicVolumes half = intrinsic_volumes_of_flat_polygon(6.0, 12.0);  // sides 3, 4, 5
        for (const IntrinsicVolumes& b : {intrinsic_volumes_of_box(1.0, 2.0, 0.5), intrinsic_volumes_of_sphere(0.7),
                                          intrinsic_volumes_of_segment(3.0)})
            CHECK(triangles_met(b, {2.0, 12.0, 14.0, 5.0}) == doctest::Approx(2.0 * kinematic_measure(b, half)));
        CHECK(triangles_met({}, {2.0, 12.0, 14.0, 5.0}) == 0.0);
    }
}
