// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/core/error.hpp>
#include <crofton/core/recovery.hpp>
#include <crofton/radiosity/lines.hpp>
#include <glm/geometric.hpp>

#include "trace_kernels.hpp"
#include "tracer_build.hpp"

namespace crofton::radiosity {
namespace {

constexpr std::size_t kBatch = 256;

detail::FlatRay flat(const Line& line, const glm::dvec3& origin, std::uint32_t skip) {
    detail::FlatRay ray;
    const glm::dvec3 point = line.point - origin;
    for (int k = 0; k < 3; ++k) {
        ray.point[k] = static_cast<float>(point[k]);
        const float d = static_cast<float>(line.direction[k]);
        // A component of zero would make 0 · ∞; this one bends the line by less than float can tell.
        ray.direction[k] = std::abs(d) < 1e-20f ? std::copysign(1e-20f, d) : d;
    }
    ray.skip = skip;
    return ray;
}

Hit unpacked(const detail::FlatHit& hit) {
    if (hit.triangle == detail::kMiss) return {};
    return {hit.t, hit.triangle & ~detail::kFront, (hit.triangle & detail::kFront) != 0};
}

}  // namespace

LineTracer::LineTracer() = default;
LineTracer::~LineTracer() = default;
LineTracer::LineTracer(LineTracer&&) noexcept = default;
LineTracer& LineTracer::operator=(LineTracer&&) noexcept = default;

Result<LineTracer> LineTracer::build(const TriangleMesh& mesh) {
    return crofton::detail::recover([&]() -> Result<LineTracer> {
        if (auto valid = validate(mesh); !valid) return tl::unexpected(valid.error());
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
    const glm::vec3 half(bounds_.half_extents());
    return {nodes_.data(), leaves_.data(), tie_, {half.x, half.y, half.z}};
}

void LineTracer::all_hits(std::span<const Line> lines, LineHits& result) const {
    const detail::TracerView tree = view();
    std::array<detail::FlatRay, kBatch> rays;
    std::array<std::uint32_t, kBatch> ends;
    thread_local Vector<detail::FlatHit> hits;
    if (hits.empty()) hits.resize(64 * kBatch);
    result.hits.clear();
    result.ends.clear();
    for (std::size_t begin = 0; begin < lines.size();) {
        const std::size_t count = std::min(kBatch, lines.size() - begin);
        for (std::size_t i = 0; i < count; ++i) rays[i] = flat(lines[begin + i], origin_, Hit::kNothing);
        const std::size_t done = detail::trace_all(tree, rays.data(), count, hits.data(), hits.size(), ends.data());
        if (done == 0) {
            hits.resize(2 * hits.size());
            continue;
        }
        const std::size_t before = result.hits.size();
        for (std::size_t h = 0; h < ends[done - 1]; ++h) result.hits.push_back(unpacked(hits[h]));
        for (std::size_t i = 0; i < done; ++i) result.ends.push_back(static_cast<std::uint32_t>(before + ends[i]));
        begin += done;
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

}  // namespace crofton::radiosity
