// SPDX-License-Identifier: MIT
// Vehicles that drive around blocks, on the right, for ever.
#pragma once
#include <crofton/scene/scene.hpp>
#include <vector>

namespace crofton::assets::town {

// Street centre lines: streets run along x at each z line and along z at each x line; both ascend.
struct Grid {
    std::vector<double> x_lines, z_lines;
};

// A rectangle of street centre lines, driven in the right-hand lane with rounded corners.
struct Loop {
    double x0 = 0.0, x1 = 0.0, z0 = 0.0, z1 = 0.0;
    bool clockwise = false;  // seen from above (from +y, x to the right and z down)

    [[nodiscard]] double length() const;
    [[nodiscard]] glm::dvec3 at(double distance) const;  // any distance, the loop repeats
};

struct Driver {
    Loop loop;
    double start = 0.0, speed = 10.0;  // metres, metres a second
    double wheelbase = 2.8;            // the body points from the path this far behind to its front
    scene::NodeId node = scene::kNone;
    scene::NodeId trailer = scene::kNone;
    double hitch = 0.0;
};

// Where the driver's front axle path has taken its body after `seconds`: origin at the wheelbase's middle.
[[nodiscard]] Transform pose(const Driver& driver, double seconds);
[[nodiscard]] Transform trailer_pose(const Driver& driver, double seconds);

}  // namespace crofton::assets::town
