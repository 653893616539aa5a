// SPDX-License-Identifier: MIT
// Bodies of all kinds, in C.
#pragma once
#include "handles.hpp"

namespace crofton::capi_test {

inline BodyHandle box_body(float x, float y, float z) {
    const float half[3] = {x, y, z};
    crofton_body* body = nullptr;
    REQUIRE(body_box(half, &body) == CROFTON_OK);
    return BodyHandle(body);
}

inline std::vector<float> octahedron() {
    return {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0.1f, 0.1f, 0.1f};
}

inline BodyHandle hull_body() {
    const std::vector<float> points = octahedron();
    crofton_body* body = nullptr;
    REQUIRE(body_hull(points.data(), points.size() / 3, &body) == CROFTON_OK);
    return BodyHandle(body);
}

// One of each kind. The compound is the last.
inline std::vector<BodyHandle> all_kinds() {
    std::vector<BodyHandle> bodies;
    const auto keep = [&](crofton_status status, crofton_body* body) {
        REQUIRE(status == CROFTON_OK);
        bodies.emplace_back(body);
    };
    crofton_body* made = nullptr;
    crofton_status status = body_sphere(0.5f, &made);
    keep(status, made);
    status = body_round(CROFTON_BODY_CAPSULE, 0.5f, 0.25f, &made);
    keep(status, made);
    status = body_round(CROFTON_BODY_CYLINDER, 0.5f, 0.5f, &made);
    keep(status, made);
    status = body_round(CROFTON_BODY_CONE, 0.5f, 0.5f, &made);
    keep(status, made);
    bodies.push_back(box_body(0.5f, 0.25f, 1.0f));
    const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    status = body_triangle(corners, &made);
    keep(status, made);
    bodies.push_back(hull_body());
    const crofton_plane plane{{0, 2, 0}, 1};
    status = body_half_space(&plane, &made);
    keep(status, made);
    status = body_rounded(bodies[4].get(), 0.125f, &made);
    keep(status, made);
    const Tetrahedron tetrahedron;
    const crofton_mesh mesh = tetrahedron.mesh();
    status = body_mesh(&mesh, 1, &made);
    keep(status, made);
    const float heights[6] = {0, 1, 0, 1, 0, 1};
    auto field = sized<crofton_height_field>();
    field.columns = 3;
    field.rows = 2;
    field.heights = heights;
    status = body_height_field(&field, 0, &made);
    keep(status, made);
    const crofton_body* children[2] = {bodies[4].get(), bodies[6].get()};
    const crofton_transform poses[2] = {translation(-1, 0, 0), translation(1, 0, 0)};
    status = body_compound(children, poses, 2, &made);
    keep(status, made);
    return bodies;
}

}  // namespace crofton::capi_test
