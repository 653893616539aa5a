// SPDX-License-Identifier: MIT
#include "adjacency.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>

namespace crofton::depth {
namespace {

constexpr std::uint64_t mix(std::uint64_t key) {
    key ^= key >> 32;
    key *= 0x9e3779b97f4a7c15u;
    return key ^ key >> 29;
}

// An open table of numbers, twice as large as what it holds.
class Slots {
  public:
    explicit Slots(std::size_t count) : slots_(std::bit_ceil(2 * count + 2), Adjacency::kNone) {}

    // The slot of an equal entry, or the empty one where it belongs.
    template <class Equal>
    std::uint32_t& find(std::uint64_t hash, const Equal& equal) {
        for (std::size_t at = hash & (slots_.size() - 1);; at = (at + 1) & (slots_.size() - 1))
            if (slots_[at] == Adjacency::kNone || equal(slots_[at])) return slots_[at];
    }

  private:
    Vector<std::uint32_t> slots_;
};

std::array<std::uint32_t, 3> bits_of(const glm::vec3& p) {
    // + 0 makes −0 and 0 one number.
    return {std::bit_cast<std::uint32_t>(p.x + 0.0f), std::bit_cast<std::uint32_t>(p.y + 0.0f),
            std::bit_cast<std::uint32_t>(p.z + 0.0f)};
}

Vector<std::uint32_t> weld(std::span<const glm::vec3> positions) {
    Slots slots(positions.size());
    Vector<std::uint32_t> first(positions.size());
    for (std::uint32_t v = 0; v < positions.size(); ++v) {
        const auto bits = bits_of(positions[v]);
        const std::uint64_t hash = mix(mix(std::uint64_t{bits[0]} << 32 | bits[1]) + bits[2]);
        std::uint32_t& slot = slots.find(hash, [&](std::uint32_t other) { return bits_of(positions[other]) == bits; });
        if (slot == Adjacency::kNone) slot = v;
        first[v] = slot;
    }
    return first;
}

}  // namespace

Adjacency find_adjacency(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices) {
    Adjacency result;
    const Vector<std::uint32_t> first = weld(positions);
    result.corners.resize(indices.size());
    for (std::size_t i = 0; i < indices.size(); ++i) result.corners[i] = first[indices[i]];
    const Vector<std::uint32_t>& c = result.corners;
    result.neighbors.assign(indices.size(), Adjacency::kNone);
    result.fans.assign(positions.size(), 0);
    result.open.assign(positions.size(), 0);

    // Half edges by their pair of corners: the first found stands in the table, `next` chains the others to it.
    const auto next_corner = [](std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; };
    Slots slots(indices.size());
    Vector<std::uint32_t> next(indices.size(), Adjacency::kNone);
    Vector<std::uint32_t> heads;
    for (std::uint32_t h = 0; h < c.size(); ++h) {
        const std::uint32_t t = h / 3 * 3;
        if (c[t] == c[t + 1] || c[t + 1] == c[t + 2] || c[t + 2] == c[t]) continue;
        ++result.fans[c[h]];
        const std::uint32_t low = std::min(c[h], c[next_corner(h)]), high = std::max(c[h], c[next_corner(h)]);
        std::uint32_t& slot = slots.find(mix(std::uint64_t{low} << 32 | high), [&](std::uint32_t g) {
            return std::min(c[g], c[next_corner(g)]) == low && std::max(c[g], c[next_corner(g)]) == high;
        });
        if (slot == Adjacency::kNone) {
            slot = h;
            heads.push_back(h);
        } else {
            next[h] = next[slot];
            next[slot] = h;
        }
    }
    for (const std::uint32_t h : heads) {
        const std::uint32_t other = next[h];
        if (other != Adjacency::kNone && next[other] == Adjacency::kNone && c[other] == c[next_corner(h)]) {
            result.neighbors[h] = other / 3;
            result.neighbors[other] = h / 3;
        } else {
            result.open[c[h]] = result.open[c[next_corner(h)]] = 1;
        }
    }
    return result;
}

}  // namespace crofton::depth
