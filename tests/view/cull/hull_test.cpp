// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/convex/shape.hpp>
#include <crofton/cull/classify.hpp>
#include <crofton/sampling/sampling.hpp>
#include <vector>

#include "../../oracle/exact_frustum.hpp"

using namespace crofton;

namespace {

// The hull's faces and the view's planes as rational inequalities.
std::vector<oracle::Inequality> rows_of(const Frustum& frustum, const convex::Hull& hull, bool with_hull) {
    std::vector<oracle::Inequality> rows;
    for (const Plane& plane : frustum.view()) {
        oracle::Inequality row(4);
        row[3] = plane.offset;
        for (int k = 0; k < 3; ++k) {
            row[static_cast<std::size_t>(k)] = plane.normal[k];
            row[3] -= mpq_class(plane.normal[k]) * mpq_class(frustum.origin[k]);
        }
        rows.push_back(row);
    }
    const auto indices = hull.triangles();
    for (std::size_t t = 0; with_hull && t < indices.size(); t += 3) {
        std::array<std::array<mpq_class, 3>, 3> p;
        for (std::size_t c = 0; c < 3; ++c)
            for (int k = 0; k < 3; ++k) p[c][static_cast<std::size_t>(k)] = hull.vertices()[indices[t + c]][k];
        oracle::Inequality row(4);
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
            row[k] = -((p[1][i] - p[0][i]) * (p[2][j] - p[0][j]) - (p[1][j] - p[0][j]) * (p[2][i] - p[0][i]));
        }
        for (std::size_t k = 0; k < 3; ++k) row[3] -= row[k] * p[0][k];
        rows.push_back(row);
    }
    return rows;
}

mpq_class value_at(const oracle::Inequality& row, const std::array<mpq_class, 3>& p) {
    return row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
}

// A bounded set that is not empty has a corner: a point where three of its planes meet, which satisfies all.
bool has_corner(const std::vector<oracle::Inequality>& rows) {
    const auto minor = [](const oracle::Inequality& a, const oracle::Inequality& b, std::size_t x, std::size_t y) {
        return mpq_class(a[x] * b[y] - a[y] * b[x]);
    };
    for (std::size_t i = 0; i < rows.size(); ++i)
        for (std::size_t j = i + 1; j < rows.size(); ++j) {
            const std::array<mpq_class, 3> cross = {minor(rows[i], rows[j], 1, 2), minor(rows[i], rows[j], 2, 0),
                                                    minor(rows[i], rows[j], 0, 1)};
            for (std::size_t k = j + 1; k < rows.size(); ++k) {
                const mpq_class det = rows[k][0] * cross[0] + rows[k][1] * cross[1] + rows[k][2] * cross[2];
                if (det == 0) continue;
                // Cramer: −(d_i (j × k) + d_j (k × i) + d_k (i × j)) / det.
                std::array<mpq_class, 3> p;
                for (std::size_t c = 0; c < 3; ++c) {
                    const std::size_t x = (c + 1) % 3, y = (c + 2) % 3;
                    p[c] = -(rows[i][3] * minor(rows[j], rows[k], x, y) + rows[j][3] * minor(rows[k], rows[i], x, y) +
                             rows[k][3] * cross[c]) /
                           det;
                }
                bool inside = true;
                for (std::size_t m = 0; m < rows.size() && inside; ++m)
                    inside = m == i || m == j || m == k || value_at(rows[m], p) >= 0;
                if (inside) return true;
            }
        }
    return false;
}

cull::Verdict oracle_verdict(const Frustum& frustum, const convex::Hull& hull) {
    bool inside = true;
    for (const oracle::Inequality& row : rows_of(frustum, hull, false))
        for (const glm::vec3& v : hull.vertices()) {
            const mpq_class value =
                row[0] * mpq_class(v.x) + row[1] * mpq_class(v.y) + row[2] * mpq_class(v.z) + row[3];
            inside = inside && value >= 0;
        }
    if (inside) return cull::Verdict::inside;
    return has_corner(rows_of(frustum, hull, true)) ? cull::Verdict::straddling : cull::Verdict::outside;
}

