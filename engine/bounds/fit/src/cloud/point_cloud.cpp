// SPDX-License-Identifier: MIT
#include "cloud/point_cloud.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/finite.hpp>
#include <glm/geometric.hpp>
#include <string>
#include <type_traits>

#include "small_set/kernels.hpp"

namespace crofton::fit {
namespace {

// Error bound of a projection of normalised coordinates computed in double: the true one is below 1e-15.
constexpr double kErrorBound = 1e-13;
// Clouds of this many chunks are worth a look at which points are inside: at a sample, then a block at a time. All are
// looked at where the sample shows that they become this many times fewer.
constexpr std::size_t kManyChunks = 64, kSampleChunks = 16, kBlock = 4096, kLeastGain = 6;
constexpr int kLeastExponent = -1000;       // of the unit: its inverse is a double
constexpr std::size_t kScanAllChunks = 16;  // up to this many, picking the promising ones costs more than it saves

template <class T>
Error first_bad(const T* points, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
        bool finite = true, small = true;
        for (std::size_t k = 0; k < 3; ++k) {
            const double value = static_cast<double>(points[3 * i + k]);
            finite = finite && std::isfinite(value);
            small = small && std::abs(value) <= kMaxCoordinate;
        }
        if (!finite) return fail(ErrorCode::non_finite, i, {"fit: point ", i, " is NaN or infinite"});
        if (!small) return fail(ErrorCode::out_of_range, i, {"fit: point ", i, " exceeds 1e30"});
    }
    return fail(ErrorCode::internal, kNoItem, "fit: the points changed while they were read");
}

}  // namespace

void make_canonical(Vector<glm::dvec3>& points) {
    std::sort(points.begin(), points.end(), lexicographic);
    points.erase(std::unique(points.begin(), points.end()), points.end());
}

Result<void> PointCloud::assign(std::span<const glm::vec3> points) {
    floats_ = points.empty() ? nullptr : &points[0].x;
    doubles_ = nullptr;
    return assign_points(floats_, points.size());
}

Result<void> PointCloud::assign(std::span<const glm::dvec3> points) {
    floats_ = nullptr;
    doubles_ = points.empty() ? nullptr : &points[0].x;
    return assign_points(doubles_, points.size());
}

template <class T>
Result<void> PointCloud::assign_points(const T* points, std::size_t count) {
    if (count == 0) return fail(ErrorCode::empty, kNoItem, "fit: no points");
    count_ = count;
    chunks_ = (count + kernels::kChunk - 1) / kernels::kChunk;
    Vector<T>* storage;
    // The greatest float not above 1e30.
    T limit = static_cast<T>(kMaxCoordinate);
    if constexpr (std::is_same_v<T, float>) {
        storage = &float_bounds_;
        if (static_cast<double>(limit) > kMaxCoordinate) limit = std::nextafter(limit, 0.0f);
    } else {
        storage = &double_bounds_;
    }
    storage->resize(6 * chunks_);
    kernels::ChunkBounds<T> chunk;
    for (std::size_t k = 0; k < 3; ++k) {
        chunk.low[k] = storage->data() + k * chunks_;
        chunk.high[k] = storage->data() + (3 + k) * chunks_;
    }
    if (!kernels::chunk_bounds(points, count, limit, chunk)) return first_bad(points, count);
    bounds_ = Aabb();
    for (std::size_t i = 0; i < chunks_; ++i)
        for (int k = 0; k < 3; ++k) {
            bounds_.min[k] = std::min(bounds_.min[k], static_cast<double>(chunk.low[k][i]));
            bounds_.max[k] = std::max(bounds_.max[k], static_cast<double>(chunk.high[k][i]));
        }
    origin_ = bounds_.center() + 0.0;  // turns −0 into 0
    shift_ = 0.0 - origin_;
    const glm::dvec3 half = bounds_.half_extents();
    int exponent = 0;
    std::frexp(std::max({half.x, half.y, half.z}), &exponent);
    exponent = std::max(exponent, kLeastExponent);
    unit_ = std::ldexp(1.0, exponent);
    scale_ = std::ldexp(1.0, -exponent);
    // find_extents on floats: |direction_i| ≤ 1 and |p_i − origin_i| ≤ unit. The direction is rounded once, the origin
    // once (the shift is added back), the kernel adds 4.1 unit roundoffs: less than 6 for each of 3 coordinates, and a
    // few least floats for underflow.
    float_origin_ = glm::vec3(origin_);
    extent_error_bound_ = floats_ ? 18.0 * 0x1p-24 + 1e-44 * scale_ : kErrorBound;
    boxes_.resize(6 * chunks_);
    for (std::size_t k = 0; k < 3; ++k) {
        const double origin = origin_[static_cast<int>(k)];
        for (std::size_t i = 0; i < chunks_; ++i) {
            const double low = (static_cast<double>(chunk.low[k][i]) - origin) * scale_;
            const double high = (static_cast<double>(chunk.high[k][i]) - origin) * scale_;
            boxes_[k * chunks_ + i] = 0.5 * (low + high);
            boxes_[(3 + k) * chunks_ + i] = 0.5 * (high - low);
        }
    }
    for (Vector<double>* list : {&middle_, &projected_radius_, &low_, &high_}) list->resize(3 * chunks_);
    wanted_.resize(chunks_);
    return {};
}

