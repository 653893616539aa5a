// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <gmpxx.h>
#include <hwy/targets.h>
#include <algorithm>
#include <counting_memory.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "collide/random_boxes.hpp"

using namespace crofton;
using namespace crofton::occlude;
using namespace crofton::testing;

namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

OccluderCandidate random_candidate(std::mt19937_64& random, const glm::dvec3& around) {
    std::uniform_real_distribution<double> unit;
    Obb box = random_box(random, 200.0);
    box.center += around;
    box.half_extents *= static_cast<float>(std::pow(10.0, unit(random)));
    OccluderCandidate candidate = candidate_of(box);
    if (unit(random) < 0.5) {
        candidate.front_only = true;
        candidate.areas[1] = candidate.areas[2] = glm::vec3(0);
    }
    return candidate;
}

// By definition, in double.
double cover_by_definition(const OccluderCandidate& c, const Camera& camera) {
    const Frustum frustum = *frustum_of(camera);
    const glm::dvec3 offset = c.center - camera.position;
    for (const Plane& plane : frustum.view())
        if (glm::dot(plane.normal, offset) + plane.offset < -c.radius) return 0.0;
    const bool perspective = camera.projection == Projection::perspective;
    const double distance = std::max(glm::length(offset), 0.5 * c.radius);
    const glm::dvec3 d = perspective ? offset / distance : glm::normalize(camera.forward);
    if (c.front_only && glm::dot(d, glm::dvec3(c.areas[0])) > 0.0) return 0.0;
    double area = 0.0;
    for (const glm::vec3& a : c.areas) area += std::abs(glm::dot(d, glm::dvec3(a)));
    return perspective ? area / (distance * distance) / (4.0 * std::numbers::pi)
                       : area / (camera.height * camera.height * camera.aspect);
}

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

Camera random_camera(std::mt19937_64& random, const glm::dvec3& around) {
    Camera camera;
    camera.position = around + 100.0 * random_vector(random);
    camera.forward = random_vector(random);
    camera.up = random_vector(random);
    camera.far_distance = random() % 2 == 0 ? std::numeric_limits<double>::infinity() : 300.0;
    if (random() % 4 == 0) {
        camera.projection = Projection::orthographic;
        camera.height = 150.0;
        camera.far_distance = 300.0;
    }
    return camera;
}

}  // namespace

