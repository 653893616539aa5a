// SPDX-License-Identifier: MIT
// From where an occluder may be used: by exact arithmetic.
#include <doctest/doctest.h>
#include <gmpxx.h>
#include <array>
#include <cmath>
#include <crofton/geometry/camera.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>
#include <glm/vector_relational.hpp>
#include <random>

#include <oracle/near_misses.hpp>
#include "shape/collide/random_boxes.hpp"

using namespace crofton;
using namespace crofton::occlude;
using namespace crofton::testing;

namespace {

// The point where three rows of a matrix are 0, by Cramer's rule.
std::array<mpq_class, 3> meeting_point(const glm::dmat4& m, const std::array<int, 3>& rows) {
    const auto determinant = [&](int instead) {
        const auto at = [&](int i, int column) {
            const double number = m[column == instead ? 3 : column][rows[static_cast<std::size_t>(i)]];
            return mpq_class(column == instead ? -number : number);
        };
        return mpq_class(at(0, 0) * (at(1, 1) * at(2, 2) - at(1, 2) * at(2, 1)) -
                         at(0, 1) * (at(1, 0) * at(2, 2) - at(1, 2) * at(2, 0)) +
                         at(0, 2) * (at(1, 0) * at(2, 1) - at(1, 1) * at(2, 0)));
    };
    const mpq_class all = determinant(-1);
    return {determinant(0) / all, determinant(1) / all, determinant(2) / all};
}

}  // namespace

