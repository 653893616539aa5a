// SPDX-License-Identifier: MIT
// Drawing for `crofton frames`: each frame, the same frame without hidden objects, and the owner of each pixel.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/render/device.hpp>
#include <crofton/render/rasterizer.hpp>
#include <memory>

#include "frames_output.hpp"
#include "pipeline/draw_list.hpp"
#include "pipeline/frame_statistics.hpp"
#include "pipeline/owner_picture.hpp"
#include "pipeline/verify.hpp"

namespace crofton::cli {

class FramesDrawing {
  public:
    // The list must outlive it. `haze`: RenderEnvironment's distance. `occlusion`: frames are drawn both ways. Errors:
    // unavailable where there is no Vulkan driver; Vulkan's.
    [[nodiscard]] static Result<std::unique_ptr<FramesDrawing>> create(pipeline::DrawList& list, const ImageSize& size,
                                                                       double haze, bool occlusion);

    // To be called when the list has other meshes.
    [[nodiscard]] Result<void> upload_geometry();

    // Fills gpu, triangles_clipped and draw_us of the frame, and of its occlusion where it has one.
    [[nodiscard]] Result<void> draw(pipeline::FrameStatistics& frame);
    // The picture of the last frame, without what is hidden.
    [[nodiscard]] Result<const render::Image*> picture();

    // Fills `seen` of the last frame, by the colours of a picture, if the device supports it. Takes as long as draw()
    // and is not part of its time.
    [[nodiscard]] Result<void> find_seen(pipeline::FrameStatistics& frame);
    // Returns the owners of pixels of the last frame, and how many pixels differ between the two pictures. Requires
    // occlusion, and a call of find_seen() before.
    [[nodiscard]] Result<pipeline::BothOwners> find_owners(const pipeline::FrameStatistics& frame);
    [[nodiscard]] Result<std::uint64_t> count_changed_pixels();

    [[nodiscard]] const render::Device& device() const { return device_; }

  private:
    FramesDrawing(pipeline::DrawList& list, render::Device device, double haze)
        : list_(list), device_(std::move(device)), haze_(haze) {}
    // Draws what is visible in `columns`, the frame's or its `occlusion`'s, and writes the cost there.
    template <class Columns>
    [[nodiscard]] Result<void> draw(Columns& columns, const Camera& camera, std::uint32_t picture);

    pipeline::DrawList& list_;
    render::Device device_;
    std::optional<render::Rasterizer> rasterizer_;
    double haze_;
    render::Image image_, other_image_;
    pipeline::OwnerPicture owners_of_shown_, owners_of_all_;
};

}  // namespace crofton::cli
