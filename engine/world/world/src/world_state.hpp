// SPDX-License-Identifier: MIT
// The state of a World.
#pragma once
#include <crofton/collide/bound_contacts.hpp>
#include <crofton/collide/broadphase.hpp>
#include <crofton/world/world.hpp>

#include "contact_finder.hpp"
#include "contact_list.hpp"
#include "ground.hpp"
#include "mesh_clusters.hpp"
#include "object_shapes.hpp"
#include "object_table.hpp"
#include "occluders.hpp"
#include "query_shape.hpp"
#include "region_pairs.hpp"
#include "regions.hpp"
#include "shape_contacts.hpp"
#include "spatial_index.hpp"

namespace crofton {

// What an object gets in the next update(), beside its layers and whether it is shown.
struct StagedChange {
    std::uint32_t object = kNoIndex;
    bool has_bound = false;
    Bound bound;
};

// Which of the scene's ids have been given out as handles, and how often.
struct Generations {
    explicit Generations(std::uint32_t the_first) : first(the_first) {}

    std::uint32_t first;
    Vector<std::uint32_t> generations;
    Vector<std::uint8_t> alive;

    void add(std::uint32_t id) {
        if (id >= alive.size()) {
            generations.resize(id + std::size_t{1}, first);
            alive.resize(id + std::size_t{1}, 0);
        }
        alive[id] = 1;
    }
    void remove(std::uint32_t id) {
        if (id >= alive.size() || !alive[id]) return;
        alive[id] = 0;
        world::renew(generations[id]);
    }
    template <class Tag>
    [[nodiscard]] bool contains(Handle<Tag> handle) const {
        return handle.index < alive.size() && alive[handle.index] && generations[handle.index] == handle.generation;
    }
    template <class Tag>
    [[nodiscard]] Result<void> check(const char* thing, Handle<Tag> handle, std::uint64_t item) const {
        if (contains(handle)) return {};
        return world::refuse(thing, handle.index, handle.generation, generations, first, item);
    }
};

struct World::State {
    // A call that lasts, on this thread: an update, or a view. Within it hooks and executors run, which may call back.
    class Call {
      public:
        Call(const State& state, bool changes) : state_(&state), changes_(changes), outer_(innermost_) {
            innermost_ = this;
        }
        ~Call() { innermost_ = outer_; }
        Call(const Call&) = delete;
        Call& operator=(const Call&) = delete;
        [[nodiscard]] static bool is_within(const State& state, bool changes_only) {
            const Call* call = innermost_;
            while (call != nullptr && !(call->state_ == &state && (call->changes_ || !changes_only)))
                call = call->outer_;
            return call != nullptr;
        }

      private:
        const State* state_;
        bool changes_;
        const Call* outer_;
        static constinit thread_local const Call* innermost_;
    };
    [[nodiscard]] bool is_updating() const { return Call::is_within(*this, true); }
    [[nodiscard]] Result<void> check_outside() const;  // of views and updates: for changes
    [[nodiscard]] Result<void> check_updated() const;  // for questions

    explicit State(const WorldOptions& chosen) : State(chosen, world::next_first_generation()) {}
    State(const WorldOptions& chosen, std::uint32_t first_generation)
        : options(chosen),
          table(first_generation),
          index(chosen.tree),
          finder(chosen),
          nodes(first_generation),
          meshes(first_generation),
          regions(first_generation) {
        table.names.regions = &regions;
    }

    WorldOptions options;
    WorldStatistics statistics;
    world::Revision revision{world::next_revision(), 0};
    bool scene_changed = false;  // in this update: objects, nodes or clusters
    world::ObjectTable table;
    world::SpatialIndex index;
    world::MoverTable movers;
    world::Shapes shapes;
    world::ContactFinder finder;
    world::ObjectShapes object_shapes;
    world::ShapeContacts shape_contacts;
    world::ContactList contact_list;
    world::Ground ground;
    world::Occluders occluders;
    world::MeshClusters mesh_clusters;
    Aabb object_bounds;  // about; where there are occluders
    scene::Scene scene;
    Generations nodes, meshes;
    world::Regions regions;
    world::RegionPairs region_pairs;
    Vector<std::uint32_t> region_pairs_met;  // scratch
    scene::MeshId point = scene::kNone;      // the mesh of objects that are added by their shapes alone; kNone: none is
    Vector<std::uint32_t> object_of_instance;
    Vector<glm::vec3> vertices;  // scratch
    Vector<StagedChange> staged;
    Vector<std::uint32_t> removed, rebound;  // the second: objects that have got a bound in this update
    std::size_t mesh_shapes = 0;             // objects with a mesh and a shape, at least: removed ones may count
    world::PairChanges pair_changes;

