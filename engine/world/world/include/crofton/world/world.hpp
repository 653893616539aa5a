// SPDX-License-Identifier: MIT
// World holds a game's objects and answers queries: views, contacts, rays, casts, overlaps.
#pragma once
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/geometry/shapes.hpp>
#include <crofton/world/answers.hpp>
#include <crofton/world/inputs.hpp>
#include <crofton/world/region.hpp>
#include <optional>
#include <span>

namespace crofton {

namespace convex {
class Shape;
struct CastOptions;
struct ManifoldOptions;
struct Motion;
}  // namespace convex

struct ObjectManifold;  // crofton/world/object_manifold.hpp

namespace world {
class RegionSolids;
struct Eye;
}  // namespace world

inline constexpr std::size_t kAutomatic = ~std::size_t{0};

// Functions of your profiler. World calls them at the beginning and end of each zone, on the thread that runs the zone;
// zones of a thread are nested. Several views at once run on the executor's threads. Names live as long as the program.
// Null functions are not called. The functions must not throw.
struct TraceHooks {
    void (*begin)(void* user, const char* zone) = nullptr;
    void (*end)(void* user, const char* zone) = nullptr;
    void (*count)(void* user, const char* counter, double value) = nullptr;
    void* user = nullptr;
};

struct WorldOptions {
    bool pairs = true;            // false: update() finds neither pairs nor contacts
    bool contacts = true;         // false: update() finds pairs only
    bool containment = true;      // counts an object inside a closed mesh as a contact; boxes and spheres are solid
    double contact_margin = 0.0;  // ≥ 0: gaps up to this between shapes are contacts
    bool mesh_depth = false;      // computes depths of contacts between meshes; takes longer than finding them
    std::size_t max_pairs = std::size_t{1} << 24;  // update() fails if there are more, so that memory stays bounded
    // Background work on the tree in each update, as a number of items (BoxTree::rebuild_step), in addition to what
    // changes require. kAutomatic: at least a 2048th of the objects and 128 while a rebuild is under way. 0: none, and
    // no allocation.
    std::size_t rebuild_budget = kAutomatic;
    std::uint32_t updates_to_rest = 16;  // updates without motion after which an object rests again
    boxtree::Orientation tree = boxtree::Orientation::aligned;  // of the tree of resting objects
    TraceHooks trace = {};                                      // called for each stage of updates and views
};

// As of the last update.
struct WorldStatistics {
    std::size_t objects = 0;              // all, hidden ones too
    std::size_t resting = 0, moving = 0;  // in the tree, in the list; none that is hidden or in no layer
    std::uint32_t boxes_changed = 0;      // in this update; includes meshes that moved within their boxes
    bool tree_built = false;              // built in one go: a scene was loaded, or much came to rest
    std::uint64_t box_pairs_tested = 0, contact_pairs_tested = 0;  // the second: pairs whose shapes were tested
    std::uint64_t shape_pairs_computed = 0;                        // in this update; none for resting objects
    collide::BatchStatistics box_tests;                            // how the pairs of boxes were decided
    double contacts_us = 0.0;  // microseconds that pairs and contacts took in this update
    std::uint32_t nodes_updated = 0;
    // Objects of attached regions whose occluders are not placed yet. An update places some 256 occluders, and fewer of
    // meshes that are new; until then, these objects hide nothing.
    std::size_t occluders_waiting = 0;
    std::uint32_t out_of_range = 0;  // objects whose product of transforms is out of range: hidden until it is valid
};

// Owns nodes, meshes and objects. Detects motion automatically: resting objects are in a tree, moving ones in a list.
//
// Changes take effect in update(). Const calls answer as of the last update and may run on any number of threads at
// once. No other call may run at the same time as any call. A scale of 0 in all axes hides an object, in one axis it
// makes its box flat.
//
// A call that returns an error changes nothing. Calls with many handles apply all valid items and return the first
// error, whose item is the place among the handles. Every call fails for a stale handle, and for numbers that are NaN,
// infinite or out of range (validate(Obb), validate(Transform)).
//
// Executors, trace hooks and log handlers run within calls, and may call back: from within update() changes and
// questions of that World are errors, or find nothing where they return no error; from within view() changes are
// errors. They must not destroy it.
//
// A World that has been moved from is an empty one with default options, and may be used again.
class World {
  public:
    explicit World(const WorldOptions& options = {});
    ~World();
    World(World&&) noexcept;
    World& operator=(World&&) noexcept;

