// SPDX-License-Identifier: MIT
// All that a Rasterizer keeps between frames.
#pragma once
#include <crofton/render/rasterizer.hpp>
#include <memory>
#include <vector>

#include <crofton/render/resources.hpp>
#include "draw_list.hpp"
#include "pipelines.hpp"
#include "target.hpp"

namespace crofton::render {

struct Rasterizer::State {
    explicit State(const VulkanContext& owner) : context(owner), pipelines(owner) {}
    ~State();
    State(const State&) = delete;
    State& operator=(const State&) = delete;

    const VulkanContext& context;
    Pipelines pipelines;
    std::vector<std::unique_ptr<Target>> targets;  // by picture
    Buffer vertices, indices;
    std::uint32_t index_count = 0;

    // Written anew each frame; they grow, never shrink.
    Buffer transforms, indirect, lines, copied_indices;
    Vector<MergedDraw> draws;       // the counted ones, then the wires
    std::size_t counted_draws = 0;  // of `draws`
    Vector<VkMultiDrawIndexedInfoEXT> multi_draws;
    Vector<std::uint32_t> copies;
    bool binds_copies = false;  // copied_indices are bound, not indices
    // The ranges that draw_owners() draws, each with a transform of its own, which carries its number.
    Vector<DrawRange> numbered_ranges;
    Vector<DrawTransform> numbered_transforms;

    VkQueryPool statistics = VK_NULL_HANDLE;  // null where the device has none
    VkQueryPool occlusion = VK_NULL_HANDLE;
    // Software devices bin on one thread and rasterise on others, but hand over what is binned only at the frame's end,
    // or before a time stamp is taken. So a time stamp is taken, and never read, after each portion of this many
    // triangles.
    static constexpr std::uint32_t kPortionTriangles = 20'000;
    static constexpr std::uint32_t kMaxPortions = 64;
    VkQueryPool stamps = VK_NULL_HANDLE;
    std::uint32_t stamp_count = 0, next_stamp = 0;  // 0 on other devices
    Commands commands;

    [[nodiscard]] Result<void> create(const RasterizerOptions& options);
    [[nodiscard]] Result<void> create_queries();
    void name_what_stays() const;  // for debuggers: once
    void name_what_grows() const;  // each frame
    // Fills draws, transforms, indirect, lines and copied_indices.
    [[nodiscard]] Result<void> prepare(const Frame& frame);
    [[nodiscard]] Result<void> join_draws();
    [[nodiscard]] Result<void> number_triangles(const Frame& frame);
    void record(const Frame& frame, const Target& target);
    // Without what is not counted; each triangle in its number (owners.cpp).
    void record_numbers(const Target& target);
    void begin_pass(VkRenderPass render_pass, const Target& target, const VkClearColorValue& background);
    void bind_geometry();
    void bind_indices(bool copied);
    void record_draws(std::size_t begin, std::size_t end);
    // `by_faces`: the pipelines.
    void record_counted_draws(const std::array<VkPipeline, kAllFaces.size()>& by_faces);
    [[nodiscard]] Result<GpuCounters> read_counters() const;
};

}  // namespace crofton::render
