// SPDX-License-Identifier: MIT
#include "frames_drawing.hpp"

#include <chrono>
#include <cstring>
#include <utility>

namespace crofton::cli {
namespace {

using Clock = std::chrono::steady_clock;

// The rasterizer's pictures: what is shown, the owners of pixels, and with occlusion all that is visible.
constexpr std::uint32_t kShown = 0, kOwners = 1, kAll = 2;

}  // namespace

Result<std::unique_ptr<FramesDrawing>> FramesDrawing::create(pipeline::DrawList& list, const ImageSize& size,
                                                             double haze, bool occlusion) {
    auto device = render::Device::create();
    if (!device) return device.error();
    std::unique_ptr<FramesDrawing> drawing(new FramesDrawing(list, std::move(*device), haze));
    auto rasterizer = render::Rasterizer::create(drawing->device_, {.width = size.width, .height = size.height});
    if (!rasterizer) return rasterizer.error();
    for (const std::uint32_t picture : {kOwners, kAll}) {
        if (picture == kAll && !occlusion) continue;
        if (auto made = rasterizer->resize(size.width, size.height, picture); !made) return made.error();
    }
    drawing->rasterizer_.emplace(std::move(*rasterizer));
    if (auto set = drawing->upload_geometry(); !set) return set.error();
    return drawing;
}

Result<void> FramesDrawing::upload_geometry() {
    return rasterizer_->set_geometry(list_.vertices(), list_.indices());
}

template <class Columns>
Result<void> FramesDrawing::draw(Columns& columns, const Camera& camera, std::uint32_t picture) {
    const auto start = Clock::now();
    if constexpr (std::is_same_v<Columns, pipeline::OccludedFrame>)
        list_.select(columns, camera);
    else
        list_.select(columns.visible_ids, camera);
    render::Frame frame;
    frame.camera = camera;
    frame.transforms = list_.transforms();
    frame.ranges = list_.ranges();
    frame.environment.haze_distance = static_cast<float>(haze_);
    const auto counters = rasterizer_->draw(frame, picture);
    if (!counters) return counters.error();
    columns.gpu = *counters;
    columns.draw_us = std::chrono::duration<double, std::micro>(Clock::now() - start).count();
    columns.triangles_clipped = list_.predict_clipped();
    return {};
}

// With occlusion either picture comes first in turn: the second finds warm caches.
Result<void> FramesDrawing::draw(pipeline::FrameStatistics& frame) {
    if (!frame.occlusion) return draw(frame, frame.camera, kShown);
    const bool all_first = frame.index % 2 == 0;
    for (const bool all : {all_first, !all_first}) {
        auto drawn = all ? draw(frame, frame.camera, kAll) : draw(*frame.occlusion, frame.camera, kShown);
        if (!drawn) return drawn;
    }
    return {};
}

Result<const render::Image*> FramesDrawing::picture() {
    if (auto read = rasterizer_->read_pixels(image_, kShown); !read) return read.error();
    return &image_;
}

Result<void> FramesDrawing::find_seen(pipeline::FrameStatistics& frame) {
    if (frame.occlusion)
        list_.select(*frame.occlusion, frame.camera);
    else
        list_.select(frame.visible_ids, frame.camera);
    if (auto drawn = owners_of_shown_.draw(*rasterizer_, kOwners, list_, frame.camera); !drawn)
        return drawn.error().code == ErrorCode::unsupported ? Result<void>{} : drawn;
    frame.seen = pipeline::Seen{owners_of_shown_.instances().size(), owners_of_shown_.triangles().size()};
    return {};
}

Result<pipeline::BothOwners> FramesDrawing::find_owners(const pipeline::FrameStatistics& frame) {
    list_.select(frame.visible_ids, frame.camera);
    if (auto drawn = owners_of_all_.draw(*rasterizer_, kOwners, list_, frame.camera); !drawn) return drawn.error();
    return pipeline::BothOwners{owners_of_all_.triangles(), owners_of_shown_.triangles()};
}

Result<std::uint64_t> FramesDrawing::count_changed_pixels() {
    if (auto read = rasterizer_->read_pixels(image_, kShown); !read) return read.error();
    if (auto read = rasterizer_->read_pixels(other_image_, kAll); !read) return read.error();
    std::uint64_t changed = 0;
    for (std::size_t p = 0; p < image_.rgba.size(); p += 4)
        changed += std::memcmp(&image_.rgba[p], &other_image_.rgba[p], 4) != 0;
    return changed;
}

}  // namespace crofton::cli