    Result<ObjectHandle> add(const ObjectDescription& description);
    // Adds many. objects[i] becomes the handle of descriptions[i], null where that is invalid. Error: sizes differ, and
    // then it adds none.
    Result<void> add(Strided<ObjectDescription> descriptions, std::span<ObjectHandle> objects);
    // Takes memory for so many objects in all, so that no later add() or update() copies what the World knows of each
    // to larger memory. Contacts, meshes, nodes and shapes are not counted. Errors: more than 2^30 objects
    // (out_of_range); too little memory (out_of_memory).
    Result<void> reserve(std::size_t objects);
    Result<void> remove(ObjectHandle object);
    // Requires an object that was added with a transform, or by its shape under no node.
    Result<void> set_transform(ObjectHandle object, const Transform& transform);
    Result<void> set_transforms(Strided<ObjectHandle> objects, Strided<Transform> transforms);
    // Requires an object that was added with a bound.
    Result<void> set_bound(ObjectHandle object, const Bound& bound);
    Result<void> set_bounds(Strided<ObjectHandle> objects, Strided<Obb> boxes);
    Result<void> set_mesh(ObjectHandle object, MeshHandle mesh);  // of an object that has one
    Result<void> set_hidden(ObjectHandle object, bool hidden);    // no answer contains it until it is shown again
    Result<void> set_layers(ObjectHandle object, std::uint32_t layers);
    Result<void> set_collides_with(ObjectHandle object, std::uint32_t layers);
    Result<void> set_user(ObjectHandle object, std::uint64_t user);  // at once, in pairs from the next update on

    // Gives an object a shape, or takes it away (nullptr). Pairs change with the next update, queries at once.
    //
    // Contacts of two objects that both have shapes have Contact::shape_points; others have Contact::points. Data that
    // the shape refers to must stay alive and unchanged; to change it, set the shape again. The object's transform, or
    // the frame of its box or sphere, places the shape; axes that are left-handed or off by more than 1e-6 are replaced
    // by the nearest rotation.
    //
    // Box: from the next update on, the object's box is the smallest in its own frame that contains the shape and the
    // bound or the mesh's box, if it has one. Views, pairs and queries use this box, so that they miss no part of the
    // shape. A sphere that does not contain the shape is replaced by that box. The bound's size may be 0: it then only
    // gives the shape's position.
    //
    // Ground: half-spaces, and compounds that contain some, are infinite. They are tested against everything that
    // shares layers with them, wherever their object's box is; views use that box. The time of an update grows with the
    // number of objects on level ground, or, if the ground is tilted, with the number of all objects.
    //
    // Scale: a transform that is not rigid scales the shape. A uniform scale, within 1e-5, works for any kind of shape.
    // Other maps, also flat and mirroring ones, work for shapes with vertices and no rounding, and for half-spaces.
    // Cylinders, cones and height fields may be scaled along their axes. Sizes are rounded to float. Scaled hulls and
    // meshes are rebuilt whenever the scale changes.
    //
    // Errors: the object's transform would turn the shape into another kind (unsupported) or put it out of range; calls
    // that set transforms or parents return the same errors. nullptr for an object that was added with only a shape
    // (invalid_argument).
    Result<void> set_shape(ObjectHandle object, const convex::Shape* shape);

    // A mesh must have triangles and pass validate(TriangleMesh).
    Result<MeshHandle> add_mesh(const MeshDescription& description);
    Result<void> replace_mesh(MeshHandle mesh, const MeshDescription& description);
    Result<void> set_vertices(MeshHandle mesh, PointsView positions);  // as many as before: a mesh that deforms
    Result<void> remove(MeshHandle mesh);                              // error: objects use it

    // Set a mesh's occluders: in views with occlusion, the mesh's objects hide others by them. find_occluders()
    // searches the triangles, which takes a second or more for 100,000. set_occluders() takes your own or stored
    // occluders, in the mesh's frame.
    //
    // Your own occluders must be opaque and lie within the drawn mesh. An occluder is a box (only kind and box are
    // read), the convex hull of surface.positions, or a patch of any triangles. Replacing a mesh or its vertices
    // removes its occluders. Errors: as occlude::find_occluders and occlude::OccluderSet; the item is the occluder.
    Result<void> find_occluders(MeshHandle mesh, const occlude::FindOptions& options = {});
    Result<void> set_occluders(MeshHandle mesh, std::span<const occlude::FoundOccluder> occluders);
    [[nodiscard]] std::span<const occlude::FoundOccluder> occluders_of(MeshHandle mesh) const;  // none: empty
    Result<void> set_occludes(ObjectHandle object, bool occludes);  // as ObjectDescription; of an object with a mesh

