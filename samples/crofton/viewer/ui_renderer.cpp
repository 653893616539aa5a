// SPDX-License-Identifier: MIT
#include "ui_renderer.hpp"

#include <algorithm>
#include <array>
#include <crofton/render/graphics_pipeline.hpp>
#include <cstddef>
#include <cstring>

#include "shaders/ui.frag.h"
#include "shaders/ui.vert.h"

namespace crofton::viewer {
namespace {

constexpr VkVertexInputBindingDescription kBinding{0, sizeof(ImDrawVert), VK_VERTEX_INPUT_RATE_VERTEX};
constexpr std::array<VkVertexInputAttributeDescription, 3> kAttributes{{
    {0, 0, VK_FORMAT_R32G32_SFLOAT, offsetof(ImDrawVert, pos)},
    {1, 0, VK_FORMAT_R32G32_SFLOAT, offsetof(ImDrawVert, uv)},
    {2, 0, VK_FORMAT_R8G8B8A8_UNORM, offsetof(ImDrawVert, col)},
}};

}  // namespace

Result<std::unique_ptr<UiRenderer>> UiRenderer::create(const render::VulkanContext& context) {
    std::unique_ptr<UiRenderer> ui(new UiRenderer(context));
    auto made = ui->create_layouts();
    if (made) made = ui->create_pipeline();
    if (made) made = ui->upload_font();
    if (!made) return std::move(made.error());
    return ui;
}

UiRenderer::~UiRenderer() {
    const auto& vk = context_.vk;
    vk.vkDeviceWaitIdle(context_.device);
    vk.vkDestroyFramebuffer(context_.device, framebuffer_, nullptr);
    vk.vkDestroyPipeline(context_.device, pipeline_, nullptr);
    vk.vkDestroyRenderPass(context_.device, pass_, nullptr);
    vk.vkDestroyPipelineLayout(context_.device, layout_, nullptr);
    vk.vkDestroyDescriptorPool(context_.device, pool_, nullptr);
    vk.vkDestroyDescriptorSetLayout(context_.device, set_layout_, nullptr);
    vk.vkDestroySampler(context_.device, sampler_, nullptr);
}

Result<void> UiRenderer::create_layouts() {
    const auto& vk = context_.vk;
    VkSamplerCreateInfo sampler{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    // Texts and pictures are shown pixel by pixel.
    sampler.magFilter = sampler.minFilter = VK_FILTER_NEAREST;
    sampler.addressModeU = sampler.addressModeV = sampler.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    VkResult result = vk.vkCreateSampler(context_.device, &sampler, nullptr, &sampler_);
    if (result != VK_SUCCESS) return render::vulkan_failure(result, "vkCreateSampler");

    const VkDescriptorSetLayoutBinding binding{0, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1,
                                               VK_SHADER_STAGE_FRAGMENT_BIT, nullptr};
    VkDescriptorSetLayoutCreateInfo set_layout{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
    set_layout.bindingCount = 1;
    set_layout.pBindings = &binding;
    result = vk.vkCreateDescriptorSetLayout(context_.device, &set_layout, nullptr, &set_layout_);
    if (result != VK_SUCCESS) return render::vulkan_failure(result, "vkCreateDescriptorSetLayout");

    const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 3};
    VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
    pool.maxSets = 3;
    pool.poolSizeCount = 1;
    pool.pPoolSizes = &size;
    result = vk.vkCreateDescriptorPool(context_.device, &pool, nullptr, &pool_);
    if (result != VK_SUCCESS) return render::vulkan_failure(result, "vkCreateDescriptorPool");
    VkDescriptorSetAllocateInfo sets{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
    sets.descriptorPool = pool_;
    sets.descriptorSetCount = 1;
    sets.pSetLayouts = &set_layout_;
    for (VkDescriptorSet* set : {&font_set_, &shown_set_, &pixels_set_}) {
        result = vk.vkAllocateDescriptorSets(context_.device, &sets, set);
        if (result != VK_SUCCESS) return render::vulkan_failure(result, "vkAllocateDescriptorSets");
    }

    const VkPushConstantRange constants{VK_SHADER_STAGE_VERTEX_BIT, 0, 4 * sizeof(float)};
    VkPipelineLayoutCreateInfo layout{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    layout.setLayoutCount = 1;
    layout.pSetLayouts = &set_layout_;
    layout.pushConstantRangeCount = 1;
    layout.pPushConstantRanges = &constants;
    result = vk.vkCreatePipelineLayout(context_.device, &layout, nullptr, &layout_);
    if (result != VK_SUCCESS) return render::vulkan_failure(result, "vkCreatePipelineLayout");
    return {};
}

Result<void> UiRenderer::create_pipeline() {
    auto pass = render::create_render_pass(context_, {.keep_color = true});
    if (!pass) return std::move(pass.error());
    pass_ = *pass;
    render::PipelineDescription description{
        render::shaders::ui_vert, render::shaders::ui_frag, kAttributes, {&kBinding, 1}};
    description.blend = true;
    auto made = render::create_pipeline(context_, description, layout_, pass_);
    if (!made) return std::move(made.error());
    pipeline_ = *made;
    return {};
}

Result<void> UiRenderer::set_target(VkImageView picture, VkExtent2D extent) {
    context_.vk.vkDestroyFramebuffer(context_.device, framebuffer_, nullptr);
    framebuffer_ = VK_NULL_HANDLE;
    extent_ = extent;
    auto made = render::create_framebuffer(context_, pass_, {&picture, 1}, extent);
    if (!made) return std::move(made.error());
    framebuffer_ = *made;
    return {};
}

void UiRenderer::point_at(VkDescriptorSet set, VkImageView view) const {
    const VkDescriptorImageInfo image{sampler_, view, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
    VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
    write.dstSet = set;
    write.descriptorCount = 1;
    write.descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
    write.pImageInfo = &image;
    context_.vk.vkUpdateDescriptorSets(context_.device, 1, &write, 0, nullptr);
}

ImTextureID UiRenderer::show(VkImageView picture) {
    point_at(shown_set_, picture);
    return reinterpret_cast<ImTextureID>(shown_set_);
}

Result<void> UiRenderer::upload(render::ImageResource& image, VkExtent2D& size, const void* rgba, VkExtent2D extent) {
    if (size.width != extent.width || size.height != extent.height) {
        auto made = render::ImageResource::create(context_, extent, VK_FORMAT_R8G8B8A8_UNORM,
                                                  VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
                                                  VK_IMAGE_ASPECT_COLOR_BIT);
        if (!made) return std::move(made.error());
        image = std::move(*made);
        size = extent;
    }
    const VkDeviceSize bytes = VkDeviceSize{4} * extent.width * extent.height;
    if (auto grown = render::reserve_host_buffer(context_, staging_, bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT); !grown)
        return grown;
    std::memcpy(staging_.mapped, rgba, bytes);
    auto commands = render::Commands::create(context_);
    if (!commands) return std::move(commands.error());
    if (auto begun = commands->begin(); !begun) return begun;
    constexpr VkPipelineStageFlags kTransfer = VK_PIPELINE_STAGE_TRANSFER_BIT;
    const auto barrier = [&](VkPipelineStageFlags before, VkPipelineStageFlags after,
                             const VkImageMemoryBarrier& what) {
        context_.vk.vkCmdPipelineBarrier(commands->handle, before, after, 0, 0, nullptr, 0, nullptr, 1, &what);
    };
    barrier(VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, kTransfer,
            render::color_barrier(image.handle, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 0,
                                  VK_ACCESS_TRANSFER_WRITE_BIT));
    VkBufferImageCopy region{};
    region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    region.imageExtent = {extent.width, extent.height, 1};
    context_.vk.vkCmdCopyBufferToImage(commands->handle, staging_.handle, image.handle,
                                       VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
    barrier(kTransfer, VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT,
            render::color_barrier(image.handle, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                  VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_ACCESS_TRANSFER_WRITE_BIT,
                                  VK_ACCESS_SHADER_READ_BIT));
    return commands->submit_and_wait();
}

Result<void> UiRenderer::upload_font() {
    unsigned char* pixels = nullptr;
    int width = 0, height = 0;
    ImGui::GetIO().Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
    const VkExtent2D extent{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
    if (auto uploaded = upload(font_, font_size_, pixels, extent); !uploaded) return uploaded;
    point_at(font_set_, font_.view);
    point_at(shown_set_, font_.view);
    point_at(pixels_set_, font_.view);
    ImGui::GetIO().Fonts->SetTexID(reinterpret_cast<ImTextureID>(font_set_));
    return {};
}

Result<ImTextureID> UiRenderer::show_pixels(std::span<const std::uint32_t> rgba, VkExtent2D extent) {
    if (auto uploaded = upload(pixels_, pixels_size_, rgba.data(), extent); !uploaded)
        return std::move(uploaded.error());
    point_at(pixels_set_, pixels_.view);
    return reinterpret_cast<ImTextureID>(pixels_set_);
}

Result<void> UiRenderer::upload_lists(const ImDrawData& data) {
    const auto vertex_bytes = static_cast<VkDeviceSize>(data.TotalVtxCount) * sizeof(ImDrawVert);
    const auto index_bytes = static_cast<VkDeviceSize>(data.TotalIdxCount) * sizeof(ImDrawIdx);
    if (auto grown = render::reserve_host_buffer(context_, vertices_, vertex_bytes, VK_BUFFER_USAGE_VERTEX_BUFFER_BIT);
        !grown)
        return grown;
    if (auto grown = render::reserve_host_buffer(context_, indices_, index_bytes, VK_BUFFER_USAGE_INDEX_BUFFER_BIT);
        !grown)
        return grown;
    std::byte* vertex = vertices_.mapped;
    std::byte* index = indices_.mapped;
    for (int i = 0; i < data.CmdListsCount; ++i) {
        const ImDrawList& list = *data.CmdLists[i];
        std::memcpy(vertex, list.VtxBuffer.Data, static_cast<std::size_t>(list.VtxBuffer.size_in_bytes()));
        std::memcpy(index, list.IdxBuffer.Data, static_cast<std::size_t>(list.IdxBuffer.size_in_bytes()));
        vertex += list.VtxBuffer.size_in_bytes();
        index += list.IdxBuffer.size_in_bytes();
    }
    return {};
}

Result<void> UiRenderer::record(VkCommandBuffer commands, const ImDrawData& data) {
    if (data.TotalIdxCount == 0) return {};
    if (auto uploaded = upload_lists(data); !uploaded) return uploaded;
    const auto& vk = context_.vk;
    VkRenderPassBeginInfo pass{VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO};
    pass.renderPass = pass_;
    pass.framebuffer = framebuffer_;
    pass.renderArea.extent = extent_;
    vk.vkCmdBeginRenderPass(commands, &pass, VK_SUBPASS_CONTENTS_INLINE);
    vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_);
    const VkDeviceSize zero = 0;
    vk.vkCmdBindVertexBuffers(commands, 0, 1, &vertices_.handle, &zero);
    vk.vkCmdBindIndexBuffer(commands, indices_.handle, 0,
                            sizeof(ImDrawIdx) == 2 ? VK_INDEX_TYPE_UINT16 : VK_INDEX_TYPE_UINT32);
    const VkViewport viewport{0.0f, 0.0f, static_cast<float>(extent_.width), static_cast<float>(extent_.height),
                              0.0f, 1.0f};
    vk.vkCmdSetViewport(commands, 0, 1, &viewport);
    const float scale_x = 2.0f / data.DisplaySize.x, scale_y = 2.0f / data.DisplaySize.y;
    const std::array constants{scale_x, scale_y, -1.0f - data.DisplayPos.x * scale_x,
                               -1.0f - data.DisplayPos.y * scale_y};
    vk.vkCmdPushConstants(commands, layout_, VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof constants, constants.data());

    const auto clamped = [](float value, std::uint32_t limit) {
        return static_cast<std::int32_t>(std::clamp(value, 0.0f, static_cast<float>(limit)));
    };
    std::uint32_t first_index = 0;
    std::int32_t first_vertex = 0;
    for (int i = 0; i < data.CmdListsCount; ++i) {
        const ImDrawList& list = *data.CmdLists[i];
        for (const ImDrawCmd& command : list.CmdBuffer) {
            // Clip rectangles are in ImGui's units; the picture may have more pixels than that (HiDPI).
            const ImVec2 k = data.FramebufferScale;
            const std::int32_t x0 = clamped((command.ClipRect.x - data.DisplayPos.x) * k.x, extent_.width);
            const std::int32_t y0 = clamped((command.ClipRect.y - data.DisplayPos.y) * k.y, extent_.height);
            const std::int32_t x1 = clamped((command.ClipRect.z - data.DisplayPos.x) * k.x, extent_.width);
            const std::int32_t y1 = clamped((command.ClipRect.w - data.DisplayPos.y) * k.y, extent_.height);
            if (x1 <= x0 || y1 <= y0 || command.ElemCount == 0) continue;
            const VkRect2D scissor{{x0, y0},
                                   {static_cast<std::uint32_t>(x1 - x0), static_cast<std::uint32_t>(y1 - y0)}};
            vk.vkCmdSetScissor(commands, 0, 1, &scissor);
            const auto set = reinterpret_cast<VkDescriptorSet>(command.GetTexID());
            vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_, 0, 1, &set, 0, nullptr);
            vk.vkCmdDrawIndexed(commands, command.ElemCount, 1, first_index + command.IdxOffset,
                                first_vertex + static_cast<std::int32_t>(command.VtxOffset), 0);
        }
        first_index += static_cast<std::uint32_t>(list.IdxBuffer.Size);
        first_vertex += list.VtxBuffer.Size;
    }
    vk.vkCmdEndRenderPass(commands);
    return {};
}

}  // namespace crofton::viewer