    [[nodiscard]] Result<void> check(ObjectHandle object, std::uint64_t item) const;
    [[nodiscard]] Result<void> check(NodeHandle node, std::uint64_t item) const;
    [[nodiscard]] Result<void> check(MeshHandle mesh, std::uint64_t item) const;
    // Whether the occluders that a view drew are those of now.
    [[nodiscard]] Result<void> check_viewed(const ViewResult& visible) const;
    void note_removal() { revision.removal = world::next_revision(); }
    [[nodiscard]] Result<void> reserve(std::size_t objects);
    void make_room(std::size_t objects);  // for so many more that are added at once
    StagedChange& stage(std::uint32_t object);
    [[nodiscard]] Result<void> attach_mesh(world::Object& object, const ObjectDescription& description);
    [[nodiscard]] Result<scene::MeshId> mesh_of(const ObjectDescription& description);
    // Whether the object was added with neither mesh nor bound.
    [[nodiscard]] bool is_shape_alone(const world::Object& object) const {
        return object.instance != kNoIndex && scene.mesh_of(object.instance) == point;
    }
    [[nodiscard]] Result<void> set_bound(ObjectHandle object, const Bound& bound, std::uint64_t item);
    [[nodiscard]] Result<void> set_transform(ObjectHandle object, const Transform& transform, std::uint64_t item);
    [[nodiscard]] Result<void> set_transform(NodeHandle node, const Transform& transform, std::uint64_t item);
    [[nodiscard]] Result<void> set_local(scene::NodeId node, const Transform& transform, std::uint64_t item);
    [[nodiscard]] bool stage_box_of_mover(std::uint32_t object, BoundKind kind, const Obb& box, double radius);
    void mark_removed(std::uint32_t object);
    void apply_changes();
    void note_movers();
    [[nodiscard]] Result<void> apply_scene(Executor& executor);
    void refresh_visibility(std::uint32_t object);
    // Of objects with shapes, or with some until now: what stands in the index for them. `bound`: that they have got.
    [[nodiscard]] Result<void> update_shapes();
    void update_bound(std::uint32_t object, const Bound& bound);
    [[nodiscard]] Bound bound_of(std::uint32_t object) const;  // as given, of an object without a mesh
    // Whether the shapes of what hangs on a node, and below it, may have their transforms. As set, not as updated.
    [[nodiscard]] Result<void> check_shapes_below(scene::NodeId node, std::uint64_t item) const;
    [[nodiscard]] Transform world_to_be(scene::NodeId node) const;
    [[nodiscard]] world::GroundShape ground_shape(std::uint32_t object) const;
    [[nodiscard]] bool is_ground(std::uint32_t object, std::uint32_t layers) const;
    void update_ground();
    void update_ground_contacts();
    // Pairs and contacts with objects of regions, after all others; none if these have failed. Errors: theirs; more
    // than max_pairs.
    Result<void> update_region_pairs(Result<void> others);
    void list_changed_near_regions();
    void add_region_pairs_of(std::uint32_t object);
    [[nodiscard]] Obb region_collider_box(std::uint32_t other, const Obb& box) const;
    // How two objects touch of which one has a shape.
    void touch_shape(const IdPair& pair, world::ShapeTouch& touch) const;
    // How one of the World's own and an object of a region touch, of which one has no shape.
    void touch_in_region(std::uint32_t object, std::uint32_t other, world::BoundTouch& touch);
    void update_shape_contacts(Executor& executor);
    [[nodiscard]] std::span<const ObjectPair> own_pairs() const {
        return ground.is_used() ? ground.pairs() : finder.pairs();
    }
    [[nodiscard]] std::span<const Contact> own_contacts() const {
        return ground.is_used() ? ground.contacts() : finder.contacts();
    }
    [[nodiscard]] bool update_occluders();  // returns whether any has come, gone or moved
    void release_scratch();
    [[nodiscard]] Result<void> set_found_occluders(scene::MeshId mesh, const occlude::FindOptions& how);
    // CullOptions::candidate_mask, in `both`, with the bits of objects that have moved or reuse an index.
    [[nodiscard]] std::span<const std::uint64_t> candidates_and_changed(std::span<const std::uint64_t> candidate_mask,
                                                                        Vector<std::uint64_t>& both) const;
    void find_triangles(const ViewRequest& request, const world::PictureView::InFrustum& in_frustum,
                        world::OccludedView& result, Executor& executor) const;
    // Draws the occluders that are worth most to the view into the result's buffer, then asks what they do not hide.
    void draw_and_ask(const occlude::OcclusionView& view, const OcclusionOptions& occlusion, std::uint32_t layers,
                      const cull::CullOptions& how, Executor& executor, world::OccludedView& result) const;

