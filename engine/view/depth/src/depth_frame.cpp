// SPDX-License-Identifier: MIT
#include "depth_frame.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace crofton::depth {
namespace {

// Where Vulkan's sample lies in its pixel ("Standard sample locations"), with y up.
glm::vec2 standard_sample(std::uint32_t samples, std::uint32_t sample) {
    struct Sixteenths {
        std::uint8_t right, down;
    };
    static constexpr Sixteenths kPlaces[][8] = {
        {{8, 8}},
        {{12, 12}, {4, 4}},
        {{6, 2}, {14, 6}, {2, 10}, {10, 14}},
        {{9, 5}, {7, 11}, {13, 9}, {5, 3}, {3, 13}, {1, 7}, {11, 15}, {15, 1}},
    };
    const Sixteenths place = kPlaces[std::countr_zero(samples)][sample];
    return {static_cast<float>(place.right) / 16.0f, static_cast<float>(16 - place.down) / 16.0f};
}

}  // namespace

void DepthFrame::set(std::span<const DepthObject> objects, const PictureView& view, std::uint32_t sample,
                     std::span<const float> floors, Executor& executor) {
    objects_ = objects;
    floors_ = floors;
    set_picture(view, sample);
    perspective_ = std::any_of(objects.begin(), objects.end(), [](const DepthObject& o) {
        return o.to_clip[0][3] != 0.0f || o.to_clip[1][3] != 0.0f || o.to_clip[2][3] != 0.0f;
    });
    projections_.resize(objects.size());
    constexpr std::size_t kGrain = 1024;
    executor.parallel_for(objects.size(), kGrain, [&](std::size_t begin, std::size_t end, unsigned) {
        project_objects(picture_, objects.data() + begin, end - begin, projections_.data() + begin);
    });
    sort();
}

void DepthFrame::set_picture(const PictureView& view, std::uint32_t sample) {
    picture_.tiles.width = view.width, picture_.tiles.height = view.height;
    picture_.half_width = 0.5f * static_cast<float>(view.width);
    picture_.half_height = 0.5f * static_cast<float>(view.height);
    const glm::vec2 at = standard_sample(view.samples, sample);
    picture_.middle_x = picture_.half_width + (0.5f - at.x), picture_.middle_y = picture_.half_height + (0.5f - at.y);
    const bool reversed = view.depth == DepthRange::reversed_zero_to_one;
    picture_.near_share = view.depth == DepthRange::zero_to_one ? 0.0f : 1.0f;
    picture_.infinitely_far = reversed ? 0.0f : -1.0f;
    picture_.z_sign = reversed ? 1.0f : -1.0f;
    // Half a step of the grid, and the rounding of three operations on numbers up to the picture's size.
    picture_.grid = 0x1p-9f + 0x1p-21f * static_cast<float>(std::max(view.width, view.height));
}

std::uint32_t DepthFrame::bin_of(const Projection& p) const {
    const bool by_w = perspective_ || p.is_unclear();
    const float distance = by_w ? p.least_w : std::max(picture_.near_share - p.nearest, 0.0f);
    constexpr std::int32_t kFirst = std::bit_cast<std::int32_t>(0x1p-20f) >> 19;
    const std::int32_t bin = (std::bit_cast<std::int32_t>(distance) >> 19) - kFirst;
    return static_cast<std::uint32_t>(std::clamp(bin, 0, static_cast<std::int32_t>(kBins) - 1));
}

void DepthFrame::sort() {
    starts_.fill(0);
    unplaced_.clear();
    for (std::uint32_t i = 0; i < projections_.size(); ++i) {
        if (!projections_[i].covers_nothing())
            ++starts_[bin_of(projections_[i]) + 1];
        else if (projections_[i].least_w < 0.0f)
            unplaced_.push_back(i);
    }
    std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
    order_.resize(starts_.back());
    std::array<std::uint32_t, kBins> next;
    std::copy_n(starts_.begin(), kBins, next.begin());
    for (std::uint32_t i = 0; i < projections_.size(); ++i)
        if (!projections_[i].covers_nothing()) order_[next[bin_of(projections_[i])]++] = i;
}

ObjectData DepthFrame::data_of(std::uint32_t i) const {
    const DepthObject& object = objects_[i];
    ObjectData data{};
    for (glm::length_t r = 0; r < 4; ++r) {
        const float sign = r == 2 ? picture_.z_sign : 1.0f;
        for (glm::length_t c = 0; c < 4; ++c) data.columns[c][r] = sign * object.to_clip[c][r];
        for (int c = 0; c < 3; ++c) data.moved[r] += std::abs(data.columns[c][r]);
        data.moved[r] *= object.position_error;
    }
    data.one_sided = object.one_sided;
    data.hides = object.hides;
    return data;
}

}  // namespace crofton::depth
