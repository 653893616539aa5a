// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/scene/transformed_box.hpp>
#include <error_of.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <random>

#include "oracle/exact_images.hpp"

using namespace crofton;
using namespace crofton::scene;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

struct Random {
    std::mt19937 engine;
    double operator()(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine); }
    glm::dvec3 vector(double size) { return {(*this)(-size, size), (*this)(-size, size), (*this)(-size, size)}; }
    glm::dmat3 rotation() {
        return glm::dmat3(glm::rotate(glm::dmat4(1.0), (*this)(-3.2, 3.2), glm::normalize(vector(1.0) + 1e-3)));
    }
};

Obb random_box(Random& random) {
    Obb box;
    box.center = random.vector(3.0);
    box.axes = glm::mat3(random.rotation());
    box.half_extents = glm::abs(glm::vec3(random.vector(2.0)));
    if (random(0.0, 1.0) < 0.2) box.half_extents[static_cast<int>(random(0.0, 2.99))] = 0.0f;
    return box;
}

Transform random_transform(Random& random, int kind) {
    Transform t;
    t.translation = random.vector(std::pow(10.0, random(-1.0, 7.0)));
    t.linear = random.rotation();
    if (kind >= 1) t.linear *= std::pow(10.0, random(-3.0, 3.0));
    if (kind >= 2)
        for (int k = 0; k < 3; ++k) t.linear[k] *= random(0.0, 1.0) < 0.5 ? -random(0.1, 4.0) : random(0.1, 4.0);
    if (kind >= 3) t.linear = t.linear * random.rotation();
    return t;
}

// A point of the box, a corner if asked, drawn towards the centre by as little as rounding makes necessary.
glm::dvec3 vertex_in(const Obb& box, Random& random, bool corner) {
    glm::dvec3 sides;
    for (int k = 0; k < 3; ++k) sides[k] = corner ? (random(-1.0, 1.0) < 0.0 ? -1.0 : 1.0) : random(-1.0, 1.0);
    for (double gap = 1e-16; gap < 1.0; gap *= 4.0) {
        glm::dvec3 p = box.center;
        for (int k = 0; k < 3; ++k)
            p += sides[k] * (1.0 - gap) * static_cast<double>(box.half_extents[k]) * glm::dvec3(box.axes[k]);
        if (contains(box, p)) return p;
    }
    return box.center;
}

}  // namespace

