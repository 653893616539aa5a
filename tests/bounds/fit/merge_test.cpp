// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/fit/fit.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <random>
#include <span>
#include <vector>

#include "random_rotation.hpp"

using namespace crofton;

TEST_SUITE("fit/merge") {
    TEST_CASE("merge names the box whose corners are beyond 1e30") {
        std::vector<Obb> boxes(3);
        boxes[1].center = glm::dvec3(5e29);
        boxes[1].half_extents = glm::vec3(6e29f);
        CHECK(validate(boxes[1]).has_value());
        const Error error = error_of(fit::merge(boxes, measure::minimal_area()));
        CHECK(error.code == ErrorCode::out_of_range);
        CHECK(error.item == 1);
        CHECK(fit::merge(std::span(boxes).subspan(1, 1), measure::minimal_area()).has_value());
    }

    TEST_CASE("far from the origin, too, merge holds the boxes themselves, not only their rounded corners") {
        std::mt19937 random(18);
        std::normal_distribution<double> normal;
        for (int run = 0; run < 500; ++run) {
            std::vector<Obb> boxes(2);
            for (Obb& box : boxes) {
                box.center = 1e12 * glm::dvec3(0.9, 0.8, 0.7) + glm::dvec3(normal(random), 1.0, normal(random));
                box.axes = glm::mat3(random_rotation(random));
                box.half_extents = glm::vec3(0.1f, 0.4f, 0.2f);
            }
            const Obb all = fit::merge(boxes, measure::minimal_perimeter()).value();
            // What doubles round here is 1e-4; long doubles know it to 1e-7 on most machines.
            long double least_room = 1.0L;
            for (const Obb& box : boxes)
                for (unsigned corner = 0; corner < 8; ++corner) {
                    long double from_center[3];
                    for (int i = 0; i < 3; ++i) {
                        from_center[i] = static_cast<long double>(box.center[i]) - all.center[i];
                        for (int j = 0; j < 3; ++j) {
                            const long double edge = static_cast<long double>(box.axes[j][i]) * box.half_extents[j];
                            from_center[i] += corner >> j & 1u ? edge : -edge;
                        }
                    }
                    for (int k = 0; k < 3; ++k) {
                        long double along = 0.0L;
                        for (int i = 0; i < 3; ++i) along += static_cast<long double>(all.axes[k][i]) * from_center[i];
                        least_room = std::min(least_room, all.half_extents[k] - std::abs(along));
                    }
                }
            CHECK(least_room >= 0.0L);
        }
    }

    TEST_CASE("merge holds every corner of every box and one box is its own merge") {
        std::mt19937 random(17);
        std::normal_distribution<double> normal;
        CHECK(error_of(fit::merge({}, measure::minimal_area())).code == ErrorCode::empty);
        for (int run = 0; run < 100; ++run) {
            std::vector<Obb> boxes(1 + static_cast<std::size_t>(run % 4));
            for (Obb& box : boxes) {
                box.center = {normal(random), normal(random), normal(random)};
                box.axes = glm::mat3(random_rotation(random));
                box.half_extents = glm::vec3(0.1f, 0.4f, 0.2f);
            }
            const Obb all = fit::merge(boxes, measure::minimal_perimeter()).value();
            if (boxes.size() == 1) {
                CHECK(all.center == boxes[0].center);
                CHECK(all.axes == boxes[0].axes);
                CHECK(all.half_extents == boxes[0].half_extents);
                continue;
            }
            for (const Obb& box : boxes)
                for (const glm::dvec3& corner : corners(box)) CHECK(contains(all, corner));
        }
    }
}
