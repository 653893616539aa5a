// SPDX-License-Identifier: MIT
// Camera paths, as `crofton frames --camera` reads them.
#include <cstdlib>
#include <pipeline/camera_path.hpp>

#include "input_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string path = crofton::fuzz::input_file("json", data, size);
    const auto cameras = crofton::pipeline::load_camera_path(path);
    if (!cameras && cameras.error().message.find(path) == std::string::npos) std::abort();
    return 0;
}
