// SPDX-License-Identifier: MIT
// Chooses the Vulkan device.
#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <cstring>

#include "instance.hpp"

namespace crofton::render {
namespace {

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

int rank(VkPhysicalDeviceType type) {
    switch (type) {
        case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
            return 0;
        case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
            return 1;
        case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
            return 2;
        case VK_PHYSICAL_DEVICE_TYPE_CPU:
            return 3;
        default:
            return 4;
    }
}

struct Wish {
    DeviceKind kind;
    std::string name;
};

Wish wish_of(const DeviceOptions& options) {
    Wish wish{options.kind, lower(options.name)};
    const char* environment = std::getenv("CROFTON_DEVICE");
    if (wish.name.empty() && environment != nullptr) wish.name = lower(environment);
    if (wish.name == "cpu") wish = {DeviceKind::cpu, {}};
    return wish;
}

std::uint32_t graphics_family(VkPhysicalDevice device) {
    std::uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
    for (std::uint32_t i = 0; i < count; ++i)
        if ((families[i].queueFlags & VK_QUEUE_GRAPHICS_BIT) != 0) return i;
    return ~0u;
}

bool has_extension(VkPhysicalDevice device, const char* name) {
    std::uint32_t count = 0;
    vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr);
    std::vector<VkExtensionProperties> extensions(count);
    vkEnumerateDeviceExtensionProperties(device, nullptr, &count, extensions.data());
    return std::any_of(extensions.begin(), extensions.end(),
                       [&](const VkExtensionProperties& e) { return std::strcmp(e.extensionName, name) == 0; });
}

// Notes optional features; errors name the needed one that is missing.
Result<void> examine(VulkanContext& context, const DeviceOptions& options) {
    const auto lacks = [&](const std::string& what) {
        return fail(ErrorCode::unsupported, kNoItem, {context.name, ": the device lacks ", what});
    };
    if (context.properties.apiVersion < VK_API_VERSION_1_3) return lacks("Vulkan 1.3");
    if (context.queue_family == ~0u) return lacks("a graphics queue");
    for (const std::string& name : options.device_extensions)
        if (!has_extension(context.physical_device, name.c_str())) return lacks(name);

    const bool multi_draw_known = has_extension(context.physical_device, VK_EXT_MULTI_DRAW_EXTENSION_NAME);
    VkPhysicalDeviceMultiDrawFeaturesEXT multi_draw{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MULTI_DRAW_FEATURES_EXT};
    VkPhysicalDeviceFeatures2 features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
    if (multi_draw_known) features.pNext = &multi_draw;
    vkGetPhysicalDeviceFeatures2(context.physical_device, &features);

    VkPhysicalDeviceMultiDrawPropertiesEXT limits{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MULTI_DRAW_PROPERTIES_EXT};
    if (multi_draw_known && multi_draw.multiDraw == VK_TRUE) {
        VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
        properties.pNext = &limits;
        vkGetPhysicalDeviceProperties2(context.physical_device, &properties);
    }
    context.max_multi_draws = limits.maxMultiDrawCount;
    context.multi_draw_indirect =
        features.features.multiDrawIndirect == VK_TRUE && features.features.drawIndirectFirstInstance == VK_TRUE;
    context.pipeline_statistics = features.features.pipelineStatisticsQuery == VK_TRUE;
    context.precise_occlusion = features.features.occlusionQueryPrecise == VK_TRUE;
    context.wireframe = features.features.fillModeNonSolid == VK_TRUE;
    context.primitive_numbers = features.features.geometryShader == VK_TRUE;
    return {};
}

}  // namespace

Result<void> choose_physical_device(VulkanContext& context, const DeviceOptions& options) {
    std::uint32_t count = 0;
    VkResult result = vkEnumeratePhysicalDevices(context.instance, &count, nullptr);
    std::vector<VkPhysicalDevice> devices(count);
    if (result == VK_SUCCESS && count > 0)
        result = vkEnumeratePhysicalDevices(context.instance, &count, devices.data());
    if (result < 0 || count == 0)
        return fail(
            ErrorCode::unavailable, kNoItem,
            "no Vulkan device found (Debian: mesa-vulkan-drivers brings a software one), so nothing can be drawn");

    const Wish wish = wish_of(options);
    std::string seen;
    int best = -1;
    for (VkPhysicalDevice device : devices) {
        VkPhysicalDeviceProperties properties;
        vkGetPhysicalDeviceProperties(device, &properties);
        seen += (seen.empty() ? "" : ", ") + std::string(properties.deviceName);
        const bool kind_fits = wish.kind == DeviceKind::any || properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
        const bool name_fits = lower(properties.deviceName).find(wish.name) != std::string::npos;
        if (!kind_fits || !name_fits || (best >= 0 && best <= rank(properties.deviceType))) continue;
        best = rank(properties.deviceType);
        context.physical_device = device;
        context.properties = properties;
        context.name = properties.deviceName;
    }
    if (best < 0) {
        const std::string asked = wish.kind == DeviceKind::cpu ? "a software device" : "named '" + wish.name + "'";
        return fail(ErrorCode::unavailable, kNoItem, {"no Vulkan device is ", asked, "; there are: ", seen});
    }
    vkGetPhysicalDeviceMemoryProperties(context.physical_device, &context.memory);
    context.queue_family = graphics_family(context.physical_device);
    return examine(context, options);
}

}  // namespace crofton::render
