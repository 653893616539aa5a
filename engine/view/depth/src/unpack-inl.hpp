// SPDX-License-Identifier: MIT
// Reads a cluster's corners, and finds which triangles meet along an edge, eight triangles at a time. Compiled once per
// instruction set (Highway).
#include <hwy/highway.h>
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "adjacency.hpp"
#include "patch.hpp"
#include "tiles-inl.hpp"

#if defined(CROFTON_DEPTH_UNPACK_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_DEPTH_UNPACK_INL
#undef CROFTON_DEPTH_UNPACK_INL
#else
#define CROFTON_DEPTH_UNPACK_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::depth::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

class PatchUnpacker {
  public:
    explicit PatchUnpacker(Patch& patch) : p_(patch) {}

    // As PatchReader::read(), of an opened patch of a sound mesh; coordinates are padded.
    HWY_INLINE void read() {
        read_corners();
        const std::uint32_t count = p_.vertex_count;
        if (p_.indices == nullptr)
            for (std::uint32_t v = 0; v < count; ++v) set_vertex(v, p_.positions[v]);
        else
            read_lent();
        for (std::uint32_t v = count; v < padded(count); ++v) set_vertex(v, p_.vertex(v - 1));
    }

    // Two triangles are neighbours where just these two share the edge, in opposite directions. Others than `those` may
    // get any neighbours.
    HWY_INLINE void find_neighbors(std::uint64_t those) {
        if (p_.has_twins) return find_neighbors_of_any();
        const DI d;
        const VI vertices = hn::Set(d, static_cast<std::int32_t>(p_.vertex_count));
        alignas(64) std::int32_t opposite[4 * Cluster::kMaxTriangles];
        for (std::uint32_t t = 0; t < p_.triangle_count; t += lanes()) {
            const VI a = load(t, 0), b = load(t, 1), c = load(t, 2);
            const auto edge = [&](VI from, VI to) { return hn::Add(hn::Mul(from, vertices), to); };
            const VI none = hn::Zero(d);
            hn::StoreInterleaved4(edge(a, b), edge(b, c), edge(c, a), none, d, p_.edges + 4 * t);
            hn::StoreInterleaved4(edge(b, a), edge(c, b), edge(a, c), none, d, opposite + 4 * t);
        }
        for (std::uint64_t left = those; left != 0; left &= left - 1) {
            const auto t = static_cast<std::uint32_t>(std::countr_zero(left));
            for (std::uint32_t h = 4 * t; h < 4 * t + 3; ++h) p_.owners[p_.edges[h]] = static_cast<std::uint8_t>(h);
        }
        const std::uint32_t end = 4 * p_.triangle_count;
        for (std::uint64_t left = those; left != 0; left &= left - 1) {
            const auto t = static_cast<std::uint32_t>(std::countr_zero(left));
            for (std::uint32_t k = 0; k < 3; ++k) {
                const std::int32_t across = opposite[4 * t + k];
                const std::uint32_t owner = p_.owners[across];
                const bool found = (p_.edges[owner] == across) & (owner < end);
                p_.blocks[t / kLanes].neighbors[k][t % kLanes] =
                    static_cast<std::uint8_t>(owner | (found ? 0u : std::uint32_t{kNoNeighbor}));
            }
        }
    }

  private:
    using DI = hn::RebindToSigned<DF>;
    using VI = hn::Vec<DI>;
    using Bytes = hn::Rebind<std::uint8_t, DI>;
    static std::uint32_t lanes() { return static_cast<std::uint32_t>(hn::Lanes(DI())); }
    HWY_INLINE VI load(std::uint32_t t, std::uint32_t k) const {
        return hn::PromoteTo(DI(), hn::LoadU(Bytes(), p_.blocks[t / kLanes].corners[k] + t % kLanes));
    }
    HWY_INLINE void set_vertex(std::uint32_t v, const glm::vec3& p) {
        p_.coordinates[0][v] = p.x, p_.coordinates[1][v] = p.y, p_.coordinates[2][v] = p.z;
    }

    using VU = hn::Vec<hn::RebindToUnsigned<DI>>;

