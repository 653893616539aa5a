// SPDX-License-Identifier: MIT
// Visible ids as bits, and bits as ranges to draw.
#include <bit>
#include <crofton/core/error.hpp>
#include <crofton/cull/cull.hpp>

#include "id_bits_kernel.hpp"

namespace crofton::cull {

void to_bits(std::span<const boxtree::ItemId> ids, std::size_t items, Vector<std::uint64_t>& bits) {
    for (const boxtree::ItemId id : ids) CROFTON_ASSERT(id < items, "an id beyond the number of items");
    bits.assign(items / 64 + 2, 0);  // one more for the kernel
    mark_ids_kernel(ids.data(), ids.size(), bits.data());
    bits.resize((items + 63) / 64);
}

void merge_ranges(std::span<const std::uint64_t> bits, std::uint32_t max_gap, Vector<ItemRange>& ranges) {
    ranges.clear();
    for (std::size_t w = 0; w < bits.size(); ++w) {
        std::uint64_t word = bits[w];
        for (unsigned at = 0; word != 0;) {
            const auto skip = static_cast<unsigned>(std::countr_zero(word));
            word >>= skip;
            at += skip;
            const auto run = static_cast<unsigned>(std::countr_one(word));
            const auto first = static_cast<boxtree::ItemId>(64 * w + at);
            if (!ranges.empty() && first - (ranges.back().first + ranges.back().count) <= max_gap)
                ranges.back().count = first + run - ranges.back().first;
            else
                ranges.push_back({first, run});
            at += run;
            word = run == 64 ? 0 : word >> run;
        }
    }
}

}  // namespace crofton::cull
