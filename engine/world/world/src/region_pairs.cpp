// SPDX-License-Identifier: MIT
#include "region_pairs.hpp"

#include <algorithm>
#include <utility>

#include "pair_order.hpp"
#include "world_state.hpp"

namespace crofton {
namespace world {

void RegionPairs::begin() {
    next_.clear();
    next_points_.clear();
    next_triangles_.clear();
    added_.clear();
    kept_ = 0;
}

void RegionPairs::keep(const ObjectPair& old) {
    while (is_before(entries_[kept_].pair, old)) ++kept_;
    Entry entry = entries_[kept_];
    const std::size_t point = std::exchange(entry.first_point, next_points_.size()),
                      triangle = std::exchange(entry.first_triangle, next_triangles_.size());
    next_points_.insert(next_points_.end(), points_.data() + point, points_.data() + point + entry.point_count);
    next_triangles_.insert(next_triangles_.end(), triangles_.data() + triangle,
                           triangles_.data() + triangle + entry.triangle_count);
    next_.push_back(entry);
}

void RegionPairs::add(const ObjectPair& pair, const BoundTouch& found) {
    added_.push_back({pair.first.object.index, pair.second.object.index});
    Entry& entry = next_.emplace_back();
    entry = {pair,
             found.hit,
             found.inside,
             found.normal,
             found.depth,
             next_points_.size(),
             found.points.size(),
             next_triangles_.size(),
             found.triangles.size()};
    next_points_.insert(next_points_.end(), found.points.begin(), found.points.end());
    next_triangles_.insert(next_triangles_.end(), found.triangles.begin(), found.triangles.end());
}

Contact RegionPairs::contact_of(const Entry& entry, ContactPhase phase) const {
    Contact contact;
    contact.first = entry.pair.first;
    contact.second = entry.pair.second;
    contact.phase = phase;
    contact.inside = entry.inside;
    contact.normal = entry.normal;
    contact.depth = entry.depth;
    contact.points = {points_.data() + entry.first_point, entry.point_count};
    contact.triangles = {triangles_.data() + entry.first_triangle, entry.triangle_count};
    return contact;
}

void RegionPairs::list_ended() {
    ended_.clear();
    std::size_t now = 0;
    for (const Entry& old : next_) {
        while (now < entries_.size() && is_before(entries_[now].pair, old.pair)) ++now;
        const bool is_there = now < entries_.size() && !is_before(old.pair, entries_[now].pair);
        if (!is_there) ended_.push_back({old.pair.first.object.index, old.pair.second.object.index});
    }
}

const mesh::MeshTree* RegionPairs::tree_under(ObjectHandle object, const glm::dmat3& linear,
                                              FunctionRef<TriangleMesh()> triangles) {
    auto at = std::lower_bound(trees_.begin(), trees_.end(), object,
                               [](const OwnTree& own, ObjectHandle asked) { return own.object < asked; });
    if (at == trees_.end() || at->object != object) {
        auto built = Owner<mesh::MeshTree>::make();
        if (!build_under(linear, triangles(), *built)) built = {};
        at = trees_.insert(at, OwnTree{object, std::move(built)});
    }
    at->last_use = updates_;
    return at->tree.get();
}

void RegionPairs::forget_trees(const Regions& regions) {
    constexpr std::uint64_t kKept = 256;
    ++updates_;
    trees_.erase(std::remove_if(trees_.begin(), trees_.end(),
                                [&](const OwnTree& own) {
                                    return updates_ - own.last_use > kKept || !regions.contains(own.object);
                                }),
                 trees_.end());
}

void RegionPairs::end(bool finds_contacts) {
    std::swap(entries_, next_);  // next_ has those before
    std::swap(points_, next_points_);
    std::swap(triangles_, next_triangles_);
    contacts_.clear();
    list_ended();
    if (!finds_contacts) return;
    std::size_t old = 0;
    const auto end_old = [&] {
        if (next_[old].hit) {
            Contact& contact = contacts_.emplace_back();
            contact.first = next_[old].pair.first;
            contact.second = next_[old].pair.second;
            contact.phase = ContactPhase::ended;
        }
        ++old;
    };
    for (const Entry& entry : entries_) {
        while (old < next_.size() && is_before(next_[old].pair, entry.pair)) end_old();
        const bool met = old < next_.size() && !is_before(entry.pair, next_[old].pair);
        const bool same = met && are_same(next_[old].pair, entry.pair), touched = same && next_[old].hit;
        if (same && (entry.hit || !touched))
            ++old;
        else if (met)
            end_old();  // it touched, and is apart; or its indices are another's
        if (entry.hit) contacts_.push_back(contact_of(entry, touched ? ContactPhase::stayed : ContactPhase::began));
    }
    while (old < next_.size()) end_old();
}

void RegionPairs::stay() {
    contacts_.erase(std::remove_if(contacts_.begin(), contacts_.end(),
                                   [](const Contact& contact) { return contact.phase == ContactPhase::ended; }),
                    contacts_.end());
    for (Contact& contact : contacts_) contact.phase = ContactPhase::stayed;
}

void RegionPairs::merge(std::span<const ObjectPair> pairs, std::span<const Contact> contacts) {
    const auto index_before = [](const auto& a, const auto& b) {
        return is_before({a.first, a.second}, {b.first, b.second});
    };
    all_pairs_.assign(pairs.begin(), pairs.end());
    for (const Entry& entry : entries_) all_pairs_.push_back(entry.pair);
    const auto middle = static_cast<std::ptrdiff_t>(pairs.size());
    std::inplace_merge(all_pairs_.begin(), all_pairs_.begin() + middle, all_pairs_.end(), index_before);
    all_contacts_.resize(contacts.size() + contacts_.size());
    std::merge(contacts.begin(), contacts.end(), contacts_.begin(), contacts_.end(), all_contacts_.begin(),
               index_before);
}

}  // namespace world

// The World's own objects whose pairs with regions may have changed, ascending: those of the finder's update, and
// those near regions that have come or whose objects were hidden or shown.
void World::State::list_changed_near_regions() {
    Vector<std::uint32_t>& changed = region_pairs.changed;
    changed.assign(finder.moved().begin(), finder.moved().end());
    if (region_pairs.lost)
        for (std::uint32_t id = 0; id < table.objects.size(); ++id) changed.push_back(id);
    for (const std::uint32_t slot : regions.changed())
        visit_bounded_near(aabb_of(regions.at_slot(slot).bounds), 2.0 * options.contact_margin, ~0u,
                           [&](std::uint32_t id) {
                               changed.push_back(id);
                               return 2.0 * options.contact_margin;
                           });
    std::sort(changed.begin(), changed.end());
    changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
}

// The box in which a region's object is looked for by shapes that come within the margin, as
// ObjectShapes::collider_box.
Obb World::State::region_collider_box(std::uint32_t other, const Obb& box) const {
    if (options.contact_margin == 0.0 || !regions.has_shape(other)) return box;
    const auto pose = regions.pose(other);
    return pose ? world::box_with_margin(box, regions.shape(other), *pose, options.contact_margin / 2.0) : box;
}

void World::State::add_region_pairs_of(std::uint32_t id) {
    const world::Object& object = table.objects[id];
    if (!object.alive || object.collides_with == 0 || !index.is_placed(id) || object_shapes.is_unbounded(id)) return;
    const Obb& box = index.box(id);
    const double margin = options.contact_margin;
    const Obb collider = object_shapes.collider_box(id, object, box, scene, margin / 2.0);
    const auto meet = [&](std::uint32_t other) {
        const world::Object of_region = regions.object(other);
        if ((index.layers(id) & of_region.collides_with) == 0) return false;
        const Obb other_box = regions.box(other);
        if (!collide::intersects(collider, region_collider_box(other, other_box))) return false;
        return finder.meet({object, box, object_shapes.has(id)}, {of_region, other_box, regions.has_shape(other)});
    };
    Vector<std::uint32_t>& met = region_pairs_met;
    met.clear();
    regions.visit_near(aabb_of(collider), margin, object.collides_with, [&](std::uint32_t other) {
        if (meet(other)) met.push_back(other);
        return margin;
    });
    std::sort(met.begin(), met.end());
    for (const std::uint32_t other : met) {
        region_pairs.touch.clear();
        if (options.contacts && !(object_shapes.has(id) && regions.has_shape(other)))
            touch_in_region(id, other, region_pairs.touch);
        region_pairs.add({table.ref(id), regions.ref(other)}, region_pairs.touch);
    }
}

void World::State::touch_in_region(std::uint32_t id, std::uint32_t other, world::BoundTouch& touch) {
    if (object_shapes.has(id) || regions.has_shape(other)) {
        touch_shape({id, other}, region_pairs.shape_touch);
        return region_pairs.shape_touch.write_to(touch, touch.points);
    }
    const world::Object& object = table.objects[id];
    const world::Object of_region = regions.object(other);
    const Obb other_box = regions.box(other);
    const world::PlacedMesh placed = regions.mesh(other);
    if (shapes.mesh_tree_of(object) == nullptr && placed.mesh == nullptr)
        return finder.touch_bounds(object, index.box(id), of_region, other_box, touch);
    shapes.begin();
    shapes.prepare(table, index, scene, id);
    shapes.build(scene, serial_executor());
    const world::PosedTree mesh = shapes.posed_tree(table, index, scene, id);
    const ObjectHandle handle = regions.ref(other).object;
    world::PosedTree other_mesh{nullptr, {glm::dmat3(1.0), other_box.center}};
    if (placed.mesh != nullptr) {
        other_mesh = {&placed.mesh->tree, {*placed.linear, placed.translation}};
        if (!world::is_rotation(*placed.linear)) {
            other_mesh.tree = region_pairs.tree_under(handle, *placed.linear, [&] { return regions.triangles(other); });
            other_mesh.pose.rotation = glm::dmat3(1.0);
        }
    } else if (of_region.kind != BoundKind::sphere) {
        const glm::dmat3 axes(other_box.axes);
        if (world::is_rotation(axes)) other_mesh.pose.rotation = axes;
        other_mesh.tree = region_pairs.tree_under(handle, world::is_rotation(axes) ? glm::dmat3(1.0) : axes,
                                                  [&] { return world::box_mesh(other_box.half_extents); });
        other_mesh.is_solid = true;
    }
    finder.touch_trees(object, mesh, of_region, other_mesh, touch);
}

Result<void> World::State::update_region_pairs(Result<void> others) {
    if (regions.is_empty() && !region_pairs.is_used()) {
        region_pairs.forget_changes();
        return others;
    }
    if (!others) {
        region_pairs.lost = true;
        region_pairs.begin();
        region_pairs.end(options.contacts);
        return others;
    }
    region_pairs.forget_trees(regions);
    list_changed_near_regions();
    const Vector<std::uint32_t>& changed = region_pairs.changed;
    region_pairs.begin();
    std::size_t c = 0;
    for (const world::RegionPairs::Entry& entry : region_pairs.entries()) {
        const std::uint32_t id = entry.pair.first.object.index;
        for (; c < changed.size() && changed[c] < id; ++c) add_region_pairs_of(changed[c]);
        const bool is_changed = c < changed.size() && changed[c] == id;
        if (!is_changed && regions.contains(entry.pair.second.object)) region_pairs.keep(entry.pair);
    }
    for (; c < changed.size(); ++c) add_region_pairs_of(changed[c]);
    const std::size_t count = region_pairs.added_count();
    region_pairs.lost = count > options.max_pairs;
    if (region_pairs.lost) region_pairs.begin();
    region_pairs.end(options.contacts);
    if (!region_pairs.lost) return {};
    return fail(ErrorCode::budget_exceeded, kNoItem,
                {"world: ", count, " pairs with objects of regions are more than max_pairs"});
}

// After all pairs were found, and contacts of what are not two shapes.
void World::State::update_shape_contacts(Executor& executor) {
    const world::ShapeContacts::Surroundings around{object_shapes, table,   index,
                                                    scene,         regions, options.contact_margin};
    if (ground.is_or_was_used())
        return shape_contacts.update_all(region_pairs.is_used() ? region_pairs.pairs() : own_pairs(), around, executor);
    const std::span<const IdPair> added = region_pairs.added(), ended = region_pairs.ended();
    if (added.empty() && ended.empty())
        return shape_contacts.update({finder.touched(), finder.ended()}, around, executor);
    const auto merge = [](std::span<const IdPair> a, std::span<const IdPair> b, Vector<IdPair>& all) {
        all.resize(a.size() + b.size());
        std::merge(a.begin(), a.end(), b.begin(), b.end(), all.begin());
    };
    merge(finder.touched(), added, region_pairs.all_added);
    merge(finder.ended(), ended, region_pairs.all_ended);
    shape_contacts.update({region_pairs.all_added, region_pairs.all_ended}, around, executor);
}

}  // namespace crofton
