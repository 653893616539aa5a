// SPDX-License-Identifier: MIT
// World::view with a picture: the triangles to draw.
#include <crofton/crofton.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <crofton/geometry/model_to_clip.hpp>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "../../box_mesh.hpp"
#include "../../error_of.hpp"
#include "../../view/depth/depth_scenes.hpp"
#include "../../view/depth/shadow_check.hpp"

namespace crofton::testing {
namespace {

struct Town {
    World world;
    std::vector<CutMesh> meshes;
    std::vector<MeshHandle> handles;
    struct Placed {
        ObjectHandle object;
        std::size_t mesh;
        Transform transform;
        bool occludes;
    };
    std::vector<Placed> placed;

    void add_mesh(TriangleMesh mesh, bool one_sided) {
        handles.push_back(world
                              .add_mesh({.positions = mesh.positions,
                                         .indices = mesh.indices,
                                         .triangles = false,
                                         .clusters = true,
                                         .one_sided = one_sided})
                              .value());
        meshes.emplace_back(std::move(mesh));
    }
    void add(std::size_t mesh, const Transform& transform, bool occludes = true) {
        const auto object =
            world.add({.mesh = handles[mesh], .transform = transform, .user = placed.size(), .occludes = occludes});
        placed.push_back({object.value(), mesh, transform, occludes});
    }
};

Transform random_transform(oracle::NearMisses& random) {
    const glm::dvec3 at(random.number(-20, 20), random.number(-2, 3), random.number(-20, 20));
    const glm::dvec3 scale(random.number(0.3, 3), random.number(0.3, 3),
                           random.index(3) == 0 ? -0.5 : random.number(0.3, 3));
    const glm::dmat4 m = placed(at, scale, {0, 1, 0}, random.number(0, 6));
    return {glm::dmat3(m), at};
}

Town random_town(std::uint64_t seed, oracle::NearMisses& random) {
    Town town;
    town.add_mesh(cube_mesh(), seed % 2 == 0);
    town.add_mesh(ball(12, random), true);
    town.add_mesh(hills(30, 25.0f, 1.0f, random), false);
    town.add(2, {glm::dmat3(1.0), {0, -3, 0}});
    for (int i = 0; i < 60; ++i) {
        const std::size_t mesh = random.index(2);
        const Transform transform = random_transform(random);
        town.add(mesh, transform, random.index(6) != 0);
    }
    (void)town.world.update();
    return town;
}

Camera camera_in(oracle::NearMisses& random) {
    Camera camera;
    const double x = random.number(-20, 20), z = random.number(-20, 20), y = random.number(0, 3);
    camera.position = {x, y, z};
    const double fx = random.number(-1, 1), fz = random.number(-1, 1);
    camera.forward = {fx, -0.1, fz};
    return camera;
}

// What a renderer shows of the town, by the oracle.
std::set<std::pair<std::uint32_t, std::uint32_t>> owners_of(const Town& town, const Camera& camera, std::uint32_t width,
                                                            std::uint32_t height) {
    oracle::OwnerPicture picture(width, height);
    oracle::OwnerRenderer renderer(picture, {.wobble = 0.0004}, 5);
    for (std::size_t i = 0; i < town.placed.size(); ++i) {
        const Town::Placed& p = town.placed[i];
        const CutMesh& mesh = town.meshes[p.mesh];
        glm::dmat4 world(p.transform.linear);
        world[3] = glm::dvec4(p.transform.translation, 1.0);
        renderer.draw({mesh.mesh.positions, mesh.mesh.indices, glm::mat4(world_to_clip(camera) * world)},
                      static_cast<std::uint32_t>(i));
    }
    std::set<std::pair<std::uint32_t, std::uint32_t>> owners;
    for (const std::uint64_t owner : picture.owners)
        if (owner != oracle::OwnerPicture::kNobody) owners.emplace(owner >> 32, owner & 0xffffffffu);
    return owners;
}

std::set<std::pair<std::uint32_t, std::uint32_t>> listed_in(const Town& town,
                                                            std::span<const depth::VisibleCluster> triangles) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> listed;
    for (const depth::VisibleCluster& c : triangles) {
        const depth::ClusteredMesh& mesh = town.meshes[town.placed[c.object].mesh].clusters;
        for (std::uint32_t k = 0; k < 64; ++k)
            if (c.triangles >> k & 1) listed.emplace(c.object, mesh.clusters()[c.cluster].first_triangle + k);
    }
    return listed;
}

// As a renderer draws the town: the matrices that a World makes of a camera.
std::vector<depth::DepthObject> drawn_by(const Town& town, const Camera& camera) {
    const glm::dmat4 to_clip = view_to_clip(camera) * glm::dmat4(world_to_view_rotation(camera));
    std::vector<depth::DepthObject> drawn;
    for (const Town::Placed& p : town.placed)
        drawn.push_back(
            {&town.meshes[p.mesh].clusters,
             crofton::detail::model_to_clip(to_clip, camera.position, p.transform.linear, p.transform.translation)});
    return drawn;
}

Camera light_in(oracle::NearMisses& random) {
    Camera light;
    light.up = {0.3, 1, 0.2};
    const double fx = random.number(-1, 1), fz = random.number(-1, 1), x = random.number(-9, 9);
    light.forward = {fx, -1, fz};
    if (random.index(2) == 0) {
        light.projection = Projection::orthographic;
        light.height = random.number(10, 60);
        light.position = -50.0 * glm::normalize(light.forward);
    } else {
        light.position = {x, random.number(0.5, 12), 3};
        light.fov_y = random.number(0.4, 2.0);
    }
    light.aspect = 1.0;
    return light;
}

}  // namespace

