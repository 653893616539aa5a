// SPDX-License-Identifier: MIT
// All pairs of boxes, frame after frame: against every pair asked by itself.
#include <algorithm>
#include <crofton/collide/broadphase.hpp>
#include <oracle/exact_boxes.hpp>
#include <span>
#include <vector>

#include "shapes.hpp"

namespace {

using namespace crofton;
using fuzz::demand;

// Whether the aligned bounds meet, exactly.
bool bounds_meet(const Obb& a, const Obb& b) {
    return oracle::decide([&]<class Number>() {
        for (int i = 0; i < 3; ++i) {
            Number half_size = 0.0;
            for (const Obb* box : {&a, &b})
                for (int k = 0; k < 3; ++k)
                    half_size += Number(double(box->half_extents[k])) * abs(Number(double(box->axes[k][i])));
            if (sgn(Number(abs(Number(Number(a.center[i]) - Number(b.center[i]))) - half_size)) > 0) return false;
        }
        return true;
    });
}

std::vector<IdPair> by_brute_force(const std::vector<Obb>& boxes, const std::vector<collide::CollisionFilter>& filters,
                                   bool exact) {
    std::vector<IdPair> pairs;
    for (std::uint32_t a = 0; a < boxes.size(); ++a)
        for (std::uint32_t b = a + 1; b < boxes.size(); ++b) {
            if (!validate(boxes[a]) || !validate(boxes[b])) continue;
            if (!filters.empty() && !collide::passes(filters[a], filters[b])) continue;
            if (exact ? collide::intersects(boxes[a], boxes[b]) : bounds_meet(boxes[a], boxes[b]))
                pairs.push_back({a, b});
        }
    return pairs;
}

std::vector<IdPair> listed(std::span<const IdPair> pairs) {
    return {pairs.begin(), pairs.end()};
}

void check(const collide::Broadphase& broadphase, const std::vector<Obb>& boxes,
           const std::vector<collide::CollisionFilter>& filters, const std::vector<IdPair>& before) {
    const std::vector<IdPair> now = by_brute_force(boxes, filters, true);
    demand(listed(broadphase.pairs()) == now, "all pairs");
    std::vector<IdPair> began, stayed, ended;
    std::set_difference(now.begin(), now.end(), before.begin(), before.end(), std::back_inserter(began));
    std::set_intersection(now.begin(), now.end(), before.begin(), before.end(), std::back_inserter(stayed));
    std::set_difference(before.begin(), before.end(), now.begin(), now.end(), std::back_inserter(ended));
    demand(listed(broadphase.began()) == began, "pairs that began");
    demand(listed(broadphase.stayed()) == stayed, "pairs that stayed");
    demand(listed(broadphase.ended()) == ended, "pairs that ended");
    std::vector<std::uint32_t> rejected;
    for (std::uint32_t i = 0; i < boxes.size(); ++i)
        if (!validate(boxes[i])) rejected.push_back(i);
    demand(std::equal(rejected.begin(), rejected.end(), broadphase.rejected().begin(), broadphase.rejected().end()),
           "boxes that are refused");
}

}  // namespace

CROFTON_FUZZ(in) {
    collide::Broadphase broadphase;
    std::vector<Obb> boxes = in.boxes(in.flag() ? 6 : 40);
    std::vector<collide::CollisionFilter> filters;
    const bool filtered = in.flag();
    std::vector<IdPair> before;
    for (int frame = 0; frame < 6 && (frame == 0 || in.more()); ++frame) {
        std::vector<std::uint32_t> moved;
        if (frame > 0 && !boxes.empty())
            for (unsigned i = in.below(8); i > 0; --i) {
                const std::uint32_t item = in.byte() % static_cast<std::uint32_t>(boxes.size());
                boxes[item] = in.flag() ? in.box_near(boxes[in.byte() % boxes.size()]) : in.box();
                if (in.below(16) == 1) boxes[item].center[static_cast<int>(in.below(3))] = in.any();
                moved.push_back(item);
            }
        const unsigned kind = in.below(6);
        if (kind == 1) boxes.push_back(in.box());
        if (kind == 2 && !boxes.empty()) boxes.pop_back();
        if (filtered) {
            const std::size_t old = filters.size();
            filters.resize(boxes.size());
            for (std::size_t i = old; i < filters.size(); ++i) filters[i] = {in.layers(), in.layers()};
        }
        const bool moved_alone = in.flag();
        const auto dropped = static_cast<std::uint32_t>(boxes.size());  // the index that a dropped box had
        if (moved_alone && std::erase(moved, dropped) > 0) {
            demand(!broadphase.update_moved(boxes, std::span(&dropped, 1), filters).has_value(),
                   "an item that is no index is refused");
            demand(listed(broadphase.pairs()) == before, "a refusal keeps the pairs");
        }
        const auto result =
            moved_alone ? broadphase.update_moved(boxes, moved, filters) : broadphase.update(boxes, filters);
        demand(result.has_value(), "an update");
        check(broadphase, boxes, filters, before);
        before = listed(broadphase.pairs());
    }
    collide::Broadphase bounds({.exact_boxes = false});
    demand(bounds.update(boxes, filters).has_value(), "an update of bounds");
    demand(listed(bounds.pairs()) == by_brute_force(boxes, filters, false), "pairs of bounds");
}
