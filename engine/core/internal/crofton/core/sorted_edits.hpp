// SPDX-License-Identifier: MIT
// Few changes of a long sorted list.
#pragma once
#include <algorithm>
#include <crofton/core/memory.hpp>
#include <cstddef>
#include <span>

namespace crofton {

// Keeps its scratch memory.
class SortedEdits {
  public:
    // Takes `removed` out of a sorted vector, and puts `added` in; both are sorted, too, `removed` is in the vector.
    // What is between two changes is moved as one. is_before(a, b) orders values.
    template <class T, class IsBefore>
    void apply(std::span<const T> removed, std::span<const T> added, Vector<T>& sorted, IsBefore is_before) {
        plan(removed, added, sorted, is_before);
        const std::size_t size = sorted.size() + added.size() - removed.size();
        if (size > sorted.size()) sorted.resize(size);
        const auto at = [&](std::size_t i) { return sorted.begin() + static_cast<std::ptrdiff_t>(i); };
        // To the left from the left, to the right from the right: no stretch is written over before it has moved.
        for (const Stretch& s : stretches_)
            if (s.shift < 0) std::move(at(s.begin), at(s.end), at(s.begin) + s.shift);
        for (std::size_t n = stretches_.size(); n-- > 0;)
            if (const Stretch& s = stretches_[n]; s.shift > 0)
                std::move_backward(at(s.begin), at(s.end), at(s.end) + s.shift);
        for (std::size_t n = 0; n < added.size(); ++n) sorted[places_[n]] = added[n];
        if (size < sorted.size()) sorted.resize(size);
    }

  private:
    struct Stretch {
        std::size_t begin, end;
        std::ptrdiff_t shift;
    };
    template <class T, class IsBefore>
    void plan(std::span<const T> removed, std::span<const T> added, const Vector<T>& sorted, IsBefore is_before) {
        stretches_.clear();
        places_.clear();
        std::size_t begin = 0, r = 0, a = 0;
        std::ptrdiff_t shift = 0;
        while (r < removed.size() || a < added.size()) {
            const bool removes = a == added.size() || (r < removed.size() && !is_before(added[a], removed[r]));
            const T& value = removes ? removed[r] : added[a];
            const auto found =
                std::lower_bound(sorted.begin() + static_cast<std::ptrdiff_t>(begin), sorted.end(), value, is_before);
            const auto end = static_cast<std::size_t>(found - sorted.begin());
            stretches_.push_back({begin, end, shift});
            begin = end;
            if (removes) {
                ++r;
                ++begin;
                --shift;
            } else {
                ++a;
                places_.push_back(static_cast<std::size_t>(static_cast<std::ptrdiff_t>(end) + shift));
                ++shift;
            }
        }
        stretches_.push_back({begin, sorted.size(), shift});
    }

    Vector<Stretch> stretches_;
    Vector<std::size_t> places_;  // of what is added
};

}  // namespace crofton
