// SPDX-License-Identifier: MIT
#include <gmp.h>

#include <doctest/doctest.h>
#include <cmath>
#include <crofton/geometry/predicates.hpp>
#include <random>

using namespace crofton;

namespace {

// Dyadic rationals of any size: the obviously right reference.
class Rational {
  public:
    Rational() { mpq_init(value_); }
    Rational(double x) {
        mpq_init(value_);
        mpq_set_d(value_, x);
    }
    Rational(const Rational& other) {
        mpq_init(value_);
        mpq_set(value_, other.value_);
    }
    Rational& operator=(const Rational&) = delete;
    ~Rational() { mpq_clear(value_); }
    friend Rational operator+(const Rational& a, const Rational& b) { return apply(mpq_add, a, b); }
    friend Rational operator-(const Rational& a, const Rational& b) { return apply(mpq_sub, a, b); }
    friend Rational operator*(const Rational& a, const Rational& b) { return apply(mpq_mul, a, b); }
    int sign() const { return mpq_sgn(value_); }

  private:
    static Rational apply(void (*f)(mpq_ptr, mpq_srcptr, mpq_srcptr), const Rational& a, const Rational& b) {
        Rational result;
        f(result.value_, a.value_, b.value_);
        return result;
    }
    mpq_t value_;
};

int orientation_reference(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
    const Rational ax(a.x), ay(a.y), bx(b.x), by(b.y), cx(c.x), cy(c.y);
    return ((ax - cx) * (by - cy) - (ay - cy) * (bx - cx)).sign();
}

int in_circle_reference(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, glm::dvec2 d) {
    const Rational dx(d.x), dy(d.y);
    const Rational ax = Rational(a.x) - dx, ay = Rational(a.y) - dy, bx = Rational(b.x) - dx, by = Rational(b.y) - dy;
    const Rational cx = Rational(c.x) - dx, cy = Rational(c.y) - dy;
    return ((ax * ax + ay * ay) * (bx * cy - cx * by) + (bx * bx + by * by) * (cx * ay - ax * cy) +
            (cx * cx + cy * cy) * (ax * by - bx * ay))
        .sign();
}

int orientation_reference(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, glm::dvec3 d) {
    const Rational dx(d.x), dy(d.y), dz(d.z);
    const Rational ax = Rational(a.x) - dx, ay = Rational(a.y) - dy, az = Rational(a.z) - dz;
    const Rational bx = Rational(b.x) - dx, by = Rational(b.y) - dy, bz = Rational(b.z) - dz;
    const Rational cx = Rational(c.x) - dx, cy = Rational(c.y) - dy, cz = Rational(c.z) - dz;
    return (az * (bx * cy - cx * by) + bz * (cx * ay - ax * cy) + cz * (ax * by - bx * ay)).sign();
}

// Moves by up to two units in the last place, so that determinants land on both sides of 0 and on it.
double nudge(double x, std::mt19937_64& random) {
    const auto steps = static_cast<int>(random() % 5) - 2;
    for (int i = 0; i < std::abs(steps); ++i) x = std::nextafter(x, steps > 0 ? 1e300 : -1e300);
    return x;
}

}  // namespace

