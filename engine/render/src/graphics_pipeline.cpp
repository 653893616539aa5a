// SPDX-License-Identifier: MIT
#include <array>
#include <crofton/render/graphics_pipeline.hpp>
#include <crofton/render/resources.hpp>
#include <string>

namespace crofton::render {
namespace {

Result<VkShaderModule> create_shader(const VulkanContext& context, std::span<const std::uint32_t> code,
                                     const char* stage) {
    VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    info.codeSize = code.size_bytes();
    info.pCode = code.data();
    VkShaderModule module = VK_NULL_HANDLE;
    const VkResult result = context.vk.vkCreateShaderModule(context.device, &info, nullptr, &module);
    if (result != VK_SUCCESS)
        return vulkan_failure(result, (std::string("vkCreateShaderModule of the ") + stage + " shader").c_str());
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

VkResult assemble(const VulkanContext& context, const PipelineDescription& description, VkShaderModule vertex,
                  VkShaderModule fragment, VkPipelineLayout layout, VkRenderPass pass, VkPipeline& pipeline) {
    const VkSpecializationMapEntry entry{0, 0, sizeof description.variant};
    const VkSpecializationInfo constants{1, &entry, sizeof description.variant, &description.variant};
    const std::array stages{stage_info(VK_SHADER_STAGE_VERTEX_BIT, vertex, constants),
                            stage_info(VK_SHADER_STAGE_FRAGMENT_BIT, fragment, constants)};
    VkPipelineVertexInputStateCreateInfo input{VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    input.vertexBindingDescriptionCount = static_cast<std::uint32_t>(description.bindings.size());
    input.pVertexBindingDescriptions = description.bindings.data();
    input.vertexAttributeDescriptionCount = static_cast<std::uint32_t>(description.attributes.size());
    input.pVertexAttributeDescriptions = description.attributes.data();
    VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
    assembly.topology = description.topology;
    VkPipelineViewportStateCreateInfo viewport{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
    viewport.viewportCount = 1;
    viewport.scissorCount = 1;
    VkPipelineRasterizationStateCreateInfo raster{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
    raster.polygonMode = description.mode;
    raster.cullMode = description.cull;
    raster.frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
    const PipelineDescription::DepthBias& bias = description.depth_bias;
    raster.depthBiasEnable = bias.constant != 0.0f || bias.slope != 0.0f;
    raster.depthBiasConstantFactor = bias.constant;
    raster.depthBiasSlopeFactor = bias.slope;
    raster.lineWidth = 1.0f;
    VkPipelineMultisampleStateCreateInfo samples{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
    samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
    VkPipelineDepthStencilStateCreateInfo depth{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
    depth.depthTestEnable = VK_TRUE;
    depth.depthWriteEnable = description.depth_write;
    depth.depthCompareOp = description.depth_compare;
    const VkPipelineColorBlendAttachmentState attachment = blend_state(description.blend);
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
    info.layout = layout;
    info.renderPass = pass;
    return context.vk.vkCreateGraphicsPipelines(context.device, VK_NULL_HANDLE, 1, &info, nullptr, &pipeline);
}

}  // namespace

Result<VkRenderPass> create_render_pass(const VulkanContext& context, const PassDescription& description) {
    const bool has_depth = description.depth_format != VK_FORMAT_UNDEFINED;
    VkAttachmentDescription color{};
    color.format = kColorFormat;
    color.samples = VK_SAMPLE_COUNT_1_BIT;
    color.loadOp = description.keep_color         ? VK_ATTACHMENT_LOAD_OP_LOAD
                   : description.draws_all_pixels ? VK_ATTACHMENT_LOAD_OP_DONT_CARE
                                                  : VK_ATTACHMENT_LOAD_OP_CLEAR;
    color.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    color.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
    color.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    color.finalLayout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
    if (description.keep_color) color.initialLayout = color.finalLayout;
    VkAttachmentDescription depth = color;
    depth.format = description.depth_format;
    depth.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
    depth.storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    depth.initialLayout = VK_IMAGE_LAYOUT_UNDEFINED;
    depth.finalLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
    const std::array attachments{color, depth};

    const VkAttachmentReference color_reference{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    const VkAttachmentReference depth_reference{1, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
    VkSubpassDescription subpass{};
    subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
    subpass.colorAttachmentCount = 1;
    subpass.pColorAttachments = &color_reference;
    if (has_depth) subpass.pDepthStencilAttachment = &depth_reference;

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
    info.attachmentCount = has_depth ? 2 : 1;
    info.pAttachments = attachments.data();
    info.subpassCount = 1;
    info.pSubpasses = &subpass;
    info.dependencyCount = static_cast<std::uint32_t>(dependencies.size());
    info.pDependencies = dependencies.data();
    VkRenderPass pass = VK_NULL_HANDLE;
    if (const VkResult result = context.vk.vkCreateRenderPass(context.device, &info, nullptr, &pass);
        result != VK_SUCCESS)
        return vulkan_failure(result, "vkCreateRenderPass");
    return pass;
}

Result<VkFramebuffer> create_framebuffer(const VulkanContext& context, VkRenderPass pass,
                                         std::span<const VkImageView> views, VkExtent2D extent) {
    VkFramebufferCreateInfo info{VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO};
    info.renderPass = pass;
    info.attachmentCount = static_cast<std::uint32_t>(views.size());
    info.pAttachments = views.data();
    info.width = extent.width;
    info.height = extent.height;
    info.layers = 1;
    VkFramebuffer framebuffer = VK_NULL_HANDLE;
    const VkResult result = context.vk.vkCreateFramebuffer(context.device, &info, nullptr, &framebuffer);
    if (result != VK_SUCCESS) return vulkan_failure(result, "vkCreateFramebuffer");
    return framebuffer;
}

Result<VkPipeline> create_pipeline(const VulkanContext& context, const PipelineDescription& description,
                                   VkPipelineLayout layout, VkRenderPass pass) {
    auto vertex = create_shader(context, description.vertex_shader, "vertex");
    if (!vertex) return std::move(vertex.error());
    auto fragment = create_shader(context, description.fragment_shader, "fragment");
    VkPipeline pipeline = VK_NULL_HANDLE;
    VkResult result = VK_SUCCESS;
    if (fragment) result = assemble(context, description, *vertex, *fragment, layout, pass, pipeline);
    context.vk.vkDestroyShaderModule(context.device, *vertex, nullptr);
    if (!fragment) return std::move(fragment.error());
    context.vk.vkDestroyShaderModule(context.device, *fragment, nullptr);
    if (result != VK_SUCCESS) return vulkan_failure(result, "vkCreateGraphicsPipelines");
    return pipeline;
}

}  // namespace crofton::render
