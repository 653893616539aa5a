// A flat list of boxes, laid out for testing all of them against a view at the speed of memory.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/cull/classify.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/geometry/obb.hpp>
#include <cstddef>
#include <cstdint>
#include <span>

namespace crofton::cull {

// 16 spheres around boxes, relative to their chunk's origin.
struct alignas(64) SphereBlock {
    float x[16], y[16], z[16];
    float radius[16];  // −infinity for lanes beyond the last box
};

// A box relative to its chunk's origin: centre, then the half edges.
struct BoxRecord {
    float center[3];
    float edge[9];
};

struct Chunk {
    double origin[3];
    double reach;  // ≥ |x| + |y| + |z| of its centres, and its radii
};

// What a query of a BoxSet answers: bit i % 64 of word i / 64 is box i's.
struct VerdictBits {
    Vector<std::uint64_t> visible;  // not outside
    Vector<std::uint64_t> inside;
    Statistics statistics;

    [[nodiscard]] Verdict verdict(std::size_t i) const {
        if (!(visible[i / 64] >> (i % 64) & 1)) return Verdict::outside;
        return inside[i / 64] >> (i % 64) & 1 ? Verdict::inside : Verdict::straddling;
    }

    // For the set's own use: the boxes that vectors cannot decide, and their number, by chunk.
    struct Count {
        std::uint32_t records_tested, undecided;
    };
    Vector<std::uint32_t> undecided;
    Vector<Count> counts;
};

// 64 bytes a box beside the user's boxes, which queries ask for again: the few that floats cannot decide are decided
// there.
class BoxSet {
  public:
    // Boxes that are not finite may be among them: they are straddling.
    void assign(std::span<const Obb> boxes, Executor& executor = serial_executor());
    // boxes[i] has changed, for each of `items`. Requires indices below size().
    void update(std::span<const std::uint32_t> items, std::span<const Obb> boxes);

    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] std::span<const SphereBlock> spheres() const { return spheres_; }
    [[nodiscard]] std::span<const BoxRecord> records() const { return records_; }
    [[nodiscard]] std::span<const Chunk> chunks() const { return chunks_; }

    static constexpr std::size_t kChunk = 4096;

  private:
    void write(std::size_t i, const Obb& box);

    std::size_t size_ = 0;
    Vector<SphereBlock> spheres_;
    Vector<BoxRecord> records_;
    Vector<Chunk> chunks_;
};

// The verdicts of classify(view.frustum, boxes[i], mode) for all boxes; `boxes` are those that the set was given. The
// view's layers are not looked at. Allocates nothing once `verdicts` has been used for a set of this size.
void cull(const BoxSet& set, std::span<const Obb> boxes, const View& view, VerdictBits& verdicts,
          Mode mode = Mode::exact, Executor& executor = serial_executor());

// The indices of the bits that are set, ascending, into `ids`, which needs room for 16 more than there are; returns how
// many.
std::size_t list_bits(std::span<const std::uint64_t> bits, std::span<ItemId> ids);

}  // namespace crofton::cull