TEST_SUITE("geometry/predicates") {
    TEST_CASE("coincident points have no orientation and lie on every circle") {
        const glm::dvec2 p(0.1, 0.7), q(3.0, -2.0);
        CHECK(orientation(p, p, p) == 0);
        CHECK(orientation(p, q, p) == 0);
        CHECK(orientation(p, p, q) == 0);
        CHECK(in_circle(p, q, glm::dvec2(5.0, 5.0), q) == 0);
    }

    TEST_CASE("works at both ends of the documented range of coordinates") {
        for (const double scale : {1e-70, 1.0, 1e70}) {
            const glm::dvec2 a(0.0, 0.0), b(scale, 0.0), c(scale, scale), d(0.0, scale);
            CHECK(orientation(a, b, c) == 1);
            CHECK(orientation(a, c, b) == -1);
            CHECK(orientation(a, c, c * 0.5) == 0);
            CHECK(in_circle(a, b, c, d) == 0);
            CHECK(in_circle(a, b, c, d * 0.75) == 1);
            CHECK(in_circle(a, b, c, d * 1.5) == -1);
        }
    }

    TEST_CASE("points of 1e-65 that differ in their last places are inside or outside of a circle") {
        const double place = std::nextafter(1e-65, 1.0) - 1e-65;
        const auto at = [&](int x, int y) { return glm::dvec2(1e-65 + x * place, 1e-65 + y * place); };
        CHECK(in_circle(at(0, 0), at(8, 0), at(0, 8), at(2, 2)) == 1);
        CHECK(in_circle(at(0, 0), at(8, 0), at(0, 8), at(8, 8)) == 0);
        CHECK(in_circle(at(0, 0), at(8, 0), at(0, 8), at(9, 8)) == -1);
    }

    TEST_CASE("sees that 0.1, 0.2, 0.3 on the diagonal are collinear, and one unit in the last place off is not") {
        const double up = std::nextafter(0.3, 1.0);
        CHECK(orientation(glm::dvec2(0.1, 0.1), glm::dvec2(0.2, 0.2), glm::dvec2(0.3, 0.3)) == 0);
        CHECK(orientation(glm::dvec2(0.1, 0.1), glm::dvec2(0.2, 0.2), glm::dvec2(0.3, up)) == 1);
        CHECK(orientation(glm::dvec2(0.1, 0.1), glm::dvec2(0.2, 0.2), glm::dvec2(up, 0.3)) == -1);
    }

    TEST_CASE("the unit tetrahedron: z below the counter-clockwise triangle o, x, y is positive, above it negative") {
        const glm::dvec3 o(0, 0, 0), x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
        CHECK(orientation(o, x, y, -z) == 1);
        CHECK(orientation(o, x, y, z) == -1);
        CHECK(orientation(o, y, x, z) == 1);
    }

    TEST_CASE("d below a counter-clockwise triangle is positive") {
        const glm::dvec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
        CHECK(orientation(a, b, c, glm::dvec3(1, 1, -1e-300)) == 1);
        CHECK(orientation(a, b, c, glm::dvec3(0.3, 0.3, -1)) == 1);
        CHECK(orientation(a, b, c, glm::dvec3(0.3, 0.3, 1e-60)) == -1);
        CHECK(orientation(a, b, c, glm::dvec3(7, 9, 0)) == 0);
    }

    TEST_CASE("agrees with rational arithmetic on nearly collinear points") {
        std::mt19937_64 random(11);
        std::uniform_real_distribution<double> number(-1.0, 1.0);
        int zeros = 0;
        for (int trial = 0; trial < 20000; ++trial) {
            const glm::dvec2 a(number(random), number(random)), b(number(random), number(random));
            const double t = trial % 2 ? 0.5 : number(random);
            const glm::dvec2 m = a + (b - a) * t;
            const glm::dvec2 c(nudge(m.x, random), nudge(m.y, random));
            const int truth = orientation_reference(a, b, c);
            zeros += truth == 0;
            REQUIRE(orientation(a, b, c) == truth);
        }
        CHECK(zeros > 0);
    }

    TEST_CASE("agrees with rational arithmetic on nearly cocircular points, dyadic and not") {
        std::mt19937_64 random(13);
        std::uniform_real_distribution<double> number(-1.0, 1.0);
        int zeros = 0;
        for (int trial = 0; trial < 5000; ++trial) {
            glm::dvec2 p[4];
            for (auto& q : p) {
                // Pythagorean points of the circle of radius 65 or the rounded unit circle, about a common centre.
                if (trial % 2) {
                    static constexpr int kPoints[][2] = {{16, 63}, {25, 60}, {33, 56}, {39, 52}, {0, 65}, {65, 0}};
                    const auto& k = kPoints[random() % 6];
                    q = glm::dvec2(random() % 2 ? k[0] : -k[0], random() % 2 ? k[1] : -k[1]) +
                        glm::dvec2(1000.25, -7.5);
                    if (trial % 4 == 1) q = glm::dvec2(nudge(q.x, random), nudge(q.y, random));
                } else {
                    const double angle = 3.14 * number(random);
                    q = glm::dvec2(std::cos(angle) + 0.3, std::sin(angle) - 5.1);
                }
            }
            const int truth = in_circle_reference(p[0], p[1], p[2], p[3]);
            zeros += truth == 0;
            REQUIRE(in_circle(p[0], p[1], p[2], p[3]) == truth);
        }
        CHECK(zeros > 100);
    }

    TEST_CASE("agrees with rational arithmetic on integers, from small ones to those whose products need rounding") {
        std::mt19937_64 random(14);
        int zeros = 0;
        for (int trial = 0; trial < 20000; ++trial) {
            const auto span = std::int64_t{2} << (trial % 4 == 0 ? 1 : random() % 20);
            const auto number = [&] { return static_cast<double>(static_cast<std::int64_t>(random() % 8) * span); };
            glm::dvec2 p[4];
            for (auto& q : p) q = glm::dvec2(number(), number()) + (trial % 3 == 0 ? glm::dvec2(0.5) : glm::dvec2(0.0));
            p[3] = trial % 2 ? p[0] + p[2] - p[1] : p[3];  // a parallelogram, at times a rectangle
            if (trial % 5 == 0) p[2].x += 1.0;
            const int circle = in_circle_reference(p[0], p[1], p[2], p[3]);
            zeros += circle == 0;
            REQUIRE(in_circle(p[0], p[1], p[2], p[3]) == circle);
            REQUIRE(orientation(p[0], p[1], p[3]) == orientation_reference(p[0], p[1], p[3]));
        }
        CHECK(zeros > 50);
    }

    TEST_CASE("points of one circle whose products take 200 bits lie on it, and not one unit off it") {
        std::mt19937_64 random(15);
        for (int trial = 0; trial < 20000; ++trial) {
            // Pythagorean points of the circle of radius 65, as large as integers go.
            static constexpr int kPoints[][2] = {{16, 63}, {25, 60}, {33, 56}, {39, 52}, {0, 65},
                                                 {65, 0},  {63, 16}, {60, 25}, {56, 33}, {52, 39}};
            const auto scale = static_cast<double>(random() >> (19 + random() % 20));
            const glm::dvec2 middle = trial % 2 ? glm::dvec2(0.0) : glm::dvec2(0x1.8p50, -0x1p50);
            glm::dvec2 points[4];
            for (auto& point : points) {
                const auto& k = kPoints[random() % 10];
                point = scale * glm::dvec2(random() % 2 ? k[0] : -k[0], random() % 2 ? k[1] : -k[1]) + middle;
            }
            if (trial % 4 == 3) points[random() % 4].x += 1.0;
            const int truth = in_circle_reference(points[0], points[1], points[2], points[3]);
            REQUIRE(in_circle(points[0], points[1], points[2], points[3]) == truth);
            if (trial % 4 != 3) REQUIRE(truth == 0);
        }
    }

    TEST_CASE("agrees with rational arithmetic on nearly coplanar points") {
        std::mt19937_64 random(17);
        std::uniform_real_distribution<double> number(-1.0, 1.0);
        for (int trial = 0; trial < 5000; ++trial) {
            glm::dvec3 p[3];
            for (auto& q : p) q = glm::dvec3(number(random), number(random), number(random));
            const double s = number(random), t = number(random);
            const glm::dvec3 m = p[0] + (p[1] - p[0]) * s + (p[2] - p[0]) * t;
            const glm::dvec3 d(nudge(m.x, random), nudge(m.y, random), nudge(m.z, random));
            REQUIRE(orientation(p[0], p[1], p[2], d) == orientation_reference(p[0], p[1], p[2], d));
        }
    }
}
