#include <cmath>
#include <limits>

#include "handles.hpp"

using namespace crofton::capi_test;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

crofton_ray ray(double x, double y, double z, double dx, double dy, double dz, double max_t = kInfinity) {
    return {{x, y, z}, {dx, dy, dz}, max_t};
}

}  // namespace

TEST_SUITE("capi/rays") {
    TEST_CASE("rays that are none are refused, named, and write nothing") {
        const Collider collider = make_collider();
        const double nan = std::nan("");
        const crofton_ray good = ray(0.1, 0.1, 5, 0, 0, -1);
        const crofton_ray bad[] = {ray(nan, 0, 0, 0, 0, 1), ray(0, 0, 0, kInfinity, 0, 1), ray(0, 0, 0, 0, 0, 0),
                                   ray(0, 0, 0, 0, 0, 1, -1.0), ray(0, 0, 0, 0, 0, 1, nan)};
        const crofton_status expected[] = {CROFTON_NON_FINITE, CROFTON_NON_FINITE, CROFTON_DEGENERATE,
                                           CROFTON_INVALID_ARGUMENT, CROFTON_INVALID_ARGUMENT};
        for (int i = 0; i < 5; ++i) {
            const crofton_ray rays[] = {good, bad[i]};
            crofton_ray_hit hits[2] = {{-7.0, 7}, {-7.0, 7}};
            CHECK(crofton_collider_raycast(collider.get(), rays, 2, hits) == expected[i]);
            CHECK(crofton_last_error_item() == 1);
            CHECK(hits[0].t == -7.0);
            int hit = 7;
            CHECK(crofton_collider_hits_any(collider.get(), &bad[i], &hit) == expected[i]);
            CHECK(hit == 7);
            const crofton_box box = box_at(0, 0, 0);
            double t = -7.0;
            CHECK(crofton_box_raycast(&box, &bad[i], &t) == expected[i]);
            CHECK(t == -7.0);
        }
        crofton_ray_hit hit;
        CHECK(crofton_collider_raycast(nullptr, &good, 1, &hit) == CROFTON_BAD_HANDLE);
        CHECK(crofton_collider_raycast(collider.get(), nullptr, 1, &hit) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_collider_raycast(collider.get(), &good, 1, nullptr) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_collider_raycast(collider.get(), nullptr, 0, nullptr) == CROFTON_OK);
    }

    TEST_CASE("a ray enters a box at its face, starts inside it at 0, or misses") {
        const crofton_box box = box_at(0, 0, 0);
        const auto entry = [&](const crofton_ray& r) {
            double t = -1.0;
            REQUIRE(crofton_box_raycast(&box, &r, &t) == CROFTON_OK);
            return t;
        };
        CHECK(entry(ray(0, 0, 5, 0, 0, -2)) == doctest::Approx(2.25));
        CHECK(entry(ray(0, 0, 0.25, 0, 0, -2)) == 0.0);
        CHECK(entry(ray(0, 0, 5, 0, 0, -2, 2.0)) == kInfinity);
        CHECK(entry(ray(0, 0, 5, 0, 0, 1)) == kInfinity);
    }

    TEST_CASE("the nearest triangle of a mesh") {
        const Collider collider = make_collider();
        // Its triangle 0 is the right one at z = 0, triangle 3 the slanted one, x + y + z = 1.
        const crofton_ray rays[] = {ray(0.25, 0.25, 5, 0, 0, -1), ray(0.25, 0.25, -5, 0, 0, 1),
                                    ray(0.25, 0.25, 5, 0, 0, -1, 4.0), ray(2, 2, 5, 0, 0, -1)};
        crofton_ray_hit hits[4];
        REQUIRE(crofton_collider_raycast(collider.get(), rays, 4, hits) == CROFTON_OK);
        CHECK(hits[0].t == doctest::Approx(4.5));
        CHECK(hits[0].index == 3);
        CHECK(hits[1].t == doctest::Approx(5.0));
        CHECK(hits[1].index == 0);
        for (const int missed : {2, 3}) {
            CHECK(hits[missed].t == kInfinity);
            CHECK(hits[missed].index == CROFTON_NONE);
        }
        for (int i = 0; i < 4; ++i) {
            int hit = -1;
            REQUIRE(crofton_collider_hits_any(collider.get(), &rays[i], &hit) == CROFTON_OK);
            CHECK(hit == (i < 2 ? 1 : 0));
        }
    }
}
