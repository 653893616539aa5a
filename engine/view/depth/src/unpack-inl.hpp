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
        // One more is written for corners that come after all vertices.
        std::uint8_t places[kMaxPatchVertices + 1];  // of the corner with which each vertex comes
        read_corners(places);
        const std::uint32_t count = p_.vertex_count;
        if (p_.indices == nullptr)
            for (std::uint32_t v = 0; v < count; ++v) set_vertex(v, p_.positions[v]);
        else
            for (std::uint32_t v = 0; v < count; ++v) set_vertex(v, p_.positions[p_.indices[places[v]]]);
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

    // A corner with a new number is the first of its vertex.
    HWY_INLINE void read_corners(std::uint8_t* places) {
        alignas(64) std::uint32_t triples[Cluster::kMaxTriangles] = {};  // a byte a corner
        const std::uint32_t bits = bits_for(p_.vertex_count), mask = (1u << bits) - 1;
        std::uint32_t named = 0;
        for (std::uint32_t t = 0, at = 0; t < p_.triangle_count; ++t, at += 3 * bits) {
            const std::uint32_t* const words = p_.corner_words + at / 32;
            const auto left = static_cast<std::uint32_t>((words[0] | std::uint64_t{words[1]} << 32) >> at % 32);
            const std::uint32_t a = left & mask, b = left >> bits & mask, c = left >> 2 * bits & mask;
            triples[t] = a | b << 8 | c << 16;
            places[named] = static_cast<std::uint8_t>(3 * t);
            named += a == named;
            places[named] = static_cast<std::uint8_t>(3 * t + 1);
            named += b == named;
            places[named] = static_cast<std::uint8_t>(3 * t + 2);
            named += c == named;
        }
        const hn::RebindToUnsigned<DI> d;
        for (std::uint32_t t = 0; t < padded(p_.triangle_count); t += lanes()) {
            const auto three = hn::Load(d, triples + t);
            PatchBlock& block = p_.blocks[t / kLanes];
            hn::StoreU(hn::U8FromU32(hn::And(three, hn::Set(d, 0xffu))), Bytes(), block.corners[0] + t % kLanes);
            hn::StoreU(hn::U8FromU32(hn::And(hn::ShiftRight<8>(three), hn::Set(d, 0xffu))), Bytes(),
                       block.corners[1] + t % kLanes);
            hn::StoreU(hn::U8FromU32(hn::ShiftRight<16>(three)), Bytes(), block.corners[2] + t % kLanes);
        }
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
};

}  // namespace crofton::depth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
