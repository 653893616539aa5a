// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/shapes.hpp>
#include <cstdint>
#include <cstdio>
#include <oracle/near_misses.hpp>
#include <oracle/sphere_verdict.hpp>

#include "exact_numbers.hpp"
#include "topics.hpp"

namespace crofton::cli {
namespace {

using oracle::NearMisses;

enum class Proof : std::uint8_t { meets, disjoint, none };

template <class Box>
Proof prove_box(const Frustum& frustum, const Box& box) {
    const auto feasible = oracle::proven_feasible<Dyadic>(
        [&]<class Number>() { return oracle::quick::rows_of_box<Number>(frustum, box); });
    return !feasible ? Proof::none : *feasible ? Proof::meets : Proof::disjoint;
}

// By the oracles of the tests: tests/oracle/feasible.hpp for boxes, sphere_verdict.hpp for spheres. Returns `none` for
// boxes that touch to within rounding.
Proof prove(const Frustum& frustum, const Obb& box) {
    return prove_box(frustum, box);
}
Proof prove(const Frustum& frustum, const Aabb& box) {
    return prove_box(frustum, box);
}

Proof prove(const Frustum& frustum, const Sphere& sphere) {
    const auto verdict =
        oracle::decide_by<Dyadic>([&]<class Number>() { return oracle::SphereVerdict<Number>(frustum, sphere)(); });
    return verdict == cull::Verdict::outside ? Proof::disjoint : Proof::meets;
}

constexpr std::size_t kBatch = 2048;  // bounds per view

struct CullCounts {
    std::uint64_t meeting = 0, disjoint = 0, unproved = 0, false_culls = 0, false_accepts = 0,
                  false_culls_conservative = 0, disagreements = 0;
};

// A proof is always found for boxes with a width.
bool has_width(const Obb& box) {
    return box.half_extents.x > 0.0f && box.half_extents.y > 0.0f && box.half_extents.z > 0.0f;
}
// Makes a bound that reaches 1 µm to 1 m across a point of the frustum's surface, inward or (one in two) short of it.
void straddle(NearMisses& random, const Frustum& frustum, Obb& box) {
    do box = random.box(frustum, 1e-6, 1.0);
    while (!has_width(box));
}
void straddle(NearMisses& random, const Frustum& frustum, Aabb& box) {
    Obb placed;
    do placed = random.box_along(glm::mat3(1.0f), frustum, 1e-6, 1.0);
    while (!has_width(placed));
    box.min = placed.center - glm::dvec3(placed.half_extents);
    box.max = placed.center + glm::dvec3(placed.half_extents);
}
void straddle(NearMisses& random, const Frustum& frustum, Sphere& sphere) {
    const auto corners = *frustum_corners(frustum);
    const glm::dvec3 target = random.surface_point(frustum, corners);
    // In the cone of the outward normals there: what lies that way has `target` for its nearest point.
    glm::dvec3 away(0.0);
    for (const Plane& plane : frustum.view())
        if (std::fabs(glm::dot(plane.normal, target - frustum.origin) + plane.offset) < 1e-8)
            away -= random.number(0.0, 1.0) * plane.normal;
    away = random.index(5) == 0 || glm::length(away) < 1e-6 ? random.outward(frustum, corners, target)
                                                            : glm::normalize(away);
    sphere.radius = std::exp(random.number(-4.0, 2.0));
    const double depth = std::exp(random.number(std::log(1e-6), 0.0));
    sphere.center = target + (sphere.radius + (random.index(2) != 0 ? depth : -depth)) * away;
}

// Only boxes have a tree; its verdicts where there is one.
std::vector<cull::Verdict> tree_verdicts(const std::vector<Obb>& boxes, const cull::View& view) {
    std::vector<cull::Verdict> verdicts(boxes.size(), cull::Verdict::outside);
    const auto tree = boxtree::BoxTree::build(boxes);
    cull::VisibleSet visible;
    cull::find_visible(*tree, view, visible);
    for (std::size_t n = 0; n < visible.size(); ++n) verdicts[visible.ids()[n]] = visible.verdicts()[n];
    return verdicts;
}
template <class Bound>
std::vector<cull::Verdict> tree_verdicts(const std::vector<Bound>&, const cull::View&) {
    return {};
}

// One view, many bounds: the list's vectors, alone and with a second view, the tree and the single test must agree, and
// the proofs judge them.
template <class Bound>
void run_batch(NearMisses& random, std::size_t count, CullCounts& counts) {
    const auto frustum = frustum_of(random.camera());
    std::vector<Bound> bounds(count);
    for (Bound& bound : bounds) straddle(random, *frustum, bound);
    const cull::View view{*frustum};
    cull::BoundSet<Bound> set;
    set.assign(bounds);
    cull::VerdictBits exact, conservative;
    cull::find_visible(set, bounds, view, exact);
    cull::find_visible(set, bounds, view, conservative, cull::CullMode::conservative);
    std::vector<std::uint32_t> masks(count);
    const std::array<cull::View, 2> views{cull::View{*frustum_of(random.camera())}, view};
    (void)cull::find_visible(set, bounds, {}, views, masks);
    const std::vector<cull::Verdict> of_tree = tree_verdicts(bounds, view);
    for (std::size_t i = 0; i < count; ++i) {
        const cull::Verdict verdict = cull::classify(*frustum, bounds[i]);
        if (verdict != exact.verdict(i) || (!of_tree.empty() && verdict != of_tree[i]) ||
            (verdict != cull::Verdict::outside) != (masks[i] >> 1 & 1) ||
            cull::classify(*frustum, bounds[i], cull::CullMode::conservative) != conservative.verdict(i))
            ++counts.disagreements;
        switch (prove(*frustum, bounds[i])) {
            case Proof::meets:
                ++counts.meeting;
                counts.false_culls += verdict == cull::Verdict::outside;
                counts.false_culls_conservative += conservative.verdict(i) == cull::Verdict::outside;
                break;
            case Proof::disjoint:
                ++counts.disjoint;
                counts.false_accepts += verdict != cull::Verdict::outside;
                break;
            default:
                ++counts.unproved;
                break;
        }
    }
}

template <class Bound>
void add_rows(const char* kind, double offset, const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    NearMisses random(options.seed, offset);
    CullCounts counts;
    for (std::uint64_t done = 0; done < options.trials; done += kBatch)
        run_batch<Bound>(random, static_cast<std::size_t>(std::min<std::uint64_t>(kBatch, options.trials - done)),
                         counts);
    char where[64];
    std::snprintf(where, sizeof where, "at camera offset %g, 1 um to 1 m deep", offset);
    const auto none = [&](const std::string& what, std::uint64_t cases, std::uint64_t measured) {
        rows.push_back(none_row(std::string(kind) + ": " + what + " " + where, "docs/notes/cull.md", cases, measured));
    };
    none("of " + std::to_string(counts.meeting) + " proved visible none is culled,", counts.meeting,
         counts.false_culls);
    none("of the same none is culled in the conservative mode,", counts.meeting, counts.false_culls_conservative);
    none("of " + std::to_string(counts.disjoint) + " proved invisible none is accepted in the exact mode,",
         counts.disjoint, counts.false_accepts);
    none("vectors, tree and single test give equal verdicts", options.trials, counts.disagreements);
    none("every one is proved visible or invisible", options.trials, counts.unproved);
}

}  // namespace

std::vector<VerifyRow> verify_cull(const VerifyOptions& options) {
    std::vector<VerifyRow> rows;
    for (const double offset : {0.0, 1e4, 1e5, 1e6, 1e7}) {
        add_rows<Obb>("boxes", offset, options, rows);
        add_rows<Aabb>("axis-aligned boxes", offset, options, rows);
        add_rows<Sphere>("spheres", offset, options, rows);
    }
    return rows;
}

}  // namespace crofton::cli
