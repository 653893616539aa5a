// SPDX-License-Identifier: MIT
#include "cull_inputs.hpp"

#include <crofton/boxtree/structure.hpp>
#include <map>

namespace crofton::bench {

const std::vector<Obb>& boxes_of(std::int64_t count) {
    static std::map<std::int64_t, std::vector<Obb>> made;
    auto& boxes = made[count];
    if (boxes.empty()) boxes = bench::crowd(static_cast<std::size_t>(count));
    return boxes;
}

const boxtree::BoxTree& tree_of(std::int64_t count) {
    static std::map<std::int64_t, boxtree::BoxTree> made;
    auto found = made.find(count);
    if (found == made.end()) found = made.emplace(count, *boxtree::BoxTree::build(boxes_of(count))).first;
    return found->second;
}

void report(benchmark::State& state, std::size_t visible) {
    state.counters["visible"] = static_cast<double>(visible);
    state.counters["ns_per_box"] =
        benchmark::Counter(static_cast<double>(state.range(0)) * 1e-9,
                           benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

const std::vector<Obb>& boxes_in_tree_order(std::int64_t count) {
    static std::map<std::int64_t, std::vector<Obb>> made;
    auto& boxes = made[count];
    if (boxes.empty())
        for (const boxtree::ItemId item : tree_of(count).structure().slot_items())
            if (item != boxtree::kNone) boxes.push_back(boxes_of(count)[item]);
    return boxes;
}

}  // namespace crofton::bench
