// SPDX-License-Identifier: MIT
// The render target: RGBA8 + D32, with a way back to the host.
#pragma once
#include <crofton/render/resources.hpp>

namespace crofton::render {

class Target {
  public:
    explicit Target(const VulkanContext& context) : context_(&context) {}
    ~Target();
    Target(const Target&) = delete;
    Target& operator=(const Target&) = delete;

    // Errors: a side of 0 or beyond the device's limit; a resolution that is not above 0 and at most 1.
    [[nodiscard]] Result<void> create(VkRenderPass pass, VkExtent2D extent, float resolution);
    // After the pass: what was drawn with fewer pixels than `color` has fills it.
    void record_enlargement(VkCommandBuffer commands) const;
    // Records the copy of the colour image into `readback`; the image is in SHADER_READ_ONLY_OPTIMAL before and after.
    void record_readback(VkCommandBuffer commands) const;

    VkExtent2D extent{}, drawn_extent{};  // of the picture, and of what is drawn
    float resolution = 1.0f;
    VkFramebuffer framebuffer = VK_NULL_HANDLE;
    ImageResource color, depth;
    ImageResource drawn_color;  // null where `color` itself is drawn into
    Buffer readback;
    bool drawn = false;

  private:
    const VulkanContext* context_;
};

}  // namespace crofton::render
