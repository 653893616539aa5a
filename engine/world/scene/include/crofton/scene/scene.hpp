// SPDX-License-Identifier: MIT
// The scene graph: nodes, meshes, instances and layers, and the changes of an update.
#pragma once
#include <array>
#include <crofton/core/error.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/geometry/transform.hpp>
#include <crofton/measure/measure.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <string_view>

namespace crofton::scene {

// ---- Polygons in space ----

// A polygon in space. Its (x, y) lies at origin + x·u + y·v; it is visible from the side of cross(u, v).
struct PlanarPolygon {
    Polygon polygon;
    glm::dvec3 origin{0.0};
    glm::dvec3 u{1.0, 0.0, 0.0};
    glm::dvec3 v{0.0, 1.0, 0.0};
    glm::vec3 color{0.8f};  // linear RGB
};

// Checks a polygon. Errors: no points; ring ends that do not ascend to the number of points, or rings of fewer than
// three points; NaN or infinite numbers; u and v parallel.
[[nodiscard]] Result<void> validate(const PlanarPolygon& polygon);

// Returns the polygon's triangles in space; vertex i is polygon.points[i], rounded to float. Errors: as validate; an
// index out of range.
[[nodiscard]] Result<TriangleMesh> to_mesh(const PlanarPolygon& polygon,
                                           std::span<const std::array<std::uint32_t, 3>> triangles);

// The scene graph.

using NodeId = std::uint32_t;
using MeshId = std::uint32_t;
using InstanceId = std::uint32_t;
inline constexpr std::uint32_t kNone = ~std::uint32_t{0};

// The work of an update().
struct UpdateStatistics {
    std::uint32_t nodes_updated = 0;      // with a new world transform or layer mask
    std::uint32_t instances_updated = 0;  // with a new box
    // Updated instances whose world transform went out of range through a chain of valid ones. They keep their last
    // valid box (at first one point at the origin) and have layer mask 0 until they come back into range.
    std::uint32_t instances_invalid = 0;
};

struct SceneOptions {
    measure::Criterion criterion = measure::minimal_perimeter();  // for the boxes around meshes
};

// A scene graph. Nodes form a forest by parent. A node's layer mask is its own AND its parent's. Instances are meshes
// under nodes. An instance's layer mask is its own AND its node's; it is 0 if the world transform scales everything to
// a point.
//
// World transforms, boxes and masks change only in update(), whose cost is proportional to the changes. Ids are
// indices: each is below its count, and ids of removed items are reused, latest first. Const calls may run on any
// number of threads; others need exclusive access to the scene. Calls require ids that are not removed, unless they say
// otherwise.
class Scene {
  public:
    explicit Scene(const SceneOptions& options = {});
    ~Scene();
    Scene(Scene&&) noexcept;
    Scene& operator=(Scene&&) noexcept;

    // Every error below names the item and leaves the scene unchanged. Errors: an id that does not exist or was
    // removed; more than 2^31 items; a transform that fails validate(Transform). A mesh must have triangles and pass
    // validate(TriangleMesh).
    //
    // Fits a box to the mesh, unless you pass the one that it has, as a file may hold it. Error: a vertex, the item,
    // that your box does not contain (invalid_argument).
    [[nodiscard]] Result<MeshId> add_mesh(TriangleMesh mesh, std::string_view name = {}, const Obb* box = nullptr);
    // Adds a polygon with its triangles (indices into polygon.points). It is a mesh for all other calls.
    [[nodiscard]] Result<MeshId> add_polygon(PlanarPolygon polygon,
                                             std::span<const std::array<std::uint32_t, 3>> triangles,
                                             std::string_view name = {});
    [[nodiscard]] Result<NodeId> add_node(NodeId parent_or_none, const Transform& local, std::uint32_t layer_mask = ~0u,
                                          std::string_view name = {});
    [[nodiscard]] Result<InstanceId> add_instance(NodeId node, MeshId mesh);

