#include "pipelines.hpp"

#include <array>
#include <crofton/render/rasterizer.hpp>
#include <cstddef>
#include <span>

#include "shaders/line.frag.h"
#include "shaders/line.vert.h"
#include "shaders/scene.frag.h"
#include "shaders/scene.vert.h"
#include "shaders/sky.frag.h"
#include "shaders/sky.vert.h"

namespace crofton::render {
namespace {

struct Recipe {
    std::span<const std::uint32_t> vertex_shader, fragment_shader;
    std::span<const VkVertexInputAttributeDescription> attributes;
    std::span<const VkVertexInputBindingDescription> bindings;
    VkPrimitiveTopology topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    VkPolygonMode mode = VK_POLYGON_MODE_FILL;
    Faces faces = Faces::both;
    VkCompareOp depth_compare = VK_COMPARE_OP_GREATER;  // reversed-Z
    bool depth_write = true;
    bool depth_bias = false;
    bool blend = false;
};

Result<VkRenderPass> create_render_pass(const VulkanContext& context) {
    VkAttachmentDescription color{};
    color.format = kColorFormat;
    color.samples = VK_SAMPLE_COUNT_1_BIT;
    color.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
    color.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    color.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
    color.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    color.finalLayout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
    VkAttachmentDescription depth = color;
    depth.format = kDepthFormat;
    depth.storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    depth.finalLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
    const std::array attachments{color, depth};

    const VkAttachmentReference color_reference{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    const VkAttachmentReference depth_reference{1, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
    VkSubpassDescription subpass{};
    subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
    subpass.colorAttachmentCount = 1;
    subpass.pColorAttachments = &color_reference;
    subpass.pDepthStencilAttachment = &depth_reference;

    constexpr VkPipelineStageFlags kDepthStages =
        VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT;
    constexpr VkPipelineStageFlags kColorStage = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT;
    constexpr VkPipelineStageFlags kReaders = VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT;
    std::array<VkSubpassDependency, 2> dependencies{};
    dependencies[0] = {VK_SUBPASS_EXTERNAL,
                       0,
                       kReaders | kDepthStages | kColorStage,
                       kDepthStages | kColorStage,
                       VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT | VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
                       VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT |
                           VK_ACCESS_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
                       0};
    dependencies[1] = {0,
                       VK_SUBPASS_EXTERNAL,
                       kColorStage,
                       kReaders,
                       VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
                       VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_TRANSFER_READ_BIT,
                       0};
    VkRenderPassCreateInfo info{VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO};
    info.attachmentCount = static_cast<std::uint32_t>(attachments.size());
    info.pAttachments = attachments.data();
    info.subpassCount = 1;
    info.pSubpasses = &subpass;
    info.dependencyCount = static_cast<std::uint32_t>(dependencies.size());
    info.pDependencies = dependencies.data();
    VkRenderPass pass = VK_NULL_HANDLE;
    if (const VkResult result = context.vk.vkCreateRenderPass(context.device, &info, nullptr, &pass);
        result != VK_SUCCESS)
        return tl::unexpected(vulkan_error(result, "vkCreateRenderPass"));
    return pass;
}

Result<VkShaderModule> create_shader(const VulkanContext& context, std::span<const std::uint32_t> code) {
    VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    info.codeSize = code.size_bytes();
    info.pCode = code.data();
    VkShaderModule module = VK_NULL_HANDLE;
    if (const VkResult result = context.vk.vkCreateShaderModule(context.device, &info, nullptr, &module);
        result != VK_SUCCESS)
        return tl::unexpected(vulkan_error(result, "vkCreateShaderModule"));
    return module;
}

VkPipelineShaderStageCreateInfo stage_info(VkShaderStageFlagBits stage, VkShaderModule module,
                                           const VkSpecializationInfo& constants) {
    VkPipelineShaderStageCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
    info.stage = stage;
    info.module = module;
    info.pName = "main";
    info.pSpecializationInfo = &constants;
    return info;
}

VkPipelineColorBlendAttachmentState blend_state(bool blend) {
    VkPipelineColorBlendAttachmentState state{};
    state.blendEnable = blend;
    state.srcColorBlendFactor = VK_BLEND_FACTOR_SRC_ALPHA;
    state.dstColorBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
    state.srcAlphaBlendFactor = VK_BLEND_FACTOR_ZERO;
    state.dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE;
    state.colorWriteMask =
        VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
    return state;
}

VkResult create_pipeline(const Pipelines& pipelines, const Recipe& recipe, VkShaderModule vertex,
                         VkShaderModule fragment, VkPipeline& pipeline) {
    const VkSpecializationMapEntry entry{0, 0, sizeof recipe.faces};
    const VkSpecializationInfo constants{1, &entry, sizeof recipe.faces, &recipe.faces};
    const std::array stages{stage_info(VK_SHADER_STAGE_VERTEX_BIT, vertex, constants),
                            stage_info(VK_SHADER_STAGE_FRAGMENT_BIT, fragment, constants)};
    VkPipelineVertexInputStateCreateInfo input{VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    input.vertexBindingDescriptionCount = static_cast<std::uint32_t>(recipe.bindings.size());
    input.pVertexBindingDescriptions = recipe.bindings.data();
    input.vertexAttributeDescriptionCount = static_cast<std::uint32_t>(recipe.attributes.size());
    input.pVertexAttributeDescriptions = recipe.attributes.data();
    VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
    assembly.topology = recipe.topology;
    VkPipelineViewportStateCreateInfo viewport{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
    viewport.viewportCount = 1;
    viewport.scissorCount = 1;
    VkPipelineRasterizationStateCreateInfo raster{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
    raster.polygonMode = recipe.mode;
    raster.cullMode = recipe.faces == Faces::front_by_culling ? VK_CULL_MODE_BACK_BIT : VK_CULL_MODE_NONE;
    raster.frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
    raster.depthBiasEnable = recipe.depth_bias;
    raster.depthBiasConstantFactor = 16.0f;
    raster.depthBiasSlopeFactor = 1.0f;
    raster.lineWidth = 1.0f;
    VkPipelineMultisampleStateCreateInfo samples{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
    samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
    VkPipelineDepthStencilStateCreateInfo depth{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
    depth.depthTestEnable = VK_TRUE;
    depth.depthWriteEnable = recipe.depth_write;
    depth.depthCompareOp = recipe.depth_compare;
    const VkPipelineColorBlendAttachmentState attachment = blend_state(recipe.blend);
    VkPipelineColorBlendStateCreateInfo blend{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
    blend.attachmentCount = 1;
    blend.pAttachments = &attachment;
    const std::array dynamic_states{VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    VkPipelineDynamicStateCreateInfo dynamic{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};
    dynamic.dynamicStateCount = static_cast<std::uint32_t>(dynamic_states.size());
    dynamic.pDynamicStates = dynamic_states.data();

    VkGraphicsPipelineCreateInfo info{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO};
    info.stageCount = static_cast<std::uint32_t>(stages.size());
    info.pStages = stages.data();
    info.pVertexInputState = &input;
    info.pInputAssemblyState = &assembly;
    info.pViewportState = &viewport;
    info.pRasterizationState = &raster;
    info.pMultisampleState = &samples;
    info.pDepthStencilState = &depth;
    info.pColorBlendState = &blend;
    info.pDynamicState = &dynamic;
    info.layout = pipelines.layout;
    info.renderPass = pipelines.render_pass;
    const VulkanContext& context = pipelines.context;
    return context.vk.vkCreateGraphicsPipelines(context.device, VK_NULL_HANDLE, 1, &info, nullptr, &pipeline);
}

Result<VkPipeline> cook(const Pipelines& pipelines, const Recipe& recipe) {
    const VulkanContext& context = pipelines.context;
    auto vertex = create_shader(context, recipe.vertex_shader);
    if (!vertex) return tl::unexpected(std::move(vertex.error()));
    auto fragment = create_shader(context, recipe.fragment_shader);
    VkPipeline pipeline = VK_NULL_HANDLE;
    const VkResult result =
        fragment ? create_pipeline(pipelines, recipe, *vertex, *fragment, pipeline) : VK_ERROR_INITIALIZATION_FAILED;
    context.vk.vkDestroyShaderModule(context.device, *vertex, nullptr);
    if (fragment) context.vk.vkDestroyShaderModule(context.device, *fragment, nullptr);
    if (result != VK_SUCCESS) return tl::unexpected(vulkan_error(result, "vkCreateGraphicsPipelines"));
    return pipeline;
}

Result<void> create_layout(Pipelines& pipelines) {
    const VulkanContext& context = pipelines.context;
    const VkPushConstantRange constants{VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0,
                                        kPushConstantBytes};
    VkPipelineLayoutCreateInfo layout{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    layout.pushConstantRangeCount = 1;
    layout.pPushConstantRanges = &constants;
    const VkResult result = context.vk.vkCreatePipelineLayout(context.device, &layout, nullptr, &pipelines.layout);
    if (result != VK_SUCCESS) return tl::unexpected(vulkan_error(result, "vkCreatePipelineLayout"));
    return {};
}

// The draw's transform comes as attributes that step once an instance: software devices fetch those once for eight
// vertices, and a storage buffer once for each.
constexpr std::array<VkVertexInputBindingDescription, 2> kVertexBindings{{
    {0, sizeof(Vertex), VK_VERTEX_INPUT_RATE_VERTEX},
    {1, sizeof(DrawTransform), VK_VERTEX_INPUT_RATE_INSTANCE},
}};
constexpr VkFormat kFloat4 = VK_FORMAT_R32G32B32A32_SFLOAT;
constexpr std::array<VkVertexInputAttributeDescription, 11> kVertexAttributes{{
    {0, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(Vertex, position)},
    {1, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(Vertex, normal)},
    {2, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(Vertex, color)},
    {3, 1, kFloat4, offsetof(DrawTransform, to_clip)},
    {4, 1, kFloat4, offsetof(DrawTransform, to_clip) + 16},
    {5, 1, kFloat4, offsetof(DrawTransform, to_clip) + 32},
    {6, 1, kFloat4, offsetof(DrawTransform, to_clip) + 48},
    {7, 1, kFloat4, offsetof(DrawTransform, normal)},
    {8, 1, kFloat4, offsetof(DrawTransform, normal) + 16},
    {9, 1, kFloat4, offsetof(DrawTransform, normal) + 32},
    {10, 1, kFloat4, offsetof(DrawTransform, tint_share)},
}};
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
    for (VkPipeline pipeline : {wires, lines, sky}) vk.vkDestroyPipeline(context.device, pipeline, nullptr);
    vk.vkDestroyPipelineLayout(context.device, layout, nullptr);
    vk.vkDestroyRenderPass(context.device, render_pass, nullptr);
}

Result<void> Pipelines::create() {
    auto pass = create_render_pass(context);
    if (!pass) return tl::unexpected(std::move(pass.error()));
    render_pass = *pass;
    if (auto made = create_layout(*this); !made) return made;

    Recipe triangle_recipe{shaders::scene_vert, shaders::scene_frag, kVertexAttributes, kVertexBindings};
    std::array<Recipe, kAllFaces.size()> face_recipes;
    face_recipes.fill(triangle_recipe);
    for (const Faces faces : kAllFaces) face_recipes[static_cast<std::size_t>(faces)].faces = faces;
    Recipe wire_recipe = triangle_recipe;
    wire_recipe.mode = VK_POLYGON_MODE_LINE;
    wire_recipe.depth_compare = VK_COMPARE_OP_GREATER_OR_EQUAL;
    wire_recipe.depth_bias = true;
    Recipe line_recipe{shaders::line_vert, shaders::line_frag, kLineAttributes, kLineBindings};
    line_recipe.topology = VK_PRIMITIVE_TOPOLOGY_LINE_LIST;
    line_recipe.depth_compare = VK_COMPARE_OP_GREATER_OR_EQUAL;
    line_recipe.blend = true;
    line_recipe.depth_write = false;
    Recipe sky_recipe{shaders::sky_vert, shaders::sky_frag, {}, {}};
    sky_recipe.depth_compare = VK_COMPARE_OP_GREATER_OR_EQUAL;
    sky_recipe.depth_write = false;

    const std::array<std::pair<const Recipe*, VkPipeline*>, 6> all{{{&face_recipes[0], &triangles[0]},
                                                                    {&face_recipes[1], &triangles[1]},
                                                                    {&face_recipes[2], &triangles[2]},
                                                                    {&line_recipe, &lines},
                                                                    {&sky_recipe, &sky},
                                                                    {&wire_recipe, &wires}}};
    for (const auto& [recipe, pipeline] : all) {
        if (recipe == &wire_recipe && !context.wireframe) continue;
        auto cooked = cook(*this, *recipe);
        if (!cooked) return tl::unexpected(std::move(cooked.error()));
        *pipeline = *cooked;
    }
    return {};
}

}  // namespace crofton::render