void PointCloud::sorted(Vector<glm::dvec3>& points) {
    points.clear();
    constexpr std::size_t kQuadratic = 160;  // beyond this sorting is quicker than ranking
    if (floats_ == nullptr || count_ > kQuadratic) {
        for (std::size_t i = 0; i < count_; ++i) points.push_back(normalised(i));
        make_canonical(points);
        return;
    }
    const std::size_t padded = (count_ + kernels::kLanes - 1) / kernels::kLanes * kernels::kLanes;
    ranks_.resize(4 * padded);
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t i = 0; i < padded; ++i) ranks_[k * padded + i] = floats_[3 * (i < count_ ? i : 0) + k];
    float* const x = ranks_.data();
    float* const ranks = x + 3 * padded;
    kernels::find_ranks({x, x + padded, x + 2 * padded, count_}, ranks);
    // Duplicates share a rank; the ranks after it stay empty.
    constexpr std::uint32_t kNoPoint = ~std::uint32_t{0};
    order_.assign(count_, kNoPoint);
    for (std::size_t i = 0; i < count_; ++i)
        order_[static_cast<std::size_t>(static_cast<int>(ranks[i]))] = static_cast<std::uint32_t>(i);
    for (const std::uint32_t i : order_)
        if (i != kNoPoint) points.push_back(normalised(i));
    // Points that differ by less than the set's size is rounded to may be one now, and in another order.
    const auto is_not_before = [](const glm::dvec3& a, const glm::dvec3& b) { return !lexicographic(a, b); };
    if (std::adjacent_find(points.begin(), points.end(), is_not_before) != points.end()) make_canonical(points);
}

bool PointCloud::has_more_than(std::size_t most) const {
    if (count_ <= most) return false;
    // A hash table with open addressing, at most half full.
    std::size_t slots = 2;
    while (slots < 2 * (most + 1)) slots *= 2;
    Vector<glm::dvec3> different;
    different.reserve(most + 1);
    Vector<std::uint32_t> table(slots, 0);  // 1 + the index in `different`, 0 where a slot is free
    for (std::size_t i = 0; i < count_; ++i) {
        const glm::dvec3 p = normalised(i);
        std::uint64_t hash = 0;
        for (int k = 0; k < 3; ++k)
            hash = (hash ^ std::bit_cast<std::uint64_t>(p[k] + 0.0)) * 0x9e3779b97f4a7c15u, hash ^= hash >> 32;
        std::size_t slot = hash % slots;
        while (table[slot] != 0 && different[table[slot] - 1] != p) slot = (slot + 1) % slots;
        if (table[slot] != 0) continue;
        different.push_back(p);
        if (different.size() > most) return true;
        table[slot] = static_cast<std::uint32_t>(different.size());
    }
    return false;
}

