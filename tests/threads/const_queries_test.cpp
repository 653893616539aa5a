// SPDX-License-Identifier: MIT
// Const calls from many threads on one object: the answers of one thread alone, and no race that a sanitizer sees.
#include <doctest/doctest.h>
#include <atomic>
#include <crofton/bake/baked_scene.hpp>
#include <crofton/collide/broadphase.hpp>
#include <crofton/convex/query.hpp>
#include <crofton/crofton.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/mesh/mesh_distance.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <cstring>
#include <functional>
#include <memory>
#include <oracle/random_boxes.hpp>
#include <string>
#include <thread>
#include <vector>

using namespace crofton;
using oracle::NearMisses;

namespace {

constexpr int kThreads = 6, kQuestions = 24;

// An answer as bytes, so that any two can be compared.
class Answer {
  public:
    template <class T>
    Answer& add(const T& value) {
        static_assert(std::is_trivially_copyable_v<T> && std::has_unique_object_representations_v<T>);
        return append(&value, sizeof value);
    }
    Answer& add(double value) { return append(&value, sizeof value); }
    template <class T>
    Answer& add_all(std::span<const T> values) {
        add(values.size());
        return append(values.data(), values.size_bytes());
    }
    bool operator==(const Answer&) const = default;

  private:
    Answer& append(const void* data, std::size_t size) {
        if (size > 0) bytes_.append(static_cast<const char*>(data), size);
        return *this;
    }
    std::string bytes_;
};

using Questions = std::function<Answer(int question)>;

// Every thread asks all questions, each beginning elsewhere; `asker` makes what a thread keeps for itself.
void check(const std::function<Questions()>& asker) {
    std::vector<Answer> expected;
    const Questions alone = asker();
    for (int q = 0; q < kQuestions; ++q) expected.push_back(alone(q));
    std::atomic<int> wrong{0}, ready{0};
    std::vector<std::thread> threads;
    for (int t = 0; t < kThreads; ++t)
        threads.emplace_back([&, t] {
            const Questions ask = asker();
            ++ready;
            while (ready < kThreads) std::this_thread::yield();
            for (int q = 0; q < kQuestions; ++q) {
                const int question = (q + t * 5) % kQuestions;
                wrong += ask(question) != expected[static_cast<std::size_t>(question)];
            }
        });
    for (std::thread& thread : threads) thread.join();
    CHECK(wrong == 0);
}

Camera camera_of(int question) {
    NearMisses random(1000 + static_cast<std::uint64_t>(question));
    Camera camera;
    camera.position = 30.0 * random.direction();
    camera.forward = glm::normalize(-camera.position + 10.0 * random.direction());
    camera.up = random.direction();
    camera.far_distance = 80.0;
    return camera;
}
Ray ray_of(int question) {
    NearMisses random(2000 + static_cast<std::uint64_t>(question));
    Ray ray;
    ray.origin = 40.0 * random.direction();
    ray.direction = -ray.origin + 12.0 * random.direction();
    return ray;
}
Obb box_of(int question) {
    NearMisses random(3000 + static_cast<std::uint64_t>(question));
    return oracle::random_box(random, glm::dvec3(0.0), 30.0);
}

TriangleMesh bumpy(std::uint32_t n) {
    TriangleMesh mesh;
    NearMisses random(7);
    for (std::uint32_t y = 0; y <= n; ++y)
        for (std::uint32_t x = 0; x <= n; ++x)
            mesh.positions.emplace_back(static_cast<float>(x), static_cast<float>(y),
                                        static_cast<float>(random.number(0.0, 2.0)));
    for (std::uint32_t y = 0; y < n; ++y)
        for (std::uint32_t x = 0; x < n; ++x) {
            const std::uint32_t a = y * (n + 1) + x, b = a + n + 1;
            for (const std::uint32_t i : {a, a + 1, b, b, a + 1, b + 1}) mesh.indices.push_back(i);
        }
    return mesh;
}

}  // namespace

