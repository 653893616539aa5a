// SPDX-License-Identifier: MIT
// Passes over many points, compiled for every instruction set and chosen at run time.
#pragma once
#include <cstddef>

#include "cloud/interior.hpp"

namespace crofton::fit::kernels {

inline constexpr std::size_t kChunk = 128;  // points in one box

// Per chunk of kChunk points (x, y, z interleaved): minima and maxima of each coordinate, in arrays of one entry a
// chunk.
template <class T>
struct ChunkBounds {
    T* low[3];
    T* high[3];
};

// Returns false if some coordinate is NaN or larger than `limit` in magnitude; the bounds are then undefined.
[[nodiscard]] bool chunk_bounds(const float* points, std::size_t count, float limit, const ChunkBounds<float>& out);
[[nodiscard]] bool chunk_bounds(const double* points, std::size_t count, double limit, const ChunkBounds<double>& out);

// Boxes by centre and half size, one array per coordinate.
struct Boxes {
    const double* center[3];
    const double* half[3];
};

// middle[i] = dot(direction, center_i), radius[i] = dot(|direction|, half_i): along the direction box i covers
// middle ± radius.
void project_boxes(const Boxes& boxes, std::size_t count, const double direction[3], double* middle, double* radius);

// Where wanted[i] ≠ 0: the least and greatest dot(direction, p − origin) over chunk i, for three directions (nine
// numbers, one direction after the other), in rounded arithmetic of T: each value is off by less than 4.1 unit
// roundoffs of Σ|direction_j (p_j − origin_j)|. out.low[k] and out.high[k] belong to direction k.
void chunk_extents(const float* points, std::size_t count, const unsigned char* wanted, const float* directions,
                   const float* origin, const ChunkBounds<float>& out);
void chunk_extents(const double* points, std::size_t count, const unsigned char* wanted, const double* directions,
                   const double* origin, const ChunkBounds<double>& out);

// Least and greatest dot(normals[k], p − center) over the points, computed in double: each difference, product and sum
// is rounded once.
void slab_extents(const float* points, std::size_t count, const double center[3], const double normals[9],
                  double low[3], double high[3]);
void slab_extents(const double* points, std::size_t count, const double center[3], const double normals[9],
                  double low[3], double high[3]);

// Normalised coordinates are (p + shift) · scale.
struct Normalisation {
    double shift[3];
    double scale;
};

// Copies the points whose normalised coordinates are not inside to `kept`, in their order; returns how many. `kept` has
// room for all. Requires test.count > 0.
std::size_t copy_all_but_interior(const float* points, std::size_t count, const Normalisation& to,
                                  const InteriorTest& test, float* kept);
std::size_t copy_all_but_interior(const double* points, std::size_t count, const Normalisation& to,
                                  const InteriorTest& test, double* kept);

}  // namespace crofton::fit::kernels
