// SPDX-License-Identifier: MIT
// Executors, trace hooks and log handlers that call the World back, while it is updated or viewed.
#include <doctest/doctest.h>
#include <box_mesh.hpp>
#include <crofton/convex/query.hpp>
#include <crofton/crofton.hpp>
#include <crofton/world/object_manifold.hpp>
#include <functional>
#include <thread>
#include <vector>

#include "box_at.hpp"

using namespace crofton;
using testing::box_at;

namespace {

const convex::Shape kBall = convex::Shape::sphere(0.6).value();

// A serial executor that calls back before its work.
class Calling : public Executor {
  public:
    explicit Calling(std::function<void()> back) : back_(std::move(back)) {}
    [[nodiscard]] unsigned concurrency() const override { return 1; }
    void parallel_for(std::size_t count, std::size_t grain, RangeTask body) override {
        back_();
        serial_executor().parallel_for(count, grain, body);
    }

  private:
    std::function<void()> back_;
};

struct Scene {
    std::function<void()> back;  // called at each zone's beginning and end
    World world{{.trace = {.begin = [](void* user, const char*) { call(user); },
                           .end = [](void* user, const char*) { call(user); },
                           .user = this}}};
    std::vector<ObjectHandle> objects;
    NodeHandle node;

    static void call(void* user) {
        const auto& back = static_cast<Scene*>(user)->back;
        if (back) back();
    }
    Scene() {
        node = *world.add_node();
        for (int i = 0; i < 200; ++i)
            objects.push_back(i % 2 == 0 ? *world.add({.bound = Bound(box_at({0.9 * (i / 2), 0, -5}, 0.5f))})
                                         : *world.add({.transform = Transform{glm::dmat3(1.0), {0.9 * (i / 2), 1, -5}},
                                                       .shape = &kBall}));
        REQUIRE(world.update().has_value());
    }
    Scene(const Scene&) = delete;
    void move(int frame) {
        for (std::size_t i = 1; i < objects.size(); i += 2)
            REQUIRE(world.set_transform(objects[i], {glm::dmat3(1.0), {0.9 * double(i / 2), 1.0 - 0.1 * frame, -5}})
                        .has_value());
    }
};

ViewRequest forward() {
    return {.camera = Camera{.position = {20, 0, 20}}, .occlusion = OcclusionOptions{}};
}

// How many calls that change something were refused, of how many.
struct Tried {
    int refused = 0, all = 0;
    template <class T>
    void operator()(const Result<T>& result) {
        ++all;
        refused += !result.has_value() && result.error().code == ErrorCode::invalid_argument;
    }
};

void change_all(Scene& scene, Tried& tried) {
    World& world = scene.world;
    const ObjectHandle object = scene.objects[1];
    Vector<ObjectHandle> added(1);
    const ObjectDescription description{.shape = &kBall};
    tried(world.add(description));
    tried(world.add(Strided<ObjectDescription>(&description, 1), added));
    tried(world.reserve(1000));
    tried(world.remove(object));
    tried(world.set_transform(object, {}));
    tried(world.set_bound(scene.objects[0], Bound(box_at({0, 0, 0}, 1.0f))));
    tried(world.set_hidden(object, true));
    tried(world.set_layers(object, 1));
    tried(world.set_collides_with(object, 1));
    tried(world.set_user(object, 1));
    tried(world.set_shape(object, &kBall));
    tried(world.add_mesh({}));
    tried(world.add_node());
    tried(world.remove(scene.node));
    tried(world.set_transform(scene.node, {}));
    tried(world.set_parent(scene.node, {}));
    tried(world.set_layers(scene.node, 1));
    tried(world.attach(Region(), {}));
    tried(world.update());
}

void ask_all(const World& world, Tried& tried) {
    ViewResult visible;
    MultiViewResult views;
    Vector<ObjectRef> found;
    Vector<ObjectHit> hits;
    Vector<ShapeHit> shape_hits;
    Vector<ObjectManifold> manifolds;
    const ViewRequest requests[] = {forward(), forward()};
    const RigidTransform place{glm::dmat3(1.0), {0, 0, -5}};
    tried(world.view(forward(), visible));
    tried(world.view(requests, views));
    tried(world.cast(kBall, place, {{1, 0, 0}}, {}));
    tried(world.cast_all(kBall, place, {{1, 0, 0}}, {}, shape_hits));
    tried(world.contact_manifolds(kBall, place, {}, manifolds));
    CHECK_FALSE(world.raycast({{0, 0, 0}, {0, 0, -1}}).has_value());
    CHECK_FALSE(world.raycast_any({{0, 0, 0}, {0, 0, -1}}));
    world.raycast_all({{0, 0, 0}, {0, 0, -1}}, hits);
    CHECK(hits.empty());
    world.overlap(Sphere{{0, 0, -5}, 1.0}, found);
    CHECK(found.empty());
    CHECK_FALSE(world.closest(kBall, place, 10.0).has_value());
    CHECK(world.pairs().empty());
    CHECK(world.contacts().empty());
}

// The same pairs, contacts and view.
void check_same(const Scene& a, const Scene& b) {
    REQUIRE(a.world.contacts().size() == b.world.contacts().size());
    for (std::size_t i = 0; i < a.world.contacts().size(); ++i) {
        CHECK(a.world.contacts()[i].depth == b.world.contacts()[i].depth);
        CHECK(a.world.contacts()[i].phase == b.world.contacts()[i].phase);
    }
    CHECK(a.world.pairs().size() == b.world.pairs().size());
    ViewResult of_a, of_b;
    REQUIRE(a.world.view(forward(), of_a).has_value());
    REQUIRE(b.world.view(forward(), of_b).has_value());
    CHECK(std::equal(of_a.ids().begin(), of_a.ids().end(), of_b.ids().begin(), of_b.ids().end()));
}

}  // namespace

