// SPDX-License-Identifier: MIT
// Stored trees, trusted in nothing; of those with sound links but contents of any kind, queries stay within bounds.
#include <crofton/boxtree/box_tree.hpp>
#include <span>

#include "use_tree.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace crofton;
    const auto bytes = std::as_bytes(std::span(data, size));
    if (auto tree = boxtree::BoxTree::deserialise(bytes)) {
        if (!tree->validate()) std::abort();
        fuzz::query(*tree);
        fuzz::change(*tree);
        if (!tree->validate()) std::abort();
    }
    if (const auto tree = boxtree::BoxTree::deserialise(bytes, boxtree::Trust::contents)) fuzz::query(*tree);
    return 0;
}
