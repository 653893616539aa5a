// SPDX-License-Identifier: MIT
// Where bodies touch, and what keeps those apart that nearly do; in world coordinates.
#pragma once
#include <array>
#include <crofton/geometry/shapes.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <crofton/scene/scene.hpp>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace crofton::viewer {

struct Segment {
    glm::dvec3 begin{0.0}, end{0.0};
};

// Keeps a tree for each mesh and scale that it has met.
class ContactFinder {
  public:
    // Replaces `found` by where the triangles of two instances meet, whatever their scale and shear.
    void find(const scene::Scene& scene, scene::InstanceId a, scene::InstanceId b, std::vector<Segment>& found);
    // Forgets what belongs to a scene that is gone.
    void clear() { trees_.clear(); }

  private:
    // linear = rotation · stretch, with stretch upper triangular: scale on its diagonal, shear above.
    using Stretch = std::array<double, 6>;
    struct Body {
        const mesh::MeshTree* tree;
        RigidTransform pose;
    };
    [[nodiscard]] std::optional<Body> body_of(const scene::Scene& scene, scene::InstanceId instance);
    [[nodiscard]] const mesh::MeshTree* tree_of(const TriangleMesh& mesh, scene::MeshId id, const Stretch& stretch);

    std::map<std::pair<scene::MeshId, Stretch>, std::unique_ptr<mesh::MeshTree>> trees_;
};

// The gap between two boxes along the axis by which the separating-axis test tells them apart, as a segment midway
// between their centres from a's side to b's. Absent where they meet.
[[nodiscard]] std::optional<Segment> separation(const Obb& a, const Obb& b);

// Pairs among `instances` whose boxes are disjoint, but nearer than the smaller one's size: at most `limit`.
[[nodiscard]] std::vector<std::pair<scene::InstanceId, scene::InstanceId>> near_pairs(
    std::span<const Obb> boxes, std::span<const scene::InstanceId> instances, std::size_t limit);

}  // namespace crofton::viewer
