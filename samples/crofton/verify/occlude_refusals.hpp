// SPDX-License-Identifier: MIT
// Occluders that are open, inside out, flat or not numbers: are they refused by name, and do they hide nothing?
#pragma once
#include <crofton/sampling/sampling.hpp>
#include <cstdint>
#include <vector>

namespace crofton::cli {

struct Refusals {
    const char* kind;
    std::uint64_t tried = 0;
    // Taken, refused under another name or for another item, or the set of occluders hides something else since. Also
    // counts the occluder before the damage, if it is refused.
    std::uint64_t wrong = 0;
};

// `rounds` sets of damaged occluders of each kind, of random shapes.
[[nodiscard]] std::vector<Refusals> try_bad_occluders(sampling::Random& random, std::uint64_t rounds);

}  // namespace crofton::cli
