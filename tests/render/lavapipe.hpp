// SPDX-License-Identifier: MIT
// A validated software device for the tests; those that need one skip where there is none.
#pragma once
#include <doctest/doctest.h>

#include <crofton/render/rasterizer.hpp>
#include <optional>
#include <string>

namespace crofton::render {

// True where this machine's validation layer can be used.
inline Result<Device> make_device(bool validation = true) {
    DeviceOptions options;
    options.kind = DeviceKind::cpu;
    options.validation = validation;
    return Device::create(options);
}

}  // namespace crofton::render

// Declares `device`, or ends the test case with a message where no software Vulkan device is installed. One that is
// there and refused is a fault: the message names what there is.
#define CROFTON_REQUIRE_DEVICE(device)                                                    \
    auto device = crofton::render::make_device();                                         \
    if (!device) {                                                                        \
        REQUIRE(device.error().message.find("there are: llvmpipe") == std::string::npos); \
        MESSAGE("skipped: " << device.error().message);                                   \
        return;                                                                           \
    }
