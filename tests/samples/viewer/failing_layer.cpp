// SPDX-License-Identifier: MIT
// A Vulkan layer that lets one call fail: the CROFTON_FAIL_CALL-th of those listed here, counted from 0, with the
// result CROFTON_FAIL_RESULT; of those named CROFTON_FAIL_NAME alone, if that is given. It appends the call's name to
// the file CROFTON_FAIL_LOG. All other calls pass.
#include <vulkan/vk_layer.h>
#include <vulkan/vulkan.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

PFN_vkGetInstanceProcAddr next_instance_proc = nullptr;
PFN_vkGetDeviceProcAddr next_device_proc = nullptr;

long number_of(const char* variable, long otherwise) {
    const char* text = std::getenv(variable);
    return text != nullptr ? std::atol(text) : otherwise;
}

VkResult result_to_give() {
    return static_cast<VkResult>(number_of("CROFTON_FAIL_RESULT", VK_ERROR_OUT_OF_DEVICE_MEMORY));
}

bool fails_now(const char* name) {
    static long left = number_of("CROFTON_FAIL_CALL", -1);
    static const char* const wanted = std::getenv("CROFTON_FAIL_NAME");
    if (wanted != nullptr && *wanted != '\0' && std::strcmp(wanted, name) != 0) return false;
    if (left < 0 || left-- > 0) return false;
    if (const char* path = std::getenv("CROFTON_FAIL_LOG"))
        if (std::FILE* file = std::fopen(path, "a")) {
            std::fprintf(file, "%s\n", name);
            std::fclose(file);
        }
    return true;
}

template <int kIndex, class Function>
struct Wrapped;
template <int kIndex, class... Arguments>
struct Wrapped<kIndex, VkResult(VKAPI_PTR*)(Arguments...)> {
    static inline VkResult(VKAPI_PTR* real)(Arguments...) = nullptr;
    static inline const char* name = nullptr;
    static VKAPI_ATTR VkResult VKAPI_CALL call(Arguments... arguments) {
        return fails_now(name) ? result_to_give() : real(arguments...);
    }
    static PFN_vkVoidFunction wrap(PFN_vkVoidFunction found, const char* its_name) {
        real = reinterpret_cast<decltype(real)>(found);
        name = its_name;
        return reinterpret_cast<PFN_vkVoidFunction>(call);
    }
};

struct Entry {
    const char* name;
    PFN_vkVoidFunction (*wrap)(PFN_vkVoidFunction, const char*);
};
#define CROFTON_ENTRY(name) \
    { #name, Wrapped < __COUNTER__, PFN_##name> ::wrap }
constexpr Entry kOfDevices[] = {
    CROFTON_ENTRY(vkAllocateCommandBuffers),
    CROFTON_ENTRY(vkAllocateDescriptorSets),
    CROFTON_ENTRY(vkAllocateMemory),
    CROFTON_ENTRY(vkBeginCommandBuffer),
    CROFTON_ENTRY(vkBindBufferMemory),
    CROFTON_ENTRY(vkBindImageMemory),
    CROFTON_ENTRY(vkCreateBuffer),
    CROFTON_ENTRY(vkCreateCommandPool),
    CROFTON_ENTRY(vkCreateDescriptorPool),
    CROFTON_ENTRY(vkCreateDescriptorSetLayout),
    CROFTON_ENTRY(vkCreateFence),
    CROFTON_ENTRY(vkCreateFramebuffer),
    CROFTON_ENTRY(vkCreateGraphicsPipelines),
    CROFTON_ENTRY(vkCreateImage),
    CROFTON_ENTRY(vkCreateImageView),
    CROFTON_ENTRY(vkCreatePipelineLayout),
    CROFTON_ENTRY(vkCreateQueryPool),
    CROFTON_ENTRY(vkCreateRenderPass),
    CROFTON_ENTRY(vkCreateSampler),
    CROFTON_ENTRY(vkCreateSemaphore),
    CROFTON_ENTRY(vkCreateShaderModule),
    CROFTON_ENTRY(vkCreateSwapchainKHR),
    CROFTON_ENTRY(vkEndCommandBuffer),
    CROFTON_ENTRY(vkGetQueryPoolResults),
    CROFTON_ENTRY(vkGetSwapchainImagesKHR),
    CROFTON_ENTRY(vkAcquireNextImageKHR),
    CROFTON_ENTRY(vkMapMemory),
    CROFTON_ENTRY(vkQueuePresentKHR),
    CROFTON_ENTRY(vkQueueSubmit),
    CROFTON_ENTRY(vkResetCommandBuffer),
    CROFTON_ENTRY(vkResetFences),
    CROFTON_ENTRY(vkWaitForFences),
};
constexpr Entry kOfInstances[] = {
    CROFTON_ENTRY(vkGetPhysicalDeviceSurfaceCapabilitiesKHR),
    CROFTON_ENTRY(vkGetPhysicalDeviceSurfaceFormatsKHR),
};

// The link to the next layer in a create info's chain.
template <class Link, class Info>
Link* link_of(const Info* info, VkStructureType type) {
    auto* link = static_cast<Link*>(const_cast<void*>(info->pNext));
    while (link != nullptr && !(link->sType == type && link->function == VK_LAYER_LINK_INFO))
        link = static_cast<Link*>(const_cast<void*>(static_cast<const void*>(link->pNext)));
    return link;
}

VKAPI_ATTR VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* memory,
                                               VkInstance* instance) {
    auto* link = link_of<VkLayerInstanceCreateInfo>(info, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO);
    if (fails_now("vkCreateInstance")) return result_to_give();
    next_instance_proc = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
    link->u.pLayerInfo = link->u.pLayerInfo->pNext;
    return reinterpret_cast<PFN_vkCreateInstance>(next_instance_proc(nullptr, "vkCreateInstance"))(info, memory,
                                                                                                   instance);
}

