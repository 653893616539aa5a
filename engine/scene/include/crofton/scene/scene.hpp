// The scene graph: who is where, and how large.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/obb.hpp>
#include <crofton/geometry/triangle_mesh.hpp>
#include <crofton/measure/criterion.hpp>
#include <crofton/scene/planar_polygon.hpp>
#include <crofton/scene/transform.hpp>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace crofton::scene {

using NodeId = std::uint32_t;
using MeshId = std::uint32_t;
using InstanceId = std::uint32_t;
inline constexpr std::uint32_t kNone = ~std::uint32_t{0};

// What update() found changed, and how much work it was.
struct UpdateStatistics {
    std::uint32_t nodes_updated = 0;      // whose world transform or layer mask was computed anew
    std::uint32_t instances_updated = 0;  // whose box was computed anew
    // Of those, instances whose world transform went out of range through a chain of valid ones. They keep their last
    // valid box (at first one point at the origin) and count as removed (layer mask 0) until they come back into range.
    std::uint32_t instances_invalid = 0;
};

struct SceneOptions {
    measure::Criterion criterion = measure::minimal_perimeter();  // for the boxes around meshes
};

// Nodes form a forest by parent; a node's layer mask is its own AND its parent's. Instances hang on nodes.
// World positions and bounds change only in update(), and only where something changed; its cost is in proportion to
// that. Const calls may run on any number of threads; others need the scene to themselves.
class Scene {
  public:
    explicit Scene(const SceneOptions& options = {});
    ~Scene();
    Scene(Scene&&) noexcept;
    Scene& operator=(Scene&&) noexcept;

    // Errors of all add_ calls: the named item is invalid, and nothing was added.
    // A mesh must have triangles and pass validate(TriangleMesh).
    [[nodiscard]] Result<MeshId> add_mesh(TriangleMesh mesh, std::string name = {});
    // A polygon is drawn through its triangles (indices into polygon.points), and is a mesh for all other calls.
    [[nodiscard]] Result<MeshId> add_polygon(PlanarPolygon polygon,
                                             std::span<const std::array<std::uint32_t, 3>> triangles,
                                             std::string name = {});
    [[nodiscard]] Result<NodeId> add_node(NodeId parent, const Transform& local, std::uint32_t layer_mask = ~0u,
                                          std::string name = {});
    [[nodiscard]] Result<InstanceId> add_instance(NodeId node, MeshId mesh);

    [[nodiscard]] Result<void> set_local(NodeId node, const Transform& local);
    [[nodiscard]] Result<void> set_layer_mask(NodeId node, std::uint32_t layer_mask);
    [[nodiscard]] Result<void> remove_instance(InstanceId instance);  // ids of others stay; this one is not reused

    UpdateStatistics update(Executor& executor = serial_executor());

    [[nodiscard]] std::size_t node_count() const;
    [[nodiscard]] std::size_t mesh_count() const;
    [[nodiscard]] std::size_t instance_count() const;  // ids are below this, removed ones included
    [[nodiscard]] bool is_removed(InstanceId instance) const;
    [[nodiscard]] const TriangleMesh& mesh(MeshId mesh) const;
    [[nodiscard]] const PlanarPolygon* polygon(MeshId mesh) const;  // nullptr where the mesh was not added as one
    [[nodiscard]] const Obb& mesh_box(MeshId mesh) const;           // in the mesh's own frame
    [[nodiscard]] const std::string& mesh_name(MeshId mesh) const;
    [[nodiscard]] NodeId node_of(InstanceId instance) const;
    [[nodiscard]] MeshId mesh_of(InstanceId instance) const;
    [[nodiscard]] NodeId parent_of(NodeId node) const;
    [[nodiscard]] const std::string& node_name(NodeId node) const;
    [[nodiscard]] const Transform& local(NodeId node) const;
    [[nodiscard]] const Transform& world(NodeId node) const;  // as of the last update()
    [[nodiscard]] std::span<const Obb> world_boxes() const;   // by InstanceId; contains every transformed vertex
    [[nodiscard]] std::span<const std::uint32_t> layer_masks() const;  // by InstanceId; 0 once removed
    [[nodiscard]] std::span<const InstanceId> moved_instances()
        const;  // whose box changed in the last update(), ascending

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace crofton::scene
