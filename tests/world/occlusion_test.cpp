// SPDX-License-Identifier: MIT
// Views of a World that leave out what is hidden.
#include <doctest/doctest.h>
#include <algorithm>
#include <counting_memory.hpp>
#include <crofton/crofton.hpp>
#include <glm/geometric.hpp>
#include <oracle/random_boxes.hpp>
#include <vector>

#include "model.hpp"
#include "new_counter.hpp"

using namespace crofton;
using oracle::NearMisses;

namespace {

TriangleMesh cuboid(const glm::vec3& half) {
    TriangleMesh mesh;
    for (unsigned i = 0; i < 8; ++i)
        mesh.positions.push_back({i & 1u ? half.x : -half.x, i & 2u ? half.y : -half.y, i & 4u ? half.z : -half.z});
    mesh.indices = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                    2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
    return mesh;
}

MeshDescription description_of(const TriangleMesh& mesh, bool occluders) {
    return {.positions = mesh.positions, .indices = mesh.indices, .occluders = occluders};
}

Obb box_at(double x, double y, double z, float half = 0.5f) {
    Obb box;
    box.center = {x, y, z};
    box.half_extents = glm::vec3(half);
    return box;
}

scene::Transform at(double x, double y, double z) {
    return {glm::dmat3(1.0), {x, y, z}};
}

// A wall of 10 × 10 × 1 ten metres before the eye, and a ball behind it.
struct BehindAWall {
    World world;
    MeshHandle mesh = world.add_mesh(description_of(cuboid({5.0f, 5.0f, 0.5f}), true)).value();
    NodeHandle node = world.add_node({.transform = at(0.0, 0.0, -10.0)}).value();
    ObjectHandle wall = world.add({.mesh = mesh, .node = node, .user = 7}).value();
    ObjectHandle behind = world.add({.bound = box_at(0.0, 0.0, -20.0), .user = 9}).value();
    ObjectHandle beside = world.add({.bound = box_at(-14.0, 0.0, -20.0)}).value();
    VisibleObjects visible;

    [[nodiscard]] bool hides(const cull::CullOptions& options = {}, std::uint32_t layer_mask = ~0u) {
        REQUIRE(world.update().has_value());
        const auto view = occlude::occlusion_view_of(Camera());
        REQUIRE(world.view(OccludingView{*view, layer_mask}, {.list_occluded = true}, visible, options).has_value());
        const auto contains = [](std::span<const std::uint32_t> ids, ObjectHandle object) {
            return std::binary_search(ids.begin(), ids.end(), object.index);
        };
        CHECK(contains(visible.ids(), beside));
        CHECK(contains(visible.ids(), behind) != contains(visible.occluded_ids(), behind));
        return visible.verdict_of(behind.index) == occlude::Verdict::occluded;
    }
};

// Houses in rows, some of which turn and move, and small things among them.
struct Town {
    World world;
    std::vector<ObjectHandle> houses, things;
    std::vector<NodeHandle> blocks;
    std::vector<Obb> boxes;
    std::vector<MeshHandle> meshes;
    glm::dvec3 offset;

