// SPDX-License-Identifier: MIT
// The render pass and the pipelines, as one owner.
#pragma once
#include <array>
#include <crofton/render/resources.hpp>
#include <crofton/render/vulkan_context.hpp>

#include "draw_list.hpp"

namespace crofton::render {

inline constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT;
inline constexpr std::uint32_t kPushConstantBytes = 128;  // what every device offers

struct Pipelines {
    explicit Pipelines(const VulkanContext& owner) : context(owner) {}
    ~Pipelines();
    Pipelines(const Pipelines&) = delete;
    Pipelines& operator=(const Pipelines&) = delete;

    [[nodiscard]] Result<void> create();
    void name() const;  // for debuggers

    const VulkanContext& context;
    // Colour ends in SHADER_READ_ONLY_OPTIMAL, visible to transfers and fragment shaders that follow.
    VkRenderPass render_pass = VK_NULL_HANDLE;
    VkRenderPass covered_pass = VK_NULL_HANDLE;  // compatible; for pictures with a sky, which need no clear colour
    VkPipelineLayout layout = VK_NULL_HANDLE;
    std::array<VkPipeline, kAllFaces.size()> triangles{};  // by Faces
    std::array<VkPipeline, kAllFaces.size()> owners{};     // the same, in numbers; null where the device cannot
    VkPipeline wires = VK_NULL_HANDLE;                     // null where the device cannot
    VkPipeline lines = VK_NULL_HANDLE;
    VkPipeline sky = VK_NULL_HANDLE;
};

}  // namespace crofton::render
