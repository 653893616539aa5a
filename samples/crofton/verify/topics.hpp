// SPDX-License-Identifier: MIT
// The claims `crofton verify` can check, by topic.
#pragma once
#include <crofton/core/error.hpp>
#include <string>
#include <vector>

#include "assets/scene_source.hpp"

#include "rows.hpp"

namespace crofton::cli {

// The measures and criteria: equations, theorems and examples of the paper, corrected where theory.md says so.
[[nodiscard]] std::vector<VerifyRow> verify_paper(const VerifyOptions& options);
// Global lines: the densities that are uniform, those that are not, and what a patch expects of them.
[[nodiscard]] std::vector<VerifyRow> verify_lines(const VerifyOptions& options);
// Culling: `trials` straddlers of each kind of bound at each camera offset from 0 to 1e7, asked by every path of the
// culling. All counts, no chance.
[[nodiscard]] std::vector<VerifyRow> verify_cull(const VerifyOptions& options);
// Occlusion: verify_occluded_scene of the town.
[[nodiscard]] std::vector<VerifyRow> verify_occlude(const VerifyOptions& options);
// Boxes that nearly touch, against exact numbers: no wrong answer in any class of gap and angle. Then the rows of
// verify_convex.
[[nodiscard]] std::vector<VerifyRow> verify_collide(const VerifyOptions& options);
// Polytopes that nearly touch, their depths and casts: no wrong answer, by exact arithmetic.
[[nodiscard]] std::vector<VerifyRow> verify_convex(const VerifyOptions& options);
// Visible sets: a bake of the town with about `trials` lines; 20 times as many for each of some cells, by another way.
// `trials` rays from eyes in the cells, and pictures of street views.
[[nodiscard]] std::vector<VerifyRow> verify_pvs(const VerifyOptions& options);

// The topic occlude on a scene: occluders are found in the scene's meshes. At each offset from 0 to 1e7 `trials` rays
// through random points of pictures are cast; the first object that one meets must be in World's answer for that view.
// Small boxes that move are among the objects. Errors: as assets::load_scene.
[[nodiscard]] Result<std::vector<VerifyRow>> verify_occluded_scene(const std::string& source,
                                                                   const assets::LoadOptions& which,
                                                                   const VerifyOptions& options);
// The topic collide on a scene: hulls of all meshes and of their pieces, and all of it as one mesh; on a map of
// polygons a height field, with holes where there is no polygon. Shapes nearly touch these, at 0, 1e3 and 1e7 times the
// size from the origin. Overlap, distances and casts must agree with exact arithmetic on each triangle. Errors: as
// assets::load_scene and read_polygons.
[[nodiscard]] Result<std::vector<VerifyRow>> verify_collided_scene(const std::string& source,
                                                                   const assets::LoadOptions& which,
                                                                   const VerifyOptions& options);

// Parts of verify_paper.
[[nodiscard]] std::vector<VerifyRow> kinematic_rows(const VerifyOptions& options);
[[nodiscard]] std::vector<VerifyRow> planar_rows(const VerifyOptions& options);
[[nodiscard]] std::vector<VerifyRow> criterion_rows(const VerifyOptions& options);
// The sharp rows: mostly without chance, at a cost that does not depend on the trials.
[[nodiscard]] std::vector<VerifyRow> volume_rows(const VerifyOptions& options);
[[nodiscard]] std::vector<VerifyRow> common_rows(const VerifyOptions& options);
[[nodiscard]] std::vector<VerifyRow> bound_rows(const VerifyOptions& options);
[[nodiscard]] std::vector<VerifyRow> triangulation_rows(const VerifyOptions& options);
[[nodiscard]] std::vector<VerifyRow> tree_rows(const VerifyOptions& options);
// Formulas that no theorem's row calls, mostly without random numbers.
[[nodiscard]] std::vector<VerifyRow> formula_rows(const VerifyOptions& options);
// Likewise of shapes: least figures, masses, meshes, limits and shadows.
[[nodiscard]] std::vector<VerifyRow> shape_rows(const VerifyOptions& options);

// Part of verify_lines.
[[nodiscard]] std::vector<VerifyRow> factor_rows(const VerifyOptions& options);

}  // namespace crofton::cli
