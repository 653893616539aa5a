// SPDX-License-Identifier: MIT
#include "contact_finder.hpp"
#include <crofton/collide/bound_contacts.hpp>
#include <crofton/mesh/mesh_distance.hpp>
#include <crofton/mesh/mesh_query.hpp>

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <utility>

#include "pair_order.hpp"

namespace crofton::world {
namespace {

// Requires that the boxes meet.
bool bounds_meet(const Object& a, const Obb& box_a, const Object& b, const Obb& box_b) {
    const bool sphere_a = a.kind == BoundKind::sphere, sphere_b = b.kind == BoundKind::sphere;
    if (sphere_a && sphere_b) return glm::length(box_a.center - box_b.center) <= a.radius + b.radius;
    if (sphere_a) return collide::intersects(box_b, sphere_of(a, box_a));
    if (sphere_b) return collide::intersects(box_a, sphere_of(b, box_b));
    return true;
}

// Requires that the bounds meet.
collide::Manifold touch_of_bounds(const Object& a, const Obb& box_a, const Object& b, const Obb& box_b) {
    const bool sphere_a = a.kind == BoundKind::sphere, sphere_b = b.kind == BoundKind::sphere;
    if (sphere_a && sphere_b) return collide::contact_manifold(sphere_of(a, box_a), sphere_of(b, box_b));
    if (sphere_b) return collide::contact_manifold(box_a, sphere_of(b, box_b));
    if (!sphere_a) return collide::contact_manifold(box_a, box_b);
    collide::Manifold manifold = collide::contact_manifold(box_b, sphere_of(a, box_a));
    manifold.normal = -manifold.normal;
    return manifold;
}

glm::dvec3 unit_or_zero(const glm::dvec3& v) {
    const double length = glm::length(v);
    return length > 0.0 ? v / length : v;
}

// Axes of boxes, and so poses, are orthonormal as far as floats are: a direction they turn needs its length again.
glm::dvec3 turned(const RigidTransform& pose, const glm::dvec3& direction) {
    return unit_or_zero(pose.rotation * direction);
}

// The box of what is no collider: it is refused by validate(Obb).
Obb no_box() {
    Obb box;
    box.center = glm::dvec3(std::numeric_limits<double>::quiet_NaN());
    return box;
}

// The filter of an object that does not collide.
constexpr collide::CollisionFilter kInNoPair{0, 0};

bool comes_before(const Contact& a, const IdPair& b) {
    return IdPair{a.first.object.index, a.second.object.index} < b;
}

}  // namespace

ContactFinder::ContactFinder(const WorldOptions& options)
    : options_(options), broadphase_({.exact_boxes = true, .max_pairs = options.max_pairs}) {}

void ContactFinder::note_colliders(const ObjectTable& table, SpatialIndex& index, const scene::Scene& scene,
                                   const ObjectShapes& shapes_of, const PairChanges& changes) {
    if (index.size() > filters_.size()) filters_.append(index.size() - filters_.size(), kInNoPair);
    if (has_own_boxes_ && index.size() > boxes_.size()) boxes_.append(index.size() - boxes_.size(), no_box());
    moved_.clear();
    for (const auto items : {index.moved_items(), index.member_items(), std::span<const ItemId>(changes.objects)})
        moved_.insert(moved_.end(), items.begin(), items.end());
    for (const ItemId item : moved_) {
        const Object& object = table.objects[item];
        const collide::CollisionFilter filter{index.layers(item), object.collides_with};
        const bool is_unbounded = shapes_of.is_unbounded(item);
        const bool collides =
            object.alive && filter.collides_with != 0 && index.is_placed(item) && !is_unbounded && filter.layers != 0;
        filters_.set(item, collides ? filter : kInNoPair);
        if (!collides) {
            if (is_unbounded && index.is_placed(item)) take_own_boxes(index);
            note_box(item, nullptr, index);
            continue;
        }
        const Obb box = shapes_of.collider_box(item, object, index.box(item), scene, options_.contact_margin / 2.0);
        note_box(item, &box, index);
    }
    // The broadphase looks at all objects then, also at those that it is not told of.
    if (!has_idle_ || moved_.size() <= index.size() / collide::Broadphase::kFewMovers) return;
    take_own_boxes(index);
    has_idle_ = false;
    for (ItemId item = 0; item < filters_.size(); ++item)
        if (filters_[item].collides_with == 0) boxes_.set(item, no_box());
}

void ContactFinder::take_own_boxes(const SpatialIndex& index) {
    if (std::exchange(has_own_boxes_, true)) return;
    boxes_.reserve(index.size() + index.size() / 16);
    boxes_.append(index.kept_boxes());
}

// nullptr: the object is no collider.
void ContactFinder::note_box(ItemId item, const Obb* box, SpatialIndex& index) {
    if (!has_own_boxes_ && box != nullptr && !have_same_bits(*box, index.box(item))) take_own_boxes(index);
    if (has_own_boxes_) return boxes_.set(item, box != nullptr ? *box : no_box());
    if (box != nullptr) return index.keep_box(item, *box);
    index.keep_no_box(item);
    has_idle_ |= index.is_placed(item);
}

void ContactFinder::note_pairs(const ObjectTable& table, const PairChanges& changes) {
    const auto refs = [&](std::span<const IdPair> pairs, Vector<ObjectPair>& named) {
        named.clear();
        for (const IdPair& pair : pairs) named.push_back({table.ref(pair.first), table.ref(pair.second)});
    };
    refs(broadphase_.began(), began_pairs_);
    refs(broadphase_.ended(), ended_pairs_);
    pairs_.note(began_pairs_, ended_pairs_);
    if (!changes.renamed) return;
    refs(broadphase_.tested(), began_pairs_);
    std::size_t place = 0;
    Vector<ObjectPair>& pairs = pairs_.values();
    for (const ObjectPair& pair : began_pairs_) {
        place = find_from(place, pairs, pair, IsBefore());
        pairs[place] = pair;
    }
}

void ContactFinder::touch_bounds(const ObjectTable& table, const SpatialIndex& index, const IdPair& pair,
                                 Worker& worker, Touch& touch) const {
    const std::uint32_t i = pair.first, j = pair.second;
    const Object &a = table.objects[i], &b = table.objects[j];
    const Obb &box_a = index.box(i), &box_b = index.box(j);
    const collide::Manifold manifold = touch_of_bounds(a, box_a, b, box_b);
    touch.hit = true;
    touch.normal = manifold.normal;
    touch.depth = manifold.depth;
    touch.point_count = static_cast<std::uint32_t>(manifold.count);
    worker.points.insert(worker.points.end(), manifold.points, manifold.points + manifold.count);
}

void ContactFinder::touch_triangles(const PosedTree& a, const PosedTree& b, Worker& worker, Touch& touch) const {
    const RigidTransform b_to_a = relative(a.pose, b.pose);
    mesh::contacts(*a.tree, *b.tree, b_to_a, worker.found);
    touch.hit = !worker.found.empty();
    if (!touch.hit && (options_.containment || a.is_solid || b.is_solid)) {
        const mesh::Containment inside = mesh::containment_of_disjoint(*a.tree, *b.tree, b_to_a);
        // A bound is solid in any case, a mesh only as the option says.
        const bool counts = inside == mesh::Containment::a_inside_b   ? b.is_solid
                            : inside == mesh::Containment::b_inside_a ? a.is_solid
                                                                      : inside == mesh::Containment::partly;
        if (options_.containment || counts) touch.inside = inside;
        touch.hit = touch.inside != mesh::Containment::none;
    }
    if (!touch.hit) return;
    touch.triangle_count = static_cast<std::uint32_t>(worker.found.size());
    const bool mirrors = glm::determinant(a.pose.rotation) < 0.0;
    for (mesh::MeshContact contact : worker.found) {
        contact.segment = {transform(a.pose, contact.segment.begin), transform(a.pose, contact.segment.end)};
        if (mirrors) std::swap(contact.segment.begin, contact.segment.end);  // to go round as MeshContact says
        contact.normal = turned(a.pose, contact.normal);
        worker.triangles.push_back(contact);
    }
    const collide::Manifold manifold = collide::contact_manifold(*a.tree, *b.tree, b_to_a, worker.found);
    touch.point_count = static_cast<std::uint32_t>(manifold.count);
    for (int i = 0; i < manifold.count; ++i)
        worker.points.push_back({transform(a.pose, manifold.points[i].position), manifold.points[i].depth});
    touch.depth = manifold.depth;
    touch.normal = turned(a.pose, manifold.normal);
    if (!options_.mesh_depth) return;
    const mesh::SeparatingMotion way_out = mesh::separating_motion(*a.tree, *b.tree, b_to_a, worker.found);
    touch.depth = way_out.depth;
    touch.normal = turned(a.pose, way_out.direction);
}

// The normal points from the mesh to the sphere.
void ContactFinder::touch_sphere(const PosedTree& mesh, const PosedTree& center, double radius, Worker& worker,
                                 Touch& touch) const {
    const RigidTransform to_mesh = relative(mesh.pose, center.pose);
    const mesh::MeshDistance gap = mesh::distance_to_point(*mesh.tree, to_mesh.translation);
    const bool inside = options_.containment && mesh::contains(*mesh.tree, to_mesh.translation);
    touch.hit = inside || gap.distance <= radius;
    if (!touch.hit) return;
    const double signed_distance = inside ? -gap.distance : gap.distance;
    const glm::dvec3 on_mesh = transform(mesh.pose, gap.on_a);
    if (gap.distance > 0.0) touch.normal = unit_or_zero((center.pose.translation - on_mesh) / signed_distance);
    touch.depth = radius - signed_distance;
    touch.point_count = 1;
    worker.points.push_back({on_mesh, touch.depth});
}

void ContactFinder::touch_trees(const Object& a, const PosedTree& tree_a, const Object& b, const PosedTree& tree_b,
                                Worker& worker, Touch& touch) const {
    const bool sphere_a = a.kind == BoundKind::sphere, sphere_b = b.kind == BoundKind::sphere;
    if ((!sphere_a && tree_a.tree == nullptr) || (!sphere_b && tree_b.tree == nullptr)) return;
    if (sphere_b) return touch_sphere(tree_a, tree_b, b.radius, worker, touch);
    if (!sphere_a) return touch_triangles(tree_a, tree_b, worker, touch);
    touch_sphere(tree_b, tree_a, a.radius, worker, touch);
    touch.normal = -touch.normal;
}

void ContactFinder::find_contacts(const ObjectTable& table, const SpatialIndex& index, const scene::Scene& scene,
                                  Shapes& shapes, const ObjectShapes& shapes_of, ShapeToucher touch_shape,
                                  Executor& executor) {
    const auto shape_count = [&](const IdPair& pair) {
        return int{shapes_of.has(pair.first)} + int{shapes_of.has(pair.second)};
    };
    const auto is_mesh = [&](std::uint32_t object) { return shapes.mesh_tree_of(table.objects[object]) != nullptr; };
    shapes.begin();
    for (const IdPair& pair : touched_) {
        if ((!is_mesh(pair.first) && !is_mesh(pair.second)) || shape_count(pair) > 0) continue;
        for (const std::uint32_t object : {pair.first, pair.second}) shapes.prepare(table, index, scene, object);
    }
    shapes.build(scene, executor);
    workers_.resize(std::max<std::size_t>(workers_.size(), executor.concurrency()));
    for (Worker& worker : workers_) {
        worker.points.clear();
        worker.triangles.clear();
    }
    touches_.resize(touched_.size());
    executor.parallel_for(touched_.size(), kPairsATask, [&](std::size_t begin, std::size_t end, unsigned w) {
        Worker& worker = workers_[w];
        for (std::size_t i = begin; i < end; ++i) {
            const IdPair& pair = touched_[i];
            Touch& touch = touches_[i];
            touch = {};
            touch.worker = w;
            touch.first_point = static_cast<std::uint32_t>(worker.points.size());
            touch.first_triangle = static_cast<std::uint32_t>(worker.triangles.size());
            if (const int count = shape_count(pair); count > 0) {
                if (count == 2) continue;
                touch_shape(pair, worker.of_shape);
                worker.of_shape.write_to(touch, worker.points);
                touch.point_count = static_cast<std::uint32_t>(worker.points.size()) - touch.first_point;
                continue;
            }
            if (!is_mesh(pair.first) && !is_mesh(pair.second)) {
                touch_bounds(table, index, pair, worker, touch);
                continue;
            }
            const std::uint32_t first = pair.first, second = pair.second;
            const PosedTree a = shapes.posed_tree(table, index, scene, first),
                            b = shapes.posed_tree(table, index, scene, second);
            touch_trees(table.objects[first], a, table.objects[second], b, worker, touch);
        }
    });
}

bool ContactFinder::meet(const Bounded& a, const Bounded& b) const {
    if (options_.contact_margin > 0.0 && (a.has_shape || b.has_shape)) {
        // Two shapes are asked as far as the contact margin, beyond boxes and spheres.
        if (a.has_shape && b.has_shape) return true;
        if (!collide::intersects(a.box, b.box)) return false;
    }
    return bounds_meet(a.object, a.box, b.object, b.box);
}

void ContactFinder::touch_bounds(const Object& a, const Obb& box_a, const Object& b, const Obb& box_b,
                                 BoundTouch& touch) const {
    const collide::Manifold manifold = touch_of_bounds(a, box_a, b, box_b);
    touch.hit = true;
    touch.normal = manifold.normal;
    touch.depth = manifold.depth;
    touch.points.assign(manifold.points, manifold.points + manifold.count);
}

void ContactFinder::touch_trees(const Object& a, const PosedTree& tree_a, const Object& b, const PosedTree& tree_b,
                                BoundTouch& touch) {
    Touch found;
    bound_worker_.points.clear();
    bound_worker_.triangles.clear();
    touch_trees(a, tree_a, b, tree_b, bound_worker_, found);
    touch.hit = found.hit;
    touch.inside = found.inside;
    touch.normal = found.normal;
    touch.depth = found.depth;
    std::swap(touch.points, bound_worker_.points);
    std::swap(touch.triangles, bound_worker_.triangles);
}

void ContactFinder::give_back(ContactMemory& memory) {
    points_.give_back(memory.points);
    triangles_.give_back(memory.triangles);
    memory = {};
}

void ContactFinder::write_contact(const ObjectTable& table, const IdPair& pair, const Touch& touch, ContactPhase phase,
                                  std::size_t place) {
    const Worker& worker = workers_[touch.worker];
    ContactMemory& memory = memory_[place];
    points_.fit(memory.points, touch.point_count);
    triangles_.fit(memory.triangles, touch.triangle_count);
    std::copy_n(worker.points.begin() + touch.first_point, touch.point_count, memory.points.begin());
    std::copy_n(worker.triangles.begin() + touch.first_triangle, touch.triangle_count, memory.triangles.begin());
    Contact& contact = contacts_[place];
    contact.first = table.ref(pair.first);
    contact.second = table.ref(pair.second);
    contact.phase = phase;
    contact.inside = touch.inside;
    contact.normal = touch.normal;
    contact.depth = touch.depth;
    contact.points = memory.points.first(touch.point_count);
    contact.triangles = memory.triangles.first(touch.triangle_count);
}

void ContactFinder::end_contact(std::size_t place) {
    Contact ended;
    ended.first = contacts_[place].first;
    ended.second = contacts_[place].second;
    ended.phase = ContactPhase::ended;
    contacts_[place] = ended;
    give_back(memory_[place]);
}

// What began in the update before stays.
void ContactFinder::age_contacts() {
    std::size_t place = 0;
    for (const IdPair& pair : began_) {
        place = find_from(place, contacts_, pair, comes_before);
        contacts_[place].phase = ContactPhase::stayed;
    }
    began_.clear();
    std::swap(ended_, ended_before_);
    ended_.clear();
}

// Goes through the pairs that were looked at, those that are apart now, and the contacts that ended in the update
// before; all are in order.
void ContactFinder::replace_contacts(const ObjectTable& table, std::span<const IdPair> apart) {
    age_contacts();
    edits_.begin();
    added_.clear();
    std::size_t t = 0, a = 0, e = 0, place = 0;
    while (t < touched_.size() || a < apart.size() || e < ended_before_.size()) {
        IdPair pair{kNoIndex, kNoIndex};
        if (t < touched_.size()) pair = touched_[t];
        if (a < apart.size() && apart[a] < pair) pair = apart[a];
        if (e < ended_before_.size() && ended_before_[e] < pair) pair = ended_before_[e];
        place = find_from(place, contacts_, pair, comes_before);
        const bool had_ended = e < ended_before_.size() && ended_before_[e] == pair,
                   is_apart = a < apart.size() && apart[a] == pair,
                   is_touched = t < touched_.size() && touched_[t] == pair;
        const bool is_listed = place < contacts_.size() && contacts_[place].first.object.index == pair.first &&
                               contacts_[place].second.object.index == pair.second;
        const bool touched_before = is_listed && !had_ended;
        if (is_touched && touches_[t].hit) {
            if (!touched_before) began_.push_back(pair);
            if (is_listed) {
                write_contact(table, pair, touches_[t], touched_before ? ContactPhase::stayed : ContactPhase::began,
                              place);
            } else {
                edits_.add(place);
                added_.push_back(static_cast<std::uint32_t>(t));
            }
        } else if (touched_before && (is_touched || is_apart)) {
            end_contact(place);
            ended_.push_back(pair);
        } else if (had_ended) {
            edits_.remove(place);
        }
        t += is_touched;
        a += is_apart;
        e += had_ended;
    }
    edits_.apply(contacts_);
    edits_.apply(memory_);
    for (std::size_t n = 0; n < added_.size(); ++n) {
        const std::size_t at = edits_.places()[n];
        memory_[at] = {};
        write_contact(table, touched_[added_[n]], touches_[added_[n]], ContactPhase::began, at);
    }
}

Result<void> ContactFinder::update(const ObjectTable& table, SpatialIndex& index, const scene::Scene& scene,
                                   Shapes& shapes, const ObjectShapes& shapes_of, const PairChanges& changes,
                                   ShapeToucher touch_shape, Executor& executor) {
    note_colliders(table, index, scene, shapes_of, changes);
    const auto has_sphere = [&](std::uint32_t a, std::uint32_t b) {
        return table.objects[a].kind == BoundKind::sphere || table.objects[b].kind == BoundKind::sphere;
    };
    const auto meet_by_id = [&](std::uint32_t a, std::uint32_t b) {
        if (!(options_.contact_margin > 0.0) && !has_sphere(a, b)) return true;
        return meet({table.objects[a], index.box(a), shapes_of.has(a)},
                    {table.objects[b], index.box(b), shapes_of.has(b)});
    };
    const std::span<const Obb> boxes = has_own_boxes_ ? boxes_.view() : index.kept_boxes();
    Result<void> found = broadphase_.update_moved(boxes, moved_, meet_by_id, filters_.view(), executor);
    boxes_.settle();
    filters_.settle();
    note_pairs(table, changes);
    if (!options_.contacts) return found;
    const auto touched = broadphase_.tested();
    touched_.assign(touched.begin(), touched.end());
    find_contacts(table, index, scene, shapes, shapes_of, touch_shape, executor);
    replace_contacts(table, broadphase_.ended());
    return found;
}

void ContactFinder::reserve(std::size_t objects) {
    if (has_own_boxes_) boxes_.reserve_pages(objects);
    filters_.reserve_pages(objects);
    broadphase_.reserve(objects);
}

void ContactFinder::release_scratch() {
    release(moved_, began_pairs_, ended_pairs_, touched_, touches_, workers_, ended_before_, added_);
    boxes_.finish();
    filters_.finish();
    broadphase_.release_scratch();
}

void ContactFinder::stay() {
    touched_.clear();
    age_contacts();
    edits_.begin();
    std::size_t place = 0;
    for (const IdPair& pair : ended_before_) {
        place = find_from(place, contacts_, pair, comes_before);
        edits_.remove(place);
    }
    edits_.apply(contacts_);
    edits_.apply(memory_);
}

}  // namespace crofton::world
