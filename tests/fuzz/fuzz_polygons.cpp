// SPDX-License-Identifier: MIT
// Polygon files of every format, and what triangulating them leads to: the first byte says which format and method.
#include <commands/polygon_files.hpp>
#include <crofton/triangulate/triangulate.hpp>
#include <cstdlib>

#include "input_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace crofton;
    static constexpr const char* kExtensions[] = {"poly", "json", "geojson", "wad"};
    if (size == 0) return 0;
    const std::string path = fuzz::input_file(kExtensions[data[0] % 4], data + 1, size - 1);
    const auto file = cli::read_polygons(path, "");
    if (!file) {
        if (file.error().message.find(path) == std::string::npos) std::abort();
        return 0;
    }
    triangulate::TriangulateOptions options;
    options.method = static_cast<triangulate::Method>(data[0] / 4 % 3);
    options.work = 5'000'000;
    for (const auto& named : file->polygons) {
        const auto result = triangulate::triangulate(named.polygon, options);
        if (!result) continue;
        for (const auto& triangle : result->triangles)
            for (const std::uint32_t corner : triangle)
                if (corner >= named.polygon.points.size()) std::abort();
    }
    return 0;
}
