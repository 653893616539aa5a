// SPDX-License-Identifier: MIT
// Writes the built-in town for the page: bindings/web/page/make_town.py compiles and runs it, bindings/web/page/town.js
// reads the bytes. Positions are rounded to a power of two of a metre, 1/256 for all but the ground.
#include <assets/scene_source.hpp>
#include <assets/town_blocks.hpp>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

namespace {

template <class T>
void write(std::vector<T> values) {
    std::fwrite(values.data(), sizeof(T), values.size(), stdout);
}

}  // namespace

int main() {
    auto source = crofton::assets::load_scene("town");
    if (!source) return std::fprintf(stderr, "%s\n", source.error().message.c_str()), 1;
    const crofton::scene::Scene& scene = source->scene;
    (void)source->scene.update();
    std::vector<std::uint32_t> heads;           // of each mesh: vertices, triangles
    std::vector<float> steps;                   // of each mesh
    std::vector<std::int16_t> places, corners;  // in steps, vertices and indices; each minus the one before
    std::vector<std::uint8_t> colors;           // red, green, blue of each vertex
    for (crofton::scene::MeshId m = 0; m < scene.mesh_count(); ++m) {
        const crofton::TriangleMesh& mesh = scene.mesh(m);
        float largest = 0.0f;
        for (const glm::vec3& p : mesh.positions)
            for (int k = 0; k < 3; ++k) largest = std::fmax(largest, std::fabs(p[k]));
        float step = 1.0f / 256.0f;
        while (largest > 32767.0f * step) step *= 2.0f;
        heads.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
        heads.push_back(static_cast<std::uint32_t>(mesh.triangle_count()));
        steps.push_back(step);
        for (std::size_t v = 0; v < mesh.positions.size(); ++v)
            for (int k = 0; k < 3; ++k) {
                const auto rounded = [&](std::size_t i) { return std::lround(mesh.positions[i][k] / step); };
                places.push_back(static_cast<std::int16_t>(rounded(v) - (v > 0 ? rounded(v - 1) : 0)));
                const float color = mesh.colors.empty() ? 0.6f : mesh.colors[v][k];
                colors.push_back(static_cast<std::uint8_t>(std::lround(255.0f * std::sqrt(color))));
            }
        std::uint32_t last = 0;
        for (const std::uint32_t corner : mesh.indices) {
            corners.push_back(static_cast<std::int16_t>(corner - last));
            last = corner;
        }
    }
    std::vector<std::uint16_t> meshes;
    std::vector<float> transforms, flight;  // by columns, three of four numbers each
    for (crofton::scene::InstanceId i = 0; i < scene.instance_count(); ++i) {
        const crofton::Transform& world = scene.world(scene.node_of(i));
        meshes.push_back(static_cast<std::uint16_t>(scene.mesh_of(i)));
        for (int c = 0; c < 4; ++c)
            for (int k = 0; k < 3; ++k)
                transforms.push_back(static_cast<float>(c < 3 ? world.linear[c][k] : world.translation[k]));
    }
    // The walk follows the pavement. Move it to the middle of the street for the flight.
    const std::vector<glm::dvec3>& corners_of_walk = source->walk;
    const std::size_t count = corners_of_walk.size();
    const double aside = 0.5 * (crofton::assets::town::kCarriageway + crofton::assets::town::kSidewalk);
    for (std::size_t i = 0; i < count; ++i) {
        const glm::dvec3 here = corners_of_walk[i];
        const auto away = [&](std::size_t other) { return glm::normalize(here - corners_of_walk[other % count]); };
        const glm::dvec3 p = here + aside * (away(i + 1) + away(i + count - 1));
        for (int k = 0; k < 3; ++k) flight.push_back(static_cast<float>(p[k]));
    }
    const auto number = [](std::size_t n) { return static_cast<std::uint32_t>(n); };
    write<std::uint32_t>({number(scene.mesh_count()), number(meshes.size()), number(count)});
    write(heads), write(steps), write(transforms), write(flight);
    write(meshes), write(places), write(corners), write(colors);
}
