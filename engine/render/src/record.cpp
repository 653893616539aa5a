// SPDX-License-Identifier: MIT
// From a frame to a command buffer.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>

#include "rasterizer_state.hpp"

namespace crofton::render {
namespace {

// Push constants, as the shaders declare them.
struct SceneConstants {
    glm::vec4 to_sun_and_haze, sun, sky_ambient, ground_ambient, fog_and_share, spare[3];
};
struct SkyConstants {
    glm::vec4 to_sun, zenith, horizon, ground, sun, right, up, forward;
};
static_assert(sizeof(SceneConstants) == kPushConstantBytes && sizeof(SkyConstants) == kPushConstantBytes);

glm::vec4 wide(const glm::vec3& v, float w = 0.0f) {
    return {v, w};
}

SceneConstants scene_constants(const Frame& frame) {
    const Environment& e = frame.environment;
    // Orthographic views have w = 1 everywhere: no haze.
    const bool haze = e.haze_distance > 0.0f && frame.camera.projection == Projection::perspective;
    return {wide(glm::normalize(e.to_sun), haze ? e.haze_distance : 1.0f),
            wide(e.sun),
            wide(e.sky_ambient),
            wide(e.ground_ambient),
            wide(e.horizon, haze ? 1.0f : 0.0f),
            {}};
}

SkyConstants sky_constants(const Frame& frame) {
    const Environment& e = frame.environment;
    const glm::dmat3 to_world = glm::transpose(world_to_view_rotation(frame.camera));
    const bool perspective = frame.camera.projection == Projection::perspective;
    // The sky is infinitely far: an orthographic view sees one point of it.
    const double half_height = perspective ? std::tan(0.5 * frame.camera.fov_y) : 0.0;
    return {wide(glm::normalize(e.to_sun)),
            wide(glm::sqrt(e.zenith)),
            wide(glm::sqrt(e.horizon)),
            wide(glm::sqrt(e.ground)),
            wide(glm::sqrt(e.sun)),
            wide(glm::vec3(to_world[0] * (half_height * frame.camera.aspect))),
            wide(glm::vec3(to_world[1] * half_height)),
            wide(glm::vec3(-to_world[2]))};
}

glm::mat4 camera_relative_to_clip(const Camera& camera) {
    return glm::mat4(view_to_clip(camera) * glm::dmat4(world_to_view_rotation(camera)));
}

}  // namespace

void Rasterizer::State::record_draws(std::size_t begin, std::size_t end) {
    const auto& vk = context.vk;
    std::uint64_t portion = 0;
    const auto end_portion_after = [&](std::uint64_t submitted) {
        portion += submitted;
        if (portion < 3 * kPortionTriangles || next_stamp == stamp_count) return;
        vk.vkCmdWriteTimestamp(commands.handle, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, stamps, next_stamp++);
        portion = 0;
    };
    if (context.max_multi_draws > 0) {
        // The instance is the transform, so each call takes a run of draws that share one.
        for (std::size_t i = begin; i < end;) {
            if (draws[i].is_copy != binds_copies) bind_indices(draws[i].is_copy);
            std::size_t run = i;
            std::uint64_t run_indices = 0;
            do run_indices += draws[run++].index_count;
            while (run < end && draws[run].transform == draws[i].transform && draws[run].is_copy == binds_copies &&
                   run - i < context.max_multi_draws && run_indices < 3 * kPortionTriangles);
            vk.vkCmdDrawMultiIndexedEXT(commands.handle, static_cast<std::uint32_t>(run - i), multi_draws.data() + i, 1,
                                        draws[i].transform, sizeof(VkMultiDrawIndexedInfoEXT), nullptr);
            end_portion_after(run_indices);
            i = run;
        }
    } else if (context.multi_draw_indirect) {
        const std::size_t limit = context.properties.limits.maxDrawIndirectCount;
        for (std::size_t i = begin; i < end; i += limit)
            vk.vkCmdDrawIndexedIndirect(commands.handle, indirect.handle, i * sizeof(VkDrawIndexedIndirectCommand),
                                        static_cast<std::uint32_t>(std::min(limit, end - i)),
                                        sizeof(VkDrawIndexedIndirectCommand));
    } else {
        for (std::size_t i = begin; i < end; ++i)
            vk.vkCmdDrawIndexed(commands.handle, draws[i].index_count, 1, draws[i].first_index, 0, draws[i].transform);
    }
}

// The counted draws, in runs of the same faces.
void Rasterizer::State::record_counted_draws(const std::array<VkPipeline, kAllFaces.size()>& by_faces) {
    for (std::size_t begin = 0; begin < counted_draws;) {
        const Faces faces = draws[begin].faces;
        std::size_t end = begin + 1;
        while (end < counted_draws && draws[end].faces == faces) ++end;
        context.vk.vkCmdBindPipeline(commands.handle, VK_PIPELINE_BIND_POINT_GRAPHICS,
                                     by_faces[static_cast<std::size_t>(faces)]);
        record_draws(begin, end);
        begin = end;
    }
}

void Rasterizer::State::begin_pass(VkRenderPass render_pass, const Target& target,
                                   const VkClearColorValue& background) {
    const auto& vk = context.vk;
    const VkCommandBuffer cmd = commands.handle;
    std::array<VkClearValue, 2> clear{};
    clear[0].color = background;
    clear[1].depthStencil = {0.0f, 0};
    VkRenderPassBeginInfo pass{VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO};
    pass.renderPass = render_pass;
    pass.framebuffer = target.framebuffer;
    pass.renderArea.extent = target.drawn_extent;
    pass.clearValueCount = static_cast<std::uint32_t>(clear.size());
    pass.pClearValues = clear.data();
    vk.vkCmdBeginRenderPass(cmd, &pass, VK_SUBPASS_CONTENTS_INLINE);
    // Negative height: clip space's y points up.
    const auto width = static_cast<float>(target.drawn_extent.width);
    const auto height = static_cast<float>(target.drawn_extent.height);
    const VkViewport viewport{0.0f, height, width, -height, 0.0f, 1.0f};
    const VkRect2D scissor{{0, 0}, target.drawn_extent};
    vk.vkCmdSetViewport(cmd, 0, 1, &viewport);
    vk.vkCmdSetScissor(cmd, 0, 1, &scissor);
}

void Rasterizer::State::bind_geometry() {
    const std::array buffers{vertices.handle, transforms.handle};
    const std::array<VkDeviceSize, 2> offsets{};
    context.vk.vkCmdBindVertexBuffers(commands.handle, 0, 2, buffers.data(), offsets.data());
    bind_indices(false);
}

void Rasterizer::State::bind_indices(bool copied) {
    binds_copies = copied;
    context.vk.vkCmdBindIndexBuffer(commands.handle, copied ? copied_indices.handle : indices.handle, 0,
                                    VK_INDEX_TYPE_UINT32);
}

void Rasterizer::State::record(const Frame& frame, const Target& target) {
    const auto& vk = context.vk;
    const VkCommandBuffer cmd = commands.handle;
    if (statistics != VK_NULL_HANDLE) vk.vkCmdResetQueryPool(cmd, statistics, 0, 1);
    vk.vkCmdResetQueryPool(cmd, occlusion, 0, 1);
    if (stamps != VK_NULL_HANDLE) vk.vkCmdResetQueryPool(cmd, stamps, 0, stamp_count);
    next_stamp = 0;

    const LabelledCommands whole(context.labels, cmd, "picture");
    const glm::vec3 background = glm::sqrt(frame.environment.horizon);
    begin_pass(frame.environment.sky ? pipelines.covered_pass : pipelines.render_pass, target,
               {{background.r, background.g, background.b, 1.0f}});
    const VkPipelineLayout layout = pipelines.layout;
    constexpr VkShaderStageFlags kStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;

    const SceneConstants scene = scene_constants(frame);
    if (!draws.empty()) {
        bind_geometry();
        vk.vkCmdPushConstants(cmd, layout, kStages, 0, sizeof scene, &scene);
    }
    // Before the queries begin: lavapipe takes over what is bound then, and does not survive that nothing is.
    vk.vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines.triangles[0]);
    if (statistics != VK_NULL_HANDLE) vk.vkCmdBeginQuery(cmd, statistics, 0, 0);
    vk.vkCmdBeginQuery(cmd, occlusion, 0,
                       context.precise_occlusion ? VkQueryControlFlags{VK_QUERY_CONTROL_PRECISE_BIT} : 0u);
    {
        const LabelledCommands label(context.labels, cmd, "counted triangles");
        record_counted_draws(pipelines.triangles);
    }
    vk.vkCmdEndQuery(cmd, occlusion, 0);
    if (statistics != VK_NULL_HANDLE) vk.vkCmdEndQuery(cmd, statistics, 0);