TEST_SUITE("occlude/eye_limits") {
    TEST_CASE("an occluder with an open side is used by eyes and parallel views that the side does not let in") {
        FoundOccluder found;  // a box [−1, 1]³, open above y = 1, moved to (10, 0, 0) and turned upright: y is world z
        found.box.half_extents = glm::vec3(1);
        found.surface.positions = {glm::vec3(-1), glm::vec3(1)};
        found.piece_bounds = {glm::dvec3(-1), glm::dvec3(1)};
        found.eyes_within.max.y = 1.0;
        Transform transform;
        transform.linear = 2.0 * glm::dmat3(1, 0, 0, 0, 0, 1, 0, -1, 0);
        transform.translation = {10, 0, 0};
        const EyeLimits limits = candidate_of(found, transform).limits;
        Camera camera;
        const auto from = [&](const glm::dvec3& eye) {
            camera.position = eye;
            return may_use(limits, camera);
        };
        CHECK(from({0, 0, 0}));
        CHECK(from({0, 0, 1.999}));
        CHECK_FALSE(from({0, 0, 2.001}));
        CHECK_FALSE(from({10, 0, 50}));
        CHECK(from({10, 0, -50}));
        CHECK_FALSE(from({10, 1, -1}));  // inside
        CHECK_FALSE(from({1e9, 0, 2.0001}));
        camera.projection = Projection::orthographic;
        camera.forward = {1, 0, 0.5};
        CHECK(from({-20, 0, 0}));
        camera.forward = {1, 0, -0.5};
        CHECK_FALSE(from({-20, 0, 0}));
        transform.linear[2] = glm::dvec3(0);  // flattened: nothing is known
        const EyeLimits flat = candidate_of(found, transform).limits;
        camera = {};
        CHECK_FALSE(may_use(flat, camera));
    }

    TEST_CASE("however sheared a mesh stands, no eye beyond an open side uses the occluder, by exact arithmetic") {
        std::mt19937_64 random(31);
        std::uniform_real_distribution<double> unit(-1.0, 1.0);
        const auto point = [&] { return glm::dvec3(unit(random), unit(random), unit(random)); };
        FoundOccluder found;  // a box [−1, 1]³, open on one side
        found.box.half_extents = glm::vec3(1);
        found.surface.positions = {glm::vec3(-1), glm::vec3(1)};
        found.piece_bounds = {glm::dvec3(-1), glm::dvec3(1)};
        int used = 0, kept_out = 0;
        for (int i = 0; i < 20000; ++i) {
            const int axis = i % 3;
            const bool upper = i % 2 == 0;
            const double side = upper ? 1.0 : -1.0;
            found.eyes_within = everywhere();
            (upper ? found.eyes_within.max : found.eyes_within.min)[axis] = side;
            Transform transform;
            const double flatness = std::pow(2.0, -static_cast<double>(random() % 48));
            transform.linear[axis] = point();
            transform.linear[(axis + 1) % 3] = point();
            // Nearly along the next column, or in the plane of both.
            transform.linear[(axis + 2) % 3] = unit(random) * transform.linear[(axis + 1) % 3] + flatness * point() +
                                               (i % 5 == 0 ? unit(random) : 0.0) * transform.linear[axis];
            transform.linear *= std::pow(2.0, static_cast<double>(random() % 40) - 20.0);
            transform.translation = i % 4 == 0 ? glm::dvec3(0) : 1e3 * point();
            glm::dvec3 local = 1e4 * point();
            local[axis] = side * (1.0 + unit(random) * std::pow(2.0, -static_cast<double>(random() % 50)));
            Camera camera;
            camera.position = transform * local;
            camera.near_distance = 1e-9;
            // By Cramer's rule: the eye's coordinate along the axis, in the mesh.
            const auto determinant = [&](bool of_eye) {
                std::array<std::array<mpq_class, 3>, 3> m;
                for (int c = 0; c < 3; ++c)
                    for (int r = 0; r < 3; ++r)
                        m[static_cast<std::size_t>(c)][static_cast<std::size_t>(r)] =
                            of_eye && c == axis
                                ? mpq_class(mpq_class(camera.position[r]) - mpq_class(transform.translation[r]))
                                : mpq_class(transform.linear[c][r]);
                return mpq_class(m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                                 m[1][0] * (m[0][1] * m[2][2] - m[0][2] * m[2][1]) +
                                 m[2][0] * (m[0][1] * m[1][2] - m[0][2] * m[1][1]));
            };
            const mpq_class whole = determinant(false);
            if (whole == 0) continue;
            const bool is_kept = determinant(true) / whole * side <= 1;
            const bool may = may_use(candidate_of(found, transform).limits, camera);
            CHECK_FALSE((may && !is_kept));
            used += may;
            kept_out += !is_kept;
        }
        CHECK(used > 1000);
        CHECK(kept_out > 4000);
    }

    TEST_CASE(
        "an eye beside a turned piece uses its occluder, also within the bounds along the axes, one inside never") {
        oracle::NearMisses random(4612);
        int beside = 0, inside = 0;
        for (int trial = 0; trial < 20'000; ++trial) {
            FoundOccluder found;
            const glm::dvec3 wanted{random.number(0.1, 9.0), random.number(0.1, 9.0), random.number(0.1, 9.0)};
            const glm::vec3 half(wanted);
            found.box.half_extents = half;
            found.surface.positions = {-half, half};
            found.piece_bounds = {-glm::dvec3(half), glm::dvec3(half)};
            Transform transform;
            for (int k = 0; k < 3; ++k)
                for (int i = 0; i < 3; ++i) transform.linear[k][i] = random.number(-1.0, 1.0);
            if (std::abs(glm::determinant(transform.linear)) < 0.01) continue;
            transform.translation = {random.number(-1e3, 1e3), random.number(-1e3, 1e3), random.number(-1e3, 1e3)};
            const EyeLimits limits = candidate_of(found, transform).limits;
            // So far beyond one of the sides, in the mesh's own coordinates, or so far within it.
            const int axis = trial % 3;
            const double sign = trial % 2 == 0 ? 1.0 : -1.0;
            const glm::dvec3 own{random.number(-0.9, 0.9), random.number(-0.9, 0.9), random.number(-0.9, 0.9)};
            Camera camera;
            camera.near_distance = 1e-4;
            const double room = 1e-3;  // more than the near plane's farthest point
            const glm::dvec3 across = glm::row(glm::inverse(transform.linear), axis);
            const auto eye_at = [&](double beyond) {
                glm::dvec3 p = own * glm::dvec3(half);
                p[axis] = sign * (static_cast<double>(half[axis]) + beyond * glm::length(across));
                return transform * p;
            };
            camera.position = eye_at(room);
            CHECK(may_use(limits, camera));
            const Aabb& bounds = limits.left_out_within;
            beside += glm::all(glm::greaterThan(camera.position, bounds.min)) &&
                      glm::all(glm::lessThan(camera.position, bounds.max));
            camera.position = eye_at(-room);
            CHECK_FALSE(may_use(limits, camera));
            camera.position = eye_at(1e-5);  // nearer than the near plane's corners
            CHECK_FALSE(may_use(limits, camera));
            camera.position = transform * (own * glm::dvec3(half));
            CHECK_FALSE(may_use(limits, camera));
            ++inside;
        }
        CHECK(inside > 15'000);
        CHECK(beside > 5'000);
    }

    TEST_CASE("no parallel view enters by an open side, however sheared its picture, by exact arithmetic") {
        std::mt19937_64 random(32);
        std::uniform_real_distribution<double> unit(-1.0, 1.0);
        const auto point = [&] { return glm::dvec3(unit(random), unit(random), unit(random)); };
        int used = 0, kept_out = 0;
        for (int i = 0; i < 20000; ++i) {
            const double angle = std::pow(2.0, -static_cast<double>(random() % 28));
            const glm::dvec3 x = point(), y = unit(random) * x + angle * point(), depth = glm::cross(x, y) / angle;
            glm::dmat4 to_clip(0.0);
            for (int k = 0; k < 3; ++k) {
                to_clip[k][0] = x[k];
                to_clip[k][1] = y[k];
                to_clip[k][2] = 0.01 * depth[k];
            }
            to_clip[3] = {0.1, 0.2, 0.5, 1.0};
            const auto view = occlusion_view_of(to_clip, DepthRange::zero_to_one);
            if (!view || view->perspective) continue;
            EyeLimits limits;
            limits.plane_count = 1;
            limits.planes[0].normal = glm::normalize(glm::cross(point(), glm::normalize(depth))) +
                                      unit(random) * std::pow(2.0, -static_cast<double>(random() % 44)) * point();
            std::array<mpq_class, 3> u, v;
            for (std::size_t k = 0; k < 3; ++k) {
                u[k] = x[static_cast<int>(k)];
                v[k] = y[static_cast<int>(k)];
            }
            mpq_class enters = 0, forward = 0;  // along the rays
            for (std::size_t k = 0; k < 3; ++k) {
                const mpq_class ray = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
                enters += ray * mpq_class(limits.planes[0].normal[static_cast<int>(k)]);
                forward += ray * mpq_class(depth[static_cast<int>(k)]);
            }
            const bool may = may_use(limits, *view), is_kept = sgn(enters) * sgn(forward) <= 0;
            CHECK_FALSE((may && !is_kept));
            used += may;
            kept_out += !is_kept;
        }
        CHECK(used > 4000);
        CHECK(kept_out > 4000);
    }

    TEST_CASE("an occluder that a parallel view's near plane may cut, within rounding, is not used") {
        // Chosen by a search for products that round to too much, all of them.
        const glm::dvec3 normal(0x1.002a2d8b69cc5p-1, 0x1.004245f308698p-1, -0x1.6a0902cbc084cp-1),
            nearest(0x1.000b1cf49f5e2p-1, 0x1.0019f24fbabe9p-1, 0x1.6a7030c10d109p-1);
        OcclusionView view;
        view.perspective = false;
        view.frustum.origin = {-0x1.000b25dcdb5bdp-1, -0x1.00170058dcbb2p-1, -0x1.6a7032d96a61cp-1};
        EyeLimits limits;
        limits.left_out_within = {nearest, nearest};
        mpq_class exact = 0;
        for (int k = 0; k < 3; ++k)
            exact += mpq_class(normal[k]) * (mpq_class(nearest[k]) - mpq_class(view.frustum.origin[k]));
        int cut = 0, whole = 0;
        for (int step = -64; step <= 64; ++step) {
            const double offset = -exact.get_d() + step * 0x1p-54;
            view.frustum.planes[4] = {normal, offset};
            const bool is_cut = exact + mpq_class(offset) < 0;
            CHECK_FALSE((is_cut && may_use(limits, view)));
            cut += is_cut;
            whole += !is_cut;
        }
        CHECK(cut > 10);
        CHECK(whole > 10);
        view.frustum.planes[4].offset = -exact.get_d() + 1e-12;
        CHECK(may_use(limits, view));
    }

    TEST_CASE("the eye of a matrix is within its error of the exact one, also of a window far to the eye's side") {
        std::mt19937_64 random(50);
        int far_off = 0, taken = 0;
        for (int trial = 0; trial < 400; ++trial) {
            const glm::dvec3 eye = 50.0 * random_vector(random), forward = glm::normalize(random_vector(random));
            const glm::dvec3 right = glm::normalize(glm::cross(forward, random_vector(random))),
                             up = glm::cross(right, forward);
            // How far, in half widths of the window.
            const double aside = std::exp2(double(trial % 13)), above = 0.3 * aside;
            const glm::dvec3 rows[4] = {right + aside * forward, up - above * forward, forward, forward};
            glm::dmat4 matrix;
            for (int r = 0; r < 4; ++r) {
                for (int j = 0; j < 3; ++j) matrix[j][r] = rows[r][j];
                matrix[3][r] = -glm::dot(rows[r], eye) - (r == 2 ? 0.1 : 0.0);
            }
            const auto view = occlusion_view_of(matrix, DepthRange::zero_to_one, glm::dvec3(0.0));
            if (!view) continue;  // the corners of such a window's near face are not known well enough
            const auto exact = meeting_point(matrix, {0, 1, 3});
            glm::dvec3 off;
            for (int j = 0; j < 3; ++j)
                off[j] = mpq_class(view->origin[j] - exact[static_cast<std::size_t>(j)]).get_d();
            CHECK(glm::length(off) <= view->eye_error);
            far_off += glm::length(off) > 0x1p-40 * glm::length(eye);
            ++taken;
        }
        CHECK(taken > 350);
        CHECK(far_off > 50);
    }
}
