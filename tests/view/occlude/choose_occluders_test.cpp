// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
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

#include "shape/collide/random_boxes.hpp"

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

    TEST_CASE("a box's candidate has the areas of its faces along its axes, and the sphere around its corners") {
        std::mt19937_64 random(8);
        for (int i = 0; i < 20; ++i) {
            const Obb box = random_box(random, 10.0);
            const OccluderCandidate candidate = candidate_of(box);
            const glm::vec3& h = box.half_extents;
            const float faces[3] = {4.0f * h.y * h.z, 4.0f * h.z * h.x, 4.0f * h.x * h.y};
            for (std::size_t k = 0; k < 3; ++k)
                CHECK(glm::distance(candidate.areas[k], faces[k] * box.axes[static_cast<int>(k)]) <= 1e-6f * faces[k]);
            CHECK(candidate.radius == doctest::Approx(double{glm::length(h)}).epsilon(1e-6));
            CHECK(candidate.center == box.center);
        }
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

    TEST_CASE(
        "candidates that get limits, lose them and get others are used where their limits allow it, also once "
        "cleared") {
        std::mt19937_64 random(12);
        const auto random_limits = [&](OccluderCandidate& candidate) {
            EyeLimits& limits = candidate.limits;
            limits = {};
            if (random() % 3 == 0) return;
            limits.left_out_within = {20.0 * random_vector(random) - 60.0, 20.0 * random_vector(random) + 60.0};
            const auto plane = [&] { return Plane{random_vector(random), 2.0 * random_vector(random).x}; };
            if (random() % 2) limits.piece_sides[limits.piece_side_count++] = plane();
            if (random() % 3 == 0) limits.planes[limits.plane_count++] = plane();
        };
        OccluderCandidates candidates;
        std::size_t used = 0, left_out = 0;
        for (int life = 0; life < 3; ++life) {
            candidates.clear();
            std::vector<OccluderCandidate> given;
            for (int i = 0; i < 600; ++i) {
                given.push_back(random_candidate(random, glm::dvec3(0.0)));
                random_limits(given.back());
                REQUIRE(candidates.add(given.back()).has_value());
            }
            for (int step = 0; step < 10; ++step) {
                for (int change = 0; change < 200; ++change) {
                    const auto id = static_cast<std::uint32_t>(random() % given.size());
                    random_limits(given[id]);
                    REQUIRE(candidates.set(id, given[id]).has_value());
                }
                // Without limits all of them would be chosen, but for those that are worth nothing.
                const Camera camera = random_camera(random, glm::dvec3(0.0));
                const ChooseBudget budget{.max_occluders = 600, .max_edges = 1'000'000};
                OccluderCandidates unlimited;
                for (OccluderCandidate candidate : given) {
                    candidate.limits = {};
                    REQUIRE(unlimited.add(candidate).has_value());
                }
                OccluderChoice choice, all;
                REQUIRE(choose_occluders(candidates, camera, budget, choice).has_value());
                REQUIRE(choose_occluders(unlimited, camera, budget, all).has_value());
                Vector<std::uint32_t> expected;
                for (const std::uint32_t id : all.ids)
                    if (may_use(given[id].limits, camera)) expected.push_back(id);
                CHECK(choice.ids == expected);
                used += expected.size();
                left_out += all.ids.size() - expected.size();
            }
        }
        CHECK(used > 300);
        CHECK(left_out > 300);
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
        Transform transform;
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
    TEST_CASE("the ten thousandth occluder takes no more memory at once than the first") {
        // Arrays that double copy all that they have: 80 ms for the last of 262,000 occluders.
        std::mt19937_64 random(12);
        CountingMemory memory;
        OccluderCandidates candidates;
        OccluderSet set;
        std::size_t most = 0;
        Vector<OccluderId> ids;
        ids.reserve(10000);
        for (int i = 0; i < 10000; ++i) {
            const std::size_t before = memory.bytes_taken();
            const Obb box = random_box(random, 200.0);
            ids.push_back(set.place(box).value());
            REQUIRE(candidates.add(candidate_of(box)));
            most = std::max(most, memory.bytes_taken() - before);
        }
        CHECK(most < 400'000);
        const std::size_t taken = memory.bytes_taken();
        for (const OccluderId id : ids) REQUIRE(set.remove(id));
        for (std::size_t i = ids.size(); i-- > 0;) CHECK(set.place(random_box(random, 200.0)).value() == ids[i]);
        CHECK(memory.bytes_taken() == taken);
    }
}
