// SPDX-License-Identifier: MIT
// The window's half that speaks Vulkan: surface, swapchain, presenting by copy.
// clang-format off
#include "window.hpp"
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
// clang-format on

#include <algorithm>
#include <array>
#include <utility>

namespace crofton::viewer {
Result<void> Window::attach(const render::VulkanContext& context) {
    context_ = &context;
    VkResult result = glfwCreateWindowSurface(context.instance, window_, nullptr, &surface_);
    if (result != VK_SUCCESS) return render::vulkan_failure(result, "glfwCreateWindowSurface");
    VkBool32 supported = VK_FALSE;
    vkGetPhysicalDeviceSurfaceSupportKHR(context.physical_device, context.queue_family, surface_, &supported);
    if (supported != VK_TRUE)
        return fail(ErrorCode::unsupported, kNoItem,
                    context.name +
                        ": the device cannot show pictures in this window; --device NAME takes another, --no-window "
                        "needs none");
    const auto& vk = context.vk;
    auto commands = render::Commands::create(context);
    if (!commands) return std::move(commands.error());
    commands_ = std::move(*commands);
    const VkSemaphoreCreateInfo semaphore{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    result = vk.vkCreateSemaphore(context.device, &semaphore, nullptr, &acquired_);
    if (result == VK_SUCCESS) result = vk.vkCreateSemaphore(context.device, &semaphore, nullptr, &copied_);
    if (result != VK_SUCCESS) return render::vulkan_failure(result, "vkCreateSemaphore");
    return create_swapchain();
}

void Window::detach() {
    if (context_ == nullptr) return;
    const auto& vk = context_->vk;
    vk.vkDeviceWaitIdle(context_->device);
    vk.vkDestroySemaphore(context_->device, std::exchange(acquired_, VK_NULL_HANDLE), nullptr);
    vk.vkDestroySemaphore(context_->device, std::exchange(copied_, VK_NULL_HANDLE), nullptr);
    commands_ = render::Commands();
    if (swapchain_ != VK_NULL_HANDLE) vk.vkDestroySwapchainKHR(context_->device, swapchain_, nullptr);
    swapchain_ = VK_NULL_HANDLE;
    if (surface_ != VK_NULL_HANDLE) vkDestroySurfaceKHR(context_->instance, surface_, nullptr);
    surface_ = VK_NULL_HANDLE;
    context_ = nullptr;
}

Window::~Window() {
    detach();
    if (window_ != nullptr) glfwDestroyWindow(window_);
    glfwTerminate();
}

Result<void> Window::create_swapchain() {
    const auto& vk = context_->vk;
    vk.vkDeviceWaitIdle(context_->device);
    VkSurfaceCapabilitiesKHR capabilities{};
    VkResult result = vkGetPhysicalDeviceSurfaceCapabilitiesKHR(context_->physical_device, surface_, &capabilities);
    if (result != VK_SUCCESS) return render::vulkan_failure(result, "vkGetPhysicalDeviceSurfaceCapabilitiesKHR");
    const VkExtent2D wanted = framebuffer_size();
    extent_ = {std::clamp(wanted.width, capabilities.minImageExtent.width, capabilities.maxImageExtent.width),
               std::clamp(wanted.height, capabilities.minImageExtent.height, capabilities.maxImageExtent.height)};
    if (extent_.width == 0 || extent_.height == 0) return {};

    std::uint32_t count = 0;
    result = vkGetPhysicalDeviceSurfaceFormatsKHR(context_->physical_device, surface_, &count, nullptr);
    if (result != VK_SUCCESS) return render::vulkan_failure(result, "vkGetPhysicalDeviceSurfaceFormatsKHR");
    std::vector<VkSurfaceFormatKHR> formats(count);
    result = vkGetPhysicalDeviceSurfaceFormatsKHR(context_->physical_device, surface_, &count, formats.data());
    if (result != VK_SUCCESS) return render::vulkan_failure(result, "vkGetPhysicalDeviceSurfaceFormatsKHR");
    if (formats.empty()) return fail(ErrorCode::unsupported, kNoItem, "the window offers no pixel format");
    // The picture's values are display values already: no second gamma.
    VkSurfaceFormatKHR format = formats.front();
    for (const VkSurfaceFormatKHR& offered : formats)
        if (offered.format == VK_FORMAT_R8G8B8A8_UNORM) format = offered;
    for (const VkSurfaceFormatKHR& offered : formats)
        if (offered.format == render::kColorFormat) format = offered;
    format_ = format.format;

    VkSwapchainCreateInfoKHR info{VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR};
    info.surface = surface_;
    info.minImageCount = std::max(capabilities.minImageCount, 2u);
    if (capabilities.maxImageCount > 0) info.minImageCount = std::min(info.minImageCount, capabilities.maxImageCount);
    info.imageFormat = format.format;
    info.imageColorSpace = format.colorSpace;
    info.imageExtent = extent_;
    info.imageArrayLayers = 1;
    info.imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    info.preTransform = capabilities.currentTransform;
    info.compositeAlpha = (capabilities.supportedCompositeAlpha & VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR) != 0
                              ? VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                              : VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR;
    info.presentMode = VK_PRESENT_MODE_FIFO_KHR;
    info.clipped = VK_TRUE;
    info.oldSwapchain = swapchain_;
    VkSwapchainKHR made = VK_NULL_HANDLE;
    result = vk.vkCreateSwapchainKHR(context_->device, &info, nullptr, &made);
    if (swapchain_ != VK_NULL_HANDLE) vk.vkDestroySwapchainKHR(context_->device, swapchain_, nullptr);
    swapchain_ = made;
    if (result != VK_SUCCESS) return render::vulkan_failure(result, "vkCreateSwapchainKHR");
    result = vk.vkGetSwapchainImagesKHR(context_->device, swapchain_, &count, nullptr);
    if (result != VK_SUCCESS) return render::vulkan_failure(result, "vkGetSwapchainImagesKHR");
    images_.resize(count);
    result = vk.vkGetSwapchainImagesKHR(context_->device, swapchain_, &count, images_.data());
    return result == VK_SUCCESS ? Result<void>{} : render::vulkan_failure(result, "vkGetSwapchainImagesKHR");
}

void Window::record_copy(VkCommandBuffer commands, VkImage picture, VkExtent2D size, VkImage onto) const {
    const auto& vk = context_->vk;
    constexpr VkPipelineStageFlags kTransfer = VK_PIPELINE_STAGE_TRANSFER_BIT;
    const std::array before{
        render::color_barrier(picture, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                              VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT, VK_ACCESS_TRANSFER_READ_BIT),
        render::color_barrier(onto, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 0,
                              VK_ACCESS_TRANSFER_WRITE_BIT)};
    vk.vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT | kTransfer, kTransfer, 0, 0,
                            nullptr, 0, nullptr, static_cast<std::uint32_t>(before.size()), before.data());
    const VkImageSubresourceLayers whole{VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    if (format_ == render::kColorFormat && size.width == extent_.width && size.height == extent_.height) {
        const VkImageCopy region{whole, {}, whole, {}, {size.width, size.height, 1}};
        vk.vkCmdCopyImage(commands, picture, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, onto,
                          VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
    } else {
        VkImageBlit region{};
        region.srcSubresource = region.dstSubresource = whole;
        region.srcOffsets[1] = {static_cast<std::int32_t>(size.width), static_cast<std::int32_t>(size.height), 1};
        region.dstOffsets[1] = {static_cast<std::int32_t>(extent_.width), static_cast<std::int32_t>(extent_.height), 1};
        vk.vkCmdBlitImage(commands, picture, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, onto,
                          VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region, VK_FILTER_NEAREST);
    }
    const std::array after{
        render::color_barrier(picture, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                              VK_ACCESS_TRANSFER_READ_BIT, VK_ACCESS_SHADER_READ_BIT),
        render::color_barrier(onto, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR,
                              VK_ACCESS_TRANSFER_WRITE_BIT, 0)};
    vk.vkCmdPipelineBarrier(commands, kTransfer,
                            VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT | VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, 0, 0, nullptr,
                            0, nullptr, static_cast<std::uint32_t>(after.size()), after.data());
}

Result<void> Window::present(VkImage picture, VkExtent2D size) {
    const VkExtent2D now = framebuffer_size();
    if (now.width == 0 || now.height == 0) return {};
    // X11 tells of a new size by the callback only, not through the swapchain.
    if (now.width != extent_.width || now.height != extent_.height)
        if (auto made = create_swapchain(); !made) return made;
    if (swapchain_ == VK_NULL_HANDLE) return {};
    const auto& vk = context_->vk;
    std::uint32_t index = 0;
    VkResult result =
        vk.vkAcquireNextImageKHR(context_->device, swapchain_, ~std::uint64_t{0}, acquired_, VK_NULL_HANDLE, &index);
    if (result == VK_ERROR_OUT_OF_DATE_KHR) return create_swapchain();
    if (result != VK_SUCCESS && result != VK_SUBOPTIMAL_KHR)
        return render::vulkan_failure(result, "vkAcquireNextImageKHR");
    if (auto begun = commands_.begin(); !begun) return begun;
    record_copy(commands_.handle, picture, size, images_[index]);
    if (auto submitted = commands_.submit(acquired_, copied_); !submitted) return submitted;
    VkPresentInfoKHR present{VK_STRUCTURE_TYPE_PRESENT_INFO_KHR};
    present.waitSemaphoreCount = 1;
    present.pWaitSemaphores = &copied_;
    present.swapchainCount = 1;
    present.pSwapchains = &swapchain_;
    present.pImageIndices = &index;
    result = vk.vkQueuePresentKHR(context_->queue, &present);
    if (auto done = commands_.wait(); !done) return done;
    if (result == VK_ERROR_OUT_OF_DATE_KHR) return create_swapchain();
    if (result != VK_SUCCESS && result != VK_SUBOPTIMAL_KHR) return render::vulkan_failure(result, "vkQueuePresentKHR");
    return {};
}

}  // namespace crofton::viewer
