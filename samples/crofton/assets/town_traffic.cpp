// SPDX-License-Identifier: MIT
#include "assets/town_traffic.hpp"

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace crofton::assets::town {
namespace {

constexpr double kLane = 1.9;    // from the centre line
constexpr double kCorner = 4.0;  // radius
constexpr double kTrailerBase = 6.0;

struct Rectangle {
    double x, z, half_x, half_z;  // centre, half sides of the driven line
};

// Clockwise, the inner lane is on the right; counter-clockwise, the outer one.
Rectangle driven(const Loop& loop) {
    const double outward = loop.clockwise ? -kLane : kLane;
    return {0.5 * (loop.x0 + loop.x1), 0.5 * (loop.z0 + loop.z1), 0.5 * (loop.x1 - loop.x0) + outward,
            0.5 * (loop.z1 - loop.z0) + outward};
}

Transform facing(const glm::dvec3& middle, const glm::dvec3& direction) {
    const glm::dvec3 forward = glm::normalize(direction), up(0, 1, 0);
    return {glm::dmat3(forward, up, glm::cross(forward, up)), middle};
}

}  // namespace

double Loop::length() const {
    const Rectangle r = driven(*this);
    return 4.0 * (r.half_x + r.half_z) - 8.0 * kCorner + 2.0 * std::numbers::pi * kCorner;
}

glm::dvec3 Loop::at(double distance) const {
    const Rectangle r = driven(*this);
    const double whole = length(), quarter = 0.5 * std::numbers::pi * kCorner;
    double s = distance - whole * std::floor(distance / whole);
    // From the middle of the corner region (+x, −z) on: side by side, each a straight and a quarter circle.
    double angle = 0.0;
    for (int side = 0; side < 4; ++side) {
        const bool along_z = side % 2 == 0;
        const double straight = 2.0 * ((along_z ? r.half_z : r.half_x) - kCorner);
        const double half = along_z ? r.half_z - kCorner : r.half_x - kCorner, off = along_z ? r.half_x : r.half_z;
        // In the frame of this side: walking forward at lateral distance `off` to the centre's right-hand normal.
        double forward = 0.0, lateral = off;
        const bool here = s <= straight + quarter || side == 3;
        if (here) {
            if (s <= straight) {
                forward = s - half;
            } else {
                const double turn = std::min((s - straight) / kCorner, 0.5 * std::numbers::pi);
                forward = half + kCorner * std::sin(turn);
                lateral = off - kCorner * (1.0 - std::cos(turn));
            }
            const double c = std::cos(angle), sn = std::sin(angle);
            // Side 0 runs along +z at +x; each next side is turned by a quarter, clockwise seen from above.
            const double px = lateral * c - forward * sn, pz = lateral * sn + forward * c;
            return {r.x + px, 0.0, r.z + (clockwise ? pz : -pz)};
        }
        s -= straight + quarter;
        angle += 0.5 * std::numbers::pi;
    }
    return {r.x, 0.0, r.z};
}

Transform pose(const Driver& driver, double seconds) {
    const double s = driver.start + driver.speed * seconds;
    const glm::dvec3 front = driver.loop.at(s), back = driver.loop.at(s - driver.wheelbase);
    return facing(0.5 * (front + back), front - back);
}

Transform trailer_pose(const Driver& driver, double seconds) {
    const Transform body = pose(driver, seconds);
    const glm::dvec3 hinge = body * glm::dvec3(-driver.hitch, 0.0, 0.0);
    const double s = driver.start + driver.speed * seconds - 0.5 * driver.wheelbase - driver.hitch;
    return facing(hinge, hinge - driver.loop.at(s - kTrailerBase));
}

}  // namespace crofton::assets::town
