// SPDX-License-Identifier: MIT
// Nodes, meshes, instances and layers; what has moved.
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

// The polygon's (x, y) lies at origin + x·u + y·v; it is seen from the side of cross(u, v).
struct PlanarPolygon {
    Polygon polygon;
    glm::dvec3 origin{0.0};
    glm::dvec3 u{1.0, 0.0, 0.0};
    glm::dvec3 v{0.0, 1.0, 0.0};
    glm::vec3 color{0.8f};  // linear RGB
};

// Errors: no points; ring ends that do not ascend to the number of points or rings of fewer than three points; NaN or
// infinite numbers; u and v parallel.
[[nodiscard]] Result<void> validate(const PlanarPolygon& polygon);

// Its triangles in space; vertex i is polygon.points[i], rounded to float. Errors: as validate; an index out of range.
[[nodiscard]] Result<TriangleMesh> to_mesh(const PlanarPolygon& polygon,
                                           std::span<const std::array<std::uint32_t, 3>> triangles);

// The scene graph: who is where, and how large.

using NodeId = std::uint32_t;
using MeshId = std::uint32_t;
using InstanceId = std::uint32_t;
inline constexpr std::uint32_t kNone = ~std::uint32_t{0};

// What update() changed, and how much work it was.
struct UpdateStatistics {
    std::uint32_t nodes_updated = 0;      // whose world transform or layer mask was computed anew
    std::uint32_t instances_updated = 0;  // whose box was computed anew
    // Of those, instances whose world transform went out of range through a chain of valid ones. They keep their last
    // valid box (at first one point at the origin) and layer mask 0 until they come back into range.
    std::uint32_t instances_invalid = 0;
};

struct SceneOptions {
    measure::Criterion criterion = measure::minimal_perimeter();  // for the boxes around meshes
};

// Nodes form a forest by parent. A node's layer mask is its own AND its parent's. Instances are meshes that hang on
// nodes. An instance's layer mask is its own AND its node's. It is 0 where the world transform scales all to a point.
// World transforms, boxes and masks change in update() alone. Its cost is in proportion to what changed. Ids are
// indices: each is below its count, and those of what was removed are given out again, latest first. Const calls may
// run on any number of threads; others need the scene to themselves. They require ids that are not removed, unless they
// say otherwise.
class Scene {
  public:
    explicit Scene(const SceneOptions& options = {});
    ~Scene();
    Scene(Scene&&) noexcept;
    Scene& operator=(Scene&&) noexcept;

    // Every error below names the item, and leaves the scene as it was. Errors: an id that does not exist or was
    // removed; more than 2^31 items; a transform that fails validate(Transform). A mesh must have triangles and pass
    // validate(TriangleMesh).
    [[nodiscard]] Result<MeshId> add_mesh(TriangleMesh mesh, std::string_view name = {});
    // A polygon is drawn through its triangles (indices into polygon.points), and is a mesh for all other calls.
    [[nodiscard]] Result<MeshId> add_polygon(PlanarPolygon polygon,
                                             std::span<const std::array<std::uint32_t, 3>> triangles,
                                             std::string_view name = {});
    [[nodiscard]] Result<NodeId> add_node(NodeId parent_or_none, const Transform& local, std::uint32_t layer_mask = ~0u,
                                          std::string_view name = {});
    [[nodiscard]] Result<InstanceId> add_instance(NodeId node, MeshId mesh);

    [[nodiscard]] Result<void> set_local(NodeId node, const Transform& local);
    // locals[i] for nodes[i]: all or none. The error's item is i. Of a node named twice the last counts.
    [[nodiscard]] Result<void> set_local(std::span<const NodeId> nodes, std::span<const Transform> locals);
    [[nodiscard]] Result<void> set_layer_mask(NodeId node, std::uint32_t layer_mask);
    // The node keeps its local transform. Errors: a parent that is the node itself or below it (invalid_argument).
    [[nodiscard]] Result<void> set_parent(NodeId node, NodeId parent_or_none);
    [[nodiscard]] Result<void> set_instance_mesh(InstanceId instance, MeshId mesh);
    [[nodiscard]] Result<void> set_instance_layers(InstanceId instance, std::uint32_t layer_mask);