    // Of an object of the World's own or of a region: whether it has a shape; the mesh that stands for it, if it has
    // none; whether it has either.
    [[nodiscard]] bool has_own_shape(std::uint32_t id) const {
        return world::is_region_index(id) ? regions.has_shape(id) : object_shapes.has(id);
    }
    // Whether the object is its box, so that a ray that meets the one meets the other there.
    [[nodiscard]] bool is_box(std::uint32_t id) const {
        if (world::is_region_index(id) || object_shapes.has(id)) return false;
        const world::Object& object = table.objects[id];
        return object.instance == kNoIndex && object.kind != BoundKind::sphere;
    }
    [[nodiscard]] world::PlacedMesh mesh_of_object(std::uint32_t id) const {
        if (world::is_region_index(id)) return regions.mesh(id);
        const world::Object& object = table.objects[id];
        const world::MeshShape* const mesh = shapes.mesh_of(object);
        if (mesh == nullptr) return {};
        const Transform& world = scene.world(scene.node_of(object.instance));
        return {mesh, &world.linear, world.translation};
    }
    [[nodiscard]] bool has_shape(std::uint32_t id) const {
        return has_own_shape(id) || mesh_of_object(id).mesh != nullptr;
    }
    [[nodiscard]] Obb box_of_object(std::uint32_t id) const {
        return world::is_region_index(id) ? regions.box(id) : index.box(id);
    }
    // Returns an object's shape, or else its mesh, sphere or box.
    [[nodiscard]] world::QueryShape query_shape_of(std::uint32_t object) const;
    // Answer for an object by its shape, as overlap() and closest() say. The distance is infinite beyond `limit`.
    [[nodiscard]] bool overlaps(const convex::ShapeAtPose& shape, std::uint32_t object) const;
    [[nodiscard]] world::Gap gap_to_shape(const convex::ShapeAtPose& shape, std::uint32_t object, double limit) const;
    // Returns a point of the shape that lies inside an object's closed mesh, if contacts count that as touching.
    [[nodiscard]] std::optional<glm::dvec3> point_inside(const convex::ShapeAtPose& shape, std::uint32_t object) const;
    // Returns the object of an index in an answer, the World's own or a region's.
    [[nodiscard]] ObjectRef ref_of(std::uint32_t object) const { return world::ref(table.names, object); }

    // How far along the ray an object's own shape is met, no farther than the ray goes; its box is met at `box_t`.
    [[nodiscard]] std::optional<ObjectHit> shape_hit(const Ray& ray, std::uint32_t object, double box_t) const;
    [[nodiscard]] std::optional<ObjectHit> own_shape_hit(const Ray& ray, std::uint32_t object) const;
    [[nodiscard]] bool is_ignored(const QueryFilter& filter, std::uint32_t object) const;
    // Visits objects whose boxes the ray meets; the visitor answers how far along the ray others are of interest.
    void visit_along(const Ray& ray, const QueryFilter& filter, collide::RayVisitor visit) const;
    // Visits objects whose boxes a box may meet whose center moves along the path, and some others, near ones roughly
    // first; the visitor answers likewise.
    void visit_swept(const Ray& path, const glm::dvec3& half_size, const QueryFilter& filter,
                     collide::NearVisitor visit) const;
    // Visits objects whose boxes are within `distance` of `bounds`, and some others, near ones roughly first.
    void visit_near(const Aabb& bounds, double distance, const QueryFilter& filter, collide::NearVisitor visit) const;
    void visit_bounded_near(const Aabb& bounds, double distance, std::uint32_t layers,
                            collide::NearVisitor visit) const;
    struct Sweep;
    template <class Shape>
    void overlap(const Shape& shape, Vector<ObjectRef>& found, const QueryFilter& filter) const;
    // How far an object is, and the nearest points: first the shape's, then the object's.
    using GapTo = FunctionRef<world::Gap(std::uint32_t object, double limit)>;
    // `bounds` are around the shape.
    [[nodiscard]] std::optional<ClosestObject> closest(const Aabb& bounds, double max_distance,
                                                       const QueryFilter& filter, GapTo gap_to_object) const;
    template <class Shape>
    [[nodiscard]] std::optional<ClosestObject> closest(const Shape& shape, double max_distance,
                                                       const QueryFilter& filter) const;
};

}  // namespace crofton
