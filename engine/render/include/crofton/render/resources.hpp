// SPDX-License-Identifier: MIT
// Native resources that free themselves, for drawing code besides the rasterizer: buffers, images, commands.
#pragma once
#include <crofton/render/vulkan_context.hpp>
#include <cstddef>
#include <utility>

namespace crofton::render {

// A buffer with its own memory; `mapped` is null if the host cannot access it. Movable, empty by default.
class Buffer {
  public:
    Buffer() = default;
    Buffer(Buffer&& other) noexcept { swap(other); }
    Buffer& operator=(Buffer&& other) noexcept {
        swap(other);
        return *this;
    }
    ~Buffer();

    // Creates a buffer in memory with all of `wanted`, or with `fallback` if there is none.
    [[nodiscard]] static Result<Buffer> create(const VulkanContext& context, VkDeviceSize size,
                                               VkBufferUsageFlags usage, VkMemoryPropertyFlags wanted,
                                               VkMemoryPropertyFlags fallback);

    // Names the buffer for debuggers, if the device has labels.
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

// Creates a buffer that the host writes and the device reads (or the other way round), coherent.
[[nodiscard]] Result<Buffer> create_host_buffer(const VulkanContext& context, VkDeviceSize size,
                                                VkBufferUsageFlags usage);
// Makes a host buffer at least `size` bytes; if it grows, its contents are lost.
[[nodiscard]] Result<void> reserve_host_buffer(const VulkanContext& context, Buffer& buffer, VkDeviceSize size,
                                               VkBufferUsageFlags usage);
// Creates a buffer that only the device accesses, filled once through a staging copy.
[[nodiscard]] Result<Buffer> create_static_buffer(const VulkanContext& context, const void* data, VkDeviceSize size,
                                                  VkBufferUsageFlags usage);

// The colour order of windows, the only one on X11: a picture is copied there byte by byte.
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

    // Names the image and its view for debuggers, if the device has labels.
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

// Returns a barrier for a colour image of one level: it makes `before` visible to `after`, in another layout.
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
    // Begins recording. After a failed call, it first waits for and resets what that call left.
    [[nodiscard]] Result<void> begin();
    // Submits the commands. Transfers wait for `wait`; `signal` is signalled at the end. Either may be null.
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
    // The unfinished state that must end before the commands can be used again.
    enum class Left : std::uint8_t { nothing, recording, pending, signalled };
    [[nodiscard]] Result<void> recover();

    const VulkanContext* context_ = nullptr;
    VkFence fence_ = VK_NULL_HANDLE;
    Left left_ = Left::nothing;
};

}  // namespace crofton::render
