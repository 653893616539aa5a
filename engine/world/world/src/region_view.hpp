// SPDX-License-Identifier: MIT
// A view's answer in a World with regions: of its own objects and of theirs.
#pragma once
#include <algorithm>
#include <crofton/cull/cull.hpp>
#include <crofton/cull/moved_tree.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <crofton/world/answers.hpp>
#include <span>

namespace crofton::world {

// A list that is made anew for each view, without writing any value twice.
template <class T>
class AnswerList {
  public:
    void clear() { size_ = 0; }
    // Room for more at the end, to be written.
    [[nodiscard]] T* extend(std::size_t count) {
        if (size_ + count > values_.size()) values_.resize(size_ + count + values_.size() / 2);
        size_ += count;
        return values_.data() + size_ - count;
    }
    void add(std::span<const T> values) { std::copy(values.begin(), values.end(), extend(values.size())); }
    void add(const T& value) { *extend(1) = value; }
    [[nodiscard]] std::span<const T> values() const { return {values_.data(), size_}; }
    [[nodiscard]] std::size_t size() const { return size_; }

  private:
    Vector<T> values_;
    std::size_t size_ = 0;
};

struct RegionQuery {
    cull::View view;
    cull::CullMode mode = cull::CullMode::exact;
    cull::ResultOrder order = cull::ResultOrder::ascending;
    const cull::DrawLimits* limits = nullptr;
    const occlude::OcclusionBuffer* buffer = nullptr;  // leaves out what it hides
    bool list_occluded = false;
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
    cull::MovedTreesQuery query;
    cull::VisibleSet regions, found;
    occlude::VisibleSet not_hidden;
    Vector<std::uint64_t> order;
    AnswerList<std::uint32_t> straddling;  // in tree order, until the end
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
