// SPDX-License-Identifier: MIT
// What a view finds in attached regions.
#pragma once
#include <crofton/cull/cull.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <crofton/world/answers.hpp>

namespace crofton::world {

struct RegionQuery {
    cull::View view;
    cull::CullMode mode = cull::CullMode::exact;
    cull::ResultOrder order = cull::ResultOrder::ascending;
    const cull::DrawLimits* limits = nullptr;
    const occlude::OcclusionBuffer* buffer = nullptr;  // leaves out what it hides
    bool list_occluded = false;
};

// Kept from frame to frame.
struct RegionView {
    // Of regions' objects. In ascending order there are verdicts; else the first inside_count are inside.
    Vector<std::uint32_t> ids, occluded;
    Vector<cull::Verdict> verdicts;
    std::size_t inside_count = 0;
    cull::Statistics statistics;
    occlude::VisibleStatistics asked;  // where there is a buffer

    // Scratch.
    cull::VisibleSet regions, found;
    occlude::VisibleSet not_hidden;
    Vector<std::uint64_t> order;
    Vector<std::uint32_t> straddling;
    Vector<Obb> boxes;
    Vector<std::uint32_t> kept;
    Vector<cull::Verdict> kept_verdicts;

    void clear();
    void add(std::uint32_t id, cull::Verdict verdict, cull::ResultOrder order_asked);
};

// A view's answer of the World's own objects and of regions' objects.
struct WholeView {
    RegionView of_regions;
    Vector<std::uint32_t> ids, occluded;
    Vector<cull::Verdict> verdicts;
    std::size_t inside_count = 0;
    cull::Statistics statistics;
    OcclusionStatistics occlusion;
};

// The same of many views.
struct WholeViews {
    Vector<std::uint32_t> ids, masks;
    Vector<std::uint32_t> object_masks;  // scratch: of one region
};

}  // namespace crofton::world
