// SPDX-License-Identifier: MIT
// The render component: a machine without a driver is an answer, too.
#include <crofton/render/device.hpp>
#include <cstdio>

int main() {
    const auto device = crofton::render::Device::create();
    std::printf("crofton::render: %s\n", device ? "a device" : device.error().message.c_str());
    return device || device.error().code == crofton::ErrorCode::unavailable ? 0 : 1;
}
