// SPDX-License-Identifier: MIT
#include <crofton/bake/checksum.hpp>

#include <algorithm>
#include <array>
#include <crofton/core/memory.hpp>
#include <cstring>

namespace crofton::bake {
namespace {

constexpr std::size_t kLanes = 8;  // independent chains, so that multiplications overlap
constexpr std::size_t kBlock = 8 * kLanes;
constexpr std::size_t kChunk = std::size_t{1} << 20;  // what one task sums
constexpr std::uint64_t kOdd = 0x9e3779b97f4a7c15u;   // 2^64 over the golden ratio

// A bijection of `state` for each word, and of `word` for each state.
constexpr std::uint64_t step(std::uint64_t state, std::uint64_t word) {
    const std::uint64_t product = (state ^ word) * kOdd;
    return product ^ (product >> 32);
}

void add_block(std::array<std::uint64_t, kLanes>& lanes, const std::byte* block) {
    std::array<std::uint64_t, kLanes> words;
    std::memcpy(words.data(), block, kBlock);
    for (std::size_t i = 0; i < kLanes; ++i) lanes[i] = step(lanes[i], words[i]);
}

std::uint64_t sum_of_chunk(std::span<const std::byte> bytes) {
    std::array<std::uint64_t, kLanes> lanes;
    for (std::size_t i = 0; i < kLanes; ++i) lanes[i] = (2 * i + 1) * kOdd;
    std::size_t done = 0;
    for (; bytes.size() - done >= kBlock; done += kBlock) add_block(lanes, bytes.data() + done);
    if (done < bytes.size()) {
        std::array<std::byte, kBlock> last{};
        std::memcpy(last.data(), bytes.data() + done, bytes.size() - done);
        add_block(lanes, last.data());
    }
    std::uint64_t sum = bytes.size();  // tells a short last block from one of zeros
    for (const std::uint64_t lane : lanes) sum = step(sum, lane);
    return sum;
}

}  // namespace

std::uint64_t checksum(std::span<const std::byte> bytes, Executor& executor) {
    Vector<std::uint64_t> sums((bytes.size() + kChunk - 1) / kChunk);
    executor.parallel_for(sums.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t i = begin; i < end; ++i)
            sums[i] = sum_of_chunk(bytes.subspan(i * kChunk, std::min(kChunk, bytes.size() - i * kChunk)));
    });
    return sum_of_chunk(std::as_bytes(std::span(sums)));
}

}  // namespace crofton::bake
