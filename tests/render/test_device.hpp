// SPDX-License-Identifier: MIT
// A validated device for the tests: a software one, or that which the environment's CROFTON_DEVICE names. Tests that
// need one skip where there is none.
#pragma once
#include <doctest/doctest.h>

#include <crofton/render/rasterizer.hpp>
#include <cstdlib>
#include <optional>
#include <string>

namespace crofton::render {

inline DeviceOptions device_options() {
    DeviceOptions options;
    if (std::getenv("CROFTON_DEVICE") == nullptr) options.kind = DeviceKind::cpu;
    return options;
}

// True where this machine's validation layer can be used.
inline Result<Device> make_device(bool validation = true) {
    DeviceOptions options = device_options();
    options.validation = validation;
    return Device::create(options);
}

}  // namespace crofton::render

// Declares `device`, or ends the test case with a message where no such Vulkan device is installed. A software one that
// is there and refused is a fault: the message names what there is.
#define CROFTON_REQUIRE_DEVICE(device)                                                    \
    auto device = crofton::render::make_device();                                         \
    if (!device) {                                                                        \
        REQUIRE(device.error().message.find("there are: llvmpipe") == std::string::npos); \
        MESSAGE("skipped: " << device.error().message);                                   \
        return;                                                                           \
    }

// The same for tests of what lavapipe alone promises.
#define CROFTON_REQUIRE_LAVAPIPE(device)                                              \
    CROFTON_REQUIRE_DEVICE(device)                                                    \
    if (!device->counts_exactly()) {                                                  \
        MESSAGE("skipped: " << device->name() << " does not count as lavapipe does"); \
        return;                                                                       \
    }
