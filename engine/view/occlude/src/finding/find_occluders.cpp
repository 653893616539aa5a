// SPDX-License-Identifier: MIT
#include <algorithm>
#include <crofton/occlude/occluder.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <string>

#include "finding/candidates.hpp"
#include "finding/shadows.hpp"
#include "finding/solid_grid.hpp"

namespace crofton::occlude {
namespace {

constexpr std::size_t kMostPieces = 64;      // the largest are searched for bodies
constexpr std::uint32_t kEdgesOfSetup = 12;  // what an occluder costs besides its edges, in edges
constexpr std::uint32_t kEdgesOfBox = 12;

Result<void> check_options(const FindOptions& options) {
    const auto bad = [](const char* why) { return fail(ErrorCode::out_of_range, kNoItem, {"find_occluders: ", why}); };
    if (options.grid < 4 || options.grid > SolidGrid::kMaxCells) return bad("grid must be 4 to 32");
    if (!(options.least_gain >= 0.0 && options.least_gain <= 1.0)) return bad("least_gain must be 0 to 1");
    if (!(options.flatness >= 0.0 && options.flatness <= 1.0)) return bad("flatness must be 0 to 1");
    return {};
}

// Closed pieces whose bounds throw enough of a shadow, the largest first.
Vector<Piece> pieces_to_search(const Search& search) {
    struct Sized {
        Piece piece;
        double shadow;
    };
    Vector<Sized> sized;
    for (const Piece& piece : search.mesh.pieces) {
        if (!is_closed(piece, search.options.sides)) continue;
        const glm::dvec3 e = 2.0 * bounds_of(search.mesh, piece).half_extents();
        const double shadow = 0.5 * (e.x * e.y + e.y * e.z + e.z * e.x);
        if (shadow >= search.least_shadow) sized.push_back({piece, shadow});
    }
    std::stable_sort(sized.begin(), sized.end(), [](const Sized& a, const Sized& b) { return a.shadow > b.shadow; });
    Vector<Piece> pieces;
    for (std::size_t i = 0; i < std::min(sized.size(), kMostPieces); ++i) pieces.push_back(sized[i].piece);
    return pieces;
}

void draw(const ShadowCaster& caster, const FoundOccluder& occluder, ShadowBits& bits) {
    const bool front_only = occluder.kind == OccluderKind::patch && occluder.sides == Sides::front;
    const TriangleMesh& mesh = occluder.surface;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
        caster.draw({glm::dvec3(mesh.positions[mesh.indices[i]]), glm::dvec3(mesh.positions[mesh.indices[i + 1]]),
                     glm::dvec3(mesh.positions[mesh.indices[i + 2]])},
                    front_only, bits);
}

bool has_eye_limits(const FoundOccluder& occluder) {
    const Aabb all = everywhere();
    return occluder.eyes_within.min != all.min || occluder.eyes_within.max != all.max;
}

// Chooses greedily: area already in shadow no longer counts. The first of equals wins.
void choose(const Search& search, const ShadowCaster& caster, Vector<FoundOccluder>& candidates,
            FoundOccluders& result) {
    Vector<ShadowBits> shadows(candidates.size());
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        draw(caster, candidates[i], shadows[i]);
        candidates[i].gain = std::numeric_limits<double>::infinity();
    }
    ShadowBits covered;
    Vector<std::uint8_t> open(candidates.size(), 1);
    std::uint32_t edges_left = search.options.max_edges;
    while (result.occluders.size() < search.options.max_occluders) {
        double best = 0.0, best_gain = 0.0;
        std::size_t chosen = candidates.size();
        for (std::size_t i = 0; i < candidates.size(); ++i) {
            if (open[i] == 0 || candidates[i].edges > edges_left) continue;
            const double cost = candidates[i].edges + kEdgesOfSetup;
            // Gains only decrease, so the last known gain is an upper bound.
            if (candidates[i].gain / cost <= best) continue;
            const double gain = candidates[i].gain = caster.mean_area_beyond(shadows[i], covered);
            if (gain < search.least_shadow || !(gain > 0.0)) {
                open[i] = 0;
                continue;
            }
            const double worth = gain / cost;
            if (worth <= best) continue;
            best = worth;
            best_gain = gain;
            chosen = i;
        }
        if (chosen == candidates.size()) break;
        open[chosen] = 0;
        edges_left -= candidates[chosen].edges;
        // An occluder that only some eyes may use does not replace others: eyes elsewhere need them.
        if (!has_eye_limits(candidates[chosen]))
            for (std::size_t r = 0; r < covered.rows.size(); ++r) covered.rows[r] |= shadows[chosen].rows[r];
        candidates[chosen].gain = best_gain;
        result.occluders.push_back(std::move(candidates[chosen]));
    }
    result.covered = caster.mean_area(covered);
}

}  // namespace

Result<FoundOccluders> find_occluders(const TriangleMesh& mesh, const FindOptions& options) {
    if (auto status = check_options(options); !status) return status.error();
    if (mesh.indices.size() % 3 != 0)
        return fail(ErrorCode::invalid_argument, mesh.indices.size(),
                    "find_occluders: the index count is no multiple of three");
    if (mesh.triangle_count() >= std::size_t{1} << 28)
        return fail(ErrorCode::out_of_range, mesh.triangle_count(),
                    "find_occluders: 2^28 triangles or more; split the mesh");
    if (options.level_triangles > 0 && mesh.triangle_count() >= std::size_t{1} << 26)
        return fail(ErrorCode::out_of_range, mesh.triangle_count(),
                    "find_occluders: a level of 2^26 triangles or more; split it");
    PieceMesh pieces = split_into_pieces(mesh);
    if (pieces.triangles.empty())
        return fail(ErrorCode::empty, kNoItem, "find_occluders: the mesh has no valid triangle");
    FoundOccluders result;
    result.rejected = pieces.rejected;
    result.pieces = static_cast<std::uint32_t>(pieces.pieces.size());
    Aabb bounds;
    for (const Piece& piece : pieces.pieces) {
        bounds.include(bounds_of(pieces, piece));
        result.closed_pieces += is_closed(piece, options.sides) ? 1 : 0;
    }
    const ShadowCaster caster(bounds);
    ShadowBits all;
    for (std::uint32_t t = 0; t < pieces.triangles.size(); ++t)
        caster.draw(pieces.corners(t), options.sides == Sides::front, all);
    result.mean_shadow = caster.mean_area(all);

    const Search search{pieces, options, options.least_gain * result.mean_shadow,
                        2.0 * glm::length(bounds.half_extents())};
    Vector<FoundOccluder> candidates;
    for (const Piece& piece : pieces_to_search(search)) {
        const std::size_t before = candidates.size();
        const bool is_convex = add_convex_piece(search, piece, candidates);
        const bool is_cheap = candidates.size() > before && candidates.back().edges <= kEdgesOfBox;
        if (!(is_convex && is_cheap)) add_boxes(search, piece, candidates);
    }
    add_walled_box(search, candidates);
    const bool is_level = options.level_triangles > 0;
    if (!is_level) add_patches(search, candidates);
    choose(search, caster, candidates, result);
    if (!is_level) return result;
    add_level_surfaces(search, result.occluders);
    result.covered = result.mean_shadow;  // of all its triangles
    return result;
}

}  // namespace crofton::occlude
