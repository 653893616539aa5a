// SPDX-License-Identifier: MIT
// Names and labels as the driver's side hears them, the validation layer between: its complaints fail the test.
#include <algorithm>
#include <crofton/render/clip_space.hpp>
#include <crofton/render/vulkan_context.hpp>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <crofton/render/resources.hpp>

#include "test_device.hpp"

using namespace crofton;
using namespace crofton::render;

namespace {

std::map<std::pair<VkObjectType, std::uint64_t>, std::string> heard_names;
std::vector<std::string> heard_labels;  // "+text" and "-"
DebugLabels real_labels;

VKAPI_ATTR VkResult VKAPI_CALL hear_name(VkDevice device, const VkDebugUtilsObjectNameInfoEXT* info) {
    heard_names[{info->objectType, info->objectHandle}] = info->pObjectName;
    return real_labels.set_name(device, info);
}
VKAPI_ATTR void VKAPI_CALL hear_begin(VkCommandBuffer commands, const VkDebugUtilsLabelEXT* label) {
    heard_labels.push_back("+" + std::string(label->pLabelName));
    real_labels.begin(commands, label);
}
VKAPI_ATTR void VKAPI_CALL hear_end(VkCommandBuffer commands) {
    heard_labels.emplace_back("-");
    real_labels.end(commands);
}

void listen(Device& device) {
    auto& labels = const_cast<VulkanContext&>(device.context()).labels;
    real_labels = labels;
    heard_names.clear();
    heard_labels.clear();
    labels = {hear_name, hear_begin, hear_end};
}

// All handles of one kind that the rasterizer was given, taken from the device's own function.
std::set<std::uint64_t> made_buffers, made_pipelines;
PFN_vkCreateBuffer real_create_buffer;
PFN_vkCreateGraphicsPipelines real_create_pipelines;
VKAPI_ATTR VkResult VKAPI_CALL note_buffer(VkDevice device, const VkBufferCreateInfo* info,
                                           const VkAllocationCallbacks* hook, VkBuffer* buffer) {
    const VkResult result = real_create_buffer(device, info, hook, buffer);
    // Staging buffers live for one copy.
    if (info->usage != VK_BUFFER_USAGE_TRANSFER_SRC_BIT) made_buffers.insert((std::uint64_t)*buffer);
    return result;
}
VKAPI_ATTR VkResult VKAPI_CALL note_pipelines(VkDevice device, VkPipelineCache cache, std::uint32_t count,
                                              const VkGraphicsPipelineCreateInfo* infos,
                                              const VkAllocationCallbacks* hook, VkPipeline* pipelines) {
    const VkResult result = real_create_pipelines(device, cache, count, infos, hook, pipelines);
    for (std::uint32_t i = 0; i < count; ++i) made_pipelines.insert((std::uint64_t)pipelines[i]);
    return result;
}
void note_objects(Device& device) {
    auto& vk = const_cast<VulkanContext&>(device.context()).vk;
    real_create_buffer = std::exchange(vk.vkCreateBuffer, note_buffer);
    real_create_pipelines = std::exchange(vk.vkCreateGraphicsPipelines, note_pipelines);
    made_buffers.clear();
    made_pipelines.clear();
}

constexpr Vertex kLabelledTriangle[] = {
    {{-1, -1, 0}, {0, 0, 1}, {1, 0, 0}}, {{1, -1, 0}, {0, 0, 1}, {1, 0, 0}}, {{1, 1, 0}, {0, 0, 1}, {1, 0, 0}}};
constexpr std::uint32_t kLabelledIndices[] = {0, 1, 2};

// A frame with all that a frame can have, at half the resolution, read back.
Image draw_labelled(Device& device) {
    auto rasterizer = Rasterizer::create(device, {32, 32}).value();
    REQUIRE(rasterizer.set_geometry(kLabelledTriangle, kLabelledIndices));
    REQUIRE(rasterizer.resize(32, 32, 0, 0.5f));
    Camera camera;
    camera.position = {0, 0, 3};
    camera.aspect = 1.0;
    const glm::dmat3 linear(1.0);
    const DrawTransform transforms[] = {draw_transform(ModelToClip(camera)(linear, glm::dvec3(0.0)), linear)};
    const DrawRange ranges[] = {{.first_index = 0, .index_count = 3, .transform = 0}};
    const LineVertex lines[] = {{{-1, 0, -3}, 0xffffffffu}, {{1, 0, -3}, 0xffffffffu}};
    REQUIRE(rasterizer.draw(
        {.camera = camera, .transforms = transforms, .ranges = ranges, .wire_ranges = ranges, .lines = lines}));
    Image image;
    REQUIRE(rasterizer.read_pixels(image));
    return image;
}

}  // namespace

