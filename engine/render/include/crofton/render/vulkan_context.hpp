// SPDX-License-Identifier: MIT
// Native Vulkan handles, for drawing code besides the rasterizer: a window's swapchain, a user interface.
#pragma once
#include <volk.h>

#include <crofton/core/error.hpp>
#include <crofton/render/debug_labels.hpp>
#include <string>
#include <vector>

namespace crofton::render {

// Native handles, owned by Device. Functions are called through `vk`, so several devices may exist in one process.
struct VulkanContext {
    VkInstance instance = VK_NULL_HANDLE;
    VkDebugUtilsMessengerEXT messenger = VK_NULL_HANDLE;
    VkPhysicalDevice physical_device = VK_NULL_HANDLE;
    VkPhysicalDeviceProperties properties{};
    VkPhysicalDeviceMemoryProperties memory{};
    VkDevice device = VK_NULL_HANDLE;
    VolkDeviceTable vk{};
    DebugLabels labels;
    std::uint32_t queue_family = 0;
    VkQueue queue = VK_NULL_HANDLE;
    VkCommandPool command_pool = VK_NULL_HANDLE;
    // 0 if the device has no VK_EXT_multi_draw.
    std::uint32_t max_multi_draws = 0;
    bool multi_draw_indirect = false;
    bool pipeline_statistics = false;
    bool precise_occlusion = false;
    bool wireframe = false;
    bool primitive_numbers = false;  // fragment shaders may read gl_PrimitiveID
    std::string name;
    std::vector<std::string> messages;

    VulkanContext() = default;
    VulkanContext(const VulkanContext&) = delete;
    VulkanContext& operator=(const VulkanContext&) = delete;
    ~VulkanContext();

    // Returns the first memory type among `type_bits` that has all of `wanted`, or ~0u.
    [[nodiscard]] std::uint32_t memory_type(std::uint32_t type_bits, VkMemoryPropertyFlags wanted) const;
};

// Returns an error with the message "what: VK_ERROR_…": `unavailable` for a lost device or a lost surface,
// `out_of_range` if memory is full, `internal` otherwise.
[[nodiscard]] Error vulkan_error(VkResult result, const char* what);
[[nodiscard]] inline Error vulkan_failure(VkResult result, const char* what) {
    return vulkan_error(result, what);
}
[[nodiscard]] const char* vulkan_result_name(VkResult result);

}  // namespace crofton::render
