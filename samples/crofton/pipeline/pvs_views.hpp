// SPDX-License-Identifier: MIT
// Measures visible sets in pictures: wrong pixels and triangles, in views that the bake did not know.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/pvs/pvs.hpp>
#include <crofton/scene/scene.hpp>
#include <memory>

#include "scene_occluders.hpp"

namespace crofton::pipeline {

struct PvsViewOptions {
    std::uint32_t views = 1000, width = 320, height = 180;
    std::uint64_t seed = 1;
    double near_radius = 0.5;  // no point of a view's near plane is farther from the eye: what the proofs were told
    // Where they are given, the views are also looked at with occlusion at run time, by World::view and its defaults.
    std::shared_ptr<const SceneOccluders> occluders = nullptr;
    double unit = 1.0;  // as FreeSpaceOptions
    StopCallback should_stop = nullptr;
    void* user = nullptr;
};

// Figures of one way to draw. A pixel is wrong if the object of its nearest triangle is not drawn: it is not in the set
// of the eye's cell, or it is called occluded.
struct PvsModeFigures {
    double wrong_mean = 0.0, wrong_worst = 0.0;  // share of a view's pixels, sky and all
    double triangles = 0.0;                      // mean of a view: of objects in the frustum that are drawn
};

struct PvsViewFigures {
    std::uint32_t views = 0, in_no_cell = 0;                // of these eyes, which get everything
    double frustum_triangles = 0.0, owner_triangles = 0.0;  // mean of a view; owners have a pixel
    PvsModeFigures conservative, statistical;
    // With occlusion at run time besides, and that alone. All 0 without occluders.
    bool has_occlusion = false;
    PvsModeFigures occlusion, conservative_and_occlusion, statistical_and_occlusion;
};

// Level views in random directions, 60 degrees high, from random places where one could stand and walk (FreeSpace) and
// the cells reach. Where there are none, they are looked at from within the cells that are not solid. No near plane
// cuts anything. Owners are found by exact rays through the middles of pixels, from the near plane on. Objects that are
// not baked are drawn in any mode: they are left out. The scene has been updated. The same figures for any executor.
// Errors: sizes of 0; no place for an eye within the cells (empty); the callback (cancelled); an occluder that a World
// refuses.
[[nodiscard]] Result<PvsViewFigures> look_at_views(const scene::Scene& scene, const pvs::BakeGeometry& geometry,
                                                   const pvs::Pvs& sets, const PvsViewOptions& options = {},
                                                   Executor& executor = serial_executor());

}  // namespace crofton::pipeline
