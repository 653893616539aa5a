// SPDX-License-Identifier: MIT
// Where the camera is in each frame: built-in paths around any scene, or one recorded in a file.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/scene/scene.hpp>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "assets/read_limits.hpp"
#include "json/json.hpp"

namespace crofton::pipeline {

// The part of the scene worth looking at: the middle nine tenths of its triangles along each axis, by their instances'
// boxes, without those that are hidden. A few far backdrops (hills, a sky dome) do not send the camera away. Empty for
// an empty scene.
[[nodiscard]] Aabb focus_of(const scene::Scene& scene);

struct PathOptions {
    std::string kind = "orbit";  // orbit, street, flight, random, or the path of a JSON file
    std::uint32_t frames = 0;    // 0: as many as the file has; kBuiltInFrames of the others
    std::uint64_t seed = 1;
    double aspect = 16.0 / 9.0;
    assets::ReadLimits limits = {};  // of the file
    // For `street`: moves an eye to its height above the floor that is below it (FreeSpace::over_floor); may be empty.
    std::function<glm::dvec3(const glm::dvec3&)> over_floor = {};
    double eye_height = 0.0;  // for `street`: the near plane is nearer than that. 0: unknown
};
inline constexpr std::uint32_t kBuiltInFrames = 120;

// A camera for each frame, and what the scene shows then: its movers stand as they do in scene_frames[i].
struct CameraPath {
    std::vector<Camera> cameras;
    std::vector<std::uint32_t> scene_frames;
};

// `bounds` frames the scene (y up); `walk` is where a pedestrian may go, for `street`, and may be empty: then the path
// leads along the longer side of the bounds, low above the ground. At a walk of one place the camera turns around. A
// recording shorter than `frames` starts over, and the scene with it. Errors: an unknown kind, an unreadable or invalid
// file, empty bounds.
[[nodiscard]] Result<CameraPath> make_camera_path(const PathOptions& options, const Aabb& bounds,
                                                  std::span<const glm::dvec3> walk);

// {position, forward, up, fov_y, aspect, near, far}; far is the string "infinity" where it is infinite. Orthographic
// cameras have a height, others have none.
[[nodiscard]] Json to_json(const Camera& camera);
// Fields that are absent keep Camera's defaults. Errors: wrong types, invalid values (validate(Camera)), the entry's
// number as item.
[[nodiscard]] Result<Camera> camera_from_json(const Json& entry, std::uint64_t item);

// A recorded path: an array of cameras, {"cameras": […]}, or the output of `crofton frames --json`. An entry may have
// "scene_frame"; where it has none, it shows the scene frame of its own number.
[[nodiscard]] Result<CameraPath> load_camera_path(const std::string& path, const assets::ReadLimits& limits = {});

}  // namespace crofton::pipeline
