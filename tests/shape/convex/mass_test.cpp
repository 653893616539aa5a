// SPDX-License-Identifier: MIT
// Mass of rounded shapes and compounds: closed forms beside slices, hulls and sums.
#include <doctest/doctest.h>
#include <cmath>
#include <error_of.hpp>
#include <limits>
#include <numbers>

#include "random_shapes.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {

constexpr double kPi = std::numbers::pi;

void check_near(const MassProperties& mass, const MassProperties& other, double tolerance) {
    CHECK(mass.volume == doctest::Approx(other.volume).epsilon(tolerance));
    const double size = std::cbrt(other.volume) + glm::length(other.center);
    CHECK(glm::distance(mass.center, other.center) <= tolerance * size);
    const double scale = other.inertia[0][0] + other.inertia[1][1] + other.inertia[2][2];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) CHECK(std::abs(mass.inertia[i][j] - other.inertia[i][j]) <= tolerance * scale);
}

// A midpoint sum over a grid of points, by the distance from the core.
MassProperties counted(const Shape& shape, int cells) {
    const Aabb box = shape.bounds();
    const glm::dvec3 step = (box.max - box.min) / static_cast<double>(cells);
    double volume = 0.0;
    glm::dvec3 first(0.0);
    glm::dmat3 second(0.0);
    for (int i = 0; i < cells; ++i)
        for (int j = 0; j < cells; ++j)
            for (int k = 0; k < cells; ++k) {
                const glm::dvec3 x = box.min + step * glm::dvec3(i + 0.5, j + 0.5, k + 0.5);
                if (closest_point({shape, at({})}, x).distance > 0.0) continue;
                volume += 1.0;
                first += x;
                second += glm::outerProduct(x, x);
            }
    const double cell = step.x * step.y * step.z;
    MassProperties mass;
    mass.volume = cell * volume;
    mass.center = first / volume;
    const glm::dmat3 central = cell * (second - volume * glm::outerProduct(mass.center, mass.center));
    mass.inertia = (central[0][0] + central[1][1] + central[2][2]) * glm::dmat3(1.0) - central;
    return mass;
}

}  // namespace

