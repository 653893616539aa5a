// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/cull.hpp>
#include <cstdio>

#include "certificate.hpp"
#include "straddlers.hpp"
#include "topics.hpp"

namespace crofton::cli {
namespace {

constexpr std::size_t kBatch = 2048;  // bounds per view

struct CullCounts {
    std::uint64_t meeting = 0, disjoint = 0, unproved = 0, false_culls = 0, false_accepts = 0,
                  false_culls_conservative = 0, disagreements = 0;
};

// Only boxes have a tree; its verdicts where there is one.
std::vector<cull::Verdict> tree_verdicts(const std::vector<Obb>& boxes, const cull::View& view) {
    std::vector<cull::Verdict> verdicts(boxes.size(), cull::Verdict::outside);
    const auto tree = boxtree::BoxTree::build(boxes);
    cull::VisibleSet visible;
    cull::find_visible(*tree, view, visible);
    for (std::size_t n = 0; n < visible.size(); ++n) verdicts[visible.ids()[n]] = visible.verdicts()[n];
    return verdicts;
}
template <class Bound>
std::vector<cull::Verdict> tree_verdicts(const std::vector<Bound>&, const cull::View&) {
    return {};
}

// One view, many bounds: the list's vectors, alone and with a second view, the tree and the single test must agree, and
// the proofs judge them.
template <class Bound>
void run_batch(Straddlers& straddlers, std::size_t count, CullCounts& counts) {
    const auto frustum = frustum_of(straddlers.camera());
    const auto corners = frustum_corners(*frustum);
    std::vector<Bound> bounds(count);
    for (Bound& bound : bounds) straddlers.make(*frustum, *corners, bound);
    const cull::View view{*frustum};
    cull::BoundSet<Bound> set;
    set.assign(bounds);
    cull::VerdictBits exact, conservative;
    cull::find_visible(set, bounds, view, exact);
    cull::find_visible(set, bounds, view, conservative, cull::CullMode::conservative);
    std::vector<std::uint32_t> masks(count);
    const std::array<cull::View, 2> views{cull::View{*frustum_of(straddlers.camera())}, view};
    (void)cull::find_visible(set, bounds, {}, views, masks);
    const std::vector<cull::Verdict> of_tree = tree_verdicts(bounds, view);
    for (std::size_t i = 0; i < count; ++i) {
        const cull::Verdict verdict = cull::classify(*frustum, bounds[i]);
        if (verdict != exact.verdict(i) || (!of_tree.empty() && verdict != of_tree[i]) ||
            (verdict != cull::Verdict::outside) != (masks[i] >> 1 & 1) ||
            cull::classify(*frustum, bounds[i], cull::CullMode::conservative) != conservative.verdict(i))
            ++counts.disagreements;
        switch (prove(*frustum, bounds[i])) {
            case Proof::meets:
                ++counts.meeting;
                counts.false_culls += verdict == cull::Verdict::outside;
                counts.false_culls_conservative += conservative.verdict(i) == cull::Verdict::outside;
                break;
            case Proof::disjoint:
                ++counts.disjoint;
                counts.false_accepts += verdict != cull::Verdict::outside;
                break;
            default:
                ++counts.unproved;
                break;
        }
    }
}

template <class Bound>
void add_rows(const char* kind, double offset, const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    Straddlers straddlers(options.seed, offset);
    CullCounts counts;
    for (std::uint64_t done = 0; done < options.trials; done += kBatch)
        run_batch<Bound>(straddlers, static_cast<std::size_t>(std::min<std::uint64_t>(kBatch, options.trials - done)),
                         counts);
    char where[64];
    std::snprintf(where, sizeof where, "at camera offset %g, 1 um to 1 m deep", offset);
    const auto none = [&](const std::string& what, std::uint64_t cases, std::uint64_t measured) {
        rows.push_back(none_row(std::string(kind) + ": " + what + " " + where, "docs/notes/cull.md", cases, measured));
    };
    none("of " + std::to_string(counts.meeting) + " proved visible none is culled,", counts.meeting,
         counts.false_culls);
    none("of the same none is culled in the conservative mode,", counts.meeting, counts.false_culls_conservative);
    none("of " + std::to_string(counts.disjoint) + " proved invisible none is accepted in the exact mode,",
         counts.disjoint, counts.false_accepts);
    none("vectors, tree and single test give equal verdicts", options.trials, counts.disagreements);
    none("every one is proved visible or invisible", options.trials, counts.unproved);
}

}  // namespace

std::vector<VerifyRow> verify_cull(const VerifyOptions& options) {
    std::vector<VerifyRow> rows;
    for (const double offset : {0.0, 1e4, 1e5, 1e6, 1e7}) {
        add_rows<Obb>("boxes", offset, options, rows);
        add_rows<Aabb>("axis-aligned boxes", offset, options, rows);
        add_rows<Sphere>("spheres", offset, options, rows);
    }
    return rows;
}

}  // namespace crofton::cli
