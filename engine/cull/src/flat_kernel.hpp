// One view against a flat list of boxes, in vectors.
#pragma once
#include <cstddef>
#include <cstdint>

#include "kernel_view.hpp"

namespace crofton::cull {

struct FlatKernelInput {
    const float* spheres;  // blocks of x[16], y[16], z[16], radius[16]
    const float* records;  // 12 floats a box
    const KernelView* view;
    double origin[3];
    double reach;
    std::size_t first, count;  // boxes; first is a multiple of 64
    bool exact;
};

struct FlatKernelOutput {
    std::uint64_t* visible;  // words of all boxes
    std::uint64_t* inside;
    std::uint32_t* undecided;  // room for count and 16 more
    std::size_t undecided_count, records_tested;
};

void run_flat_kernel(const FlatKernelInput& input, FlatKernelOutput& output);

std::size_t list_bits_kernel(const std::uint64_t* bits, std::size_t words, std::uint32_t* ids);

}  // namespace crofton::cull
