// SPDX-License-Identifier: MIT
// Finds what a view sees of a binary tree.
#include <algorithm>
#include <crofton/study/binary_tree.hpp>

namespace crofton::study {

// A bound contains what is below it, so its verdict is theirs unless it straddles.
std::size_t find_visible(const BinaryTree& tree, const cull::View& view, Vector<ItemId>& ids) {
    ids.clear();
    if (view.layer_mask == 0) return 0;
    const auto test = [&](const Obb& bound) {
        const cull::Verdict verdict = cull::classify(view.frustum, bound);
        if (verdict == cull::Verdict::outside) return Visit::skip;
        return verdict == cull::Verdict::inside ? Visit::take : Visit::descend;
    };
    const std::size_t tests = tree.visit(test, [&](ItemId item) { ids.push_back(item); });
    std::sort(ids.begin(), ids.end());
    return tests;
}

}  // namespace crofton::study
