// SPDX-License-Identifier: MIT
#include "pixels.hpp"

#include <doctest/doctest.h>

#define STBI_ONLY_PNG
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace crofton::test {

Pixels::Pixels(const std::string& file) {
    int channels = 0;
    unsigned char* data = stbi_load(file.c_str(), &width, &height, &channels, 4);
    REQUIRE_MESSAGE(data != nullptr, file);
    rgba.assign(data, data + 4 * width * height);
    stbi_image_free(data);
}

}  // namespace crofton::test
