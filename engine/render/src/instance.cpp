// SPDX-License-Identifier: MIT
#include "instance.hpp"

#include <algorithm>
#include <crofton/core/error.hpp>
#include <cstring>

namespace crofton::render {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

constexpr const char* kNoDriver =
    "no Vulkan driver found, so nothing can be drawn; install one (Debian: mesa-vulkan-drivers for software, or your "
    "GPU's)";

VKAPI_ATTR VkBool32 VKAPI_CALL collect_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                               VkDebugUtilsMessageTypeFlagsEXT,
                                               const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
    if (severity < VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT) return VK_FALSE;
    auto& messages = *static_cast<std::vector<std::string>*>(user);
    messages.emplace_back(data->pMessage != nullptr ? data->pMessage : "(no text)");
    log(LogLevel::warning, messages.back());
    return VK_FALSE;
}

bool has_layer(const char* name) {
    std::uint32_t count = 0;
    vkEnumerateInstanceLayerProperties(&count, nullptr);
    std::vector<VkLayerProperties> layers(count);
    vkEnumerateInstanceLayerProperties(&count, layers.data());
    return std::any_of(layers.begin(), layers.end(),
                       [&](const VkLayerProperties& layer) { return std::strcmp(layer.layerName, name) == 0; });
}

bool asks_for_labels(const DeviceOptions& options) {
    return std::find(options.instance_extensions.begin(), options.instance_extensions.end(),
                     VK_EXT_DEBUG_UTILS_EXTENSION_NAME) != options.instance_extensions.end();
}

VkDebugUtilsMessengerCreateInfoEXT messenger_info(VulkanContext& context) {
    VkDebugUtilsMessengerCreateInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
    info.messageSeverity =
        VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
    info.pfnUserCallback = collect_message;
    info.pUserData = &context.messages;
    return info;
}

}  // namespace

void load_labels(VulkanContext& context, const DeviceOptions& options) {
    if (!options.validation && !asks_for_labels(options)) return;
    const auto load = [&](const char* function) { return vkGetDeviceProcAddr(context.device, function); };
    context.labels.set_name = reinterpret_cast<PFN_vkSetDebugUtilsObjectNameEXT>(load("vkSetDebugUtilsObjectNameEXT"));
    context.labels.begin = reinterpret_cast<PFN_vkCmdBeginDebugUtilsLabelEXT>(load("vkCmdBeginDebugUtilsLabelEXT"));
    context.labels.end = reinterpret_cast<PFN_vkCmdEndDebugUtilsLabelEXT>(load("vkCmdEndDebugUtilsLabelEXT"));
}

Result<void> create_instance(VulkanContext& context, const DeviceOptions& options) {
    if (volkInitialize() != VK_SUCCESS)
        return fail(ErrorCode::unavailable, kNoItem,
                    "no Vulkan loader found (Debian: libvulkan1), so nothing can be drawn");
    if (volkGetInstanceVersion() < VK_API_VERSION_1_3)
        return fail(ErrorCode::unsupported, kNoItem, "the Vulkan loader is older than 1.3");
    if (options.validation && !has_layer(kValidationLayer))
        return fail(ErrorCode::unavailable, kNoItem,
                    "the Vulkan validation layer is not installed (Debian: vulkan-validationlayers)");

    VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
    application.pApplicationName = "crofton";
    application.apiVersion = VK_API_VERSION_1_3;

    std::vector<const char*> extensions;
    for (const std::string& name : options.instance_extensions) extensions.push_back(name.c_str());
    if (options.validation && !asks_for_labels(options)) extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);

    const VkValidationFeatureEnableEXT enabled[] = {VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
    VkDebugUtilsMessengerCreateInfoEXT messenger = messenger_info(context);
    VkValidationFeaturesEXT features{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT};
    features.pNext = &messenger;
    features.enabledValidationFeatureCount = 1;
    features.pEnabledValidationFeatures = enabled;

    VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
    info.pApplicationInfo = &application;
    info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
    info.ppEnabledExtensionNames = extensions.data();
    if (options.validation) {
        info.pNext = &features;
        info.enabledLayerCount = 1;
        info.ppEnabledLayerNames = &kValidationLayer;
    }
    const VkResult result = vkCreateInstance(&info, nullptr, &context.instance);
    if (result == VK_ERROR_INCOMPATIBLE_DRIVER) return fail(ErrorCode::unavailable, kNoItem, kNoDriver);
    if (result != VK_SUCCESS) {
        Error error = vulkan_error(result, "vkCreateInstance");
        error.code = ErrorCode::unavailable;
        return error;
    }
    volkLoadInstanceOnly(context.instance);
    if (options.validation) {
        const VkResult made = vkCreateDebugUtilsMessengerEXT(context.instance, &messenger, nullptr, &context.messenger);
        if (made != VK_SUCCESS) return vulkan_failure(made, "vkCreateDebugUtilsMessengerEXT");
    }
    return {};
}

}  // namespace crofton::render
