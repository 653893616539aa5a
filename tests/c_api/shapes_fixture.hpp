// SPDX-License-Identifier: MIT
// Shapes of all kinds, in C.
#pragma once
#include "handles.hpp"

namespace crofton::capi_test {

inline ShapeHandle box_shape(float x, float y, float z) {
    const float half[3] = {x, y, z};
    crofton_shape* shape = nullptr;
    REQUIRE(shape_box(half, &shape) == CROFTON_OK);
    return ShapeHandle(shape);
}

inline std::vector<float> octahedron() {
    return {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0.1f, 0.1f, 0.1f};
}

inline ShapeHandle hull_shape() {
    const std::vector<float> points = octahedron();
    crofton_shape* shape = nullptr;
    REQUIRE(shape_hull(points.data(), points.size() / 3, &shape) == CROFTON_OK);
    return ShapeHandle(shape);
}

// One of each kind. The compound is the last.
inline std::vector<ShapeHandle> all_kinds() {
    std::vector<ShapeHandle> shapes;
    const auto keep = [&](crofton_status status, crofton_shape* shape) {
        REQUIRE(status == CROFTON_OK);
        shapes.emplace_back(shape);
    };
    crofton_shape* made = nullptr;
    crofton_status status = shape_sphere(0.5f, &made);
    keep(status, made);
    status = shape_round(CROFTON_SHAPE_CAPSULE, 0.5f, 0.25f, &made);
    keep(status, made);
    status = shape_round(CROFTON_SHAPE_CYLINDER, 0.5f, 0.5f, &made);
    keep(status, made);
    status = shape_round(CROFTON_SHAPE_CONE, 0.5f, 0.5f, &made);
    keep(status, made);
    shapes.push_back(box_shape(0.5f, 0.25f, 1.0f));
    const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    status = shape_triangle(corners, &made);
    keep(status, made);
    shapes.push_back(hull_shape());
    const crofton_plane plane{{0, 2, 0}, 1};
    status = shape_half_space(&plane, &made);
    keep(status, made);
    status = shape_rounded(shapes[4].get(), 0.125f, &made);
    keep(status, made);
    const Tetrahedron tetrahedron;
    const crofton_mesh mesh = tetrahedron.mesh();
    status = shape_mesh(&mesh, 1, &made);
    keep(status, made);
    const float heights[6] = {0, 1, 0, 1, 0, 1};
    auto field = sized<crofton_height_field>();
    field.columns = 3;
    field.rows = 2;
    field.heights = heights;
    status = shape_height_field(&field, 0, &made);
    keep(status, made);
    const crofton_shape* children[2] = {shapes[4].get(), shapes[6].get()};
    const crofton_transform poses[2] = {translation(-1, 0, 0), translation(1, 0, 0)};
    status = shape_compound(children, poses, 2, &made);
    keep(status, made);
    return shapes;
}

}  // namespace crofton::capi_test
