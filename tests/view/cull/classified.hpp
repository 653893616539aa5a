// SPDX-License-Identifier: MIT
// What every structure must answer: classify's verdict, box by box. Tests compare on each instruction set in turn.
#pragma once
#include <hwy/targets.h>
#include <bit>
#include <crofton/cull/cull.hpp>
#include <span>
#include <vector>

#include "../../ranges.hpp"

namespace crofton::testing {

struct Classified {
    std::vector<cull::ItemId> ids;  // ascending
    std::vector<cull::Verdict> verdicts;

    // Of boxes in the view's layers; `layers` may be empty: in all.
    Classified(std::span<const Obb> boxes, std::span<const std::uint32_t> layers, const cull::View& view,
               cull::CullMode mode = cull::CullMode::exact) {
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            if (!layers.empty() && !(layers[i] & view.layer_mask)) continue;
            const cull::Verdict verdict = cull::classify(view.frustum, boxes[i], mode);
            if (verdict == cull::Verdict::outside) continue;
            ids.push_back(static_cast<cull::ItemId>(i));
            verdicts.push_back(verdict);
        }
    }
    [[nodiscard]] std::size_t inside_count() const {
        return static_cast<std::size_t>(test::ranges::count(verdicts, cull::Verdict::inside));
    }
    [[nodiscard]] bool is_answer(const cull::VisibleSet& visible) const {
        return test::ranges::equal(visible.ids(), ids) && test::ranges::equal(visible.verdicts(), verdicts) &&
               visible.inside_count() == inside_count();
    }
    // The same ids in any order.
    [[nodiscard]] bool are_ids(std::span<const cull::ItemId> found) const {
        std::vector<cull::ItemId> sorted(found.begin(), found.end());
        test::ranges::sort(sorted);
        return sorted == ids;
    }
    [[nodiscard]] bool are_ids_of_view(const cull::MaskedVisibleSet& many, unsigned view) const {
        std::vector<cull::ItemId> found;
        for (std::size_t i = 0; i < many.size(); ++i)
            if (many.view_mask(i) >> view & 1u) found.push_back(many.ids()[i]);
        return are_ids(found);
    }
};

// One of the instruction sets that this processor has, by the trial's number, until the end of the scope.
class TargetInTurn {
  public:
    explicit TargetInTurn(int trial) {
        const std::int64_t all = hwy::SupportedTargets();
        std::int64_t rest = all;
        for (int i = trial % std::popcount(static_cast<std::uint64_t>(all)); i > 0; --i) rest &= rest - 1;
        hwy::SetSupportedTargetsForTest(rest & -rest);
    }
    TargetInTurn(const TargetInTurn&) = delete;
    TargetInTurn& operator=(const TargetInTurn&) = delete;
    ~TargetInTurn() { hwy::SetSupportedTargetsForTest(0); }
};

}  // namespace crofton::testing
