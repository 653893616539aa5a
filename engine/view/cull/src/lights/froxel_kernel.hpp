// SPDX-License-Identifier: MIT
// Lights against a grid of froxels, in vectors: what a filter can decide, and calls for what it cannot.
#pragma once
#include <cstddef>
#include <cstdint>

namespace crofton::cull {

// In the view's own frame: u right, v up, w forward from the grid's origin. Boundary i of the columns is u = slope_i w
// + start_i, of the rows likewise in v, of the slices w = depth_i. As unit normals: across_i u + forward_i w + offset_i
// ≥ 0 is the right or upper side. Arrays have kFroxelPadding entries more than there are boundaries.
inline constexpr std::size_t kFroxelPadding = 16;

template <class T>
struct FroxelArrays {
    const T *slope[2], *start[2], *across[2], *forward[2], *offset[2], *depth;

    static constexpr std::size_t kPerBoundary = 5;

    // Where they lie in one array.
    FroxelArrays(const T* base, const std::uint32_t (&size)[3]) {
        for (unsigned axis = 0; axis < 2; ++axis)
            for (const T** array : {&slope[axis], &start[axis], &across[axis], &forward[axis], &offset[axis]}) {
                *array = base;
                base += size[axis] + 1 + kFroxelPadding;
            }
        depth = base;
    }
    static std::size_t length(const std::uint32_t (&size)[3]) {
        return kPerBoundary * (size[0] + size[1] + 2 + 2 * kFroxelPadding) + size[2] + 1 + kFroxelPadding;
    }
};

struct FroxelKernelGrid {
    std::uint32_t size[3];
    FroxelArrays<float> floats;
    FroxelArrays<double> doubles;
    double spread;  // ≥ 1 + the largest |slope| of columns and of rows
    double start;   // ≥ the largest |start|
};

// A light in the grid's frame; the axis is a unit vector up to rounding.
struct KernelLight {
    double at[3];
    double radius;                 // of the sphere, or the spot's range
    double axis[3], cosine, sine;  // of the half angle; the sine is above 0
    bool is_spot;
};

// Froxels `froxel` + l for the bits l of `mask` are lit by the light.
struct LitRun {
    std::uint32_t froxel, light, mask;
};

// The most lights of one input.
inline constexpr std::uint32_t kLightsAPart = 256;

struct FroxelKernelInput {
    const FroxelKernelGrid* grid;
    const KernelLight* lights;
    std::uint32_t count, first;  // light n's number is first + n
    // Decides what no filter can.
    bool (*decide)(void* context, std::uint32_t light, std::uint32_t froxel);
    void* context;
};

struct SpotBatch;

// Handles light `light` of the input, and writes at most as many runs as the batch holds pairs and the grid froxels;
// returns how many. Pairs of a spot stay in the batch until it is full. Lights come in ascending order, points before
// spots.
std::size_t run_froxel_kernel(const FroxelKernelInput& input, std::uint32_t light, SpotBatch& batch, LitRun* runs);
// Decides the pairs that are left in the batch.
std::size_t finish_spots(const FroxelKernelInput& input, SpotBatch& batch, LitRun* runs);

}  // namespace crofton::cull
