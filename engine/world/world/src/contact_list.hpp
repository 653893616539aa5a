// SPDX-License-Identifier: MIT
// All contacts of a World in one list.
#pragma once
#include <algorithm>
#include <atomic>
#include <mutex>

#include "pair_order.hpp"

namespace crofton::world {

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
            if (is_old_.load(std::memory_order_relaxed)) merge(a, b);
            is_old_.store(false, std::memory_order_release);
        }
        return all_;
    }

  private:
    // Of the same two objects, one contact may have ended where another has begun.
    static bool comes_before(const Contact& a, const Contact& b) {
        const ObjectPair first{a.first, a.second}, second{b.first, b.second};
        if (is_before(first, second) || is_before(second, first)) return is_before(first, second);
        return a.phase == ContactPhase::ended && b.phase != ContactPhase::ended;
    }
    void merge(std::span<const Contact> a, std::span<const Contact> b) const {
        all_.resize(a.size() + b.size());
        std::merge(a.begin(), a.end(), b.begin(), b.end(), all_.begin(), comes_before);
    }

    bool changed_before_ = true;
    mutable std::mutex mutex_;
    mutable std::atomic<bool> is_old_ = true;
    mutable Vector<Contact> all_;
};

}  // namespace crofton::world
