// SPDX-License-Identifier: MIT
// The answer to a query, in buffers that are kept from frame to frame.
#pragma once
#include <crofton/boxtree/layout.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/cull/classify.hpp>
#include <crofton/cull/statistics.hpp>
#include <crofton/cull/verdict_bits.hpp>
#include <cstdint>
#include <span>

namespace crofton::cull {

class VisibleSet {
  public:
    // The items seen, each once: in ResultOrder::ascending by id; in ResultOrder::tree in an order that depends on tree
    // and view alone: those inside first, then those straddling, each part by and large along the tree.
    [[nodiscard]] std::span<const boxtree::ItemId> ids() const { return std::span(ids_).first(size_); }
    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] std::size_t inside_count() const { return inside_; }
    // In ResultOrder::ascending the verdict of ids()[i] is verdicts()[i]. In ResultOrder::tree there are none: the
    // first inside_count() ids are inside, the others straddle.
    [[nodiscard]] std::span<const Verdict> verdicts() const {
        return std::span(verdicts_).first(verdicts_.empty() ? 0 : size_);
    }
    [[nodiscard]] const Statistics& statistics() const { return statistics_; }

  private:
    friend class Query;
    Vector<boxtree::ItemId> ids_;  // as long as its largest use so far
    Vector<boxtree::ItemId> straddling_;
    Vector<boxtree::ItemId> part_inside_, part_straddling_;
    Vector<std::uint32_t> undecided_;
    Vector<Verdict> verdicts_;
    Vector<std::uint64_t> bits_;
    Vector<std::uint64_t> runs_;
    Vector<std::uint32_t> work_;
    VerdictBits moving_bits_;
    Vector<std::uint32_t> listed_;
    std::size_t size_ = 0, inside_ = 0;
    Statistics statistics_;
};

}  // namespace crofton::cull
