// SPDX-License-Identifier: MIT
// A town of boxes that hide, and of boxes that are asked for; and what of it is seen, by rays.
#pragma once
#include <cmath>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <crofton/sampling/sampling.hpp>
#include <vector>

namespace crofton::bench {

struct OcclusionTown {
    std::vector<Obb> houses, objects;
    std::vector<Camera> cameras;
};

inline Obb upright_box(const glm::dvec3& center, double angle, double x, double y, double z) {
    Obb box;
    box.center = center;
    const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
    box.axes = glm::mat3(c, 0.0f, -s, 0.0f, 1.0f, 0.0f, s, 0.0f, c);
    box.half_extents = {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
    return box;
}

// Houses of 8 to 24 m by 6 to 30 m on plots of 24 m, in no order; objects of 0.3 to 3 m among them and upon them; eyes
// at the height of the lower roofs. `house_size` scales the houses alone: of small ones much more is seen.
inline OcclusionTown occlusion_town(std::uint64_t seed, std::size_t houses, std::size_t objects, double eye_height,
                                    double house_size = 1.0) {
    sampling::Random random(seed);
    OcclusionTown town;
    const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(houses))));
    const double extent = 12.0 * static_cast<double>(side);
    for (std::size_t i = 0; i < houses; ++i) {
        const double height = house_size * (3.0 + 12.0 * random.uniform() * random.uniform());
        const double x = 24.0 * (static_cast<double>(i % side) + 0.5) - extent + random.uniform(-3.0, 3.0);
        const double z = 24.0 * (static_cast<double>(i / side) + 0.5) - extent + random.uniform(-3.0, 3.0);
        const double a = house_size * random.uniform(4.0, 12.0), b = house_size * random.uniform(4.0, 12.0);
        const double turn = random.uniform(-0.3, 0.3);
        town.houses.push_back(upright_box({x, height, z}, turn, a, height, b));
    }
    for (std::size_t i = 0; i < objects; ++i) {
        const double size = 0.15 * std::pow(10.0, random.uniform()), turn = random.uniform(0.0, 6.28);
        const double x = random.uniform(-extent, extent), y = 12.0 * random.uniform() * random.uniform() + size;
        const double z = random.uniform(-extent, extent);
        const double a = size * random.uniform(0.5, 1.0), b = size * random.uniform(0.5, 1.0);
        town.objects.push_back(upright_box({x, y, z}, turn, a, size, b));
    }
    for (int view = 0; view < 4; ++view) {
        Camera camera;
        const double turn = 1.5707963 * view + random.uniform(-0.4, 0.4);
        camera.position = {1.05 * extent * std::cos(turn), eye_height, 1.05 * extent * std::sin(turn)};
        camera.forward = {-std::cos(turn), -0.02 * eye_height / 10.0, -std::sin(turn)};
        camera.fov_y = 1.0;
        camera.far_distance = 10.0 * extent;
        town.cameras.push_back(camera);
    }
    return town;
}

}  // namespace crofton::bench
