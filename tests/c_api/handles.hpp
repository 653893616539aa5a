// SPDX-License-Identifier: MIT
// Handles that destroy themselves, and structs with their size set, for the tests of the C API.
#pragma once
#include <crofton/capi/bake.h>
#include <crofton/capi/crofton.h>
#include <doctest/doctest.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "shorthand.hpp"

namespace crofton::capi_test {

template <class Handle, crofton_status (*kDestroy)(Handle*)>
struct Destroy {
    void operator()(Handle* handle) const { kDestroy(handle); }
};
template <class Handle, crofton_status (*kDestroy)(Handle*)>
using Owned = std::unique_ptr<Handle, Destroy<Handle, kDestroy>>;
using Scene = Owned<crofton_scene, crofton_scene_destroy>;
using Tree = Owned<crofton_tree, crofton_tree_destroy>;
using VisibleSet = Owned<crofton_view_result, crofton_view_result_destroy>;
using Broadphase = Owned<crofton_broadphase, crofton_broadphase_destroy>;
using Triangulator = Owned<crofton_triangulator, crofton_triangulator_destroy>;
using WorldHandle = Owned<crofton_world, crofton_world_destroy>;
using ViewResultHandle = Owned<crofton_view_result, crofton_view_result_destroy>;
using ShapeHandle = Owned<crofton_shape, crofton_shape_destroy>;
using ShapeContactsHandle = Owned<crofton_shape_contacts, crofton_shape_contacts_destroy>;
using Found = Owned<crofton_found, crofton_found_destroy>;
using ClusteredMesh = Owned<crofton_clustered_mesh, crofton_clustered_mesh_destroy>;
using RegionOwner = Owned<crofton_region, crofton_region_destroy>;
using DepthCuller = Owned<crofton_depth_culler, crofton_depth_culler_destroy>;

template <class OwnedHandle, class... Arguments>
OwnedHandle make(crofton_status (*create)(Arguments..., typename OwnedHandle::pointer*), Arguments... arguments) {
    typename OwnedHandle::pointer handle = nullptr;
    REQUIRE(create(arguments..., &handle) == CROFTON_OK);
    return OwnedHandle(handle);
}
inline Scene make_scene() {
    return make<Scene>(crofton_scene_create);
}
inline VisibleSet make_visible_set() {
    return make<VisibleSet>(crofton_view_result_create);
}
inline Broadphase make_broadphase() {
    return make<Broadphase>(crofton_broadphase_create);
}
inline Triangulator make_triangulator() {
    return make<Triangulator>(crofton_triangulator_create);
}
inline WorldHandle make_world(const crofton_world_options* options = nullptr) {
    crofton_world* world = nullptr;
    REQUIRE(crofton_world_create(options, &world) == CROFTON_OK);
    return WorldHandle(world);
}
inline ViewResultHandle make_view_result() {
    return make<ViewResultHandle>(crofton_view_result_create);
}
inline Found make_found() {
    return make<Found>(crofton_found_create);
}
inline DepthCuller make_depth_culler() {
    return make<DepthCuller>(crofton_depth_culler_create);
}

// With the defaults of its members.
template <class Struct>
Struct sized() {
    Struct result{};
    result.size = sizeof result;
    return result;
}
template <>
inline crofton_world_options sized() {
    return crofton_default_world_options();
}
template <>
inline crofton_mesh_data sized() {
    return crofton_default_mesh_data();
}
template <>
inline crofton_object_description sized() {
    return crofton_default_object_description();
}
template <>
inline crofton_view_request sized() {
    return crofton_default_view_request();
}
template <>
inline crofton_depth_object sized() {
    return crofton_default_depth_object();
}
template <>
inline crofton_picture_view sized() {
    return crofton_default_picture_view();
}
template <>
inline crofton_shadow_receivers sized() {
    return crofton_default_shadow_receivers();
}
template <>
inline crofton_depth_receivers sized() {
    return crofton_default_depth_receivers();
}

template <class Given>
crofton_status look(const crofton_world* world, const Given& view, crofton_view_result* result) {
    const crofton_view_request request = request_of(view);
    return crofton_world_view(world, &request, 1, nullptr, result);
}
inline crofton_status look_at_many(const crofton_world* world, std::span<const View> views,
                                   crofton_view_result* result) {
    std::vector<crofton_view_request> requests;
    for (const View& view : views) requests.push_back(request_of(view));
    return crofton_world_view(world, requests.data(), requests.size(), nullptr, result);
}

inline crofton_box box_at(double x, double y, double z, float half = 0.5f) {
    return {{x, y, z}, {1, 0, 0, 0, 1, 0, 0, 0, 1}, {half, half, half}};
}

inline View default_view() {
    crofton_camera camera = crofton_default_camera();
    View view;
    view.frustum.size = sizeof view.frustum;
    REQUIRE(crofton_frustum_from_camera(&camera, &view.frustum) == CROFTON_OK);
    return view;
}

// A tetrahedron with its right angle at the origin and legs of one.
struct Tetrahedron {
    std::vector<float> positions{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    std::vector<std::uint32_t> indices{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    crofton_mesh mesh() const {
        return {sizeof(crofton_mesh), positions.data(), positions.size() / 3,
                indices.data(),       indices.size(),   "tetrahedron"};
    }
};

inline ShapeHandle make_mesh_shape(float size = 1.0f) {
    Tetrahedron tetrahedron;
    for (float& x : tetrahedron.positions) x *= size;
    const crofton_mesh mesh = tetrahedron.mesh();
    crofton_shape* shape = nullptr;
    REQUIRE(shape_mesh(&mesh, 0, &shape) == CROFTON_OK);
    return ShapeHandle(shape);
}

inline crofton_transform translation(double x, double y, double z) {
    return {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {x, y, z}};
}

inline crofton_bound box_bound(const crofton_box& box) {
    crofton_bound bound{};
    bound.kind = CROFTON_BOUND_BOX;
    bound.box = box;
    return bound;
}
inline crofton_bound sphere_bound(double x, double y, double z, double radius) {
    crofton_bound bound{};
    bound.kind = CROFTON_BOUND_SPHERE;
    bound.center[0] = x;
    bound.center[1] = y;
    bound.center[2] = z;
    bound.radius = radius;
    return bound;
}

inline bool mentions(const char* text, const char* part) {
    return std::string(text).find(part) != std::string::npos;
}

}  // namespace crofton::capi_test
