// SPDX-License-Identifier: MIT
// Whether two convex polytopes meet, as other libraries tell. Boxes and hulls, without margins. Each is there where its
// library was found; what a library cannot build it throws.
#pragma once
#include <crofton/convex/query.hpp>

namespace crofton::bench {

bool fcl_meets(const convex::ShapeAtPose& a, const convex::ShapeAtPose& b);
bool bullet_meets(const convex::ShapeAtPose& a, const convex::ShapeAtPose& b);
bool ode_meets(const convex::ShapeAtPose& a, const convex::ShapeAtPose& b);  // between dInitODE2 and dCloseODE
bool coal_meets(const convex::ShapeAtPose& a, const convex::ShapeAtPose& b);
// Float, relative to a: so its worlds do it when they count in double.
bool jolt_meets(const convex::ShapeAtPose& a, const convex::ShapeAtPose& b);
bool box3d_meets(const convex::ShapeAtPose& a, const convex::ShapeAtPose& b);

}  // namespace crofton::bench
