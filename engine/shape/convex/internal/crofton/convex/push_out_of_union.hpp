// SPDX-License-Identifier: MIT
// contact_manifolds() with neighbours, for many pairs of shapes that are often neighbours of each other.
#pragma once
#include <crofton/convex/query.hpp>

namespace crofton::convex {

// Values of ordered pairs of numbers. Takes memory when it holds more pairs than ever before.
template <class Value>
class PairTable {
  public:
    void clear() {
        count_ = 0;
        ++round_;
    }
    // Returns the pair's value, which `make` gives if there is none yet. It holds until the next call.
    template <class Make>
    const Value& get(std::uint32_t first, std::uint32_t second, Make make) {
        if (2 * (count_ + 1) > slots_.size()) grow();
        const std::uint64_t key = std::uint64_t{first} << 32 | second;
        Slot* const slot = find(key);
        if (slot->round != round_) {
            *slot = {key, round_, make()};
            ++count_;
        }
        return slot->value;
    }

  private:
    struct Slot {
        std::uint64_t key = 0, round = 0;  // the slot is empty where its round is over
        Value value{};
    };
    // The slot of the key, or the empty one where it belongs.
    Slot* find(std::uint64_t key) {
        const std::size_t mask = slots_.size() - 1;
        for (std::size_t at = (key * 0x9e3779b97f4a7c15u) >> 32 & mask;; at = (at + 1) & mask)
            if (slots_[at].round != round_ || slots_[at].key == key) return &slots_[at];
    }
    void grow() {
        Vector<Slot> before(slots_.size() < 32 ? 64 : 2 * slots_.size());
        std::swap(before, slots_);
        for (const Slot& slot : before)
            if (slot.round == round_) *find(slot.key) = slot;
    }

    Vector<Slot> slots_;  // a power of two, at most half of them in use
    std::size_t count_ = 0;
    std::uint64_t round_ = 1;
};

// The contact of two shapes alone: its normal from the first to the second, its depth and one of its points.
struct PairContact {
    bool touches = false;
    glm::dvec3 normal{0.0}, point{0.0};
    double depth = 0.0;
};

// What is found of pairs of numbered shapes, in calls between which no shape changes or moves.
struct PairMemory {
    PairTable<bool> is_flush;  // the second beside the first
    PairTable<PairContact> contact;

    void clear() {
        is_flush.clear();
        contact.clear();
    }
};

// Shapes beside a and b as in Beside, with the numbers of all.
struct NumberedBeside {
    Beside shapes;
    std::uint32_t number_a = 0, number_b = 0;
    std::span<const std::uint32_t> numbers_a = {}, numbers_b = {};
};

// Replaces the contacts of two convex shapes alone, which contact_manifolds() has found with the cache, by their
// contacts beside others.
void push_out_of_union(const ShapeAtPose& a, const ShapeAtPose& b, const NumberedBeside& beside,
                       const ManifoldOptions& options, Manifolds& found, PairMemory& memory, PairCache& cache);

}  // namespace crofton::convex
