// SPDX-License-Identifier: MIT
// Shuffles that move the selected lanes of a vector to its front, by mask. Filled by the compiler, read only.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace crofton::simd {

// For 8 lanes of 32 bits: digit l (4 bits each) of entry `mask` is the lane that comes l-th. Lanes that are not
// selected follow in their order.
struct CompressLanes8 {
    alignas(64) std::uint32_t lanes[256];
};

// For 16 bytes that are lanes of kLaneBytes each: entry `mask` names the byte that comes to each place.
template <std::size_t kLaneBytes>
struct CompressBytes16 {
    static constexpr std::size_t kLanes = 16 / kLaneBytes;
    alignas(64) std::uint8_t bytes[std::size_t{1} << kLanes][16];
};

// The selected lanes, then the others, both in their order.
template <std::size_t kLanes>
constexpr std::array<std::uint8_t, kLanes> compressed_order(std::size_t mask) {
    std::array<std::uint8_t, kLanes> order{};
    std::size_t at = 0;
    for (const bool selected : {true, false})
        for (std::size_t lane = 0; lane < kLanes; ++lane)
            if ((mask >> lane & 1) == selected) order[at++] = static_cast<std::uint8_t>(lane);
    return order;
}

constexpr CompressLanes8 make_compress_lanes_8() {
    CompressLanes8 table{};
    for (std::size_t mask = 0; mask < 256; ++mask) {
        const auto order = compressed_order<8>(mask);
        for (std::size_t l = 0; l < 8; ++l) table.lanes[mask] |= std::uint32_t{order[l]} << (4 * l);
    }
    return table;
}

// For 4 lanes of 64 bits, which are moved as pairs of 32-bit lanes.
struct CompressLanes4 {
    alignas(64) std::uint32_t lanes[16];
};

constexpr CompressLanes4 make_compress_lanes_4() {
    CompressLanes4 table{};
    for (std::size_t mask = 0; mask < 16; ++mask) {
        const auto order = compressed_order<4>(mask);
        for (std::size_t l = 0; l < 8; ++l)
            table.lanes[mask] |= (2 * std::uint32_t{order[l / 2]} + static_cast<std::uint32_t>(l % 2)) << (4 * l);
    }
    return table;
}

template <std::size_t kLaneBytes>
constexpr CompressBytes16<kLaneBytes> make_compress_bytes_16() {
    using Table = CompressBytes16<kLaneBytes>;
    Table table{};
    for (std::size_t mask = 0; mask < std::size_t{1} << Table::kLanes; ++mask) {
        const auto order = compressed_order<Table::kLanes>(mask);
        for (std::size_t b = 0; b < 16; ++b)
            table.bytes[mask][b] = static_cast<std::uint8_t>(kLaneBytes * order[b / kLaneBytes] + b % kLaneBytes);
    }
    return table;
}

// The positions of the bits of 4, then those of the others.
struct Positions4 {
    alignas(64) std::uint32_t lanes[16][4];
};

constexpr Positions4 make_positions_4() {
    Positions4 table{};
    for (std::size_t mask = 0; mask < 16; ++mask) {
        const auto order = compressed_order<4>(mask);
        for (std::size_t l = 0; l < 4; ++l) table.lanes[mask][l] = order[l];
    }
    return table;
}

inline constexpr Positions4 kPositions4 = make_positions_4();
inline constexpr CompressLanes8 kCompressLanes8 = make_compress_lanes_8();
inline constexpr CompressLanes4 kCompressLanes4 = make_compress_lanes_4();
template <std::size_t kLaneBytes>
inline constexpr CompressBytes16<kLaneBytes> kCompressBytes16 = make_compress_bytes_16<kLaneBytes>();

}  // namespace crofton::simd
