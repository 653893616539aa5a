// SPDX-License-Identifier: MIT
// A headless Vulkan rasterizer that draws index ranges and counts triangles.
#pragma once
#include <array>
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/render/device.hpp>
#include <crofton/render/vertex.hpp>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <span>

namespace crofton::render {

// `index_count` consecutive indices drawn with transform `transform` (an index into the frame's transforms).
struct DrawRange {
    std::uint32_t first_index = 0;
    std::uint32_t index_count = 0;
    std::uint32_t transform = 0;
    bool one_sided = false;  // back faces are not drawn, but counted
    // Set it if no vertex lies beyond a clip plane, as inside_clip_planes() finds. Back faces of one-sided ranges are
    // then culled before rasterisation; elsewhere lavapipe would not count them, so the fragment shader drops them.
    bool unclipped = false;
};

// The vertex shader's input for one draw; made by draw_transform().
struct DrawTransform {
    glm::mat4 to_clip;                // as ModelToClip makes it
    std::array<glm::vec4, 3> normal;  // columns of the cofactor matrix of the linear part; .w holds the tint's r, g, b
    float tint_share = 0.0f;          // 0: the vertices' colours, 1: the tint
    float unlit = 0.0f;               // 1: colours as given, without light
    float number[2]{};                // written by draw_owners()
};
static_assert(sizeof(DrawTransform) == 128, "the layout that the vertex shader's attributes are read by");

// Returns the input for a mesh placed by x ↦ linear · x + translation; `to_clip` is ModelToClip's matrix for the same
// placement.
[[nodiscard]] DrawTransform draw_transform(const glm::mat4& to_clip, const glm::dmat3& linear);
void set_tint(DrawTransform& transform, const glm::vec3& linear_rgb, float share = 1.0f);

// An end of a line, relative to the camera, in the displayed colour (RGBA, 0 to 255).
struct LineVertex {
    glm::vec3 position;
    std::uint32_t rgba;  // R in the lowest byte
};

// Sun, sky and haze, in linear RGB; y is up.
struct Environment {
    glm::vec3 to_sun{0.45f, 0.75f, 0.49f};
    glm::vec3 sun{1.05f, 0.98f, 0.85f};
    glm::vec3 sky_ambient{0.30f, 0.38f, 0.50f};
    glm::vec3 ground_ambient{0.16f, 0.14f, 0.12f};
    glm::vec3 zenith{0.10f, 0.26f, 0.62f};
    glm::vec3 horizon{0.62f, 0.74f, 0.86f};  // the haze's colour too
    glm::vec3 ground{0.30f, 0.29f, 0.27f};
    float haze_distance = 900.0f;  // metres of view depth at which half the light is haze; 0 = none
    bool sky = true;               // otherwise the background is the horizon's colour
};

// One picture. The spans are read only during draw(). Only `ranges` are counted, not lines, wires or sky.
struct Frame {
    Camera camera;  // must be the one that made the transforms
    std::span<const DrawTransform> transforms;
    std::span<const DrawRange> ranges;
    std::span<const DrawRange> wire_ranges{};  // their edges are drawn over the picture; ignored if unsupported
    std::span<const LineVertex> lines{};       // two per line
    Environment environment{};
};

// The GPU's counts of one frame (VkQueryPipelineStatisticFlagBits names; samples_passed is a precise occlusion query).
struct GpuCounters {
    std::uint64_t input_assembly_primitives = 0;
    std::uint64_t clipping_invocations = 0;
    std::uint64_t clipping_primitives = 0;
    std::uint64_t samples_passed = 0;
};

// Top row first, RGBA.
struct Image {
    std::uint32_t width = 0, height = 0;
    Vector<std::uint8_t> rgba;
};

// The number of a pixel that no triangle owns, in draw_owners().
inline constexpr std::uint32_t kNoTriangle = 0xffffffffu;

class ImageResource;  // native handles: see resources.hpp

struct RasterizerOptions {
    std::uint32_t width = 1280;
    std::uint32_t height = 720;
};

// Draws into a BGRA8 + D32 target; on lavapipe any other pair may turn on a guard band, which changes the counts. The
// device must outlive it. Depth is reversed-Z: cameras and matrices must use DepthRange::reversed_zero_to_one.
class Rasterizer {
  public:
    // Creates a rasterizer. Errors: size 0 or beyond the device's limit; unavailable, unsupported, internal from
    // Vulkan.
    [[nodiscard]] static Result<Rasterizer> create(Device& device, const RasterizerOptions& options = {});
    ~Rasterizer();
    Rasterizer(Rasterizer&&) noexcept;
    Rasterizer& operator=(Rasterizer&&) noexcept;

    // Replaces the static vertex and index buffer. Errors: an index out of range or a count not a multiple of 3 (item =
    // index).
    [[nodiscard]] Result<void> set_geometry(std::span<const Vertex> vertices, std::span<const std::uint32_t> indices);

    // Sets the size of a picture. Picture 0 is made by create(), the others by their first resize(), in order. They
    // share the geometry, so that one scene can be seen from several sides.
    //
    // If `resolution` is less than 1, only that share of the pixels each way is drawn, and the picture is enlarged.
    // Counts stay the same, except the samples passed. Errors: as create(); a resolution that is not above 0 and at
    // most 1.
    [[nodiscard]] Result<void> resize(std::uint32_t width, std::uint32_t height, std::uint32_t picture = 0,
                                      float resolution = 1.0f);

    // Draws and waits. Consecutive ranges with the same transform become one draw. Memory grows only when needed.
    // Errors: a range beyond the indices or transforms, or not of whole triangles (item = range); Vulkan's.
    [[nodiscard]] Result<GpuCounters> draw(const Frame& frame, std::uint32_t picture = 0);

    // draw() in two steps, so that the caller can work while the device draws. submit() has read frame and spans when
    // it returns; call finish() next, before any other function.
    [[nodiscard]] Result<void> submit(const Frame& frame, std::uint32_t picture = 0);
    [[nodiscard]] Result<GpuCounters> finish();

    // Reads the picture's pixels. Errors: nothing drawn since its last change of size; Vulkan's.
    [[nodiscard]] Result<void> read_pixels(Image& image, std::uint32_t picture = 0);

    // Writes which triangle owns each pixel, top row first: `owners` gets k for the k-th triangle of frame.ranges,
    // counted through the ranges in order, or kNoTriangle. The owner is the triangle whose colour draw() leaves there.
    //
    // Draws the ranges into the picture, each triangle in its number, without lines, wires and sky, and waits. Errors:
    // `unsupported` if fragment shaders cannot read gl_PrimitiveID; a picture whose resolution is below 1; more than
    // 2^32 - 2 triangles; as draw().
    [[nodiscard]] Result<void> draw_owners(const Frame& frame, Vector<std::uint32_t>& owners,
                                           std::uint32_t picture = 0);

    // Returns the number of draws of the last frame after merging.
    [[nodiscard]] std::uint32_t draw_count() const;
    [[nodiscard]] std::uint32_t width(std::uint32_t picture = 0) const;
    [[nodiscard]] std::uint32_t height(std::uint32_t picture = 0) const;

    // Returns the picture between draws, for a window: of kColorFormat, in SHADER_READ_ONLY_OPTIMAL, usable as colour
    // attachment, transfer source and sampled image. Leave it in that layout, idle. Null if there is no such picture.
    [[nodiscard]] const ImageResource* native_image(std::uint32_t picture = 0) const;

  private:
    struct State;
    explicit Rasterizer(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace crofton::render
