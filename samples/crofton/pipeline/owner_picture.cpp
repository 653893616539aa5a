// SPDX-License-Identifier: MIT
#include "owner_picture.hpp"

#include <algorithm>

namespace crofton::pipeline {
namespace {

// A displayed channel is the square root of the linear one.
float linear(std::uint32_t channel) {
    const float displayed = static_cast<float>(channel) / 255.0f;
    return displayed * displayed;
}

// Black is where nothing is seen.
glm::vec3 color_of(scene::InstanceId instance) {
    const std::uint32_t number = instance + 1;
    return {linear(number & 255u), linear(number >> 8 & 255u), linear(number >> 16 & 255u)};
}

}  // namespace

Result<void> OwnerPicture::draw(render::Rasterizer& rasterizer, std::uint32_t picture, const DrawList& list,
                                const Camera& camera) {
    ranges_.assign(list.ranges().begin(), list.ranges().end());
    transforms_.clear();
    for (std::size_t r = 0; r < ranges_.size(); ++r) {
        const scene::InstanceId instance = list.instance_of(r);
        if (instance >= kMaxInstances)
            return fail(ErrorCode::out_of_range, instance, "owner picture: too many instances for 24 bits");
        render::DrawTransform transform = list.transforms()[ranges_[r].transform];
        render::set_tint(transform, color_of(instance));
        transform.unlit = 1.0f;
        ranges_[r].transform = static_cast<std::uint32_t>(r);
        transforms_.push_back(transform);
    }
    render::Frame frame;
    frame.camera = camera;
    frame.transforms = transforms_;
    frame.ranges = ranges_;
    frame.environment.haze_distance = 0.0f;
    frame.environment.sky = false;
    frame.environment.horizon = glm::vec3(0.0f);
    if (const auto drawn = rasterizer.draw(frame, picture); !drawn) return tl::unexpected(drawn.error());
    if (auto read = rasterizer.read_pixels(image_, picture); !read) return read;
    owners_.clear();
    std::uint32_t last = 0;  // neighbours are alike
    for (std::size_t p = 0; p + 3 < image_.rgba.size(); p += 4) {
        const std::uint32_t number = image_.rgba[p] | static_cast<std::uint32_t>(image_.rgba[p + 1]) << 8 |
                                     static_cast<std::uint32_t>(image_.rgba[p + 2]) << 16;
        if (number == 0 || number == last) continue;
        last = number;
        owners_.push_back(number - 1);
    }
    std::sort(owners_.begin(), owners_.end());
    owners_.erase(std::unique(owners_.begin(), owners_.end()), owners_.end());
    return {};
}

}  // namespace crofton::pipeline
