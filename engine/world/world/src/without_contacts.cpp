// SPDX-License-Identifier: MIT
// Replaces contact_finder.cpp and shape_contacts.cpp if CROFTON_CONTACTS is off: a smaller World with views and rays.
// Asking it for pairs is an error.
#include "contact_finder.hpp"
#include "region_pairs.hpp"
#include "shape_contacts.hpp"
#include "world_state.hpp"

namespace crofton::world {

ContactFinder::ContactFinder(const WorldOptions& options)
    : options_(options), broadphase_({.exact_boxes = true, .max_pairs = options.max_pairs}) {}

Result<void> ContactFinder::update(const ObjectTable&, SpatialIndex&, const scene::Scene&, Shapes&, const ObjectShapes&,
                                   const PairChanges&, ShapeToucher, Executor&) {
    return fail(ErrorCode::unsupported, kNoItem, "World::update: this build of the library finds no pairs");
}
void ContactFinder::reserve(std::size_t) {}
void ContactFinder::stay() {}
void ContactFinder::release_scratch() {}

void RegionPairs::stay() {}
void RegionPairs::merge(std::span<const ObjectPair>, std::span<const Contact>) {}

void ShapeContacts::update(const ChangedPairs&, const Surroundings&, Executor&) {}
void ShapeContacts::update_all(std::span<const ObjectPair>, const Surroundings&, Executor&) {}
void ShapeContacts::stay() {}
void ShapeContacts::release_scratch() {}

}  // namespace crofton::world

namespace crofton {
Result<void> World::State::update_region_pairs(Result<void> others) {
    return others;
}
void World::State::update_shape_contacts(Executor&) {}
}  // namespace crofton
