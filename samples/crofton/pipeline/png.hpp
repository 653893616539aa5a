// SPDX-License-Identifier: MIT
// A drawn picture as the bytes of a PNG file.
#pragma once
#include <crofton/render/rasterizer.hpp>
#include <string>

namespace crofton::pipeline {

// Empty if it could not be encoded (no pixels).
[[nodiscard]] std::string encode_png(const render::Image& image);

}  // namespace crofton::pipeline
