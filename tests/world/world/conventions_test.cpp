// SPDX-License-Identifier: MIT
// Which engines a World fits: any handedness, any axis up, any unit.
#include <doctest/doctest.h>
#include <crofton/crofton.hpp>
#include <glm/matrix.hpp>
#include <oracle/random_boxes.hpp>
#include <vector>

#include "../../view_request.hpp"

using namespace crofton;

namespace {

// From right-handed metres with y up to left-handed centimetres with z up.
const glm::dmat3 kSwap({1, 0, 0}, {0, 0, 1}, {0, 1, 0});
constexpr double kUnit = 100.0;

Transform converted(const Transform& t) {
    return {kSwap * t.linear * kSwap, kUnit * (kSwap * t.translation)};
}

struct Answers {
    std::vector<std::uint32_t> visible;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    std::vector<std::uint32_t> contacts, overlapping;
    std::vector<std::pair<std::uint32_t, double>> hits;
    std::vector<glm::dvec3> normals;
};

}  // namespace

TEST_SUITE("world/conventions") {
    TEST_CASE("a left-handed world with z up, in centimetres, gets the same answers") {
        oracle::NearMisses random(31);
        World ours, theirs;
        // A brick: of a rounder shape either world may choose another of equally good boxes.
        TriangleMesh mesh;
        for (int i = 0; i < 8; ++i)
            mesh.positions.push_back({i & 1 ? 1.0f : -1.0f, i & 2 ? 0.6f : -0.6f, i & 4 ? 0.3f : -0.3f});
        mesh.indices = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                        2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
        TriangleMesh swapped = mesh;
        for (glm::vec3& p : swapped.positions) p = glm::vec3(kUnit * (kSwap * glm::dvec3(p)));
        // Outside is where cross(b - a, c - a) points: clockwise triangles, as left-handed engines have them.
        for (std::size_t t = 0; t < swapped.indices.size(); t += 3)
            std::swap(swapped.indices[t + 1], swapped.indices[t + 2]);
        const auto our_mesh = ours.add_mesh({.positions = mesh.positions, .indices = mesh.indices}).value();
        const auto their_mesh = theirs.add_mesh({.positions = swapped.positions, .indices = swapped.indices}).value();
        for (int i = 0; i < 200; ++i) {
            const glm::dvec3 toward = random.direction();
            const glm::dvec3 place = random.number(2.0, 12.0) * toward;
            if (i % 4 == 0) {
                REQUIRE(ours.add({.bound = Sphere{place, 0.7}}).has_value());
                REQUIRE(theirs.add({.bound = Sphere{kUnit * (kSwap * place), kUnit * 0.7}}).has_value());
                continue;
            }
            const glm::dvec3 axis = random.direction();
            const double angle = random.number(0.0, 3.0);
            Transform transform{glm::mat3_cast(glm::dquat(std::cos(angle), std::sin(angle) * axis)), place};
            transform.linear *= i % 3 ? 1.0 : 1.5;
            REQUIRE(ours.add({.mesh = our_mesh, .transform = transform}).has_value());
            REQUIRE(theirs.add({.mesh = their_mesh, .transform = converted(transform)}).has_value());
        }
        REQUIRE(ours.update().has_value());
        REQUIRE(theirs.update().has_value());

        const auto ask = [](const World& world, const cull::View& view, const Ray& ray, const Sphere& sphere) {
            Answers answers;
            ViewResult visible;
            (void)world.view(request_of(view), visible);
            answers.visible.assign(visible.ids().begin(), visible.ids().end());
            for (const ObjectPair& pair : world.pairs())
                answers.pairs.emplace_back(pair.first.object.index, pair.second.object.index);
            for (const Contact& contact : world.contacts()) {
                answers.contacts.push_back(static_cast<std::uint32_t>(contact.triangles.size()));
                answers.normals.push_back(contact.normal);
            }
            Vector<ObjectHit> hits;
            world.raycast_all(ray, hits);
            for (const ObjectHit& hit : hits) answers.hits.emplace_back(hit.triangle, hit.t);
            Vector<ObjectRef> found;
            world.overlap(sphere, found);
            for (const ObjectRef& object : found) answers.overlapping.push_back(object.object.index);
            return answers;
        };
        std::size_t seen = 0, hit = 0;
        for (int query = 0; query < 50; ++query) {
            Camera camera;
            camera.position = 15.0 * random.direction();
            camera.forward = random.direction() - 0.1 * camera.position;
            // Their engine's matrix: from its coordinates to the same clip space.
            glm::dmat4 to_ours(kSwap / kUnit);
            to_ours[3][3] = 1.0;
            const glm::dmat4 to_clip = world_to_clip(camera);
            const cull::View our_view{.frustum = frustum_of(to_clip, DepthRange::reversed_zero_to_one).value()};
            const cull::View their_view{.frustum =
                                            frustum_of(to_clip * to_ours, DepthRange::reversed_zero_to_one).value()};
            const Ray ray{camera.position, camera.forward};
            const Sphere sphere{5.0 * random.direction(), 3.0};
            const Answers a = ask(ours, our_view, ray, sphere);
            const Answers b = ask(theirs, their_view, {kUnit * (kSwap * ray.origin), kUnit * (kSwap * ray.direction)},
                                  {kUnit * (kSwap * sphere.center), kUnit * sphere.radius});
            CHECK(a.visible == b.visible);
            CHECK(a.pairs == b.pairs);
            CHECK(a.contacts == b.contacts);
            CHECK(a.overlapping == b.overlapping);
            REQUIRE(a.hits.size() == b.hits.size());
            for (std::size_t i = 0; i < a.hits.size(); ++i) {
                CHECK(a.hits[i].first == b.hits[i].first);
                CHECK(a.hits[i].second == doctest::Approx(b.hits[i].second).epsilon(1e-5));
            }
            REQUIRE(a.normals.size() == b.normals.size());
            for (std::size_t i = 0; i < a.normals.size(); ++i)
                CHECK(glm::length(kSwap * a.normals[i] - b.normals[i]) < 1e-3);
            seen += a.visible.size();
            hit += a.hits.size();
        }
        CHECK(seen > 500);
        CHECK(hit > 50);
        CHECK(ours.contacts().size() > 20);
    }
}
