// SPDX-License-Identifier: MIT
#include "camera_controller.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "pipeline/free_space.hpp"

namespace crofton::viewer {
namespace {

constexpr double kRadiansPerPixel = 0.004;
constexpr double kWalkingSpeed = 1.4;  // metres a second, of a person
constexpr glm::dvec3 kUp{0.0, 1.0, 0.0};

glm::dvec3 direction(double yaw, double pitch) {
    return {std::cos(pitch) * std::sin(yaw), std::sin(pitch), -std::cos(pitch) * std::cos(yaw)};
}

// From how far before the box's centre, looking at it, all of its corners are just in view.
double distance_for_all(const Camera& camera, const Aabb& box) {
    const glm::dmat3 to_view = world_to_view_rotation(camera);
    const glm::dvec3 half = box.half_extents();
    const double tangent_y = std::tan(0.5 * camera.fov_y), tangent_x = tangent_y * camera.aspect;
    double distance = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 p =
            to_view * glm::dvec3((corner & 1) != 0 ? half.x : -half.x, (corner & 2) != 0 ? half.y : -half.y,
                                 (corner & 4) != 0 ? half.z : -half.z);
        distance = std::max({distance, p.z + std::fabs(p.x) / tangent_x, p.z + std::fabs(p.y) / tangent_y});
    }
    return distance;
}

}  // namespace

void CameraController::look(const Camera& view) {
    const double aspect = camera.aspect;
    camera = view;
    camera.aspect = aspect;
    target_ = camera.position + glm::normalize(camera.forward) * distance_;
}

void CameraController::frame_all(const Aabb& focus, const Aabb& extent) {
    if (focus.is_empty()) return;
    const double radius = std::max(glm::length(focus.half_extents()), 1e-3);
    target_ = focus.center();
    camera.forward = glm::normalize(glm::dvec3(-0.6, -0.45, -0.6));
    camera.up = kUp;
    distance_ = 1.04 * distance_for_all(camera, focus);
    camera.position = target_ - camera.forward * distance_;
    camera.near_distance = std::max(radius * 5e-4, 0.02);
    camera.far_distance = 2.0 * (glm::length(extent.half_extents()) + distance_);
    speed = radius / 6.0;
}

void CameraController::stand(const glm::dvec3& place, const glm::dvec3& next, double eye_height) {
    const glm::dvec3 along(next.x - place.x, 0.0, next.z - place.z);
    if (!(glm::length(along) > 0.0)) return;
    camera.position = place;
    camera.forward = glm::normalize(along);
    camera.up = kUp;
    target_ = place + camera.forward * distance_;
    speed = kWalkingSpeed * eye_height / pipeline::FreeSpace::kPersonEye;
}

bool CameraController::recall_bookmark(int slot) {
    const auto& stored = bookmarks_[static_cast<std::size_t>(slot)];
    if (stored) look(*stored);
    return stored.has_value();
}

bool CameraController::held(const char* key) const {
    return std::find(keys_.begin(), keys_.end(), key) != keys_.end();
}

void CameraController::turn(double yaw_change, double pitch_change) {
    const glm::dvec3 forward = glm::normalize(camera.forward);
    const double yaw = std::atan2(forward.x, -forward.z) + yaw_change;
    const double limit = 0.5 * std::numbers::pi - 0.01;
    const double pitch = std::clamp(std::asin(std::clamp(forward.y, -1.0, 1.0)) + pitch_change, -limit, limit);
    camera.forward = direction(yaw, pitch);
    camera.up = kUp;
    if (mode == CameraMode::orbit) camera.position = target_ - camera.forward * distance_;
}

void CameraController::handle(const Event& event) {
    switch (event.kind) {
        case Event::Kind::key_down:
            if (!held(event.text.c_str())) keys_.push_back(event.text);
            break;
        case Event::Kind::key_up:
            keys_.erase(std::remove(keys_.begin(), keys_.end(), event.text), keys_.end());
            break;
        case Event::Kind::button_down:
        case Event::Kind::button_up:
            if (event.button == 1) turning_ = event.kind == Event::Kind::button_down;
            cursor_ = event.at;
            break;
        case Event::Kind::cursor: {
            const glm::dvec2 change = event.at - cursor_;
            cursor_ = event.at;
            const double sign = mode == CameraMode::orbit ? -1.0 : 1.0;
            if (turning_) turn(sign * change.x * kRadiansPerPixel, -change.y * kRadiansPerPixel);
            break;
        }
        case Event::Kind::scroll:
            if (mode == CameraMode::fly) {
                speed = std::clamp(speed * std::pow(1.25, event.at.y), 1e-3, 1e6);
            } else {
                distance_ = std::clamp(distance_ * std::pow(0.87, event.at.y), 1e-3, 1e9);
                camera.position = target_ - glm::normalize(camera.forward) * distance_;
            }
            break;
        case Event::Kind::drop:
        case Event::Kind::scale:
            break;
    }
}

void CameraController::advance(double seconds) {
    const glm::dvec3 forward = glm::normalize(camera.forward);
    const glm::dvec3 right = glm::normalize(glm::cross(forward, camera.up));
    glm::dvec3 step(0.0);
    if (held("W")) step += forward;
    if (held("S")) step -= forward;
    if (held("D")) step += right;
    if (held("A")) step -= right;
    if (held("E")) step += kUp;
    if (held("Q")) step -= kUp;
    step *= speed * (held("Shift") ? 4.0 : 1.0) * seconds;
    camera.position += step;
    target_ += step;
}

}  // namespace crofton::viewer
