// SPDX-License-Identifier: MIT
#include "visible_set.hpp"

namespace crofton::viewer {

Json to_json(const CellSight& sight) {
    constexpr const char* kKinds[] = {"unknown", "solid", "inner", "open"};
    return {{"cell", sight.cell},
            {"kind", kKinds[static_cast<std::size_t>(sight.kind)]},
            {"seen", sight.seen},
            {"unseen", sight.unseen},
            {"hidden", sight.hidden}};
}

std::optional<CellSight> look_up(const pvs::Pvs* pvs, const pipeline::FrameStatistics& frame) {
    if (pvs == nullptr) return std::nullopt;
    CellSight sight;
    sight.cell = pvs->find_cell(frame.camera.position);
    if (sight.cell == pvs::kNoCell) return std::nullopt;
    sight.kind = pvs->kind(sight.cell);
    sight.box = pvs->cells().box(sight.cell);
    for (std::uint32_t o = 0; o < pvs->object_count(); ++o) {
        if (!pvs->is_baked(o)) continue;
        const pvs::PairState state = pvs->state(sight.cell, o);
        ++(state == pvs::PairState::seen ? sight.seen : state == pvs::PairState::unseen ? sight.unseen : sight.hidden);
    }
    return sight;
}

}  // namespace crofton::viewer
