// SPDX-License-Identifier: MIT
// A light as a filter reads it, with the error bounds that light_tests-inl.hpp derives.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "lights/froxel_kernel.hpp"

namespace crofton::cull {

template <class T>
inline constexpr T kLightRounding = std::is_same_v<T, float> ? T(0x1p-21) : T(0x1p-45);
template <class T>
inline constexpr T kLightTrifle = std::is_same_v<T, float> ? T(0x1p-18) : T(0x1p-40);  // of relative errors

template <class T>
struct FilterLight {
    T at[3], axis[3], radius, cosine, sine;
    T eta;    // 8 s δ
    T inner;  // (radius − η)², less a trifle; −1 where that says nothing
    T outer;  // (R + η)² for an R ≥ radius
    T keep;   // 1 − κ, κ = s² (kLightTrifle + 4 δ / R)
    bool is_spot;

    FilterLight() = default;
    FilterLight(const FroxelKernelGrid& grid, const KernelLight& light) : is_spot(light.is_spot) {
        T largest = 0;
        for (int j = 0; j < 3; ++j) {
            at[j] = static_cast<T>(light.at[j]);
            axis[j] = static_cast<T>(light.axis[j]);
            largest = std::max(largest, std::fabs(at[j]));
        }
        radius = static_cast<T>(light.radius);
        cosine = static_cast<T>(light.cosine);
        sine = static_cast<T>(light.sine);
        const T s = static_cast<T>(grid.spread);
        const T delta = kLightRounding<T> * (s * (largest + radius) + static_cast<T>(grid.start));
        eta = 8 * s * delta;
        const T within = radius - eta, least = std::max({radius, 16 * s * s * delta, std::numeric_limits<T>::min()});
        inner = within > 0 ? within * within * (1 - kLightTrifle<T>) : T(-1);
        outer = (least + eta) * (least + eta) * (1 + kLightTrifle<T>);
        keep = 1 - s * s * (kLightTrifle<T> + 4 * delta / least);
    }
};

// Spot lights and the froxels that they may reach, gathered until they fill vectors.
struct SpotBatch {
    static constexpr std::uint32_t kPairs = 512;
    std::uint32_t count = 0;
    std::int32_t light[kPairs], column[kPairs], row[kPairs], froxel[kPairs];
    float low[kPairs], high[kPairs];  // the part of the froxel's slab that the light reaches
    std::uint8_t is_lit[kPairs];
    FilterLight<float> lights[kLightsAPart];  // of the input; spots that have pairs
};

}  // namespace crofton::cull