TEST_SUITE("scene/transform") {
    TEST_CASE("transforms that are not finite or out of range are refused by name") {
        Transform t;
        CHECK(validate(t).has_value());
        t.linear[1][2] = kNan;
        CHECK(error_of(validate(t, 9)).code == ErrorCode::non_finite);
        CHECK(error_of(validate(t, 9)).item == 9);
        t = Transform{};
        t.translation.y = std::numeric_limits<double>::infinity();
        CHECK(error_of(validate(t)).code == ErrorCode::non_finite);
        t = Transform{};
        t.linear[0] *= 1e16;
        CHECK(error_of(validate(t)).code == ErrorCode::out_of_range);
        t = Transform{};
        t.translation.z = -2e15;
        CHECK(error_of(validate(t)).code == ErrorCode::out_of_range);
        glm::dmat4 projective(1.0);
        projective[1][3] = 0.5;
        CHECK(error_of(from_matrix(projective)).code == ErrorCode::unsupported);
        projective[1][3] = kNan;
        CHECK_FALSE(from_matrix(projective).has_value());
    }

    TEST_CASE("any scale is data: none, tiny, flat") {
        Transform t;
        t.linear = glm::dmat3(0.0);
        CHECK(validate(t).has_value());
        CHECK(maps_to_point(t));
        t.linear[1] = {0.0, 1e-300, 0.0};
        CHECK(validate(t).has_value());
        CHECK_FALSE(maps_to_point(t));
        t = Transform{};
        t.linear[2] = t.linear[0] + t.linear[1];
        CHECK(validate(t).has_value());
        CHECK(from_trs({}, glm::dquat(1, 0, 0, 0), {0.0, 0.0, 0.0}).has_value());
    }

    TEST_CASE("a quaternion within 1 % of unit length is normalised, any other is refused") {
        const glm::dvec3 one(1.0);
        const glm::dquat turn = glm::angleAxis(0.7, glm::normalize(glm::dvec3(1.0, 2.0, 3.0)));
        const glm::dmat3 rotation = glm::mat3_cast(turn);
        CHECK(from_trs({}, turn, one).value().linear == rotation);
        for (const double length : {0.9901, 0.995, 1.0 + 1e-7, 1.0099}) {
            const glm::dmat3 linear = from_trs({}, turn * length, one).value().linear;
            for (int k = 0; k < 3; ++k) CHECK(glm::length(linear[k] - rotation[k]) < 1e-15);
        }
        // Stored in bytes as glTF allows: each component rounded to a multiple of 1/127.
        const auto byte = [](double x) { return std::round(127.0 * x) / 127.0; };
        std::mt19937 random(4);
        std::normal_distribution<double> number;
        for (int i = 0; i < 1000; ++i) {
            const glm::dquat q =
                glm::normalize(glm::dquat(number(random), number(random), number(random), number(random)));
            const auto stored = from_trs({}, glm::dquat(byte(q.w), byte(q.x), byte(q.y), byte(q.z)), one).value();
            CHECK(std::abs(glm::determinant(stored.linear) - 1.0) < 1e-14);
        }
        for (const double length : {0.0, 1e-200, 0.9, 0.989, 1.011, 2.0, 1e200})
            CHECK(error_of(from_trs({}, turn * length, one)).code ==
                  (length > 1e100 ? ErrorCode::non_finite : ErrorCode::invalid_argument));
        CHECK(error_of(from_trs({}, turn * kNan, one)).code == ErrorCode::non_finite);
        CHECK(error_of(from_trs({}, turn, {1.0, kNan, 1.0})).code == ErrorCode::non_finite);
        CHECK(error_of(from_trs({kNan, 0.0, 0.0}, turn, one)).code == ErrorCode::non_finite);
    }

    TEST_CASE("a flattened box is flat, contains the exact image, and is no larger than the image needs") {
        Random random{std::mt19937(17)};
        for (int trial = 0; trial < 4000; ++trial) {
            const Obb box = random_box(random);
            Transform t;
            t.translation = random.vector(10.0);
            const int rank = trial % 3;  // of the linear part
            glm::dmat3 flat(0.0);
            for (int k = 0; k < rank; ++k) flat[k][k] = random(0.5, 2.0);
            t.linear = random.rotation() * flat * (trial % 2 == 0 ? glm::dmat3(1.0) : random.rotation());
            const auto image = transformed_box(t, box, measure::minimal_perimeter()).value();
            for (int p = 0; p < 4; ++p) CHECK(testing::contains_exact_image(image, t, vertex_in(box, random, p < 3)));
            glm::vec3 h = image.half_extents;
            std::sort(&h[0], &h[0] + 3);
            const float size = static_cast<float>(glm::length(box.half_extents)) * 2.0f;
            for (int k = 0; k < 3 - rank; ++k) CHECK(h[k] <= 1e-6f * size + 1e-12f);
        }
    }

    TEST_CASE("an image too small for any float, or for any double, is not taken for a point") {
        Obb box;
        box.half_extents = glm::vec3(0x1p-100f);
        for (const double scale : {0x1p-200, 0x1p-900, 0x1p-980, 0x1p-1010, 0x1p-1074}) {
            Transform t;
            t.linear = glm::dmat3(scale);
            const Obb image = transformed_box(t, box, measure::minimal_perimeter()).value();
            for (int k = 0; k < 3; ++k) CHECK(image.half_extents[k] > 0.0f);
        }
    }

    TEST_CASE("however small it becomes, a turned box keeps its turn: its axes are valid and those of the image") {
        Random random{std::mt19937(19)};
        const Obb box{{}, glm::mat3(1.0f), {1.0f, 2.0f, 3.0f}};
        for (int exponent = 0; exponent < 300; ++exponent) {
            Transform t;
            const glm::dmat3 turn = random.rotation();
            t.linear = std::pow(10.0, -exponent) * turn;
            const auto image = transformed_box(t, box, measure::minimal_perimeter()).value();
            for (int k = 0; k < 3; ++k) CHECK(glm::distance(glm::dvec3(image.axes[k]), turn[k]) < 1e-6);
        }
    }

    TEST_CASE("a box moved out of the range of coordinates is an error, not a box") {
        Transform t;
        t.translation.x = 1e31;
        CHECK(error_of(transformed_box(t, Obb{}, measure::minimal_perimeter())).code == ErrorCode::out_of_range);
        t.translation.x = kNan;
        CHECK_FALSE(transformed_box(t, Obb{}, measure::minimal_perimeter()).has_value());
    }

    TEST_CASE("composition applies the inner transform first") {
        const Transform outer =
            from_trs({1.0, 0.0, 0.0}, glm::angleAxis(1.5707963267948966, glm::dvec3(0, 0, 1)), {2, 2, 2}).value();
        const Transform inner = from_trs({0.0, 3.0, 0.0}, glm::dquat(1, 0, 0, 0), {1, 1, 1}).value();
        const glm::dvec3 p = (outer * inner) * glm::dvec3(1.0, 0.0, 0.0);
        CHECK(p.x == doctest::Approx(-5.0));
        CHECK(p.y == doctest::Approx(2.0));
        CHECK(glm::length((outer * inner) * glm::dvec3(1, 2, 3) - outer * (inner * glm::dvec3(1, 2, 3))) < 1e-14);
    }

    TEST_CASE(
        "the transformed box contains the exact image of the box's points: rotated, scaled, mirrored, sheared, far "
        "away") {
        Random random{std::mt19937(7)};
        for (int trial = 0; trial < 6000; ++trial) {
            const Obb box = random_box(random);
            const Transform t = random_transform(random, trial % 4);
            const auto image = transformed_box(t, box, measure::minimal_perimeter()).value();
            for (int p = 0; p < 4; ++p) CHECK(testing::contains_exact_image(image, t, vertex_in(box, random, p < 3)));
            CHECK(glm::determinant(image.axes) > 0.0f);
        }
    }

    TEST_CASE("a similarity keeps the box's size but for rounding") {
        Random random{std::mt19937(8)};
        for (int trial = 0; trial < 1000; ++trial) {
            Obb box = random_box(random);
            Transform t = random_transform(random, 0);
            t.translation = random.vector(100.0);
            t.linear *= -3.0;
            const Obb image = transformed_box(t, box, measure::minimal_perimeter()).value();
            CHECK(edge_sum(image) == doctest::Approx(3.0 * edge_sum(box)).epsilon(2e-6));
        }
    }

    TEST_CASE("a sheared cube gets the smallest box with two flush faces, by the chosen criterion") {
        // x ↦ (x + y, y, z) makes the square |x|, |y| ≤ 1 a parallelogram with edges (2, 0) and (2, 2): flush with the
        // first, its rectangle is 4 × 2; flush with the second, of length 2√2, it is 3√2 × √2. Areas 8 and 6, edge sums
        // 6 and 4√2.
        Transform shear;
        shear.linear[1] = {1.0, 1.0, 0.0};
        Obb cube;
        cube.half_extents = {1.0f, 1.0f, 1.0f};
        CHECK(edge_sum(transformed_box(shear, cube, measure::minimal_perimeter()).value()) ==
              doctest::Approx(4.0 * std::sqrt(2.0) + 2.0).epsilon(1e-6));
        CHECK(volume(transformed_box(shear, cube, measure::minimal_volume()).value()) ==
              doctest::Approx(12.0).epsilon(1e-6));
    }

    TEST_CASE("a transform that flattens a box along any of its edges gives a flat box around it") {
        for (int flat = 0; flat < 3; ++flat) {
            Transform place;
            place.linear[flat] = glm::dvec3(0.0);
            Obb box{};
            box.axes = glm::mat3(1.0f);
            box.half_extents = {1.0f, 2.0f, 3.0f};
            const Result<Obb> image = transformed_box(place, box, measure::minimal_perimeter());
            REQUIRE(image.has_value());
            CHECK(validate(*image));
            for (int corner = 0; corner < 8; ++corner) {
                glm::dvec3 p;
                for (int k = 0; k < 3; ++k) p[k] = (corner >> k & 1 ? 1.0 : -1.0) * double(box.half_extents[k]);
                p = place * p - image->center;
                for (int k = 0; k < 3; ++k)
                    CHECK(std::abs(glm::dot(p, glm::dvec3(image->axes[k]))) <= double(image->half_extents[k]) + 1e-6);
            }
            // One edge of three is next to nothing.
            const glm::vec3& half = image->half_extents;
            CHECK(std::min(half.x, std::min(half.y, half.z)) < 1e-6f);
        }
    }
}
