// SPDX-License-Identifier: MIT
#include <crofton/render/resources.hpp>

#include <algorithm>
#include <cstring>

namespace crofton::render {
namespace {

Result<VkDeviceMemory> allocate(const VulkanContext& context, const VkMemoryRequirements& needs,
                                VkMemoryPropertyFlags wanted, VkMemoryPropertyFlags fallback, bool& host_visible) {
    std::uint32_t type = context.memory_type(needs.memoryTypeBits, wanted);
    if (type == ~0u) type = context.memory_type(needs.memoryTypeBits, fallback);
    if (type == ~0u)
        return fail(ErrorCode::unsupported, kNoItem, {context.name, ": no suitable kind of device memory"});
    host_visible = (context.memory.memoryTypes[type].propertyFlags & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT) != 0;
    VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
    info.allocationSize = needs.size;
    info.memoryTypeIndex = type;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    if (const VkResult result = context.vk.vkAllocateMemory(context.device, &info, nullptr, &memory);
        result != VK_SUCCESS)
        return vulkan_failure(result, "vkAllocateMemory");
    return memory;
}

}  // namespace

Buffer::~Buffer() {
    if (context_ == nullptr) return;
    context_->vk.vkDestroyBuffer(context_->device, handle, nullptr);
    context_->vk.vkFreeMemory(context_->device, memory_, nullptr);
}

Result<Buffer> Buffer::create(const VulkanContext& context, VkDeviceSize size, VkBufferUsageFlags usage,
                              VkMemoryPropertyFlags wanted, VkMemoryPropertyFlags fallback) {
    Buffer buffer;
    buffer.context_ = &context;
    buffer.size = size;
    VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
    info.size = size;
    info.usage = usage;
    const auto& vk = context.vk;
    if (const VkResult result = vk.vkCreateBuffer(context.device, &info, nullptr, &buffer.handle); result != VK_SUCCESS)
        return vulkan_failure(result, "vkCreateBuffer");
    VkMemoryRequirements needs;
    vk.vkGetBufferMemoryRequirements(context.device, buffer.handle, &needs);
    bool host_visible = false;
    auto memory = allocate(context, needs, wanted, fallback, host_visible);
    if (!memory) return std::move(memory.error());
    buffer.memory_ = *memory;
    if (const VkResult result = vk.vkBindBufferMemory(context.device, buffer.handle, buffer.memory_, 0);
        result != VK_SUCCESS)
        return vulkan_failure(result, "vkBindBufferMemory");
    if (host_visible && (wanted & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT) != 0) {
        void* data = nullptr;
        if (const VkResult result = vk.vkMapMemory(context.device, buffer.memory_, 0, VK_WHOLE_SIZE, 0, &data);
            result != VK_SUCCESS)
            return vulkan_failure(result, "vkMapMemory");
        buffer.mapped = static_cast<std::byte*>(data);
    }
    return buffer;
}

Result<Buffer> create_host_buffer(const VulkanContext& context, VkDeviceSize size, VkBufferUsageFlags usage) {
    constexpr VkMemoryPropertyFlags kHost = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    // Cached memory is many times faster to read back from.
    const VkMemoryPropertyFlags extra = (usage & VK_BUFFER_USAGE_TRANSFER_DST_BIT) != 0
                                            ? VK_MEMORY_PROPERTY_HOST_CACHED_BIT
                                            : VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
    return Buffer::create(context, size, usage, kHost | extra, kHost);
}

Result<void> reserve_host_buffer(const VulkanContext& context, Buffer& buffer, VkDeviceSize size,
                                 VkBufferUsageFlags usage) {
    if (buffer.size >= size) return {};
    auto grown = create_host_buffer(context, std::max(size, buffer.size * 2), usage);
    if (!grown) return std::move(grown.error());
    buffer = std::move(*grown);
    return {};
}

Result<Buffer> create_static_buffer(const VulkanContext& context, const void* data, VkDeviceSize size,
                                    VkBufferUsageFlags usage) {
    auto staging = create_host_buffer(context, size, VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
    if (!staging) return staging;
    std::memcpy(staging->mapped, data, size);
    auto buffer =
        Buffer::create(context, size, usage | VK_BUFFER_USAGE_TRANSFER_DST_BIT, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0);
    if (!buffer) return buffer;
    auto commands = Commands::create(context);
    if (!commands) return std::move(commands.error());
    if (auto begun = commands->begin(); !begun) return std::move(begun.error());
    const VkBufferCopy whole{0, 0, size};
    context.vk.vkCmdCopyBuffer(commands->handle, staging->handle, buffer->handle, 1, &whole);
    if (auto done = commands->submit_and_wait(); !done) return std::move(done.error());
    return buffer;
}

ImageResource::~ImageResource() {
    if (context_ == nullptr) return;
    context_->vk.vkDestroyImageView(context_->device, view, nullptr);
    context_->vk.vkDestroyImage(context_->device, handle, nullptr);
    context_->vk.vkFreeMemory(context_->device, memory_, nullptr);
}

Result<ImageResource> ImageResource::create(const VulkanContext& context, VkExtent2D extent, VkFormat format,
                                            VkImageUsageFlags usage, VkImageAspectFlags aspect) {
    ImageResource image;
    image.context_ = &context;
    VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = format;
    info.extent = {extent.width, extent.height, 1};
    info.mipLevels = 1;
    info.arrayLayers = 1;
    info.samples = VK_SAMPLE_COUNT_1_BIT;
    info.tiling = VK_IMAGE_TILING_OPTIMAL;
    info.usage = usage;
    const auto& vk = context.vk;
    if (const VkResult result = vk.vkCreateImage(context.device, &info, nullptr, &image.handle); result != VK_SUCCESS)
        return vulkan_failure(result, "vkCreateImage");
    VkMemoryRequirements needs;
    vk.vkGetImageMemoryRequirements(context.device, image.handle, &needs);
    bool host_visible = false;
    auto memory = allocate(context, needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0, host_visible);
    if (!memory) return std::move(memory.error());
    image.memory_ = *memory;
    if (const VkResult result = vk.vkBindImageMemory(context.device, image.handle, image.memory_, 0);
        result != VK_SUCCESS)
        return vulkan_failure(result, "vkBindImageMemory");
    VkImageViewCreateInfo view{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
    view.image = image.handle;
    view.viewType = VK_IMAGE_VIEW_TYPE_2D;
    view.format = format;
    view.subresourceRange = {aspect, 0, 1, 0, 1};
    if (const VkResult result = vk.vkCreateImageView(context.device, &view, nullptr, &image.view); result != VK_SUCCESS)
        return vulkan_failure(result, "vkCreateImageView");
    return image;
}

VkImageMemoryBarrier color_barrier(VkImage image, VkImageLayout from, VkImageLayout to, VkAccessFlags before,
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

Commands::~Commands() {
    if (context_ == nullptr) return;
    if (left_ == Left::pending) context_->vk.vkDeviceWaitIdle(context_->device);
    context_->vk.vkDestroyFence(context_->device, fence_, nullptr);
    if (handle != VK_NULL_HANDLE)
        context_->vk.vkFreeCommandBuffers(context_->device, context_->command_pool, 1, &handle);
}

Result<Commands> Commands::create(const VulkanContext& context) {
    Commands commands;
    commands.context_ = &context;
    VkCommandBufferAllocateInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    info.commandPool = context.command_pool;
    info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    info.commandBufferCount = 1;
    VkResult result = context.vk.vkAllocateCommandBuffers(context.device, &info, &commands.handle);
    if (result != VK_SUCCESS) return vulkan_failure(result, "vkAllocateCommandBuffers");
    const VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    result = context.vk.vkCreateFence(context.device, &fence, nullptr, &commands.fence_);
    if (result != VK_SUCCESS) return vulkan_failure(result, "vkCreateFence");
    return commands;
}

Result<void> Commands::recover() {
    const auto& vk = context_->vk;
    if (left_ == Left::recording) {
        const VkResult result = vk.vkResetCommandBuffer(handle, 0);
        if (result != VK_SUCCESS) return vulkan_failure(result, "vkResetCommandBuffer");
    } else if (left_ != Left::nothing) {
        return wait();
    }
    left_ = Left::nothing;
    return {};
}

Result<void> Commands::begin() {
    if (auto recovered = recover(); !recovered) return recovered;
    VkCommandBufferBeginInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    const VkResult result = context_->vk.vkBeginCommandBuffer(handle, &info);
    if (result != VK_SUCCESS) return vulkan_failure(result, "vkBeginCommandBuffer");
    left_ = Left::recording;
    return {};
}

Result<void> Commands::submit_and_wait() {
    if (auto submitted = submit(); !submitted) return submitted;
    return wait();
}

Result<void> Commands::submit(VkSemaphore wait, VkSemaphore signal) {
    const auto& vk = context_->vk;
    VkResult result = vk.vkEndCommandBuffer(handle);
    if (result != VK_SUCCESS) return vulkan_failure(result, "vkEndCommandBuffer");
    left_ = Left::nothing;
    VkSubmitInfo info{VK_STRUCTURE_TYPE_SUBMIT_INFO};
    info.commandBufferCount = 1;
    info.pCommandBuffers = &handle;
    constexpr VkPipelineStageFlags kWaiting = VK_PIPELINE_STAGE_TRANSFER_BIT;
    info.waitSemaphoreCount = wait != VK_NULL_HANDLE ? 1 : 0;
    info.pWaitSemaphores = &wait;
    info.pWaitDstStageMask = &kWaiting;
    info.signalSemaphoreCount = signal != VK_NULL_HANDLE ? 1 : 0;
    info.pSignalSemaphores = &signal;
    result = vk.vkQueueSubmit(context_->queue, 1, &info, fence_);
    if (result != VK_SUCCESS) return vulkan_failure(result, "vkQueueSubmit");
    left_ = Left::pending;
    return {};
}

Result<void> Commands::wait() {
    const auto& vk = context_->vk;
    VkResult result = vk.vkWaitForFences(context_->device, 1, &fence_, VK_TRUE, ~std::uint64_t{0});
    if (result != VK_SUCCESS) return vulkan_failure(result, "vkWaitForFences");
    left_ = Left::signalled;
    result = vk.vkResetFences(context_->device, 1, &fence_);
    if (result != VK_SUCCESS) return vulkan_failure(result, "vkResetFences");
    left_ = Left::nothing;
    return {};
}

}  // namespace crofton::render
