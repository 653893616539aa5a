// SPDX-License-Identifier: MIT
// A small world in C, for tests of what is refused.
#pragma once
#include <cstddef>
#include <limits>

#include "handles.hpp"

namespace crofton::capi_test {

inline const double kNotANumber = std::numeric_limits<double>::quiet_NaN(),
                    kNoLimit = std::numeric_limits<double>::infinity();

inline crofton_status try_add(const WorldHandle& world, const crofton_bound& bound, crofton_object& object,
                              std::uint64_t user = 0) {
    auto description = sized<crofton_object_description>();
    description.bound = &bound;
    description.user = user;
    return crofton_world_add(world.get(), &description, &object);
}

inline crofton_object add_bound(const WorldHandle& world, const crofton_bound& bound, std::uint64_t user = 0) {
    crofton_object object{};
    REQUIRE(try_add(world, bound, object, user) == CROFTON_OK);
    return object;
}

inline void update(const WorldHandle& world) {
    REQUIRE(crofton_world_update(world.get(), nullptr) == CROFTON_OK);
}

inline crofton_mesh_data data_of(const Tetrahedron& tetrahedron) {
    auto data = sized<crofton_mesh_data>();
    data.positions = tetrahedron.positions.data();
    data.position_count = tetrahedron.positions.size() / 3;
    data.indices = tetrahedron.indices.data();
    data.index_count = tetrahedron.indices.size();
    return data;
}

inline crofton_world_mesh add_tetrahedron(const WorldHandle& world) {
    const Tetrahedron tetrahedron;
    const crofton_mesh_data data = data_of(tetrahedron);
    crofton_world_mesh mesh{};
    REQUIRE(crofton_world_add_mesh(world.get(), &data, &mesh) == CROFTON_OK);
    return mesh;
}

// One object, and results to ask it with.
struct SmallWorld {
    WorldHandle world = make_world();
    ViewResultHandle visible = make_view_result();
    ViewResultHandle in_views = make_view_result();
    Found found = make_found();
    crofton_object box = add_bound(world, box_bound(box_at(0, 0, -5)), 7);
    SmallWorld() { update(world); }
};

}  // namespace crofton::capi_test
