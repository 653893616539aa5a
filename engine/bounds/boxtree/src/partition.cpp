// SPDX-License-Identifier: MIT
#include "partition.hpp"

#include <algorithm>
#include <crofton/core/rank.hpp>
#include <utility>

namespace crofton::boxtree {
namespace {

// Unsigned integers in the order of the floats they stand for.
std::uint32_t ordered_bits(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

constexpr std::size_t kUnlimited = ~std::size_t{0};
constexpr std::size_t kFew = 64;  // items that are sorted in one go
// The cost of an item in the passes of a sort and of a cut.
constexpr std::size_t kKeyWork = 4, kDigitWork = 2, kOrderWork = 1, kRateWork = 3, kMarkWork = 1, kPartWork = 2;

}  // namespace

// Visits as many of [at, end) as the work allows, at least one; true at the end.
template <class Visit>
bool Splitter::run_some(std::uint32_t& at, std::uint32_t end, std::size_t cost, std::size_t& work, Visit visit) {
    const std::size_t most = std::max<std::size_t>(work / cost, 1), count = std::min<std::size_t>(end - at, most);
    const std::uint32_t begin = std::exchange(at, at + static_cast<std::uint32_t>(count));
    visit(begin, at);
    visits_ += count;
    work -= std::min(work, count * cost);
    return at == end;
}

void Splitter::start(std::span<const BuildItem> items) {
    begin(items);
    std::size_t work = kUnlimited;
    (void)sort_on(work);
}

void Splitter::begin(std::span<const BuildItem> items) {
    items_ = items;
    for (auto& sorted : sorted_) sorted.reserve(items.size());
    right_.reserve(items.size());
    is_left_.reserve(items.size());
    keys_.reserve(items.size());
    keys_next_.reserve(items.size());
    axis_ = 0;
    pass_ = Pass::keys;
    at_ = 0;
}

bool Splitter::sort_on(std::size_t& work) {
    while (axis_ < 3) {
        if (work == 0) return false;
        if (!sort_pass(work)) continue;
        at_ = 0;
        switch (pass_) {
            case Pass::keys:
                digit_ = 0;
                pass_ = items_.size() <= kFew ? Pass::order : Pass::digits;
                break;
            case Pass::digits:
                if (++digit_ == kDigits) pass_ = Pass::order;
                break;
            case Pass::order:
                ++axis_;
                pass_ = Pass::keys;
        }
    }
    return true;
}

// Works on the current pass of a radix sort by the centres along an axis; true at its end. Equal ones keep their order.
bool Splitter::sort_pass(std::size_t& work) {
    const auto count = static_cast<std::uint32_t>(items_.size());
    const auto digit_of = [this](const Key& key) { return key.value >> digit_ * kDigitBits & (kDigitValues - 1); };
    switch (pass_) {
        case Pass::keys:
            if (at_ == 0) starts_ = {};
            return run_some(at_, count, kKeyWork, work,
                            [&](std::uint32_t begin, std::uint32_t end) { write_keys(begin, end); });
        case Pass::digits: {
            std::array<std::uint32_t, kDigitValues>& starts = starts_[digit_];
            if (at_ == 0) {
                if (starts[digit_of(keys_[0])] == count) return true;
                std::uint32_t sum = 0;
                for (std::uint32_t& start : starts) sum += std::exchange(start, sum);
            }
            const bool done = run_some(at_, count, kDigitWork, work, [&](std::uint32_t begin, std::uint32_t end) {
                for (std::uint32_t i = begin; i < end; ++i) keys_next_[starts[digit_of(keys_[i])]++] = keys_[i];
            });
            if (done) keys_.swap(keys_next_);
            return done;
        }
        default:
            if (count <= kFew)
                std::sort(keys_.begin(), keys_.begin() + count, [](const Key& a, const Key& b) {
                    return a.value != b.value ? a.value < b.value : a.index < b.index;
                });
            return run_some(at_, count, kOrderWork, work, [&](std::uint32_t begin, std::uint32_t end) {
                for (std::uint32_t i = begin; i < end; ++i) sorted_[axis_][i] = keys_[i].index;
            });
    }
}

// Writes items' keys and counts their digits. Clears new memory just before it is needed.
void Splitter::write_keys(std::uint32_t begin, std::uint32_t end) {
    const auto grow = [end](auto& buffer) {
        if (buffer.size() < end) buffer.resize(end);
    };
    grow(sorted_[axis_]);
    grow(keys_);
    grow(keys_next_);
    grow(right_);
    grow(is_left_);
    for (std::uint32_t i = begin; i < end; ++i) {
        const std::uint32_t value = ordered_bits(items_[i].twice_center(axis_));
        keys_[i] = {value, i};
        for (unsigned d = 0; d < kDigits; ++d) ++starts_[d][value >> d * kDigitBits & (kDigitValues - 1)];
    }
}

// The axis along which the centres spread farthest.
unsigned Splitter::longest_axis(Range range) const {
    unsigned best = 0;
    float longest = -1.0f;
    for (unsigned axis = 0; axis < 3; ++axis) {
        const float spread = items_[sorted_[axis][range.end - 1]].twice_center(axis) -
                             items_[sorted_[axis][range.begin]].twice_center(axis);
        if (spread > longest) longest = spread, best = axis;
    }
    return best;
}

// The next part to cut, the largest; false if none is larger than it should be.
bool Splitter::choose_part() {
    Division& d = division_;
    d.largest = 0;
    for (std::uint32_t i = 1; i < d.children.count; ++i)
        if (d.children.ranges[i].size() > d.children.ranges[d.largest].size()) d.largest = i;
    const Range whole = d.children.ranges[d.largest];
    if (whole.size() <= d.capacity) return false;
    d.axis = 0;
    d.at = whole.begin;
    d.least = std::numeric_limits<double>::infinity();
    std::fill_n(d.bounds, kWidth, kNothing);
    d.stage = Stage::rate;
    if (whole.size() > 2 * d.capacity) return true;
    // Where only one cut is possible along each axis, only the axis is chosen.
    d.cut = {longest_axis(whole), d.capacity};
    d.stage = Stage::mark;
    return true;
}

// Bounds the parts along an axis; true once that axis is rated.
bool Splitter::rate_axis(const Cost& cost, std::size_t& work) {
    Division& d = division_;
    const Range whole = d.children.ranges[d.largest];
    const std::uint32_t* const sorted = sorted_[d.axis].data();
    const bool done = run_some(d.at, whole.end, kRateWork, work, [&](std::uint32_t begin, std::uint32_t end) {
        while (begin < end) {
            const std::uint32_t part = (begin - whole.begin) / d.capacity,
                                part_end = std::min(whole.begin + (part + 1) * d.capacity, end);
            BuildItem bounds = d.bounds[part];
            for (; begin < part_end; ++begin) bounds.include(items_[sorted[begin]]);
            d.bounds[part] = bounds;
        }
    });
    if (done) rate_cuts(cost);
    return done;
}

// The best of the cuts at multiples of the capacity, fewer than 16 along each axis.
void Splitter::rate_cuts(const Cost& cost) {
    Division& d = division_;
    const std::uint32_t count = d.children.ranges[d.largest].size(), parts = (count + d.capacity - 1) / d.capacity;
    double right_cost[kWidth];
    BuildItem bounds = kNothing;
    for (std::uint32_t p = parts - 1; p > 0; --p) {
        bounds.include(d.bounds[p]);
        right_cost[p] = cost(bounds) * (count - p * d.capacity);
    }
    bounds = kNothing;
    for (std::uint32_t p = 1; p < parts; ++p) {
        bounds.include(d.bounds[p - 1]);
        const double value = cost(bounds) * (p * d.capacity) + right_cost[p];
        if (value < d.least) d.least = value, d.cut = {d.axis, p * d.capacity};
    }
}

// Notes which items are left of the cut; true once all are noted.
bool Splitter::mark_sides(std::size_t& work) {
    Division& d = division_;
    const Range whole = d.children.ranges[d.largest];
    const std::uint32_t middle = whole.begin + d.cut.left, *const sorted = sorted_[d.cut.axis].data();
    return run_some(d.at, whole.end, kMarkWork, work, [&](std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t i = begin; i < end; ++i) is_left_[sorted[i]] = i < middle ? 1 : 0;
    });
}

// Brings the items left of the cut before the others, in the order along an axis; true once that is done.
bool Splitter::part_axis(std::size_t& work) {
    Division& d = division_;
    const Range whole = d.children.ranges[d.largest];
    std::uint32_t* const sorted = sorted_[d.axis].data();
    const bool done = run_some(d.at, whole.end, kPartWork, work, [&](std::uint32_t begin, std::uint32_t end) {
        // Writes both places and advances one of them, which avoids a branch that cannot be predicted.
        std::uint32_t *left = sorted + d.left, *right = right_.data() + d.right;
        for (std::uint32_t i = begin; i < end; ++i) {
            const std::uint32_t index = sorted[i], is_left = is_left_[index];
            *left = index;
            *right = index;
            left += is_left;
            right += 1 - is_left;
        }
        d.left = static_cast<std::uint32_t>(left - sorted);
        d.right = static_cast<std::uint32_t>(right - right_.data());
    });
    if (done) std::copy_n(right_.data(), d.right, sorted + d.left);
    return done;
}

void Splitter::finish_cut() {
    Children& children = division_.children;
    const std::uint32_t largest = division_.largest;
    const Range whole = children.ranges[largest];
    const std::uint32_t middle = whole.begin + division_.cut.left;
    for (std::uint32_t i = children.count; i > largest + 1; --i) children.ranges[i] = children.ranges[i - 1];
    children.ranges[largest] = {whole.begin, middle};
    children.ranges[largest + 1] = {middle, whole.end};
    ++children.count;
}

void Splitter::take(Range range, const Splitter& from, std::span<const std::uint32_t> indices) {
    for (unsigned axis = 0; axis < 3; ++axis)
        for (std::uint32_t i = 0; i < range.size(); ++i)
            sorted_[axis][range.begin + i] = indices[from.sorted_[axis][i]];
}

Children Splitter::divide(Range range, std::uint32_t unit, const Cost& cost) {
    begin_division(range, unit);
    std::size_t work = kUnlimited;
    (void)divide_on(cost, work);
    return division_.children;
}

void Splitter::begin_division(Range range, std::uint32_t unit) {
    division_.stage = Stage::choose;
    division_.children.count = range.size() > 0 ? 1 : 0;
    division_.children.ranges[0] = range;
    division_.capacity = static_cast<std::uint32_t>(items_a_part(range.size(), unit));
}

bool Splitter::divide_on(const Cost& cost, std::size_t& work) {
    Division& d = division_;
    const auto begin_axis = [&](unsigned axis) {
        const std::uint32_t first = d.children.ranges[d.largest].begin;
        d.axis = axis;
        d.at = d.left = first;
        d.right = 0;
        std::fill_n(d.bounds, kWidth, kNothing);
    };
    for (;;) {
        if (d.stage == Stage::choose && (d.children.count == 0 || !choose_part())) return true;
        if (work == 0) return false;
        switch (d.stage) {
            case Stage::rate:
                if (!rate_axis(cost, work)) break;
                begin_axis((d.axis + 1) % 3);
                if (d.axis == 0) d.stage = Stage::mark;
                break;
            case Stage::mark:
                if (!mark_sides(work)) break;
                begin_axis((d.cut.axis + 1) % 3);
                d.stage = Stage::part;
                break;
            default:
                if (!part_axis(work)) break;
                begin_axis((d.axis + 1) % 3);
                if (d.axis != d.cut.axis) break;
                finish_cut();
                d.stage = Stage::choose;
        }
    }
}

namespace {

float spread_of(const float (&values)[kWidth]) {
    const auto lanes = [&](unsigned first) { return detail::load4(reinterpret_cast<const char*>(values + first)); };
    detail::Lanes4 low = lanes(0), high = low;
    for (unsigned first = 4; first < kWidth; first += 4) {
        low = detail::lesser(lanes(first), low);
        high = detail::larger(lanes(first), high);
    }
    return std::max({float{high[0]}, float{high[1]}, float{high[2]}, float{high[3]}}) -
           std::min({float{low[0]}, float{low[1]}, float{low[2]}, float{low[3]}});
}

}  // namespace

void halve(std::span<BuildItem, kWidth> items) {
    float centers[3][kWidth];
    unsigned widest = 0;
    float most = -1.0f;
    for (unsigned axis = 0; axis < 3; ++axis) {
        for (unsigned i = 0; i < kWidth; ++i) centers[axis][i] = items[i].twice_center(axis);
        const float spread = spread_of(centers[axis]);
        if (spread > most) most = spread, widest = axis;
    }
    std::int32_t along_x[kWidth], along_widest[kWidth];
    detail::rank<kWidth>(centers[0], along_x);
    if (widest != 0) detail::rank<kWidth>(centers[widest], along_widest);
    const std::int32_t* const halves = widest != 0 ? along_widest : along_x;
    std::uint32_t in_order[kWidth];  // along x
    for (unsigned i = 0; i < kWidth; ++i) in_order[static_cast<std::size_t>(along_x[i])] = i;
    std::array<BuildItem, kWidth> result;
    unsigned first = 0, second = kWidth / 2;
    for (const std::uint32_t i : in_order) result[halves[i] < std::int32_t{kWidth / 2} ? first++ : second++] = items[i];
    std::copy(result.begin(), result.end(), items.begin());
}

}  // namespace crofton::boxtree
