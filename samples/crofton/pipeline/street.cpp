// SPDX-License-Identifier: MIT
#include "street.hpp"

#include <algorithm>
#include <cstdio>

namespace crofton::pipeline {
namespace {

// In plain digits, as few as tell the length.
std::string in_digits(double length) {
    char text[40];
    std::snprintf(text, sizeof text, "%.3g", length);
    return text;
}

std::string remark_on(const FreeSpace& space, const assets::SceneSource& source, const Aabb& focus) {
    if (space.unit() == 1.0 || (space.unit() > 0.0 && space.unit() == source.unit)) return {};
    if (space.unit() > 0.0)
        return source.name + ": the street is " + in_digits(space.eye_height()) +
               " above the ground, as if lengths were " + (space.unit() == 0.01 ? "centimetres" : "millimetres") +
               ": houses would be too high in metres. --unit sets it";
    const double longer = std::max(focus.max.x - focus.min.x, focus.max.z - focus.min.z);
    return source.name + ": no place for a person of 1.8 m" + (source.unit > 0.0 ? "" : ", if lengths are metres") +
           ": the street is " + in_digits(space.eye_height()) + " above the ground, " +
           (space.room_height() > 0.0 ? "by its rooms' height of " + in_digits(space.room_height())
                                      : "by the scene's size of " + in_digits(longer));
}

}  // namespace

void Street::set(PathOptions& options) const {
    if (!space) return;
    options.eye_height = space->eye_height();
    options.over_floor = [this](const glm::dvec3& eye) { return space->over_floor(eye); };
}

Street street_of(const assets::SceneSource& source, const Aabb& focus) {
    // A level's waypoints do not say how to get from one to the next.
    const bool has_own = !source.walk.empty() && source.rooms.empty();
    Street street;
    if (has_own) {
        street.walk = source.walk;
        return street;
    }
    street.space = FreeSpace::find(source.scene, focus, {.unit = source.unit});
    if (street.space) {
        street.walk = street.space->walk();
        street.remark = remark_on(*street.space, source, focus);
        return street;
    }
    street.walk = source.walk;
    street.remark = source.name + ": no floor to walk on was found: the street leads " +
                    (source.walk.empty() ? "along the longer side of the scene" : "from waypoint to waypoint");
    return street;
}

}  // namespace crofton::pipeline