void PointCloud::project_boxes(const glm::dmat3& directions) {
    kernels::Boxes boxes;
    for (std::size_t k = 0; k < 3; ++k) {
        boxes.center[k] = boxes_.data() + k * chunks_;
        boxes.half[k] = boxes_.data() + (3 + k) * chunks_;
    }
    for (std::size_t k = 0; k < 3; ++k)
        kernels::project_boxes(boxes, chunks_, &directions[static_cast<int>(k)].x, middle_.data() + k * chunks_,
                               projected_radius_.data() + k * chunks_);
}

template <class T>
void PointCloud::find_extents_of(const T* points, Vector<T>& storage, const T* directions, const T* origin,
                                 const glm::dvec3& shift) {
    kernels::ChunkBounds<T> chunk;
    for (std::size_t k = 0; k < 3; ++k) {
        chunk.low[k] = storage.data() + k * chunks_;
        chunk.high[k] = storage.data() + (3 + k) * chunks_;
    }
    kernels::chunk_extents(points, count_, wanted_.data(), directions, origin, chunk);
    for (std::size_t k = 0; k < 3; ++k) {
        double* low = low_.data() + k * chunks_;
        double* high = high_.data() + k * chunks_;
        const double moved = shift[static_cast<int>(k)];
        for (std::size_t i = 0; i < chunks_; ++i) {
            const bool wanted = wanted_[i] != 0;
            low[i] = wanted ? static_cast<double>(chunk.low[k][i]) * scale_ + moved : kInfinity;
            high[i] = wanted ? static_cast<double>(chunk.high[k][i]) * scale_ + moved : -kInfinity;
        }
    }
}

void PointCloud::find_extents(const glm::dmat3& directions) {
    if (floats_) {
        const glm::mat3 rounded(directions);
        const glm::dvec3 shift = (glm::dvec3(float_origin_) - origin_) * scale_ * directions;
        find_extents_of(floats_, float_bounds_, &rounded[0].x, &float_origin_.x, shift);
    } else {
        find_extents_of(doubles_, double_bounds_, &directions[0].x, &origin_.x, glm::dvec3(0.0));
    }
}

std::size_t PointCloud::most_promising_chunk(std::size_t side) const {
    const double* middle = middle_.data() + side / 2 * chunks_;
    const double* radius = projected_radius_.data() + side / 2 * chunks_;
    const double sign = side % 2 == 0 ? 1.0 : -1.0;
    std::size_t best = 0;
    for (std::size_t i = 1; i < chunks_; ++i)
        if (sign * middle[i] + radius[i] > sign * middle[best] + radius[best]) best = i;
    return best;
}

void PointCloud::scan(std::size_t chunk, const glm::dvec3& direction, Support& best) const {
    const std::size_t end = std::min(count_, (chunk + 1) * kernels::kChunk);
    for (std::size_t i = chunk * kernels::kChunk; i < end; ++i) {
        const glm::dvec3 p = normalised(i);
        const double t = glm::dot(p, direction);
        if (t >= best.height && (t > best.height || lexicographic(p, best.point))) best = {p, t};
    }
}

Supports PointCloud::supports(const glm::dmat3& directions) {
    project_boxes(directions);
    std::array<Support, 6> best;
    best.fill({glm::dvec3(0.0), -kInfinity});
    const auto scan_for = [&](std::size_t side, std::size_t chunk) {
        const int k = static_cast<int>(side / 2);
        scan(chunk, (side % 2 == 0 ? 1.0 : -1.0) * directions[k], best[side]);
    };
    // One promising chunk a side first, so that most others can be skipped.
    std::array<std::size_t, 6> scanned;
    scanned.fill(chunks_);
    for (std::size_t side = 0; side < 6 && chunks_ > kScanAllChunks; ++side) {
        scanned[side] = most_promising_chunk(side);
        scan_for(side, scanned[side]);
    }
    for (std::size_t i = 0; i < chunks_; ++i) {
        bool skip = true;
        for (std::size_t k = 0; k < 3; ++k) {
            const double middle = middle_[k * chunks_ + i], radius = projected_radius_[k * chunks_ + i] + kErrorBound;
            skip = skip && middle + radius < best[2 * k].height && radius - middle < best[2 * k + 1].height;
        }
        wanted_[i] = !skip;
    }
    find_extents(directions);
    // Scan in double every chunk that may hold the support point, judging by its rounded extents.
    for (std::size_t k = 0; k < 3; ++k) {
        const double* low = low_.data() + k * chunks_;
        const double* high = high_.data() + k * chunks_;
        const double error = extent_error_bound_;
        const double least = std::min(-best[2 * k + 1].height, *std::min_element(low, low + chunks_) + error) + error;
        const double greatest = std::max(best[2 * k].height, *std::max_element(high, high + chunks_) - error) - error;
        for (std::size_t i = 0; i < chunks_; ++i) {
            if (high[i] >= greatest && i != scanned[2 * k]) scan_for(2 * k, i);
            if (low[i] <= least && i != scanned[2 * k + 1]) scan_for(2 * k + 1, i);
        }
    }
    Supports supports;
    for (std::size_t side = 0; side < 6; ++side) supports[side] = best[side].point;
    return supports;
}

