// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/core/recovery.hpp>
#include <crofton/radiosity/patches.hpp>
#include <glm/geometric.hpp>
#include <numeric>
#include <string>

namespace crofton::radiosity {
namespace {

bool in_range(const glm::vec3& v, float low, float below) {
    for (int k = 0; k < 3; ++k)
        if (!(v[k] >= low && v[k] < below)) return false;
    return true;
}

glm::dvec3 area_vector(const TriangleMesh& mesh, std::size_t t) {
    const glm::dvec3 a(mesh.positions[mesh.indices[3 * t]]), b(mesh.positions[mesh.indices[3 * t + 1]]),
        c(mesh.positions[mesh.indices[3 * t + 2]]);
    return 0.5 * glm::cross(b - a, c - a);
}

Result<void> check_materials(std::span<const Material> materials) {
    for (std::size_t p = 0; p < materials.size(); ++p) {
        const std::string name = "patch " + std::to_string(p);
        if (!in_range(materials[p].emission, 0.0f, 1e30f))
            return fail(ErrorCode::out_of_range, p, {name, ": its emission is negative or not finite"});
        if (!in_range(materials[p].reflectance, 0.0f, 1.0f))
            return fail(ErrorCode::out_of_range, p,
                        {name, ": its reflectance must lie in [0, 1): with 1 or more, light would never end"});
    }
    return {};
}

}  // namespace

Result<Patches> make_patches(TriangleMesh mesh, std::span<const std::uint32_t> patch_of_triangle,
                             std::span<const Material> materials) {
    return crofton::detail::recover([&]() -> Result<Patches> {
        if (auto valid = validate(mesh); !valid) return valid.error();
        if (mesh.indices.empty()) return fail(ErrorCode::empty, kNoItem, "patches: there are no triangles");
        if (patch_of_triangle.size() != mesh.triangle_count())
            return fail(ErrorCode::invalid_argument, patch_of_triangle.size(),
                        "patches: not one patch number per triangle");
        if (auto valid = check_materials(materials); !valid) return valid.error();
        Patches patches;
        patches.areas.assign(materials.size(), 0.0);
        patches.triangle_areas.resize(patch_of_triangle.size());
        for (std::size_t t = 0; t < patch_of_triangle.size(); ++t) {
            const std::uint32_t p = patch_of_triangle[t];
            if (p >= materials.size())
                return fail(ErrorCode::out_of_range, t, {"triangle ", t, ": patch ", p, " of ", materials.size()});
            const double area = glm::length(area_vector(mesh, t));
            if (!(area > 0.0) || !std::isfinite(area))
                return fail(ErrorCode::degenerate, t, {"triangle ", t, ": has no area; leave it out"});
            patches.triangle_areas[t] = area;
            patches.areas[p] += area;
        }
        for (std::size_t p = 0; p < materials.size(); ++p)
            if (patches.areas[p] == 0.0) return fail(ErrorCode::degenerate, p, {"patch ", p, ": has no triangles"});
        patches.mesh = std::move(mesh);
        patches.patch_of_triangle.assign(patch_of_triangle.begin(), patch_of_triangle.end());
        patches.materials.assign(materials.begin(), materials.end());
        return patches;
    });
}

Result<Patches> make_patches(TriangleMesh mesh, std::span<const Material> materials) {
    return crofton::detail::recover([&]() -> Result<Patches> {
        Vector<std::uint32_t> own(mesh.triangle_count());
        std::iota(own.begin(), own.end(), 0u);
        return make_patches(std::move(mesh), own, materials);
    });
}

Vector<glm::vec3> corner_values(const Patches& patches, std::span<const glm::vec3> values,
                                std::span<const double> weights) {
    const TriangleMesh& mesh = patches.mesh;
    constexpr double kSameFace = 0.87;
    // Corners sorted by position: those at one point lie side by side.
    Vector<std::uint32_t> order(mesh.indices.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto at = [&](std::uint32_t corner) -> const glm::vec3& { return mesh.positions[mesh.indices[corner]]; };
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        const glm::vec3 &p = at(a), &q = at(b);
        if (p.x != q.x) return p.x < q.x;
        if (p.y != q.y) return p.y < q.y;
        if (p.z != q.z) return p.z < q.z;
        return a < b;
    });
    Vector<glm::vec3> result(order.size());
    Vector<glm::dvec3> normals;
    for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
        normals.clear();
        for (end = begin; end < order.size() && at(order[end]) == at(order[begin]); ++end)
            normals.push_back(glm::normalize(area_vector(mesh, order[end] / 3)));
        for (std::size_t i = begin; i < end; ++i) {
            glm::dvec3 sum(0.0);
            double weight = 0.0;
            for (std::size_t j = begin; j < end; ++j) {
                if (j != i && glm::dot(normals[i - begin], normals[j - begin]) < kSameFace) continue;
                const std::size_t t = order[j] / 3;
                const std::uint32_t patch = patches.patch_of_triangle[t];
                const double share = patches.triangle_areas[t] * (weights.empty() ? 1.0 : weights[patch]);
                sum += share * glm::dvec3(values[patch]);
                weight += share;
            }
            result[order[i]] = weight > 0.0 ? glm::vec3(sum / weight) : glm::vec3(0.0f);
        }
    }
    return result;
}

}  // namespace crofton::radiosity
