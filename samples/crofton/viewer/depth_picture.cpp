// SPDX-License-Identifier: MIT
#include "depth_picture.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace crofton::viewer {
namespace {

// Along the view: 1 / w in perspective; a parallel view stores minus the distance.
double distance_of(float nearness, bool perspective) {
    const auto value = static_cast<double>(nearness);
    return perspective ? 1.0 / value : -value;
}

}  // namespace

std::uint32_t depth_color(double share) {
    // From a warm white over orange to a dark red, in steps that the eye tells apart.
    constexpr double kStops[][3] = {{255, 246, 214}, {250, 190, 90}, {214, 96, 50}, {132, 40, 52}, {56, 16, 34}};
    const double at = std::clamp(share, 0.0, 1.0) * 4.0;
    const auto stop = std::min(static_cast<std::size_t>(at), std::size_t{3});
    const double part = at - static_cast<double>(stop);
    std::uint32_t color = 0xff000000;
    for (std::size_t k = 0; k < 3; ++k) {
        const double value = kStops[stop][k] + part * (kStops[stop + 1][k] - kStops[stop][k]);
        color |= static_cast<std::uint32_t>(std::lround(value)) << (8 * k);
    }
    return color;
}

void paint_depth(const occlude::OcclusionBuffer& buffer, DepthPicture& picture) {
    const occlude::BufferSize size = buffer.size();
    const bool perspective = buffer.view().perspective;
    picture.width = size.width;
    picture.height = size.height;
    picture.rgba.assign(std::size_t{size.width} * size.height, kOpenColor);
    std::vector<float> nearness(picture.rgba.size());
    buffer.read(nearness);
    double low = std::numeric_limits<double>::infinity(), high = -low;
    std::size_t covered = 0;
    for (const float value : nearness) {
        if (value <= occlude::OcclusionBuffer::kUncovered) continue;
        ++covered;
        low = std::min(low, distance_of(value, perspective));
        high = std::max(high, distance_of(value, perspective));
    }
    picture.covered = static_cast<double>(covered) / static_cast<double>(nearness.size());
    picture.nearest = covered > 0 ? low : 0.0;
    picture.farthest = covered > 0 ? high : 0.0;
    const double base = std::max(low, 1e-6), range = std::log(std::max(high / base, 1.0 + 1e-9));
    for (std::uint32_t y = 0; y < size.height; ++y)
        for (std::uint32_t x = 0; x < size.width; ++x) {
            const float value = nearness[std::size_t{y} * size.width + x];
            if (value <= occlude::OcclusionBuffer::kUncovered) continue;
            const double share = std::log(std::max(distance_of(value, perspective) / base, 1.0)) / range;
            picture.rgba[std::size_t{size.height - 1 - y} * size.width + x] = depth_color(share);
        }
}

}  // namespace crofton::viewer
