// SPDX-License-Identifier: MIT
// Which of many occluders to draw for a view: those that cover most of it.
#pragma once
#include <array>
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/shapes.hpp>
#include <crofton/occlude/find_occluders.hpp>
#include <crofton/occlude/occlusion_view.hpp>
#include <crofton/scene/transform.hpp>
#include <cstdint>
#include <limits>

namespace crofton::occlude {

// From where an occluder must not be used: what it lies in, and the sides of it that are open.
struct EyeLimits {
    Aabb left_out_within;  // FoundOccluder::piece_bounds; empty: none
    // The eye is on the kept side of all (FoundOccluder::eyes_within).
    std::array<Plane, 6> planes{};
    std::uint32_t plane_count = 0;
};

// Whether all that the occluder hides from this camera is hidden by what it lies in: the eye keeps the limits and is
// farther away than any point of its near plane. For a parallel view: what it lies in is wholly beyond the near plane,
// and no open side faces the view. Conservative where rounding leaves a doubt. Requires a valid camera.
[[nodiscard]] bool may_use(const EyeLimits& limits, const Camera& camera);
[[nodiscard]] bool may_use(const EyeLimits& limits, const OcclusionView& view);

// How large an occluder looks from where, and where it must not be used. World coordinates.
struct OccluderCandidate {
    glm::dvec3 center{0.0};
    double radius = 0.0;  // of a ball around the center that contains the occluder
    // Seen along a unit direction d it covers the area Σ |dot(d, areas[k])|: of a box, areas[k] is the area of the
    // faces across axis k times the axis; of a patch, areas[0] is its area times its normal, the others are 0.
    std::array<glm::vec3, 3> areas{};
    bool front_only = false;  // hides only where dot(d, areas[0]) < 0
    std::uint32_t edges = 12;
    std::uint32_t layers = ~0u;  // of what it is part of: only views that draw that may use it
    EyeLimits limits;
};

[[nodiscard]] OccluderCandidate candidate_of(const Obb& box);
// An occluder of a mesh that stands under `transform`. A convex body counts as a cube of its surface area. Of a patch
// the mean normal counts; where that is less than nine tenths, as of a closed mesh, a box of its mean shadows along the
// axes.
[[nodiscard]] OccluderCandidate candidate_of(const FoundOccluder& found, const scene::Transform& transform);

// Candidates by id, stored for vector kernels. Ids are 0, 1, 2, … in the order of add().
class OccluderCandidates {
  public:
    // Errors leave all as it was: non_finite, out_of_range (coordinates beyond 1e15), with `item` the id.
    [[nodiscard]] Result<std::uint32_t> add(const OccluderCandidate& candidate);
    [[nodiscard]] Result<void> set(std::uint32_t id, const OccluderCandidate& candidate);
    void reserve(std::size_t count);
    void clear();
    [[nodiscard]] std::size_t size() const { return edges_.size(); }

    // Coordinates relative to origin(), rounded to float, by component: center, radius, nine of the areas, then 0 or
    // the largest float for front_only.
    static constexpr std::size_t kColumns = 14;
    [[nodiscard]] const glm::dvec3& origin() const { return origin_; }
    [[nodiscard]] const float* column(std::size_t k) const { return columns_[k].data(); }
    [[nodiscard]] std::uint32_t edges(std::uint32_t id) const { return edges_[id]; }
    [[nodiscard]] std::uint32_t layers(std::uint32_t id) const { return layers_[id]; }
    [[nodiscard]] const EyeLimits& limits(std::uint32_t id) const { return limits_[id]; }

  private:
    [[nodiscard]] Result<void> check(std::uint32_t id, const OccluderCandidate& candidate) const;
    void write(std::uint32_t id, const OccluderCandidate& candidate);

    glm::dvec3 origin_{0.0};  // the first candidate's center
    std::array<Vector<float>, kColumns> columns_;
    Vector<std::uint32_t> edges_, layers_;
    Vector<EyeLimits> limits_;
};

struct ChooseBudget {
    std::uint32_t max_occluders = 256;
    std::uint32_t max_edges = (std::numeric_limits<std::uint32_t>::max)();
    // Of what it covers of the sphere of directions, 4π (parallel views: of the picture's area). What covers less is
    // left out: 2e-5 are about ten pixels of 640 × 360 at 60°.
    float least_cover = 2e-5f;
    // Where the objects are that may be hidden. What lies behind an occluder is then counted: how far the ray from the
    // eye through its center runs on in these bounds. So the ground, with nothing below, is worth nothing, and of two
    // walls that look alike the nearer one is worth more. Empty: all that covers alike is worth the same.
    Aabb objects = {};
    std::uint32_t layer_mask = ~0u;  // only candidates that share a layer with it
};

// Keeps its memory from frame to frame.
struct OccluderChoice {
    Vector<std::uint32_t> ids;  // those worth most first; of equals the lower id

    Vector<float> values;  // scratch from here on
    Vector<std::uint32_t> seen;
    Vector<std::uint64_t> order;
};

// The candidates that are worth most to the view, each by itself: their projected area over the squared distance, or
// for a parallel view over the picture's area, times the way behind them. Of objects spread evenly with density n and
// mean shadow A, a solid angle ω with a way L behind hides n·A·L·ω of their solid angles on average. Any choice is
// right; a better one hides more. Same ids for any instruction set. Allocates nothing once `choice` and the candidates
// have been as large. Errors: as validate(Camera).
[[nodiscard]] Result<void> choose_occluders(const OccluderCandidates& candidates, const Camera& camera,
                                            const ChooseBudget& budget, OccluderChoice& choice);
void choose_occluders(const OccluderCandidates& candidates, const OcclusionView& view, const ChooseBudget& budget,
                      OccluderChoice& choice);

}  // namespace crofton::occlude