TEST_SUITE("world/picture_view") {
    TEST_CASE("a light lists the casters without which a shadow on what a camera sees would change") {
        ShadowCheck sum;
        for (std::uint64_t seed = 1; seed <= 40; ++seed) {
            CAPTURE(seed);
            oracle::NearMisses random(seed);
            Town town = random_town(2 * seed + 1, random);
            if (seed % 4 == 0) {  // things move
                for (std::size_t i = 1; i < town.placed.size(); i += 3) {
                    town.placed[i].transform = random_transform(random);
                    REQUIRE(town.world.set_transform(town.placed[i].object, town.placed[i].transform));
                }
                REQUIRE(town.world.update());
            }
            Scene scene;
            Roles roles;
            for (const Town::Placed& p : town.placed) {
                roles.drawn.push_back(static_cast<std::uint32_t>(scene.objects.size()));
                scene.objects.push_back({&town.meshes[p.mesh], glm::dmat4(1.0)});
            }
            roles.casters = roles.drawn;
            Camera camera = camera_in(random);
            camera.aspect = 2.0;
            const Camera light = light_in(random);
            const depth::PictureView picture{160, 80}, map{128, 128};
            const float radius = float(random.index(3)) + 0.5f;
            ViewResult seen, casters, by_tree, all;
            REQUIRE(town.world.view({.camera = camera, .picture = picture}, seen));
            ViewRequest request{.camera = light, .picture = map, .receivers = ShadowReceivers{&seen, radius}};
            REQUIRE(town.world.view(request, casters));
            REQUIRE(town.world.view({.camera = light, .picture = map}, all));
            CHECK(casters.picture_statistics().triangles_listed <= all.picture_statistics().triangles_listed);
            const auto objects = drawn_by(town, camera), of_light = drawn_by(town, light);
            std::vector<depth::DepthReceiver> receivers;
            for (const depth::DepthObject& o : of_light) receivers.push_back({o.mesh, o.to_clip});
            ShadowCheck c;
            compare_shadows(scene, roles, {picture, objects}, {map, of_light}, {nullptr, receivers, radius},
                            casters.triangles(), random, c);
            CHECK(c.wrong == 0);
            sum.add(c);
            // In the tree's order, and as one of many views.
            const auto same = [&](std::span<const depth::VisibleCluster> other) {
                return listed_in(town, other) == listed_in(town, casters.triangles());
            };
            request.order = cull::ResultOrder::tree;
            REQUIRE(town.world.view(request, by_tree));
            CHECK(same(by_tree.triangles()));
            const std::vector<ViewRequest> two = {{.camera = light, .order = cull::ResultOrder::tree}, request};
            MultiViewResult many;
            REQUIRE(town.world.view(two, many));
            CHECK(same(many.triangles(1)));
        }
        CHECK(sum.shadows > 10'000);
    }

    TEST_CASE("an object that has only a box may be seen anywhere within it") {
        World world;
        const TriangleMesh plank = box_mesh({-0.5f, -0.1f, -0.5f}, {0.5f, 0.1f, 0.5f});
        const MeshHandle mesh =
            world.add_mesh({.positions = plank.positions, .indices = plank.indices, .clusters = true}).value();
        const ObjectHandle roof =
            world.add({.mesh = mesh, .transform = Transform{glm::dmat3(1.0), {0, 2, -9}}}).value();
        const ObjectHandle box = world.add({.bound = Obb{{0, 0, -10}, glm::mat3(1.0f), glm::vec3(1.5f)}}).value();
        (void)world.update();
        Camera sun;
        sun.projection = Projection::orthographic;
        sun.position = {0, 20, -10};
        sun.forward = {0, -1, 0};
        sun.up = {0, 0, -1};
        sun.height = 8;
        sun.aspect = 1.0;
        // Below the roof's edge, so that only the box is seen.
        Camera camera;
        camera.forward = {0, -0.15, -1};
        camera.fov_y = 0.3;
        ViewResult seen, casters;
        REQUIRE(world.view({.camera = camera, .picture = depth::PictureView{160, 90}}, seen));
        CHECK(std::equal(seen.ids().begin(), seen.ids().end(), &box.index, &box.index + 1));
        const ViewRequest request{
            .camera = sun, .picture = depth::PictureView{64, 64}, .receivers = ShadowReceivers{&seen}};
        REQUIRE(world.view(request, casters));
        CHECK(std::count(casters.ids().begin(), casters.ids().end(), roof.index) == 1);
        CHECK(std::count(casters.ids().begin(), casters.ids().end(), box.index) == 1);
        // Turned away, the camera sees nothing, and nothing is listed.
        camera.forward = {0, 0, 1};
        REQUIRE(world.view({.camera = camera, .picture = depth::PictureView{160, 90}}, seen));
        REQUIRE(world.view(request, casters));
        CHECK(casters.size() == 0);
    }

    TEST_CASE("what is counted as listed is what triangles() lists, also beside objects without clusters") {
        World world;
        const TriangleMesh cube = testing::cube_mesh();
        const MeshHandle mesh =
            world.add_mesh({.positions = cube.positions, .indices = cube.indices, .clusters = true}).value();
        for (int i = 0; i < 3; ++i) {
            const glm::dvec3 at(4.0 * i - 4.0, 0.0, -10.0);
            REQUIRE(world.add({.mesh = mesh, .transform = Transform{glm::dmat3(1.0), at}}));
            REQUIRE(world.add({.bound = Sphere{at + glm::dvec3(0.0, 3.0, 0.0), 1.0}}));
        }
        REQUIRE(world.update());
        ViewResult result;
        REQUIRE(world.view(
            {.camera = Camera{}, .picture = depth::PictureView{.width = 160, .height = 90, .samples = 4}}, result));
        CHECK(result.size() == 6);
        std::set<std::uint32_t> objects;
        std::uint64_t triangles = 0;
        for (const depth::VisibleCluster& cluster : result.triangles()) {
            objects.insert(cluster.object);
            triangles += static_cast<std::uint64_t>(std::popcount(cluster.triangles));
        }
        CHECK(objects.size() == 3);
        CHECK(result.picture_statistics().objects_listed == 3);
        CHECK(result.picture_statistics().triangles_listed == triangles);
    }

    TEST_CASE("the triangles that own a pixel are listed, by objects in order, and what is behind walls is not") {
        std::uint64_t listed_sum = 0, total = 0;
        for (std::uint64_t seed = 1; seed <= 30; ++seed) {
            CAPTURE(seed);
            oracle::NearMisses random(seed);
            const Town town = random_town(seed, random);
            // Objects were added in the order of their indices.
            for (std::size_t i = 0; i < town.placed.size(); ++i) REQUIRE(town.placed[i].object.index == i);
            const Camera camera = camera_in(random);
            ViewResult result;
            REQUIRE(town.world.view({.camera = camera, .picture = depth::PictureView{160, 90}}, result));
            CHECK(result.has_picture());
            CHECK_FALSE(result.has_occlusion());
            const auto listed = listed_in(town, result.triangles());
            // One-sided meshes: closed ones show no back face but from within.
            std::size_t lost = 0;
            for (const auto& owner : owners_of(town, camera, 160, 90)) {
                const bool one_sided =
                    town.placed[owner.first].mesh == 1 || (town.placed[owner.first].mesh == 0 && seed % 2 == 0);
                lost += !one_sided && listed.count(owner) == 0;
            }
            CHECK(lost == 0);
            CHECK(
                std::is_sorted(result.triangles().begin(), result.triangles().end(), [](const auto& a, const auto& b) {
                    return a.object != b.object ? a.object < b.object : a.cluster < b.cluster;
                }));
            std::set<std::uint32_t> objects;
            for (const auto& [object, triangle] : listed) objects.insert(object);
            CHECK(std::equal(objects.begin(), objects.end(), result.ids().begin(), result.ids().end()));
            CHECK(result.verdicts().size() == result.size());
            CHECK(result.inside_count() ==
                  std::size_t(std::count(result.verdicts().begin(), result.verdicts().end(), cull::Verdict::inside)));
            CHECK(result.picture_statistics().triangles_listed == listed.size());
            listed_sum += listed.size();
            ViewResult all;
            REQUIRE(town.world.view({.camera = camera}, all));
            for (const std::uint32_t id : all.ids()) total += town.meshes[town.placed[id].mesh].mesh.triangle_count();
            for (const std::uint32_t id : result.ids())
                CHECK(std::binary_search(all.ids().begin(), all.ids().end(), id));
        }
        CHECK(4 * listed_sum < total);
    }

    TEST_CASE("a camera, its matrix, tree order, many views and threads list the same triangles") {
        oracle::NearMisses random(77);
        const Town town = random_town(3, random);
        ThreadPool pool(2);
        std::vector<ViewRequest> requests;
        std::vector<std::vector<depth::VisibleCluster>> single;
        for (int v = 0; v < 4; ++v) {
            Camera camera = camera_in(random);
            const ViewRequest request{.camera = camera, .picture = depth::PictureView{200, 112}};
            ViewResult result, by_matrix, by_tree;
            REQUIRE(town.world.view(request, result));
            single.emplace_back(result.triangles().begin(), result.triangles().end());
            const auto same = [&](std::span<const depth::VisibleCluster> other) {
                return std::equal(other.begin(), other.end(), result.triangles().begin(), result.triangles().end(),
                                  [](const auto& a, const auto& b) {
                                      return a.object == b.object && a.cluster == b.cluster &&
                                             a.triangles == b.triangles;
                                  });
            };
            const glm::dmat4 to_clip = view_to_clip(camera) * glm::dmat4(world_to_view_rotation(camera));
            REQUIRE(town.world.view({.matrix = ViewMatrix{to_clip, DepthRange::reversed_zero_to_one, camera.position},
                                     .picture = depth::PictureView{200, 112}},
                                    by_matrix));
            CHECK(same(by_matrix.triangles()));
            ViewRequest tree = request;
            tree.order = cull::ResultOrder::tree;
            REQUIRE(town.world.view(tree, by_tree));
            CHECK(same(by_tree.triangles()));
            CHECK(by_tree.inside_count() <= by_tree.size());
            requests.push_back(request);
        }
        requests.push_back({.camera = *requests[0].camera});
        MultiViewResult many;
        REQUIRE(town.world.view(requests, many, pool));
        for (std::size_t v = 0; v < 4; ++v) {
            REQUIRE(many.triangles(v).size() == single[v].size());
            for (std::size_t i = 0; i < single[v].size(); ++i)
                CHECK(many.triangles(v)[i].triangles == single[v][i].triangles);
        }
        CHECK(many.triangles(4).empty());
        CHECK(many.triangles(5).empty());
    }

    TEST_CASE("each of many views tells its hidden objects and what its picture took, as it does alone") {
        World world;
        const TriangleMesh wall = box_mesh({-5, -5, -0.1f}, {5, 5, 0.1f});
        const MeshHandle mesh =
            world.add_mesh({.positions = wall.positions, .indices = wall.indices, .occluders = true, .clusters = true})
                .value();
        (void)world.add({.mesh = mesh, .transform = Transform{glm::dmat3(1.0), {0, 0, -10}}});
        const ObjectHandle behind =
            world.add({.mesh = mesh, .transform = Transform{glm::dmat3(0.1), {0, 0, -20}}}).value();
        (void)world.update();
        Camera away;
        away.forward = {0, 0, 1};
        const OcclusionOptions listing{.list_occluded = true};
        const depth::PictureView picture{320, 180};
        const ViewRequest requests[] = {{.camera = Camera{}, .occlusion = listing},
                                        {.camera = Camera{}, .occlusion = OcclusionOptions{}},
                                        {.camera = Camera{}, .picture = picture},
                                        {.camera = away, .occlusion = listing},
                                        {.camera = Camera{}}};
        ThreadPool pool(2);
        MultiViewResult many;
        for (int round = 0; round < 2; ++round) {  // with the memory of other requests
            for (std::size_t lead = 0; lead < 5; ++lead) {
                std::vector<ViewRequest> rotated;
                for (std::size_t v = 0; v < 5; ++v) rotated.push_back(requests[(v + lead) % 5]);
                REQUIRE(world.view(rotated, many, pool));
                for (std::size_t v = 0; v < 5; ++v) {
                    const std::size_t which = (v + lead) % 5;
                    CAPTURE(which);
                    const auto hidden = many.occluded_ids(v);
                    REQUIRE(hidden.size() == (which == 0 ? 1 : 0));
                    if (which == 0) CHECK(hidden[0] == behind.index);
                    ViewResult alone;
                    REQUIRE(world.view(rotated[v], alone));
                    CHECK(many.picture_statistics(v).triangles_listed == alone.picture_statistics().triangles_listed);
                    CHECK(many.picture_statistics(v).clusters_asked == alone.picture_statistics().clusters_asked);
                    CHECK((many.picture_statistics(v).triangles_listed > 0) == (which == 2));
                }
            }
            CHECK(many.occluded_ids(5).empty());
            CHECK(many.picture_statistics(5).objects_asked == 0);
            REQUIRE(world.view(std::span(requests).last(1), many));
            CHECK(many.occluded_ids(0).empty());
            CHECK(many.picture_statistics(0).objects_asked == 0);
        }
    }

    TEST_CASE("objects without clusters are listed where their boxes may be seen, and hide nothing") {
        World world;
        const TriangleMesh wall = box_mesh({-5, -5, -0.1f}, {5, 5, 0.1f});
        const MeshHandle mesh =
            world.add_mesh({.positions = wall.positions, .indices = wall.indices, .clusters = true}).value();
        const auto add_box = [&](double x, double z) {
            return world.add({.bound = Obb{{x, 0, z}, glm::mat3(1.0f), glm::vec3(0.5f)}}).value();
        };
        const ObjectHandle hidden = add_box(0, -20), open = add_box(12, -20), front = add_box(0, -5);
        const ObjectHandle wall_object =
            world.add({.mesh = mesh, .transform = Transform{glm::dmat3(1.0), {0, 0, -10}}}).value();
        (void)world.update();
        const ViewRequest request{.camera = Camera{}, .picture = depth::PictureView{320, 180}};
        ViewResult result;
        const auto sees = [&](ObjectHandle object) {
            return std::count(result.ids().begin(), result.ids().end(), object.index) == 1;
        };
        REQUIRE(world.view(request, result));
        CHECK_FALSE(sees(hidden));
        CHECK(sees(open));
        CHECK(sees(front));
        CHECK(sees(wall_object));
        for (const depth::VisibleCluster& c : result.triangles()) CHECK(c.object == wall_object.index);
        CHECK(result.verdict_of(hidden.index) == occlude::Verdict::outside);
        CHECK(result.verdict_of(front.index) == occlude::Verdict::inside);
        CHECK(result.occlusion_buffer() == nullptr);
        CHECK(result.picture_statistics().triangles_listed > 0);
        // A window pane hides nothing.
        REQUIRE(world.set_occludes(wall_object, false));
        (void)world.update();
        REQUIRE(world.view(request, result));
        CHECK(sees(hidden));
        REQUIRE(world.set_occludes(wall_object, true));
        // The mesh deforms: the wall shrinks to a plank.
        Vector<glm::vec3> plank = wall.positions;
        for (glm::vec3& p : plank) p.x *= 0.01f;
        REQUIRE(world.set_vertices(mesh, plank));
        (void)world.update();
        REQUIRE(world.view(request, result));
        CHECK(sees(hidden));
        CHECK(world.clusters_of(mesh) != nullptr);
        // Answers of other kinds after it.
        REQUIRE(world.view({.camera = Camera{}, .occlusion = OcclusionOptions{}}, result));
        CHECK(result.has_occlusion());
        CHECK(result.triangles().empty());
        REQUIRE(world.view({.camera = Camera{}}, result));
        CHECK_FALSE(result.has_picture());
        CHECK(sees(hidden));
    }

    TEST_CASE("clusters that were cut before are used as they are, until the mesh deforms") {
        oracle::NearMisses random(4);
        const TriangleMesh round = ball(14, random);
        // As no World would cut them.
        const auto precut = depth::ClusteredMesh::cut(round.positions, round.indices, {.max_triangles = 5}).value();
        REQUIRE(precut.clusters().size() !=
                depth::ClusteredMesh::cut(round.positions, round.indices)->clusters().size());
        World world;
        MeshDescription description{.positions = round.positions, .indices = round.indices, .clusters = true};
        description.precut = &precut;
        const MeshHandle mesh = world.add_mesh(description).value();
        const MeshHandle cut = world.add_mesh({.positions = round.positions, .indices = round.indices}).value();
        REQUIRE(world.replace_mesh(cut, description));
        const Transform place{glm::dmat3(1.0), {0, 0, -5}};
        (void)world.add({.mesh = mesh, .transform = place}).value();
        (void)world.update();
        for (const MeshHandle handle : {mesh, cut}) {
            REQUIRE(world.clusters_of(handle) != nullptr);
            CHECK(world.clusters_of(handle)->clusters().size() == precut.clusters().size());
            CHECK(std::equal(precut.triangle_order().begin(), precut.triangle_order().end(),
                             world.clusters_of(handle)->triangle_order().begin()));
        }
        ViewResult visible;
        REQUIRE(world.view({.camera = Camera{}, .picture = depth::PictureView{160, 90}}, visible));
        depth::DepthCuller culler;
        const std::vector<depth::DepthObject> alone = {
            {&precut, glm::mat4(world_to_clip(Camera{}) * glm::translate(glm::dmat4(1.0), {0, 0, -5}))}};
        const auto expected = culler.find_visible(alone, {160, 90});
        REQUIRE(visible.triangles().size() == expected->size());
        for (std::size_t i = 0; i < expected->size(); ++i)
            CHECK(visible.triangles()[i].triangles == (*expected)[i].triangles);

        TriangleMesh wider = round;
        for (glm::vec3& p : wider.positions) p.x *= 2.0f;
        description.positions = wider.positions;
        CHECK(error_of(world.add_mesh(description)).message.find("`precut`") != std::string::npos);
        CHECK(error_of(world.replace_mesh(mesh, description)).message.find("`precut`") != std::string::npos);
        CHECK(world.clusters_of(mesh)->clusters().size() == precut.clusters().size());
        description.positions = round.positions;
        description.indices = std::span<const std::uint32_t>(round.indices).first(round.indices.size() - 3);
        CHECK_FALSE(world.add_mesh(description));

        // One that was moved by a little, which its size does not tell.
        TriangleMesh other = round;
        std::swap(other.positions[100], other.positions[130]);
        description.indices = round.indices;
        description.positions = other.positions;
        CHECK(error_of(world.add_mesh(description)).message.find("`precut`") != std::string::npos);

        REQUIRE(world.set_vertices(mesh, wider.positions));
        (void)world.update();
        depth::ClusteredMesh fitted = precut;
        REQUIRE(fitted.refit(wider.positions, wider.indices));
        CHECK(world.clusters_of(mesh)->serialise() == fitted.serialise());
    }

    TEST_CASE("clusters read the World's positions in place, and views are as of the last update all the same") {
        oracle::NearMisses random(5);
        TriangleMesh round = ball(14, random);
        World world;
        const MeshHandle mesh =
            world.add_mesh({.positions = round.positions, .indices = round.indices, .clusters = true}).value();
        (void)world.add({.mesh = mesh, .transform = Transform{glm::dmat3(1.0), {0, 0, -5}}}).value();
        (void)world.update();
        auto cut = depth::ClusteredMesh::cut(round.positions, round.indices).value();
        const auto memory = [&] {
            REQUIRE(cut.refit(round.positions, round.indices));
            REQUIRE(cut.lend(round.positions, round.indices, depth::IndexOrder::original));
            return cut.memory();
        };
        CHECK(world.clusters_of(mesh)->memory() == memory());
        const auto seen = [&] {
            ViewResult visible;
            REQUIRE(world.view({.camera = Camera{}, .picture = depth::PictureView{160, 90}}, visible));
            std::vector<std::uint64_t> numbers;
            for (const depth::VisibleCluster& c : visible.triangles())
                numbers.insert(numbers.end(), {c.object, c.cluster, c.triangles});
            return numbers;
        };
        const auto before = seen();
        REQUIRE_FALSE(before.empty());
        for (glm::vec3& p : round.positions) p *= glm::vec3(2.0f, 0.1f, 0.5f);
        REQUIRE(world.set_vertices(mesh, round.positions));
        CHECK(seen() == before);
        (void)world.update();
        CHECK(seen() != before);
        CHECK(world.clusters_of(mesh)->memory() == memory());
        CHECK(std::ranges::equal(world.clusters_of(mesh)->triangle_order(), cut.triangle_order()));
        // Many more meshes, so that the World's lists move.
        for (int i = 0; i < 100; ++i)
            (void)world.add_mesh({.positions = round.positions, .indices = round.indices, .clusters = true}).value();
        const auto after = seen();
        (void)world.update();
        CHECK(seen() == after);
    }

    TEST_CASE(
        "permuted clusters that were lent belong to the permuted mesh, and the World does not read what was lent") {
        oracle::NearMisses random(6);
        const TriangleMesh round = ball(14, random);
        auto precut = depth::ClusteredMesh::cut(round.positions, round.indices).value();
        TriangleMesh permuted = round;
        precut.permute(round.indices, permuted.indices);
        World world;
        {
            const TriangleMesh lent = permuted;
            REQUIRE(precut.lend(lent.positions, lent.indices));
            MeshDescription description{.positions = round.positions, .indices = round.indices, .clusters = true};
            description.precut = &precut;
            CHECK(error_of(world.add_mesh(description)).message.find("`precut`") != std::string::npos);
            description.indices = permuted.indices;
            const MeshHandle mesh = world.add_mesh(description).value();
            (void)world.add({.mesh = mesh, .transform = Transform{glm::dmat3(1.0), {0, 0, -5}}}).value();
        }
        precut = {};
        (void)world.update();
        ViewResult visible;
        REQUIRE(world.view({.camera = Camera{}, .picture = depth::PictureView{160, 90}}, visible));
        CHECK_FALSE(visible.triangles().empty());
    }

    TEST_CASE("a light's view refuses the camera's answer once the World has changed, whatever has changed") {
        struct Stage {
            World world;
            MeshHandle mesh, other;
            ObjectHandle floor, roof;
            NodeHandle node;
            RegionHandle region;
        };
        const TriangleMesh cube = cube_mesh(), slab = box_mesh({-5, -0.1f, -5}, {5, 0.1f, 5});
        const auto describe = [](const TriangleMesh& mesh) {
            return MeshDescription{.positions = mesh.positions, .indices = mesh.indices, .clusters = true};
        };
        const std::vector<RegionObject> below = {
            {.bound = Obb{.center = {0, -50, 0}, .half_extents = glm::vec3(1.0f)}}};
        const Region region = Region::prepare(below).value();
        struct Change {
            const char* name;
            bool changes;
            std::function<void(Stage&)> make;
        };
        const auto updated = [](Stage& s) { (void)s.world.update(); };
        const std::vector<Change> changes = {
            {"nothing", false, [](Stage&) {}},
            {"an update of nothing", false, updated},
            {"meshes are added", false,
             [&](Stage& s) {
                 for (int i = 0; i < 20; ++i) (void)s.world.add_mesh(describe(cube)).value();
             }},
            {"a transform waits for the update", false,
             [&](Stage& s) {
                 REQUIRE(s.world.set_transform(s.floor, {glm::dmat3(1.0), {0, -3, -8}}));
             }},
            {"vertices wait for the update", false,
             [&](Stage& s) { REQUIRE(s.world.set_vertices(s.mesh, slab.positions)); }},
            {"an object moves", true,
             [&](Stage& s) {
                 REQUIRE(s.world.set_transform(s.floor, {glm::dmat3(1.0), {0, -3, -8}}));
                 updated(s);
             }},
            {"a node moves", true,
             [&](Stage& s) {
                 REQUIRE(s.world.set_transform(s.node, {glm::dmat3(1.0), {0, 1, 0}}));
                 updated(s);
             }},
            {"an object comes", true,
             [&](Stage& s) {
                 (void)s.world.add({.mesh = s.mesh, .transform = Transform{glm::dmat3(1.0), {0, 3, -8}}}).value();
                 updated(s);
             }},
            {"a mesh deforms", true,
             [&](Stage& s) {
                 TriangleMesh deformed = slab;  // within the same box
                 std::swap(deformed.positions[0], deformed.positions[1]);
                 REQUIRE(s.world.set_vertices(s.mesh, deformed.positions));
                 updated(s);
             }},
            {"a mesh is replaced", true, [&](Stage& s) { REQUIRE(s.world.replace_mesh(s.mesh, describe(cube))); }},
            {"an object gets another mesh", true,
             [&](Stage& s) {
                 REQUIRE(s.world.set_mesh(s.floor, s.other));
                 updated(s);
             }},
            {"an object hides", true,
             [&](Stage& s) {
                 REQUIRE(s.world.set_hidden(s.roof, true));
                 updated(s);
             }},
            {"a node is in other layers", true,
             [&](Stage& s) {
                 REQUIRE(s.world.set_layers(s.node, 2));
                 updated(s);
             }},
            {"an object goes", true, [](Stage& s) { REQUIRE(s.world.remove(s.floor)); }},
            {"a node goes with what hangs on it", true, [](Stage& s) { REQUIRE(s.world.remove(s.node)); }},
            {"an object and its mesh go", true,
             [](Stage& s) {
                 REQUIRE(s.world.remove(s.floor));
                 REQUIRE(s.world.remove(s.mesh));
             }},
            {"all goes, and other things come to its places", true,
             [&](Stage& s) {
                 for (const ObjectHandle object : {s.floor, s.roof}) REQUIRE(s.world.remove(object));
                 for (const MeshHandle mesh : {s.mesh, s.other}) REQUIRE(s.world.remove(mesh));
                 const MeshHandle mesh = s.world.add_mesh(describe(cube)).value();
                 updated(s);
                 for (int i = 0; i < 2; ++i)
                     (void)s.world.add({.mesh = mesh, .transform = Transform{glm::dmat3(1.0), {0, 0, -8.0 - i}}})
                         .value();
                 updated(s);
             }},
            {"a region comes", true,
             [&](Stage& s) {
                 (void)s.world.attach(region, {0, 0, 0}).value();
                 updated(s);
             }},
            {"a region goes", true,
             [&](Stage& s) {
                 REQUIRE(s.world.detach(s.region));
                 updated(s);
             }},
            {"the World moves", false,
             [](Stage& s) {
                 World moved = std::move(s.world);
                 s.world = std::move(moved);
             }},
            {"another World comes to its place", true,
             [&](Stage& s) {
                 s.world = World();
                 const MeshHandle mesh = s.world.add_mesh(describe(cube)).value();
                 (void)s.world.add({.mesh = mesh, .transform = Transform{glm::dmat3(1.0), {0, 0, -8}}}).value();
                 updated(s);
             }},
        };
        for (const Change& change : changes) {
            const std::string name = change.name;
            CAPTURE(name);
            Stage s;
            s.mesh = s.world.add_mesh(describe(slab)).value(), s.other = s.world.add_mesh(describe(cube)).value();
            s.node = s.world.add_node().value();
            s.region = s.world.attach(region, {1, 2, 3}).value();
            s.floor = s.world.add({.mesh = s.mesh, .transform = Transform{glm::dmat3(1.0), {0, -2, -8}}}).value();
            s.roof = s.world.add({.mesh = s.other, .node = s.node, .transform = Transform{glm::dmat3(1.0), {0, 2, -8}}})
                         .value();
            (void)s.world.update();
            Camera lamp;
            lamp.position = {0, 8, -8};
            lamp.forward = {0, -1, 0};
            lamp.up = {0, 0, -1};
            const depth::PictureView picture{160, 90};
            ViewResult seen, casters;
            const ViewRequest of_camera{.camera = Camera{}, .picture = picture};
            const ViewRequest of_lamp{.camera = lamp, .picture = picture, .receivers = ShadowReceivers{&seen}};
            REQUIRE(s.world.view(of_camera, seen));
            REQUIRE(s.world.view(of_lamp, casters));
            CHECK(casters.size() == 2);
            change.make(s);
            ViewResult between;
            REQUIRE(s.world.view(of_camera, between));
            for (const bool of_many : {false, true}) {
                MultiViewResult many;
                const auto answer =
                    of_many ? s.world.view(std::vector<ViewRequest>(2, of_lamp), many) : s.world.view(of_lamp, casters);
                CHECK(answer.has_value() == !change.changes);
                if (answer) continue;
                CHECK(error_of(answer).code == ErrorCode::invalid_argument);
                const std::string message = error_of(answer).message;
                CHECK((message.find("changed since") != message.npos || message.find("this World") != message.npos));
            }
            (void)s.world.update();
            REQUIRE(s.world.view(of_camera, seen));
            CHECK(s.world.view(of_lamp, casters));
        }
    }

    TEST_CASE("requests that cannot be obeyed are refused by name") {
        World world;
        ViewResult result;
        const depth::PictureView picture{320, 180};
        CHECK(error_of(world.view({.volume = *frustum_of(Camera{}), .picture = picture}, result)).code ==
              ErrorCode::invalid_argument);
        CHECK(error_of(world.view({.camera = Camera{}, .occlusion = OcclusionOptions{}, .picture = picture}, result))
                  .code == ErrorCode::invalid_argument);
        CHECK(error_of(world.view({.camera = Camera{}, .picture = depth::PictureView{0, 180}}, result)).code ==
              ErrorCode::out_of_range);
        CHECK(error_of(world.view({.camera = Camera{}, .picture = depth::PictureView{20000, 180}}, result)).code ==
              ErrorCode::out_of_range);
        CHECK(error_of(world.view({.camera = Camera{}, .picture = depth::PictureView{.samples = 3}}, result)).code ==
              ErrorCode::out_of_range);
        CHECK(error_of(world.view(
                           {.matrix = ViewMatrix{world_to_clip(Camera{}), DepthRange::zero_to_one}, .picture = picture},
                           result))
                  .code == ErrorCode::invalid_argument);
        ViewResult seen, plain;
        REQUIRE(world.view({.camera = Camera{}, .picture = picture}, seen));
        REQUIRE(world.view({.camera = Camera{}}, plain));
        const auto code_of = [&](const ShadowReceivers& receivers, const std::optional<depth::PictureView>& map) {
            const ViewRequest request{.camera = Camera{}, .picture = map, .receivers = receivers};
            const Error error = error_of(world.view(request, result));
            const auto of_many = world.view(std::vector<ViewRequest>(1, request), *std::make_unique<MultiViewResult>());
            CHECK(error_of(of_many).code == error.code);
            CHECK(error_of(of_many).item == 0);
            return error.code;
        };
        World other;
        ViewResult of_other;
        REQUIRE(other.view({.camera = Camera{}, .picture = picture}, of_other));
        CHECK(code_of({}, picture) == ErrorCode::invalid_argument);
        CHECK(code_of({&plain}, picture) == ErrorCode::invalid_argument);
        CHECK(code_of({&of_other}, picture) == ErrorCode::invalid_argument);
        CHECK(code_of({&seen}, std::nullopt) == ErrorCode::invalid_argument);
        CHECK(code_of({&seen, 0.25f}, picture) == ErrorCode::out_of_range);
        CHECK(code_of({&seen, 2000.0f}, picture) == ErrorCode::out_of_range);
        CHECK(code_of({&seen}, depth::PictureView{.samples = 2}) == ErrorCode::out_of_range);
        CHECK(error_of(world.view({.camera = Camera{}, .picture = picture, .receivers = ShadowReceivers{&seen}}, seen))
                  .code == ErrorCode::invalid_argument);
        CHECK(seen.has_picture());
        MultiViewResult many;
        const std::vector<ViewRequest> two = {{.camera = Camera{}, .picture = picture},
                                              {.camera = Camera{}, .picture = depth::PictureView{0, 0}}};
        const auto refused = world.view(two, many);
        REQUIRE_FALSE(refused);
        CHECK(refused.error().item == 1);
        REQUIRE(world.view({.camera = Camera{}, .picture = picture}, result));
        CHECK(result.size() == 0);
        CHECK(world.clusters_of({}) == nullptr);
        // A mesh that cannot be cut leaves nothing behind.
        TriangleMesh far = cube_mesh();
        for (glm::vec3& p : far.positions) p *= 1e16f;
        const auto added = world.add_mesh({.positions = far.positions, .indices = far.indices, .clusters = true});
        CHECK_FALSE(added);
    }
}

}  // namespace crofton::testing