    // Both end what a mesh was as a polygon. replace_mesh: as add_mesh; the name stays.
    [[nodiscard]] Result<void> replace_mesh(MeshId mesh, TriangleMesh replacement);
    // For deforming meshes: as many vertices as before, finite and within 1e30. The mesh's box keeps its axes and is
    // refitted, in time linear in the vertices.
    [[nodiscard]] Result<void> set_vertices(MeshId mesh, std::span<const glm::vec3> positions);

    // The instance's layer mask is 0 at once.
    [[nodiscard]] Result<void> remove_instance(InstanceId instance);
    // With all nodes and instances below it.
    [[nodiscard]] Result<void> remove_node(NodeId node);
    // Errors: instances use it (invalid_argument).
    [[nodiscard]] Result<void> remove_mesh(MeshId mesh);

    UpdateStatistics update(Executor& executor = serial_executor());

    // Ids are below these counts, removed ones included; so are the sizes of the spans below.
    [[nodiscard]] std::size_t node_count() const;
    [[nodiscard]] std::size_t mesh_count() const;
    [[nodiscard]] std::size_t instance_count() const;
    [[nodiscard]] bool is_removed(InstanceId instance) const;
    [[nodiscard]] bool is_node_removed(NodeId node) const;
    [[nodiscard]] bool is_mesh_removed(MeshId mesh) const;

    [[nodiscard]] const TriangleMesh& mesh(MeshId mesh) const;      // empty once removed
    [[nodiscard]] const PlanarPolygon* polygon(MeshId mesh) const;  // nullptr where the mesh was not added as one
    [[nodiscard]] const Obb& mesh_box(MeshId mesh) const;           // in the mesh's own frame
    [[nodiscard]] std::string_view mesh_name(MeshId mesh) const;    // empty once removed
    // Another number whenever an id's vertices or triangles change; no two meshes of a scene ever share one.
    [[nodiscard]] std::uint64_t mesh_revision(MeshId mesh) const;
    [[nodiscard]] NodeId node_of(InstanceId instance) const;      // kNone once removed
    [[nodiscard]] MeshId mesh_of(InstanceId instance) const;      // kNone once removed
    [[nodiscard]] NodeId parent_of(NodeId node) const;            // kNone for roots, and once removed
    [[nodiscard]] std::string_view node_name(NodeId node) const;  // empty once removed
    // Calls on_node for the node and all below it, parents first, and on_instance for what hangs on them. Neither may
    // change the scene.
    void visit_subtree(NodeId node, FunctionRef<void(NodeId)> on_node, FunctionRef<void(InstanceId)> on_instance) const;
    [[nodiscard]] const Transform& local(NodeId node) const;
    [[nodiscard]] const Transform& world(NodeId node) const;  // as of the last update()
    // By InstanceId, as of the last update(). A box contains the exact image of every vertex under the stored numbers
    // of world(): transform.hpp.
    [[nodiscard]] std::span<const Obb> world_boxes() const;
    [[nodiscard]] std::span<const std::uint32_t> layer_masks() const;  // 0 once removed

    // What the last update() found, each list ascending and without repetition. An id that was removed and given out
    // again in between is in removed_instances() for its old instance. For its new one it is in the others.
    [[nodiscard]] std::span<const InstanceId> moved_instances() const;      // new, or with another box or transform
    [[nodiscard]] std::span<const InstanceId> relayered_instances() const;  // new, or with another layer mask
    [[nodiscard]] std::span<const InstanceId> removed_instances() const;  // there at the update() before, then removed

  private:
    struct State;
    struct Release {
        void operator()(State* state) const;
    };
    std::unique_ptr<State, Release> state_;
};

}  // namespace crofton::scene
