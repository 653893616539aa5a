// SPDX-License-Identifier: MIT
// World, the front door: holds objects, and answers what is seen, what touches and what rays hit.
#pragma once
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/geometry/shapes.hpp>
#include <crofton/world/answers.hpp>
#include <crofton/world/inputs.hpp>
#include <optional>
#include <span>

namespace crofton {

namespace convex {
class Body;
struct CastOptions;
struct Motion;
}  // namespace convex

inline constexpr std::size_t kAutomatic = ~std::size_t{0};

// A profiler's functions. Zones are told when they begin and end, on the thread that runs them, nested on each thread.
// Several views at once run on the executor's threads. Names are constants that live as long as the program. A function
// that is null is not called; none may throw.
struct TraceHooks {
    void (*begin)(void* user, const char* zone) = nullptr;
    void (*end)(void* user, const char* zone) = nullptr;
    void (*count)(void* user, const char* counter, double value) = nullptr;
    void* user = nullptr;
};

struct WorldOptions {
    bool pairs = true;            // false: neither pairs nor contacts are looked for
    bool contacts = true;         // false: pairs alone
    bool containment = true;      // an object inside a closed mesh touches it
    double contact_margin = 0.0;  // ≥ 0: gaps up to this between bodies are contacts
    bool mesh_depth = false;      // finds a way out of contacts between meshes, which costs more than finding them
    std::size_t max_pairs = std::size_t{1} << 24;  // more are an error, not an exhausted memory
    // Items' worth of background work on the tree an update (BoxTree::rebuild_step), beside what changes make
    // necessary; kAutomatic: at least a 2048th of the objects and 128 while a rebuild is under way. 0: none, and no
    // allocation.
    std::size_t rebuild_budget = kAutomatic;
    std::uint32_t updates_to_rest = 16;  // without moving, until an object counts as resting again
    boxtree::Orientation tree = boxtree::Orientation::aligned;  // of the tree of what rests
    TraceHooks trace = {};                                      // told of the stages of updates and views
};

// As of the last update.
struct WorldStatistics {
    std::size_t objects = 0, resting = 0, moving = 0;  // shown ones: in the tree, in the list
    std::uint32_t boxes_changed = 0;                   // in this update; also of meshes that moved within their boxes
    bool tree_built = false;                           // all at once: a scene was loaded, or much came to rest
    std::uint64_t box_pairs_tested = 0, contact_pairs_tested = 0;  // the second: pairs whose shapes were looked at
    std::uint64_t body_pairs_computed = 0;  // whose contacts of bodies were found anew; what rests has none
    collide::BatchStatistics box_tests;     // how the pairs of boxes were told apart
    double contacts_us = 0.0;               // microseconds of this update that pairs and contacts took
    std::uint32_t nodes_updated = 0;
    std::uint32_t out_of_range =
        0;  // objects that the product of transforms has put beyond it: hidden until they return
};

// Owns nodes, meshes and objects. Detects motion automatically: resting objects are in a tree, moving ones in a list.
//
// Changes take effect in update(). Const calls answer as of the last update and may run on any number of threads; the
// other calls need the World to themselves. A transform may flatten: a zero scale hides the object, a flat scale gives
// a flat box.
//
// Errors name the item, and the call changes nothing. Calls that take many handles do what they can and return the
// first error; its item is the place among the handles. Every call can fail with stale_handle, and with numbers that
// are NaN, infinite or out of range (validate(Obb), validate(Transform)).
class World {
  public:
    explicit World(const WorldOptions& options = {});
    ~World();
    World(World&&) noexcept;
    World& operator=(World&&) noexcept;

    Result<ObjectHandle> add(const ObjectDescription& description);
    Result<void> remove(ObjectHandle object);
    // Requires an object that was added with a transform, or by its body under no node.
    Result<void> set_transform(ObjectHandle object, const Transform& transform);
    Result<void> set_transforms(Strided<ObjectHandle> objects, Strided<Transform> transforms);
    // Requires an object that was added with a bound.
    Result<void> set_bound(ObjectHandle object, const Bound& bound);
    Result<void> set_bounds(Strided<ObjectHandle> objects, Strided<Obb> boxes);
    Result<void> set_mesh(ObjectHandle object, MeshHandle mesh);  // of an object that has one
    Result<void> set_hidden(ObjectHandle object, bool hidden);    // in no answer until shown again
    Result<void> set_layers(ObjectHandle object, std::uint32_t layers);
    Result<void> set_collides_with(ObjectHandle object, std::uint32_t layers);
    Result<void> set_user(ObjectHandle object, std::uint64_t user);  // at once, in pairs from the next update on

