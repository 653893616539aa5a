// SPDX-License-Identifier: MIT
// Points inside the hull of others are forgotten when a large cloud is fitted. No answer may tell.
#include "cloud/interior.hpp"

#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/fit/fit.hpp>
#include <glm/geometric.hpp>
#include <random>
#include <string>
#include <vector>

#include "cloud/point_cloud.hpp"

using namespace crofton;
using namespace crofton::fit;

namespace {

using Points = std::vector<glm::dvec3>;

class Random {
  public:
    explicit Random(unsigned seed) : engine_(seed) {}
    double unit() { return unit_(engine_); }
    glm::dvec3 box() {
        const double x = unit(), y = unit(), z = unit();
        return {x, y, z};
    }
    glm::dvec3 normal() {
        const double x = normal_(engine_), y = normal_(engine_), z = normal_(engine_);
        return {x, y, z};
    }
    glm::dvec3 direction() { return glm::normalize(normal()); }
    glm::dmat3 rotation() {
        const glm::dvec3 a = direction(), b = glm::normalize(glm::cross(a, direction()));
        return {a, b, glm::cross(a, b)};
    }
    void shuffle(Points& points) { std::shuffle(points.begin(), points.end(), engine_); }

  private:
    std::mt19937 engine_;
    std::uniform_real_distribution<double> unit_{-1.0, 1.0};
    std::normal_distribution<double> normal_;
};

bool is_inside(const InteriorTest& test, const glm::dvec3& p) {
    for (std::size_t i = 0; i < test.count; ++i)
        if (test.planes[i][0] * p.x + test.planes[i][1] * p.y + test.planes[i][2] * p.z >= test.planes[i][3])
            return false;
    return test.count > 0;
}

double volume(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
    return glm::dot(glm::cross(b - a, c - a), d - a);
}

// The oracle: whether some four of the points have p between them (Carathéodory), up to 1e-12.
bool in_some_tetrahedron(const Points& points, const glm::dvec3& p) {
    constexpr double kRounding = 1e-12;
    for (std::size_t a = 0; a < points.size(); ++a)
        for (std::size_t b = 0; b < a; ++b)
            for (std::size_t c = 0; c < b; ++c)
                for (std::size_t d = 0; d < c; ++d) {
                    const double whole = volume(points[a], points[b], points[c], points[d]);
                    if (std::abs(whole) < kRounding) continue;
                    const double sign = whole < 0.0 ? -1.0 : 1.0;
                    if (sign * volume(p, points[b], points[c], points[d]) >= -kRounding &&
                        sign * volume(points[a], p, points[c], points[d]) >= -kRounding &&
                        sign * volume(points[a], points[b], p, points[d]) >= -kRounding &&
                        sign * volume(points[a], points[b], points[c], p) >= -kRounding)
                        return true;
                }
    return false;
}

// Few points as extreme ones may be: of a box or a sphere, thin, with many in one plane, line or place.
Points few_points(Random& random, int kind) {
    Points points;
    const std::size_t count = 4 + static_cast<std::size_t>(kind % 15);
    const glm::dvec3 size = kind % 3 == 0 ? glm::dvec3(0.5) : glm::dvec3(0.5, 0.3, kind % 3 == 1 ? 1e-3 : 1e-5);
    for (std::size_t i = 0; i < count; ++i) {
        glm::dvec3 p = kind % 2 == 0 ? random.direction() : random.box();
        if (kind % 5 == 1)
            for (int k = 0; k < 3; ++k) p[k] = std::round(2.0 * p[k]) / 2.0;
        if (kind % 7 == 2 && i > 3) p = points[i % 3];
        points.push_back(kind % 7 == 2 && i > 3 ? p : size * p);
    }
    const glm::dmat3 turn = random.rotation();
    if (kind % 4 != 1)
        for (glm::dvec3& p : points) p = turn * p;
    return points;
}

struct Cloud {
    const char* name;
    Points points;
    bool thins;  // most of its points are inside the hull of few
};

// Clouds in random order.
std::vector<Cloud> clouds(Random& random, std::size_t count) {
    std::vector<Cloud> all;
    const glm::dmat3 turn = random.rotation();
    const auto add = [&](const char* name, bool thins, auto&& point) {
        Points points;
        for (std::size_t i = 0; i < count; ++i) points.push_back(point(i));
        random.shuffle(points);
        all.push_back({name, points, thins});
    };
    const glm::dvec3 size(3, 2, 1);
    add("normal distribution", true, [&](std::size_t) { return random.normal() * size; });
    add("turned box", true, [&](std::size_t) { return turn * (random.box() * size); });
    add("ellipsoid's surface", false, [&](std::size_t) { return turn * (random.direction() * size); });
    add("cylinder's surface", false, [&](std::size_t) {
        const double angle = 4.0 * random.unit();
        return turn * glm::dvec3(std::cos(angle), std::sin(angle), 2.0 * random.unit());
    });
    add("coarse grid", false, [&](std::size_t) { return glm::round(4.0 * random.box()); });
    add("fine grid", true, [&](std::size_t) { return glm::round(40.0 * random.box()); });
    add("points twice and thrice", true, [&](std::size_t i) {
        static glm::dvec3 last;
        if (i % 3 == 0) last = random.box();
        return last;
    });
    add("far from the origin", true, [&](std::size_t) { return random.box() + glm::dvec3(1e7, -1e7, 3e6); });
    add("large", true, [&](std::size_t) { return 1e29 * random.box(); });
    add("small", true, [&](std::size_t) { return 1e-30 * random.normal(); });
    add("thin", true, [&](std::size_t) { return random.normal() * glm::dvec3(1, 1, 1e-3); });
    add("thinner than the margin", false, [&](std::size_t) { return turn * (random.box() * glm::dvec3(1, 1, 1e-8)); });
    add("flat", false, [&](std::size_t) { return turn * (random.box() * glm::dvec3(1, 1, 0)); });
    add("straight", false, [&](std::size_t) { return random.unit() * glm::dvec3(1, 2, 3); });
    add("one point", false, [&](std::size_t) { return glm::dvec3(1, 2, 3); });
    return all;
}

const glm::dmat3 kTriples[] = {
    {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{1, 1, 1}, {1, 1, -1}, {1, -1, 1}}, {{1, -1, -1}, {1, 1, 0}, {1, 0, 1}}};

Points extremes_of(PointCloud& cloud) {
    Points extremes;
    for (const glm::dmat3& triple : kTriples)
        for (const glm::dvec3& p : cloud.supports(triple)) extremes.push_back(p);
    return extremes;
}

template <class Point>
void check_supports(const Cloud& cloud, Random& random) {
    const std::vector<Point> points(cloud.points.begin(), cloud.points.end());
    PointCloud whole, thinned;
    REQUIRE(whole.assign(std::span<const Point>(points)));
    REQUIRE(thinned.assign(std::span<const Point>(points)));
    thinned.forget_interior(extremes_of(thinned));
    INFO(std::string(cloud.name), ": ", thinned.size(), " of ", whole.size());
    CHECK((thinned.size() < whole.size() / 4) == cloud.thins);
    CHECK((cloud.thins || thinned.size() == whole.size()));
    CHECK(thinned.origin() == whole.origin());
    CHECK(thinned.unit() == whole.unit());
    int differences = 0;
    for (int i = 0; i < 60; ++i) {
        const glm::dmat3 directions = i < 3 ? kTriples[i] : random.rotation();
        differences += whole.supports(directions) != thinned.supports(directions);
    }
    CHECK(differences == 0);
}

template <class Point>
std::string boxes_of(const Points& from, bool exact) {
    const std::vector<Point> points(from.begin(), from.end());
    std::string bits;
    for (const Quality quality : {Quality::fast, Quality::tight, Quality::exact})
        for (const auto& criterion :
             {measure::minimal_volume(), measure::minimal_area(), measure::minimal_perimeter()}) {
            if (quality == Quality::exact && !exact) continue;
            const auto box = fit_obb(std::span<const Point>(points), {criterion, quality});
            REQUIRE(box);
            bits.append(reinterpret_cast<const char*>(&*box), sizeof *box);
        }
    return bits;
}

}  // namespace

