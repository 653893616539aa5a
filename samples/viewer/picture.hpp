// Pictures and texts into files, whole or not at all.
#pragma once
#include <crofton/render/rasterizer.hpp>
#include <string>

namespace crofton::viewer {

// Errors name the file and the system's reason.
[[nodiscard]] Result<void> write_png(const std::string& path, const render::Image& image);
[[nodiscard]] Result<void> write_text(const std::string& path, const std::string& text);

}  // namespace crofton::viewer
