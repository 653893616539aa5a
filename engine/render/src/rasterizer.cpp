// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/core/error.hpp>
#include <crofton/render/rasterizer.hpp>
#include <cstring>
#include <glm/geometric.hpp>

#include "packed_vertex.hpp"
#include "rasterizer_state.hpp"

namespace crofton::render {

DrawTransform draw_transform(const glm::mat4& to_clip, const glm::dmat3& linear) {
    DrawTransform result{};
    result.to_clip = to_clip;
    // Cofactors turn normals right under any scale or shear, singular ones included; the shader normalises.
    const std::array<glm::dvec3, 3> cofactors{glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                                              glm::cross(linear[0], linear[1])};
    double largest = 0.0;
    for (const glm::dvec3& c : cofactors) largest = std::max({largest, std::fabs(c.x), std::fabs(c.y), std::fabs(c.z)});
    for (std::size_t k = 0; k < 3; ++k)
        result.normal[k] = glm::vec4(glm::vec3(largest > 0.0 ? cofactors[k] / largest : cofactors[k]), 0.0f);
    return result;
}

void set_tint(DrawTransform& transform, const glm::vec3& linear_rgb, float share) {
    for (int k = 0; k < 3; ++k) transform.normal[static_cast<std::size_t>(k)].w = linear_rgb[k];
    transform.tint_share = share;
}

namespace {

// A software device's memory is the host's: join_draws() reads it.
Result<Buffer> create_index_buffer(const VulkanContext& context, std::span<const std::uint32_t> indices) {
    if (context.properties.deviceType != VK_PHYSICAL_DEVICE_TYPE_CPU)
        return create_static_buffer(context, indices.data(), indices.size_bytes(), VK_BUFFER_USAGE_INDEX_BUFFER_BIT);
    auto buffer = create_host_buffer(context, indices.size_bytes(), VK_BUFFER_USAGE_INDEX_BUFFER_BIT);
    if (buffer) std::memcpy(buffer->mapped, indices.data(), indices.size_bytes());
    return buffer;
}

}  // namespace

Rasterizer::State::~State() {
    context.vk.vkDeviceWaitIdle(context.device);
    context.vk.vkDestroyQueryPool(context.device, statistics, nullptr);
    context.vk.vkDestroyQueryPool(context.device, occlusion, nullptr);
    context.vk.vkDestroyQueryPool(context.device, stamps, nullptr);
}

Result<void> Rasterizer::State::create(const RasterizerOptions& options) {
    if (auto made = pipelines.create(); !made) return made;
    auto target = std::make_unique<Target>(context);
    if (auto made = target->create(pipelines.render_pass, {options.width, options.height}, 1.0f); !made) return made;
    targets.push_back(std::move(target));
    auto made_commands = Commands::create(context);
    if (!made_commands) return std::move(made_commands.error());
    commands = std::move(*made_commands);
    if (auto made = create_queries(); !made) return made;
    name_what_stays();
    return {};
}

void Rasterizer::State::name_what_stays() const {
    const auto name = [&](VkObjectType type, auto handle, const char* text) {
        context.labels.name(context.device, type, handle, text);
    };
    name(VK_OBJECT_TYPE_QUERY_POOL, occlusion, "samples passed");
    name(VK_OBJECT_TYPE_QUERY_POOL, statistics, "triangles counted");
    name(VK_OBJECT_TYPE_QUERY_POOL, stamps, "portions handed over");
    name(VK_OBJECT_TYPE_COMMAND_BUFFER, commands.handle, "frame");
}

void Rasterizer::State::name_what_grows() const {
    transforms.name("transforms");
    indirect.name("draws");
    lines.name("line ends");
    copied_indices.name("indices of short draws");
}

Result<void> Rasterizer::State::create_queries() {
    VkQueryPoolCreateInfo info{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
    info.queryCount = 1;
    info.queryType = VK_QUERY_TYPE_OCCLUSION;
    VkResult result = context.vk.vkCreateQueryPool(context.device, &info, nullptr, &occlusion);
    if (result == VK_SUCCESS && context.pipeline_statistics) {
        info.queryType = VK_QUERY_TYPE_PIPELINE_STATISTICS;
        info.pipelineStatistics = VK_QUERY_PIPELINE_STATISTIC_INPUT_ASSEMBLY_PRIMITIVES_BIT |
                                  VK_QUERY_PIPELINE_STATISTIC_CLIPPING_INVOCATIONS_BIT |
                                  VK_QUERY_PIPELINE_STATISTIC_CLIPPING_PRIMITIVES_BIT;
        result = context.vk.vkCreateQueryPool(context.device, &info, nullptr, &statistics);
    }
    if (result == VK_SUCCESS && context.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU &&
        context.properties.limits.timestampComputeAndGraphics == VK_TRUE) {
        info.queryType = VK_QUERY_TYPE_TIMESTAMP;
        info.queryCount = stamp_count = kMaxPortions;
        info.pipelineStatistics = 0;
        result = context.vk.vkCreateQueryPool(context.device, &info, nullptr, &stamps);
    }
    if (result != VK_SUCCESS) return vulkan_failure(result, "vkCreateQueryPool");
    return {};
}

// Software devices pay for each draw, and their indices can be read here.
Result<void> Rasterizer::State::join_draws() {
    if (indices.mapped == nullptr || context.max_multi_draws == 0) return {};
    const std::span<const std::uint32_t> all(reinterpret_cast<const std::uint32_t*>(indices.mapped), index_count);
    join_short_draws(all, 3 * kPortionTriangles, draws, copies);
    if (copies.empty()) return {};
    const std::size_t bytes = copies.size() * sizeof copies[0];
    if (auto made = reserve_host_buffer(context, copied_indices, bytes, VK_BUFFER_USAGE_INDEX_BUFFER_BIT); !made)
        return made;
    std::memcpy(copied_indices.mapped, copies.data(), bytes);
    return {};
}

Result<void> Rasterizer::State::prepare(const Frame& frame) {
    draws.clear();
    if (auto merged = merge_ranges(frame.ranges, index_count, frame.transforms.size(), draws); !merged) return merged;
    if (auto joined = join_draws(); !joined) return joined;
    counted_draws = draws.size();
    if (auto merged = merge_ranges(frame.wire_ranges, index_count, frame.transforms.size(), draws); !merged)
        return merged;

    if (!draws.empty()) {
        const std::size_t bytes = frame.transforms.size_bytes();
        if (auto made = reserve_host_buffer(context, transforms, bytes, VK_BUFFER_USAGE_VERTEX_BUFFER_BIT); !made)
            return made;
        std::memcpy(transforms.mapped, frame.transforms.data(), bytes);
    }
    if (context.max_multi_draws > 0) {
        multi_draws.clear();
        for (const MergedDraw& draw : draws) multi_draws.push_back({draw.first_index, draw.index_count, 0});
    } else if (context.multi_draw_indirect && !draws.empty()) {
        if (auto made = reserve_host_buffer(context, indirect, draws.size() * sizeof(VkDrawIndexedIndirectCommand),
                                            VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT);
            !made)
            return made;
        for (std::size_t i = 0; i < draws.size(); ++i) {
            const VkDrawIndexedIndirectCommand command{draws[i].index_count, 1, draws[i].first_index, 0,
                                                       draws[i].transform};
            std::memcpy(indirect.mapped + i * sizeof command, &command, sizeof command);
        }
    }
    if (!frame.lines.empty()) {
        if (auto made =
                reserve_host_buffer(context, lines, frame.lines.size_bytes(), VK_BUFFER_USAGE_VERTEX_BUFFER_BIT);
            !made)
            return made;
        std::memcpy(lines.mapped, frame.lines.data(), frame.lines.size_bytes());
    }
    if (context.labels.set_name != nullptr) name_what_grows();
    return {};
}

Result<GpuCounters> Rasterizer::State::read_counters() const {
    GpuCounters counters;
    const auto read = [&](VkQueryPool pool, std::span<std::uint64_t> values) {
        return context.vk.vkGetQueryPoolResults(context.device, pool, 0, 1, values.size_bytes(), values.data(),
                                                values.size_bytes(), VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT);
    };
    std::array<std::uint64_t, 3> statistic{};
    VkResult result = read(occlusion, {&counters.samples_passed, 1});
    if (result == VK_SUCCESS && statistics != VK_NULL_HANDLE) result = read(statistics, statistic);
    if (result != VK_SUCCESS) return vulkan_failure(result, "vkGetQueryPoolResults");
    counters.input_assembly_primitives = statistic[0];
    counters.clipping_invocations = statistic[1];
    counters.clipping_primitives = statistic[2];
    return counters;
}

Rasterizer::Rasterizer(std::unique_ptr<State> state) : state_(std::move(state)) {}
Rasterizer::~Rasterizer() = default;
Rasterizer::Rasterizer(Rasterizer&&) noexcept = default;
Rasterizer& Rasterizer::operator=(Rasterizer&&) noexcept = default;

Result<Rasterizer> Rasterizer::create(Device& device, const RasterizerOptions& options) {
    auto state = std::make_unique<State>(device.context());
    if (auto made = state->create(options); !made) return std::move(made.error());
    return Rasterizer(std::move(state));
}

Result<void> Rasterizer::set_geometry(std::span<const Vertex> vertices, std::span<const std::uint32_t> indices) {
    if (indices.size() % 3 != 0)
        return fail(ErrorCode::invalid_argument, kNoItem, "the indices are not whole triangles");
    if (indices.size() > 0xffffffffu) return fail(ErrorCode::out_of_range, kNoItem, "more than 2^32 indices");
    for (std::size_t i = 0; i < indices.size(); ++i)
        if (indices[i] >= vertices.size()) return fail(ErrorCode::out_of_range, i, "an index refers to no vertex");
    Buffer new_vertices, new_indices;
    if (!indices.empty()) {
        const VulkanContext& context = state_->context;
        Vector<PackedVertex> packed_vertices(vertices.size());
        std::transform(vertices.begin(), vertices.end(), packed_vertices.begin(), packed);
        auto made_vertices =
            create_static_buffer(context, packed_vertices.data(), packed_vertices.size() * sizeof(PackedVertex),
                                 VK_BUFFER_USAGE_VERTEX_BUFFER_BIT);
        if (!made_vertices) return std::move(made_vertices.error());
        auto made_indices = create_index_buffer(context, indices);
        if (!made_indices) return std::move(made_indices.error());
        new_vertices = std::move(*made_vertices);
        new_indices = std::move(*made_indices);
        new_vertices.name("vertices");
        new_indices.name("indices");
    }
    state_->vertices = std::move(new_vertices);
    state_->indices = std::move(new_indices);
    state_->index_count = static_cast<std::uint32_t>(indices.size());
    return {};
}

Result<void> Rasterizer::resize(std::uint32_t width, std::uint32_t height, std::uint32_t picture, float resolution) {
    auto& targets = state_->targets;
    CROFTON_ASSERT(picture <= targets.size(), "pictures are made one after another");
    if (picture < targets.size() && width == targets[picture]->extent.width &&
        height == targets[picture]->extent.height && resolution == targets[picture]->resolution)
        return {};
    auto target = std::make_unique<Target>(state_->context);
    if (auto made = target->create(state_->pipelines.render_pass, {width, height}, resolution); !made) return made;
    if (picture == targets.size()) targets.emplace_back();
    targets[picture] = std::move(target);
    return {};
}

Result<GpuCounters> Rasterizer::draw(const Frame& frame, std::uint32_t picture) {
    if (auto submitted = submit(frame, picture); !submitted) return std::move(submitted.error());
    return finish();
}

Result<void> Rasterizer::submit(const Frame& frame, std::uint32_t picture) {
    CROFTON_ASSERT(picture < state_->targets.size(), "there is no such picture");
    Target& target = *state_->targets[picture];
    if (auto prepared = state_->prepare(frame); !prepared) return prepared;
    if (auto begun = state_->commands.begin(); !begun) return begun;
    state_->record(frame, target);
    if (auto submitted = state_->commands.submit(); !submitted) return submitted;
    target.drawn = true;
    return {};
}

Result<GpuCounters> Rasterizer::finish() {
    if (auto done = state_->commands.wait(); !done) return std::move(done.error());
    return state_->read_counters();
}

Result<void> Rasterizer::read_pixels(Image& image, std::uint32_t picture) {
    CROFTON_ASSERT(picture < state_->targets.size(), "there is no such picture");
    Target& target = *state_->targets[picture];
    if (!target.drawn) return fail(ErrorCode::empty, kNoItem, "no frame has been drawn at this size yet");
    if (auto begun = state_->commands.begin(); !begun) return begun;
    target.record_readback(state_->commands.handle);
    if (auto done = state_->commands.submit_and_wait(); !done) return done;
    image.width = target.extent.width;
    image.height = target.extent.height;
    image.rgba.resize(target.readback.size);
    static_assert(kColorFormat == VK_FORMAT_B8G8R8A8_UNORM);
    const auto* bgra = reinterpret_cast<const std::uint8_t*>(target.readback.mapped);
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
        image.rgba[i] = bgra[i + 2];
        image.rgba[i + 1] = bgra[i + 1];
        image.rgba[i + 2] = bgra[i];
        image.rgba[i + 3] = bgra[i + 3];
    }
    return {};
}

std::uint32_t Rasterizer::draw_count() const {
    return static_cast<std::uint32_t>(state_->counted_draws);
}
std::uint32_t Rasterizer::width(std::uint32_t picture) const {
    return state_->targets[picture]->extent.width;
}
std::uint32_t Rasterizer::height(std::uint32_t picture) const {
    return state_->targets[picture]->extent.height;
}
const ImageResource* Rasterizer::native_image(std::uint32_t picture) const {
    return picture < state_->targets.size() ? &state_->targets[picture]->color : nullptr;
}

}  // namespace crofton::render
