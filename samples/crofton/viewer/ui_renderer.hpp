// SPDX-License-Identifier: MIT
// Draws Dear ImGui's lists over a picture, through the rasterizer's own device. (ImGui's Vulkan backend as packaged
// calls the loader's functions by name; ours are loaded at run time and share those names.)
#pragma once
#include <imgui.h>

#include <crofton/render/resources.hpp>
#include <cstdint>
#include <memory>
#include <span>

namespace crofton::viewer {

class UiRenderer {
  public:
    // Uploads the font atlas: an ImGui context with its fonts is current.
    [[nodiscard]] static Result<std::unique_ptr<UiRenderer>> create(const render::VulkanContext& context);
    ~UiRenderer();
    UiRenderer(const UiRenderer&) = delete;
    UiRenderer& operator=(const UiRenderer&) = delete;

    // Takes over ImGui's font atlas after it has changed; nothing is being drawn.
    [[nodiscard]] Result<void> upload_font();

    // The picture to draw over; again after each change of its size.
    [[nodiscard]] Result<void> set_target(VkImageView picture, VkExtent2D extent);

    // Registers a picture for ImGui::Image, one at a time besides the font; the next call replaces it.
    [[nodiscard]] ImTextureID show(VkImageView picture);
    // The same for pixels in memory, red in the lowest byte: one more picture. Errors: Vulkan's.
    [[nodiscard]] Result<ImTextureID> show_pixels(std::span<const std::uint32_t> rgba, VkExtent2D extent);

    // Records the pass; the target is in SHADER_READ_ONLY_OPTIMAL before and after. Errors: Vulkan's.
    [[nodiscard]] Result<void> record(VkCommandBuffer commands, const ImDrawData& data);

  private:
    explicit UiRenderer(const render::VulkanContext& context) : context_(context) {}
    [[nodiscard]] Result<void> create_layouts();
    [[nodiscard]] Result<void> create_pipeline();
    [[nodiscard]] Result<void> upload_lists(const ImDrawData& data);
    // A new image where the size is another one.
    [[nodiscard]] Result<void> upload(render::ImageResource& image, VkExtent2D& size, const void* rgba,
                                      VkExtent2D extent);
    void point_at(VkDescriptorSet set, VkImageView view) const;

    const render::VulkanContext& context_;
    VkSampler sampler_ = VK_NULL_HANDLE;
    VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
    VkDescriptorPool pool_ = VK_NULL_HANDLE;
    VkDescriptorSet font_set_ = VK_NULL_HANDLE, shown_set_ = VK_NULL_HANDLE, pixels_set_ = VK_NULL_HANDLE;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    VkRenderPass pass_ = VK_NULL_HANDLE;
    VkPipeline pipeline_ = VK_NULL_HANDLE;
    VkFramebuffer framebuffer_ = VK_NULL_HANDLE;
    VkExtent2D extent_{};
    render::ImageResource font_, pixels_;
    VkExtent2D font_size_{}, pixels_size_{};
    render::Buffer vertices_, indices_, staging_;
};

}  // namespace crofton::viewer
