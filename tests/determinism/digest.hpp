// SPDX-License-Identifier: MIT
// The bits of answers, added up: numbers by their representation, so that a change in the last place is a change.
#pragma once
#include <bit>
#include <concepts>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/shapes.hpp>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <ranges>

namespace crofton::test {

// FNV-1a over 64-bit words (Fowler, Noll, Vo), each stirred by the finaliser of MurmurHash3.
class Digest {
  public:
    Digest& add(std::unsigned_integral auto number) {
        std::uint64_t word = number;
        word = (word ^ word >> 33) * 0xff51afd7ed558ccdu;
        word = (word ^ word >> 33) * 0xc4ceb9fe1a85ec53u;
        state_ = (state_ ^ word ^ word >> 33) * 0x100000001b3u;
        return *this;
    }
    Digest& add(double number) { return add(std::bit_cast<std::uint64_t>(number)); }
    Digest& add(float number) { return add(std::bit_cast<std::uint32_t>(number)); }
    Digest& add(const glm::dvec2& v) { return add(v.x).add(v.y); }
    Digest& add(const glm::dvec3& v) { return add(v.x).add(v.y).add(v.z); }
    Digest& add(const glm::vec3& v) { return add(v.x).add(v.y).add(v.z); }
    Digest& add(const Plane& plane) { return add(plane.normal).add(plane.offset); }
    Digest& add(const Aabb& box) { return add(box.min).add(box.max); }
    Digest& add(const Obb& box) {
        add(box.center).add(box.half_extents);
        for (int k = 0; k < 3; ++k) add(box.axes[k]);
        return *this;
    }
    template <std::ranges::range Range>
    Digest& add(const Range& range) {
        std::uint64_t count = 0;
        for (const auto& item : range) add(item), ++count;
        return add(count);
    }
    [[nodiscard]] std::uint64_t value() const { return state_; }

  private:
    std::uint64_t state_ = 0xcbf29ce484222325u;
};

}  // namespace crofton::test
