// SPDX-License-Identifier: MIT
// The Vulkan device, and the messages of its validation.
#pragma once
#include <crofton/core/error.hpp>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace crofton::render {

struct VulkanContext;  // native handles: see vulkan_context.hpp

enum class DeviceKind : std::uint8_t {
    any,  // discrete, then integrated, then virtual, then software
    cpu,  // a software device (lavapipe): the one whose triangle counters are predicted exactly
};

struct DeviceOptions {
    DeviceKind kind = DeviceKind::any;
    // Part of the device's name, ignoring case. If empty: the environment's CROFTON_DEVICE, if set ("cpu" selects the
    // kind); otherwise the best device of `kind`.
    std::string name;
    // Turns on VK_LAYER_KHRONOS_validation with synchronisation checks, and collects its messages.
    bool validation = false;
    // For windows: the extensions of the surface and the swapchain. VK_EXT_debug_utils, which validation includes,
    // gives objects and passes their names in debuggers.
    std::vector<std::string> instance_extensions;
    std::vector<std::string> device_extensions;
};

// A Vulkan 1.3 device with one graphics queue. It loads the driver at run time: without one, create() fails and the
// program continues. Not thread-safe: use a device on one thread at a time.
class Device {
  public:
    // Creates a device. Errors: unavailable – no Vulkan loader, no driver, no device of that kind or name, or the
    // validation layer is absent; unsupported – the device lacks Vulkan 1.3, a needed feature or extension.
    [[nodiscard]] static Result<Device> create(const DeviceOptions& options = {});
    ~Device();
    Device(Device&&) noexcept;
    Device& operator=(Device&&) noexcept;

    [[nodiscard]] const std::string& name() const;
    // Returns true for lavapipe, where `clipping_primitives` equals ClipPredictor's count. Other devices clip
    // differently.
    [[nodiscard]] bool counts_exactly() const;
    // Returns all messages of severity WARNING or above since creation; empty if validation is off.
    [[nodiscard]] std::span<const std::string> validation_messages() const;
    [[nodiscard]] const VulkanContext& context() const;

  private:
    explicit Device(std::unique_ptr<VulkanContext> context);
    std::unique_ptr<VulkanContext> context_;
};

}  // namespace crofton::render
