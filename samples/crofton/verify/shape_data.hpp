// SPDX-License-Identifier: MIT
// Shapes made of a scene's or map's data: hulls, and surfaces with their triangles one by one.
#pragma once
#include <crofton/convex/shape.hpp>
#include <crofton/core/error.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <optional>
#include <string>
#include <vector>

#include "assets/scene_source.hpp"

namespace crofton::cli {

struct ShapeData {
    std::vector<convex::Hull> hulls;
    std::vector<std::vector<glm::vec3>> hull_points;  // that each was built of
    std::size_t flat = 0;                             // meshes and pieces without a hull
    // One of the two.
    mesh::MeshTree tree;
    std::optional<convex::HeightField> field;
    std::vector<Triangle> triangles;  // of the surface, each as a part of it; coordinates are floats
    double size = 0.0;                // the diagonal of the box around it

    [[nodiscard]] convex::Shape surface() const {
        return field ? convex::Shape::height_field(*field, convex::Sides::both) : *convex::Shape::mesh(tree);
    }
};

// Hulls are of the whole scene, of each mesh and of its pieces. A mesh of more than 64 triangles is cut at the median
// of its triangles three times, across its longest side: at most eight pieces. A map's polygons are steps of several
// heights on a grid of 257².
[[nodiscard]] Result<ShapeData> read_shape_data(const std::string& source, const assets::LoadOptions& which);

}  // namespace crofton::cli
