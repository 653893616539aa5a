// SPDX-License-Identifier: MIT
#include "body_contacts.hpp"

#include <algorithm>

#include "pair_order.hpp"

namespace crofton::world {

// The pairs of two bodies, each with its state in the update before. Both lists are in order.
void BodyContacts::list(std::span<const ObjectPair> pairs, const ObjectBodies& bodies) {
    touches_.clear();
    std::size_t old = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        if (!bodies.has(pairs[i].first.object.index) || !bodies.has(pairs[i].second.object.index)) continue;
        while (old < states_.size() && is_before(states_[old].pair, pairs[i])) ++old;
        Touch& touch = touches_.emplace_back();
        touch.pair = static_cast<std::uint32_t>(i);
        if (old < states_.size() && are_same(states_[old].pair, pairs[i]))
            touch.before = static_cast<std::uint32_t>(old);
    }
}

void BodyContacts::list_neighbors(std::span<const ObjectPair> pairs, const SpatialIndex& index, double margin) {
    neighbors_.clear();
    for (const Touch& touch : touches_)
        neighbors_.add({pairs[touch.pair].first.object.index, pairs[touch.pair].second.object.index});
    neighbors_.list(moved_.size(), index, margin);
}

bool BodyContacts::have_moved(const Neighbors& neighbors) const {
    for (const Vector<std::uint32_t>& objects : neighbors.objects)
        for (const std::uint32_t object : objects)
            if (moved_[object] != 0) return true;
    return false;
}

void BodyContacts::place_neighbors(const ObjectBodies& bodies, const ObjectTable& table, const SpatialIndex& index,
                                   const scene::Scene& scene, Worker& worker) const {
    worker.poses.clear();
    worker.poses.reserve(worker.neighbors.objects[0].size() + worker.neighbors.objects[1].size());
    for (int side = 0; side < 2; ++side) {
        worker.placed[side].clear();
        for (const std::uint32_t object : worker.neighbors.objects[side])
            if (const auto pose = bodies.pose_of(object, table.objects[object], index.box(object), scene))
                worker.placed[side].push_back({bodies.body(object), worker.poses.emplace_back(*pose)});
    }
}

void BodyContacts::note_moved(const SpatialIndex& index) {
    moved_.assign(index.size(), 0);
    for (const auto items : {index.moved_items(), std::span<const std::uint32_t>(changed_)})
        for (const std::uint32_t item : items)
            if (item < moved_.size()) moved_[item] = 1;
    changed_.clear();
}

void BodyContacts::update(std::span<const ObjectPair> pairs, const ObjectBodies& bodies, const ObjectTable& table,
                          const SpatialIndex& index, const scene::Scene& scene, double margin, Executor& executor) {
    computed_ = 0;
    if (!has_work(bodies)) {
        changed_.clear();
        return contacts_.clear();
    }
    note_moved(index);
    list(pairs, bodies);
    list_neighbors(pairs, index, margin);
    workers_.resize(std::max<std::size_t>(workers_.size(), executor.concurrency()));
    for (Worker& worker : workers_) worker.points.clear();
    executor.parallel_for(touches_.size(), kPairsATask, [&](std::size_t begin, std::size_t end, unsigned w) {
        Worker& worker = workers_[w];
        for (std::size_t i = begin; i < end; ++i) {
            Touch& touch = touches_[i];
            const std::uint32_t a = pairs[touch.pair].first.object.index, b = pairs[touch.pair].second.object.index;
            const PairState* const before = touch.before != kNoIndex ? &states_[touch.before] : nullptr;
            touch.worker = w;
            touch.first_point = static_cast<std::uint32_t>(worker.points.size());
            worker.pair_points.clear();
            if (before != nullptr) {
                touch.cache = before->cache;
                const auto first = points_.begin() + before->first_point;
                worker.pair_points.assign(first, first + before->point_count);
            }
            neighbors_.find({a, b}, worker.neighbors);
            touch.neighbors = worker.neighbors.name;
            const bool same = before != nullptr && before->neighbors == touch.neighbors;
            if (same && moved_[a] == 0 && moved_[b] == 0 && !have_moved(worker.neighbors)) {
                for (convex::TrackedPoint& point : worker.pair_points) point.began = false;
            } else {
                touch.computed = true;
                const auto pose_a = bodies.pose_of(a, table.objects[a], index.box(a), scene),
                           pose_b = bodies.pose_of(b, table.objects[b], index.box(b), scene);
                if (!pose_a || !pose_b) continue;
                place_neighbors(bodies, table, index, scene, worker);
                convex::contact_manifolds({bodies.body(a), *pose_a}, {bodies.body(b), *pose_b},
                                          {worker.placed[0], worker.placed[1]}, {.margin = margin}, worker.found,
                                          &touch.cache);
                convex::track(worker.found.all(), worker.pair_points);
            }
            touch.point_count = static_cast<std::uint32_t>(worker.pair_points.size());
            worker.points.insert(worker.points.end(), worker.pair_points.begin(), worker.pair_points.end());
        }
    });
    gather(pairs);
}

void BodyContacts::add(const ObjectPair& pair, ContactPhase phase, std::uint32_t first_point, std::uint32_t count) {
    contacts_.push_back({pair.first, pair.second, phase, next_points_.data() + first_point, count});
}

// In the order of the pairs, whoever computed them. A state is kept while the pair's boxes meet, for its cache.
void BodyContacts::gather(std::span<const ObjectPair> pairs) {
    contacts_.clear();
    next_states_.clear();
    next_points_.clear();
    std::size_t count = 0;
    for (const Touch& touch : touches_) count += touch.point_count;
    if (count > next_points_.capacity()) next_points_.reserve(count + count / 2);
    std::size_t old = 0;
    const auto end_until = [&](std::size_t state) {
        for (; old < state; ++old)
            if (states_[old].point_count > 0) add(states_[old].pair, ContactPhase::ended, 0, 0);
    };
    for (const Touch& touch : touches_) {
        computed_ += touch.computed ? 1 : 0;
        const ObjectPair& pair = pairs[touch.pair];
        while (old < states_.size() && (is_before(states_[old].pair, pair) ||
                                        (touch.before == kNoIndex && !is_before(pair, states_[old].pair))))
            end_until(old + 1);
        const auto first = static_cast<std::uint32_t>(next_points_.size());
        const auto from = workers_[touch.worker].points.begin() + touch.first_point;
        next_points_.insert(next_points_.end(), from, from + touch.point_count);
        next_states_.push_back({pair, touch.cache, touch.neighbors, first, touch.point_count});
        const bool touched = touch.before != kNoIndex && states_[touch.before].point_count > 0;
        if (touch.point_count > 0)
            add(pair, touched ? ContactPhase::stayed : ContactPhase::began, first, touch.point_count);
        else if (touched)
            add(pair, ContactPhase::ended, 0, 0);
        if (touch.before != kNoIndex) old = touch.before + std::size_t{1};
    }
    end_until(states_.size());
    std::swap(states_, next_states_);
    std::swap(points_, next_points_);
}

void BodyContacts::stay() {
    computed_ = 0;
    std::size_t kept = 0;
    for (BodyContact& contact : contacts_) {
        if (contact.phase == ContactPhase::ended) continue;
        contact.phase = ContactPhase::stayed;
        for (std::uint32_t i = 0; i < contact.point_count; ++i) contact.points[i].began = false;
        contacts_[kept++] = contact;
    }
    contacts_.resize(kept);
}

}  // namespace crofton::world