    // Returns the clusters of a mesh with MeshDescription::clusters, as of the last update; nullptr for other meshes.
    // Permute the index buffer that you draw by its triangle_order(). Both stay while the mesh deforms (set_vertices);
    // replace_mesh() cuts anew. It reads the World's positions: call keep_copy()
    // of a copy before the mesh changes or is removed.
    [[nodiscard]] const depth::ClusteredMesh* clusters_of(MeshHandle mesh) const;

    Result<NodeHandle> add_node(const NodeDescription& description = {});
    Result<void> remove(NodeHandle node);  // with all nodes and objects below it
    Result<void> set_transform(NodeHandle node, const Transform& transform);
    Result<void> set_transforms(Strided<NodeHandle> nodes, Strided<Transform> transforms);
    Result<void> set_parent(NodeHandle node, NodeHandle parent_or_null);  // error: the node itself or one below it
    Result<void> set_layers(NodeHandle node, std::uint32_t layers);

    // Places a region in the world: coordinates of its objects are relative to `origin`. The same region may be
    // attached at several origins. Takes constant time, and so does detach(), whatever the region holds.
    //
    // From the next update on, all answers contain the region's objects as if they had been added one by one, with
    // centers of boxes and translations of transforms that are the sums of their own and the origin, rounded once;
    // exactness is that of other objects. Boxes around meshes and shapes are those of the region, a little wider
    // (RegionOptions::max_origin). What occluders of regions hide is left out as soon as they are placed
    // (WorldStatistics::occluders_waiting).
    //
    // The object at place i of the region has the index of object_in(region, 0) plus i. Such objects are at rest.
    // set_hidden() works for them; other changes fail with `unsupported`: hide the object and add one of the World's
    // own. pairs() and contacts() contain pairs of one of the World's own objects and one of a region
    // (docs/large_worlds.md).
    //
    // Detaching makes the handles of the region's objects stale. As for removed objects, rays and shapes no longer
    // meet them, and other answers follow with the next update. Errors: an origin that is not finite, or puts the
    // objects beyond 5e29, or is beyond the region's max_origin; more than 2^31 objects in all regions; a stale handle.
    Result<RegionHandle> attach(const Region& region, const glm::dvec3& origin);
    Result<void> detach(RegionHandle region);
    [[nodiscard]] bool contains(RegionHandle region) const;
    // Error: no such place (out_of_range).
    [[nodiscard]] Result<ObjectHandle> object_in(RegionHandle region, std::uint32_t place) const;
    // Error: an object of the World's own (invalid_argument).
    [[nodiscard]] Result<RegionPlace> place_of(ObjectHandle object) const;

    [[nodiscard]] bool contains(ObjectHandle object) const;
    [[nodiscard]] bool contains(MeshHandle mesh) const;
    [[nodiscard]] bool contains(NodeHandle node) const;
    [[nodiscard]] std::size_t object_count() const;  // of regions too; removed and detached ones are not counted
    [[nodiscard]] Result<std::uint64_t> user_of(ObjectHandle object) const;
    // Returns the box of the last update. Error: there was no update since the object was added (empty).
    [[nodiscard]] Result<Obb> box_of(ObjectHandle object) const;
    [[nodiscard]] Result<Transform> transform_of(
        ObjectHandle object) const;  // to the world; an error for an object with a bound

    // Applies the changes and finds pairs and contacts. Call it once a frame.
    //
    // Errors: more than max_pairs pairs (all pairs are dropped; everything else is up to date); an object's transform
    // puts its shape out of range (no answer contains the shape until the transform changes).
    Result<void> update(Executor& executor = serial_executor());
    [[nodiscard]] const WorldStatistics& statistics() const;
    // Returns the tree of resting objects, for overlays and measurements. Its items are the objects' indices.
    [[nodiscard]] const boxtree::BoxTree& tree() const;

