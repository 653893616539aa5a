// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/geometry/camera.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/query_sample.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <numeric>

namespace crofton::study {
namespace {

using std::numbers::pi;
constexpr std::uint32_t kMaxQueries = 1u << 24;
// Relative to the largest distances: 128 roundings. What is surely inside is so by more than this file's sums err.
constexpr double kSure = 0x1p-46;

double sum_of(const glm::dvec3& v) {
    return std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
}

struct HalfEdges {
    std::array<glm::dvec3, 3> axis;
    explicit HalfEdges(const Obb& box) {
        for (int k = 0; k < 3; ++k)
            axis[static_cast<std::size_t>(k)] = glm::dvec3(box.axes[k]) * double{box.half_extents[k]};
    }
    [[nodiscard]] double projected_radius(const glm::dvec3& n) const {
        return std::abs(glm::dot(axis[0], n)) + std::abs(glm::dot(axis[1], n)) + std::abs(glm::dot(axis[2], n));
    }
};

}  // namespace

Result<QuerySample> QuerySample::make(Kind kind, const Sphere& region, std::uint32_t count) {
    if (!(region.radius > 0.0) || !std::isfinite(region.radius) ||
        !std::isfinite(region.center.x + region.center.y + region.center.z))
        return fail(ErrorCode::invalid_argument, kNoItem, "query sample: the region has no positive, finite radius");
    if (count == 0 || count > kMaxQueries)
        return fail(ErrorCode::out_of_range, kNoItem, "query sample: between 1 and 2^24 queries are possible");
    QuerySample sample;
    sample.kind_ = kind;
    sample.queries_.resize(count);
    return sample;
}

Result<QuerySample> QuerySample::planes(const Sphere& region, std::uint32_t count, std::uint64_t seed) {
    auto sample = make(Kind::plane, region, count);
    if (!sample) return sample;
    const sampling::UnitPoints points(seed, sampling::Sequence::quasi_random);
    for (std::uint32_t i = 0; i < count; ++i) {
        const auto u = points.at<3>(i);
        const glm::dvec3 n = sampling::direction({u[0], u[1]});
        sample->queries_[i].direction = n;
        sample->queries_[i].point = region.center + region.radius * (2.0 * u[2] - 1.0) * n;
    }
    sample->measure_ = 4.0 * pi * region.radius;
    return sample;
}

Result<QuerySample> QuerySample::lines(const Sphere& region, std::uint32_t count, std::uint64_t seed) {
    auto sample = make(Kind::line, region, count);
    if (!sample) return sample;
    const sampling::UnitPoints points(seed, sampling::Sequence::quasi_random);
    for (std::uint32_t i = 0; i < count; ++i) {
        const Line line = sampling::line_through_disc(region, points.at<4>(i));
        sample->queries_[i].point = line.point;
        sample->queries_[i].direction = line.direction;
    }
    sample->measure_ = sampling::measure_of_lines(4.0 * pi * region.radius * region.radius);
    return sample;
}

Result<QuerySample> QuerySample::frusta(const Camera& camera, const Sphere& region, std::uint32_t count,
                                        std::uint64_t seed) {
    auto sample = make(Kind::frustum, region, count);
    if (!sample) return sample;
    if (auto finite = measure::intrinsic_volumes_of_frustum(camera); !finite) return finite.error();
    const Frustum frustum = *frustum_of(camera);
    sample->corners_ = *frustum_corners(frustum);
    const auto& c = sample->corners_;
    for (std::size_t k = 0; k < 5; ++k) {  // far is parallel to near
        const glm::dvec3 n = frustum.planes[k].normal;
        sample->normals_[k] = n;
        auto& extent = sample->extents_[k];
        extent = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
        for (const glm::dvec3& corner : c)
            extent = {std::min(extent[0], glm::dot(n, corner)), std::max(extent[1], glm::dot(n, corner))};
    }
    sample->edges_ = {c[1] - c[0], c[2] - c[0], c[4] - c[0], c[5] - c[1], c[6] - c[2], c[7] - c[3]};
    Aabb range;
    for (const glm::dvec3& corner : c) range.include(corner);
    range.min -= glm::dvec3(region.radius);
    range.max += glm::dvec3(region.radius);
    const sampling::UnitPoints points(seed, sampling::Sequence::quasi_random);
    for (std::uint32_t i = 0; i < count; ++i) {
        const RigidTransform uniform = sampling::motion(range, points.at<6>(i));
        sample->queries_[i].rotation = uniform.rotation;
        sample->queries_[i].point = region.center - uniform.rotation * uniform.translation;
    }
    const glm::dvec3 size = range.max - range.min;
    sample->measure_ = size.x * size.y * size.z;
    return sample;
}

bool QuerySample::hits(std::uint32_t i, const Obb& box) const {
    const Query& q = queries_[i];
    const glm::dvec3 d = box.center - q.point;
    if (kind_ == Kind::plane) return std::abs(glm::dot(d, q.direction)) <= HalfEdges(box).projected_radius(q.direction);
    if (kind_ == Kind::frustum) return frustum_hits(q, box, nullptr);
    // Separating axes of a line and a box: the box's axes crossed with the line.
    const HalfEdges half(box);
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 n = glm::cross(glm::dvec3(box.axes[k]), q.direction);
        if (std::abs(glm::dot(d, n)) > half.projected_radius(n)) return false;
    }
    return true;
}

