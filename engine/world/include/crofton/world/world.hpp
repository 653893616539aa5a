// SPDX-License-Identifier: MIT
// The front door: objects in, what is seen and what touches out.
#pragma once
#include <crofton/collide/convex_query.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/geometry/shapes.hpp>
#include <crofton/world/answers.hpp>
#include <crofton/world/inputs.hpp>
#include <memory>
#include <optional>
#include <span>

namespace crofton {

inline constexpr std::size_t kAutomatic = ~std::size_t{0};

struct WorldOptions {
    bool pairs = true;        // false: neither pairs nor contacts are looked for
    bool contacts = true;     // false: pairs alone
    bool containment = true;  // a closed mesh around another object touches it
    bool mesh_depth = false;  // depth and direction of contacts between meshes, which cost more than finding them
    std::size_t max_pairs = std::size_t{1} << 24;  // more are an error, not an exhausted memory
    // Items' worth of background work on the tree an update (BoxTree::rebuild_step), beside what changes make
    // necessary; kAutomatic: a 128th of the objects and 512. 0: none, and no allocation.
    std::size_t rebuild_budget = kAutomatic;
    std::uint32_t updates_to_rest = 16;  // without moving, until an object counts as resting again
};

// As of the last update.
struct WorldStatistics {
    std::size_t objects = 0, resting = 0, moving = 0;  // shown ones: in the tree, in the list
    std::uint32_t boxes_changed = 0;                   // in this update
    bool tree_built = false;                           // all at once: much has come to rest, or come and gone
    std::uint64_t box_pairs_tested = 0, contact_pairs_tested = 0;
    std::uint32_t nodes_updated = 0;
    std::uint32_t out_of_range =
        0;  // objects that the product of transforms has put beyond it: hidden until they return
};

// Owns nodes, meshes, objects, the tree of what rests and the list of what moves; which is which it finds out.
// Changes take effect in update(). Const calls answer as of the last update and may run on any number of threads; the
// others need the World for themselves. An error names the item and leaves all as it was; calls that take many handles
// do what they can and return the first error, whose item is the place among the handles.
// Errors of all calls: a stale handle (stale_handle); numbers that are NaN, infinite or out of range, for which see
// validate(Obb) and scene::validate(Transform). A transform may flatten: zero scale hides, a flat scale gives a flat
// box.
class World {
  public:
    explicit World(const WorldOptions& options = {});
    ~World();
    World(World&&) noexcept;
    World& operator=(World&&) noexcept;

    Result<ObjectHandle> add(const ObjectDescription& description);
    Result<void> remove(ObjectHandle object);
    // Of an object that was added with a transform.
    Result<void> set_transform(ObjectHandle object, const scene::Transform& transform);
    Result<void> set_transforms(Strided<ObjectHandle> objects, Strided<scene::Transform> transforms);
    // Of an object that was added with a bound.
    Result<void> set_bound(ObjectHandle object, const Bound& bound);
    Result<void> set_bounds(Strided<ObjectHandle> objects, Strided<Obb> boxes);
    Result<void> set_mesh(ObjectHandle object, MeshHandle mesh);  // of an object that has one
    Result<void> set_hidden(ObjectHandle object, bool hidden);    // in no answer until shown again
    Result<void> set_layers(ObjectHandle object, std::uint32_t layers);
    Result<void> set_collides_with(ObjectHandle object, std::uint32_t layers);
    Result<void> set_user(ObjectHandle object, std::uint64_t user);

    // A mesh must have triangles and pass validate(TriangleMesh).
    Result<MeshHandle> add_mesh(const MeshDescription& description);
    Result<void> replace_mesh(MeshHandle mesh, const MeshDescription& description);
    Result<void> set_vertices(MeshHandle mesh, PointsView positions);  // as many as before: a mesh that deforms
    Result<void> remove(MeshHandle mesh);                              // error: objects use it

    Result<NodeHandle> add_node(const NodeDescription& description = {});
    Result<void> remove(NodeHandle node);  // with all nodes and objects below it
    Result<void> set_transform(NodeHandle node, const scene::Transform& transform);
    Result<void> set_transforms(Strided<NodeHandle> nodes, Strided<scene::Transform> transforms);
    Result<void> set_parent(NodeHandle node, NodeHandle parent_or_null);  // error: the node itself or one below it
    Result<void> set_layers(NodeHandle node, std::uint32_t layers);

    [[nodiscard]] bool contains(ObjectHandle object) const;
    [[nodiscard]] bool contains(MeshHandle mesh) const;
    [[nodiscard]] bool contains(NodeHandle node) const;
    [[nodiscard]] std::size_t object_count() const;  // removed ones not counted
    [[nodiscard]] Result<std::uint64_t> user_of(ObjectHandle object) const;
    [[nodiscard]] Result<Obb> box_of(ObjectHandle object) const;                     // as of the last update
    [[nodiscard]] Result<scene::Transform> transform_of(ObjectHandle object) const;  // to the world; likewise

    // Once a frame. Error: more than max_pairs pairs; then there are none, and all else is as it should be.
    Result<void> update(Executor& executor = serial_executor());
    [[nodiscard]] const WorldStatistics& statistics() const;

    // What a view sees, by the objects' boxes, exactly as the mode says. At most cull::kMaxViews views in one pass.
    // Errors of the first: as validate(Camera).
    Result<void> view(const Camera& camera, VisibleObjects& visible, const cull::CullOptions& options = {},
                      Executor& executor = serial_executor()) const;
    void view(const cull::View& view, VisibleObjects& visible, const cull::CullOptions& options = {},
              Executor& executor = serial_executor()) const;
    void view(std::span<const cull::View> views, VisibleInViews& visible,
              cull::CullMode mode = cull::CullMode::exact) const;

    // Triangles of meshes, balls and boxes, whichever an object has. Objects removed since the last update are in none
    // of the answers.
    [[nodiscard]] std::optional<ObjectHit> raycast(const Ray& ray, std::uint32_t layers = ~0u) const;
    [[nodiscard]] bool raycast_any(const Ray& ray, std::uint32_t layers = ~0u) const;
    // Every object's nearest hit, by t, then by index.
    void raycast_all(const Ray& ray, Vector<ObjectHit>& hits, std::uint32_t layers = ~0u) const;

    // Whose box or ball meets the shape; by index. Meshes by their boxes.
    void overlap(const Obb& shape, Vector<ObjectRef>& found, std::uint32_t layers = ~0u) const;
    void overlap(const Sphere& shape, Vector<ObjectRef>& found, std::uint32_t layers = ~0u) const;
    void overlap(const collide::Capsule& shape, Vector<ObjectRef>& found, std::uint32_t layers = ~0u) const;
    // The box or ball nearest to the shape, no farther than max_distance; of several the lowest index.
    [[nodiscard]] std::optional<ClosestObject> closest(const Sphere& shape, double max_distance,
                                                       std::uint32_t layers = ~0u) const;
    [[nodiscard]] std::optional<ClosestObject> closest(const Obb& shape, double max_distance,
                                                       std::uint32_t layers = ~0u) const;
    [[nodiscard]] std::optional<ClosestObject> closest(const collide::Capsule& shape, double max_distance,
                                                       std::uint32_t layers = ~0u) const;

    // Found by update(): objects whose boxes or balls meet, in order; and of them those that touch, with those that no
    // longer do.
    [[nodiscard]] std::span<const ObjectPair> pairs() const;
    [[nodiscard]] std::span<const Contact> contacts() const;

  private:
    struct State;
    struct Deleter {
        void operator()(State* state) const;
    };
    std::unique_ptr<State, Deleter> state_;
};

}  // namespace crofton
