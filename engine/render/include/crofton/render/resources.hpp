// SPDX-License-Identifier: MIT
// Native resources that free themselves, for those who draw beside the rasterizer: buffers, images, commands.
#pragma once
#include <crofton/render/vulkan_context.hpp>
#include <cstddef>
#include <utility>

namespace crofton::render {

// A buffer with its own memory; `mapped` is null where the host cannot see it. Movable, empty by default.
class Buffer {
  public:
    Buffer() = default;
    Buffer(Buffer&& other) noexcept { swap(other); }
    Buffer& operator=(Buffer&& other) noexcept {
        swap(other);
        return *this;
    }
    ~Buffer();

    // `wanted` first, `fallback` where no memory has all of it.
    [[nodiscard]] static Result<Buffer> create(const VulkanContext& context, VkDeviceSize size,
                                               VkBufferUsageFlags usage, VkMemoryPropertyFlags wanted,
                                               VkMemoryPropertyFlags fallback);

    // In debuggers, where the device has labels.
    void name(const char* text) const {
        if (context_ != nullptr) context_->labels.name(context_->device, VK_OBJECT_TYPE_BUFFER, handle, text);
    }

    VkBuffer handle = VK_NULL_HANDLE;
    VkDeviceSize size = 0;
    std::byte* mapped = nullptr;

  private:
    void swap(Buffer& other) noexcept {
        std::swap(handle, other.handle);
        std::swap(size, other.size);
        std::swap(mapped, other.mapped);
        std::swap(context_, other.context_);
        std::swap(memory_, other.memory_);
    }
    const VulkanContext* context_ = nullptr;
    VkDeviceMemory memory_ = VK_NULL_HANDLE;
};

// Memory that the host writes and the device reads (or the other way round), coherent.
[[nodiscard]] Result<Buffer> create_host_buffer(const VulkanContext& context, VkDeviceSize size,
                                                VkBufferUsageFlags usage);
// Makes a host buffer at least `size` bytes; what it held is lost where it grows.
[[nodiscard]] Result<void> reserve_host_buffer(const VulkanContext& context, Buffer& buffer, VkDeviceSize size,
                                               VkBufferUsageFlags usage);
// Memory that only the device touches, filled once through a staging copy.
[[nodiscard]] Result<Buffer> create_static_buffer(const VulkanContext& context, const void* data, VkDeviceSize size,
                                                  VkBufferUsageFlags usage);

// The order of colours that windows take, on X11 alone so: a picture goes there by a copy of its bytes.
inline constexpr VkFormat kColorFormat = VK_FORMAT_B8G8R8A8_UNORM;

// A 2D image of one level with its memory and view.
class ImageResource {
  public:
    ImageResource() = default;
    ImageResource(ImageResource&& other) noexcept { swap(other); }
    ImageResource& operator=(ImageResource&& other) noexcept {
        swap(other);
        return *this;
    }
    ~ImageResource();

    [[nodiscard]] static Result<ImageResource> create(const VulkanContext& context, VkExtent2D extent, VkFormat format,
                                                      VkImageUsageFlags usage, VkImageAspectFlags aspect);

    // In debuggers, where the device has labels: the image and its view.
    void name(const char* text) const {
        if (context_ == nullptr) return;
        context_->labels.name(context_->device, VK_OBJECT_TYPE_IMAGE, handle, text);
        context_->labels.name(context_->device, VK_OBJECT_TYPE_IMAGE_VIEW, view, text);
    }

    VkImage handle = VK_NULL_HANDLE;
    VkImageView view = VK_NULL_HANDLE;

  private:
    void swap(ImageResource& other) noexcept {
        std::swap(handle, other.handle);
        std::swap(view, other.view);
        std::swap(context_, other.context_);
        std::swap(memory_, other.memory_);
    }
    const VulkanContext* context_ = nullptr;
    VkDeviceMemory memory_ = VK_NULL_HANDLE;
};

// Of a colour image's one level: `before` is made visible to `after`, in another layout.
[[nodiscard]] VkImageMemoryBarrier color_barrier(VkImage image, VkImageLayout from, VkImageLayout to,
                                                 VkAccessFlags before, VkAccessFlags after);

// A command buffer and its fence: recorded, submitted, waited for.
class Commands {
  public:
    Commands() = default;
    Commands(Commands&& other) noexcept { swap(other); }
    Commands& operator=(Commands&& other) noexcept {
        swap(other);
        return *this;
    }
    ~Commands();

    [[nodiscard]] static Result<Commands> create(const VulkanContext& context);
    // Also after a call that failed: what that one left is waited for and taken back first.
    [[nodiscard]] Result<void> begin();
    // Transfers wait for `wait`; `signal` tells that all is done. Either may be null.
    [[nodiscard]] Result<void> submit(VkSemaphore wait = VK_NULL_HANDLE, VkSemaphore signal = VK_NULL_HANDLE);
    [[nodiscard]] Result<void> wait();  // once after each submit()
    [[nodiscard]] Result<void> submit_and_wait();

    VkCommandBuffer handle = VK_NULL_HANDLE;

  private:
    void swap(Commands& other) noexcept {
        std::swap(handle, other.handle);
        std::swap(context_, other.context_);
        std::swap(fence_, other.fence_);
        std::swap(left_, other.left_);
    }
    // What has been begun, and would have to be ended before the commands can be used again.
    enum class Left : std::uint8_t { nothing, recording, pending, signalled };
    [[nodiscard]] Result<void> recover();

    const VulkanContext* context_ = nullptr;
    VkFence fence_ = VK_NULL_HANDLE;
    Left left_ = Left::nothing;
};

}  // namespace crofton::render
