// SPDX-License-Identifier: MIT
// The Vulkan instance: loader, driver, validation.
#pragma once
#include <crofton/render/device.hpp>
#include <crofton/render/vulkan_context.hpp>

namespace crofton::render {

// Fills instance and messenger. Errors: as Device::create.
[[nodiscard]] Result<void> create_instance(VulkanContext& context, const DeviceOptions& options);

// Fills labels where the extension is on; after the device is made.
void load_labels(VulkanContext& context, const DeviceOptions& options);

// Chooses physical_device and the queue family, and notes what they can do. Errors: as Device::create.
[[nodiscard]] Result<void> choose_physical_device(VulkanContext& context, const DeviceOptions& options);

}  // namespace crofton::render
