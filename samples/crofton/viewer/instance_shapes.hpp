// SPDX-License-Identifier: MIT
// A scene's instances by their triangles and their hulls: what the viewer asks beyond bounds.
#pragma once
#include <crofton/convex/query.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <crofton/scene/scene.hpp>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace crofton::viewer {

// Hulls with more corners than this are shown by a larger one.
inline constexpr int kHullVertices = 64;

// Two instances whose triangles meet, and where: in the world's frame.
struct TriangleContacts {
    scene::InstanceId first = 0, second = 0;
    Vector<mesh::MeshContact> triangles;
};

// Two instances whose hulls meet. Points keep their ids, and whether they have just begun, from call to call.
struct HullContacts {
    scene::InstanceId first = 0, second = 0;
    Vector<convex::TrackedPoint> points;
};

using InstancePair = std::pair<scene::InstanceId, scene::InstanceId>;

// Returns the nearest triangle of a mesh that stands there. A transform without an inverse is not hit.
[[nodiscard]] std::optional<mesh::TriangleHit> raycast_placed(const Ray& ray, const mesh::MeshTree& tree,
                                                              const Transform& world);

// Trees and hulls are made when first asked for: most visits need few. One of a mesh serves all instances that turn and
// move it; what is scaled, sheared or mirrored has its own. The scene must outlive this; its meshes do not change.
class InstanceShapes {
  public:
    explicit InstanceShapes(const scene::Scene& scene);

    // As raycast_placed().
    [[nodiscard]] std::optional<mesh::TriangleHit> raycast(const Ray& ray, scene::InstanceId instance);
    // Returns the pairs whose triangles overlap.
    [[nodiscard]] std::vector<TriangleContacts> triangle_contacts(std::span<const InstancePair> pairs);
    // Returns the pairs whose hulls overlap. Flat meshes have no hull and overlap nothing.
    [[nodiscard]] std::vector<HullContacts> hull_contacts(std::span<const InstancePair> pairs);
    // The hull's edges, in the world; false: it has none.
    bool outline(scene::InstanceId instance, convex::LineVisitor line);

  private:
    struct TreeAndHull {
        glm::dmat3 linear{1.0};  // that its vertices have gone through
        std::optional<mesh::MeshTree> tree;
        std::optional<convex::Hull> hull;
        bool tree_made = false, hull_made = false;
    };
    struct Placed {
        TreeAndHull* entry;
        RigidTransform pose;
    };
    struct Kept {  // of a pair
        convex::PairCache cache;
        Vector<convex::TrackedPoint> points;
        std::uint64_t call = 0;
    };
    [[nodiscard]] Placed place(scene::InstanceId instance);
    [[nodiscard]] TriangleMesh posed_mesh(scene::InstanceId instance, const TreeAndHull& entry) const;
    [[nodiscard]] const mesh::MeshTree* tree_of(scene::InstanceId instance, TreeAndHull& entry) const;
    [[nodiscard]] const convex::Hull* hull_of(scene::InstanceId instance, TreeAndHull& entry) const;

    const scene::Scene* scene_;
    std::vector<TreeAndHull> of_mesh_;
    std::map<scene::InstanceId, TreeAndHull> own_;
    std::map<InstancePair, Kept> kept_;
    std::uint64_t calls_ = 0;
};

}  // namespace crofton::viewer
