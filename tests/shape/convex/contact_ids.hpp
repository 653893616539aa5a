// SPDX-License-Identifier: MIT
// The ids of a manifold's points.
#pragma once
#include <crofton/convex/query.hpp>
#include <set>
#include <utility>

namespace crofton::testing {

[[nodiscard]] inline std::set<std::pair<convex::Feature, convex::Feature>> ids(const convex::Manifold& m) {
    std::set<std::pair<convex::Feature, convex::Feature>> result;
    for (int i = 0; i < m.count; ++i) result.insert({m.points[i].on_a, m.points[i].on_b});
    return result;
}

}  // namespace crofton::testing