    if (counted_draws < draws.size() && pipelines.wires != VK_NULL_HANDLE) {
        const LabelledCommands label(context.labels, cmd, "wires");
        vk.vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines.wires);
        record_draws(counted_draws, draws.size());
    }
    if (frame.environment.sky) {
        const LabelledCommands label(context.labels, cmd, "sky");
        const SkyConstants sky = sky_constants(frame);
        vk.vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines.sky);
        vk.vkCmdPushConstants(cmd, layout, kStages, 0, sizeof sky, &sky);
        vk.vkCmdDraw(cmd, 3, 1, 0, 0);
    }
    if (frame.lines.size() >= 2) {
        const LabelledCommands label(context.labels, cmd, "lines");
        const glm::mat4 matrix = camera_relative_to_clip(frame.camera);
        const VkDeviceSize zero = 0;
        vk.vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines.lines);
        vk.vkCmdBindVertexBuffers(cmd, 0, 1, &lines.handle, &zero);
        vk.vkCmdPushConstants(cmd, layout, kStages, 0, sizeof matrix, &matrix);
        vk.vkCmdDraw(cmd, static_cast<std::uint32_t>(frame.lines.size() / 2 * 2), 1, 0, 0);
    }
    vk.vkCmdEndRenderPass(cmd);
    target.record_enlargement(cmd);
}

}  // namespace crofton::render
