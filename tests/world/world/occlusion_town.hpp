// SPDX-License-Identifier: MIT
// A town in a World whose houses hide things, and rays that witness what is seen.
#pragma once
#include <crofton/crofton.hpp>
#include <glm/geometric.hpp>
#include <oracle/random_boxes.hpp>
#include <vector>

namespace crofton::testing {

using oracle::NearMisses;

inline TriangleMesh cuboid(const glm::vec3& half) {
    TriangleMesh mesh;
    for (unsigned i = 0; i < 8; ++i)
        mesh.positions.push_back({i & 1u ? half.x : -half.x, i & 2u ? half.y : -half.y, i & 4u ? half.z : -half.z});
    mesh.indices = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                    2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
    return mesh;
}

inline MeshDescription description_of(const TriangleMesh& mesh, bool occluders) {
    return {.positions = mesh.positions, .indices = mesh.indices, .occluders = occluders};
}

inline Transform at(double x, double y, double z) {
    return {glm::dmat3(1.0), {x, y, z}};
}

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
    [[nodiscard]] static Transform place(NearMisses& random) {
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
inline bool is_witnessed(const World& world, const Camera& camera, const Frustum& frustum, ObjectHandle object,
                         std::uint32_t layers, NearMisses& random) {
    const Obb box = world.box_of(object).value();
    for (int n = 0; n < 12; ++n) {
        glm::dvec3 point = box.center;
        for (int k = 0; k < 3; ++k)
            point += 0.999 * random.number(-1.0, 1.0) * double(box.half_extents[k]) * glm::dvec3(box.axes[k]);
        bool in_view = true;
        for (const Plane& plane : frustum.view())
            in_view = in_view && glm::dot(plane.normal, point - frustum.origin) + plane.offset > 1e-6;
        const auto hit = world.raycast({camera.position, point - camera.position, 1.0}, {layers});
        // What begins before the near plane is not drawn: such a ray tells nothing.
        if (in_view && hit && hit->object == object && hit->t * glm::length(point - camera.position) > 0.3) return true;
    }
    return false;
}

}  // namespace crofton::testing
