// SPDX-License-Identifier: MIT
// The finished sets and what is asked of them.
#include <algorithm>
#include <bit>
#include <cmath>
#include <crofton/core/recovery.hpp>
#include <crofton/pvs/pvs.hpp>

#include "bake_data.hpp"
#include "hidden_pairs.hpp"
#include "shaft.hpp"

namespace crofton::pvs {
namespace {

constexpr std::uint32_t kMaxHalvings = 16;

CellKind kind_of(std::uint32_t flags) {
    if (!(flags & kPassed)) return CellKind::unknown;
    if ((flags & kSolid) && !(flags & kFree)) return CellKind::solid;
    return std::popcount(flags / kFirstEscape) >= kEscapesOfOpen ? CellKind::open : CellKind::inner;
}

bool is_empty(CellKind kind) {
    return kind == CellKind::solid || kind == CellKind::unknown;
}

}  // namespace

Result<Pvs> Pvs::finish(const Bake& bake, std::span<const PlacedOccluder> occluders, const ProofOptions& options,
                        Executor& executor) {
    if (!(options.near_radius >= 0.0) || !std::isfinite(options.near_radius))
        return fail(ErrorCode::invalid_argument, kNoItem, "pvs: near_radius is a length of at least 0");
    if (options.halvings > kMaxHalvings) return fail(ErrorCode::invalid_argument, kNoItem, "pvs: at most 16 halvings");
    return crofton::detail::recover([&]() -> Result<Pvs> {
        const Bake::State& state = bake.data();
        Pvs pvs;
        pvs.cells_ = state.cells;
        pvs.objects_ = state.found.name.objects;
        pvs.geometry_ = state.geometry;
        pvs.epsilon_ = bake.epsilon_reached();
        pvs.confidence_ = state.options.confidence;
        for (const std::uint16_t flags : state.found.flags) pvs.kinds_.push_back(kind_of(flags));
        pvs.baked_ = state.baked;
        pvs.seen_ = state.found.seen;
        pvs.open_.assign(pvs.seen_.size(), ~std::uint64_t{0});
        Vector<Blocker> bodies;
        for (const PlacedOccluder& placed : occluders)
            if (auto body = blocker_of(placed, state.origin)) bodies.push_back(std::move(*body));
        prove_hidden(state, bodies, options, executor, pvs.open_);
        // Cells without eyes see nothing; objects that were not baked are seen from everywhere else.
        const std::size_t words = pvs.words();
        const std::uint64_t in_last =
            pvs.objects_ % 64 ? (std::uint64_t{1} << pvs.objects_ % 64) - 1 : ~std::uint64_t{0};
        for (std::size_t c = 0; c < pvs.kinds_.size(); ++c)
            for (std::size_t w = 0; w < words; ++w) {
                std::uint64_t &seen = pvs.seen_[c * words + w], &open = pvs.open_[c * words + w];
                std::uint64_t kept = w + 1 == words ? in_last : ~std::uint64_t{0};
                if (is_empty(pvs.kinds_[c])) kept = 0;
                seen = (seen | ~pvs.baked_[w]) & kept;
                open = (open | ~pvs.baked_[w]) & kept;
            }
        return pvs;
    });
}

PairState Pvs::state(std::size_t cell, std::uint32_t object) const {
    const std::size_t word = cell * words() + object / 64;
    if (seen_[word] >> (object % 64) & 1) return PairState::seen;
    return open_[word] >> (object % 64) & 1 ? PairState::unseen : PairState::hidden;
}

bool Pvs::is_baked(std::uint32_t object) const {
    return baked_[object / 64] >> (object % 64) & 1;
}

PairCounts Pvs::counts() const {
    PairCounts counts;
    for (std::size_t c = 0; c < kinds_.size(); ++c) {
        if (is_empty(kinds_[c])) continue;
        for (std::uint32_t o = 0; o < objects_; ++o) {
            if (!is_baked(o)) continue;
            const PairState which = state(c, o);
            ++(which == PairState::seen ? counts.seen : which == PairState::unseen ? counts.unseen : counts.hidden);
        }
    }
    return counts;
}

std::uint32_t Pvs::find_cell(const glm::dvec3& eye) const {
    const std::uint32_t cell = cells_.find(eye);
    return cell >= kinds_.size() || is_empty(kinds_[cell]) ? kNoCell : cell;  // kNoCell; or moved from
}

std::span<const std::uint64_t> Pvs::visible_from(std::uint32_t cell, Mode mode) const {
    CROFTON_ASSERT(cell < kinds_.size(), "a cell of these");
    return std::span(mode == Mode::conservative ? open_ : seen_).subspan(cell * words(), words());
}

std::span<const std::uint64_t> Pvs::visible_from(const glm::dvec3& eye, Mode mode) const {
    const std::uint32_t cell = find_cell(eye);
    return cell == kNoCell ? std::span<const std::uint64_t>{} : visible_from(cell, mode);
}

std::uint32_t Pvs::keep_visible(const glm::dvec3& eye, Mode mode, std::span<const std::uint32_t> ids,
                                Vector<std::uint32_t>& kept) const {
    const std::uint32_t cell = find_cell(eye);
    if (cell == kNoCell) {
        kept.assign(ids.begin(), ids.end());
        return cell;
    }
    const std::uint64_t* bits = visible_from(cell, mode).data();
    kept.resize(ids.size());
    std::uint32_t* to = kept.data();
    for (const std::uint32_t id : ids) {
        *to = id;
        to += id >= objects_ || (bits[id / 64] >> (id % 64) & 1);
    }
    kept.resize(static_cast<std::size_t>(to - kept.data()));
    return cell;
}

}  // namespace crofton::pvs
