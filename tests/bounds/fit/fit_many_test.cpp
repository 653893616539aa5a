// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/core/executor.hpp>
#include <crofton/fit/fit.hpp>
#include <error_of.hpp>
#include <limits>
#include <random>
#include <vector>

using namespace crofton;

namespace {

struct Input {
    std::vector<glm::vec3> positions;
    std::vector<std::uint32_t> indices, ends;

    [[nodiscard]] fit::Clusters clusters() const { return {positions, indices, ends}; }
    [[nodiscard]] std::vector<glm::vec3> points(std::size_t i) const {
        std::vector<glm::vec3> result;
        for (std::uint32_t j = i == 0 ? 0 : ends[i - 1]; j < ends[i]; ++j) result.push_back(positions[indices[j]]);
        return result;
    }
};

// Patches of a curved surface with a little noise, as the leaves of a mesh tree are.
Input patches(std::size_t count, std::size_t corners) {
    std::mt19937 random(1);
    std::normal_distribution<float> normal;
    Input input;
    for (std::size_t i = 0; i < count; ++i) {
        const float bend = normal(random);
        const glm::vec3 place(normal(random), normal(random), normal(random));
        for (std::size_t j = 0; j < corners; ++j) {
            const float x = normal(random), y = 0.6f * normal(random);
            input.indices.push_back(static_cast<std::uint32_t>(input.positions.size()));
            input.positions.push_back(
                place + 0.1f * glm::vec3(x + 0.3f * y, y, 0.1f * bend * (x * x + y * y) + 0.02f * normal(random)));
        }
        input.ends.push_back(static_cast<std::uint32_t>(input.indices.size()));
    }
    return input;
}

}  // namespace

TEST_SUITE("fit/fit_many") {
    TEST_CASE("a bad cluster is named and does not spoil the others") {
        Input input = patches(100, 10);
        input.positions[input.indices[input.ends[40]]].x = std::numeric_limits<float>::quiet_NaN();
        input.indices[input.ends[70]] = 123456;
        std::vector<Obb> boxes(100);
        ThreadPool pool(3);
        const auto done = fit::fit_many(input.clusters(), {}, pool, boxes);
        REQUIRE(!done);
        CHECK(error_of(done).item == 41);
        CHECK(error_of(done).code == ErrorCode::non_finite);
        CHECK(boxes[41].half_extents == glm::vec3(0.0f));
        CHECK(boxes[71].half_extents == glm::vec3(0.0f));
        for (std::size_t i : {0u, 40u, 42u, 99u}) CHECK(boxes[i].half_extents != glm::vec3(0.0f));
        input.ends[0] = 0;
        CHECK(error_of(fit::fit_many(input.clusters(), {}, pool, boxes)).code == ErrorCode::empty);
        CHECK(fit::fit_many({}, {}, pool, {}).has_value());
        CHECK(!fit::fit_many(input.clusters(), {.criterion = {0.0, 0.0, 0.0}}, pool, boxes));
    }

    TEST_CASE("the boxes are those of fit_obb, to the bit, with any executor") {
        const Input input = patches(300, 24);
        ThreadPool pool(4);
        for (const auto quality : {fit::Quality::fast, fit::Quality::tight}) {
            const fit::FitOptions options{measure::minimal_area(), quality};
            std::vector<Obb> alone(300), together(300);
            REQUIRE(fit::fit_many(input.clusters(), options, serial_executor(), alone));
            REQUIRE(fit::fit_many(input.clusters(), options, pool, together));
            for (std::size_t i = 0; i < 300; ++i) {
                const std::vector<glm::vec3> points = input.points(i);
                const Obb expected = fit::fit_obb(std::span<const glm::vec3>(points), options).value();
                for (const Obb& box : {alone[i], together[i]}) {
                    CHECK(box.center == expected.center);
                    CHECK(box.axes == expected.axes);
                    CHECK(box.half_extents == expected.half_extents);
                }
                for (const glm::vec3& p : points) CHECK(contains(alone[i], glm::dvec3(p)));
            }
        }
    }

    TEST_CASE(
        "tight boxes of patches are within a thousandth of the optimum on average, fast ones within a hundredth") {
        const Input input = patches(300, 64);
        for (const auto& criterion : {measure::minimal_area(), measure::minimal_perimeter()}) {
            std::vector<Obb> fast(300), tight(300), exact(300);
            REQUIRE(fit::fit_many(input.clusters(), {criterion, fit::Quality::fast}, serial_executor(), fast));
            REQUIRE(fit::fit_many(input.clusters(), {criterion, fit::Quality::tight}, serial_executor(), tight));
            REQUIRE(fit::fit_many(input.clusters(), {criterion, fit::Quality::exact}, serial_executor(), exact));
            double fast_excess = 0.0, tight_excess = 0.0;
            for (std::size_t i = 0; i < 300; ++i) {
                const double best = criterion(measure::intrinsic_volumes_of_box(exact[i]));
                fast_excess += criterion(measure::intrinsic_volumes_of_box(fast[i])) / best - 1.0;
                tight_excess += criterion(measure::intrinsic_volumes_of_box(tight[i])) / best - 1.0;
                CHECK(criterion(measure::intrinsic_volumes_of_box(tight[i])) >= best * (1.0 - 1e-6));
            }
            CHECK(fast_excess / 300.0 <= 0.01);
            CHECK(tight_excess / 300.0 <= 0.001);
        }
    }
}
