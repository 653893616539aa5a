#include <algorithm>
#include <bit>
#include <cmath>
#include <crofton/core/assert.hpp>
#include <crofton/cull/box_set.hpp>
#include <limits>

#include "box_constraints.hpp"
#include "flat_kernel.hpp"
#include "query.hpp"

namespace crofton::cull {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

float float_at_least(double value) {
    const float rounded = static_cast<float>(value);
    return static_cast<double>(rounded) < value ? std::nextafter(rounded, kInfinity) : rounded;
}

}  // namespace

void BoxSet::assign(std::span<const Obb> boxes, Executor& executor) {
    size_ = boxes.size();
    spheres_.resize((size_ + 63) / 64 * 4);  // whole words of verdicts
    records_.resize(size_);
    chunks_.resize((size_ + kChunk - 1) / kChunk);
    executor.parallel_for(chunks_.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t c = begin; c < end; ++c) {
            const std::size_t first = c * kChunk, last = std::min(size_, first + kChunk);
            Aabb centers;
            for (std::size_t i = first; i < last; ++i)
                if (is_usable(boxes[i])) centers.include(boxes[i].center);
            for (int j = 0; j < 3; ++j) chunks_[c].origin[j] = centers.is_empty() ? 0.0 : centers.center()[j];
            chunks_[c].reach = 0.0;
            for (std::size_t i = first; i < last; ++i) write(i, boxes[i]);
        }
    });
    for (std::size_t i = size_; i < spheres_.size() * 16; ++i) {
        SphereBlock& block = spheres_[i / 16];
        block.x[i % 16] = block.y[i % 16] = block.z[i % 16] = 0.0f;
        block.radius[i % 16] = -kInfinity;
    }
}

void BoxSet::update(std::span<const std::uint32_t> items, std::span<const Obb> boxes) {
    CROFTON_ASSERT(boxes.size() == size_, "update needs all boxes of the set");
    for (const std::uint32_t i : items) write(i, boxes[i]);
}

void BoxSet::write(std::size_t i, const Obb& box) {
    SphereBlock& block = spheres_[i / 16];
    BoxRecord& record = records_[i];
    Chunk& chunk = chunks_[i / kChunk];
    if (!is_usable(box)) {
        block.x[i % 16] = block.y[i % 16] = block.z[i % 16] = 0.0f;
        block.radius[i % 16] = kInfinity;  // no plane decides
        record = {};
        return;
    }
    double shift = 1e-44, square = 0.0, reach = 0.0;
    for (int j = 0; j < 3; ++j) {
        const double d = box.center[j] - chunk.origin[j];
        record.center[j] = static_cast<float>(d);
        reach += std::fabs(d);
    }
    // The difference rounds by 2^-53, the float by 2^-24, relative to each component.
    shift += reach * 0x1.01p-24;
    glm::dvec3 edge[3];
    for (int k = 0; k < 3; ++k) edge[k] = half_edge(box, k);
    for (int k = 0; k < 3; ++k) {
        for (int j = 0; j < 3; ++j) record.edge[3 * k + j] = static_cast<float>(edge[k][j]);
        // No corner is farther than |Σ ±edge|² ≤ Σ |edge_k|² + 2 Σ |edge_i · edge_k|.
        const glm::dvec3& next = edge[(k + 1) % 3];
        const auto dot = [](const glm::dvec3& a, const glm::dvec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; };
        square += dot(edge[k], edge[k]) + 2.0 * std::fabs(dot(edge[k], next));
    }
    block.x[i % 16] = record.center[0];
    block.y[i % 16] = record.center[1];
    block.z[i % 16] = record.center[2];
    const double radius = std::sqrt(square) + shift;
    block.radius[i % 16] = float_at_least(radius * (1.0 + 0x1p-9) + 1e-37);
    chunk.reach = std::max(chunk.reach, reach * (1.0 + 0x1p-20) + radius);
}

void cull(const BoxSet& set, std::span<const Obb> boxes, const View& view, VerdictBits& verdicts, Mode mode,
          Executor& executor) {
    CROFTON_ASSERT(boxes.size() == set.size(), "cull needs the boxes that the set was given");
    const std::size_t words = (set.size() + 63) / 64;
    verdicts.statistics = {};
    verdicts.visible.resize(words);
    verdicts.inside.resize(words);
    const std::size_t stride = BoxSet::kChunk + 16;
    if (verdicts.undecided.size() < set.chunks().size() * stride)
        verdicts.undecided.resize(set.chunks().size() * stride);
    if (verdicts.counts.size() < set.chunks().size()) verdicts.counts.resize(set.chunks().size());
    const bool usable = is_usable(view.frustum), vectors = usable && has_unit_normals(view.frustum);
    const KernelView kernel_view = kernel_view_of(view);
    executor.parallel_for(set.chunks().size(), 4, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t c = begin; c < end; ++c) {
            const Chunk& chunk = set.chunks()[c];
            const std::size_t first = c * BoxSet::kChunk, count = std::min(BoxSet::kChunk, set.size() - first);
            FlatKernelOutput output{verdicts.visible.data(), verdicts.inside.data(),
                                    verdicts.undecided.data() + c * stride, 0, 0};
            if (vectors) {
                const FlatKernelInput input{set.spheres()[0].x,
                                            set.records()[0].center,
                                            &kernel_view,
                                            {chunk.origin[0], chunk.origin[1], chunk.origin[2]},
                                            chunk.reach,
                                            first,
                                            count,
                                            mode == Mode::exact};
                run_flat_kernel(input, output);
            } else {
                for (std::size_t i = 0; i < count; ++i)
                    output.undecided[output.undecided_count++] = static_cast<std::uint32_t>(first + i);
            }
            verdicts.counts[c] = {static_cast<std::uint32_t>(output.records_tested),
                                  static_cast<std::uint32_t>(output.undecided_count)};
            for (std::size_t n = 0; n < output.undecided_count; ++n) {
                const std::uint32_t i = output.undecided[n];
                const Verdict verdict =
                    usable && is_usable(boxes[i]) ? classify_usable(view.frustum, boxes[i], mode) : Verdict::straddling;
                const std::uint64_t bit = std::uint64_t{1} << (i % 64);
                verdicts.visible[i / 64] =
                    verdict == Verdict::outside ? verdicts.visible[i / 64] & ~bit : verdicts.visible[i / 64] | bit;
                verdicts.inside[i / 64] =
                    verdict == Verdict::inside ? verdicts.inside[i / 64] | bit : verdicts.inside[i / 64] & ~bit;
            }
        }
    });
    if (!kCountStatistics) return;
    verdicts.statistics.boxes_tested = set.size();
    for (std::size_t c = 0; c < set.chunks().size(); ++c)
        verdicts.statistics.exact_tests += verdicts.counts[c].undecided;
}

std::size_t list_bits(std::span<const std::uint64_t> bits, std::span<ItemId> ids) {
    return list_bits_kernel(bits.data(), bits.size(), ids.data());
}

}  // namespace crofton::cull