void PointCloud::forget_interior(std::span<const glm::dvec3> extremes) {
    const auto read =
        static_cast<std::size_t>(std::count_if(wanted_.begin(), wanted_.end(), [](auto w) { return w != 0; }));
    if (chunks_ < kManyChunks || read < chunks_ / 2) return;
    const InteriorTest test = interior_test(extremes);
    if (test.count == 0) return;
    if (floats_)
        forget_interior_of(floats_, test, kept_floats_);
    else
        forget_interior_of(doubles_, test, kept_doubles_);
}

template <class T>
void PointCloud::forget_interior_of(const T* points, const InteriorTest& test, Vector<T>& kept) {
    const kernels::Normalisation to{{shift_.x, shift_.y, shift_.z}, scale_};
    std::size_t left = 0;
    const auto look = [&](std::size_t begin, std::size_t block) {
        kept.resize(3 * (left + block));
        left += kernels::copy_all_but_interior(points + 3 * begin, block, to, test, kept.data() + 3 * left);
    };
    for (std::size_t i = 0; i < kSampleChunks; ++i)
        look(i * chunks_ / kSampleChunks * kernels::kChunk, kernels::kChunk);
    if (left > kSampleChunks * kernels::kChunk / kLeastGain) return;
    left = 0;
    for (std::size_t begin = 0; begin < count_; begin += kBlock) look(begin, std::min(kBlock, count_ - begin));
    if constexpr (std::is_same_v<T, float>)
        floats_ = kept.data();
    else
        doubles_ = kept.data();
    static_cast<void>(assign_points(kept.data(), left));  // they were good before
}

void PointCloud::visit_beyond(const glm::dmat3& directions, const glm::dvec3& center, const glm::dvec3& limit,
                              FunctionRef<void(int k, const glm::dvec3& p)> visit) {
    project_boxes(directions);
    const glm::dvec3 middle = (center - origin_) * scale_ * directions;
    const glm::dvec3 beyond = limit * scale_ - kErrorBound;
    for (std::size_t i = 0; i < chunks_; ++i) {
        bool skip = true;
        for (std::size_t k = 0; k < 3; ++k) {
            const int axis = static_cast<int>(k);
            skip = skip && std::abs(middle_[k * chunks_ + i] - middle[axis]) + projected_radius_[k * chunks_ + i] <
                               beyond[axis];
        }
        wanted_[i] = !skip;
    }
    find_extents(directions);
    for (int k = 0; k < 3; ++k)
        for (std::size_t chunk = 0; chunk < chunks_; ++chunk) {
            const double low = low_[static_cast<std::size_t>(k) * chunks_ + chunk];
            const double high = high_[static_cast<std::size_t>(k) * chunks_ + chunk];
            const double certain = beyond[k] - extent_error_bound_;
            if (high - middle[k] < certain && middle[k] - low < certain) continue;
            const std::size_t end = std::min(count_, (chunk + 1) * kernels::kChunk);
            for (std::size_t i = chunk * kernels::kChunk; i < end; ++i)
                if (std::abs(glm::dot(normalised(i), directions[k]) - middle[k]) >= beyond[k]) visit(k, world(i));
        }
}

}  // namespace crofton::fit
