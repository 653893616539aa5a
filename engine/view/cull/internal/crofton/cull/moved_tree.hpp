// SPDX-License-Identifier: MIT
// A query of a tree whose boxes are stored relative to an origin.
#pragma once
#include <crofton/cull/cull.hpp>
#include <crofton/geometry/move.hpp>

namespace crofton::cull {

// As find_visible() of a tree, with each box moved: exact for the moved boxes. Requires options without limits.
void find_visible(const boxtree::BoxTree& tree, const Move& move, const View& view, VisibleSet& visible,
                  const CullOptions& options = {});

}  // namespace crofton::cull
