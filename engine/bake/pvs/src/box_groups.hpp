// SPDX-License-Identifier: MIT
// A binary hierarchy over boxes: what is asked of pairs is asked of groups first.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <cstdint>
#include <span>

namespace crofton::pvs {

class BoxGroups {
  public:
    static constexpr std::uint32_t kRoot = 0;
    struct Group {
        Aabb box;
        std::uint32_t first = 0, count = 0;  // its items: items()[first .. first + count)
        std::uint32_t child = 0;             // its halves are child and child + 1; 0: one item
    };

    explicit BoxGroups(std::span<const Aabb> boxes);  // halves by the longest axis of the centres; at least one box

    [[nodiscard]] const Group& operator[](std::uint32_t group) const { return groups_[group]; }
    [[nodiscard]] std::span<const std::uint32_t> items(const Group& group) const {
        return std::span(items_).subspan(group.first, group.count);
    }
    [[nodiscard]] bool is_empty() const { return groups_.empty(); }

  private:
    Vector<Group> groups_;
    Vector<std::uint32_t> items_;
};

}  // namespace crofton::pvs
