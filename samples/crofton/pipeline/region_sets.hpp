// SPDX-License-Identifier: MIT
// Visible sets of a region: which of its own objects the region itself hides from the cells around it.
#pragma once
#include <crofton/bake/region_files.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/pvs/pvs.hpp>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace crofton::pipeline {

// What a file of sets is of.
struct RegionSetsOf {
    std::uint64_t region = 0;  // checksum of the region's file
    std::uint64_t how = 0;     // of the options of the bake
    double near_radius = 0.0;  // that the proofs were told
    friend bool operator==(const RegionSetsOf&, const RegionSetsOf&) = default;
};

// Proofs use the region's occluders alone, so they hold beside any other region.
struct RegionSets {
    RegionSetsOf of;
    pvs::Pvs sets;  // of the region's objects, relative to its origin

    // A bit set of the objects that may be seen: all that are not proved hidden. Empty: all objects, because the eye is
    // in no cell or within a rounding of a cell's side, the view is parallel, or its near plane reaches too far.
    [[nodiscard]] std::span<const std::uint64_t> seen_by(const Camera& camera, const glm::dvec3& origin) const;
};

// "r2_3.crofton" → "r2_3.sets.crofton", in the same folder.
[[nodiscard]] std::string sets_name_of(const std::string& region_name);
[[nodiscard]] Result<Vector<std::byte>> to_file(const RegionSets& sets);
// Reads the sets of a region whose file has this checksum. nullptr: there are none. Errors name the file: it cannot be
// read, is damaged, or is of another region, or of one that was baked anew since.
[[nodiscard]] Result<std::shared_ptr<const RegionSets>> load_region_sets(const std::string& folder,
                                                                         const bake::RegionFile& region,
                                                                         std::uint64_t checksum,
                                                                         std::uint64_t largest_file);

}  // namespace crofton::pipeline
