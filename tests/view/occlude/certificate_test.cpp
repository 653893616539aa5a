// SPDX-License-Identifier: MIT
// What is called hidden has a proof in rational numbers.
#include <doctest/doctest.h>
#include <crofton/occlude/occlusion.hpp>
#include <oracle/hidden_certificate.hpp>
#include <oracle/occlusion_scenes.hpp>
#include <utility>
#include <vector>

using namespace crofton;
using namespace crofton::test;

namespace {

// Rational arithmetic takes minutes under the sanitizers.
#if defined(__SANITIZE_ADDRESS__)
constexpr std::size_t kSetups = 8;
#else
constexpr std::size_t kSetups = 40;
#endif

// Each into two that overlap, so that much is hidden by two alone.
void split(std::vector<Obb>& boxes) {
    std::vector<Obb> parts;
    for (Obb box : boxes) {
        const glm::dvec3 aside = 0.4 * static_cast<double>(box.half_extents.x) * glm::dvec3(box.axes[0]);
        box.half_extents.x *= 0.6f;
        for (const double side : {-1.0, 1.0}) {
            parts.push_back(box);
            parts.back().center += side * aside;
        }
    }
    boxes = std::move(parts);
}

// Objects of sizes that a certificate takes a few hundred pixels for, behind walls and boxes of all kinds.
OcclusionScene certified_scene(Random& random, double offset, bool in_parts) {
    OcclusionScene scene = random_scene(random, offset, 40);
    scene.size = {48, 32};
    for (int i = 0; i < 2; ++i)
        scene.occluders.push_back(box_at(random, point_in_view(random, scene.camera, 6.0 + i), 1.0, 6.0));
    if (!in_parts) return scene;
    split(scene.occluders);
    for (Obb& object : scene.objects) object.half_extents *= 3.0f;
    return scene;
}

std::vector<Obb> named_by(const occlude::OcclusionBuffer& buffer, const Obb& object, const OcclusionScene& scene) {
    Vector<occlude::OccluderId> ids;
    buffer.hidden_by(object, ids);
    std::vector<Obb> named;
    for (const occlude::OccluderId id : ids) named.push_back(scene.occluders[id]);
    return named;
}

}  // namespace

TEST_SUITE("occlude/certificate") {
    TEST_CASE("each hidden box is proven hidden by the occluders that are named, pixel by pixel, in rationals") {
        Random random(91);
        std::size_t hidden = 0, by_many = 0, visible = 0, visible_proven = 0;
        for (const double offset : {0.0, 1e5, 1e7})
            for (std::size_t trial = 0; trial < kSetups; ++trial) {
                const OcclusionScene scene = certified_scene(random, offset, trial % 2 != 0);
                const auto view = *occlude::occlusion_view_of(scene.camera);
                auto buffer = *occlude::OcclusionBuffer::create(scene.size);
                buffer.draw(set_of(scene.occluders), view);
                const oracle::HiddenCertificate certificate(view, scene.camera.near_distance, scene.size.width,
                                                            scene.size.height);
                for (const Obb& object : scene.objects) {
                    if (buffer.hides(object)) {
                        const std::vector<Obb> named = named_by(buffer, object, scene);
                        CHECK(certificate.proves(object, named));
                        ++hidden;
                        by_many += named.size() > 1;
                        continue;
                    }
                    const Frustum& frustum = view.frustum;
                    if (!is_in_view(frustum, object.center)) continue;
                    ++visible;
                    visible_proven += certificate.proves(object, scene.occluders);
                }
            }
        MESSAGE(hidden << " hidden, " << by_many << " by several; " << visible_proven << " of " << visible
                       << " visible ones have a proof, too");
        CHECK(hidden > 12 * kSetups);
        CHECK(by_many > kSetups / 4);
        CHECK(visible > 12 * kSetups);
        CHECK(visible_proven < visible / 4);
    }

    TEST_CASE("there is no proof for what is seen past an edge, before a wall or in a gap") {
        Camera camera;
        const auto view = *occlude::occlusion_view_of(camera);
        const oracle::HiddenCertificate certificate(view, camera.near_distance, 48, 32);
        const auto box = [](double x, double z, float half) {
            Obb result;
            result.center = {x, 0.0, z};
            result.half_extents = glm::vec3(half);
            return result;
        };
        const std::vector<Obb> wall = {box(0.0, -10.0, 3.0f)};
        CHECK(certificate.proves(box(0.0, -20.0, 1.0f), wall));
        CHECK_FALSE(certificate.proves(box(8.0, -20.0, 1.0f), wall));
        CHECK_FALSE(certificate.proves(box(0.0, -6.5, 0.1f), wall));
        CHECK_FALSE(certificate.proves(box(0.0, -20.0, 1.0f), {}));
        const std::vector<Obb> walls = {box(-3.001, -10.0, 3.0f), box(3.001, -10.0, 3.0f)};
        CHECK_FALSE(certificate.proves(box(0.0, -20.0, 0.1f), walls));
    }
}
