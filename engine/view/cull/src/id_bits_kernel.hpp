// SPDX-License-Identifier: MIT
// Ids in any order to bits, and bits to ascending ids, in vectors.
#pragma once
#include <cstddef>
#include <cstdint>

namespace crofton::cull {

// Sets bit id % 64 of word id / 64 for each id; the ids are distinct. `bits` has a word more than the largest needs.
void mark_ids_kernel(const std::uint32_t* ids, std::size_t count, std::uint64_t* bits);

// Keeps, in order, the ids whose bit is set and those beyond the bits; returns how many. Room for 16 more is needed.
// Requires words ≥ 1.
std::size_t keep_ids_kernel(std::uint32_t* ids, std::size_t count, const std::uint64_t* bits, std::size_t words);

// The indices of the bits that are set, ascending; returns how many. Room for 16 more is needed.
std::size_t list_bits_kernel(const std::uint64_t* bits, std::size_t words, std::uint32_t* ids);

// The same, and `before` receives, for each word, the number of indices listed before its own.
std::size_t list_placed_bits_kernel(const std::uint64_t* bits, std::size_t words, std::uint32_t* ids,
                                    std::uint64_t* before);

// Sets to `value` the byte of each listed id whose bit is set.
void mark_placed_kernel(const std::uint32_t* ids, std::size_t count, const std::uint64_t* bits,
                        const std::uint64_t* before, std::uint8_t value, std::uint8_t* bytes);

// As the first, with a byte for each index: `marked` where its bit in `marks` is set, `others` where not. Room for 64
// more bytes.
struct MarkBytes {
    std::uint8_t marked, others;
};
std::size_t list_marked_bits_kernel(const std::uint64_t* bits, const std::uint64_t* marks, std::size_t words,
                                    MarkBytes values, std::uint32_t* ids, std::uint8_t* bytes);

}  // namespace crofton::cull
