// SPDX-License-Identifier: MIT
#include <crofton/render/device.hpp>
#include <cstring>

#include "instance.hpp"

namespace crofton::render {
namespace {

Result<void> create_logical_device(VulkanContext& context, const DeviceOptions& options) {
    const float priority = 1.0f;
    VkDeviceQueueCreateInfo queue{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
    queue.queueFamilyIndex = context.queue_family;
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;

    std::vector<const char*> extensions;
    for (const std::string& name : options.device_extensions) extensions.push_back(name.c_str());
    if (context.max_multi_draws > 0) extensions.push_back(VK_EXT_MULTI_DRAW_EXTENSION_NAME);

    VkPhysicalDeviceMultiDrawFeaturesEXT multi_draw{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MULTI_DRAW_FEATURES_EXT};
    multi_draw.multiDraw = VK_TRUE;
    VkPhysicalDeviceFeatures2 features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
    if (context.max_multi_draws > 0) features.pNext = &multi_draw;
    features.features.multiDrawIndirect = context.multi_draw_indirect;
    features.features.drawIndirectFirstInstance = context.multi_draw_indirect;
    features.features.pipelineStatisticsQuery = context.pipeline_statistics;
    features.features.occlusionQueryPrecise = context.precise_occlusion;
    features.features.fillModeNonSolid = context.wireframe;
    features.features.geometryShader = context.primitive_numbers;

    VkDeviceCreateInfo info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
    info.pNext = &features;
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queue;
    info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
    info.ppEnabledExtensionNames = extensions.data();
    if (const VkResult result = vkCreateDevice(context.physical_device, &info, nullptr, &context.device);
        result != VK_SUCCESS)
        return vulkan_failure(result, "vkCreateDevice");
    volkLoadDeviceTable(&context.vk, context.device);
    load_labels(context, options);
    context.vk.vkGetDeviceQueue(context.device, context.queue_family, 0, &context.queue);

    VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
    pool.queueFamilyIndex = context.queue_family;
    if (const VkResult result = context.vk.vkCreateCommandPool(context.device, &pool, nullptr, &context.command_pool);
        result != VK_SUCCESS)
        return vulkan_failure(result, "vkCreateCommandPool");
    return {};
}

}  // namespace

VulkanContext::~VulkanContext() {
    if (device != VK_NULL_HANDLE) {
        vk.vkDeviceWaitIdle(device);
        if (command_pool != VK_NULL_HANDLE) vk.vkDestroyCommandPool(device, command_pool, nullptr);
        vk.vkDestroyDevice(device, nullptr);
    }
    if (instance == VK_NULL_HANDLE) return;
    // Several devices may be alive: the instance's functions are looked up afresh.
    volkLoadInstanceOnly(instance);
    if (messenger != VK_NULL_HANDLE) vkDestroyDebugUtilsMessengerEXT(instance, messenger, nullptr);
    vkDestroyInstance(instance, nullptr);
}

std::uint32_t VulkanContext::memory_type(std::uint32_t type_bits, VkMemoryPropertyFlags wanted) const {
    for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i)
        if ((type_bits >> i & 1u) != 0 && (memory.memoryTypes[i].propertyFlags & wanted) == wanted) return i;
    return ~0u;
}

Device::Device(std::unique_ptr<VulkanContext> context) : context_(std::move(context)) {}
Device::~Device() = default;
Device::Device(Device&&) noexcept = default;
Device& Device::operator=(Device&&) noexcept = default;

Result<Device> Device::create(const DeviceOptions& options) {
    auto context = std::make_unique<VulkanContext>();
    auto made = create_instance(*context, options);
    if (made) made = choose_physical_device(*context, options);
    if (made) made = create_logical_device(*context, options);
    if (!made) return std::move(made.error());
    return Device(std::move(context));
}

const std::string& Device::name() const {
    return context_->name;
}

bool Device::counts_exactly() const {
    return context_->properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU && context_->pipeline_statistics &&
           std::strncmp(context_->properties.deviceName, "llvmpipe", 8) == 0;
}

std::span<const std::string> Device::validation_messages() const {
    return context_->messages;
}

const VulkanContext& Device::context() const {
    return *context_;
}

}  // namespace crofton::render
