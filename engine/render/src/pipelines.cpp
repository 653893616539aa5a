// SPDX-License-Identifier: MIT
#include "pipelines.hpp"

#include <array>
#include <crofton/render/clip_space.hpp>
#include <crofton/render/graphics_pipeline.hpp>
#include <crofton/render/rasterizer.hpp>
#include <cstddef>

#include "packed_vertex.hpp"
#include "shaders/line.frag.h"
#include "shaders/line.vert.h"
#include "shaders/owner.frag.h"
#include "shaders/owner.vert.h"
#include "shaders/scene.frag.h"
#include "shaders/scene.vert.h"
#include "shaders/sky.frag.h"
#include "shaders/sky.vert.h"

namespace crofton::render {
namespace {

Result<void> create_layout(Pipelines& pipelines) {
    const VulkanContext& context = pipelines.context;
    const VkPushConstantRange constants{VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0,
                                        kPushConstantBytes};
    VkPipelineLayoutCreateInfo layout{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    layout.pushConstantRangeCount = 1;
    layout.pPushConstantRanges = &constants;
    const VkResult result = context.vk.vkCreatePipelineLayout(context.device, &layout, nullptr, &pipelines.layout);
    if (result != VK_SUCCESS) return vulkan_failure(result, "vkCreatePipelineLayout");
    return {};
}

// The draw's transform comes as attributes that step once an instance. Software devices fetch those once for eight
// vertices, and a storage buffer once for each.
constexpr std::array<VkVertexInputBindingDescription, 2> kVertexBindings{{
    {0, sizeof(PackedVertex), VK_VERTEX_INPUT_RATE_VERTEX},
    {1, sizeof(DrawTransform), VK_VERTEX_INPUT_RATE_INSTANCE},
}};
constexpr VkFormat kFloat4 = VK_FORMAT_R32G32B32A32_SFLOAT;
constexpr std::array<VkVertexInputAttributeDescription, 11> kVertexAttributes{{
    {0, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(PackedVertex, position)},
    {1, 0, VK_FORMAT_A2B10G10R10_SNORM_PACK32, offsetof(PackedVertex, normal)},
    {2, 0, VK_FORMAT_A2B10G10R10_UNORM_PACK32, offsetof(PackedVertex, color)},
    {3, 1, kFloat4, offsetof(DrawTransform, to_clip)},
    {4, 1, kFloat4, offsetof(DrawTransform, to_clip) + 16},
    {5, 1, kFloat4, offsetof(DrawTransform, to_clip) + 32},
    {6, 1, kFloat4, offsetof(DrawTransform, to_clip) + 48},
    {7, 1, kFloat4, offsetof(DrawTransform, normal)},
    {8, 1, kFloat4, offsetof(DrawTransform, normal) + 16},
    {9, 1, kFloat4, offsetof(DrawTransform, normal) + 32},
    {10, 1, kFloat4, offsetof(DrawTransform, tint_share)},
}};
// Those that decide where a triangle lies and what number it has.
constexpr std::array<VkVertexInputAttributeDescription, 6> kOwnerAttributes{
    kVertexAttributes[0], kVertexAttributes[3], kVertexAttributes[4],
    kVertexAttributes[5], kVertexAttributes[6], kVertexAttributes[10]};
constexpr std::array<VkVertexInputBindingDescription, 1> kLineBindings{
    {{0, sizeof(LineVertex), VK_VERTEX_INPUT_RATE_VERTEX}}};
constexpr std::array<VkVertexInputAttributeDescription, 2> kLineAttributes{{
    {0, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(LineVertex, position)},
    {1, 0, VK_FORMAT_R8G8B8A8_UNORM, offsetof(LineVertex, rgba)},
}};

}  // namespace

Pipelines::~Pipelines() {
    const auto& vk = context.vk;
    for (VkPipeline pipeline : triangles) vk.vkDestroyPipeline(context.device, pipeline, nullptr);
    for (VkPipeline pipeline : owners) vk.vkDestroyPipeline(context.device, pipeline, nullptr);
    for (VkPipeline pipeline : {wires, lines, sky}) vk.vkDestroyPipeline(context.device, pipeline, nullptr);
    vk.vkDestroyPipelineLayout(context.device, layout, nullptr);
    vk.vkDestroyRenderPass(context.device, render_pass, nullptr);
    vk.vkDestroyRenderPass(context.device, covered_pass, nullptr);
}

Result<void> Pipelines::create() {
    auto pass = create_render_pass(context, {.depth_format = kDepthFormat});
    if (!pass) return std::move(pass.error());
    render_pass = *pass;
    auto covered = create_render_pass(context, {.depth_format = kDepthFormat, .draws_all_pixels = true});
    if (!covered) return std::move(covered.error());
    covered_pass = *covered;
    if (auto made = create_layout(*this); !made) return made;

    const auto make = [&](const PipelineDescription& description, VkPipeline& pipeline) -> Result<void> {
        auto made = create_pipeline(context, description, layout, render_pass);
        if (!made) return std::move(made.error());
        pipeline = *made;
        return {};
    };
    const PipelineDescription scene{shaders::scene_vert, shaders::scene_frag, kVertexAttributes, kVertexBindings};
    const auto make_by_faces = [&](PipelineDescription description,
                                   std::array<VkPipeline, kAllFaces.size()>& by_faces) -> Result<void> {
        description.depth_bias.slope = kDepthSlopeBias;
        for (const Faces faces : kAllFaces) {
            description.variant = static_cast<std::uint32_t>(faces);
            description.cull = faces == Faces::front_by_culling ? VK_CULL_MODE_BACK_BIT : VK_CULL_MODE_NONE;
            if (auto made = make(description, by_faces[static_cast<std::size_t>(faces)]); !made) return made;
        }
        return {};
    };
    if (auto made = make_by_faces(scene, triangles); !made) return made;
    if (context.primitive_numbers) {
        const PipelineDescription numbers{shaders::owner_vert, shaders::owner_frag, kOwnerAttributes, kVertexBindings};
        if (auto made = make_by_faces(numbers, owners); !made) return made;
    }
    if (context.wireframe) {
        PipelineDescription wire = scene;
        wire.mode = VK_POLYGON_MODE_LINE;
        wire.depth_compare = VK_COMPARE_OP_GREATER_OR_EQUAL;
        wire.depth_bias = {.constant = 16.0f, .slope = 1.0f};
        if (auto made = make(wire, wires); !made) return made;
    }
    PipelineDescription line{shaders::line_vert, shaders::line_frag, kLineAttributes, kLineBindings};
    line.topology = VK_PRIMITIVE_TOPOLOGY_LINE_LIST;
    line.depth_compare = VK_COMPARE_OP_GREATER_OR_EQUAL;
    line.depth_write = false;
    line.blend = true;
    if (auto made = make(line, lines); !made) return made;
    PipelineDescription background{shaders::sky_vert, shaders::sky_frag, {}, {}};
    background.depth_compare = VK_COMPARE_OP_GREATER_OR_EQUAL;
    background.depth_write = false;
    if (auto made = make(background, sky); !made) return made;
    name();
    return {};
}

void Pipelines::name() const {
    const DebugLabels& labels = context.labels;
    const auto name_pipeline = [&](VkPipeline pipeline, const char* text) {
        labels.name(context.device, VK_OBJECT_TYPE_PIPELINE, pipeline, text);
    };
    labels.name(context.device, VK_OBJECT_TYPE_RENDER_PASS, render_pass, "picture");
    labels.name(context.device, VK_OBJECT_TYPE_RENDER_PASS, covered_pass, "picture with a sky");
    labels.name(context.device, VK_OBJECT_TYPE_PIPELINE_LAYOUT, layout, "all pipelines");
    name_pipeline(triangles[static_cast<std::size_t>(Faces::both)], "triangles, both faces");
    name_pipeline(triangles[static_cast<std::size_t>(Faces::front_by_shader)], "triangles, front faces by the shader");
    name_pipeline(triangles[static_cast<std::size_t>(Faces::front_by_culling)], "triangles, front faces by culling");
    for (const VkPipeline pipeline : owners) name_pipeline(pipeline, "triangles, in numbers");
    name_pipeline(wires, "wires");
    name_pipeline(lines, "lines");
    name_pipeline(sky, "sky");
}

}  // namespace crofton::render