    // Lists the objects whose boxes a view sees, as exactly as the request's mode says.
    //
    // May be called from any number of threads at once, each with its own `visible`. Gives the same bits for any
    // executor. Allocates nothing once `visible` has held as many objects. Tree order with occlusion costs a second
    // query. Errors name what cannot be obeyed: no camera, matrix or volume, or two that contradict each other; a
    // camera or matrix that is not valid; a volume of more than 12 planes, or with one that is not finite; limits with
    // a hysteresis below 1, or neither 32 layer distances nor none; occlusion without an eye, or whose least cover is
    // NaN; a depth buffer's size or a picture's out of its range; a picture together with occlusion, or without an eye;
    // receivers without a picture, without the answer to a view with a picture of this World, with one from before the
    // World changed, with `visible` itself, or with a radius out of its range.
    Result<void> view(const ViewRequest& request, ViewResult& visible, Executor& executor = serial_executor()) const;
    // Answers up to 32 views: lists each object once, with a mask of the views that see it.
    //
    // Views without occlusion and candidates, with equal limits and mode, take one walk through the tree. Other views
    // are answered one by one, distributed to the executor's threads. Errors, whose item is the place among the
    // requests: those of a single view; more than 32 views; views of different orders.
    Result<void> view(std::span<const ViewRequest> requests, MultiViewResult& visible,
                      Executor& executor = serial_executor()) const;
    // hidden_by() lists the occluders that hide an object, none if it is not hidden. drawn_occluders() lists the drawn
    // occluders, those that hide most first. Call them after a view with occlusion and before the next update.
    //
    // hidden_by() draws all occluders again, and allocates. Errors: invalid_argument if `visible` is of another World,
    // or an update has changed something since.
    Result<void> hidden_by(ObjectHandle object, const ViewResult& visible, Vector<OccluderRef>& occluders) const;
    Result<void> drawn_occluders(const ViewResult& visible, Vector<OccluderRef>& occluders) const;

    // Returns the nearest hit. Tests an object's shape (as convex::raycast), or if it has none, its mesh's triangles,
    // its sphere or its box.
    //
    // A ray that begins inside a shape, sphere or box hits it at t = 0, without a normal. A direction may have any
    // length except 0. An invalid ray hits nothing. No answer contains objects removed since the last update.
    [[nodiscard]] std::optional<ObjectHit> raycast(const Ray& ray, const QueryFilter& filter = {}) const;
    [[nodiscard]] bool raycast_any(const Ray& ray, const QueryFilter& filter = {}) const;
    // Lists the nearest hit of each object that the ray hits, in order of t, then of index.
    void raycast_all(const Ray& ray, Vector<ObjectHit>& hits, const QueryFilter& filter = {}) const;

    // Lists the objects that overlap the probe, in order of index. Tests an object's shape (as convex::intersects), or
    // if it has none, its mesh's triangles, its sphere or its box.
    //
    // A mesh is a surface. A probe inside it overlaps it if the mesh is closed there and WorldOptions::containment is
    // set, as for contacts; a shape of a mesh is a surface only. Exact for boxes with boxes; otherwise as exact as
    // convex::intersects. Beside a shape or mesh, a box whose axes are off by more than 1e-6 counts as the smallest box
    // around it along the nearest orthonormal axes. Vertices of meshes under a scale or shear are rounded to double.
    //
    // An invalid box, and a sphere or capsule with NaN or numbers beyond kMaxCoordinate, overlaps nothing; closest()
    // finds nothing for it.
    void overlap(const Obb& probe, Vector<ObjectRef>& found, const QueryFilter& filter = {}) const;
    void overlap(const Sphere& probe, Vector<ObjectRef>& found, const QueryFilter& filter = {}) const;
    void overlap(const collide::Capsule& probe, Vector<ObjectRef>& found, const QueryFilter& filter = {}) const;
    // The same for any shape except a half-space. A shape with an invalid pose overlaps nothing.
    void overlap(const convex::Shape& probe, const RigidTransform& pose, Vector<ObjectRef>& found,
                 const QueryFilter& filter = {}) const;
    // Returns the first object that a moving shape meets, by convex::cast against each object's shape, or if it has
    // none, its mesh's triangles, its sphere or its box. The objects are at rest.
    //
    // A shape that starts inside a closed mesh meets the mesh from inside, as a ray does.
    // A shape that stands on an object can slide along it and move away from it. An object that overlaps the shape at
    // the start is met at time 0; CastOptions::ignore_initial_overlaps leaves it out. Errors: as convex::cast; a
    // half-space; an invalid pose.
    [[nodiscard]] Result<std::optional<ShapeHit>> cast(const convex::Shape& probe, const RigidTransform& pose,
                                                       const convex::Motion& motion, const convex::CastOptions& options,
                                                       const QueryFilter& filter = {}) const;
    // Lists the first hit of each object that the moving shape meets, in order of time, then of index.
    //
    // Each is that of convex::cast with the object; objects that the cast begins in contact with are neighbours, so
    // that a shape that slides on flush objects does not meet their sides. An object is not met a second time.
    // CastOptions::early_out leaves out later hits. Errors: as cast.
    Result<void> cast_all(const convex::Shape& probe, const RigidTransform& pose, const convex::Motion& motion,
                          const convex::CastOptions& options, Vector<ShapeHit>& hits,
                          const QueryFilter& filter = {}) const;
    // Lists where a shape, which need not be an object, touches the objects, and how deep: to push a character out of
    // walls, to ask whether a thing fits into a place, to find what a blow meets. Ordered by index of the object; of
    // one object the deepest manifold comes first.
    //
    // Each object's manifolds are those of convex::contact_manifolds with its shape, or if it has none, its mesh's
    // triangles, its sphere or its box, up to `options.margin` away. The other objects near the probe are neighbours
    // (convex::Beside), so that flush objects push as their union does. A mesh is a surface: a probe that is inside it
    // and does not reach it has no contact. Allocates. Errors: a half-space; an invalid pose; options out of range.
    Result<void> contact_manifolds(const convex::Shape& probe, const RigidTransform& pose,
                                   const convex::ManifoldOptions& options, Vector<ObjectManifold>& found,
                                   const QueryFilter& filter = {}) const;
    // Returns the object that is nearest to the probe, at most max_distance away; if several are equally near, the one
    // with the lowest index. Tests the same shapes as overlap(): the distance is 0 iff the probe overlaps the object.
    [[nodiscard]] std::optional<ClosestObject> closest(const Sphere& probe, double max_distance,
                                                       const QueryFilter& filter = {}) const;
    [[nodiscard]] std::optional<ClosestObject> closest(const Obb& probe, double max_distance,
                                                       const QueryFilter& filter = {}) const;
    [[nodiscard]] std::optional<ClosestObject> closest(const collide::Capsule& probe, double max_distance,
                                                       const QueryFilter& filter = {}) const;
    // The same for any shape except a half-space, within the bounds that convex::distance proves. Returns nothing for
    // an invalid pose.
    [[nodiscard]] std::optional<ClosestObject> closest(const convex::Shape& probe, const RigidTransform& pose,
                                                       double max_distance, const QueryFilter& filter = {}) const;

