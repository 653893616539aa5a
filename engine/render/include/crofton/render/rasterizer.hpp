// Headless Vulkan rasterizer: draws index ranges and says how many triangles that cost.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <string>

namespace crofton::render {

struct Vertex {
    glm::vec3 position;
    glm::vec3 normal;
    glm::vec3 color;  // linear RGB
};

// `count` consecutive indices drawn with transform `transform` (an index into the frame's transforms).
struct DrawRange {
    std::uint32_t first_index = 0;
    std::uint32_t index_count = 0;
    std::uint32_t transform = 0;
};

// What the GPU counted over one frame (VkQueryPipelineStatisticFlagBits names; samples_passed is a precise occlusion query).
struct GpuCounters {
    std::uint64_t input_assembly_primitives = 0;
    std::uint64_t clipping_invocations = 0;
    std::uint64_t clipping_primitives = 0;
    std::uint64_t samples_passed = 0;
};

}  // namespace crofton::render
