// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/cull/cull.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/query_sample.hpp>
#include <crofton/study/spatial_lines.hpp>
#include <error_of.hpp>
#include <limits>
#include <numbers>

using namespace crofton;
using namespace crofton::measure;
using namespace crofton::sampling;
using namespace crofton::study;

namespace {

Obb turned_box() {
    Obb box;
    box.center = glm::dvec3(0.3, -0.2, 0.5);
    box.axes = glm::mat3(rotation({0.2, 0.5, 0.7}));
    box.half_extents = glm::vec3(0.8f, 0.4f, 0.1f);
    return box;
}

// The share of n quasi-random queries misses the truth by less than random ones would: 4 binomial standard errors.
void check(const QuerySample& sample, const Obb& box, double expected) {
    const double n = sample.size(), hits = static_cast<double>(sample.hitting(sample.all(), box).size()), p = hits / n;
    CHECK(std::abs(p * sample.measure() - expected) <= 4.0 * sample.measure() * std::sqrt(p * (1.0 - p) / n));
}

}  // namespace

TEST_SUITE("study/query_sample") {
    TEST_CASE("empty regions, no queries and endless frusta are refused") {
        CHECK(error_of(QuerySample::planes({glm::dvec3(0.0), 0.0}, 10, 1)).code == ErrorCode::invalid_argument);
        CHECK(error_of(QuerySample::lines({glm::dvec3(std::nan("")), 1.0}, 10, 1)).code == ErrorCode::invalid_argument);
        CHECK(error_of(QuerySample::lines({glm::dvec3(0.0), 1.0}, 0, 1)).code == ErrorCode::out_of_range);
        Camera endless;
        endless.far_distance = std::numeric_limits<double>::infinity();
        CHECK_FALSE(QuerySample::frusta(endless, {glm::dvec3(0.0), 1.0}, 10, 1).has_value());
    }

    TEST_CASE("planes, lines and frusta hit a box as often as M, F and the kinematic formula say") {
        const Sphere region{glm::dvec3(0.1, 0.0, 0.2), 2.0};
        const Obb box = turned_box();
        const IntrinsicVolumes k = intrinsic_volumes_of_box(box);
        const std::uint32_t n = 1 << 16;
        check(*QuerySample::planes(region, n, 1), box, k.mean_curvature);
        check(*QuerySample::lines(region, n, 2), box, measure_of_lines(k.area));
        Camera camera;
        camera.near_distance = 0.5, camera.far_distance = 8.0;
        camera.position = glm::dvec3(100.0);  // where the prototype stands does not matter
        check(*QuerySample::frusta(camera, region, n, 3), box,
              kinematic_measure(*intrinsic_volumes_of_frustum(camera), k));
        camera.projection = Projection::orthographic;
        camera.height = 1.0;
        check(*QuerySample::frusta(camera, region, n, 4), box,
              kinematic_measure(*intrinsic_volumes_of_frustum(camera), k));
    }

    TEST_CASE("a frustum straddles what it meets and does not contain, planes and lines contain nothing") {
        Camera camera;
        camera.near_distance = 0.5, camera.far_distance = 8.0;
        const Sphere region{glm::dvec3(0.0), 2.0};
        const auto frusta = *QuerySample::frusta(camera, region, 4096, 1);
        const auto planes = *QuerySample::planes(region, 4096, 1);
        Obb large = turned_box(), point;
        large.half_extents = glm::vec3(100.0f);
        int met = 0, straddled = 0;
        for (std::uint32_t i = 0; i < 4096; ++i) {
            CHECK(planes.straddles(i, turned_box()) == planes.hits(i, turned_box()));
            CHECK(frusta.straddles(i, large));        // meets it, cannot hold it
            CHECK_FALSE(frusta.straddles(i, point));  // holds it or misses it
            CHECK((!frusta.straddles(i, turned_box()) || frusta.hits(i, turned_box())));
            met += frusta.hits(i, turned_box());
            straddled += frusta.straddles(i, turned_box());
        }
        CHECK(straddled > 0);
        CHECK(straddled < met);
    }

    TEST_CASE("a frustum close to a wide plate misses it, though the plate's axes are not quite orthogonal") {
        Camera camera;
        camera.near_distance = 0.002, camera.far_distance = 0.01;
        const Sphere region{glm::dvec3(0.0), 0.002};
        constexpr std::uint32_t count = 1 << 14;
        const auto sample = *QuerySample::frusta(camera, region, count, 3);
        Obb plate = turned_box();
        plate.center = glm::dvec3(0.0);
        plate.half_extents = glm::vec3(100.0f, 100.0f, 1e-6f);
        // The same frusta, as the class draws them, for cull's exact test.
        const auto corners = *frustum_corners(*frustum_of(camera));
        Aabb range;
        for (const glm::dvec3& corner : corners) range.include(corner);
        range.min -= glm::dvec3(region.radius);
        range.max += glm::dvec3(region.radius);
        const UnitPoints points(3, Sequence::quasi_random);
        int hit = 0, differ = 0;
        for (std::uint32_t i = 0; i < count; ++i) {
            const RigidTransform motion = sampling::motion(range, points.at<6>(i));
            Camera placed = camera;
            placed.position = -(motion.rotation * motion.translation);
            placed.forward = motion.rotation * camera.forward;
            placed.up = motion.rotation * camera.up;
            const bool truly = cull::classify(*frustum_of(placed), plate) != cull::Verdict::outside;
            hit += truly;
            differ += truly != sample.hits(i, plate);
        }
        CHECK(hit > 1000);
        CHECK(differ == 0);
    }

    TEST_CASE("queries that hit two boxes agree with the exact measures (4) and (5)") {
        Obb other;
        other.half_extents = glm::vec3(0.5f);
        const std::vector<ConvexBody> bodies = {ConvexBody::box(turned_box()), ConvexBody::box(other)};
        const auto planes = *QuerySample::planes({glm::dvec3(0.0), 2.0}, 1 << 16, 5);
        const auto lines = *QuerySample::lines({glm::dvec3(0.0), 2.0}, 1 << 16, 5);
        const auto share = [&](const QuerySample& sample) {
            return sample.measure() *
                   static_cast<double>(sample.hitting(sample.hitting(sample.all(), turned_box()), other).size()) /
                   sample.size();
        };
        CHECK(share(planes) == doctest::Approx(measure_of_planes_hitting_all(bodies)->value).epsilon(0.02));
        CHECK(share(lines) == doctest::Approx(measure_of_lines_hitting_all(bodies)->value).epsilon(0.05));
    }
}
