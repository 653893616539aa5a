// SPDX-License-Identifier: MIT
// Lists the triangles that a line crosses.
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/core/error.hpp>
#include <crofton/core/recovery.hpp>
#include <crofton/lines/lines.hpp>
#include <glm/geometric.hpp>

#include "hit_order.hpp"
#include "trace_kernels.hpp"
#include "tracer_build.hpp"

namespace crofton::lines {
namespace {

constexpr std::size_t kBatch = 256;

detail::FlatRay flat(const Line& line, const glm::dvec3& origin, std::uint32_t skip) {
    detail::FlatRay ray;
    const glm::dvec3 point = line.point - origin;
    for (int k = 0; k < 3; ++k) {
        ray.point[k] = static_cast<float>(point[k]);
        const float d = static_cast<float>(line.direction[k]);
        // A component of zero would make 0 · ∞; this one bends the line by less than a float's resolution.
        ray.direction[k] = std::abs(d) < 1e-20f ? std::copysign(1e-20f, d) : d;
    }
    ray.skip = skip;
    return ray;
}

Hit unpacked(const detail::FlatHit& hit) {
    if (hit.triangle == detail::kMiss) return {};
    return {hit.t, hit.triangle & ~detail::kFront, (hit.triangle & detail::kFront) != 0};
}

// One thread's memory.
struct StreamMemory {
    static constexpr std::size_t kMost = 4096;  // lines at once: what is kept of them fits a core's own cache
    Vector<detail::StreamLine> lines;
    Vector<std::uint16_t> lists;
    Vector<float> t;
    Vector<std::uint32_t> triangle, line;
    detail::HitOrder order;

    void reserve(std::size_t count) {
        if (lines.size() < count) lines.resize(count);
        if (lists.size() < 32 * count + 1024) lists.resize(32 * count + 1024);
        if (t.size() < 4 * count + 1024) resize_crossings(4 * count + 1024);
    }
    void resize_crossings(std::size_t count) {
        triangle.resize(count);
        line.resize(count);
        t.resize(count);  // last: its size is the room that there is, also where memory ends before
    }
    void grow(detail::StreamEnd end) {
        if (end == detail::StreamEnd::lists_full)
            lists.resize(2 * lists.size());
        else
            resize_crossings(2 * t.size());
    }
    detail::StreamCrossings room() { return {t.data(), triangle.data(), line.data(), 0, t.size()}; }
};

}  // namespace

LineTracer::LineTracer() = default;
LineTracer::~LineTracer() = default;
LineTracer::LineTracer(LineTracer&&) noexcept = default;
LineTracer& LineTracer::operator=(LineTracer&&) noexcept = default;

Result<LineTracer> LineTracer::build(const TriangleMesh& mesh) {
    return crofton::detail::recover([&]() -> Result<LineTracer> {
        if (auto valid = validate(mesh); !valid) return valid.error();
        if (mesh.indices.empty()) return fail(ErrorCode::empty, kNoItem, "line tracer: there are no triangles");
        if (mesh.triangle_count() >= std::size_t{1} << 30)
            return fail(ErrorCode::out_of_range, mesh.triangle_count(), "line tracer: 2^30 triangles or more");
        LineTracer tracer;
        for (const std::uint32_t i : mesh.indices) tracer.bounds_.include(glm::dvec3(mesh.positions[i]));
        tracer.origin_ = tracer.bounds_.center();
        tracer.tie_ = static_cast<float>(1e-6 * glm::length(tracer.bounds_.half_extents()));
        detail::build_tracer(mesh, tracer.origin_, tracer.nodes_, tracer.leaves_);
        return tracer;
    });
}

std::size_t LineTracer::bytes() const {
    return nodes_.capacity() * sizeof(mesh::BoxNode) + leaves_.capacity() * sizeof(detail::TracerLeaf);
}

detail::TracerView LineTracer::view() const {
    return {nodes_.data(), leaves_.data(), tie_};
}

void LineTracer::all_hits(std::span<const Line> lines, LineHits& result) const {
    static_assert(sizeof(Line) == 6 * sizeof(double));
    thread_local StreamMemory stream;
    const detail::TracerView tree = view();
    const double origin[3] = {origin_.x, origin_.y, origin_.z};
    result.hits.clear();
    result.ends.clear();
    for (std::size_t begin = 0; begin < lines.size(); begin += StreamMemory::kMost) {
        const std::size_t count = std::min(StreamMemory::kMost, lines.size() - begin);
        stream.reserve(count);
        detail::flatten(&lines[begin].point.x, count, origin, stream.lines.data());
        detail::StreamCrossings found;
        for (;;) {
            found = stream.room();
            const auto end =
                detail::trace_stream(tree, stream.lines.data(), count, stream.lists.data(), stream.lists.size(), found);
            if (end == detail::StreamEnd::done) break;
            stream.grow(end);
        }
        stream.order.append(found, count, tie_, result);
    }
}

void LineTracer::first_hits(std::span<const FirstHitQuery> rays, std::span<Hit> result) const {
    CROFTON_ASSERT(rays.size() == result.size(), "one result per ray");
    const detail::TracerView tree = view();
    std::array<detail::FlatRay, kBatch> flat_rays;
    std::array<detail::FlatHit, kBatch> hits;
    for (std::size_t begin = 0; begin < rays.size(); begin += kBatch) {
        const std::size_t count = std::min(kBatch, rays.size() - begin);
        for (std::size_t i = 0; i < count; ++i)
            flat_rays[i] = flat(rays[begin + i].line, origin_, rays[begin + i].skip);
        detail::trace_first(tree, flat_rays.data(), count, hits.data());
        for (std::size_t i = 0; i < count; ++i) result[begin + i] = unpacked(hits[i]);
    }
}

}  // namespace crofton::lines
