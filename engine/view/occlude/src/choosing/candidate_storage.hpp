// SPDX-License-Identifier: MIT
// The data of OccluderCandidates: pages that do not move, so that no add() takes long.
#pragma once
#include <array>
#include <crofton/core/memory.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <span>

namespace crofton::occlude {

struct CandidatePage {
    static constexpr std::size_t kSize = 256;  // a multiple of the lanes of a vector
    static constexpr std::size_t kColumns = 14;
    // Coordinates relative to the origin, rounded to float, by component: center, radius, nine of the areas, then 1 or
    // 0 for front_only.
    std::array<std::array<float, kSize>, kColumns> columns{};
    std::array<std::uint32_t, kSize> edges{}, layers{};
    std::array<EyeLimits, kSize> limits{};
    std::array<glm::vec3, kSize> half_sizes{};
};

struct OccluderCandidates::Data {
    glm::dvec3 origin{0.0};  // the first candidate's center
    std::size_t count = 0;
    Vector<Owner<CandidatePage>> pages;
};

struct CandidateStorage {
    [[nodiscard]] static const glm::dvec3& origin(const OccluderCandidates& candidates) {
        return candidates.data_->origin;
    }
    [[nodiscard]] static std::span<const Owner<CandidatePage>> pages(const OccluderCandidates& candidates) {
        return candidates.data_->pages;
    }
};

}  // namespace crofton::occlude
