// SPDX-License-Identifier: MIT
// The meshes of objects: trees over triangles for rays and contacts.
#pragma once
#include <crofton/convex/shape.hpp>
#include <crofton/geometry/shapes.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <crofton/scene/scene.hpp>
#include <utility>

#include "object_table.hpp"
#include "spatial_index.hpp"

namespace crofton::world {

// Triangles and where they are.
struct PosedTree {
    const mesh::MeshTree* tree = nullptr;  // none: no valid triangle
    RigidTransform pose;
    bool is_solid = false;  // the triangles are those of a bound
};

// A mesh as queries ask it.
struct MeshShape {
    mesh::MeshTree tree;
    Vector<std::uint32_t> places;  // of triangles in the tree's leaves, by index: leaf · kMeshLeafWidth + lane
    Aabb bounds;                   // of the tree's vertices
    bool is_usable = false;        // false: no triangle is valid or wanted

    // Builds the tree.
    void build(const TriangleMesh& triangles, bool refittable, Executor& executor);
    // Returns the mesh as a shape, under a map that stays alive as long as the shape; nullptr: no map.
    [[nodiscard]] convex::Shape shape(const glm::dmat3* map) const;
    // Returns a triangle, in the mesh's frame.
    [[nodiscard]] Triangle triangle(std::uint32_t index) const;
};

// A mesh that stands for an object, and its transform to the world.
struct PlacedMesh {
    const MeshShape* mesh = nullptr;  // none: the object's sphere or box stands for it
    const glm::dmat3* linear = nullptr;
    glm::dvec3 translation{0.0};
};

// Whether trees may be asked under the map as under a pose.
[[nodiscard]] bool is_rotation(const glm::dmat3& map);
// Builds the tree over the mesh's triangles under a linear map. False: no triangle is valid then.
[[nodiscard]] TriangleMesh box_mesh(const glm::vec3& half_extents);  // its surface, along its own axes
[[nodiscard]] bool build_under(const glm::dmat3& linear, TriangleMesh triangles, mesh::MeshTree& tree);

// A mesh's tree serves all objects that turn and move it. An object with a scale or shear has a tree of its own, of the
// vertices times the linear part, rounded to float. So has a box that meets a mesh. Spheres are points.
class Shapes {
  public:
    Shapes();

    // The mesh is new or another.
    void set_mesh(scene::MeshId mesh, bool wants_triangles);
    // Its vertices have moved: its tree is refitted from the second time on, and built anew where it has worn out.
    void note_deformed(scene::MeshId mesh) { meshes_[mesh].deforms = true; }
    // Meshes that are new, change or go; before they change or go.
    void note(scene::MeshId mesh) { noted_.push_back(mesh); }
    // Builds the trees of meshes that are new or changed. Looks at those that were noted alone.
    void update(const scene::Scene& scene, Executor& executor);

    // Its mesh, and the mesh's tree; none for a bound, and where triangles are not wanted or none is valid: then its
    // box stands for it.
    [[nodiscard]] const MeshShape* mesh_of(const Object& object) const {
        const bool has = object.kind == BoundKind::none && object.mesh < meshes_.size();
        return has && meshes_[object.mesh].shape.is_usable ? &meshes_[object.mesh].shape : nullptr;
    }
    [[nodiscard]] const mesh::MeshTree* mesh_tree_of(const Object& object) const {
        const MeshShape* const mesh = mesh_of(object);
        return mesh != nullptr ? &mesh->tree : nullptr;
    }
    // Takes a mesh out. Its objects must not be asked for afterwards.
    [[nodiscard]] MeshShape take(scene::MeshId mesh) { return std::move(meshes_[mesh].shape); }

    // Objects that prepare() is called for between begin() and build() can be asked for their tree afterwards, until
    // something changes.
    void begin();
    void prepare(const ObjectTable& table, const SpatialIndex& index, const scene::Scene& scene, std::uint32_t object);
    void build(const scene::Scene& scene, Executor& executor);
    [[nodiscard]] PosedTree posed_tree(const ObjectTable& table, const SpatialIndex& index, const scene::Scene& scene,
                                       std::uint32_t object) const;
    void forget(std::uint32_t object);  // it is gone, or another

  private:
    struct Mesh {
        MeshShape shape;
        std::uint64_t revision = 0;
        double spread = 0.0;  // of the tree's boxes when it was built
        bool wants_triangles = true;
        bool deforms = false, can_refit = false;  // the second: the tree is refittable and of this mesh's triangles
    };
    struct Own {
        mesh::MeshTree tree;
        glm::dmat3 linear{1.0};
        glm::vec3 half_extents{0.0f};   // of a box
        scene::MeshId mesh = kNoIndex;  // none: a box
        std::uint64_t revision = 0;
        bool is_usable = false;
    };
    static void update_tree(const TriangleMesh& triangles, Mesh& mesh, Executor& executor);
    void build_own(const scene::Scene& scene, Own& own) const;

    Vector<Mesh> meshes_;
    Vector<std::uint32_t> own_of_object_;  // kNoIndex: none
    Vector<Own> own_;
    Vector<std::uint32_t> free_, to_build_, noted_;
    mesh::MeshTree point_;
};

}  // namespace crofton::world
