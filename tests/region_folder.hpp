// SPDX-License-Identifier: MIT
// A scene as a folder of regions that is gone after the test.
#pragma once
#include <doctest/doctest.h>
#include <crofton/bake/region_files.hpp>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

namespace crofton::testing {

struct RegionFolder {
    std::string path = (std::filesystem::temp_directory_path() / "crofton-flight-XXXXXX").string();

    RegionFolder(const scene::Scene& scene, std::uint32_t columns, std::uint32_t rows) {
        REQUIRE(mkdtemp(path.data()) != nullptr);
        const auto regions = bake::SceneRegions::split(scene, columns, rows).value();
        std::vector<bake::RegionFile> index;
        for (std::size_t i = 0; i < regions.size(); ++i) {
            const auto file = regions.bake(i).value();
            index.push_back(regions.region(i));
            index.back().bytes = file.size();
            REQUIRE(bake::write_file(path + "/" + index.back().name, file));
        }
        REQUIRE(bake::write_file(path + "/" + bake::kRegionIndexName, bake::bake_region_index(index).value()));
    }
    ~RegionFolder() { std::filesystem::remove_all(path); }
    RegionFolder(const RegionFolder&) = delete;
    RegionFolder& operator=(const RegionFolder&) = delete;
};

}  // namespace crofton::testing
