// SPDX-License-Identifier: MIT
#include "contact_finder.hpp"
#include <crofton/mesh/mesh_query.hpp>

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <utility>

#include "pair_order.hpp"

namespace crofton::world {
namespace {

// Of two whose boxes meet.
bool bounds_meet(const Object& a, const Obb& box_a, const Object& b, const Obb& box_b) {
    const bool ball_a = a.kind == BoundKind::ball, ball_b = b.kind == BoundKind::ball;
    if (ball_a && ball_b) return glm::length(box_a.center - box_b.center) <= a.radius + b.radius;
    if (ball_a) return collide::intersects(box_b, ball_of(a, box_a));
    if (ball_b) return collide::intersects(box_a, ball_of(b, box_b));
    return true;
}

// Of two that meet.
collide::Manifold touch_of_bounds(const Object& a, const Obb& box_a, const Object& b, const Obb& box_b) {
    const bool ball_a = a.kind == BoundKind::ball, ball_b = b.kind == BoundKind::ball;
    if (ball_a && ball_b) return collide::contact_manifold(ball_of(a, box_a), ball_of(b, box_b));
    if (ball_b) return collide::contact_manifold(box_a, ball_of(b, box_b));
    if (!ball_a) return collide::contact_manifold(box_a, box_b);
    collide::Manifold manifold = collide::contact_manifold(box_b, ball_of(a, box_a));
    manifold.normal = -manifold.normal;
    return manifold;
}

// Appends part of a list, for which there is room, and returns where it is.
template <class T>
std::span<const T> append(const Vector<T>& from, std::uint32_t first, std::uint32_t count, Vector<T>& to) {
    const std::size_t begin = to.size();
    to.insert(to.end(), from.begin() + first, from.begin() + first + count);
    return {to.data() + begin, count};
}

glm::dvec3 unit_or_zero(const glm::dvec3& v) {
    const double length = glm::length(v);
    return length > 0.0 ? v / length : v;
}

// Axes of boxes, and so poses, are orthonormal as far as floats are: a direction they turn needs its length again.
glm::dvec3 turned(const RigidTransform& pose, const glm::dvec3& direction) {
    return unit_or_zero(pose.rotation * direction);
}

}  // namespace

ContactFinder::ContactFinder(const WorldOptions& options)
    : options_(options), broadphase_({.exact_boxes = true, .max_pairs = options.max_pairs}) {}

void ContactFinder::list_colliders(const ObjectTable& table, const SpatialIndex& index) {
    colliders_.clear();
    boxes_.clear();
    filters_.clear();
    collider_of_.assign(table.objects.size(), kNoIndex);
    for (std::uint32_t i = 0; i < table.objects.size(); ++i) {
        const Object& object = table.objects[i];
        if (!object.alive || object.collides_with == 0 || !index.is_placed(i)) continue;
        const std::uint32_t layers = index.layers(i);
        if (layers == 0) continue;
        collider_of_[i] = static_cast<std::uint32_t>(colliders_.size());
        colliders_.push_back(i);
        boxes_.push_back(index.box(i));
        filters_.push_back({layers, object.collides_with});
    }
}

void ContactFinder::move_colliders(const SpatialIndex& index) {
    moved_.clear();
    for (const ItemId item : index.moved_items()) {
        const std::uint32_t collider = item < collider_of_.size() ? collider_of_[item] : kNoIndex;
        if (collider == kNoIndex) continue;
        boxes_[collider] = index.box(item);
        moved_.push_back(collider);
    }
}

// Colliders ascend, so that pairs of objects are in the order of pairs of boxes.
void ContactFinder::list_pairs(const ObjectTable& table) {
    pairs_.clear();
    for (const IdPair& pair : broadphase_.pairs()) {
        const std::uint32_t first = colliders_[pair.first], second = colliders_[pair.second];
        if (!bounds_meet(table.objects[first], boxes_[pair.first], table.objects[second], boxes_[pair.second]))
            continue;
        pairs_.push_back({table.ref(first), table.ref(second)});
    }
}

void ContactFinder::touch_bounds(const ObjectTable& table, const SpatialIndex& index, const ObjectPair& pair,
                                 Worker& worker, Touch& touch) const {
    const std::uint32_t i = pair.first.object.index, j = pair.second.object.index;
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
    if (!touch.hit && options_.containment) {
        touch.inside = mesh::containment_of_disjoint(*a.tree, *b.tree, b_to_a);
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
    const mesh::MeshDepth way_out = mesh::penetration(*a.tree, *b.tree, b_to_a, worker.found);
    touch.depth = way_out.depth;
    touch.normal = turned(a.pose, way_out.direction);
}

// The normal points from the mesh to the ball.
void ContactFinder::touch_ball(const PosedTree& mesh, const PosedTree& center, double radius, Worker& worker,
                               Touch& touch) const {
    const RigidTransform to_mesh = relative(mesh.pose, center.pose);
    const mesh::MeshDistance gap = mesh::distance(*mesh.tree, *center.tree, to_mesh);
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

void ContactFinder::find_contacts(const ObjectTable& table, const SpatialIndex& index, const scene::Scene& scene,
                                  Bodies& bodies, const BodyContacts& bodies_of, Executor& executor) {
    const auto have_bodies = [&](const ObjectPair& pair) {
        return bodies_of.has(pair.first.object.index) && bodies_of.has(pair.second.object.index);
    };
    const auto is_mesh = [&](const ObjectRef& object) {
        return bodies.mesh_tree_of(table.objects[object.object.index]) != nullptr;
    };
    bodies.begin();
    for (const ObjectPair& pair : pairs_) {
        if ((!is_mesh(pair.first) && !is_mesh(pair.second)) || have_bodies(pair)) continue;
        for (const ObjectRef& object : {pair.first, pair.second})
            bodies.prepare(table, index, scene, object.object.index);
    }
    bodies.build(scene, executor);
    workers_.resize(std::max<std::size_t>(workers_.size(), executor.concurrency()));
    for (Worker& worker : workers_) {
        worker.points.clear();
        worker.triangles.clear();
    }
    touches_.resize(pairs_.size());
    executor.parallel_for(pairs_.size(), kPairsATask, [&](std::size_t begin, std::size_t end, unsigned w) {
        Worker& worker = workers_[w];
        for (std::size_t i = begin; i < end; ++i) {
            const ObjectPair& pair = pairs_[i];
            Touch& touch = touches_[i];
            touch = {};
            touch.worker = w;
            touch.first_point = static_cast<std::uint32_t>(worker.points.size());
            touch.first_triangle = static_cast<std::uint32_t>(worker.triangles.size());
            if (have_bodies(pair)) continue;
            if (!is_mesh(pair.first) && !is_mesh(pair.second)) {
                touch_bounds(table, index, pair, worker, touch);
                continue;
            }
            const std::uint32_t first = pair.first.object.index, second = pair.second.object.index;
            const PosedTree a = bodies.posed_tree(table, index, scene, first),
                            b = bodies.posed_tree(table, index, scene, second);
            if (!a.tree || !b.tree) continue;
            if (table.objects[second].kind == BoundKind::ball) {
                touch_ball(a, b, table.objects[second].radius, worker, touch);
            } else if (table.objects[first].kind == BoundKind::ball) {
                touch_ball(b, a, table.objects[first].radius, worker, touch);
                touch.normal = -touch.normal;
            } else {
                touch_triangles(a, b, worker, touch);
            }
        }
    });
}

void ContactFinder::add_contact(const ObjectPair& pair, const Touch& touch, ContactPhase phase) {
    Contact& contact = contacts_.emplace_back();
    contact.first = pair.first;
    contact.second = pair.second;
    contact.phase = phase;
    if (phase == ContactPhase::ended) return;
    contact.inside = touch.inside;
    contact.normal = touch.normal;
    contact.depth = touch.depth;
    const Worker& worker = workers_[touch.worker];
    contact.points = append(worker.points, touch.first_point, touch.point_count, points_);
    contact.triangles = append(worker.triangles, touch.first_triangle, touch.triangle_count, triangles_);
}

// In the order of the pairs, whoever tested them.
void ContactFinder::gather() {
    before_.clear();
    for (const Contact& contact : contacts_)
        if (contact.phase != ContactPhase::ended) before_.push_back({contact.first, contact.second});
    contacts_.clear();
    points_.clear();
    triangles_.clear();
    std::size_t point_count = 0, triangle_count = 0;
    for (const Worker& worker : workers_) {
        point_count += worker.points.size();
        triangle_count += worker.triangles.size();
    }
    if (point_count > points_.capacity()) points_.reserve(point_count + point_count / 2);
    if (triangle_count > triangles_.capacity()) triangles_.reserve(triangle_count + triangle_count / 2);
    std::size_t old = 0;
    for (std::size_t i = 0; i < touches_.size(); ++i) {
        if (!touches_[i].hit) continue;
        for (; old < before_.size() && is_before(before_[old], pairs_[i]); ++old)
            add_contact(before_[old], {}, ContactPhase::ended);
        const bool met = old < before_.size() && !is_before(pairs_[i], before_[old]);
        const bool stayed = met && are_same(before_[old], pairs_[i]);
        if (met && !stayed) add_contact(before_[old], {}, ContactPhase::ended);
        add_contact(pairs_[i], touches_[i], stayed ? ContactPhase::stayed : ContactPhase::began);
        old += met;
    }
    for (; old < before_.size(); ++old) add_contact(before_[old], {}, ContactPhase::ended);
}

Result<void> ContactFinder::update(const ObjectTable& table, const SpatialIndex& index, const scene::Scene& scene,
                                   Bodies& bodies, const BodyContacts& bodies_of, bool moved_only, Executor& executor) {
    Result<void> found;
    if (moved_only) {
        move_colliders(index);
        found = broadphase_.update_moved(boxes_, moved_, filters_, executor);
    } else {
        list_colliders(table, index);
        found = broadphase_.update(boxes_, filters_, executor);
    }
    list_pairs(table);
    if (options_.contacts) {
        find_contacts(table, index, scene, bodies, bodies_of, executor);
        gather();
    }
    return found;
}

void ContactFinder::stay() {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        if (contacts_[i].phase == ContactPhase::ended) continue;
        contacts_[kept] = contacts_[i];
        contacts_[kept].phase = ContactPhase::stayed;
        ++kept;
    }
    contacts_.resize(kept);
}

}  // namespace crofton::world
