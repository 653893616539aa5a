// SPDX-License-Identifier: MIT
// Meshes and shapes as Python has them: shared, and never changed once made.
#pragma once
#include <crofton/convex/query.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "convert.hpp"

namespace crofton::python {

// Triangles, and the tree over them, which is built when a query first needs it.
class PyMesh {
  public:
    PyMesh(TriangleMesh mesh, std::string name) : mesh_(std::move(mesh)), name_(std::move(name)) {}

    [[nodiscard]] const TriangleMesh& triangles() const { return mesh_; }
    [[nodiscard]] const std::string& name() const { return name_; }
    // Called without the interpreter's lock. Errors: as MeshTree::build; a vertex beyond 1e12.
    [[nodiscard]] Result<const mesh::MeshTree*> tree() const;

  private:
    TriangleMesh mesh_;
    std::string name_;
    mutable std::mutex mutex_;
    mutable std::optional<mesh::MeshTree> tree_;
};

// Checks a mesh and makes it Python's. Raises Error for one without triangles.
[[nodiscard]] std::shared_ptr<PyMesh> make_mesh(TriangleMesh mesh, std::string name);

// A shape, with all that it is a view of.
struct PyShape {
    std::optional<convex::Shape> shape;
    std::optional<convex::Hull> hull;
    std::optional<convex::HeightField> field;
    std::optional<convex::Compound> compound;
    std::shared_ptr<const PyMesh> mesh;
    std::vector<std::shared_ptr<const PyShape>> parts;
};
using SharedShape = std::shared_ptr<PyShape>;

// A rotation and a translation as a matrix of shape (4, 4) or (3, 4); None: the identity. Raises Error for one that
// scales, shears or mirrors.
[[nodiscard]] RigidTransform pose_of(const py::object& given, const char* name);

// An array of records: first, second, begin, end, normal.
[[nodiscard]] py::array mesh_contacts_of(std::span<const mesh::MeshContact> contacts);

// The first hit of a ray at a mesh or a shape.
struct SurfaceHit {
    double t;
    glm::dvec3 point, normal;
    std::uint32_t triangle;
    bool started_inside;
};

// Nearest points of two things.
struct NearestPoints {
    double distance;
    glm::dvec3 on_a, on_b;
};

[[nodiscard]] const char* kind_name(convex::Kind kind);

}  // namespace crofton::python
