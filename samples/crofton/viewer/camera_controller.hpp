// SPDX-License-Identifier: MIT
// The camera in the user's hand: flying freely, or circling a point.
#pragma once
#include <array>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <optional>
#include <string>

#include "window.hpp"

namespace crofton::viewer {

enum class CameraMode : std::uint8_t { fly, orbit };

class CameraController {
  public:
    // Looks at `focus` from a corner above, as far as `extent` reaches; takes the speed from the focus.
    void frame_all(const Aabb& focus, const Aabb& extent);
    // Stands at `place` and looks towards `next`, horizontally; takes a walker's speed from the eye's height.
    void stand(const glm::dvec3& place, const glm::dvec3& next, double eye_height);
    void look(const Camera& camera);

    // Mouse and held keys. `scale` is pixels to radians.
    void handle(const Event& event);
    // Moves by the keys held (W A S D, Q and E for down and up, Shift for four times the speed).
    void advance(double seconds);

    void store_bookmark(int slot) { bookmarks_[static_cast<std::size_t>(slot)] = camera; }
    bool recall_bookmark(int slot);

    // How fast `advance` flies, in metres a second.
    double speed = 10.0;
    CameraMode mode = CameraMode::fly;
    Camera camera;

  private:
    void turn(double yaw, double pitch);
    [[nodiscard]] bool held(const char* key) const;

    glm::dvec3 target_{0.0};
    double distance_ = 10.0;
    glm::dvec2 cursor_{0.0};
    bool turning_ = false;
    std::vector<std::string> keys_;
    std::array<std::optional<Camera>, 10> bookmarks_;
};

}  // namespace crofton::viewer
