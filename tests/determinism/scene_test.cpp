// SPDX-License-Identifier: MIT
// Scenes and their bakes in the same bits everywhere.
#include <crofton/bake/baked_scene.hpp>
#include <crofton/scene/scene.hpp>

#include "crowd.hpp"
#include "digest.hpp"
#include "everywhere.hpp"

using namespace crofton;
using namespace crofton::test;

namespace {

// A chain of turned, stretched and mirrored nodes, then a third of them moved.
scene::Scene moving_scene(Executor& executor) {
    scene::Scene scene;
    Random random(81);
    const auto mesh = *scene.add_mesh(torus(12, 6, 0.2), "torus");
    std::vector<scene::NodeId> nodes;
    const auto transform = [&] {
        Transform local{sampling::rotation(random.point<3>()), 5.0 * sampling::direction(random.point<2>())};
        if (index(random, 3) == 0) local.linear[0] *= -1.5;
        return local;
    };
    for (int i = 0; i < 200; ++i) {
        const scene::NodeId parent = i < 20 ? scene::kNone : nodes[index(random, static_cast<std::uint32_t>(i))];
        nodes.push_back(*scene.add_node(parent, transform()));
        (void)scene.add_instance(nodes.back(), mesh);
    }
    scene.update(executor);
    for (std::size_t i = 0; i < nodes.size(); i += 3) (void)scene.set_local(nodes[i], transform());
    scene.update(executor);
    return scene;
}

std::uint64_t baked(Executor& executor) {
    const scene::Scene scene = moving_scene(executor);
    Digest digest;
    digest.add(scene.world_boxes());
    const Vector<std::byte> file = *bake::bake(scene, executor);
    for (const std::byte byte : file) digest.add(static_cast<std::uint8_t>(byte));
    return digest.value();
}

}  // namespace

TEST_SUITE("determinism/scene") {
    TEST_CASE("world boxes and baked files are the same bytes everywhere") {
        check_everywhere(0x4497ce4a45189b58, [](Executor& e) { return baked(e); });
    }

    TEST_CASE("the published box contains every vertex, up to rounding") {
        const scene::Scene scene = moving_scene(serial_executor());
        const TriangleMesh mesh = torus(12, 6, 0.2);
        for (scene::InstanceId i = 0; i < scene.instance_count(); ++i) {
            const Transform& world = scene.world(static_cast<scene::NodeId>(i));
            for (const glm::vec3& p : mesh.positions) CHECK(contains(scene.world_boxes()[i], world * glm::dvec3(p)));
        }
    }
}
