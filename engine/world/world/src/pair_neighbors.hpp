// SPDX-License-Identifier: MIT
// Finds the objects that lie beside a pair of touching objects, at the place where they touch.
#pragma once
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/transform.hpp>
#include <optional>

#include "spatial_index.hpp"

namespace crofton::world {

// The objects beside a pair: those that meet the one, where the other is.
struct Neighbors {
    Vector<std::uint32_t> objects[2];  // beside the first, beside the second
    std::uint64_t name = 0;            // differs where the objects do, but for a chance of 2^-64
};

// Tiles of a floor need not be pairs themselves. So objects beside the first are sought among those that meet the
// second.
class PairNeighbors {
  public:
    struct Pair {
        std::uint32_t first, second;  // objects
    };
    void add(const Pair& pair);
    void remove(const Pair& pair);
    // Whom an object meets, ascending.
    [[nodiscard]] std::span<const std::uint32_t> partners_of(std::uint32_t object) const {
        const std::uint32_t slot = slot_of(object);
        if (slot == kNoIndex) return {};
        return slots_[slot].partners;
    }
    // Where the shape of an object that meets others stands; nothing: it meets none for now.
    [[nodiscard]] const std::optional<RigidTransform>& pose_of(std::uint32_t object) const {
        return slots_[slot_of(object)].pose;
    }
    // After the object has come into a pair, or moved. Its box is taken wider by `margin`, and by what counts as flush.
    void place(std::uint32_t object, const Obb& box, double margin, const std::optional<RigidTransform>& pose);
    void find(const Pair& pair, Neighbors& neighbors) const;
    // Visits the pairs that `object` may lie beside, or might have before it moved or parted; some of them twice.
    template <class Visit>
    void visit_pairs_beside(std::uint32_t object, Visit visit) const {
        for (const std::uint32_t partner : partners_of(object)) visit_pairs_at(partner, object, visit);
    }
    // The same, of the partner's pairs.
    template <class Visit>
    void visit_pairs_at(std::uint32_t partner, std::uint32_t object, Visit visit) const {
        const auto meeting = partners_of(partner);
        const auto visit_other = [&](std::uint32_t other) {
            if (other != object && other != partner) visit(partner, other);
        };
        if (meeting.size() <= kCrowd) {
            for (const std::uint32_t other : meeting) visit_other(other);
            return;
        }
        const auto visit_if_met = [&](std::uint32_t other) {
            if (std::binary_search(meeting.begin(), meeting.end(), other)) visit_other(other);
        };
        for (const std::uint32_t other : partners_of(object)) visit_if_met(other);
        for (const std::uint32_t other : crowds_) visit_if_met(other);
    }

  private:
    // What meets more objects than these, as a ground does, asks only those that meet the other of the pair as well.
    static constexpr std::size_t kCrowd = 64;
    void find_beside(std::uint32_t own, std::uint32_t other, Vector<std::uint32_t>& objects) const;

    // Of an object that meets others.
    struct Slot {
        Vector<std::uint32_t> partners;
        Aabb bounds;
        std::optional<RigidTransform> pose;
    };
    [[nodiscard]] const Aabb& bounds_of(std::uint32_t object) const { return slots_[slot_of(object)].bounds; }

    // kNoIndex: it meets no other.
    [[nodiscard]] std::uint32_t slot_of(std::uint32_t object) const;
    [[nodiscard]] std::uint32_t& take_slot(std::uint32_t object);  // where slot_of() is kept
    void give_back_slot(std::uint32_t object);

    struct RegionSlot {
        std::uint32_t object, slot;
    };
    Vector<std::uint32_t> slot_of_;    // by object of the World's own
    Vector<RegionSlot> region_slots_;  // of regions' objects, in order
    Vector<Slot> slots_;
    Vector<std::uint32_t> free_;    // slots
    Vector<std::uint32_t> crowds_;  // objects that meet more than kCrowd
};

}  // namespace crofton::world
