// SPDX-License-Identifier: MIT
// One scene in a World of each interface, C and C++: the same objects, nodes and changes.
#pragma once
#include <array>
#include <crofton/core/executor.hpp>
#include <crofton/crofton.hpp>
#include <cstring>
#include <error_of.hpp>
#include <oracle/random_boxes.hpp>
#include <vector>

#include "handles.hpp"

namespace crofton::capi_test {

template <class To, class From>
To same_bytes(const From& from) {
    static_assert(sizeof(To) == sizeof(From));
    To to;
    std::memcpy(static_cast<void*>(&to), static_cast<const void*>(&from), sizeof to);
    return to;
}

// The same objects in a World of each interface.
struct BothWorlds {
    World world{{.mesh_depth = true}};
    WorldHandle c;
    std::vector<crofton_object> objects;  // of the one in C
    std::uint32_t lead = 0;               // of generations in the other: they begin elsewhere in each World
    std::vector<bool> has_mesh;
    std::vector<crofton_node> nodes;
    ThreadPool pool{3};
    crofton_jobs jobs = sized<crofton_jobs>();

    BothWorlds() {
        auto options = sized<crofton_world_options>();
        options.mesh_depth = 1;
        c = make_world(&options);
        jobs.user = &pool;
        jobs.concurrency = pool.concurrency();
        jobs.parallel_for = [](void* user, size_t count, size_t grain, crofton_range_task task, void* data) {
            static_cast<ThreadPool*>(user)->parallel_for(
                count, grain, [&](std::size_t begin, std::size_t end, unsigned w) { task(data, begin, end, w); });
        };
    }
    [[nodiscard]] ObjectHandle object(std::size_t i) const { return twin<ObjectHandle>(objects[i]); }
    [[nodiscard]] NodeHandle node(std::size_t i) const { return twin<NodeHandle>(nodes[i]); }
    // What a handle of the World in C is in the other.
    template <class Handle, class Given>
    [[nodiscard]] Handle twin(const Given& given) const {
        return {given.index, given.generation + lead};
    }
};

inline Transform random_transform(oracle::NearMisses& random) {
    const Obb turned = oracle::random_box(random, {}, 8.0);
    return {glm::dmat3(turned.axes) * random.number(0.5, 3.0), turned.center};
}

// Two meshes: floats with a stride and 16-bit indices; doubles without indices.
inline std::array<crofton_world_mesh, 2> add_meshes(BothWorlds& both) {
    struct Vertex {
        glm::vec3 position;
        float other;
    };
    const Tetrahedron source;
    std::vector<Vertex> vertices;
    std::vector<glm::dvec3> corners;
    for (std::size_t i = 0; i < 4; ++i) {
        const float* p = &source.positions[3 * i];
        vertices.push_back({{p[0], p[1], p[2]}, 9.0f});
    }
    for (const std::uint32_t i : source.indices) corners.push_back(2.0 * glm::dvec3(vertices[i].position));
    const std::vector<std::uint16_t> indices(source.indices.begin(), source.indices.end());
    auto data = sized<crofton_mesh_data>();
    data.positions = vertices.data();
    data.position_count = vertices.size();
    data.position_stride = sizeof(Vertex);
    data.indices = indices.data();
    data.index_count = indices.size();
    data.is_short = 1;
    std::array<crofton_world_mesh, 2> meshes{};
    REQUIRE(crofton_world_add_mesh(both.c.get(), &data, &meshes[0]) == CROFTON_OK);
    data = sized<crofton_mesh_data>();
    data.positions = corners.data();
    data.position_count = corners.size();
    data.is_double = 1;
    REQUIRE(crofton_world_add_mesh(both.c.get(), &data, &meshes[1]) == CROFTON_OK);
    const auto first = both.world.add_mesh(
        {.positions = {&vertices[0].position.x, vertices.size(), sizeof(Vertex)}, .indices = indices});
    const auto second = both.world.add_mesh({.positions = corners});
    both.lead = first.value().generation - meshes[0].generation;
    REQUIRE(first.value() == both.twin<MeshHandle>(meshes[0]));
    REQUIRE(second.value() == both.twin<MeshHandle>(meshes[1]));
    return meshes;
}

inline void add_nodes(BothWorlds& both, oracle::NearMisses& random, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
        NodeDescription description{.transform = random_transform(random), .layers = random.index(4) ? ~0u : 5u};
        const crofton_node* parent = nullptr;
        if (i > 0 && random.index(2)) {
            const std::size_t which = random.index(static_cast<unsigned>(i));
            parent = &both.nodes[which];
            description.parent = both.node(which);
        }
        const auto transform = same_bytes<crofton_transform>(description.transform);
        crofton_node node{};
        REQUIRE(crofton_world_add_node(both.c.get(), parent, &transform, description.layers, &node) == CROFTON_OK);
        REQUIRE(both.world.add_node(description).value() == both.twin<NodeHandle>(node));
        both.nodes.push_back(node);
    }
}

inline void random_bound(oracle::NearMisses& random, crofton_bound& c, Bound& bound) {
    const Obb box = oracle::random_box(random, {}, 10.0);
    const Aabb aligned = aabb_of(box);
    const Sphere sphere{box.center, static_cast<double>(box.half_extents.x)};
    const unsigned kind = random.index(3);
    c = sphere_bound(sphere.center.x, sphere.center.y, sphere.center.z, sphere.radius);
    c.kind = kind + CROFTON_BOUND_BOX;
    c.box = same_bytes<crofton_box>(box);
    for (int k = 0; k < 3; ++k) {
        c.min[k] = aligned.min[k];
        c.max[k] = aligned.max[k];
    }
    bound = kind == 0 ? Bound(box) : kind == 1 ? Bound(aligned) : Bound(sphere);
}

