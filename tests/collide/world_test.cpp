#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <counting_memory.hpp>
#include <crofton/collide/world.hpp>
#include <crofton/core/thread_pool.hpp>
#include <limits>

#include "mesh/meshes.hpp"

using namespace crofton;
using namespace crofton::collide;
using namespace crofton::mesh;
using namespace crofton::testing;

namespace {

struct Stage {
    scene::Scene scene;
    std::vector<scene::NodeId> nodes;

    scene::InstanceId add(scene::MeshId mesh, const scene::Transform& place, std::uint32_t layers = ~0u) {
        nodes.push_back(*scene.add_node(scene::kNone, place, layers));
        return *scene.add_instance(nodes.back(), mesh);
    }
};

scene::Transform at(const glm::dvec3& place, const glm::dmat3& linear = glm::dmat3(1.0)) {
    return {linear, place};
}

bool same(std::span<const InstancePair> a, std::span<const InstancePair> b) {
    return std::ranges::equal(a, b, [](const InstancePair& x, const InstancePair& y) {
        return x.instances == y.instances && x.inside == y.inside && x.contact_count == y.contact_count &&
               x.first_contact == y.first_contact;
    });
}

}  // namespace

TEST_SUITE("collide/world") {
    TEST_CASE("an empty scene, removed instances and wrong filters") {
        Stage stage;
        World world;
        stage.scene.update();
        REQUIRE(world.update(stage.scene).has_value());
        CHECK(world.pairs().empty());
        const auto mesh = *stage.scene.add_mesh(wavy_torus(1.0, 0.4, 0.0));
        const auto a = stage.add(mesh, at({0.0, 0.0, 0.0}));
        stage.add(mesh, at({0.5, 0.0, 0.0}));
        stage.scene.update();
        CHECK(world.update(stage.scene, std::vector<Filter>(7)).error().code == ErrorCode::invalid_argument);
        REQUIRE(world.update(stage.scene).has_value());
        CHECK(world.pairs().size() == 1);
        REQUIRE(stage.scene.remove_instance(a).has_value());
        stage.scene.update();
        REQUIRE(world.update(stage.scene).has_value());
        CHECK(world.pairs().empty());
        CHECK(world.ended().size() == 1);
    }

    TEST_CASE("rings through each other meet, a ring through a hole does not, a ball in a ball is inside") {
        Stage stage;
        const auto ring = *stage.scene.add_mesh(wavy_torus(1.0, 0.3, 0.0)),
                   ball = *stage.scene.add_mesh(wavy_torus(0.2, 0.21, 0.0));
        stage.add(ring, at({0.0, 0.0, 0.0}));
        stage.add(ring, at({2.0, 0.0, 0.0}));                    // overlaps 0
        stage.add(ball, at({0.0, 0.0, 0.0}));                    // in the hole of 0
        stage.add(ball, at({10.0, 0.0, 0.0}, glm::dmat3(8.0)));  // large, scaled
        stage.add(ball, at({10.5, 1.2, 0.3}, glm::dmat3(0.5)));  // inside it
        stage.scene.update();
        World world;
        REQUIRE(world.update(stage.scene).has_value());
        REQUIRE(world.pairs().size() == 2);
        CHECK(world.pairs()[0].instances == IdPair{0, 1});
        CHECK(world.pairs()[0].contact_count > 0);
        for (const MeshContact& contact : world.contacts()) {
            CHECK(glm::length(contact.normal) == doctest::Approx(1.0));
            CHECK(std::abs(contact.segment.begin.x - 1.0) < 0.4);
        }
        CHECK(world.pairs()[1].instances == IdPair{3, 4});
        CHECK(world.pairs()[1].inside == Containment::b_inside_a);
        CHECK(world.statistics().trees_built == 4);
        CHECK(world.statistics().mesh_pairs_hit == 2);
        REQUIRE(world.update(stage.scene).has_value());
        CHECK(world.statistics().trees_built == 0);
        CHECK(world.stayed().size() == 2);
        CHECK(world.began().empty());
    }

    TEST_CASE("layers and filters keep instances apart") {
        Stage stage;
        const auto ring = *stage.scene.add_mesh(wavy_torus(1.0, 0.3, 0.0));
        for (const std::uint32_t layers : {1u, 2u, 3u}) stage.add(ring, at({0.1 * layers, 0.0, 0.0}), layers);
        stage.scene.update();
        World world;
        REQUIRE(world.update(stage.scene).has_value());
        CHECK(world.pairs().size() == 2);  // not 0 with 1
        std::vector<Filter> filters(3);
        filters[0].collides_with = 2;
        REQUIRE(world.update(stage.scene, filters).has_value());
        CHECK(world.pairs().empty());
    }

    TEST_CASE("a moving scene gives the same pairs and contacts with any number of threads") {
        std::mt19937_64 random(8);
        Stage stage;
        const auto ring = *stage.scene.add_mesh(wavy_torus(1.0, 0.3, 0.2, 16, 8)),
                   ball = *stage.scene.add_mesh(wavy_torus(0.2, 0.3, 0.1, 10, 6));
        for (int i = 0; i < 60; ++i)
            stage.add(i % 2 ? ring : ball,
                      at(4.0 * random_vector(random), glm::mat3_cast(random_rotation(random)) * (i % 3 ? 1.0 : 0.7)));
        World serial, parallel;
        ThreadPool pool(3);
        for (int frame = 0; frame < 5; ++frame) {
            stage.scene.update();
            REQUIRE(serial.update(stage.scene).has_value());
            REQUIRE(parallel.update(stage.scene, {}, pool).has_value());
            CHECK(serial.pairs().size() > 5);
            CHECK(same(serial.pairs(), parallel.pairs()));
            CHECK(std::ranges::equal(
                serial.contacts(), parallel.contacts(), [](const MeshContact& x, const MeshContact& y) {
                    return x.triangles == y.triangles && x.segment.begin == y.segment.begin && x.normal == y.normal;
                }));
            for (const scene::NodeId node : stage.nodes) {
                scene::Transform place = stage.scene.local(node);
                place.translation += 0.1 * random_vector(random);
                REQUIRE(stage.scene.set_local(node, place).has_value());
            }
        }
    }

    TEST_CASE("instances with a transform that is not finite are named, and the others collide as without them") {
        Stage stage, clean;
        for (Stage* s : {&stage, &clean}) {
            const auto mesh = *s->scene.add_mesh(wavy_torus(1.0, 0.4, 0.0));
            s->add(mesh, at({0.0, 0.0, 0.0}));
            s->add(mesh, at({0.5, 0.0, 0.0}));
            s->add(mesh, at({9.0, 0.0, 0.0}));
            s->scene.update();
        }
        World world, reference;
        REQUIRE(reference.update(clean.scene).has_value());
        const double nan = std::numeric_limits<double>::quiet_NaN();
        for (const double bad : {nan, std::numeric_limits<double>::infinity()}) {
            const auto refused = stage.scene.set_local(stage.nodes[2], at({bad, 0.0, 0.0}));
            REQUIRE_FALSE(refused.has_value());
            CHECK(refused.error().code == ErrorCode::non_finite);
            CHECK(refused.error().item == stage.nodes[2]);
            scene::Transform turned;
            turned.linear[1][2] = bad;
            CHECK(stage.scene.set_local(stage.nodes[1], turned).error().item == stage.nodes[1]);
        }
        stage.scene.update();
        REQUIRE(world.update(stage.scene).has_value());
        CHECK(same(world.pairs(), reference.pairs()));
        CHECK(world.pairs().size() == 1);
        CHECK(world.rejected().empty());
    }

    TEST_CASE("an instance whose chain of transforms leaves all bounds is hidden, and the others are unharmed") {
        for (const double scale : {1e15, 1e-15}) {
            Stage stage;
            const auto ring = *stage.scene.add_mesh(wavy_torus(1.0, 0.3, 0.0, 12, 8));
            stage.add(ring, at({0.0, 0.0, 0.0}));
            stage.add(ring, at({1.0, 0.0, 0.0}));
            scene::NodeId node = scene::kNone;
            for (int i = 0; i < 30; ++i) node = *stage.scene.add_node(node, at({5.0, 0.0, 0.0}, glm::dmat3(scale)));
            const auto lost = *stage.scene.add_instance(node, ring);
            CHECK(stage.scene.update().instances_invalid == (scale > 1.0 ? 1 : 0));
            CHECK(stage.scene.layer_masks()[lost] == 0);  // too large, or scaled to a point
            World world;
            REQUIRE(world.update(stage.scene).has_value());
            CHECK(world.pairs().size() == 1);
            CHECK(world.rejected().empty());
        }
    }

    TEST_CASE("a mesh that is deformed or replaced collides as what it is now") {
        Stage stage;
        const TriangleMesh near = wavy_torus(1.0, 0.3, 0.0, 12, 8);
        const auto ring = *stage.scene.add_mesh(near);
        const auto other = *stage.scene.add_mesh(near);
        stage.add(ring, at({0.0, 0.0, 0.0}));
        stage.add(other, at({1.0, 0.0, 0.0}));
        World world;
        const auto pairs = [&] {
            stage.scene.update();
            REQUIRE(world.update(stage.scene).has_value());
            return world.pairs().size();
        };
        CHECK(pairs() == 1);
        TriangleMesh far = near;
        for (glm::vec3& p : far.positions) p = 0.1f * p - glm::vec3(1.0f, 0.0f, 0.0f);  // in the ring's hole
        REQUIRE(stage.scene.set_vertices(other, far.positions).has_value());
        CHECK(pairs() == 0);
        REQUIRE(stage.scene.replace_mesh(other, near).has_value());
        CHECK(pairs() == 1);
    }

    TEST_CASE("once warm a moving scene is collided without allocation") {
        const CountingMemory counting;
        Stage stage;
        const auto ring = *stage.scene.add_mesh(wavy_torus(1.0, 0.3, 0.0, 12, 8));
        for (int i = 0; i < 12; ++i) stage.add(ring, at({1.8 * (i % 4), 1.9 * (i / 4), 0.0}));
        World world;
        constexpr int kPeriod = 8;
        const auto run = [&](int frame) {
            for (std::size_t n = 0; n < stage.nodes.size(); ++n) {
                const double shift = 0.05 * double((frame + int(n)) % kPeriod);
                (void)stage.scene.set_local(stage.nodes[n],
                                            at({1.8 * double(n % 4) + shift, 1.9 * double(n / 4), 0.0}));
            }
            stage.scene.update();
            const std::size_t before = counting.allocations();
            REQUIRE(world.update(stage.scene).has_value());
            return counting.allocations() - before;
        };
        CHECK(run(0) > 0);
        for (int frame = 1; frame < 3 * kPeriod; ++frame) (void)run(frame);
        std::size_t later = 0;
        for (int frame = 0; frame < 5 * kPeriod; ++frame) later += run(frame);
        CHECK(later == 0);
        CHECK_FALSE(world.contacts().empty());
    }
}
