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

void RegionPairs::end(bool finds_contacts) {
    std::swap(entries_, next_);  // next_ has those before
    std::swap(points_, next_points_);
    std::swap(triangles_, next_triangles_);
    contacts_.clear();
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
    if (pair_changes.all_contacts || region_pairs.lost)
        for (std::uint32_t id = 0; id < table.objects.size(); ++id) changed.push_back(id);
    for (const std::uint32_t slot : regions.changed())
        visit_bounded_near(aabb_of(regions.at_slot(slot).bounds), 0.0, ~0u, [&](std::uint32_t id) {
            changed.push_back(id);
            return 0.0;
        });
    std::sort(changed.begin(), changed.end());
    changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
}

void World::State::add_region_pairs_of(std::uint32_t id) {
    const world::Object& object = table.objects[id];
    if (!object.alive || object.collides_with == 0 || !index.is_placed(id) || object_shapes.is_unbounded(id)) return;
    const Obb& box = index.box(id);
    Vector<std::uint32_t>& met = region_pairs_met;
    met.clear();
    regions.visit_near(aabb_of(box), 0.0, object.collides_with, [&](std::uint32_t other) {
        const world::Object of_region = regions.object(other);
        const Obb other_box = regions.box(other);
        if ((index.layers(id) & of_region.collides_with) != 0 && collide::intersects(box, other_box) &&
            world::ContactFinder::meet(object, box, of_region, other_box))
            met.push_back(other);
        return 0.0;
    });
    std::sort(met.begin(), met.end());
    if (met.empty()) return;
    world::PosedTree mesh;
    if (options.contacts && shapes.mesh_tree_of(object) != nullptr) {
        shapes.begin();
        shapes.prepare(table, index, scene, id);
        shapes.build(scene, serial_executor());
        mesh = shapes.posed_tree(table, index, scene, id);
    }
    for (const std::uint32_t other : met) {
        world::BoundTouch& touch = region_pairs.touch;
        touch.clear();
        if (options.contacts) {
            const world::Object of_region = regions.object(other);
            const Obb other_box = regions.box(other);
            if (shapes.mesh_tree_of(object) == nullptr)
                finder.touch_bounds(object, box, of_region, other_box, touch);
            else if (mesh.tree != nullptr)
                finder.touch_bound(mesh, of_region, other_box, shapes, scene, touch);
        }
        region_pairs.add({table.ref(id), regions.ref(other)}, touch);
    }
}

Result<void> World::State::update_region_pairs(Result<void> others) {
    if (regions.is_empty() && !region_pairs.is_used()) return others;
    if (!others) {
        region_pairs.lost = true;
        region_pairs.begin();
        region_pairs.end(options.contacts);
        return others;
    }
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

}  // namespace crofton
