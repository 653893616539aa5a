// SPDX-License-Identifier: MIT
// Finds flat parts of the surface: triangles that share sides, face the same way and lie near one plane.
#include <algorithm>
#include <glm/geometric.hpp>

#include "finding/candidates.hpp"

namespace crofton::occlude {
namespace {

constexpr std::size_t kMostPatches = 64;
constexpr double kLeastCosine = 0.9;  // between the normals of two triangles of a patch

struct Patch {
    Vector<std::uint32_t> triangles;
    double area = 0.0;
};

class PatchFinder {
  public:
    explicit PatchFinder(const Search& search)
        : search_(search),
          normals_(search.mesh.triangles.size()),
          patch_of_(search.mesh.triangles.size(), kNoNeighbor) {
        for (std::uint32_t t = 0; t < normals_.size(); ++t) {
            const Triangle p = search.mesh.corners(t);
            normals_[t] = glm::cross(p[1] - p[0], p[2] - p[0]);
        }
    }

    [[nodiscard]] Vector<Patch> find();
    [[nodiscard]] std::uint32_t boundary_of(const Patch& patch) const;

  private:
    [[nodiscard]] Patch grow(std::uint32_t seed, std::uint32_t number);

    const Search& search_;
    Vector<glm::dvec3> normals_;  // of twice the area's length
    Vector<std::uint32_t> patch_of_;
};

Patch PatchFinder::grow(std::uint32_t seed, std::uint32_t number) {
    const PieceMesh& mesh = search_.mesh;
    const glm::dvec3 normal = glm::normalize(normals_[seed]), origin(mesh.positions[mesh.triangles[seed][0]]);
    const double tolerance = search_.options.flatness * search_.size;
    const auto belongs = [&](std::uint32_t t) {
        const double length = glm::length(normals_[t]);
        if (!(length > 0.0) || glm::dot(normals_[t], normal) < kLeastCosine * length) return false;
        return std::all_of(mesh.triangles[t].begin(), mesh.triangles[t].end(), [&](std::uint32_t v) {
            return std::abs(glm::dot(normal, glm::dvec3(mesh.positions[v]) - origin)) <= tolerance;
        });
    };
    Patch patch{{seed}, 0.0};
    patch_of_[seed] = number;
    for (std::size_t i = 0; i < patch.triangles.size(); ++i) {
        patch.area += 0.5 * glm::dot(normals_[patch.triangles[i]], normal);
        for (const std::uint32_t t : mesh.neighbors[patch.triangles[i]]) {
            if (t == kNoNeighbor || patch_of_[t] != kNoNeighbor || !belongs(t)) continue;
            patch_of_[t] = number;
            patch.triangles.push_back(t);
        }
    }
    return patch;
}

Vector<Patch> PatchFinder::find() {
    Vector<std::uint32_t> seeds;
    Vector<double> size(normals_.size());
    for (std::uint32_t t = 0; t < normals_.size(); ++t) {
        size[t] = glm::dot(normals_[t], normals_[t]);
        if (size[t] > 0.0) seeds.push_back(t);
    }
    std::sort(seeds.begin(), seeds.end(),
              [&](std::uint32_t a, std::uint32_t b) { return size[a] != size[b] ? size[a] > size[b] : a < b; });
    const double least = search_.least_shadow * (search_.options.sides == Sides::front ? 4.0 : 2.0);
    Vector<Patch> patches;
    std::uint32_t number = 0;
    for (const std::uint32_t seed : seeds) {
        if (patch_of_[seed] != kNoNeighbor) continue;
        Patch patch = grow(seed, number++);
        if (patch.area >= least && patch.triangles.size() <= search_.options.max_patch_triangles)
            patches.push_back(std::move(patch));
    }
    std::stable_sort(patches.begin(), patches.end(), [](const Patch& a, const Patch& b) { return a.area > b.area; });
    if (patches.size() > kMostPatches) patches.resize(kMostPatches);
    return patches;
}

std::uint32_t PatchFinder::boundary_of(const Patch& patch) const {
    std::uint32_t edges = 0;
    for (const std::uint32_t t : patch.triangles)
        for (const std::uint32_t n : search_.mesh.neighbors[t])
            edges += n == kNoNeighbor || patch_of_[n] != patch_of_[t] ? 1 : 0;
    return edges;
}

}  // namespace

void add_patches(const Search& search, Vector<FoundOccluder>& found) {
    PatchFinder finder(search);
    for (Patch& patch : finder.find()) {
        FoundOccluder occluder;
        occluder.kind = OccluderKind::patch;
        occluder.sides = search.options.sides;
        occluder.mean_shadow = patch.area * (search.options.sides == Sides::front ? 0.25 : 0.5);
        occluder.edges = finder.boundary_of(patch);
        std::sort(patch.triangles.begin(), patch.triangles.end());
        occluder.surface = part_of(search.mesh, patch.triangles);
        found.push_back(std::move(occluder));
    }
}

}  // namespace crofton::occlude