    Town(NearMisses& random, const glm::dvec3& at_offset, std::size_t count) : offset(at_offset) {
        for (const float height : {4.0f, 6.0f, 9.0f})
            meshes.push_back(world.add_mesh(description_of(cuboid({4.0f, height, 5.0f}), true)).value());
        for (int b = 0; b < 16; ++b)
            blocks.push_back(world
                                 .add_node({.transform = {glm::dmat3(1.0),
                                                          offset + glm::dvec3(40.0 * (b % 4), 0.0, 40.0 * (b / 4))}})
                                 .value());
        for (std::size_t i = 0; i < 64; ++i)
            houses.push_back(world
                                 .add({.mesh = meshes[random.index(3)],
                                       .node = blocks[i % 16],
                                       .transform = place(random),
                                       .user = i})
                                 .value());
        for (std::size_t i = 0; i < count; ++i) {
            boxes.push_back(thing(random));
            things.push_back(world.add({.bound = boxes.back(), .user = 1000 + i}).value());
        }
    }
    [[nodiscard]] static scene::Transform place(NearMisses& random) {
        const Obb turned = oracle::random_box(random, {}, 8.0);
        const double scale = random.index(4) ? 1.0 : random.number(0.5, 1.5);
        return {scale * glm::dmat3(random.index(2) ? turned.axes : glm::mat3(1.0f)),
                {random.number(-16.0, 16.0), 0.0, random.number(-16.0, 16.0)}};
    }
    [[nodiscard]] Obb thing(NearMisses& random) const {
        Obb box = oracle::random_box(random, {}, 1.0);
        box.center =
            offset + glm::dvec3(random.number(-20.0, 140.0), random.number(-3.0, 3.0), random.number(-20.0, 140.0));
        box.half_extents = glm::vec3(static_cast<float>(random.number(0.1, 0.8)));
        return box;
    }
    [[nodiscard]] Camera camera(NearMisses& random) const {
        Camera camera;
        camera.position =
            offset + glm::dvec3(random.number(-20.0, 140.0), random.number(-2.0, 4.0), random.number(-20.0, 140.0));
        camera.forward = {random.number(-1.0, 1.0), random.number(-0.2, 0.2), random.number(-1.0, 1.0)};
        camera.far_distance = 400.0;
        return camera;
    }
    // Changes of every kind.
    void change(NearMisses& random) {
        const auto any = [&](std::size_t count) { return random.index(static_cast<unsigned>(count)); };
        for (int i = 0; i < 6; ++i) {
            const ObjectHandle house = houses[any(houses.size())];
            if (!world.contains(house)) continue;
            switch (random.index(7)) {
                case 0:
                    (void)world.set_transform(house, place(random));
                    break;
                case 1:
                    (void)world.set_hidden(house, random.index(2) != 0);
                    break;
                case 2:
                    (void)world.set_layers(house, random.index(2) ? ~0u : 1u << random.index(3));
                    break;
                case 3:
                    (void)world.set_mesh(house, meshes[random.index(3)]);
                    break;
                case 4:
                    (void)world.set_occludes(house, random.index(3) != 0);
                    break;
                case 5:
                    (void)world.set_transform(house, {glm::dmat3(random.index(2) ? 0.0 : 1.0), {}});
                    break;
                default:
                    (void)world.remove(house);
            }
        }
        const NodeHandle block = blocks[any(blocks.size())];
        REQUIRE(world
                    .set_transform(block, {glm::dmat3(1.0), offset + glm::dvec3(random.number(0.0, 120.0), 0.0,
                                                                                random.number(0.0, 120.0))})
                    .has_value());
        houses.push_back(
            world.add({.mesh = meshes[random.index(3)], .node = blocks[any(16)], .transform = place(random)}).value());
        for (std::size_t i = 0; i < things.size(); i += 5) {
            boxes[i] = thing(random);
            REQUIRE(world.set_bound(things[i], boxes[i]).has_value());
        }
    }
};

// Whether a ray of the camera reaches the object before anything else of the layers.
bool is_witnessed(const World& world, const Camera& camera, const Frustum& frustum, ObjectHandle object,
                  std::uint32_t layers, NearMisses& random) {
    const Obb box = world.box_of(object).value();
    for (int n = 0; n < 12; ++n) {
        glm::dvec3 point = box.center;
        for (int k = 0; k < 3; ++k)
            point += 0.999 * random.number(-1.0, 1.0) * double(box.half_extents[k]) * glm::dvec3(box.axes[k]);
        bool in_view = true;
        for (const Plane& plane : frustum.view())
            in_view = in_view && glm::dot(plane.normal, point - frustum.origin) + plane.offset > 1e-6;
        const auto hit = world.raycast({camera.position, point - camera.position, 1.0}, layers);
        // What begins before the near plane is not drawn: such a ray tells nothing.
        if (in_view && hit && hit->object == object && hit->t * glm::length(point - camera.position) > 0.3) return true;
    }
    return false;
}

}  // namespace