    // The bits from `first` on, of the words that the corners begin with; 3 · corner_bits more of them in each lane.
    [[nodiscard]] HWY_INLINE VU corner_bits_from(std::uint32_t first) const {
        const hn::RebindToUnsigned<DI> d;
        const std::uint32_t* const words = p_.corner_words + first / 32;
#if HWY_TARGET == HWY_SCALAR
        return hn::Set(d, static_cast<std::uint32_t>((words[0] | std::uint64_t{words[1]} << 32) >> first % 32));
#else
        // Eight lanes reach 31 + 8 · 24 bits, which are seven words, and four lanes 31 + 4 · 24, which are four.
        const VU at = hn::Add(hn::Mul(numbers(), hn::Set(d, 3 * p_.corner_bits)), hn::Set(d, first % 32));
        const VU word = hn::ShiftRight<5>(at), bit = hn::And(at, hn::Set(d, 31u));
        const VU next = hn::Min(hn::Add(word, hn::Set(d, 1u)), hn::Set(d, lanes() - 1));
        const VU all = hn::LoadU(d, words);
        const VU low = hn::TableLookupLanes(all, hn::IndicesFromVec(d, word));
        const VU high = hn::TableLookupLanes(all, hn::IndicesFromVec(d, next));
        return hn::Or(hn::Shr(low, bit), hn::Shl(hn::Add(high, high), hn::Sub(hn::Set(d, 31u), bit)));
#endif
    }
    [[nodiscard]] static HWY_INLINE VU numbers() {
        alignas(32) static constexpr std::uint32_t kNumbers[kLanes] = {0, 1, 2, 3, 4, 5, 6, 7};
        return hn::Load(hn::RebindToUnsigned<DI>(), kNumbers);
    }

    HWY_INLINE void read_corners() {
        const hn::RebindToUnsigned<DI> d;
        const auto bits = static_cast<int>(p_.corner_bits);
        const VU mask = hn::Set(d, (1u << bits) - 1);
        VU most = hn::Zero(d);
        for (std::uint32_t t = 0; t < padded(p_.triangle_count); t += lanes()) {
            VU corners[3] = {corner_bits_from(p_.first_bit + t * 3 * p_.corner_bits)};
            corners[1] = hn::ShiftRightSame(corners[0], bits), corners[2] = hn::ShiftRightSame(corners[1], bits);
            const auto real = hn::Lt(hn::Add(numbers(), hn::Set(d, t)), hn::Set(d, p_.triangle_count));
            for (std::uint32_t k = 0; k < 3; ++k) {
                corners[k] = hn::IfThenElseZero(real, hn::And(corners[k], mask));
                most = hn::Max(most, corners[k]);
                hn::StoreU(hn::U8FromU32(corners[k]), Bytes(), p_.blocks[t / kLanes].corners[k] + t % kLanes);
            }
            hn::Store(hn::Or(corners[0], hn::Or(hn::ShiftLeft<8>(corners[1]), hn::ShiftLeft<16>(corners[2]))), d,
                      triples_ + t);
        }
        p_.vertex_count = hn::GetLane(hn::MaxOfLanes(d, most)) + 1;
    }

    // A vertex is where the first corner of it is: the last that is written here.
    HWY_INLINE void read_lent() {
        std::uint8_t places[kMaxPatchVertices];
        for (std::uint32_t t = p_.triangle_count; t-- > 0;) {
            const std::uint32_t corners = triples_[t];
            places[corners >> 16] = static_cast<std::uint8_t>(3 * t + 2);
            places[corners >> 8 & 0xff] = static_cast<std::uint8_t>(3 * t + 1);
            places[corners & 0xff] = static_cast<std::uint8_t>(3 * t);
        }
        const std::uint32_t count = p_.vertex_count;
        if (p_.order == nullptr)
            for (std::uint32_t v = 0; v < count; ++v) set_vertex(v, p_.positions[p_.indices[places[v]]]);
        else
            for (std::uint32_t v = 0; v < count; ++v)
                set_vertex(v, p_.positions[p_.indices[std::size_t{3} * p_.order[places[v] / 3] + places[v] % 3]]);
    }

    void find_neighbors_of_any() {
        std::array<std::uint8_t, 3 * Cluster::kMaxTriangles> corners, neighbors;
        for (std::uint32_t t = 0; t < p_.triangle_count; ++t)
            for (std::uint32_t k = 0; k < 3; ++k) corners[3 * t + k] = static_cast<std::uint8_t>(p_.corner(t, k));
        depth::find_neighbors(corners.data(), p_.triangle_count, neighbors.data());
        for (std::uint32_t t = 0; t < padded(p_.triangle_count); ++t)
            for (std::uint32_t k = 0; k < 3; ++k)
                p_.blocks[t / kLanes].neighbors[k][t % kLanes] =
                    t < p_.triangle_count ? neighbors[3 * t + k] : kNoNeighbor;
    }

    Patch& p_;
    alignas(64) std::uint32_t triples_[Cluster::kMaxTriangles];  // the corners of each triangle, a byte each
};

}  // namespace crofton::depth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
