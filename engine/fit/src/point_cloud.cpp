#include "point_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/geometry/obb.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <string>
#include <type_traits>

#include "cloud_kernels.hpp"

namespace crofton::fit {
namespace {

// Rounding of normalised coordinates and of their projections stays far below this.
constexpr double kSlack = 1e-13;

template <class T>
tl::unexpected<Error> first_bad(const T* points, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
        bool finite = true, small = true;
        for (std::size_t k = 0; k < 3; ++k) {
            const double value = static_cast<double>(points[3 * i + k]);
            finite = finite && std::isfinite(value);
            small = small && std::abs(value) <= kMaxCoordinate;
        }
        if (!finite) return fail(ErrorCode::non_finite, i, "fit: point " + std::to_string(i) + " is NaN or infinite");
        if (!small) return fail(ErrorCode::out_of_range, i, "fit: point " + std::to_string(i) + " exceeds 1e30");
    }
    return fail(ErrorCode::internal, kNoItem, "fit: a bad point was seen, then lost");
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
    origin_ = bounds_.center();
    const glm::dvec3 half = bounds_.half_extents();
    int exponent = 0;
    std::frexp(std::max({half.x, half.y, half.z}), &exponent);
    unit_ = std::ldexp(1.0, exponent);
    scale_ = std::ldexp(1.0, -exponent);
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
    middle_.resize(chunks_);
    reach_.resize(chunks_);
    return {};
}

std::array<glm::dvec3, 2> PointCloud::extreme_pair(const glm::dvec3& direction) {
    kernels::Boxes boxes;
    for (std::size_t k = 0; k < 3; ++k) {
        boxes.center[k] = boxes_.data() + k * chunks_;
        boxes.half[k] = boxes_.data() + (3 + k) * chunks_;
    }
    kernels::project_boxes(boxes, chunks_, &direction.x, middle_.data(), reach_.data());
    // The most promising chunks first, so that the others can be skipped.
    std::size_t top = 0, bottom = 0;
    for (std::size_t i = 1; i < chunks_; ++i) {
        if (middle_[i] + reach_[i] > middle_[top] + reach_[top]) top = i;
        if (middle_[i] - reach_[i] < middle_[bottom] - reach_[bottom]) bottom = i;
    }
    std::array<glm::dvec3, 2> best{};
    double high = -std::numeric_limits<double>::infinity(), low = -high;
    const auto scan = [&](std::size_t chunk) {
        const std::size_t end = std::min(count_, (chunk + 1) * kernels::kChunk);
        for (std::size_t i = chunk * kernels::kChunk; i < end; ++i) {
            const glm::dvec3 p = normalised(i);
            const double t = glm::dot(p, direction);
            if (t >= high && (t > high || lexicographic(p, best[0]))) {
                high = t;
                best[0] = p;
            }
            if (t <= low && (t < low || lexicographic(p, best[1]))) {
                low = t;
                best[1] = p;
            }
        }
    };
    scan(top);
    if (bottom != top) scan(bottom);
    for (std::size_t i = 0; i < chunks_; ++i)
        if (i != top && i != bottom &&
            (middle_[i] + reach_[i] >= high - kSlack || middle_[i] - reach_[i] <= low + kSlack))
            scan(i);
    return best;
}

Supports PointCloud::supports(const glm::dmat3& axes) {
    Supports result;
    for (int k = 0; k < 3; ++k) {
        const auto pair = extreme_pair(axes[k]);
        result[static_cast<std::size_t>(2 * k)] = pair[0];
        result[static_cast<std::size_t>(2 * k + 1)] = pair[1];
    }
    return result;
}

void PointCloud::visit_beyond(const glm::dvec3& direction, const glm::dvec3& center, double reach,
                              FunctionRef<void(const glm::dvec3&)> visit) {
    kernels::Boxes boxes;
    for (std::size_t k = 0; k < 3; ++k) {
        boxes.center[k] = boxes_.data() + k * chunks_;
        boxes.half[k] = boxes_.data() + (3 + k) * chunks_;
    }
    kernels::project_boxes(boxes, chunks_, &direction.x, middle_.data(), reach_.data());
    const double middle = glm::dot((center - origin_) * scale_, direction);
    const double limit = reach * scale_ - kSlack;
    for (std::size_t chunk = 0; chunk < chunks_; ++chunk) {
        if (std::abs(middle_[chunk] - middle) + reach_[chunk] < limit) continue;
        const std::size_t end = std::min(count_, (chunk + 1) * kernels::kChunk);
        for (std::size_t i = chunk * kernels::kChunk; i < end; ++i)
            if (std::abs(glm::dot(normalised(i), direction) - middle) >= limit) visit(world(i));
    }
}

}  // namespace crofton::fit