TEST_SUITE("render/debug_labels") {
    TEST_CASE("with validation every buffer and pipeline that stays has a name, and so have images and queries") {
        CROFTON_REQUIRE_DEVICE(device);
        REQUIRE((device->context().labels.set_name != nullptr));
        note_objects(*device);
        listen(*device);
        draw_labelled(*device);
        CHECK(made_buffers.size() >= 5);
        CHECK(made_pipelines.size() >= 5);
        for (const std::uint64_t buffer : made_buffers) CHECK(heard_names.count({VK_OBJECT_TYPE_BUFFER, buffer}) == 1);
        for (const std::uint64_t pipeline : made_pipelines)
            CHECK(heard_names.count({VK_OBJECT_TYPE_PIPELINE, pipeline}) == 1);
        const auto has = [](VkObjectType type, const std::string& text) {
            return std::any_of(heard_names.begin(), heard_names.end(),
                               [&](const auto& heard) { return heard.first.first == type && heard.second == text; });
        };
        CHECK(has(VK_OBJECT_TYPE_IMAGE, "picture"));
        CHECK(has(VK_OBJECT_TYPE_IMAGE_VIEW, "picture as drawn"));
        CHECK(has(VK_OBJECT_TYPE_IMAGE, "depth"));
        CHECK(has(VK_OBJECT_TYPE_RENDER_PASS, "picture"));
        CHECK(has(VK_OBJECT_TYPE_QUERY_POOL, "samples passed"));
        CHECK(has(VK_OBJECT_TYPE_COMMAND_BUFFER, "frame"));
        for (const std::string& text : device->validation_messages()) FAIL_CHECK(text);
    }

    TEST_CASE("the passes of a frame are labelled, each inside the one it belongs to") {
        CROFTON_REQUIRE_DEVICE(device);
        listen(*device);
        draw_labelled(*device);
        std::vector<std::string> expected{"+picture", "+counted triangles", "-"};
        if (device->context().wireframe) expected.insert(expected.end(), {"+wires", "-"});
        expected.insert(expected.end(), {"+sky", "-", "+lines", "-", "+enlarge the picture", "-", "-",
                                         "+copy the picture to the host", "-"});
        CHECK(heard_labels == expected);
        for (const std::string& text : device->validation_messages()) FAIL_CHECK(text);
    }

    TEST_CASE("the validation layer calls a buffer by the name it was given") {
        CROFTON_REQUIRE_DEVICE(device);
        set_log_handler([](void*, LogLevel, std::string_view) {}, nullptr);
        const VulkanContext& context = device->context();
        auto made = create_host_buffer(context, 256, VK_BUFFER_USAGE_TRANSFER_DST_BIT);
        auto commands = Commands::create(context);
        REQUIRE((made && commands));
        made->name("written twice");
        REQUIRE(commands->begin());
        // No barrier between: the layer complains, and names the buffer.
        context.vk.vkCmdFillBuffer(commands->handle, made->handle, 0, 256, 1);
        context.vk.vkCmdFillBuffer(commands->handle, made->handle, 0, 256, 2);
        const auto messages = device->validation_messages();
        CHECK(std::any_of(messages.begin(), messages.end(),
                          [](const std::string& text) { return text.find("written twice") != std::string::npos; }));
        set_log_handler(nullptr, nullptr);
    }

    TEST_CASE(
        "without the extension there are no labels, with it asked for alone there are, and pictures are the same") {
        auto plain = make_device(false);
        if (!plain) {
            MESSAGE("skipped: " << plain.error().message);
            return;
        }
        CHECK((plain->context().labels.set_name == nullptr));
        CHECK((plain->context().labels.begin == nullptr));
        DeviceOptions options = device_options();
        options.instance_extensions = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME};
        auto labelled = Device::create(options).value();
        CHECK((labelled.context().labels.set_name != nullptr));
        const Image without = draw_labelled(*plain), with = draw_labelled(labelled);
        CHECK(without.rgba == with.rgba);
    }
}
