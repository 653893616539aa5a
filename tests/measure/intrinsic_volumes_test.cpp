#include <cmath>
#include <crofton/measure/criterion.hpp>
#include <doctest/doctest.h>
#include <numbers>

using namespace crofton;
using namespace crofton::measure;
using std::numbers::pi;

TEST_SUITE("measure/intrinsic_volumes") {
    TEST_CASE("criteria with NaN, negative or only zero weights are refused") {
        CHECK(validate(Criterion{std::nan(""), 1.0, 1.0}).error().item == 0);
        CHECK(validate(Criterion{1.0, -1.0, 1.0}).error().item == 1);
        CHECK(validate(Criterion{}).error().code == ErrorCode::invalid_argument);
        CHECK(validate(minimal_perimeter()).has_value());
    }

    TEST_CASE("a narrow view of a near-cube gives the cube's measures") {
        // An orthographic volume is a box: V, F and M are known in closed form.
        Camera camera;
        camera.projection = Projection::orthographic;
        camera.height = 2.0;
        camera.aspect = 1.5;
        camera.near = 1.0;
        camera.far = 5.0;
        const auto measures = of_frustum(camera);
        REQUIRE(measures.has_value());
        const IntrinsicVolumes box = of_box(3.0, 2.0, 4.0);
        CHECK(measures->volume == doctest::Approx(box.volume));
        CHECK(measures->area == doctest::Approx(box.area));
        CHECK(measures->mean_curvature == doctest::Approx(box.mean_curvature));
    }

    TEST_CASE("a perspective view volume has the volume and area of its truncated pyramid") {
        Camera camera;
        camera.fov_y = 0.5 * pi;  // half-tangent 1
        camera.aspect = 0.6;
        camera.near = 0.1;
        camera.far = 10.0;
        const auto measures = of_frustum(camera);
        REQUIRE(measures.has_value());
        const auto face = [](double d) { return 4.0 * 0.6 * d * d; };
        CHECK(measures->volume == doctest::Approx((face(10.0) * 10.0 - face(0.1) * 0.1) / 3.0));
        const double slant_x = 4.0 * 0.5 * std::sqrt(1.0 + 0.36) * (100.0 - 0.01);  // left and right: half-width 0.6
        const double slant_y = 4.0 * 0.5 * 0.6 * std::sqrt(2.0) * (100.0 - 0.01);
        CHECK(measures->area == doctest::Approx(face(10.0) + face(0.1) + slant_x + slant_y));
    }

    TEST_CASE("the kinematic formula is symmetric and gives Steiner's formula for a ball") {
        const IntrinsicVolumes box = of_box(1.0, 2.0, 3.0);
        const double r = 0.5;
        const double steiner = box.volume + box.area * r + box.mean_curvature * r * r + 4.0 / 3.0 * pi * r * r * r;
        CHECK(kinematic_measure(of_ball(r), box) == doctest::Approx(steiner));
        CHECK(kinematic_measure(box, of_ball(r)) == doctest::Approx(steiner));
    }

    TEST_CASE("long rays rank boxes by area, large bodies by edge sum") {
        const Criterion rays = for_rays(1e9), body = for_partner(of_ball(1e9));
        const auto cube = of_box(1.0, 1.0, 1.0), plate = of_box(2.4, 0.7, 0.05);
        CHECK(rays(cube) / rays(plate) == doctest::Approx(cube.area / plate.area));
        CHECK(body(cube) / body(plate) == doctest::Approx(cube.mean_curvature / plate.mean_curvature));
    }
}