TEST_SUITE("convex/mass") {
    TEST_CASE("a rounded box: Steiner's volume, and inertia known from its pieces") {
        const double a = 0.5, b = 1.0, c = 1.5, r = 0.25;
        const MassProperties mass =
            mass_properties(Shape::rounded(Shape::box({0.5f, 1, 1.5f}).value(), 0.25f).value()).value();
        const double volume = 8 * a * b * c + 8 * (a * b + b * c + c * a) * r + 2 * kPi * r * r * (a + b + c) +
                              4.0 / 3.0 * kPi * r * r * r;
        CHECK(mass.volume == doctest::Approx(volume).epsilon(1e-14));
        CHECK(glm::length(mass.center) < 1e-15);
        // ∫ x²: the box, its two plates across x, plates along it, and so on, piece by piece.
        const auto squared = [&](double u, double v, double w) {
            const double box = 8 * v * w * u * u * u / 3;
            const double caps = 8 * v * w * (std::pow(u + r, 3) - u * u * u) / 3;
            const double sides = 8 * u * u * u / 3 * r * (v + w);
            const double along = 2 * kPi * r * r * u * u * u / 3;
            // Four quarters of a cylinder along y and along z: the x of a quarter is u + s.
            const double quarter = kPi * r * r / 4 * u * u + 2 * u * r * r * r / 3 + kPi * r * r * r * r / 16;
            const double across = 4 * quarter * 2 * (v + w);
            const double sphere = 4.0 / 3.0 * kPi * r * r * r * (u * u + r * r / 5) + 8 * u * kPi * r * r * r * r / 8;
            return box + caps + sides + along + across + sphere;
        };
        const double xx = squared(a, b, c), yy = squared(b, c, a), zz = squared(c, a, b);
        CHECK(mass.inertia[0][0] == doctest::Approx(yy + zz).epsilon(1e-13));
        CHECK(mass.inertia[1][1] == doctest::Approx(zz + xx).epsilon(1e-13));
        CHECK(mass.inertia[2][2] == doctest::Approx(xx + yy).epsilon(1e-13));
        CHECK(std::abs(mass.inertia[0][1]) < 1e-14);
    }

    TEST_CASE("a needle's inertia about its axis is as precise as the others") {
        const glm::vec3 half(1e-3f, 1e-3f, 1e3f);
        std::vector<glm::vec3> corners;
        for (int i = 0; i < 8; ++i)
            corners.push_back(half * glm::vec3((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1));
        const MassProperties box = mass_properties(Shape::box(half).value()).value();
        const Hull hull = Hull::build(corners).value();
        for (int k = 0; k < 3; ++k)
            CHECK(hull.mass().inertia[k][k] / box.inertia[k][k] == doctest::Approx(1.0).epsilon(1e-13));
    }

    TEST_CASE("a hull that is a box has the box's mass when rounded, wherever its frame is") {
        std::vector<glm::vec3> corners;
        for (int i = 0; i < 8; ++i)
            corners.emplace_back(100.0f + ((i & 1) != 0 ? 0.5f : -0.5f), (i & 2) != 0 ? 1.0f : -1.0f,
                                 (i & 4) != 0 ? 1.5f : -1.5f);
        const Hull hull = Hull::build(corners).value();
        MassProperties box =
            mass_properties(Shape::rounded(Shape::box({0.5f, 1, 1.5f}).value(), 0.25f).value()).value();
        box.center.x = 100.0;
        check_near(mass_properties(Shape::rounded(Shape::hull(hull), 0.25f).value()).value(), box, 1e-13);
    }

    TEST_CASE("flat cores: plates, triangles, segments and points") {
        const auto rounded = [](const Shape& core) {
            return mass_properties(Shape::rounded(core, 0.5f).value()).value();
        };
        const MassProperties sphere = mass_properties(Shape::sphere(0.5f).value()).value();
        check_near(rounded(Shape::box({0, 0, 0}).value()), sphere, 1e-14);
        check_near(rounded(Shape::triangle({0, 0, 0}, {0, 0, 0}, {0, 0, 0}).value()), sphere, 1e-14);
        const MassProperties capsule = mass_properties(Shape::capsule(2, 0.5f).value()).value();
        check_near(rounded(Shape::box({0, 2, 0}).value()), capsule, 1e-14);
        check_near(rounded(Shape::triangle({0, 2, 0}, {0, -2, 0}, {0, 1, 0}).value()), capsule, 1e-14);
        const MassProperties plate = rounded(Shape::box({1, 0, 1}).value());
        CHECK(plate.volume == doctest::Approx(4.0 + 4.0 * kPi * 0.25 + kPi / 6).epsilon(1e-14));
        const MassProperties triangle = rounded(Shape::triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}).value());
        CHECK(triangle.volume == doctest::Approx(0.5 + (2.0 + std::sqrt(2.0)) * kPi * 0.125 + kPi / 6).epsilon(1e-14));
    }

    TEST_CASE("mass of rounded hulls, cylinders and cones agrees with sums over a grid") {
        RandomShapes random(3);
        std::vector<Shape> shapes{Shape::cylinder(0.75f, 0.5f).value(), Shape::cone(0.75f, 0.5f).value(),
                                  Shape::triangle({0, 0, 0}, {1, 0.2f, 0}, {0.3f, 1, 0.5f}).value()};
        for (int i = 0; i < 6; ++i) shapes.push_back(random.hull(10));
        for (const Shape& core : shapes) {
            const Shape shape = Shape::rounded(core, 0.3f).value();
            check_near(mass_properties(shape).value(), counted(shape, 60), 0.01);
        }
    }

    TEST_CASE("a rounded cone has Steiner's volume") {
        const double radius = 0.5, height = 1.5, r = 0.25, slant = std::hypot(radius, height);
        const double volume = kPi * radius * radius * height / 3, area = kPi * radius * (radius + slant);
        // The side, whose curvature across is height / slant over the radius; the rim, by its outer angle.
        const double mean_curvature = kPi * height + kPi * radius * (kPi - std::atan2(height, radius));
        const Shape cone = Shape::rounded(Shape::cone(0.75f, 0.5f).value(), r).value();
        CHECK(mass_properties(cone).value().volume ==
              doctest::Approx(volume + area * r + mean_curvature * r * r + 4 * kPi / 3 * r * r * r).epsilon(1e-14));
    }

    TEST_CASE("a rounded cylinder without height, a cone without height and one without radius are what they are") {
        const auto rounded = [](const Shape& core) {
            return mass_properties(Shape::rounded(core, 0.5f).value()).value();
        };
        check_near(rounded(Shape::cone(2, 0).value()), mass_properties(Shape::capsule(2, 0.5f).value()).value(), 1e-14);
        check_near(rounded(Shape::cylinder(2, 0).value()), mass_properties(Shape::capsule(2, 0.5f).value()).value(),
                   1e-14);
        check_near(rounded(Shape::cone(0, 1).value()), rounded(Shape::cylinder(0, 1).value()), 1e-13);
        // Steiner: the disc's two sides, half its rim, and a sphere.
        CHECK(rounded(Shape::cylinder(0, 1).value()).volume ==
              doctest::Approx(kPi + kPi * kPi * 0.25 + kPi / 6).epsilon(1e-14));
    }

    TEST_CASE("a compound is the sum of its children, turned and moved, nested or not") {
        const Shape half = Shape::box({0.5f, 1, 1.5f}).value(), whole = Shape::box({1, 1, 1.5f}).value();
        RandomShapes random(4);
        const RigidTransform place{random.rotation(), {3, -2, 7}};
        const Compound pair =
            Compound::build(std::vector<CompoundChild>{{half, at({-0.5, 0, 0})}, {half, at({0.5, 0, 0})}}).value();
        check_near(mass_properties(Shape::compound(pair)).value(), mass_properties(whole).value(), 1e-14);
        const Compound outer = Compound::build(std::vector<CompoundChild>{{Shape::compound(pair), place},
                                                                          {Shape::sphere(0).value(), at({})}})
                                   .value();
        MassProperties expected = mass_properties(whole).value();
        expected.center = place.translation;
        expected.inertia = place.rotation * expected.inertia * glm::transpose(place.rotation);
        check_near(mass_properties(Shape::compound(outer)).value(), expected, 1e-13);
    }

    TEST_CASE("surfaces and half-spaces have no mass, also as children") {
        const Shape half = Shape::half_space({{0, 1, 0}, 0}).value();
        CHECK(error_of(mass_properties(half)).code == ErrorCode::unsupported);
        const std::vector<float> heights(4, 0.0f);
        const HeightField field = HeightField::build({.columns = 2, .rows = 2, .heights = heights}).value();
        const Shape ground = Shape::height_field(field);
        CHECK(error_of(mass_properties(ground)).code == ErrorCode::unsupported);
        const Compound both =
            Compound::build(std::vector<CompoundChild>{{Shape::sphere(1).value(), at({})}, {ground, at({})}}).value();
        const Error error = error_of(mass_properties(Shape::compound(both)));
        CHECK(error.code == ErrorCode::unsupported);
        CHECK(error.item == 1);
    }
}
