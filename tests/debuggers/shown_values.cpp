// SPDX-License-Identifier: MIT
// A value of each type that debuggers are taught to show; check_shown.py stops in stop_here() and looks.
#include <crofton/cull/cull.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/world/world.hpp>

using namespace crofton;

namespace {

int stops = 0;
[[gnu::noinline]] void stop_here() {
    ++stops;
}

}  // namespace

int main() {
    [[maybe_unused]] const Obb box{{1.0, 2.0, 3.0}, glm::mat3(1.0f), {0.5f, 0.25f, 4.0f}};
    [[maybe_unused]] const Aabb bounds{{-1.0, -2.0, -3.0}, {1.0, 2.0, 3.5}};
    [[maybe_unused]] const Aabb empty;
    [[maybe_unused]] const Sphere sphere{{0.0, 1.0, -5.0}, 1.5};
    [[maybe_unused]] const Plane plane{{0.0, 0.0, 1.0}, -2.0};
    [[maybe_unused]] const IdPair pair{3, 7};
    [[maybe_unused]] const Error error(ErrorCode::non_finite, 5, "a corner is NaN");
    [[maybe_unused]] const Error lone(ErrorCode::io, kNoItem, "no such file");
    Camera camera;
    camera.position = {7.0, 8.0, 9.0};
    [[maybe_unused]] const Frustum frustum = frustum_of(camera).value();
    [[maybe_unused]] const Result<int> number = 42;
    [[maybe_unused]] const Result<int> no_number = error;
    [[maybe_unused]] const Result<void> success;
    [[maybe_unused]] const Result<void> failure = error;
    [[maybe_unused]] const ObjectHandle null;
    World world;
    [[maybe_unused]] const ObjectHandle first = world.add({.bound = Sphere{{0.0, 0.0, -5.0}, 1.0}}).value();
    [[maybe_unused]] cull::VisibleSet visible;
    stop_here();
    return stops == 1 ? 0 : 1;
}