TEST_SUITE("threads/const_queries") {
    TEST_CASE("a changed tree answers views, shapes and rays, and can be stored") {
        oracle::Crowd crowd = oracle::random_crowd(3000, 0.0, 5);
        auto tree = *boxtree::BoxTree::build(crowd.boxes, crowd.layers);
        for (boxtree::ItemId i = 0; i < 500; ++i) REQUIRE(tree.move(i, box_of(static_cast<int>(i))).has_value());
        tree.refit();
        const boxtree::BoxTree& shared = tree;
        check([&]() -> Questions {
            auto visible = std::make_shared<cull::VisibleSet>();
            auto many = std::make_shared<cull::MaskedVisibleSet>();
            return [&, visible, many](int q) {
                Answer answer;
                const cull::View view{*frustum_of(camera_of(q)), ~0u};
                cull::find_visible(shared, view, *visible);
                answer.add_all(visible->ids());
                const std::vector<cull::View> views = {view, {*frustum_of(camera_of(q + 1)), 3u}};
                (void)cull::find_visible(shared, views, *many);
                answer.add_all(many->ids());
                Vector<boxtree::ItemId> items;
                collide::overlapping(shared, box_of(q), items);
                answer.add_all(std::span<const boxtree::ItemId>(items));
                if (const auto hit = collide::raycast(ray_of(q), shared)) answer.add(hit->t).add(hit->item);
                answer.add(shared.item_count());
                if (q % 12 == 0) answer.add(shared.validate().has_value()).add(shared.serialise().size());
                return answer;
            };
        });
    }

    TEST_CASE("packed lists of boxes, and of moving boxes") {
        const oracle::Crowd crowd = oracle::random_crowd(2000, 0.0, 6);
        cull::BoxSet set;
        set.assign(crowd.boxes);
        std::vector<boxtree::ItemId> movers;
        for (boxtree::ItemId i = 0; i < 200; ++i) movers.push_back(i);
        boxtree::BuildOptions options;
        options.detached = movers;
        const auto tree = *boxtree::BoxTree::build(crowd.boxes, crowd.layers, options);
        cull::MovingBoxes moving;
        REQUIRE(moving.update(tree, movers, std::span(crowd.boxes).first(200)).has_value());
        check([&]() -> Questions {
            auto bits = std::make_shared<cull::VerdictBits>();
            auto visible = std::make_shared<cull::VisibleSet>();
            return [&, bits, visible](int q) {
                const cull::View view{*frustum_of(camera_of(q)), ~0u};
                cull::find_visible<Obb>(set, crowd.boxes, view, *bits);
                cull::find_visible(tree, moving, view, *visible);
                return Answer()
                    .add_all(std::span<const std::uint64_t>(bits->visible))
                    .add_all(std::span<const std::uint64_t>(bits->inside))
                    .add_all(visible->ids());
            };
        });
    }

    TEST_CASE("meshes: rays with and without their own hierarchy, contacts, distances") {
        const auto a = *mesh::MeshTree::build(bumpy(20)), b = *mesh::MeshTree::build(bumpy(20), {.rays = true});
        check([&]() -> Questions {
            return [&](int q) {
                Answer answer;
                Ray ray = ray_of(q);
                ray.direction += glm::dvec3(10.0, 10.0, 1.0);
                for (const mesh::MeshTree* tree : {&a, &b})
                    if (const auto hit = mesh::raycast(ray, *tree)) answer.add(hit->t).add(hit->triangle);
                RigidTransform pose;
                pose.translation = {0.3 * q, -0.2 * q, 0.15 * q};
                Vector<mesh::TrianglePair> pairs;
                mesh::intersecting_triangles(a, b, pose, pairs);
                answer.add_all(std::span<const mesh::TrianglePair>(pairs));
                return answer.add(mesh::distance(a, b, pose).distance).add(mesh::contains(a, pose.translation));
            };
        });
    }

    TEST_CASE("convex shapes share a hull") {
        NearMisses random(9);
        std::vector<glm::vec3> points;
        for (int i = 0; i < 60; ++i) points.emplace_back(random.direction());
        const auto hull = *convex::Hull::build(points);
        const convex::Shape shape = convex::Shape::hull(hull);
        check([&]() -> Questions {
            auto cache = std::make_shared<convex::PairCache>();
            return [&, cache](int q) {
                *cache = {};  // the pair is a new one
                RigidTransform here, there;
                there.translation = {0.08 * q, 0.5, 0.25};
                const convex::Distance d = convex::distance({shape, here}, {shape, there}, cache.get());
                const convex::Manifold m = convex::contact_manifold({shape, here}, {shape, there}, {}, cache.get());
                return Answer().add(d.distance).add(m.depth).add(m.count);
            };
        });
    }

    TEST_CASE("a buffer of occluders, and the set that many views draw from") {
        NearMisses random(10);
        occlude::OccluderSet set;
        for (int i = 0; i < 60; ++i) REQUIRE(set.place(oracle::random_box(random, glm::dvec3(0.0), 20.0)).has_value());
        const oracle::Crowd crowd = oracle::random_crowd(800, 0.0, 11);
        const auto tree = *boxtree::BoxTree::build(crowd.boxes, crowd.layers);
        auto shared = *occlude::OcclusionBuffer::create({160, 90});
        shared.draw(set, *occlude::occlusion_view_of(camera_of(3)));
        check([&]() -> Questions {
            auto own = std::make_shared<occlude::OcclusionBuffer>(*occlude::OcclusionBuffer::create({160, 90}));
            auto visible = std::make_shared<occlude::VisibleSet>();
            return [&, own, visible](int q) {
                own->draw(set, *occlude::occlusion_view_of(camera_of(q)));
                Answer answer;
                answer.add(own->count_covered());
                occlude::find_visible(tree, shared, *visible);
                answer.add_all(visible->ids());
                for (std::size_t i = 0; i < 100; ++i) answer.add(shared.hides(crowd.boxes[i]));
                return answer;
            };
        });
    }

    TEST_CASE("a world with meshes, bounds and occluders answers views, rays and shapes") {
        World world({.updates_to_rest = 2});
        const TriangleMesh mesh = bumpy(10);
        const auto id =
            world.add_mesh({.positions = mesh.positions, .indices = mesh.indices, .occluders = true}).value();
        NearMisses random(12);
        std::vector<ObjectHandle> objects;
        for (int i = 0; i < 400; ++i) {
            ObjectDescription description;
            if (i % 8 == 0) {
                description.mesh = id;
                description.transform = Transform{glm::dmat3(1.0), 25.0 * random.direction()};
            } else {
                description.bound = oracle::random_box(random, glm::dvec3(0.0), 30.0);
            }
            description.user = static_cast<std::uint64_t>(i);
            objects.push_back(*world.add(description));
        }
        for (int frame = 0; frame < 4; ++frame) {
            for (std::size_t i = 1; i < 50; i += 8)
                REQUIRE(world.set_bound(objects[i], oracle::random_box(random, glm::dvec3(0.0), 30.0)).has_value());
            REQUIRE(world.update().has_value());
        }
        const World& shared = world;
        check([&]() -> Questions {
            auto visible = std::make_shared<ViewResult>();
            return [&, visible](int q) {
                Answer answer;
                answer.add(shared.view({.camera = camera_of(q)}, *visible).has_value());
                answer.add_all(visible->ids());
                answer.add(
                    shared.view({.camera = camera_of(q), .occlusion = OcclusionOptions{.size = {96, 54}}}, *visible)
                        .has_value());
                answer.add_all(visible->ids());
                if (const auto hit = shared.raycast(ray_of(q))) answer.add(hit->t).add(hit->user);
                Vector<ObjectRef> found;
                shared.overlap(box_of(q), found);
                for (const ObjectRef& object : found) answer.add(object.user);
                if (const auto closest = shared.closest(box_of(q), 100.0))
                    answer.add(closest->distance).add(closest->user);
                return answer.add(shared.pairs().size()).add(shared.contacts().size());
            };
        });
    }

    TEST_CASE("a scene and what was baked of it") {
        scene::Scene scene;
        const auto id = *scene.add_mesh(bumpy(4), "mesh");
        for (int i = 0; i < 60; ++i) {
            Transform place;
            place.translation = box_of(i).center;
            const auto node = *scene.add_node(scene::kNone, place, ~0u, "node");
            REQUIRE(scene.add_instance(node, id).has_value());
        }
        scene.update();
        const scene::Scene& shared = scene;
        const auto bytes = *bake::bake(shared);
        const auto baked = *bake::BakedScene::from_memory(bytes);
        check([&]() -> Questions {
            auto visible = std::make_shared<cull::VisibleSet>();
            return [&, visible](int q) {
                Answer answer;
                cull::find_visible(baked.tree(), {*frustum_of(camera_of(q)), ~0u}, *visible);
                answer.add_all(visible->ids());
                cull::find_visible(shared.world_boxes(), shared.layer_masks(), {*frustum_of(camera_of(q)), ~0u},
                                   *visible);
                answer.add_all(visible->ids()).add(baked.mesh(id).positions.size());
                if (q % 12 == 0) answer.add_all(std::span<const std::byte>(*bake::bake(shared)));
                return answer;
            };
        });
    }
}
