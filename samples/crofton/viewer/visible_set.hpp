// SPDX-License-Identifier: MIT
// The cell that the eye is in, and how much of the scene may be seen from it.
#pragma once
#include <crofton/pvs/pvs.hpp>
#include <optional>

#include "json/json.hpp"
#include "pipeline/frame_statistics.hpp"

namespace crofton::viewer {

struct CellSight {
    std::uint32_t cell = pvs::kNoCell;
    pvs::CellKind kind = pvs::CellKind::unknown;
    Aabb box;
    // Objects of the whole scene, whether in view or not.
    std::uint64_t seen = 0, unseen = 0, hidden = 0;
};
[[nodiscard]] Json to_json(const CellSight& sight);

// Returns the cell of the camera that culled the frame; nothing without sets, in no cell, or in a solid one.
[[nodiscard]] std::optional<CellSight> look_up(const pvs::Pvs* pvs, const pipeline::FrameStatistics& frame);

}  // namespace crofton::viewer
