// SPDX-License-Identifier: MIT
#include "shape_contacts.hpp"

#include <algorithm>

#include "pair_order.hpp"

namespace crofton::world {
namespace {

// Where more objects move than one in so many pairs has, all pairs are looked at.
constexpr std::size_t kManyMovers = 8;

IdPair ids_of(const ObjectRef& first, const ObjectRef& second) {
    return {first.object.index, second.object.index};
}

constexpr auto is_state_before = [](const auto& state, const IdPair& pair) {
    return ids_of(state.pair.first, state.pair.second) < pair;
};
constexpr auto is_contact_before = [](const Contact& contact, const IdPair& pair) {
    return ids_of(contact.first, contact.second) < pair;
};

bool is_at(const Vector<Contact>& contacts, std::size_t place, const IdPair& pair) {
    return place < contacts.size() && ids_of(contacts[place].first, contacts[place].second) == pair;
}

// Whether shapes overlap, or are apart, by more than flush ones may. Others have no way out to look for.
bool is_deep(const convex::Manifolds& found, const convex::Shape& a, const convex::Shape& b) {
    const double flush = 0x1p-22 * (a.core_radius() + a.radius() + b.core_radius() + b.radius());
    return std::any_of(found.all().begin(), found.all().end(),
                       [&](const convex::Manifold& m) { return std::abs(m.depth) > flush; });
}

}  // namespace

void ShapeContacts::note_moved(const Surroundings& around) {
    moved_.resize(std::max(moved_.size(), around.index.size()), 0);
    movers_.clear();
    for (const auto items : {around.index.moved_items(), std::span<const std::uint32_t>(changed_)})
        for (const std::uint32_t item : items)
            if (item < around.index.size() && moved_[item] == 0) {
                moved_[item] = 1;
                movers_.push_back(item);
            }
    changed_.clear();
}

// Another user's data.
void ShapeContacts::rename(PairState& state, const ObjectPair& pair) {
    if (state.pair.first.user == pair.first.user && state.pair.second.user == pair.second.user) return;
    state.pair = pair;
    const IdPair ids = ids_of(pair.first, pair.second);
    for (std::size_t at = find_from(0, contacts_, ids, is_contact_before); is_at(contacts_, at, ids); ++at)
        contacts_[at].first = pair.first, contacts_[at].second = pair.second;
}

// The pair is there no more.
void ShapeContacts::drop(const PairState& state) {
    const IdPair ids = ids_of(state.pair.first, state.pair.second);
    if (state.point_count > 0) dropped_.push_back(ids);
    points_.give_back(state.points);
}

// The states of pairs of two shapes that have come or gone.
void ShapeContacts::note_pairs(const ChangedPairs& pairs, const Surroundings& around) {
    came_.clear();
    joined_.clear();
    parted_.clear();
    dropped_.clear();
    edits_.begin();
    std::size_t t = 0, e = 0, place = 0;
    while (t < pairs.there.size() || e < pairs.ended.size()) {
        const bool is_there = t < pairs.there.size() && (e == pairs.ended.size() || !(pairs.ended[e] < pairs.there[t]));
        const IdPair ids = is_there ? pairs.there[t++] : pairs.ended[e++];
        const bool of_shapes = is_there && around.has_shape(ids.first) && around.has_shape(ids.second);
        place = find_from(place, states_, ids, is_state_before);
        const bool was_there =
            place < states_.size() && ids_of(states_[place].pair.first, states_[place].pair.second) == ids;
        if (!of_shapes && !was_there) continue;
        const ObjectPair pair{ref(around.table.names, ids.first), ref(around.table.names, ids.second)};
        if (was_there && of_shapes && are_same(states_[place].pair, pair)) {
            rename(states_[place], pair);
            continue;
        }
        if (of_shapes) {
            edits_.add(place);
            came_.push_back(pair);
            joined_.push_back({ids.first, ids.second});
        }
        if (was_there) {
            drop(states_[place]);
            edits_.remove(place);
            parted_.push_back({ids.first, ids.second});
        }
    }
    edits_.apply(states_);
    for (std::size_t n = 0; n < came_.size(); ++n) {
        PairState& state = states_[edits_.places()[n]];
        state = {};
        state.pair = came_[n];
    }
    for (const PairNeighbors::Pair& pair : parted_) neighbors_.remove(pair);
    for (const PairNeighbors::Pair& pair : joined_) neighbors_.add(pair);
    for (const PairNeighbors::Pair& pair : joined_)
        for (const std::uint32_t object : {pair.first, pair.second}) place_object(object, around);
    // Those that meet no shape have nothing to do with pairs.
    movers_.erase(std::remove_if(movers_.begin(), movers_.end(),
                                 [&](std::uint32_t object) {
                                     const bool alone = neighbors_.partners_of(object).empty();
                                     if (alone) moved_[object] = 0;
                                     return alone;
                                 }),
                  movers_.end());
    for (const std::uint32_t object : movers_) place_object(object, around);
}

void ShapeContacts::place_object(std::uint32_t object, const Surroundings& around) {
    neighbors_.place(object, around.box(object), around.margin, around.pose(object));
}

// Pairs that may have to be computed; touch() tells.
void ShapeContacts::list_candidates() {
    touches_.clear();
    const auto add = [&](std::size_t state) { touches_.emplace_back().state = static_cast<std::uint32_t>(state); };
    const auto add_all = [&] {
        for (std::size_t i = 0; i < states_.size(); ++i) add(i);
    };
    if ((movers_.size() + joined_.size() + parted_.size()) * kManyMovers > states_.size()) return add_all();
    candidates_.clear();
    const auto add_pair = [&](std::uint32_t a, std::uint32_t b) {
        candidates_.push_back({std::min(a, b), std::max(a, b)});
    };
    for (const std::uint32_t object : movers_) {
        for (const std::uint32_t partner : neighbors_.partners_of(object)) add_pair(object, partner);
        neighbors_.visit_pairs_beside(object, add_pair);
        if (candidates_.size() > states_.size()) return add_all();  // where many meet many
    }
    for (const auto* const pairs : {&joined_, &parted_})
        for (const PairNeighbors::Pair& pair : *pairs) {
            if (pairs == &joined_) add_pair(pair.first, pair.second);
            neighbors_.visit_pairs_at(pair.first, pair.second, add_pair);
            neighbors_.visit_pairs_at(pair.second, pair.first, add_pair);
        }
    std::sort(candidates_.begin(), candidates_.end());
    candidates_.erase(std::unique(candidates_.begin(), candidates_.end()), candidates_.end());
    std::size_t place = 0;
    for (const IdPair& pair : candidates_) add(place = find_from(place, states_, pair, is_state_before));
}

bool ShapeContacts::have_moved(const Neighbors& neighbors) const {
    for (const Vector<std::uint32_t>& objects : neighbors.objects)
        for (const std::uint32_t object : objects)
            if (has_moved(object)) return true;
    return false;
}

void ShapeContacts::place_neighbors(const Surroundings& around, Worker& worker) const {
    for (int side = 0; side < 2; ++side) {
        worker.placed[side].clear();
        worker.numbers[side].clear();
        for (const std::uint32_t object : worker.neighbors.objects[side])
            if (const auto& pose = neighbors_.pose_of(object)) {
                worker.placed[side].push_back({around.shape(object), *pose});
                worker.numbers[side].push_back(object);
            }
    }
}

// The contacts of two convex shapes that rest flush are the same whatever lies beside them.
void ShapeContacts::compute(Touch& touch, const Surroundings& around, Worker& worker) const {
    const PairState& state = states_[touch.state];
    const std::uint32_t a = state.pair.first.object.index, b = state.pair.second.object.index;
    touch.computed = true;
    const auto &pose_a = neighbors_.pose_of(a), &pose_b = neighbors_.pose_of(b);
    if (!pose_a || !pose_b) return worker.pair_points.clear();
    const convex::ShapeAtPose placed_a{around.shape(a), *pose_a}, placed_b{around.shape(b), *pose_b};
    const convex::ManifoldOptions options{.margin = around.margin};
    const bool convex = placed_a.shape.is_convex() && placed_b.shape.is_convex();
    if (convex) {
        convex::contact_manifolds(placed_a, placed_b, options, worker.found, &touch.cache);
        touch.asks_neighbors = is_deep(worker.found, placed_a.shape, placed_b.shape);
        if (!touch.asks_neighbors) return void(convex::track(worker.found.all(), worker.pair_points));
    }
    touch.asks_neighbors = true;
    neighbors_.find({a, b}, worker.neighbors);
    touch.neighbors = worker.neighbors.name;
    place_neighbors(around, worker);
    const convex::Beside beside{worker.placed[0], worker.placed[1]};
    if (convex)
        convex::push_out_of_union(placed_a, placed_b, {beside, a, b, worker.numbers[0], worker.numbers[1]}, options,
                                  worker.found, worker.memory, touch.cache);
    else
        convex::contact_manifolds(placed_a, placed_b, beside, options, worker.found, &touch.cache);
    convex::track(worker.found.all(), worker.pair_points);
}

void ShapeContacts::touch(Touch& touch, const Surroundings& around, Worker& worker) const {
    const PairState& state = states_[touch.state];
    const std::uint32_t a = state.pair.first.object.index, b = state.pair.second.object.index;
    if (!state.is_new && !has_moved(a) && !has_moved(b)) {
        if (!state.asks_neighbors) return;
        neighbors_.find({a, b}, worker.neighbors);
        if (worker.neighbors.name == state.neighbors && !have_moved(worker.neighbors)) return;
    }
    touch.cache = state.cache;
    worker.pair_points.assign(state.points.begin(), state.points.begin() + state.point_count);
    compute(touch, around, worker);
    touch.first_point = static_cast<std::uint32_t>(worker.points.size());
    touch.point_count = static_cast<std::uint32_t>(worker.pair_points.size());
    worker.points.insert(worker.points.end(), worker.pair_points.begin(), worker.pair_points.end());
}

void ShapeContacts::update(const ChangedPairs& pairs, const Surroundings& around, Executor& executor) {
    computed_ = 0;
    if (!has_work(around.shapes)) {
        for (Vector<IdPair>* const list : {&began_, &ended_, &fresh_}) list->clear();
        changed_.clear();
        return contacts_.clear();
    }
    note_moved(around);
    note_pairs(pairs, around);
    list_candidates();
    workers_.resize(std::max<std::size_t>(workers_.size(), executor.concurrency()));
    for (Worker& worker : workers_) {
        worker.points.clear();
        worker.memory.clear();
    }
    executor.parallel_for(touches_.size(), kPairsATask, [&](std::size_t begin, std::size_t end, unsigned w) {
        for (std::size_t i = begin; i < end; ++i) {
            touches_[i].worker = w;
            touch(touches_[i], around, workers_[w]);
        }
    });
    touches_.erase(std::remove_if(touches_.begin(), touches_.end(), [](const Touch& t) { return !t.computed; }),
                   touches_.end());
    computed_ = touches_.size();
    for (const std::uint32_t object : movers_) moved_[object] = 0;
    write_contacts();
}

void ShapeContacts::update_all(std::span<const ObjectPair> pairs, const Surroundings& around, Executor& executor) {
    all_.clear();
    gone_.clear();
    for (const ObjectPair& pair : pairs) all_.push_back(ids_of(pair.first, pair.second));
    std::size_t place = 0;
    for (const PairState& state : states_) {
        const IdPair ids = ids_of(state.pair.first, state.pair.second);
        while (place < all_.size() && all_[place] < ids) ++place;
        if (place == all_.size() || !(all_[place] == ids)) gone_.push_back(ids);
    }
    update({all_, gone_}, around, executor);
}

// What began in the update before stays.
void ShapeContacts::age() {
    std::size_t place = 0;
    for (const IdPair& pair : began_) {
        place = find_from(place, contacts_, pair, is_contact_before);
        for (std::size_t at = place; is_at(contacts_, at, pair); ++at)
            if (contacts_[at].phase == ContactPhase::began) contacts_[at].phase = ContactPhase::stayed;
    }
    place = 0;
    for (const IdPair& pair : fresh_) {
        place = find_from(place, states_, pair, is_state_before);
        if (place == states_.size()) break;
        for (std::uint32_t i = 0; i < states_[place].point_count; ++i) states_[place].points[i].began = false;
    }
    began_.clear();
    fresh_.clear();
    std::swap(ended_, ended_before_);
    ended_.clear();
}

void ShapeContacts::write(PairState& state, const Touch& touch) {
    state.cache = touch.cache;
    state.neighbors = touch.neighbors;
    state.asks_neighbors = touch.asks_neighbors;
    state.is_new = false;
    if (touch.point_count > state.points.size()) {
        points_.give_back(state.points);
        state.points = points_.take(touch.point_count);
    }
    state.point_count = touch.point_count;
    std::copy_n(workers_[touch.worker].points.begin() + touch.first_point, touch.point_count, state.points.begin());
}

// With the normal and depth of its deepest point.
void ShapeContacts::show(const PairState& state, Contact& contact) {
    contact.shape_points = state.points.first(state.point_count);
    const auto deepest = std::max_element(
        contact.shape_points.begin(), contact.shape_points.end(),
        [](const convex::TrackedPoint& a, const convex::TrackedPoint& b) { return a.contact.depth < b.contact.depth; });
    contact.normal = deepest->normal;
    contact.depth = deepest->contact.depth;
}

// Goes through the pairs that were computed, those that touched and are gone, and the contacts that ended in the update
// before; all are in order. Two contacts of objects of the same indices are one that ended and one of new objects.
void ShapeContacts::write_contacts() {
    age();
    edits_.begin();
    added_.clear();
    std::size_t t = 0, d = 0, e = 0, place = 0;
    while (t < touches_.size() || d < dropped_.size() || e < ended_before_.size()) {
        const PairState* const next = t < touches_.size() ? &states_[touches_[t].state] : nullptr;
        IdPair ids = next != nullptr ? ids_of(next->pair.first, next->pair.second) : IdPair{kNoIndex, kNoIndex};
        const bool is_touch_at = next != nullptr;
        const IdPair of_touch = ids;
        if (d < dropped_.size() && dropped_[d] < ids) ids = dropped_[d];
        if (e < ended_before_.size() && ended_before_[e] < ids) ids = ended_before_[e];
        const bool is_touched = is_touch_at && of_touch == ids, is_dropped = d < dropped_.size() && dropped_[d] == ids;
        place = find_from(place, contacts_, ids, is_contact_before);
        std::size_t at = place;
        if (e < ended_before_.size() && ended_before_[e] == ids) {
            edits_.remove(at++);
            ++e;
        }
        const bool was_touching = is_at(contacts_, at, ids);
        const auto end = [&](Contact& contact) {
            Contact ended;
            ended.first = contact.first;
            ended.second = contact.second;
            ended.phase = ContactPhase::ended;
            contact = ended;
            ended_.push_back(ids);
        };
        if (is_dropped) {
            end(contacts_[at++]);
            ++d;
        }
        if (is_touched) {
            const Touch& touch = touches_[t];
            PairState& state = states_[touch.state];
            write(state, touch);
            const bool stays = was_touching && !is_dropped;
            if (touch.point_count > 0) {
                fresh_.push_back(ids);
                if (!stays) began_.push_back(ids);
            }
            if (stays && touch.point_count > 0) {
                show(state, contacts_[at]);
            } else if (stays) {
                end(contacts_[at]);
            } else if (touch.point_count > 0) {
                edits_.add(at);
                added_.push_back(static_cast<std::uint32_t>(t));
            }
            ++t;
        }
    }
    edits_.apply(contacts_);
    for (std::size_t n = 0; n < added_.size(); ++n) {
        const PairState& state = states_[touches_[added_[n]].state];
        Contact& contact = contacts_[edits_.places()[n]];
        contact = {};
        contact.first = state.pair.first;
        contact.second = state.pair.second;
        show(state, contact);
    }
}

void ShapeContacts::release_scratch() {
    release(changed_, movers_, came_, joined_, parted_, dropped_, candidates_, ended_before_, all_, gone_, touches_,
            added_, workers_);
}

void ShapeContacts::stay() {
    computed_ = 0;
    touches_.clear();
    dropped_.clear();
    write_contacts();
}

}  // namespace crofton::world