bool QuerySample::surely_hits(std::uint32_t i, std::span<const glm::dvec3> points,
                              std::span<const std::uint32_t> triangles) const {
    const Query& q = queries_[i];
    if (kind_ == Kind::plane) {
        bool above = false, below = false;
        for (const glm::dvec3& p : points) {
            const double side = glm::dot(p - q.point, q.direction), error_bound = kSure * (sum_of(p) + sum_of(q.point));
            above = above || side >= error_bound;
            below = below || side <= -error_bound;
        }
        return above && below;
    }
    for (std::size_t t = 0; t + 2 < triangles.size(); t += 3) {
        const std::array<glm::dvec3, 3> corner = {points[triangles[t]] - q.point, points[triangles[t + 1]] - q.point,
                                                  points[triangles[t + 2]] - q.point};
        double max_l1 = sum_of(q.point);
        for (std::size_t k = 0; k < 3; ++k) max_l1 = std::max(max_l1, sum_of(points[triangles[t + k]]));
        int turns = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec3 &a = corner[k], &b = corner[(k + 1) % 3];
            if (kind_ == Kind::frustum && segment_enters(q, a, b, kSure * max_l1)) return true;
            // Seen along the line: its distance from the edge, times the edge's length.
            const double turn = glm::dot(glm::cross(a, b), q.direction);
            const double error_bound = 2.0 * kSure * max_l1 * (sum_of(a) + sum_of(b));
            turns += turn > error_bound ? 1 : turn < -error_bound ? -1 : 0;
        }
        if (kind_ == Kind::line && std::abs(turns) == 3) return true;
    }
    return false;
}

// Points relative to the query's own. Some point of the segment is inside every plane by `margin`. Where it lies along
// the segment is rounded, which moves the sides by less than half the margin.
bool QuerySample::segment_enters(const Query& q, const glm::dvec3& from, const glm::dvec3& to, double margin) const {
    const glm::dmat3 back = glm::transpose(q.rotation);
    const glm::dvec3 a = back * from, b = back * to;
    double begin = 0.0, end = 1.0;
    // The part where side(0) + t (side(1) − side(0)) >= margin.
    for (const glm::dvec3& corner : corners_) margin = std::max(margin, kSure * sum_of(corner));
    const auto clip = [&](double at_a, double at_b) {
        at_a -= margin, at_b -= margin;
        if (at_a < 0.0 && at_b < 0.0) return false;
        if (at_a < 0.0) begin = std::max(begin, at_a / (at_a - at_b));
        if (at_b < 0.0) end = std::min(end, at_a / (at_a - at_b));
        return begin <= end;
    };
    for (std::size_t k = 0; k < normals_.size(); ++k)
        if (!clip(glm::dot(normals_[k], a) - extents_[k][0], glm::dot(normals_[k], b) - extents_[k][0])) return false;
    return clip(extents_[4][1] - glm::dot(normals_[4], a), extents_[4][1] - glm::dot(normals_[4], b));
}

bool QuerySample::straddles(std::uint32_t i, const Obb& box) const {
    if (kind_ != Kind::frustum) return hits(i, box);
    bool contained = false;
    return frustum_hits(queries_[i], box, &contained) && !contained;
}

bool QuerySample::frustum_hits(const Query& q, const Obb& box, bool* contained) const {
    // In the frustum's own frame.
    const glm::dmat3 back = glm::transpose(q.rotation);
    const glm::dvec3 center = back * (box.center - q.point);
    HalfEdges half(box);
    for (glm::dvec3& a : half.axis) a = back * a;
    bool inside = true;
    for (std::size_t k = 0; k < normals_.size(); ++k) {
        const double at = glm::dot(normals_[k], center), radius = half.projected_radius(normals_[k]);
        if (at + radius < extents_[k][0] || at - radius > extents_[k][1]) return false;
        // Inward normals: the lower extent is the plane itself; the far plane is the upper one along near's normal.
        inside = inside && at - radius >= extents_[k][0] && (k != 4 || at + radius <= extents_[k][1]);
    }
    if (contained != nullptr) *contained = inside;
    if (inside) return true;
    const auto apart = [&](const glm::dvec3& n) {
        const double at = glm::dot(n, center), radius = half.projected_radius(n);
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (const glm::dvec3& corner : corners_)
            low = std::min(low, glm::dot(n, corner)), high = std::max(high, glm::dot(n, corner));
        return at + radius < low || at - radius > high;
    };
    // Stored axes are not quite orthogonal, so a face's normal is a cross product of two.
    const std::array<glm::dvec3, 3> axes = {back * glm::dvec3(box.axes[0]), back * glm::dvec3(box.axes[1]),
                                            back * glm::dvec3(box.axes[2])};
    for (std::size_t k = 0; k < 3; ++k)
        if (apart(glm::cross(axes[k], axes[(k + 1) % 3]))) return false;
    for (const glm::dvec3& a : axes)
        for (const glm::dvec3& e : edges_)
            if (apart(glm::cross(a, e))) return false;
    return true;
}

Vector<std::uint32_t> QuerySample::hitting(std::span<const std::uint32_t> candidates, const Obb& box) const {
    Vector<std::uint32_t> result;
    for (const std::uint32_t i : candidates)
        if (hits(i, box)) result.push_back(i);
    return result;
}

Vector<std::uint32_t> QuerySample::all() const {
    Vector<std::uint32_t> result(size());
    std::iota(result.begin(), result.end(), 0u);
    return result;
}

}  // namespace crofton::study
