// SPDX-License-Identifier: MIT
// A bake of visible sets and one of light, whose stored states a fuzzer forges.
#pragma once
#include <crofton/geometry/box.hpp>
#include <crofton/pvs/pvs.hpp>
#include <crofton/radiosity/patches.hpp>
#include <crofton/radiosity/solver.hpp>
#include <cstdint>

namespace crofton::fuzz {

// A wall between two quads, each an object; eyes are around it.
inline pvs::BakeGeometry small_geometry() {
    pvs::BakeGeometry geometry;
    for (std::uint32_t o = 0; o < 3; ++o) {
        const float x = 2.0f * static_cast<float>(o) - 2.0f;
        const std::uint32_t first = 4 * o;
        for (const auto& [y, z] : {std::pair(0.0f, 0.0f), {2.0f, 0.0f}, {2.0f, 2.0f}, {0.0f, 2.0f}})
            geometry.mesh.positions.emplace_back(x, y, z);
        for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) geometry.mesh.indices.push_back(first + i);
        geometry.object_of.insert(geometry.object_of.end(), 2, o);
        Obb box;
        box.center = {static_cast<double>(x), 1.0, 1.0};
        box.half_extents = {0.125f, 1.0f, 1.0f};
        geometry.boxes.push_back(box);
    }
    return geometry;
}

inline pvs::Bake small_bake() {
    const Aabb eyes{{-4.0, 0.0, 0.0}, {4.0, 2.0, 2.0}};
    const pvs::BakeOptions options{.epsilon = 0.1, .confidence = 0.5};
    return pvs::Bake::create(small_geometry(), pvs::Cells::grid(eyes, {4, 1, 1}).value(), options).value();
}

// The quads again, one of which glows.
inline const radiosity::Patches& small_patches() {
    static const radiosity::Patches patches = [] {
        const pvs::BakeGeometry geometry = small_geometry();
        const radiosity::Material glows{glm::vec3(1.0f), glm::vec3(0.5f)}, dark{glm::vec3(0.0f), glm::vec3(0.5f)};
        const std::uint32_t patch_of[] = {0, 0, 1, 1, 2, 2};
        return radiosity::make_patches(geometry.mesh, patch_of, std::array{glows, dark, dark}).value();
    }();
    return patches;
}
inline radiosity::SolverOptions small_options() {
    radiosity::SolverOptions options;
    options.lines = 1 << 6;
    options.first_shot = 1 << 6;
    return options;
}
inline constexpr std::uint64_t kSmallRuns = 24;  // three chains

}  // namespace crofton::fuzz
