// SPDX-License-Identifier: MIT
#include "region_sets.hpp"

#include <crofton/bake/container.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <filesystem>
#include <glm/common.hpp>
#include <system_error>
#include <utility>

namespace crofton::pipeline {

std::span<const std::uint64_t> RegionSets::seen_by(const Camera& camera, const glm::dvec3& origin) const {
    const auto view = occlude::occlusion_view_of(camera);
    if (!view || !view->perspective || view->near_radius + view->eye_error > of.near_radius) return {};
    // The difference is rounded once: the eye is within this of it.
    const glm::dvec3 eye = camera.position - origin, error = 0x1p-53 * glm::abs(eye);
    const std::uint32_t cell = sets.find_cell(eye);
    // Cells are boxes. So the eye is in this one if both corners of the eye's range are.
    if (cell == pvs::kNoCell || sets.find_cell(eye - error) != cell || sets.find_cell(eye + error) != cell) return {};
    return sets.visible_from(cell, pvs::Mode::conservative);
}

std::string sets_name_of(const std::string& region_name) {
    return std::filesystem::path(region_name).replace_extension(".sets.crofton").string();
}

Result<Vector<std::byte>> to_file(const RegionSets& sets) {
    bake::Writer writer;
    writer.add("region", std::span<const RegionSetsOf>(&sets.of, 1));
    return sets.sets.to_file(writer.finish());
}

namespace {

Result<RegionSets> read_sets(std::span<const std::byte> file, const bake::RegionFile& region, std::uint64_t checksum,
                             std::uint64_t largest_file) {
    const auto reader = bake::Reader::open(file);
    if (!reader) return reader.error();
    const auto of = reader->section<RegionSetsOf>("region");
    if (!of) return of.error();
    auto sets = pvs::Pvs::from_memory(file, {.pairs = largest_file});  // a byte each
    if (!sets) return sets.error();
    if (of->size() != 1 || of->front().region != checksum || sets->object_count() != region.objects)
        return fail(ErrorCode::invalid_argument, kNoItem,
                    "is not of " + region.name + " as it is now: run 'crofton pvs' on the folder again");
    if (!sets->cells().is_grid() || !(of->front().near_radius >= 0.0))
        return fail(ErrorCode::parse, kNoItem, "its cells are no grid, or the near plane's distance is negative");
    return RegionSets{of->front(), std::move(*sets)};
}

}  // namespace

Result<std::shared_ptr<const RegionSets>> load_region_sets(const std::string& folder, const bake::RegionFile& region,
                                                           std::uint64_t checksum, std::uint64_t largest_file) {
    const std::string path = folder + "/" + sets_name_of(region.name);
    std::error_code unknown;
    if (!std::filesystem::exists(path, unknown)) return std::shared_ptr<const RegionSets>();
    const auto file = bake::MappedFile::open(path, {.access = bake::FileAccess::read, .largest = largest_file});
    if (!file) return file.error();
    auto sets = read_sets(file->bytes(), region, checksum, largest_file);
    if (!sets) return fail(sets.error().code, sets.error().item, path + ": " + sets.error().message);
    return std::make_shared<const RegionSets>(std::move(*sets));
}

}  // namespace crofton::pipeline
