// SPDX-License-Identifier: MIT
#include "target.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/render/graphics_pipeline.hpp>

#include "pipelines.hpp"

namespace crofton::render {

Target::~Target() {
    context_->vk.vkDestroyFramebuffer(context_->device, framebuffer, nullptr);
}

Result<void> Target::create(VkRenderPass pass, VkExtent2D size, float share) {
    const std::uint32_t limit = context_->properties.limits.maxImageDimension2D;
    if (size.width == 0 || size.height == 0 || size.width > limit || size.height > limit)
        return fail(ErrorCode::out_of_range, kNoItem,
                    {"picture size ", size.width, "x", size.height, " is not within 1 to ", limit});
    if (!(share > 0.0f && share <= 1.0f))
        return fail(ErrorCode::out_of_range, kNoItem, "a picture's resolution must be above 0 and at most 1");
    extent = size;
    resolution = share;
    const auto shrunk = [share](std::uint32_t side) {
        return std::max(
            1u, static_cast<std::uint32_t>(std::lround(static_cast<double>(side) * static_cast<double>(share))));
    };
    drawn_extent = {shrunk(extent.width), shrunk(extent.height)};
    const bool enlarges = drawn_extent.width < extent.width || drawn_extent.height < extent.height;
    const auto make_color = [&](VkExtent2D of, ImageResource& image) -> Result<void> {
        auto made = ImageResource::create(*context_, of, kColorFormat,
                                          VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                                              VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_SAMPLED_BIT,
                                          VK_IMAGE_ASPECT_COLOR_BIT);
        if (!made) return std::move(made.error());
        image = std::move(*made);
        return {};
    };
    if (auto made = make_color(extent, color); !made) return made;
    if (enlarges)
        if (auto made = make_color(drawn_extent, drawn_color); !made) return made;
    auto made_depth = ImageResource::create(*context_, drawn_extent, kDepthFormat,
                                            VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, VK_IMAGE_ASPECT_DEPTH_BIT);
    if (!made_depth) return std::move(made_depth.error());
    depth = std::move(*made_depth);
    auto made_readback =
        create_host_buffer(*context_, VkDeviceSize{4} * extent.width * extent.height, VK_BUFFER_USAGE_TRANSFER_DST_BIT);
    if (!made_readback) return std::move(made_readback.error());
    readback = std::move(*made_readback);

    const std::array views{enlarges ? drawn_color.view : color.view, depth.view};
    auto made = create_framebuffer(*context_, pass, views, drawn_extent);
    if (!made) return std::move(made.error());
    framebuffer = *made;
    color.name("picture");
    drawn_color.name("picture as drawn");
    depth.name("depth");
    readback.name("picture for the host");
    context_->labels.name(context_->device, VK_OBJECT_TYPE_FRAMEBUFFER, framebuffer, "picture");
    return {};
}

void Target::record_enlargement(VkCommandBuffer commands) const {
    if (drawn_color.handle == VK_NULL_HANDLE) return;
    const LabelledCommands label(context_->labels, commands, "enlarge the picture");
    const auto& vk = context_->vk;
    constexpr VkPipelineStageFlags kTransfer = VK_PIPELINE_STAGE_TRANSFER_BIT;
    constexpr VkPipelineStageFlags kReaders = kTransfer | VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT;
    const std::array before{color_barrier(drawn_color.handle, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                                          VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
                                          VK_ACCESS_TRANSFER_READ_BIT),
                            color_barrier(color.handle, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                          0, VK_ACCESS_TRANSFER_WRITE_BIT)};
    vk.vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT | kReaders, kTransfer, 0, 0,
                            nullptr, 0, nullptr, static_cast<std::uint32_t>(before.size()), before.data());
    VkImageBlit region{};
    region.srcSubresource = region.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    region.srcOffsets[1] = {static_cast<std::int32_t>(drawn_extent.width),
                            static_cast<std::int32_t>(drawn_extent.height), 1};
    region.dstOffsets[1] = {static_cast<std::int32_t>(extent.width), static_cast<std::int32_t>(extent.height), 1};
    vk.vkCmdBlitImage(commands, drawn_color.handle, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, color.handle,
                      VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region, VK_FILTER_LINEAR);
    const VkImageMemoryBarrier after =
        color_barrier(color.handle, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                      VK_ACCESS_TRANSFER_WRITE_BIT, VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_TRANSFER_READ_BIT);
    vk.vkCmdPipelineBarrier(commands, kTransfer, kReaders | VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT, 0, 0,
                            nullptr, 0, nullptr, 1, &after);
}

void Target::record_readback(VkCommandBuffer commands) const {
    const LabelledCommands label(context_->labels, commands, "copy the picture to the host");
    const VkImageMemoryBarrier to_copy =
        color_barrier(color.handle, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                      VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT, VK_ACCESS_TRANSFER_READ_BIT);
    context_->vk.vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
                                      VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, nullptr, 0, nullptr, 1, &to_copy);
    VkBufferImageCopy region{};
    region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    region.imageExtent = {extent.width, extent.height, 1};
    context_->vk.vkCmdCopyImageToBuffer(commands, color.handle, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, readback.handle,
                                        1, &region);
    const VkImageMemoryBarrier back =
        color_barrier(color.handle, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                      VK_ACCESS_TRANSFER_READ_BIT, VK_ACCESS_SHADER_READ_BIT);
    VkMemoryBarrier to_host{VK_STRUCTURE_TYPE_MEMORY_BARRIER};
    to_host.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
    to_host.dstAccessMask = VK_ACCESS_HOST_READ_BIT;
    context_->vk.vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT,
                                      VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT | VK_PIPELINE_STAGE_HOST_BIT, 0, 1,
                                      &to_host, 0, nullptr, 1, &back);
}

}  // namespace crofton::render