inline void add_object(BothWorlds& both, oracle::NearMisses& random, const std::array<crofton_world_mesh, 2>& meshes) {
    auto c = sized<crofton_object_description>();
    ObjectDescription description;
    crofton_bound bound{};
    crofton_transform transform{};
    const bool has_mesh = random.index(2) == 0;
    if (has_mesh) {
        c.has_mesh = 1;
        c.mesh = meshes[random.index(2)];
        description.mesh = both.twin<MeshHandle>(c.mesh);
        if (random.index(2)) {
            const std::size_t node = random.index(static_cast<unsigned>(both.nodes.size()));
            c.has_node = 1;
            c.node = both.nodes[node];
            description.node = both.node(node);
        }
        description.transform = random_transform(random);
        transform = same_bytes<crofton_transform>(*description.transform);
        c.transform = &transform;
    } else {
        random_bound(random, bound, description.bound);
        c.bound = &bound;
    }
    c.user = description.user = random.index(1u << 30);
    description.layers = 1u << random.index(4) | 1u << random.index(4);
    c.layers = description.layers;
    description.collides_with = random.index(3) ? ~0u : 3u;
    c.collides_with = description.collides_with;
    crofton_object object{};
    REQUIRE(crofton_world_add(both.c.get(), &c, &object) == CROFTON_OK);
    REQUIRE(both.world.add(description).value() == both.twin<ObjectHandle>(object));
    both.objects.push_back(object);
    both.has_mesh.push_back(has_mesh);
}

// Changes of every kind.
inline void change(BothWorlds& both, oracle::NearMisses& random) {
    World& world = both.world;
    crofton_world* const c = both.c.get();
    const auto any = [&](std::size_t count) { return random.index(static_cast<unsigned>(count)); };
    struct Moved {
        crofton_object object;
        crofton_transform transform;
        crofton_box box;
    };
    std::vector<Moved> moved;  // meshes and bounds alike: each call refuses the others
    std::vector<ObjectHandle> handles;
    std::vector<Transform> transforms;
    std::vector<Obb> boxes;
    for (int i = 0; i < 20; ++i) {
        const std::size_t object = any(both.objects.size());
        handles.push_back(both.object(object));
        transforms.push_back(random_transform(random));
        boxes.push_back(oracle::random_box(random, {}, 10.0));
        moved.push_back({both.objects[object], same_bytes<crofton_transform>(transforms.back()),
                         same_bytes<crofton_box>(boxes.back())});
    }
    const auto placed = world.set_transforms(handles, transforms);
    REQUIRE((crofton_world_set_transforms(c, &moved[0].object, sizeof(Moved), &moved[0].transform, sizeof(Moved),
                                          moved.size()) == CROFTON_OK) == placed.has_value());
    if (!placed) CHECK(crofton_last_error_item() == error_of(placed).item);
    const auto boxed = world.set_bounds(handles, boxes);
    REQUIRE((crofton_world_set_boxes(c, &moved[0].object, sizeof(Moved), &moved[0].box, sizeof(Moved), moved.size()) ==
             CROFTON_OK) == boxed.has_value());
    if (!boxed) CHECK(crofton_last_error_item() == error_of(boxed).item);
    for (int i = 0; i < 6; ++i) {
        const std::size_t o = any(both.objects.size()), n = any(both.nodes.size()), p = any(both.nodes.size());
        const crofton_object object = both.objects[o];
        const std::uint32_t layers = random.index(16);
        const auto node_place = random_transform(random);
        const auto c_place = same_bytes<crofton_transform>(node_place);
        const bool known = world.contains(both.object(o));
        CHECK((world_set_hidden(c, object, i % 2) == CROFTON_OK) == known);
        CHECK(world.set_hidden(both.object(o), i % 2 != 0).has_value() == known);
        CHECK((world_set_layers(c, object, layers) == CROFTON_OK) == known);
        CHECK(world.set_layers(both.object(o), layers).has_value() == known);
        CHECK((world_set_collides_with(c, object, ~layers) == CROFTON_OK) == known);
        CHECK(world.set_collides_with(both.object(o), ~layers).has_value() == known);
        CHECK((world_set_user(c, object, layers + 1000) == CROFTON_OK) == known);
        CHECK(world.set_user(both.object(o), layers + 1000).has_value() == known);
        CHECK(crofton_world_set_node_transforms(c, &both.nodes[n], 0, &c_place, 0, 1) == CROFTON_OK);
        CHECK(world.set_transform(both.node(n), node_place).has_value());
        const bool hung = world.set_parent(both.node(n), both.node(p)).has_value();
        CHECK((crofton_world_set_parent(c, both.nodes[n], &both.nodes[p]) == CROFTON_OK) == hung);
        CHECK(crofton_world_set_node_layers(c, both.nodes[n], layers | 1u) == CROFTON_OK);
        CHECK(world.set_layers(both.node(n), layers | 1u).has_value());
    }
    const std::size_t gone = any(both.objects.size());
    CHECK((crofton_world_remove(c, both.objects[gone]) == CROFTON_OK) == world.remove(both.object(gone)).has_value());
}

}  // namespace crofton::capi_test
