// SPDX-License-Identifier: MIT
// Render passes and pipelines by their differences, for the rasterizer and for other drawing code.
#pragma once
#include <crofton/render/vulkan_context.hpp>
#include <cstdint>
#include <span>

namespace crofton::render {

// One pass over a picture of kColorFormat. The picture ends in SHADER_READ_ONLY_OPTIMAL, visible to following transfers
// and fragment shaders. A picture that is kept must be in that layout before.
struct PassDescription {
    bool keep_color = false;                      // false: cleared
    VkFormat depth_format = VK_FORMAT_UNDEFINED;  // cleared, and discarded after the pass; UNDEFINED: no depth
    bool draws_all_pixels = false;                // colour is not cleared, unless it is kept
};
[[nodiscard]] Result<VkRenderPass> create_render_pass(const VulkanContext& context, const PassDescription& description);

// `views`: colour, then depth if the pass has one.
[[nodiscard]] Result<VkFramebuffer> create_framebuffer(const VulkanContext& context, VkRenderPass pass,
                                                       std::span<const VkImageView> views, VkExtent2D extent);

// A pipeline with one colour attachment, dynamic viewport and scissor, and counter-clockwise front faces.
struct PipelineDescription {
    std::span<const std::uint32_t> vertex_shader, fragment_shader;  // SPIR-V
    std::span<const VkVertexInputAttributeDescription> attributes;
    std::span<const VkVertexInputBindingDescription> bindings;
    VkPrimitiveTopology topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    VkPolygonMode mode = VK_POLYGON_MODE_FILL;
    VkCullModeFlags cull = VK_CULL_MODE_NONE;
    std::uint32_t variant = 0;                          // the shaders' constant_id 0
    VkCompareOp depth_compare = VK_COMPARE_OP_GREATER;  // reversed-Z; of no effect in a pass without depth
    bool depth_write = true;
    struct DepthBias {
        float constant = 0.0f;  // in the least steps of the depth's format
        float slope = 0.0f;     // of the triangle's steepest slope, from one pixel to the next
    } depth_bias{};             // positive: nearer, as depth is reversed
    bool blend = false;         // by the source's alpha
};
[[nodiscard]] Result<VkPipeline> create_pipeline(const VulkanContext& context, const PipelineDescription& description,
                                                 VkPipelineLayout layout, VkRenderPass pass);

}  // namespace crofton::render
