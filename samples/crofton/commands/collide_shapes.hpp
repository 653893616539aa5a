// SPDX-License-Identifier: MIT
// crofton collide of convex hulls, and casts: questions of crofton::convex.
#pragma once
#include <crofton/convex/query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <optional>
#include <string>

#include "json/json.hpp"
#include "read_options.hpp"

namespace crofton::cli {

// A shape made of a file: the hull of its vertices, or its triangles.
struct FileShape {
    std::optional<convex::Hull> hull;
    std::optional<mesh::MeshTree> mesh;
    glm::dvec3 origin{0.0};  // as PlacedMesh
    [[nodiscard]] convex::Shape shape() const {
        return hull ? convex::Shape::hull(*hull) : convex::Shape::mesh(*mesh).value();
    }
};
[[nodiscard]] Result<FileShape> load_shape(const std::string& path, bool as_hull, int max_vertices,
                                           const ReadOptions& options);

// "x,y,z"; empty: none. The option's name is for the error.
[[nodiscard]] Result<glm::dvec3> vector_of(const std::string& option, const std::string& text);

struct ShapeAnswer {
    std::string sentence;
    Json document;
};
// `mode` is any, all or distance. Points of the answer are `origin` farther out than the shapes.
[[nodiscard]] ShapeAnswer ask_hulls(const std::string& mode, const convex::ShapeAtPose& a, const convex::ShapeAtPose& b,
                                    const glm::dvec3& origin);
// B moves. Errors: of convex::cast.
[[nodiscard]] Result<ShapeAnswer> ask_cast(const convex::ShapeAtPose& a, const convex::ShapeAtPose& b,
                                           const convex::Motion& motion, double duration, const glm::dvec3& origin);

}  // namespace crofton::cli