TEST_SUITE("world/callbacks") {
    TEST_CASE("what an update calls back may neither change nor ask the World, and spoils nothing") {
        Scene scene, plain;
        Tried tried;
        int calls = 0;
        const auto back = [&] {
            ++calls;
            change_all(scene, tried);
            ask_all(scene.world, tried);
            CHECK(plain.world.raycast({{0, 0, 0}, {0, 0, -1}}).has_value());  // another World answers
        };
        Calling executor(back);
        for (int frame = 1; frame <= 4; ++frame) {
            scene.move(frame);
            plain.move(frame);
            scene.back = back;
            REQUIRE(scene.world.update(executor).has_value());
            scene.back = {};
            REQUIRE(plain.world.update().has_value());
            check_same(scene, plain);
        }
        CHECK(calls > 20);
        CHECK(tried.refused == tried.all);
    }

    TEST_CASE("what a view calls back may ask the World, and not change it") {
        Scene scene, plain;
        Tried tried;
        int rays = 0;
        const auto back = [&] {
            if (rays >= 40) return;
            ++rays;
            change_all(scene, tried);
            CHECK(scene.world.raycast({{0, 0, 0}, {0, 0, -1}}).has_value());
            ViewResult inner;
            CHECK(scene.world.view(forward(), inner).has_value());
        };
        Calling executor(back);
        scene.back = back;
        ViewResult visible, expected;
        MultiViewResult views;
        const ViewRequest requests[] = {forward(), forward()};
        REQUIRE(scene.world.view(forward(), visible, executor).has_value());
        REQUIRE(scene.world.view(requests, views, executor).has_value());
        scene.back = {};
        REQUIRE(plain.world.view(forward(), expected).has_value());
        CHECK(std::equal(visible.ids().begin(), visible.ids().end(), expected.ids().begin(), expected.ids().end()));
        CHECK(views.size() == expected.size());
        CHECK(rays > 5);
        CHECK(tried.refused == tried.all);
        CHECK(scene.world.set_hidden(scene.objects[0], true).has_value());
    }

    TEST_CASE("two Worlds that share a pool are updated and viewed on two threads as each alone") {
        Scene scenes[2], plain;
        ThreadPool pool(3);
        const auto live = [&](Scene& scene) {
            for (int frame = 1; frame <= 8; ++frame) {
                scene.move(frame);
                ViewResult visible;
                if (!scene.world.update(pool) || !scene.world.view(forward(), visible, pool)) return;
            }
        };
        std::thread other([&] { live(scenes[1]); });
        live(scenes[0]);
        other.join();
        live(plain);
        for (const Scene& scene : scenes) check_same(scene, plain);
    }

    TEST_CASE("a log handler that calls the World back while it is updated changes and finds nothing") {
        Scene scene;
        Tried tried;
        struct Handler {
            Scene& scene;
            Tried& tried;
            int calls = 0;
        } handler{scene, tried};
        set_log_handler(
            [](void* user, LogLevel, std::string_view) {
                auto& own = *static_cast<Handler*>(user);
                ++own.calls;
                change_all(own.scene, own.tried);
                ask_all(own.scene.world, own.tried);
            },
            &handler);
        // The product of the transforms is out of range.
        const TriangleMesh cube = testing::cube_mesh(1.0f);
        const MeshHandle mesh = *scene.world.add_mesh({.positions = cube.positions, .indices = cube.indices});
        const Transform huge{glm::dmat3(1e15), {}};
        REQUIRE(scene.world.add({.mesh = mesh, .node = scene.node, .transform = huge}).has_value());
        REQUIRE(scene.world.set_transform(scene.node, huge).has_value());
        (void)scene.world.update();
        set_log_handler(nullptr, nullptr);
        CHECK(handler.calls > 0);
        CHECK(tried.refused == tried.all);
        CHECK(scene.world.update().has_value());
    }
}
