// SPDX-License-Identifier: MIT
// Parts of a bake of light: sums of chains, states as bytes, their sum.
#include <algorithm>
#include <bit>
#include <crofton/core/recovery.hpp>
#include <cstring>
#include <iterator>

#include "bake_sums.hpp"
#include "fnv1a.hpp"

namespace crofton::radiosity {
namespace {

constexpr std::uint64_t kBakeMagic = 0x656b6162'6f736964u;  // names this format and its byte order

struct BakeHeader {
    std::uint64_t magic = kBakeMagic, fingerprint = 0, patches = 0, runs = 0, sums = 0;
};
struct SumHeader {
    std::uint64_t begin = 0, end = 0, lines = 0, unseen = 0, seen = 0;
};
constexpr std::uint64_t kMostPatchesOfState = std::uint64_t{1} << 32;
constexpr std::uint64_t kBytesOfPatch = 2 * sizeof(glm::dvec3) + 2 * sizeof(std::uint64_t);

Error damaged(const char* what) {
    return fail(ErrorCode::parse, kNoItem, {"state of a bake of light: ", what});
}

// One array after another, as they are stored.
template <class SumOrConst, class Visit>
void for_each_array(SumOrConst& sum, Visit&& visit) {
    visit(sum.light);
    visit(sum.squares);
    visit(sum.drawn);
    visit(sum.buried);
}

void add_values(const Bake::Sum& from, Bake::Sum& to) {
    to.lines += from.lines;
    to.unseen += from.unseen;
    to.seen += from.seen;
    for (std::size_t i = 0; i < to.light.size(); ++i) {
        to.light[i] += from.light[i];
        to.squares[i] += from.squares[i];
        to.drawn[i] += from.drawn[i];
        to.buried[i] += from.buried[i];
    }
}

// The first sum that ends behind the chain.
auto first_beyond(const Bake::Sums& sums, std::uint64_t chain) {
    return std::upper_bound(sums.all.begin(), sums.all.end(), chain,
                            [](std::uint64_t c, const Bake::Sum& each) { return c < each.end; });
}

bool is_node(const SumHeader& sum, std::uint64_t chains) {
    if (sum.begin >= sum.end || sum.end > chains) return false;
    const std::uint64_t size = sum.end - sum.begin;
    return std::has_single_bit(size) && sum.begin % size == 0;
}

}  // namespace

ChainRange chains_of(const Shard& shard, std::uint64_t runs) {
    // Neither product overflows: at most 2^29 chains, shards are below 2^32.
    const std::uint64_t chains = chains_of(runs);
    return {chains * shard.index / shard.count, chains * (std::uint64_t{shard.index} + 1) / shard.count};
}

bool has_chain(const Bake::Sums& sums, std::uint64_t chain) {
    const auto sum = first_beyond(sums, chain);
    return sum != sums.all.end() && sum->begin <= chain;
}

void add(Bake::Sum sum, Bake::Sums& sums) {
    // Nodes of a tree, in order: two of them are apart, or one holds the other.
    auto at = sums.all.begin() + (first_beyond(sums, sum.begin) - sums.all.cbegin());
    if (at != sums.all.end() && at->begin <= sum.begin && sum.end <= at->end) return;
    auto last = at;
    while (last != sums.all.end() && last->end <= sum.end) ++last;
    at = sums.all.erase(at, last);
    for (;;) {
        const std::uint64_t size = sum.end - sum.begin;
        const bool is_left = sum.begin / size % 2 == 0;
        const bool is_there = is_left ? at != sums.all.end() && at->begin == sum.end && at->end == sum.end + size
                                      : at != sums.all.begin() && std::prev(at)->begin == sum.begin - size &&
                                            std::prev(at)->end == sum.begin;
        if (!is_there) break;
        if (!is_left) --at;
        Bake::Sum left = is_left ? std::move(sum) : std::move(*at);
        const Bake::Sum right = is_left ? std::move(*at) : std::move(sum);
        at = sums.all.erase(at);
        add_values(right, left);
        left.end = right.end;
        sum = std::move(left);
    }
    sums.all.insert(at, std::move(sum));
}

Vector<std::byte> to_bytes(const Bake::Sums& sums) {
    const BakeHeader header{kBakeMagic, sums.fingerprint, sums.patches, sums.runs, sums.all.size()};
    Vector<std::byte> bytes(sizeof header + sums.all.size() * (sizeof(SumHeader) + sums.patches * kBytesOfPatch) +
                            sizeof(std::uint64_t));
    std::byte* to = bytes.data();
    const auto put = [&](const void* data, std::size_t size) {
        if (size > 0) std::memcpy(to, data, size);
        to += size;
    };
    put(&header, sizeof header);
    for (const Bake::Sum& sum : sums.all) {
        const SumHeader head{sum.begin, sum.end, sum.lines, sum.unseen, sum.seen};
        put(&head, sizeof head);
        for_each_array(sum, [&](const auto& values) { put(values.data(), values.size() * sizeof(values[0])); });
    }
    const std::uint64_t check = fnv1a(kBakeMagic, std::span(bytes).first(bytes.size() - sizeof(std::uint64_t)));
    put(&check, sizeof check);
    return bytes;
}

Result<Bake::Sums> sums_from(std::span<const std::byte> bytes) {
    BakeHeader header;
    std::uint64_t check = 0;
    if (!is_bake_state(bytes) || bytes.size() < sizeof header + sizeof check)
        return damaged("damaged, or not one of ours");
    std::memcpy(&header, bytes.data(), sizeof header);
    std::memcpy(&check, bytes.data() + bytes.size() - sizeof check, sizeof check);
    if (check != fnv1a(kBakeMagic, bytes.first(bytes.size() - sizeof check))) return damaged("damaged");
    const std::uint64_t room = bytes.size() - sizeof header - sizeof check;
    if (header.patches == 0 || header.patches > kMostPatchesOfState || header.runs > kMostRuns)
        return damaged("its header makes no sense");
    const std::uint64_t each = sizeof(SumHeader) + header.patches * kBytesOfPatch;
    if (room % each != 0 || room / each != header.sums) return damaged("it is not as long as its header says");
    Bake::Sums sums;
    sums.fingerprint = header.fingerprint;
    sums.patches = header.patches;
    sums.runs = header.runs;
    const std::byte* from = bytes.data() + sizeof header;
    std::uint64_t end = 0;
    for (std::uint64_t i = 0; i < header.sums; ++i) {
        SumHeader head;
        std::memcpy(&head, from, sizeof head);
        from += sizeof head;
        if (!is_node(head, chains_of(header.runs)) || head.begin < end) return damaged("its chains do not ascend");
        end = head.end;
        Bake::Sum sum{head.begin, head.end, head.lines, head.unseen, head.seen, {}, {}, {}, {}};
        for_each_array(sum, [&](auto& values) {
            values.resize(static_cast<std::size_t>(header.patches));
            const std::size_t size = values.size() * sizeof(values[0]);
            if (size > 0) std::memcpy(values.data(), from, size);
            from += size;
        });
        add(std::move(sum), sums);
    }
    return sums;
}

bool is_bake_state(std::span<const std::byte> bytes) {
    std::uint64_t magic = 0;
    if (bytes.size() < sizeof magic) return false;
    std::memcpy(&magic, bytes.data(), sizeof magic);
    return magic == kBakeMagic;
}

Result<Vector<std::byte>> merge_states(std::span<const std::span<const std::byte>> states) {
    return crofton::detail::recover([&]() -> Result<Vector<std::byte>> {
        if (states.empty()) return fail(ErrorCode::empty, kNoItem, "merging parts of a bake of light: there are none");
        Bake::Sums sums;
        for (std::size_t i = 0; i < states.size(); ++i) {
            auto part = sums_from(states[i]);
            if (!part) return fail(part.error().code, i, part.error().message);
            if (i == 0) {
                sums = std::move(*part);
                continue;
            }
            if (part->fingerprint != sums.fingerprint || part->patches != sums.patches || part->runs != sums.runs)
                return fail(ErrorCode::invalid_argument, i,
                            "a part of another bake than the first: scene, options and runs must be the same");
            for (Bake::Sum& sum : part->all) add(std::move(sum), sums);
        }
        return to_bytes(sums);
    });
}

Result<Vector<std::uint32_t>> missing_shards(std::span<const std::byte> state, std::uint32_t count) {
    return crofton::detail::recover([&]() -> Result<Vector<std::uint32_t>> {
        if (count == 0) return fail(ErrorCode::invalid_argument, kNoItem, "a bake in 0 parts");
        const auto sums = sums_from(state);
        if (!sums) return sums.error();
        Vector<std::uint32_t> missing;
        for (std::uint32_t i = 0; i < count; ++i) {
            const ChainRange shard = chains_of({i, count}, sums->runs);
            std::uint64_t chain = shard.begin;
            for (auto sum = first_beyond(*sums, chain);
                 chain < shard.end && sum != sums->all.end() && sum->begin <= chain; ++sum)
                chain = sum->end;
            if (chain < shard.end) missing.push_back(i);
        }
        return missing;
    });
}

}  // namespace crofton::radiosity
