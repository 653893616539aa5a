// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <assets/gltf_color.hpp>
#include <assets/scene_source.hpp>
#include <string>
#include <string_view>

#include "gltf_asset.hpp"

using namespace crofton;

namespace {

// A binary PPM of grey texels, each 0 (black) or 1 (white).
std::string picture(std::string_view width, std::string_view height, std::string_view texels) {
    std::string ppm = "P6 " + std::string(width) + ' ' + std::string(height) + " 255\n";
    for (const char texel : texels) ppm.append(3, texel == '1' ? '\xff' : '\0');
    return ppm;
}

}  // namespace

TEST_SUITE("assets/gltf_color") {
    TEST_CASE("a texture's averages leave no row or column out") {
        constexpr float kAll = 1e6f;  // texture widths
        assets::TexturePyramid row, column, sheet;
        REQUIRE(row.decode(picture("3", "1", "001"), {}));
        CHECK(row.sample({0.5f, 0.5f}, kAll).x == doctest::Approx(1.0 / 3.0));
        REQUIRE(column.decode(picture("1", "3", "001"), {}));
        CHECK(column.sample({0.5f, 0.5f}, kAll).x == doctest::Approx(1.0 / 3.0));
        // Its columns become one of 2 and one of 3: means of 0 and 1/2.
        REQUIRE(sheet.decode(picture("5", "2", "0000100011"), {}));
        CHECK(sheet.sample({0.5f, 0.5f}, kAll).x == doctest::Approx(0.25));
    }

    TEST_CASE("the last column of a large picture counts") {
        std::string texels(2049, '0');
        texels.back() = '1';
        assets::TexturePyramid row;
        REQUIRE(row.decode(picture("2049", "1", texels), {}));
        CHECK(row.texels() == 1024);
        CHECK(row.sample({0.9999f, 0.5f}, 0.0f).x == doctest::Approx(1.0 / 3.0));
    }

    TEST_CASE("vertex colours without a material are the mesh's colours, not tinted by its name") {
        test_files::Asset asset;
        const std::size_t positions = asset.accessor(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
        const std::size_t indices = asset.accessor(std::vector<std::uint16_t>{0, 1, 2}, "SCALAR");
        const std::size_t colors =
            asset.accessor(std::vector<std::uint8_t>{255, 0, 0, 255, 0, 255, 0, 255, 255, 255, 255, 255}, "VEC4", true);
        asset.mesh(positions, indices)["attributes"]["COLOR_0"] = colors;
        asset.root["meshes"][0]["name"] = "wall";
        const test_files::TemporaryFile file("colors.glb", asset.glb());
        const auto scene = assets::load_scene(file.path()).value();
        const auto& read = scene.scene.mesh(0).colors;
        REQUIRE(read.size() == 3);
        CHECK(read[0] == glm::vec3(1.0f, 0.0f, 0.0f));
        CHECK(read[1] == glm::vec3(0.0f, 1.0f, 0.0f));
        CHECK(read[2] == glm::vec3(1.0f));
    }
}