    // pairs() returns the pairs of objects whose boxes or spheres overlap, in order. contacts() returns the pairs that
    // touch, and those that have ended touching, in order. Both are of the last update.
    //
    // With a contact margin, pairs of two shapes are listed up to that gap; on infinite ground, within rounding.
    [[nodiscard]] std::span<const ObjectPair> pairs() const;
    [[nodiscard]] std::span<const Contact> contacts() const;

  private:
    friend class world::RegionSolids;
    World(const WorldOptions& options, std::uint32_t first_generation);
    // `visible` receives the answer; null if it surely is not the receivers' result.
    [[nodiscard]] Result<void> check_receivers(const ViewRequest& request, const ViewResult* visible,
                                               std::uint64_t item) const;
    // View the World's own objects, without those of regions.
    void view_own(const ViewRequest& request, const world::Eye& eye, ViewResult& visible, Executor& executor) const;
    [[nodiscard]] Result<void> view_own(std::span<const ViewRequest> requests, std::span<const world::Eye> eyes,
                                        MultiViewResult& visible, Executor& executor) const;
    void view_each(std::span<const ViewRequest> requests, std::span<const world::Eye> eyes, MultiViewResult& visible,
                   Executor& executor) const;
    // Adds regions' objects to such an answer.
    void find_in_regions(const ViewRequest& request, const cull::View& view, ViewResult& visible) const;
    void add_regions(const ViewRequest& request, const cull::View& view, ViewResult& visible, Executor& executor) const;
    void add_regions(std::span<const ViewRequest> requests, std::span<const world::Eye> eyes,
                     MultiViewResult& visible) const;
    void keep_in_picture(const ViewRequest& request, ViewResult& visible, Executor& executor) const;
    struct State;
    // A World that was moved from has no state: its queries get that of an empty World, and its changes begin a new
    // one.
    class StateOwner {
      public:
        explicit StateOwner(Owner<State> state);
        State* operator->() { return state_ ? state_.get() : renew(); }
        State& operator*() { return *operator->(); }
        State* operator->() const { return state_ ? state_.get() : empty(); }
        State& operator*() const { return *operator->(); }

      private:
        State* renew();
        static State* empty();
        Owner<State> state_;
    };
    StateOwner state_;
};

}  // namespace crofton
