// SPDX-License-Identifier: MIT
// Finds the triangle that owns each pixel: draws the frame's triangles in their numbers, from 1; 0 is the background.
#include <cstring>

#include "rasterizer_state.hpp"

namespace crofton::render {

Result<void> Rasterizer::State::number_triangles(const Frame& frame) {
    draws.clear();
    if (auto valid = merge_ranges(frame.ranges, index_count, frame.transforms.size(), draws); !valid) return valid;
    numbered_ranges.assign(frame.ranges.begin(), frame.ranges.end());
    numbered_transforms.clear();
    std::uint64_t number = 1;
    for (std::size_t r = 0; r < numbered_ranges.size(); ++r) {
        DrawRange& range = numbered_ranges[r];
        DrawTransform transform = frame.transforms[range.transform];
        transform.number[0] = static_cast<float>(number & 0xffffu);
        transform.number[1] = static_cast<float>(number >> 16);
        numbered_transforms.push_back(transform);
        range.transform = static_cast<std::uint32_t>(r);
        number += range.index_count / 3;
        if (number > kNoTriangle) return fail(ErrorCode::out_of_range, r, "more triangles than 32 bits can number");
    }
    return {};
}

void Rasterizer::State::record_numbers(const Target& target) {
    if (stamps != VK_NULL_HANDLE) context.vk.vkCmdResetQueryPool(commands.handle, stamps, 0, stamp_count);
    next_stamp = 0;
    const LabelledCommands label(context.labels, commands.handle, "triangles in numbers");
    begin_pass(pipelines.render_pass, target, {});
    if (!draws.empty()) bind_geometry();
    record_counted_draws(pipelines.owners);
    context.vk.vkCmdEndRenderPass(commands.handle);
    target.record_readback(commands.handle);
}

Result<void> Rasterizer::draw_owners(const Frame& frame, Vector<std::uint32_t>& owners, std::uint32_t picture) {
    State& s = *state_;
    CROFTON_ASSERT(picture < s.targets.size(), "there is no such picture");
    Target& target = *s.targets[picture];
    if (!s.context.primitive_numbers)
        return fail(ErrorCode::unsupported, kNoItem,
                    {s.context.name, ": the device cannot number triangles in fragment shaders"});
    if (target.drawn_color.handle != VK_NULL_HANDLE)
        return fail(ErrorCode::invalid_argument, kNoItem, "owners of pixels need a picture of resolution 1");
    if (auto numbered = s.number_triangles(frame); !numbered) return numbered;
    Frame numbers = frame;
    numbers.ranges = s.numbered_ranges;
    numbers.transforms = s.numbered_transforms;
    numbers.wire_ranges = {};
    numbers.lines = {};
    if (auto prepared = s.prepare(numbers); !prepared) return prepared;
    if (auto begun = s.commands.begin(); !begun) return begun;
    s.record_numbers(target);
    if (auto done = s.commands.submit_and_wait(); !done) return done;
    target.drawn = true;
    owners.resize(std::size_t{target.extent.width} * target.extent.height);
    static_assert(kColorFormat == VK_FORMAT_B8G8R8A8_UNORM);
    const auto* bgra = reinterpret_cast<const std::uint8_t*>(target.readback.mapped);
    for (std::size_t p = 0; p < owners.size(); ++p, bgra += 4) {
        const std::uint32_t number = static_cast<std::uint32_t>(bgra[2]) | static_cast<std::uint32_t>(bgra[1]) << 8 |
                                     static_cast<std::uint32_t>(bgra[0]) << 16 |
                                     static_cast<std::uint32_t>(bgra[3]) << 24;
        owners[p] = number - 1;
    }
    return {};
}

}  // namespace crofton::render
