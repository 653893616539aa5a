// SPDX-License-Identifier: MIT
#include "space_order.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <crofton/collide/box_block.hpp>
#include <crofton/geometry/finite.hpp>
#include <glm/common.hpp>
#include <utility>

namespace crofton::collide {
namespace {

constexpr std::size_t kSamples = 256;
constexpr std::size_t kMiddleSamples = 64;  // taken in every update
constexpr int kMortonBits = 9;              // per axis
constexpr int kClassBits = 3;
constexpr std::size_t kChunk = 4096;  // of the curve that is arranged anew

// Boxes beyond are invalid, and differences of theirs may be infinite.
bool is_ordered(const Obb& box) {
    return is_in_range(box.center) && is_finite(glm::dvec3(box.half_extents));
}

// Values of `measure` over an even sample of the boxes that have a place; empty when there are none.
template <class Values, class Measure>
void sample(std::span<const Obb> boxes, std::size_t count, Values& values, Measure measure) {
    values.clear();
    const std::size_t step = std::max<std::size_t>(1, boxes.size() / count);
    for (std::size_t i = 0; i < boxes.size() && values.size() < count; i += step)
        if (is_ordered(boxes[i])) values.push_back(measure(boxes[i]));
}

template <class Values, class Measure>
void sorted_sample(std::span<const Obb> boxes, Values& values, Measure measure) {
    sample(boxes, kSamples, values, measure);
    std::sort(values.begin(), values.end());
}

double size_of(const Obb& box) {
    return static_cast<double>(box.half_extents.x) + static_cast<double>(box.half_extents.y) +
           static_cast<double>(box.half_extents.z);
}

std::uint32_t spread_bits(std::uint32_t x) {
    x = (x | x << 16) & 0x030000ffu;
    x = (x | x << 8) & 0x0300f00fu;
    x = (x | x << 4) & 0x030c30c3u;
    return (x | x << 2) & 0x09249249u;
}

struct FixedSample {
    std::array<double, kSamples> values;
    std::size_t count = 0;
    void clear() { count = 0; }
    void push_back(double value) { values[count++] = value; }
    [[nodiscard]] std::size_t size() const { return count; }
    auto begin() { return values.begin(); }
    auto end() { return values.begin() + static_cast<std::ptrdiff_t>(count); }
};

}  // namespace

glm::dvec3 middle_of(std::span<const Obb> boxes) {
    glm::dvec3 middle(0.0);
    FixedSample values;
    for (int i = 0; i < 3; ++i) {
        sample(boxes, kMiddleSamples, values, [&](const Obb& box) { return box.center[i]; });
        if (values.count == 0) break;
        const auto median = values.begin() + static_cast<std::ptrdiff_t>(values.count / 2);
        std::nth_element(values.begin(), median, values.end());
        middle[i] = std::clamp(*median, -kMaxCoordinate, kMaxCoordinate);
    }
    return middle;
}

void SpaceOrder::sort(std::span<const Obb> boxes) {
    FixedSample values;
    glm::dvec3 low(0.0), scale(0.0);
    constexpr double kCells = 1 << kMortonBits;
    for (int i = 0; i < 3; ++i) {
        sorted_sample(boxes, values, [&](const Obb& box) { return box.center[i]; });
        if (values.count == 0) break;
        // Between the 2nd and the 98th percentile, widened to hold an even spread: a few far boxes share the outermost
        // cells.
        const double from = values.values[values.count / 50], to = values.values[values.count - 1 - values.count / 50];
        const double margin = 0.025 * (to - from);
        low[i] = from - margin;
        scale[i] = to > from ? kCells / (to - from + 2.0 * margin) : 0.0;
    }
    sorted_sample(boxes, values, size_of);
    const double median = values.count > 0 ? values.values[values.count / 2] : 1.0;

    keyed_.clear();
    keyed_.reserve(boxes.size());
    for (std::size_t n = 0; n < boxes.size(); ++n) {
        const Obb& box = boxes[n];
        if (!is_ordered(box)) continue;
        std::uint32_t cell[3];
        for (int i = 0; i < 3; ++i)
            cell[i] = static_cast<std::uint32_t>(std::clamp((box.center[i] - low[i]) * scale[i], 0.0, kCells - 1.0));
        double limit = 4.0 * median;
        std::uint32_t size_class = 0;
        for (const double size = size_of(box); size >= limit && size_class + 1 < (1u << kClassBits); limit *= 4.0)
            ++size_class;
        const std::uint32_t key = size_class << (3 * kMortonBits) | spread_bits(cell[2]) << 2 |
                                  spread_bits(cell[1]) << 1 | spread_bits(cell[0]);
        keyed_.push_back({key, static_cast<std::uint32_t>(n)});
    }
    other_.resize(keyed_.size());
    constexpr int kDigit = 10;  // three passes make the 30 bits
    for (int shift = 0; shift < 30; shift += kDigit) {
        std::array<std::uint32_t, 1u << kDigit> place{};
        const auto digit = [shift](const Keyed& k) { return k.key >> shift & ((1u << kDigit) - 1u); };
        for (const Keyed& k : keyed_) ++place[digit(k)];
        std::uint32_t sum = 0;
        for (std::uint32_t& p : place) sum += std::exchange(p, sum);
        for (const Keyed& k : keyed_) other_[place[digit(k)]++] = k;
        std::swap(keyed_, other_);
    }
    items_.resize(keyed_.size());
    for (std::size_t begin = 0; begin < keyed_.size(); begin += kChunk) {
        const std::size_t count = std::min(kChunk, keyed_.size() - begin);
        arrange({keyed_.data() + begin, count}, boxes, low, {items_.data() + begin, count});
    }
}

// Halves ranges along the axis in which their centres spread most, down to a leaf: squarer leaves than the curve's,
// which jumps. Cuts are at powers of two, so that blocks of every level hold whole subtrees.
void SpaceOrder::arrange(std::span<const Keyed> chunk, std::span<const Obb> boxes, const glm::dvec3& origin,
                         std::span<std::uint32_t> items) {
    struct Place {
        float center[3];
        std::uint32_t item;
    };
    struct Range {
        std::size_t begin, end;
    };
    std::array<Place, kChunk> places;
    for (std::size_t n = 0; n < chunk.size(); ++n) {
        const Obb& box = boxes[chunk[n].item];
        places[n].item = chunk[n].item;
        for (int i = 0; i < 3; ++i) places[n].center[i] = static_cast<float>(box.center[i] - origin[i]);
    }
    std::array<Range, 32> stack;
    std::size_t height = 0;
    stack[height++] = {0, chunk.size()};
    while (height > 0) {
        const Range range = stack[--height];
        if (range.end - range.begin <= kBoxBlock) continue;
        const auto begin = places.begin() + static_cast<std::ptrdiff_t>(range.begin);
        const auto end = places.begin() + static_cast<std::ptrdiff_t>(range.end);
        std::size_t axis = 0;
        float widest = -1.0f;
        for (std::size_t i = 0; i < 3; ++i) {
            float least = begin->center[i], most = least;
            for (auto p = begin; p != end; ++p) {
                least = std::min(least, p->center[i]);
                most = std::max(most, p->center[i]);
            }
            if (most - least > widest) widest = most - least, axis = i;
        }
        const std::size_t cut = range.begin + std::bit_floor(range.end - range.begin - 1);
        std::nth_element(
            begin, places.begin() + static_cast<std::ptrdiff_t>(cut), end, [axis](const Place& a, const Place& b) {
                return a.center[axis] < b.center[axis] || (a.center[axis] == b.center[axis] && a.item < b.item);
            });
        stack[height++] = {range.begin, cut};
        stack[height++] = {cut, range.end};
    }
    for (std::size_t n = 0; n < chunk.size(); ++n) items[n] = places[n].item;
}

}  // namespace crofton::collide
