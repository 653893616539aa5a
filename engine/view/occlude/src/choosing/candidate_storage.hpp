// SPDX-License-Identifier: MIT
// The data of OccluderCandidates: pages that do not move, so that no add() takes long.
#pragma once
#include <array>
#include <crofton/core/memory.hpp>
#include <crofton/core/paged_vector.hpp>
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
    std::array<glm::vec3, kSize> half_sizes{};
    // Of the eye's limits, most of which have no planes.
    std::array<Aabb, kSize> left_out_within{};
    static constexpr std::uint32_t kNoPlanes = ~0u;
    std::array<std::uint32_t, kSize> limits;  // their place in Data::limits_with_planes

    CandidatePage() { limits.fill(kNoPlanes); }
};

struct OccluderCandidates::Data {
    glm::dvec3 origin{0.0};  // the first candidate's center
    std::size_t count = 0;
    Vector<Owner<CandidatePage>> pages;
    struct LimitsWithPlanes {
        EyeLimits limits;
        std::uint32_t next_free = CandidatePage::kNoPlanes;
    };
    PagedVector<LimitsWithPlanes, 64> limits_with_planes;
    std::uint32_t first_free = CandidatePage::kNoPlanes;

    void write(std::size_t id, const OccluderCandidate& candidate);
    void set_limits(std::uint32_t& place, const EyeLimits& limits);
};

struct CandidateStorage {
    [[nodiscard]] static const glm::dvec3& origin(const OccluderCandidates& candidates) {
        return candidates.data_->origin;
    }
    [[nodiscard]] static std::span<const Owner<CandidatePage>> pages(const OccluderCandidates& candidates) {
        return candidates.data_->pages;
    }
    // nullptr: it has no planes.
    [[nodiscard]] static const EyeLimits* limits_with_planes(const OccluderCandidates& candidates,
                                                             std::uint32_t place) {
        return place == CandidatePage::kNoPlanes ? nullptr : &candidates.data_->limits_with_planes[place].limits;
    }
};

}  // namespace crofton::occlude