Camera random_camera(sampling::Random& random) {
    Camera camera;
    camera.position = 6.0 * sampling::ball_point(random.point<3>());
    camera.forward = sampling::direction(random.point<2>());
    camera.up = sampling::direction(random.point<2>());
    camera.fov_y = random.uniform(0.2, 2.0);
    camera.near_distance = random.uniform(0.05, 1.0);
    camera.far_distance = random.uniform(2.0, 12.0);
    return camera;
}

}  // namespace

TEST_SUITE("cull/hull") {
    TEST_CASE("verdicts are those of rational arithmetic, near misses included") {
        int counts[3] = {}, kept = 0;
        for (std::uint64_t seed = 0; seed < 240; ++seed) {
            sampling::Random random(41, seed);
            const Frustum frustum = *frustum_of(random_camera(random));
            std::vector<glm::vec3> points;
            // Some far larger than the view, some on a coarse grid, so that they touch.
            const double size = seed % 3 == 0 ? 20.0 : random.uniform(0.3, 3.0);
            const glm::dvec3 at = 4.0 * sampling::ball_point(random.point<3>());
            for (int i = 0; i < 7; ++i) {
                glm::dvec3 p = at + size * sampling::ball_point(random.point<3>());
                if (seed % 2 == 0) p = glm::dvec3(std::round(p.x), std::round(p.y), std::round(p.z));
                points.push_back(glm::vec3(p));
            }
            const auto hull = convex::Hull::build(points);
            if (!hull) continue;
            const cull::Verdict truth = oracle_verdict(frustum, *hull);
            CHECK(cull::classify(frustum, *hull) == truth);
            const cull::Verdict by_planes = cull::classify(frustum, *hull, cull::CullMode::conservative);
            if (by_planes == cull::Verdict::outside) CHECK(truth == cull::Verdict::outside);
            CHECK((by_planes == cull::Verdict::inside) == (truth == cull::Verdict::inside));
            kept += by_planes == cull::Verdict::straddling && truth == cull::Verdict::outside;
            ++counts[static_cast<int>(truth)];
        }
        for (const int count : counts) CHECK(count > 8);
        CHECK(kept > 2);  // past an edge or a corner of the view
    }

    TEST_CASE("a hull around the whole view meets it, one that touches a plane is never outside") {
        Camera camera;
        camera.near_distance = 1.0;
        camera.far_distance = 2.0;
        const Frustum view = *frustum_of(camera);
        std::vector<glm::vec3> corners;
        for (unsigned c = 0; c < 8; ++c)
            corners.push_back({c & 1 ? 50.0f : -50.0f, c & 2 ? 50.0f : -50.0f, c & 4 ? 50.0f : -50.0f});
        CHECK(cull::classify(view, *convex::Hull::build(corners)) == cull::Verdict::straddling);
        Camera box;
        box.projection = Projection::orthographic;
        box.height = 2.0, box.aspect = 1.0, box.near_distance = 1.0, box.far_distance = 3.0;
        const Frustum cube = *frustum_of(box);  // |x|, |y| ≤ 1, −3 ≤ z ≤ −1
        const std::vector<glm::vec3> touching = {{1, 0, -2}, {2, 0, -2}, {2, 1, -2}, {2, 0, -1.5f}},
                                     beside = {{1.0000001f, 0, -2}, {2, 0, -2}, {2, 1, -2}, {2, 0, -1.5f}};
        CHECK(cull::classify(cube, *convex::Hull::build(touching)) == cull::Verdict::straddling);
        CHECK(cull::classify(cube, *convex::Hull::build(beside)) == cull::Verdict::outside);
    }

    TEST_CASE("views without a far plane, and NaN in the view, lose nothing") {
        Camera camera;
        camera.far_distance = std::numeric_limits<double>::infinity();
        Frustum view = *frustum_of(camera);
        const std::vector<glm::vec3> points = {{0, 0, -1e6f}, {10, 0, -1e6f}, {0, 10, -1e6f}, {0, 0, -2e6f}};
        const auto hull = *convex::Hull::build(points);
        CHECK(cull::classify(view, hull) == cull::Verdict::inside);
        view.planes[0].offset = std::nan("");
        CHECK(cull::classify(view, hull) == cull::Verdict::straddling);
    }
}
