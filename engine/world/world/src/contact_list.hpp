// SPDX-License-Identifier: MIT
// All contacts of a World in one list.
#pragma once
#include <algorithm>
#include <atomic>
#include <mutex>

#include "pair_order.hpp"

namespace crofton::world {

// Merges two lists of contacts, each in order. A pair that one list has ended and the other has begun, because it is
// now tested in another way (set_shape), is one contact that stays.
inline void merge_contacts(std::span<const Contact> a, std::span<const Contact> b, Vector<Contact>& all) {
    all.resize(a.size() + b.size());
    std::merge(a.begin(), a.end(), b.begin(), b.end(), all.begin(), [](const Contact& x, const Contact& y) {
        const ObjectPair first{x.first, x.second}, second{y.first, y.second};
        if (is_before(first, second) || is_before(second, first)) return is_before(first, second);
        return x.phase == ContactPhase::ended && y.phase != ContactPhase::ended;
    });
    std::size_t kept = 0;
    for (Contact& contact : all) {
        const Contact* const last = kept > 0 ? &all[kept - 1] : nullptr;
        const bool goes_on = last != nullptr && last->phase == ContactPhase::ended &&
                             contact.phase == ContactPhase::began && last->first.object == contact.first.object &&
                             last->second.object == contact.second.object;
        if (goes_on) {
            contact.phase = ContactPhase::stayed;
            --kept;
        }
        all[kept++] = contact;
    }
    all.resize(kept);
}

// Two lists of contacts, each in order, seen as one. It is made when someone asks for it, where both have contacts:
// an update costs the same. One thread changes the lists; any may ask between changes.
class ContactList {
  public:
    // Phases change, and what has ended goes, in the update after a change as well.
    void note_update(bool changed) {
        if (changed || changed_before_) is_old_ = true;
        changed_before_ = changed;
    }
    [[nodiscard]] std::span<const Contact> get(std::span<const Contact> a, std::span<const Contact> b) const {
        if (a.empty()) return b;
        if (b.empty()) return a;
        if (is_old_.load(std::memory_order_acquire)) {
            const std::lock_guard lock(mutex_);
            if (is_old_.load(std::memory_order_relaxed)) merge_contacts(a, b, all_);
            is_old_.store(false, std::memory_order_release);
        }
        return all_;
    }

  private:
    bool changed_before_ = true;
    mutable std::mutex mutex_;
    mutable std::atomic<bool> is_old_ = true;
    mutable Vector<Contact> all_;
};

}  // namespace crofton::world
