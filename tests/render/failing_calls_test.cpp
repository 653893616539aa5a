// SPDX-License-Identifier: MIT
// Every call of Vulkan fails once, while a picture is made ready and while it is drawn: an error that names the call,
// and the same device draws the same picture afterwards.
#include <crofton/render/clip_space.hpp>
#include <crofton/render/vulkan_context.hpp>
#include <cstdint>
#include <limits>

#include "test_device.hpp"

using namespace crofton;
using namespace crofton::render;

namespace {

constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
std::int64_t calls_left = kNever;  // until one fails; all that follow succeed
bool has_failed = false;

bool fails_now() {
    if (calls_left == kNever || calls_left-- > 0) return false;
    calls_left = kNever;
    has_failed = true;
    return true;
}

// Stands in the table of a device in a function's place.
template <auto kMember>
struct Call;
template <class... Arguments, VkResult (VKAPI_PTR* VolkDeviceTable::*kMember)(Arguments...)>
struct Call<kMember> {
    static inline VkResult(VKAPI_PTR* real)(Arguments...) = nullptr;
    static VKAPI_ATTR VkResult VKAPI_CALL call(Arguments... arguments) {
        return fails_now() ? VK_ERROR_OUT_OF_DEVICE_MEMORY : real(arguments...);
    }
    static void put_into(VolkDeviceTable& table) {
        if (table.*kMember == nullptr || table.*kMember == call) return;
        real = table.*kMember;
        table.*kMember = call;
    }
};
template <auto... kMembers>
void wrap(VolkDeviceTable& table) {
    (Call<kMembers>::put_into(table), ...);
}

// All whose result the engine asks for once there is a device.
void wrap_calls(Device& device) {
    using T = VolkDeviceTable;
    auto& table = const_cast<VulkanContext&>(device.context()).vk;
    wrap<&T::vkAllocateCommandBuffers, &T::vkAllocateDescriptorSets, &T::vkAllocateMemory, &T::vkBeginCommandBuffer,
         &T::vkBindBufferMemory, &T::vkBindImageMemory, &T::vkCreateBuffer, &T::vkCreateDescriptorPool,
         &T::vkCreateDescriptorSetLayout, &T::vkCreateFence, &T::vkCreateFramebuffer, &T::vkCreateGraphicsPipelines,
         &T::vkCreateImage, &T::vkCreateImageView, &T::vkCreatePipelineLayout, &T::vkCreateQueryPool,
         &T::vkCreateRenderPass, &T::vkCreateSampler, &T::vkCreateShaderModule, &T::vkEndCommandBuffer,
         &T::vkGetQueryPoolResults, &T::vkMapMemory, &T::vkQueueSubmit, &T::vkResetCommandBuffer, &T::vkResetFences,
         &T::vkWaitForFences>(table);
}

constexpr Vertex kOneTriangle[] = {
    {{-1, -1, 0}, {0, 0, 1}, {1, 0, 0}}, {{1, -1, 0}, {0, 0, 1}, {1, 0, 0}}, {{1, 1, 0}, {0, 0, 1}, {1, 0, 0}}};
constexpr std::uint32_t kItsIndices[] = {0, 1, 2};

Result<Rasterizer> make_ready(Device& device) {
    auto rasterizer = Rasterizer::create(device, {32, 32});
    if (!rasterizer) return rasterizer;
    if (auto set = rasterizer->set_geometry(kOneTriangle, kItsIndices); !set) return set.error();
    return rasterizer;
}

Result<Image> draw(Rasterizer& rasterizer) {
    Camera camera;
    camera.position = {0, 0, 3};
    camera.aspect = 1.0;
    const glm::dmat3 linear(1.0);
    DrawTransform transforms[] = {draw_transform(ModelToClip(camera)(linear, glm::dvec3(0.0)), linear)};
    const DrawRange ranges[] = {{.first_index = 0, .index_count = 3, .transform = 0}};
    const auto counters = rasterizer.draw({.camera = camera, .transforms = transforms, .ranges = ranges});
    if (!counters) return counters.error();
    CHECK(counters->input_assembly_primitives == 1);
    Image image;
    if (auto read = rasterizer.read_pixels(image); !read) return read.error();
    return image;
}

void check_message(const Error& error) {
    CAPTURE(error.message);
    CHECK(error.message.find("vk") != std::string::npos);
    CHECK(error.message.find("VK_ERROR_OUT_OF_DEVICE_MEMORY") != std::string::npos);
}

}  // namespace

TEST_SUITE("render/failing_calls") {
    TEST_CASE("each call fails once while a rasterizer is made: an error names it, and the next one draws") {
        CROFTON_REQUIRE_DEVICE(device);
        wrap_calls(*device);
        auto first = make_ready(*device).value();
        const auto expected = draw(first).value();
        for (std::int64_t n = 0;; ++n) {
            CAPTURE(n);
            has_failed = false;
            calls_left = n;
            auto made = make_ready(*device);
            calls_left = kNever;
            CHECK(made.has_value() == !has_failed);
            if (!made) check_message(made.error());
            auto again = made ? std::move(made) : make_ready(*device);
            REQUIRE(again.has_value());
            const auto image = draw(*again).value();
            CHECK(image.rgba == expected.rgba);
            if (!has_failed) {
                MESSAGE(n << " calls failed while a rasterizer was made");
                CHECK(n > 20);
                break;
            }
        }
        for (const std::string& text : device->validation_messages()) FAIL_CHECK(text);
    }

    TEST_CASE("each call fails once while a picture is drawn: an error names it, and the same rasterizer draws") {
        CROFTON_REQUIRE_DEVICE(device);
        wrap_calls(*device);
        auto rasterizer = make_ready(*device).value();
        const auto expected = draw(rasterizer).value();
        for (std::int64_t n = 0;; ++n) {
            CAPTURE(n);
            has_failed = false;
            calls_left = n;
            const auto image = draw(rasterizer);
            calls_left = kNever;
            CHECK(image.has_value() == !has_failed);
            if (!image) check_message(image.error());
            const auto again = draw(rasterizer).value();
            CHECK(again.rgba == expected.rgba);
            if (!has_failed) {
                MESSAGE(n << " calls failed while a picture was drawn");
                CHECK(n > 3);
                break;
            }
        }
        for (const std::string& text : device->validation_messages()) FAIL_CHECK(text);
    }
}