TEST_SUITE("occlude/choose_occluders") {
    TEST_CASE("a candidate that is NaN or too far away, an unknown id, a bad camera: each is named") {
        OccluderCandidates candidates;
        OccluderCandidate bad = candidate_of(Obb{});
        bad.center.y = kNotANumber;
        CHECK(error_of(candidates.add(bad)).code == ErrorCode::non_finite);
        bad = candidate_of(Obb{});
        bad.areas[2].x = std::numeric_limits<float>::infinity();
        CHECK(error_of(candidates.add(bad)).code == ErrorCode::non_finite);
        bad = candidate_of(Obb{});
        bad.radius = std::numeric_limits<double>::infinity();
        CHECK(error_of(candidates.add(bad)).code == ErrorCode::non_finite);
        bad = candidate_of(Obb{});
        bad.center.x = 2e15;
        CHECK(error_of(candidates.add(bad)).code == ErrorCode::out_of_range);
        bad.center.x = 0.0;
        bad.radius = -1.0;
        CHECK(error_of(candidates.add(bad)).code == ErrorCode::out_of_range);
        CHECK(error_of(candidates.set(0, candidate_of(Obb{}))).code == ErrorCode::out_of_range);
        CHECK(candidates.size() == 0);
        OccluderChoice choice;
        Camera camera;
        CHECK(choose_occluders(candidates, camera, {}, choice).has_value());
        CHECK(choice.ids.empty());
        camera.fov_y = kNotANumber;
        CHECK_FALSE(choose_occluders(candidates, camera, {}, choice).has_value());
    }

    TEST_CASE("those that cover most are chosen, as the definition in double says, at any place") {
        std::mt19937_64 random(1);
        for (int trial = 0; trial < 40; ++trial) {
            const glm::dvec3 around = trial % 2 == 0 ? glm::dvec3(0.0) : 1e7 * random_vector(random);
            OccluderCandidates candidates;
            std::vector<OccluderCandidate> given;
            for (int i = 0; i < 500; ++i) {
                given.push_back(random_candidate(random, around));
                REQUIRE(candidates.add(given.back()).value() == std::uint32_t(i));
            }
            const Camera camera = random_camera(random, around);
            OccluderChoice choice;
            const ChooseBudget budget{.max_occluders = 30, .least_cover = 1e-4f};
            REQUIRE(choose_occluders(candidates, camera, budget, choice).has_value());
            std::vector<double> best;
            for (const OccluderCandidate& c : given)
                if (const double cover = cover_by_definition(c, camera); cover >= 1e-4) best.push_back(cover);
            std::sort(best.begin(), best.end(), std::greater<>());
            best.resize(std::min<std::size_t>(best.size(), 30));
            // What stands at the border of the view or at the limit may be rounded in or out.
            REQUIRE(std::abs(double(choice.ids.size()) - double(best.size())) <= 2.0);
            int different = 0;
            for (std::size_t i = 0; i < std::min(best.size(), choice.ids.size()); ++i) {
                const double cover = cover_by_definition(given[choice.ids[i]], camera);
                different += std::abs(cover - best[i]) > 1e-3 * best[i] ? 1 : 0;
            }
            CHECK(different <= 2);
        }
    }

    TEST_CASE("a patch is not chosen from behind, nor a body from within its piece, nor what is out of view") {
        OccluderCandidates candidates;
        OccluderCandidate patch;  // faces +z
        patch.center = {0, 0, -10};
        patch.radius = 3.0;
        patch.areas[0] = {0, 0, 9};
        patch.front_only = true;
        OccluderCandidate away = patch;
        away.areas[0] = {0, 0, -9};
        Obb box;
        box.half_extents = glm::vec3(1);
        box.center = {2, 0, -10};
        OccluderCandidate body = candidate_of(box), around = body, behind = candidate_of(box);
        around.limits.left_out_within = {glm::dvec3(-1), glm::dvec3(1)};
        behind.center.z = 10.0;
        for (const auto& c : {patch, away, body, around, behind}) REQUIRE(candidates.add(c).has_value());
        OccluderChoice choice;
        REQUIRE(choose_occluders(candidates, Camera{}, {}, choice).has_value());
        CHECK(choice.ids == Vector<std::uint32_t>{0, 2});
        Camera outside;
        outside.position = {0, 0, 1.5};
        REQUIRE(choose_occluders(candidates, outside, {}, choice).has_value());
        CHECK(choice.ids == Vector<std::uint32_t>{0, 2, 3});
        outside.position.z = 1.15;  // outside, but a corner of the near plane may be inside: it is 0.16 away
        REQUIRE(choose_occluders(candidates, outside, {}, choice).has_value());
        CHECK(choice.ids == Vector<std::uint32_t>{0, 2});
        outside.position.z = 1.17;
        REQUIRE(choose_occluders(candidates, outside, {}, choice).has_value());
        CHECK(choice.ids == Vector<std::uint32_t>{0, 2, 3});
        outside.projection = Projection::orthographic;
        REQUIRE(choose_occluders(candidates, outside, {}, choice).has_value());
        CHECK(choice.ids == Vector<std::uint32_t>{0, 2, 3});
        outside.position.z = 1.05;  // the near plane cuts what it lies in
        REQUIRE(choose_occluders(candidates, outside, {}, choice).has_value());
        CHECK(choice.ids == Vector<std::uint32_t>{0, 2});
    }

    TEST_CASE("an occluder with an open side is used by eyes and parallel views that the side does not let in") {
        FoundOccluder found;  // a box [−1, 1]³, open above y = 1, moved to (10, 0, 0) and turned upright: y is world z
        found.box.half_extents = glm::vec3(1);
        found.surface.positions = {glm::vec3(-1), glm::vec3(1)};
        found.piece_bounds = {glm::dvec3(-1), glm::dvec3(1)};
        found.eyes_within.max.y = 1.0;
        scene::Transform transform;
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
            scene::Transform transform;
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

    TEST_CASE("an occluder that a parallel view's near plane cuts by less than rounding tells is not used") {
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

    TEST_CASE("budgets hold, equals come by id, and a changed candidate counts as it is now") {
        OccluderCandidates candidates;
        Obb box;
        box.half_extents = glm::vec3(1);
        box.center = {0, 0, -20};
        for (int i = 0; i < 100; ++i) REQUIRE(candidates.add(candidate_of(box)).has_value());
        OccluderChoice choice;
        REQUIRE(choose_occluders(candidates, Camera{}, {.max_occluders = 5}, choice).has_value());
        CHECK(choice.ids == Vector<std::uint32_t>{0, 1, 2, 3, 4});
        REQUIRE(choose_occluders(candidates, Camera{}, {.max_edges = 40}, choice).has_value());
        CHECK(choice.ids == Vector<std::uint32_t>{0, 1, 2});
        REQUIRE(choose_occluders(candidates, Camera{}, {.max_occluders = 0}, choice).has_value());
        CHECK(choice.ids.empty());
        box.center.z = -5.0;
        REQUIRE(candidates.set(77, candidate_of(box)).has_value());
        REQUIRE(choose_occluders(candidates, Camera{}, {.max_occluders = 2}, choice).has_value());
        CHECK(choice.ids == Vector<std::uint32_t>{77, 0});
        choose_occluders(candidates, *occlusion_view_of(Camera{}), {.max_occluders = 3}, choice);
        CHECK(choice.ids == Vector<std::uint32_t>{77, 0, 1});
    }

    TEST_CASE("all instruction sets choose the same, and nothing is allocated once warm") {
        std::mt19937_64 random(2);
        OccluderCandidates candidates;
        for (int i = 0; i < 3001; ++i) REQUIRE(candidates.add(random_candidate(random, glm::dvec3(0))).has_value());
        OccluderChoice choice;
        for (int trial = 0; trial < 10; ++trial) {
            const Camera camera = random_camera(random, glm::dvec3(0));
            Vector<std::uint32_t> first;
            const std::int64_t targets = hwy::SupportedTargets();
            for (std::int64_t rest = targets; rest != 0; rest &= rest - 1) {
                hwy::SetSupportedTargetsForTest(rest & -rest);
                REQUIRE(choose_occluders(candidates, camera, {}, choice).has_value());
                if (rest == targets) first = choice.ids;
                CHECK(choice.ids == first);
            }
            hwy::SetSupportedTargetsForTest(0);
        }
        // Keys of all candidates, whatever the views above saw.
        choice.order.reserve(candidates.size());
        choice.ids.reserve(256);
        const CountingMemory memory;
        for (int trial = 0; trial < 10; ++trial)
            REQUIRE(choose_occluders(candidates, random_camera(random, glm::dvec3(0)), {}, choice).has_value());
        CHECK(memory.allocations() == 0);
    }

    TEST_CASE("a found occluder's candidate: its area is what Cauchy says, wherever it stands, also mirrored") {
        TriangleMesh mesh;  // a quad that faces +z
        mesh.positions = {{0, 0, 0}, {2, 0, 0}, {2, 3, 0}, {0, 3, 0}};
        mesh.indices = {0, 1, 2, 0, 2, 3};
        const auto found = find_occluders(mesh);
        REQUIRE(found.has_value());
        REQUIRE(found->occluders.size() == 1);
        scene::Transform transform;
        transform.translation = {5, 6, 7};
        transform.linear = 2.0 * glm::dmat3(1.0);
        OccluderCandidate c = candidate_of(found->occluders[0], transform);
        CHECK(c.areas[0] == glm::vec3(0, 0, 24));
        CHECK(c.front_only);
        CHECK(c.center == glm::dvec3(7, 9, 7));
        CHECK(c.radius == doctest::Approx(std::sqrt(13.0)));
        transform.linear[0][0] = -2.0;
        c = candidate_of(found->occluders[0], transform);
        CHECK(c.areas[0] == glm::vec3(0, 0, 24));  // mirrored left to right it still faces +z
    }

    TEST_CASE("a patch that is closed counts as a box of its mean shadows, from all sides") {
        FoundOccluder found;  // a box of 0.3 by 0.7 by 1.1
        found.kind = OccluderKind::patch;
        found.sides = Sides::front;
        for (unsigned i = 0; i < 8; ++i)
            found.surface.positions.push_back(
                glm::vec3((i & 1u) != 0 ? 0.3f : 0.0f, (i & 2u) != 0 ? 0.7f : 0.0f, (i & 4u) != 0 ? 1.1f : 0.0f));
        found.surface.indices = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
        const OccluderCandidate box = candidate_of(found, {});
        const double sizes[3] = {0.3, 0.7, 1.1};
        for (int k = 0; k < 3; ++k) {
            glm::vec3 area = box.areas[static_cast<std::size_t>(k)];
            CHECK(area[k] == doctest::Approx(sizes[(k + 1) % 3] * sizes[(k + 2) % 3]));
            area[k] = 0.0f;
            CHECK(area == glm::vec3(0));
        }
        CHECK_FALSE(box.front_only);
        CHECK(box.radius == doctest::Approx(0.5 * std::sqrt(0.09 + 0.49 + 1.21)));
    }

    TEST_CASE("a surface with a part that is turned away from the rest may be chosen from behind the rest") {
        TriangleMesh mesh;  // a wall of 2 by 3 that faces +z, and one of 0.125 by 3 at its right end that faces −x
        mesh.positions = {{0, 0, 0}, {2, 0, 0}, {2, 3, 0}, {0, 3, 0}, {2, 0, 0.125f}, {2, 3, 0.125f}};
        mesh.indices = {0, 1, 2, 0, 2, 3, 1, 4, 5, 1, 5, 2};
        for (std::size_t t = 6; t < 12; t += 3) std::swap(mesh.indices[t], mesh.indices[t + 1]);
        const auto found = find_occluders(mesh, {.max_occluders = 0, .level_triangles = 48});
        REQUIRE(found.has_value());
        REQUIRE(found->occluders.size() == 1);
        const OccluderCandidate bent = candidate_of(found->occluders[0], {});
        CHECK(bent.areas[0].z == doctest::Approx(6.0));
        CHECK_FALSE(bent.front_only);
        FoundOccluder flat = found->occluders[0];
        flat.surface.indices.resize(6);
        CHECK(candidate_of(flat, {}).front_only);
        CHECK_FALSE(candidate_of(find_occluders(mesh, {.sides = Sides::both})->occluders[0], {}).front_only);
    }
}
