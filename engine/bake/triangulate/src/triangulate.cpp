// SPDX-License-Identifier: MIT
#include <cmath>
#include <crofton/core/recovery.hpp>
#include <crofton/triangulate/triangulate.hpp>
#include <limits>
#include <memory>
#include <new>

#include "domain/domain.hpp"
#include "ear/ear_clipping.hpp"
#include "ear/simple_ring.hpp"
#include "minimum_weight/local_improvement.hpp"
#include "minimum_weight/minimum_weight.hpp"

namespace crofton::triangulate {

struct Triangulator::Workspace {
    Domain domain;
    MinimumWeight minimum_weight;
    SimpleRing simple_ring;
    EarClipping ear_clipping;
    LocalImprovement improvement;
    Vector<std::array<std::uint32_t, 3>> lightest, other;

    // Ear clipping of one short ring that touches itself nowhere; false where it is something else.
    [[nodiscard]] Result<bool> clip_simple_ring(const Polygon& polygon, Triangulation& result);
    // False where the caller has cancelled.
    [[nodiscard]] bool complete(Watch& watch, Triangulation& result);
};

Triangulator::Triangulator() : workspace_(new (Allocator<Workspace>().allocate(1)) Workspace) {}
Triangulator::~Triangulator() = default;
Triangulator::Triangulator(Triangulator&&) noexcept = default;
Triangulator& Triangulator::operator=(Triangulator&&) noexcept = default;

void Triangulator::Release::operator()(Workspace* workspace) const {
    workspace->~Workspace();
    Allocator<Workspace>().deallocate(workspace, 1);
}

namespace {

void write(const Domain& domain, Triangulation& result) {
    const auto& mesh = domain.mesh();
    result.triangles.reserve(domain.inside_count());
    const bool shared = domain.has_shared_positions();
    double weight = 0.0;
    for (Index t = 0; t < mesh.triangle_count(); ++t) {
        if (!domain.inside(t)) continue;
        for (Index e = 4 * t; e < 4 * t + 3; ++e) {
            // Each diagonal once; no branches, which would be hard to predict.
            const Index twin = mesh.twin[e] == kNone ? e : mesh.twin[e];
            const bool counts = (twin > e) & domain.inside(twin / 4);
            const glm::dvec2 d = mesh.points[mesh.origin[e]] - mesh.points[mesh.destination(e)];
            weight += counts ? std::sqrt(d.x * d.x + d.y * d.y) : 0.0;
        }
        const Index* const corners = mesh.origin.data() + 4 * t;
        if (shared)
            result.triangles.push_back(
                {domain.input_index(4 * t), domain.input_index(4 * t + 1), domain.input_index(4 * t + 2)});
        else
            result.triangles.push_back(
                {domain.input_of(corners[0]), domain.input_of(corners[1]), domain.input_of(corners[2])});
    }
    result.weight = weight * domain.scale();
}

}  // namespace

Result<void> Triangulator::triangulate(const Polygon& polygon, const TriangulateOptions& options,
                                       Triangulation& result) {
    auto done = detail::recover([&]() -> Result<void> {
        result.triangles.clear();
        result.weight = 0.0;
        result.optimal = false;
        result.gap = std::numeric_limits<double>::infinity();
        Watch watch(options, polygon.points.size());
        if (options.method == Method::ear) {
            const auto clipped = workspace_->clip_simple_ring(polygon, result);
            if (!clipped) return clipped.error();
            if (*clipped) return {};
        }
        if (auto built = workspace_->domain.build(polygon); !built) return built;
        if (options.method == Method::minimum_weight) {
            const auto solved = workspace_->minimum_weight.solve(workspace_->domain, options, watch, result);
            if (!solved) return solved.error();
            if (!result.optimal && !workspace_->complete(watch, result)) {
                result.triangles.clear();
                return fail(ErrorCode::cancelled, kNoItem, "stopped by the caller");
            }
            return {};
        }
        if (options.method == Method::ear) {
            const Domain& domain = workspace_->domain;
            result.weight = workspace_->ear_clipping.run(domain, result.triangles) * domain.scale();
            if (result.triangles.size() != domain.inside_count()) {
                result.triangles.clear();
                return fail(ErrorCode::internal, kNoItem, "a walk without ears");
            }
            return {};
        }
        write(workspace_->domain, result);
        return {};
    });
    if (!done && done.error().code == ErrorCode::out_of_memory) {
        // Drop a half-built state before the next call. An empty workspace has no memory.
        std::destroy_at(workspace_.get());
        std::construct_at(workspace_.get());
        result.triangles.clear();
    }
    return done;
}

Result<bool> Triangulator::Workspace::clip_simple_ring(const Polygon& polygon, Triangulation& result) {
    if (auto checked = domain.check(polygon); !checked) return checked.error();
    const std::span<const glm::dvec2> points = polygon.points;
    if (polygon.ring_count() != 1 || points.size() > SimpleRing::kMostPoints || domain.scale() != 1.0) return false;
    const int turn = simple_ring.turn_of(points);
    if (turn == 0) return false;
    result.triangles.reserve(points.size() - 2);
    result.weight = ear_clipping.run(points, turn > 0, result.triangles);
    if (result.triangles.size() == points.size() - 2) return true;
    result.triangles.clear();
    return fail(ErrorCode::internal, kNoItem, "a walk without ears");
}

// The lightest of what is known, where the search has not come to its end. That is its best triangulation, if it has
// one, ear clipping, Delaunay, and Delaunay with all that is proven; all improved.
bool Triangulator::Workspace::complete(Watch& watch, Triangulation& result) {
    double least = std::numeric_limits<double>::infinity();
    const auto improve = [&] {
        improvement.run(watch);
        const double weight = improvement.weight();
        if (!(weight < least)) return;
        least = weight;
        improvement.write(lightest);
    };
    if (!result.triangles.empty() && improvement.start_from_triangles(domain, result.triangles)) improve();
    other.clear();
    (void)ear_clipping.run(domain, other);
    if (other.size() == domain.inside_count() && improvement.start_from_triangles(domain, other)) improve();
    improvement.start_from_mesh(domain);
    improve();
    if (result.triangles.empty() && !minimum_weight.known_edges().empty()) {
        domain.insert_diagonals(minimum_weight.known_edges());
        improvement.start_from_mesh(domain);
        improve();
    }
    if (watch.cancelled_by_now()) return false;
    result.triangles.swap(lightest);
    result.weight = least * domain.scale();
    result.gap = minimum_weight.gap_of(result.weight);
    return true;
}

Result<Triangulation> triangulate(const Polygon& polygon, const TriangulateOptions& options) {
    return detail::recover([&]() -> Result<Triangulation> {
        Triangulator triangulator;
        Triangulation result;
        if (auto done = triangulator.triangulate(polygon, options, result); !done) {
            return std::move(done.error());
        }
        return result;
    });
}

}  // namespace crofton::triangulate