    // Gives an object a body, or with nullptr takes it away: for pairs from the next update on, for queries at once.
    //
    // Pairs of objects that both have bodies are in body_contacts() instead of contacts(). What the body is a view of
    // stays the caller's, alive and unchanged; to change it, set the body again. It stands where the object's
    // transform, or the frame of its box or sphere, puts it; axes that are left-handed or off by more than 1e-6 are
    // turned into the nearest rotation.
    // Box: from the next update on, the object's box is the least in its own frame around the bound, or the mesh's box,
    // and the body; around the body alone where the object was added with neither. It stands for the object in views,
    // pairs and queries, so that nothing of the body is missed. A sphere whose body does not fit into it counts as that
    // box. A bound of size 0 is enough: it only says where the body is. No bounds: half-spaces, and compounds that hold
    // some, are ground without end. They meet, and are met by, everything that shares layers with them, wherever their
    // object's box is; views go by that box. Level ground costs an update what lies on it; tilted ground looks at each
    // object. Scale: a transform that is not rigid scales the body. Uniform scales, within 1e-5, do so with any kind.
    // Other maps, flat and mirroring ones too, are for what has vertices and no rounding, and for half-spaces.
    // Cylinders, cones and height fields may be scaled along their axes. Sizes are rounded to float. Scaled hulls and
    // meshes are built anew whenever the scale changes. Errors: a body that the object's transform, as it is set now,
    // turns into another kind (unsupported), or puts out of range. Calls that set transforms or parents refuse them
    // likewise. An object that was added by its body alone keeps one: nullptr is refused (invalid_argument).
    Result<void> set_body(ObjectHandle object, const convex::Body* body);

    // A mesh must have triangles and pass validate(TriangleMesh).
    Result<MeshHandle> add_mesh(const MeshDescription& description);
    Result<void> replace_mesh(MeshHandle mesh, const MeshDescription& description);
    Result<void> set_vertices(MeshHandle mesh, PointsView positions);  // as many as before: a mesh that deforms
    Result<void> remove(MeshHandle mesh);                              // error: objects use it

    // Occluders: what a mesh's objects hide others with, in views with occlusion. find_occluders() looks for them in
    // the triangles, which takes a second or more for 100,000; set_occluders() takes your own, or stored ones, in the
    // mesh's frame.
    //
    // Your own must be opaque and lie within what is drawn of the mesh. An occluder is a box (kind and box are enough),
    // the convex hull of surface.positions, or a patch of any triangles. Replacing a mesh or its vertices forgets its
    // occluders. Errors name the occluder: as occlude::find_occluders and occlude::OccluderSet.
    Result<void> find_occluders(MeshHandle mesh, const occlude::FindOptions& options = {});
    Result<void> set_occluders(MeshHandle mesh, std::span<const occlude::FoundOccluder> occluders);
    [[nodiscard]] std::span<const occlude::FoundOccluder> occluders_of(MeshHandle mesh) const;  // none: empty
    Result<void> set_occludes(ObjectHandle object, bool occludes);  // as ObjectDescription; of an object with a mesh

    // How a mesh with MeshDescription::clusters is cut, as of the last update; nullptr where it is not. Permute the
    // index buffer that you draw by its triangle_order().
    [[nodiscard]] const depth::ClusteredMesh* clusters_of(MeshHandle mesh) const;

    Result<NodeHandle> add_node(const NodeDescription& description = {});
    Result<void> remove(NodeHandle node);  // with all nodes and objects below it
    Result<void> set_transform(NodeHandle node, const Transform& transform);
    Result<void> set_transforms(Strided<NodeHandle> nodes, Strided<Transform> transforms);
    Result<void> set_parent(NodeHandle node, NodeHandle parent_or_null);  // error: the node itself or one below it
    Result<void> set_layers(NodeHandle node, std::uint32_t layers);

    [[nodiscard]] bool contains(ObjectHandle object) const;
    [[nodiscard]] bool contains(MeshHandle mesh) const;
    [[nodiscard]] bool contains(NodeHandle node) const;
    [[nodiscard]] std::size_t object_count() const;  // removed ones not counted
    [[nodiscard]] Result<std::uint64_t> user_of(ObjectHandle object) const;
    // As of the last update; before the first one after the object was added: an error (empty).
    [[nodiscard]] Result<Obb> box_of(ObjectHandle object) const;
    [[nodiscard]] Result<Transform> transform_of(ObjectHandle object) const;  // to the world; not of a bound

    // Makes the changes take effect and finds pairs and contacts. Call it once a frame.
    //
    // Errors: more than max_pairs pairs (then there are none, and all else is up to date); a body that its object's
    // transform puts out of range (it is nowhere until that changes).
    Result<void> update(Executor& executor = serial_executor());
    [[nodiscard]] const WorldStatistics& statistics() const;
    // For overlays and measurements: the tree of what rests. Items are the objects' indices.
    [[nodiscard]] const boxtree::BoxTree& tree() const;

