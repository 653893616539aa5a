// SPDX-License-Identifier: MIT
// How near the occluders are in each pixel of a view, never nearer than they are anywhere in it.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/occlude/occluder.hpp>
#include <crofton/occlude/occlusion_view.hpp>
#include <cstdint>
#include <memory>
#include <span>

namespace crofton::occlude {

struct BufferSize {
    std::uint32_t width = 640, height = 360;  // pixels; 8 to 4096 each
};

struct DrawStatistics {
    std::uint64_t pieces_drawn = 0;     // boxes, convex shapes, connected pieces of meshes, if the view meets them
    std::uint64_t triangles_drawn = 0;  // of meshes, surfaces, and bodies that cross the near plane
};

// A pixel is covered where occluders cover the whole closed square; its depth is then not nearer than the farthest
// point of the nearest surface over that square (docs/notes/occlude.md has the proof). Const functions may run on any
// number of threads at once.
class OcclusionBuffer {
  public:
    // Errors: out_of_range.
    [[nodiscard]] static Result<OcclusionBuffer> create(const BufferSize& size = {});
    ~OcclusionBuffer();
    OcclusionBuffer(OcclusionBuffer&&) noexcept;
    OcclusionBuffer& operator=(OcclusionBuffer&&) noexcept;

    // Replaces what was drawn before. Same bits for any executor and instruction set; allocates nothing once it has
    // drawn as much.
    void draw(const OccluderSet& occluders, const OcclusionView& view, Executor& executor = serial_executor());
    // Of all these alone, as far as they are on: many views may draw from one set at once. Requires ids of the set,
    // each once.
    void draw(const OccluderSet& occluders, std::span<const OccluderId> chosen, const OcclusionView& view,
              Executor& executor = serial_executor());

    // True only if no point of the box is seen: each ray of the view that meets the box meets an occluder before it
    // does. False where the box is outside the view, comes before the near plane, or is not valid.
    [[nodiscard]] bool hides(const Obb& box) const;
    // Bit i % 64 of word i / 64 for boxes[i]: as hides(). Requires one bit for each box.
    void find_hidden(std::span<const Obb> boxes, std::span<std::uint64_t> hidden,
                     Executor& executor = serial_executor()) const;
    // The occluders that hide a box that is hidden: those whose depth is stored in a pixel of the rectangle around its
    // picture. Ascending; empty where the box is not hidden. Slow and allocating: draws each occluder again.
    void hidden_by(const Obb& box, Vector<OccluderId>& ids) const;

    [[nodiscard]] BufferSize size() const;
    [[nodiscard]] const OcclusionView& view() const;
    [[nodiscard]] const DrawStatistics& statistics() const;
    // z / w of the view in column x and row y, counted from the left and from the bottom; kUncovered, which is less
    // than any that is seen, where the pixel is not covered.
    [[nodiscard]] float nearness(std::uint32_t x, std::uint32_t y) const;
    static constexpr float kUncovered = -3e38f;
    // All of them, row by row from the bottom. Requires width · height numbers.
    void read(std::span<float> nearness) const;
    [[nodiscard]] std::uint64_t count_covered() const;  // pixels; looks at all

    struct Data;
    [[nodiscard]] const Data& data() const { return *data_; }  // for the module's own kernels

  private:
    OcclusionBuffer();
    void draw(const OccluderSet& occluders, const OccluderId* chosen, std::size_t count, const OcclusionView& view,
              Executor& executor);
    std::unique_ptr<Data> data_;
};

}  // namespace crofton::occlude