TEST_SUITE("fit/interior") {
    TEST_CASE("points that count as inside are inside, with a sphere around them") {
        Random random(61);
        int inside = 0, wrong = 0;
        for (int kind = 0; kind < 420; ++kind) {
            const Points points = few_points(random, kind);
            const InteriorTest test = interior_test(points);
            for (int i = 0; i < 60; ++i) {
                // Mixtures of some of the points, and a little beyond.
                glm::dvec3 p(0.0);
                double sum = 0.0;
                for (const glm::dvec3& q : points) {
                    const double weight = std::pow(std::abs(random.unit()), 1 + i % 9);
                    p += weight * q, sum += weight;
                }
                p *= (1.0 + 0.2 * random.unit()) / sum;
                if (!is_inside(test, p)) continue;
                ++inside;
                for (int k = 0; k < 6; ++k) {
                    glm::dvec3 beside = p;
                    beside[k / 2] += k % 2 == 0 ? 9e-7 : -9e-7;
                    wrong += !in_some_tetrahedron(points, beside);
                }
            }
        }
        CHECK(inside > 3000);
        CHECK(wrong == 0);
    }

    TEST_CASE("flat points, straight ones and too few have nothing inside") {
        Random random(62);
        Points points;
        CHECK(interior_test(points).count == 0);
        for (int i = 0; i < 12; ++i) {
            points.push_back({random.unit(), random.unit(), 0.5});
            CHECK(interior_test(points).count == 0);
        }
        points.assign(9, glm::dvec3(0.25));
        CHECK(interior_test(points).count == 0);
        for (int i = 0; i < 9; ++i) points.push_back(random.unit() * glm::dvec3(1, 0.5, 0.25));
        CHECK(interior_test(points).count == 0);
    }

    TEST_CASE(
        "of a cube's corners and the middles of its edges and faces, in any order, the whole cube is the inside") {
        Points points;
        for (int i = 0; i < 27; ++i)
            if (i != 13) points.push_back(glm::dvec3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1));
        Random random(63);
        for (int run = 0; run < 20; ++run) {
            random.shuffle(points);
            const InteriorTest test = interior_test(points);
            CHECK(test.count > 0);
            CHECK(is_inside(test, {0.9999, -0.9999, 0.9999}));
            CHECK(!is_inside(test, {1.0, 0.0, 0.0}));
            CHECK(!is_inside(test, {0.0, -1.0000001, 0.0}));
        }
    }

    TEST_CASE("support points are the same without the points inside") {
        Random random(64);
        for (const Cloud& cloud : clouds(random, 20000)) {
            check_supports<glm::dvec3>(cloud, random);
            if (std::string(cloud.name) != "far from the origin") check_supports<glm::vec3>(cloud, random);
        }
    }

    TEST_CASE("a cloud that is small, or whose neighbours are neighbours in the list, is kept whole") {
        Random random(65);
        const Points small = clouds(random, 8064)[1].points;
        Points helix;
        for (int i = 0; i < 20000; ++i)
            helix.push_back(glm::dvec3(std::cos(i * 1e-3), std::sin(i * 1e-3), i * 1e-3) + 0.01 * random.box());
        for (const Points& points : {small, helix}) {
            PointCloud cloud;
            REQUIRE(cloud.assign(std::span<const glm::dvec3>(points)));
            cloud.forget_interior(extremes_of(cloud));
            CHECK(cloud.size() == points.size());
        }
        random.shuffle(helix);
        PointCloud cloud;
        REQUIRE(cloud.assign(std::span<const glm::dvec3>(helix)));
        cloud.forget_interior(extremes_of(cloud));
        CHECK(cloud.size() == helix.size());  // few of its points are inside
    }

    // 8,000 points are never thinned, the same ones twice are: a box depends on the set alone.
    TEST_CASE("the box of a thinned cloud is that of all its points, to the last bit") {
        Random random(66);
        for (const Cloud& cloud : clouds(random, 8000)) {
            INFO(std::string(cloud.name));
            Points twice = cloud.points;
            twice.insert(twice.end(), cloud.points.begin(), cloud.points.end());
            random.shuffle(twice);
            CHECK(boxes_of<glm::dvec3>(twice, cloud.thins) == boxes_of<glm::dvec3>(cloud.points, cloud.thins));
            if (cloud.thins) {
                const auto proof = fit_exact(std::span<const glm::dvec3>(twice));
                const auto whole = fit_exact(std::span<const glm::dvec3>(cloud.points));
                CHECK(proof->lower_bound == whole->lower_bound);
                CHECK(proof->cells == whole->cells);
                CHECK(proof->subset == whole->subset);
            }
            CHECK(boxes_of<glm::vec3>(twice, cloud.thins) == boxes_of<glm::vec3>(cloud.points, cloud.thins));
        }
    }
}