TEST_SUITE("world/occlusion") {
    TEST_CASE("an object behind a wall is occluded, and the wall is named") {
        BehindAWall s;
        REQUIRE(s.hides());
        CHECK(s.visible.has_occlusion());
        CHECK(s.visible.occlusion_statistics().occluders_drawn == 1);
        CHECK(s.visible.occlusion_statistics().drawn.pieces_drawn == 1);
        CHECK(s.visible.occlusion_statistics().asked.items_hidden >= 1);
        Vector<OccluderRef> occluders;
        REQUIRE(s.world.hidden_by(s.behind, s.visible, occluders).has_value());
        REQUIRE(occluders.size() == 1);
        CHECK(occluders[0].object == s.wall);
        CHECK(occluders[0].user == 7);
        CHECK(occluders[0].place == 0);
        REQUIRE(s.world.hidden_by(s.beside, s.visible, occluders).has_value());
        CHECK(occluders.empty());
        s.world.drawn_occluders(s.visible, occluders);
        CHECK(occluders.size() == 1);
        // The picture: the wall in the middle, nothing at the edge.
        const occlude::OcclusionBuffer* buffer = s.visible.occlusion_buffer();
        REQUIRE(buffer != nullptr);
        CHECK(1.0 / double(buffer->nearness(240, 135)) == doctest::Approx(9.5).epsilon(1e-3));
        CHECK(buffer->nearness(1, 1) == occlude::OcclusionBuffer::kUncovered);
        CHECK(buffer->count_covered() > 1000);
        std::vector<float> pixels(480 * 270);
        buffer->read(pixels);
        CHECK(pixels[135 * 480 + 240] == buffer->nearness(240, 135));
        // Without the switch.
        REQUIRE(s.world.view(Camera(), {.enabled = false}, s.visible).has_value());
        CHECK(s.visible.size() == 3);
        CHECK(!s.visible.has_occlusion());
        CHECK(s.visible.occlusion_buffer() == nullptr);
    }

    TEST_CASE("what a view does not draw hides nothing in it") {
        BehindAWall s;
        REQUIRE(s.hides());
        SUBCASE("hidden") {
            REQUIRE(s.world.set_hidden(s.wall, true).has_value());
            CHECK_FALSE(s.hides());
            REQUIRE(s.world.set_hidden(s.wall, false).has_value());
            CHECK(s.hides());
        }
        SUBCASE("transparent") {
            REQUIRE(s.world.set_occludes(s.wall, false).has_value());
            CHECK_FALSE(s.hides());
            REQUIRE(s.world.set_occludes(s.wall, true).has_value());
            CHECK(s.hides());
            CHECK(s.world.set_occludes(s.behind, true).error().code == ErrorCode::invalid_argument);
        }
        SUBCASE("in another layer, by itself or by its node") {
            REQUIRE(s.world.set_layers(s.wall, 2).has_value());
            CHECK_FALSE(s.hides({}, 1));
            CHECK(s.hides({}, 3));
            REQUIRE(s.world.set_layers(s.node, 1).has_value());
            CHECK_FALSE(s.hides());
        }
        SUBCASE("removed, alone or with its node") {
            REQUIRE(s.world.remove(s.wall).has_value());
            CHECK_FALSE(s.hides());
            BehindAWall other;
            REQUIRE(other.hides());
            REQUIRE(other.world.remove(other.node).has_value());
            CHECK_FALSE(other.hides());
        }
        SUBCASE("flat, or a point") {
            glm::dmat3 flat(1.0);
            flat[2][2] = 0.0;
            REQUIRE(s.world.set_transform(s.node, {flat, {0.0, 0.0, -10.0}}).has_value());
            CHECK_FALSE(s.hides());
            REQUIRE(s.world.set_transform(s.node, {glm::dmat3(0.0), {}}).has_value());
            CHECK_FALSE(s.hides());
            REQUIRE(s.world.set_transform(s.node, at(0.0, 0.0, -10.0)).has_value());
            CHECK(s.hides());
        }
        SUBCASE("too small or too far for the view") {
            cull::DrawLimits limits;
            limits.least_radius = 20.0;
            REQUIRE(s.world.view(Camera(), {}, s.visible, {.limits = &limits}).has_value());
            CHECK(s.visible.size() == 0);
            std::vector<float> distances(3, 1e9f);
            distances[s.wall.index] = 5.0f;
            cull::DrawLimits by_item;
            by_item.item_distances = distances;
            CHECK_FALSE(s.hides({.limits = &by_item}));
            distances[s.wall.index] = 15.0f;
            CHECK(s.hides({.limits = &by_item}));
        }
        SUBCASE("another mesh, other vertices") {
            const auto small = s.world.add_mesh(description_of(cuboid({0.1f, 0.1f, 0.1f}), true)).value();
            REQUIRE(s.world.set_mesh(s.wall, small).has_value());
            CHECK_FALSE(s.hides());
            REQUIRE(s.world.set_mesh(s.wall, s.mesh).has_value());
            CHECK(s.hides());
            const TriangleMesh same = cuboid({5.0f, 5.0f, 0.5f});
            REQUIRE(s.world.set_vertices(s.mesh, same.positions).has_value());
            CHECK(s.world.occluders_of(s.mesh).empty());
            CHECK_FALSE(s.hides());
            REQUIRE(s.world.find_occluders(s.mesh).has_value());
            CHECK(s.hides());
            REQUIRE(s.world.replace_mesh(s.mesh, description_of(same, false)).has_value());
            CHECK_FALSE(s.hides());
            REQUIRE(s.world.replace_mesh(s.mesh, description_of(same, true)).has_value());
            CHECK(s.hides());
        }
    }

    TEST_CASE("an occluder follows its node, in the update that moves it") {
        BehindAWall s;
        REQUIRE(s.hides());
        REQUIRE(s.world.set_transform(s.node, at(12.0, 0.0, -10.0)).has_value());
        CHECK_FALSE(s.hides());
        for (int i = 0; i < 5; ++i) {
            REQUIRE(s.world.set_transform(s.node, at(0.0, 0.1 * i, -10.0)).has_value());
            CHECK(s.hides());
        }
        // What moves is asked as well.
        for (int i = 0; i < 5; ++i) {
            REQUIRE(s.world.set_bound(s.behind, box_at(0.1 * i, 0.0, -20.0)).has_value());
            CHECK(s.hides());
        }
        CHECK(s.world.statistics().moving >= 1);
        REQUIRE(s.world.set_bound(s.behind, box_at(0.0, 7.0, -20.0)).has_value());
        CHECK(s.hides());  // 7.5 of 20 behind 5 of 9.5
        REQUIRE(s.world.set_bound(s.behind, box_at(0.0, 0.0, -8.0)).has_value());
        CHECK_FALSE(s.hides());
    }

    TEST_CASE("occluders are given, listed and given again; bad ones are refused by name") {
        BehindAWall s;
        const auto found = s.world.occluders_of(s.mesh);
        REQUIRE(found.size() == 1);
        const std::vector<occlude::FoundOccluder> stored(found.begin(), found.end());
        REQUIRE(s.world.set_occluders(s.mesh, {}).has_value());
        CHECK_FALSE(s.hides());
        REQUIRE(s.world.set_occluders(s.mesh, stored).has_value());
        CHECK(s.hides());
        occlude::FoundOccluder box;
        box.box.half_extents = {4.0f, 4.0f, 0.25f};
        REQUIRE(s.world.set_occluders(s.mesh, {&box, 1}).has_value());
        CHECK(s.hides());
        CHECK(s.world.occluders_of(s.mesh)[0].surface.positions.size() == 8);
        occlude::FoundOccluder patch;
        patch.kind = occlude::OccluderKind::patch;
        patch.surface.positions = {{-4, -4, 0}, {4, -4, 0}, {4, 4, 0}, {-4, 4, 0}};
        patch.surface.indices = {0, 1, 2, 0, 2, 3};
        patch.sides = occlude::Sides::front;
        REQUIRE(s.world.set_occluders(s.mesh, {&patch, 1}).has_value());
        CHECK(s.hides());
        std::swap(patch.surface.indices[1], patch.surface.indices[2]);
        std::swap(patch.surface.indices[4], patch.surface.indices[5]);
        REQUIRE(s.world.set_occluders(s.mesh, {&patch, 1}).has_value());
        CHECK_FALSE(s.hides());
        occlude::FoundOccluder closed;
        closed.kind = occlude::OccluderKind::patch;
        closed.surface = cuboid({4.0f, 4.0f, 0.25f});
        REQUIRE(s.world.set_occluders(s.mesh, {&closed, 1}).has_value());
        CHECK(s.hides());

        occlude::FoundOccluder bad[3] = {box, box, box};
        bad[1].box.half_extents.x = 0.0f;
        auto refused = s.world.set_occluders(s.mesh, bad);
        CHECK(refused.error().code == ErrorCode::degenerate);
        CHECK(refused.error().item == 1);
        bad[1] = box;
        bad[2].box.center.y = std::numeric_limits<double>::quiet_NaN();
        refused = s.world.set_occluders(s.mesh, bad);
        CHECK(refused.error().code == ErrorCode::non_finite);
        CHECK(refused.error().item == 2);
        CHECK(s.hides());  // as before
        CHECK(s.world.set_occluders({}, {}).error().code == ErrorCode::stale_handle);
        CHECK(s.world.find_occluders({}).error().code == ErrorCode::stale_handle);
        CHECK(s.world.occluders_of({}).empty());
        CHECK(s.world.set_occludes({}, true).error().code == ErrorCode::stale_handle);
        Vector<OccluderRef> none;
        CHECK(s.world.hidden_by({}, s.visible, none).error().code == ErrorCode::stale_handle);
        CHECK(s.world.view(Camera(), {.size = {4, 270}}, s.visible).error().code == ErrorCode::out_of_range);
        CHECK(s.world.view(Camera{.fov_y = -1.0}, {}, s.visible).error().code != ErrorCode::out_of_memory);
    }

    TEST_CASE("what only occludes is in no answer") {
        World world;
        const auto mesh = world.add_mesh(description_of(cuboid({5.0f, 5.0f, 0.5f}), true)).value();
        const auto wall = world.add({.mesh = mesh, .transform = at(0.0, 0.0, -10.0), .only_occludes = true}).value();
        (void)world.add({.bound = box_at(0.0, 0.0, -20.0)}).value();
        CHECK(world.add({.bound = box_at(0.0, 0.0, -20.0), .only_occludes = true}).error().code ==
              ErrorCode::invalid_argument);
        REQUIRE(world.update().has_value());
        VisibleObjects visible;
        REQUIRE(world.view(Camera(), visible).has_value());
        CHECK(visible.size() == 1);
        REQUIRE(world.view(Camera(), OcclusionOptions{}, visible).has_value());
        CHECK(visible.size() == 0);
        CHECK_FALSE(world.raycast({{0, 0, 0}, {0, 0, -1}, 15.0}).has_value());
        REQUIRE(world.set_hidden(wall, true).has_value());
        REQUIRE(world.update().has_value());
        REQUIRE(world.view(Camera(), OcclusionOptions{}, visible).has_value());
        CHECK(visible.size() == 1);
    }

    TEST_CASE("no object that a ray of the view reaches first is left out, whatever has changed") {
        NearMisses random(171);
        std::size_t hidden = 0, witnessed = 0;
        for (const double offset : {0.0, 1e5, 1e7}) {
            Town town(random, offset * glm::dvec3(1.0, 0.5, -1.0), 300);
            VisibleObjects visible, plain;
            for (int frame = 0; frame < 12; ++frame) {
                REQUIRE(town.world.update().has_value());
                const Camera camera = town.camera(random);
                const std::uint32_t layers = random.index(2) ? ~0u : 3u;
                const OccludingView view{*occlude::occlusion_view_of(camera), layers};
                REQUIRE(town.world.view(view, {.list_occluded = true}, visible).has_value());
                town.world.view(cull::View{view.view.frustum, layers}, plain);
                std::vector<std::uint32_t> both(visible.ids().begin(), visible.ids().end());
                both.insert(both.end(), visible.occluded_ids().begin(), visible.occluded_ids().end());
                std::sort(both.begin(), both.end());
                REQUIRE(std::equal(both.begin(), both.end(), plain.ids().begin(), plain.ids().end()));
                for (std::size_t i = 0; i < visible.size(); ++i)
                    CHECK(visible.verdicts()[i] ==
                          plain.verdicts()[std::size_t(
                              std::lower_bound(plain.ids().begin(), plain.ids().end(), visible.ids()[i]) -
                              plain.ids().begin())]);
                for (const std::uint32_t id : visible.occluded_ids()) {
                    ++hidden;
                    const ObjectHandle object = visible.ref(id).object;
                    CHECK_FALSE(is_witnessed(town.world, camera, view.view.frustum, object, layers, random));
                }
                for (std::size_t i = 0; i < visible.size(); i += 4)
                    witnessed += is_witnessed(town.world, camera, view.view.frustum, visible[i].object, layers, random);
                town.change(random);
            }
        }
        MESSAGE(hidden << " hidden, " << witnessed << " of a fourth of the others witnessed");
        CHECK(hidden > 1000);
        CHECK(witnessed > 100);
    }

    TEST_CASE("many views in one call, threads and matrices give the same answers") {
        NearMisses random(172);
        Town town(random, {1e4, 0.0, 0.0}, 500);
        REQUIRE(town.world.update().has_value());
        ThreadPool pool(3);
        std::vector<OccludingView> views;
        for (int v = 0; v < 9; ++v)
            views.push_back({*occlude::occlusion_view_of(town.camera(random)), v % 3 ? ~0u : 5u});
        VisibleInViews together, alone;
        REQUIRE(town.world.view(views, OcclusionOptions{}, together, {}, pool).has_value());
        REQUIRE(town.world.view(views, OcclusionOptions{}, alone).has_value());
        CHECK(std::ranges::equal(together.ids(), alone.ids()));
        CHECK(together.occlusion_view_count() == views.size());
        std::size_t seen = 0;
        for (std::size_t v = 0; v < views.size(); ++v) {
            VisibleObjects one, threaded;
            REQUIRE(town.world.view(views[v], OcclusionOptions{}, one).has_value());
            REQUIRE(town.world.view(views[v], OcclusionOptions{}, threaded, {}, pool).has_value());
            CHECK(std::ranges::equal(one.ids(), threaded.ids()));
            std::vector<std::uint32_t> of_view;
            for (std::size_t i = 0; i < together.size(); ++i) {
                CHECK(together.view_mask(i) == alone.view_mask(i));
                if (together.view_mask(i) >> v & 1u) of_view.push_back(together.ids()[i]);
            }
            CHECK(std::ranges::equal(one.ids(), of_view));
            CHECK(together.occlusion_statistics(v).occluders_drawn == one.occlusion_statistics().occluders_drawn);
            std::vector<float> a(480 * 270), b(a.size()), c(a.size());
            one.occlusion_buffer()->read(a);
            threaded.occlusion_buffer()->read(b);
            together.occlusion_buffer(v).read(c);
            CHECK(a == b);
            CHECK(a == c);
            seen += one.size();
        }
        CHECK(seen > 100);
        // Again with fewer views, and without occlusion.
        REQUIRE(town.world.view(std::span(views).first(2), OcclusionOptions{}, together).has_value());
        for (std::size_t i = 0; i < together.size(); ++i) CHECK(together.view_mask(i) < 4);
        VisibleInViews plain;
        REQUIRE(town.world.view(std::span(views).first(2), {.enabled = false}, plain).has_value());
        CHECK(plain.size() > together.size());
        CHECK(plain.occlusion_view_count() == 0);

        // An engine's own matrix sees what the camera sees, up to rounding.
        const Camera camera = town.camera(random);
        VisibleObjects by_camera, by_matrix;
        REQUIRE(town.world.view(camera, OcclusionOptions{}, by_camera).has_value());
        const auto matrix = occlude::occlusion_view_of(world_to_clip(camera), DepthRange::reversed_zero_to_one);
        REQUIRE(town.world.view(OccludingView{*matrix}, OcclusionOptions{}, by_matrix).has_value());
        CHECK(std::abs(double(by_camera.size()) - double(by_matrix.size())) <= 2.0);
    }

    TEST_CASE("frames with occlusion allocate nothing once warm") {
        testing::CountingMemory memory;
        {
            NearMisses random(173);
            Town town(random, {}, 500);
            const std::array<OccludingView, 2> views{OccludingView{*occlude::occlusion_view_of(town.camera(random))},
                                                     OccludingView{*occlude::occlusion_view_of(town.camera(random))}};
            VisibleObjects visible;
            VisibleInViews in_views;
            const auto frame = [&](double shift) {
                for (std::size_t i = 0; i < town.boxes.size(); i += 3) town.boxes[i].center.x += shift;
                REQUIRE(town.world.set_bounds(town.things, town.boxes).has_value());
                for (std::size_t b = 0; b < 4; ++b)
                    REQUIRE(
                        town.world.set_transform(town.blocks[b], at(40.0 * double(b) + shift, 0.0, 0.0)).has_value());
                REQUIRE(town.world.update().has_value());
                REQUIRE(town.world.view(views[0], {.list_occluded = true}, visible).has_value());
                REQUIRE(town.world.view(views, OcclusionOptions{}, in_views).has_value());
            };
            for (int i = 0; i < 24; ++i) frame(i % 2 ? 0.1 : -0.1);
            const std::size_t before = memory.allocations(), news = testing::operator_news();
            for (int i = 0; i < 6; ++i) frame(i % 2 ? 0.1 : -0.1);
            CHECK(memory.allocations() == before);
            CHECK(testing::operator_news() == news);
            CHECK(visible.occluded_ids().size() > 10);
        }
        CHECK(memory.bytes_in_use() == 0);
    }
}