VKAPI_ATTR VkResult VKAPI_CALL create_device(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                                             const VkAllocationCallbacks* memory, VkDevice* device) {
    auto* link = link_of<VkLayerDeviceCreateInfo>(info, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
    if (fails_now("vkCreateDevice")) return result_to_give();
    const auto instance_proc = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
    next_device_proc = link->u.pLayerInfo->pfnNextGetDeviceProcAddr;
    link->u.pLayerInfo = link->u.pLayerInfo->pNext;
    return reinterpret_cast<PFN_vkCreateDevice>(instance_proc(nullptr, "vkCreateDevice"))(physical, info, memory,
                                                                                          device);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL device_proc(VkDevice device, const char* name) {
    if (std::strcmp(name, "vkGetDeviceProcAddr") == 0) return reinterpret_cast<PFN_vkVoidFunction>(device_proc);
    const PFN_vkVoidFunction found = next_device_proc(device, name);
    if (found == nullptr) return nullptr;
    for (const Entry& entry : kOfDevices)
        if (std::strcmp(name, entry.name) == 0) return entry.wrap(found, entry.name);
    return found;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL instance_proc(VkInstance instance, const char* name) {
    if (std::strcmp(name, "vkCreateInstance") == 0) return reinterpret_cast<PFN_vkVoidFunction>(create_instance);
    if (std::strcmp(name, "vkCreateDevice") == 0) return reinterpret_cast<PFN_vkVoidFunction>(create_device);
    if (std::strcmp(name, "vkGetInstanceProcAddr") == 0) return reinterpret_cast<PFN_vkVoidFunction>(instance_proc);
    if (std::strcmp(name, "vkGetDeviceProcAddr") == 0) return reinterpret_cast<PFN_vkVoidFunction>(device_proc);
    const PFN_vkVoidFunction found = next_instance_proc(instance, name);
    if (found == nullptr) return nullptr;
    for (const Entry& entry : kOfInstances)
        if (std::strcmp(name, entry.name) == 0) return entry.wrap(found, entry.name);
    return found;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) VKAPI_ATTR VkResult VKAPI_CALL
vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface* version) {
    if (version->loaderLayerInterfaceVersion > 2) version->loaderLayerInterfaceVersion = 2;
    version->pfnGetInstanceProcAddr = instance_proc;
    version->pfnGetDeviceProcAddr = device_proc;
    version->pfnGetPhysicalDeviceProcAddr = nullptr;
    return VK_SUCCESS;
}
