// SPDX-License-Identifier: MIT
#include "partition.hpp"

#include <algorithm>

namespace crofton::boxtree {
namespace {

// Unsigned integers in the order of the floats they stand for.
std::uint32_t ordered_bits(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

}  // namespace

void Splitter::start(std::span<const BuildItem> items) {
    items_ = items;
    const auto grow = [&](auto& buffer) {
        if (buffer.size() < items.size()) buffer.resize(items.size());
    };
    grow(right_);
    grow(is_left_);
    grow(keys_);
    grow(keys_next_);
    for (unsigned axis = 0; axis < 3; ++axis) {
        sorted_[axis].resize(items.size());
        sort(axis);
    }
}

// A radix sort by the centres along an axis. Equal ones keep their order.
void Splitter::sort(unsigned axis) {
    constexpr unsigned kDigitBits = 8, kDigits = 4, kDigitValues = 1u << kDigitBits;
    constexpr std::size_t kFew = 64;
    const std::size_t count = items_.size();
    for (std::uint32_t i = 0; i < count; ++i) keys_[i] = {ordered_bits(items_[i].twice_center(axis)), i};
    if (count <= kFew) {
        std::sort(keys_.begin(), keys_.begin() + static_cast<std::ptrdiff_t>(count), [](const Key& a, const Key& b) {
            return a.value != b.value ? a.value < b.value : a.index < b.index;
        });
    } else {
        const auto digit = [](const Key& key, unsigned d) { return key.value >> d * kDigitBits & (kDigitValues - 1); };
        std::uint32_t starts[kDigits][kDigitValues] = {};
        for (std::size_t i = 0; i < count; ++i)
            for (unsigned d = 0; d < kDigits; ++d) ++starts[d][digit(keys_[i], d)];
        for (unsigned d = 0; d < kDigits; ++d) {
            if (starts[d][digit(keys_[0], d)] == count) continue;
            std::uint32_t sum = 0;
            for (std::uint32_t& start : starts[d]) sum += std::exchange(start, sum);
            for (std::size_t i = 0; i < count; ++i) keys_next_[starts[d][digit(keys_[i], d)]++] = keys_[i];
            keys_.swap(keys_next_);
        }
    }
    for (std::size_t i = 0; i < count; ++i) sorted_[axis][i] = keys_[i].index;
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

// The best of the cuts at multiples of `capacity`, fewer than 16 along each axis.
Splitter::Cut Splitter::best_cut(Range range, std::uint32_t capacity, const Cost& cost) const {
    const std::uint32_t count = range.size(), parts = (count + capacity - 1) / capacity;
    // Where only one cut is possible along each axis, only the axis is chosen.
    if (parts == 2) return {longest_axis(range), capacity};
    Cut best;
    double least = std::numeric_limits<double>::infinity();
    for (unsigned axis = 0; axis < 3; ++axis) {
        BuildItem part[kWidth];
        for (std::uint32_t p = 0; p < parts; ++p) {
            const std::uint32_t begin = range.begin + p * capacity, end = std::min(begin + capacity, range.end);
            BuildItem bounds = kNothing;
            for (std::uint32_t i = begin; i < end; ++i) bounds.include(items_[sorted_[axis][i]]);
            part[p] = bounds;
        }
        double right_cost[kWidth];
        BuildItem bounds = kNothing;
        for (std::uint32_t p = parts - 1; p > 0; --p) {
            bounds.include(part[p]);
            right_cost[p] = cost(bounds) * (count - p * capacity);
        }
        bounds = kNothing;
        for (std::uint32_t p = 1; p < parts; ++p) {
            bounds.include(part[p - 1]);
            const double value = cost(bounds) * (p * capacity) + right_cost[p];
            if (value < least) least = value, best = {axis, p * capacity};
        }
    }
    return best;
}

void Splitter::cut(Range range, const Cut& cut) {
    const std::uint32_t middle = range.begin + cut.left;
    for (std::uint32_t i = range.begin; i < range.end; ++i) is_left_[sorted_[cut.axis][i]] = i < middle ? 1 : 0;
    for (unsigned axis = 0; axis < 3; ++axis) {
        if (axis == cut.axis) continue;
        // Writes both places and advances one of them, which avoids a branch that cannot be predicted.
        std::uint32_t* const sorted = sorted_[axis].data();
        std::uint32_t *left = sorted + range.begin, *right = right_.data();
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
            const std::uint32_t index = sorted[i], is_left = is_left_[index];
            *left = index;
            *right = index;
            left += is_left;
            right += 1 - is_left;
        }
        std::copy(right_.data(), right, left);
    }
}

void Splitter::take(Range range, const Splitter& from, std::span<const std::uint32_t> indices) {
    for (unsigned axis = 0; axis < 3; ++axis)
        for (std::uint32_t i = 0; i < range.size(); ++i)
            sorted_[axis][range.begin + i] = indices[from.sorted_[axis][i]];
}

Children Splitter::divide(Range range, std::uint32_t unit, const Cost& cost) {
    Children children;
    if (range.size() == 0) return children;
    const std::uint64_t capacity = items_a_part(range.size(), unit);
    children.ranges[0] = range;
    children.count = 1;
    for (;;) {
        std::uint32_t largest = 0;
        for (std::uint32_t i = 1; i < children.count; ++i)
            if (children.ranges[i].size() > children.ranges[largest].size()) largest = i;
        const Range whole = children.ranges[largest];
        if (whole.size() <= capacity) return children;
        const Cut best = best_cut(whole, static_cast<std::uint32_t>(capacity), cost);
        cut(whole, best);
        for (std::uint32_t i = children.count; i > largest + 1; --i) children.ranges[i] = children.ranges[i - 1];
        children.ranges[largest] = {whole.begin, whole.begin + best.left};
        children.ranges[largest + 1] = {whole.begin + best.left, whole.end};
        ++children.count;
    }
}

void halve(std::span<BuildItem, kWidth> items) {
    // An item's rank is how many centres come before its own; equal ones keep their order.
    std::uint32_t ranks[3][kWidth];
    unsigned widest = 0;
    float most = -1.0f;
    for (unsigned axis = 0; axis < 3; ++axis) {
        float centers[kWidth];
        for (unsigned i = 0; i < kWidth; ++i) {
            centers[i] = items[i].twice_center(axis);
            ranks[axis][i] = 0;
        }
        for (unsigned j = 0; j < kWidth; ++j)
            for (unsigned i = 0; i < kWidth; ++i)
                ranks[axis][i] +=
                    static_cast<std::uint32_t>(centers[j] < centers[i]) |
                    (static_cast<std::uint32_t>(centers[j] == centers[i]) & static_cast<std::uint32_t>(j < i));
        const auto [low, high] = std::minmax_element(centers, centers + kWidth);
        if (*high - *low > most) most = *high - *low, widest = axis;
    }
    std::array<BuildItem, kWidth> along_x;
    std::array<bool, kWidth> is_first;
    for (unsigned i = 0; i < kWidth; ++i) {
        along_x[ranks[0][i]] = items[i];
        is_first[ranks[0][i]] = ranks[widest][i] < kWidth / 2;
    }
    unsigned first = 0, second = kWidth / 2;
    for (unsigned i = 0; i < kWidth; ++i) items[is_first[i] ? first++ : second++] = along_x[i];
}

}  // namespace crofton::boxtree
