// SPDX-License-Identifier: MIT
// A view's result in a World with regions: the World's own objects and those of regions.
#pragma once
#include <algorithm>
#include <crofton/cull/cull.hpp>
#include <crofton/cull/moved_tree.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <crofton/world/answers.hpp>
#include <span>

namespace crofton::world {

using cull::AnswerList;
struct Attachment;

struct RegionQuery {
    cull::View view;
    cull::CullMode mode = cull::CullMode::exact;
    cull::ResultOrder order = cull::ResultOrder::ascending;
    const cull::DrawLimits* limits = nullptr;
    const occlude::OcclusionBuffer* buffer = nullptr;  // leaves out what it hides
    bool list_occluded = false;

    [[nodiscard]] bool asks_each() const { return limits != nullptr || buffer != nullptr; }  // single objects
};

// Kept from frame to frame.
struct WholeView {
    // In ascending order there are verdicts; in tree order the first inside_count are inside.
    AnswerList<std::uint32_t> ids, occluded;
    AnswerList<cull::Verdict> verdicts;
    std::size_t inside_count = 0;
    cull::Statistics statistics;
    OcclusionStatistics occlusion;

    // Scratch.
    // Regions that are asked together: all of one's objects are seen, or its tree is walked.
    struct Batch {
        struct Part {
            const Attachment* region = nullptr;
            bool is_whole = false;
        };
        Vector<Part> parts;
        Vector<cull::MovedTreesQuery::Asked> trees;
        std::size_t items = 0;
        void clear() {
            parts.clear();
            trees.clear();
            items = 0;
        }
    };
    cull::MovedTreesQuery query;
    cull::VisibleSet regions;
    occlude::VisibleSet not_hidden;
    // A region that the view sees.
    struct Seen {
        const Attachment* region = nullptr;
        bool is_inside = false;  // as a whole; false may also mean unknown
    };
    Vector<std::uint64_t> pages, inside_pages;  // of regions that the view sees
    Vector<Seen> seen;                          // these regions, in the order of the answer
    Batch batch;
    AnswerList<std::uint32_t> straddling;  // in tree order, until the end
    AnswerList<std::uint32_t> found;       // in one region
    AnswerList<cull::Verdict> found_verdicts;
    Vector<Obb> boxes;
    Vector<std::uint32_t> kept;
    Vector<cull::Verdict> kept_verdicts;

    void clear();
    void add(std::uint32_t id, cull::Verdict verdict, cull::ResultOrder order_asked);
};

// The same of many views.
struct WholeViews {
    Vector<std::uint32_t> ids, masks;
    Vector<std::uint32_t> object_masks;  // scratch: of one region
};

}  // namespace crofton::world
