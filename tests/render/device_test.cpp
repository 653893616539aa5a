// SPDX-License-Identifier: MIT
#include <crofton/core/error.hpp>
#include <crofton/render/vulkan_context.hpp>
#include <cstdlib>
#include <error_of.hpp>
#include <string>

#include "test_device.hpp"

using namespace crofton;
using namespace crofton::render;

namespace {

// Sets an environment variable for the life of the object.
class ScopedVariable {
  public:
    ScopedVariable(const char* name, const char* value) : name_(name) {
        if (const char* old = std::getenv(name)) old_ = old, had_ = true;
        setenv(name, value, 1);
    }
    ~ScopedVariable() { had_ ? setenv(name_, old_.c_str(), 1) : unsetenv(name_); }

  private:
    const char* name_;
    std::string old_;
    bool had_ = false;
};

}  // namespace

TEST_SUITE("render/device") {
    TEST_CASE("without any driver, creation fails with a message that says what to install") {
        const ScopedVariable drivers("VK_ICD_FILENAMES", "/nonexistent.json");
        const ScopedVariable drivers_too("VK_DRIVER_FILES", "/nonexistent.json");
        const auto device = Device::create();
        REQUIRE_FALSE(device);
        CHECK(error_of(device).code == ErrorCode::unavailable);
        CHECK(error_of(device).message.find("mesa-vulkan-drivers") != std::string::npos);
    }
    TEST_CASE("an instance has the labels' extension if it is requested or validated, and not otherwise") {
        // A function of an extension that is not enabled has no address.
        const auto has_labels = [](const DeviceOptions& options) {
            const auto device = Device::create(options).value();
            return vkGetInstanceProcAddr(device.context().instance, "vkCreateDebugUtilsMessengerEXT") != nullptr;
        };
        CROFTON_REQUIRE_DEVICE(validated);
        DeviceOptions options = device_options();
        CHECK_FALSE(has_labels(options));
        options.instance_extensions = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME};
        CHECK(has_labels(options));
        options.validation = true;
        CHECK(has_labels(options));
        options.instance_extensions.clear();
        CHECK(has_labels(options));
    }
    TEST_CASE("a name that no device has is refused, and the message lists the devices there are") {
        CROFTON_REQUIRE_DEVICE(device);
        DeviceOptions options;
        options.name = "no such device";
        auto refused = Device::create(options);
        REQUIRE_FALSE(refused);
        CHECK(error_of(refused).code == ErrorCode::unavailable);
        CHECK(error_of(refused).message.find(device->name()) != std::string::npos);
        const ScopedVariable wish("CROFTON_DEVICE", "no such device");
        CHECK_FALSE(Device::create());
    }
    TEST_CASE("a device is found by part of its name in any case, and by CROFTON_DEVICE") {
        CROFTON_REQUIRE_LAVAPIPE(device);
        DeviceOptions options;
        options.name = "LLVMpipe";
        const auto by_name = Device::create(options).value();
        CHECK(by_name.counts_exactly());
        const ScopedVariable wish("CROFTON_DEVICE", "cpu");
        const auto by_variable = Device::create().value();
        CHECK(by_variable.name() == device->name());
    }
    TEST_CASE("an extension that the device lacks is named") {
        CROFTON_REQUIRE_DEVICE(device);
        DeviceOptions options;
        options.device_extensions = {"VK_NO_such_extension"};
        const auto refused = Device::create(options);
        REQUIRE_FALSE(refused);
        CHECK(error_of(refused).code == ErrorCode::unsupported);
        CHECK(error_of(refused).message.find("VK_NO_such_extension") != std::string::npos);
    }
    TEST_CASE("a Vulkan error becomes an error of its kind that names the call") {
        const auto code = [](VkResult result) { return vulkan_error(result, "vkQueueSubmit").code; };
        CHECK(code(VK_ERROR_DEVICE_LOST) == ErrorCode::unavailable);
        CHECK(code(VK_ERROR_SURFACE_LOST_KHR) == ErrorCode::unavailable);
        CHECK(code(VK_ERROR_OUT_OF_HOST_MEMORY) == ErrorCode::out_of_range);
        CHECK(code(VK_ERROR_OUT_OF_DEVICE_MEMORY) == ErrorCode::out_of_range);
        CHECK(code(VK_ERROR_INITIALIZATION_FAILED) == ErrorCode::internal);
        CHECK(code(VK_TIMEOUT) == ErrorCode::internal);
        const std::string lost = vulkan_error(VK_ERROR_DEVICE_LOST, "vkQueueSubmit").message;
        CHECK(lost.find("vkQueueSubmit: VK_ERROR_DEVICE_LOST") == 0);
        CHECK(lost.find("create a new one") != std::string::npos);
        CHECK(vulkan_error(VK_TIMEOUT, "vkWaitForFences").message == "vkWaitForFences: VK_TIMEOUT");
    }
    TEST_CASE("the validation layer is alive: a deliberate hazard is reported") {
        CROFTON_REQUIRE_DEVICE(device);
        set_log_handler([](void*, LogLevel, std::string_view) {}, nullptr);
        const VulkanContext& context = device->context();
        const auto& vk = context.vk;
        VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
        info.size = 256;
        info.usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT;
        VkBuffer buffer;
        REQUIRE(vk.vkCreateBuffer(context.device, &info, nullptr, &buffer) == VK_SUCCESS);
        VkMemoryRequirements needs;
        vk.vkGetBufferMemoryRequirements(context.device, buffer, &needs);
        VkMemoryAllocateInfo memory_info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
        memory_info.allocationSize = needs.size;
        memory_info.memoryTypeIndex = context.memory_type(needs.memoryTypeBits, 0);
        VkDeviceMemory memory;
        REQUIRE(vk.vkAllocateMemory(context.device, &memory_info, nullptr, &memory) == VK_SUCCESS);
        REQUIRE(vk.vkBindBufferMemory(context.device, buffer, memory, 0) == VK_SUCCESS);
        VkCommandBufferAllocateInfo commands_info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
        commands_info.commandPool = context.command_pool;
        commands_info.commandBufferCount = 1;
        VkCommandBuffer commands;
        REQUIRE(vk.vkAllocateCommandBuffers(context.device, &commands_info, &commands) == VK_SUCCESS);
        const VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
        vk.vkBeginCommandBuffer(commands, &begin);
        // Two writes to the same bytes with no barrier between them.
        vk.vkCmdFillBuffer(commands, buffer, 0, 256, 1);
        vk.vkCmdFillBuffer(commands, buffer, 0, 256, 2);
        vk.vkEndCommandBuffer(commands);
        bool found = false;
        for (const std::string& message : device->validation_messages())
            found |= message.find("SYNC-HAZARD-WRITE-AFTER-WRITE") != std::string::npos;
        CHECK(found);
        vk.vkFreeCommandBuffers(context.device, context.command_pool, 1, &commands);
        vk.vkDestroyBuffer(context.device, buffer, nullptr);
        vk.vkFreeMemory(context.device, memory, nullptr);
        set_log_handler(nullptr, nullptr);
    }
}