    // Lists what a view sees, by the objects' boxes: exactly as the request's mode says.
    //
    // May be called from any number of threads at once, each with its own `visible`. Gives the same bits for any
    // executor. Allocates nothing once `visible` has held as many objects. Tree order with occlusion costs a second
    // query. Errors name what cannot be obeyed: no camera, matrix or volume, or two that contradict each other; a
    // camera or matrix that is not valid; a volume of more than 12 planes; occlusion without an eye; a depth buffer's
    // size or a picture's out of its range; a picture beside occlusion, or without an eye.
    Result<void> view(const ViewRequest& request, ViewResult& visible, Executor& executor = serial_executor()) const;
    // The same for up to 32 views: each object once, with a mask of the views that see it.
    //
    // Views without occlusion and candidates, with equal limits and mode, are answered in one walk through the tree;
    // others one by one, shared among the executor's threads. Further errors, whose item is the place among the
    // requests: more than 32 views; views of different orders.
    Result<void> view(std::span<const ViewRequest> requests, MultiViewResult& visible,
                      Executor& executor = serial_executor()) const;
    // After a view with occlusion and before the next update: hidden_by() lists the occluders that hide an object (none
    // if it is not hidden), drawn_occluders() those that were drawn, those worth most first.
    //
    // hidden_by() draws all of them again, and allocates. Errors: invalid_argument if `visible` is of another World.
    Result<void> hidden_by(ObjectHandle object, const ViewResult& visible, Vector<OccluderRef>& occluders) const;
    Result<void> drawn_occluders(const ViewResult& visible, Vector<OccluderRef>& occluders) const;

    // Returns the nearest hit: on an object's body (as convex::raycast), else on its mesh's triangles, its sphere or
    // its box.
    //
    // A ray that begins inside a body, sphere or box hits it at t = 0, without a normal. Directions may have any length
    // but 0; an invalid ray hits nothing. Objects removed since the last update are in none of the answers.
    [[nodiscard]] std::optional<ObjectHit> raycast(const Ray& ray, std::uint32_t layers = ~0u) const;
    [[nodiscard]] bool raycast_any(const Ray& ray, std::uint32_t layers = ~0u) const;
    // Lists every object's nearest hit, in order of t, then of index.
    void raycast_all(const Ray& ray, Vector<ObjectHit>& hits, std::uint32_t layers = ~0u) const;

    // Lists the objects whose box or sphere meets the shape, in order of index. A mesh counts as its box, endless
    // ground as its half-spaces and the box around the rest of its body.
    //
    // Here and in closest(), an invalid box, and a sphere or capsule with NaN or numbers beyond kMaxCoordinate, meets
    // nothing and has nothing near.
    void overlap(const Obb& shape, Vector<ObjectRef>& found, std::uint32_t layers = ~0u) const;
    void overlap(const Sphere& shape, Vector<ObjectRef>& found, std::uint32_t layers = ~0u) const;
    void overlap(const collide::Capsule& shape, Vector<ObjectRef>& found, std::uint32_t layers = ~0u) const;
    // The same for any body but a half-space, exactly. Objects that have bodies count as these.
    //
    // Bounds beyond convex::kMaxExtent are cut off there. A box whose axes are off by more than 1e-6 counts as the
    // least box around it along the nearest orthonormal axes. An invalid pose meets nothing.
    void overlap(const convex::Body& shape, const RigidTransform& pose, Vector<ObjectRef>& found,
                 std::uint32_t layers = ~0u) const;
    // Returns the first object that a moving body meets: convex::cast against each object's body, sphere or box at
    // rest.
    //
    // A body that stands on an object can slide along it and part from it. An object that it overlaps from the start is
    // met at time 0; CastOptions::ignore_initial_overlaps leaves it out. Errors: as convex::cast; a half-space; an
    // invalid pose.
    [[nodiscard]] Result<std::optional<BodyHit>> cast(const convex::Body& shape, const RigidTransform& pose,
                                                      const convex::Motion& motion, const convex::CastOptions& options,
                                                      std::uint32_t layers = ~0u) const;
    // Returns the object whose box or sphere is nearest to the shape, within max_distance; of several the lowest index.
    [[nodiscard]] std::optional<ClosestObject> closest(const Sphere& shape, double max_distance,
                                                       std::uint32_t layers = ~0u) const;
    [[nodiscard]] std::optional<ClosestObject> closest(const Obb& shape, double max_distance,
                                                       std::uint32_t layers = ~0u) const;
    [[nodiscard]] std::optional<ClosestObject> closest(const collide::Capsule& shape, double max_distance,
                                                       std::uint32_t layers = ~0u) const;
    // The same for any body but a half-space, within the bounds that convex::distance proves. Objects that have bodies
    // count as these. Returns nothing for an invalid pose.
    [[nodiscard]] std::optional<ClosestObject> closest(const convex::Body& shape, const RigidTransform& pose,
                                                       double max_distance, std::uint32_t layers = ~0u) const;

    // pairs(): objects whose boxes or spheres meet, in order. contacts(): those of them that touch, and those that have
    // ended touching. Both as update() found them.
    //
    // With a contact margin, pairs of two bodies are listed up to that gap; on endless ground within rounding.
    [[nodiscard]] std::span<const ObjectPair> pairs() const;
    [[nodiscard]] std::span<const Contact> contacts() const;
    // Contacts of two objects that both have bodies, in order. Pairs of which neither has moved are not computed again.
    [[nodiscard]] std::span<const BodyContact> body_contacts() const;

  private:
    [[nodiscard]] Result<void> view_each(std::span<const ViewRequest> requests, MultiViewResult& visible,
                                         Executor& executor) const;
    struct State;
    Owner<State> state_;
};

}  // namespace crofton