    [[nodiscard]] Result<void> set_local(NodeId node, const Transform& local);
    // Sets locals[i] for nodes[i]: all or none. The error's item is i. If a node is named twice, the last transform
    // counts.
    [[nodiscard]] Result<void> set_local(std::span<const NodeId> nodes, std::span<const Transform> locals);
    [[nodiscard]] Result<void> set_layer_mask(NodeId node, std::uint32_t layer_mask);
    // Moves a node under another parent; it keeps its local transform. Errors: a parent that is the node itself or
    // below it (invalid_argument).
    [[nodiscard]] Result<void> set_parent(NodeId node, NodeId parent_or_none);
    [[nodiscard]] Result<void> set_instance_mesh(InstanceId instance, MeshId mesh);
    [[nodiscard]] Result<void> set_instance_layers(InstanceId instance, std::uint32_t layer_mask);

    // Both make a polygon an ordinary mesh. replace_mesh: as add_mesh; the name stays.
    [[nodiscard]] Result<void> replace_mesh(MeshId mesh, TriangleMesh replacement, const Obb* box = nullptr);
    // For deforming meshes. Takes as many vertices as before, finite and within 1e30. The mesh's box keeps its axes and
    // is refitted, in time linear in the vertices.
    [[nodiscard]] Result<void> set_vertices(MeshId mesh, std::span<const glm::vec3> positions);

    // Removes an instance. Its layer mask is 0 at once.
    [[nodiscard]] Result<void> remove_instance(InstanceId instance);
    // Removes a node with all nodes and instances below it.
    [[nodiscard]] Result<void> remove_node(NodeId node);
    // Removes a mesh. Errors: instances use it (invalid_argument).
    [[nodiscard]] Result<void> remove_mesh(MeshId mesh);

    UpdateStatistics update(Executor& executor = serial_executor());

    // Ids are below these counts, those of removed items included; so are the sizes of the spans below.
    [[nodiscard]] std::size_t node_count() const;
    [[nodiscard]] std::size_t mesh_count() const;
    [[nodiscard]] std::size_t instance_count() const;
    [[nodiscard]] bool is_removed(InstanceId instance) const;
    [[nodiscard]] bool is_node_removed(NodeId node) const;
    [[nodiscard]] bool is_mesh_removed(MeshId mesh) const;

    [[nodiscard]] const TriangleMesh& mesh(MeshId mesh) const;      // empty once removed
    [[nodiscard]] const PlanarPolygon* polygon(MeshId mesh) const;  // nullptr if the mesh was not added as one
    [[nodiscard]] const Obb& mesh_box(MeshId mesh) const;           // in the mesh's own frame
    [[nodiscard]] std::string_view mesh_name(MeshId mesh) const;    // empty once removed
    // A number that changes whenever an id's vertices or triangles change; no two meshes of a scene ever share one.
    [[nodiscard]] std::uint64_t mesh_revision(MeshId mesh) const;
    [[nodiscard]] NodeId node_of(InstanceId instance) const;      // kNone once removed
    [[nodiscard]] MeshId mesh_of(InstanceId instance) const;      // kNone once removed
    [[nodiscard]] NodeId parent_of(NodeId node) const;            // kNone for roots, and once removed
    [[nodiscard]] std::string_view node_name(NodeId node) const;  // empty once removed
    // Calls on_node for the node and all nodes below it, parents first, and on_instance for their instances. Neither
    // may change the scene.
    void visit_subtree(NodeId node, FunctionRef<void(NodeId)> on_node, FunctionRef<void(InstanceId)> on_instance) const;
    [[nodiscard]] const Transform& local(NodeId node) const;
    [[nodiscard]] const Transform& world(NodeId node) const;  // as of the last update()
    // By InstanceId, as of the last update(). A box contains the exact image of every vertex under the stored numbers
    // of world() (transform.hpp).
    [[nodiscard]] std::span<const Obb> world_boxes() const;
    [[nodiscard]] std::span<const std::uint32_t> layer_masks() const;  // 0 once removed

    // The changes of the last update(), each list ascending and without repetition. An id that was removed and reused
    // since the update before is in removed_instances() for its old instance and in the other lists for its new one.
    [[nodiscard]] std::span<const InstanceId> moved_instances() const;  // new, or with another box, transform or mesh
    [[nodiscard]] std::span<const InstanceId> relayered_instances() const;  // new, or with another layer mask
    [[nodiscard]] std::span<const InstanceId> removed_instances() const;    // existed before, now removed

  private:
    struct State;
    struct Release {
        void operator()(State* state) const;
    };
    std::unique_ptr<State, Release> state_;
};

}  // namespace crofton::scene
