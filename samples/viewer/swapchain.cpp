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
namespace {

tl::unexpected<Error> vulkan_failure(VkResult result, const char* what) {
    return tl::unexpected(render::vulkan_error(result, what));
}

VkImageMemoryBarrier barrier_of(VkImage image, VkImageLayout from, VkImageLayout to, VkAccessFlags before,
                                VkAccessFlags after) {
    VkImageMemoryBarrier barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
    barrier.srcAccessMask = before;
    barrier.dstAccessMask = after;
    barrier.oldLayout = from;
    barrier.newLayout = to;
    barrier.srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = image;
    barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    return barrier;
}

}  // namespace

Result<void> Window::attach(const render::VulkanContext& context) {
    context_ = &context;
    VkResult result = glfwCreateWindowSurface(context.instance, window_, nullptr, &surface_);
    if (result != VK_SUCCESS) return vulkan_failure(result, "glfwCreateWindowSurface");
    VkBool32 supported = VK_FALSE;
    vkGetPhysicalDeviceSurfaceSupportKHR(context.physical_device, context.queue_family, surface_, &supported);
    if (supported != VK_TRUE)
        return fail(ErrorCode::unsupported, kNoItem,
                    context.name +
                        ": the device cannot show pictures in this window; --device NAME takes another, --no-window "
                        "needs none");
    const auto& vk = context.vk;
    VkCommandBufferAllocateInfo commands{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    commands.commandPool = context.command_pool;
    commands.commandBufferCount = 1;
    const VkSemaphoreCreateInfo semaphore{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    const VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    result = vk.vkAllocateCommandBuffers(context.device, &commands, &commands_);
    if (result == VK_SUCCESS) result = vk.vkCreateSemaphore(context.device, &semaphore, nullptr, &acquired_);
    if (result == VK_SUCCESS) result = vk.vkCreateSemaphore(context.device, &semaphore, nullptr, &copied_);
    if (result == VK_SUCCESS) result = vk.vkCreateFence(context.device, &fence, nullptr, &done_);
    if (result != VK_SUCCESS) return vulkan_failure(result, "what presenting needs");
    return create_swapchain();
}

void Window::detach() {
    if (context_ == nullptr) return;
    const auto& vk = context_->vk;
    vk.vkDeviceWaitIdle(context_->device);
    vk.vkDestroyFence(context_->device, std::exchange(done_, VK_NULL_HANDLE), nullptr);
    vk.vkDestroySemaphore(context_->device, std::exchange(acquired_, VK_NULL_HANDLE), nullptr);
    vk.vkDestroySemaphore(context_->device, std::exchange(copied_, VK_NULL_HANDLE), nullptr);
    if (commands_ != VK_NULL_HANDLE) vk.vkFreeCommandBuffers(context_->device, context_->command_pool, 1, &commands_);
    commands_ = VK_NULL_HANDLE;
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
    if (result != VK_SUCCESS) return vulkan_failure(result, "vkGetPhysicalDeviceSurfaceCapabilitiesKHR");
    const VkExtent2D wanted = framebuffer_size();
    extent_ = {std::clamp(wanted.width, capabilities.minImageExtent.width, capabilities.maxImageExtent.width),
               std::clamp(wanted.height, capabilities.minImageExtent.height, capabilities.maxImageExtent.height)};
    if (extent_.width == 0 || extent_.height == 0) return {};

    std::uint32_t count = 0;
    vkGetPhysicalDeviceSurfaceFormatsKHR(context_->physical_device, surface_, &count, nullptr);
    std::vector<VkSurfaceFormatKHR> formats(count);
    vkGetPhysicalDeviceSurfaceFormatsKHR(context_->physical_device, surface_, &count, formats.data());
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
    if (result != VK_SUCCESS) return vulkan_failure(result, "vkCreateSwapchainKHR");
    vk.vkGetSwapchainImagesKHR(context_->device, swapchain_, &count, nullptr);
    images_.resize(count);
    vk.vkGetSwapchainImagesKHR(context_->device, swapchain_, &count, images_.data());
    return {};
}

void Window::record_copy(VkCommandBuffer commands, VkImage picture, VkExtent2D size, VkImage onto) const {
    const auto& vk = context_->vk;
    constexpr VkPipelineStageFlags kTransfer = VK_PIPELINE_STAGE_TRANSFER_BIT;
    const std::array before{
        barrier_of(picture, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                   VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT, VK_ACCESS_TRANSFER_READ_BIT),
        barrier_of(onto, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 0,
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
        barrier_of(picture, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                   VK_ACCESS_TRANSFER_READ_BIT, VK_ACCESS_SHADER_READ_BIT),
        barrier_of(onto, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR,
                   VK_ACCESS_TRANSFER_WRITE_BIT, 0)};
    vk.vkCmdPipelineBarrier(commands, kTransfer,
                            VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT | VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, 0, 0, nullptr,
                            0, nullptr, static_cast<std::uint32_t>(after.size()), after.data());
}

VkResult Window::try_present(VkImage picture, VkExtent2D size) {
    const auto& vk = context_->vk;
    std::uint32_t index = 0;
    VkResult result =
        vk.vkAcquireNextImageKHR(context_->device, swapchain_, ~std::uint64_t{0}, acquired_, VK_NULL_HANDLE, &index);
    if (result != VK_SUCCESS && result != VK_SUBOPTIMAL_KHR) return result;
    VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    vk.vkBeginCommandBuffer(commands_, &begin);
    record_copy(commands_, picture, size, images_[index]);
    result = vk.vkEndCommandBuffer(commands_);
    if (result != VK_SUCCESS) return result;
    const VkPipelineStageFlags wait_stage = VK_PIPELINE_STAGE_TRANSFER_BIT;
    VkSubmitInfo submit{VK_STRUCTURE_TYPE_SUBMIT_INFO};
    submit.waitSemaphoreCount = 1;
    submit.pWaitSemaphores = &acquired_;
    submit.pWaitDstStageMask = &wait_stage;
    submit.commandBufferCount = 1;
    submit.pCommandBuffers = &commands_;
    submit.signalSemaphoreCount = 1;
    submit.pSignalSemaphores = &copied_;
    result = vk.vkQueueSubmit(context_->queue, 1, &submit, done_);
    if (result != VK_SUCCESS) return result;
    VkPresentInfoKHR present{VK_STRUCTURE_TYPE_PRESENT_INFO_KHR};
    present.waitSemaphoreCount = 1;
    present.pWaitSemaphores = &copied_;
    present.swapchainCount = 1;
    present.pSwapchains = &swapchain_;
    present.pImageIndices = &index;
    const VkResult presented = vk.vkQueuePresentKHR(context_->queue, &present);
    result = vk.vkWaitForFences(context_->device, 1, &done_, VK_TRUE, ~std::uint64_t{0});
    vk.vkResetFences(context_->device, 1, &done_);
    return result != VK_SUCCESS ? result : presented;
}

Result<void> Window::present(VkImage picture, VkExtent2D size) {
    const VkExtent2D now = framebuffer_size();
    if (now.width == 0 || now.height == 0) return {};
    // X11 tells of a new size by the callback only, not through the swapchain.
    if (now.width != extent_.width || now.height != extent_.height)
        if (auto made = create_swapchain(); !made) return made;
    if (swapchain_ == VK_NULL_HANDLE) return {};
    const VkResult result = try_present(picture, size);
    if (result == VK_SUCCESS || result == VK_SUBOPTIMAL_KHR) return {};
    if (result == VK_ERROR_OUT_OF_DATE_KHR) return create_swapchain();
    return vulkan_failure(result, "presenting the picture");
}

}  // namespace crofton::viewer
