#include "target.hpp"

#include <array>
#include <crofton/render/graphics_pipeline.hpp>

#include "pipelines.hpp"

namespace crofton::render {

Target::~Target() {
    context_->vk.vkDestroyFramebuffer(context_->device, framebuffer, nullptr);
}

Result<void> Target::create(VkRenderPass pass, VkExtent2D size) {
    const std::uint32_t limit = context_->properties.limits.maxImageDimension2D;
    if (size.width == 0 || size.height == 0 || size.width > limit || size.height > limit)
        return fail(ErrorCode::out_of_range, kNoItem,
                    "picture size " + std::to_string(size.width) + "x" + std::to_string(size.height) +
                        " is not within 1 to " + std::to_string(limit));
    extent = size;
    auto made_color = ImageResource::create(
        *context_, extent, kColorFormat,
        VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_SAMPLED_BIT,
        VK_IMAGE_ASPECT_COLOR_BIT);
    if (!made_color) return tl::unexpected(std::move(made_color.error()));
    color = std::move(*made_color);
    auto made_depth = ImageResource::create(*context_, extent, kDepthFormat,
                                            VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, VK_IMAGE_ASPECT_DEPTH_BIT);
    if (!made_depth) return tl::unexpected(std::move(made_depth.error()));
    depth = std::move(*made_depth);
    auto made_readback =
        create_host_buffer(*context_, VkDeviceSize{4} * extent.width * extent.height, VK_BUFFER_USAGE_TRANSFER_DST_BIT);
    if (!made_readback) return tl::unexpected(std::move(made_readback.error()));
    readback = std::move(*made_readback);

    const std::array views{color.view, depth.view};
    auto made = create_framebuffer(*context_, pass, views, extent);
    if (!made) return tl::unexpected(std::move(made.error()));
    framebuffer = *made;
    return {};
}

void Target::record_readback(VkCommandBuffer commands) const {
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
