// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/core/error.hpp>
#include <crofton/core/stop_signal.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/trigonometry.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/light_field.hpp>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/packing.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <numbers>
#include <optional>

namespace crofton::study {
namespace {

// Pixels are counted from the picture's upper left corner; the middle of the first is (0.5, 0.5).
class PictureRays {
  public:
    [[nodiscard]] static Result<PictureRays> of(const Camera& camera, std::uint32_t width, std::uint32_t height) {
        if (auto valid = validate(camera); !valid) return valid.error();
        if (camera.projection != Projection::perspective)
            return fail(ErrorCode::unsupported, kNoItem, "picture: the camera is orthographic");
        if (width == 0 || height == 0 || std::uint64_t{width} * height > std::uint64_t{1} << 24)
            return fail(ErrorCode::out_of_range, kNoItem, "picture: no pixels, or more than 2^24");
        PictureRays rays;
        rays.to_view_ = world_to_view_rotation(camera);
        rays.size_ = {width, height};
        rays.half_.y = tangent(0.5 * camera.fov_y);
        rays.half_.x = rays.half_.y * camera.aspect;
        return rays;
    }

    // Unit, in the world.
    [[nodiscard]] glm::dvec3 direction(double x, double y) const {
        const glm::dvec3 view((2.0 * x / size_.x - 1.0) * half_.x, (1.0 - 2.0 * y / size_.y) * half_.y, -1.0);
        return glm::normalize(glm::transpose(to_view_) * view);
    }
    // Returns the pixel of a point relative to the eye; nothing if it lies outside the picture.
    [[nodiscard]] std::optional<glm::dvec2> pixel_of(const glm::dvec3& point) const {
        const glm::dvec3 view = to_view_ * point;
        if (!(view.z < 0.0)) return {};
        const double x = 0.5 * size_.x * (1.0 - view.x / (view.z * half_.x)),
                     y = 0.5 * size_.y * (1.0 + view.y / (view.z * half_.y));
        if (!(x >= 0.0 && x < size_.x && y >= 0.0 && y < size_.y)) return {};
        return glm::dvec2(x, y);
    }

  private:
    glm::dmat3 to_view_{1.0};
    glm::dvec2 size_{0.0}, half_{0.0};
};

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kBundles = 8.0;  // times √lines: the sky has one place in the picture a bundle

glm::i8vec3 packed(const glm::vec3& normal) {
    return {glm::round(127.0f * normal)};
}

// A point of the picture, in pixels.
struct Sample {
    double x, y, depth, offset;
    glm::vec3 light;
};

// Samples by the pixel they lie in.
class Buckets {
  public:
    Buckets(const Vector<Sample>& samples, std::uint32_t width, std::uint32_t height)
        : samples_(samples), width_(width), height_(height), starts_(std::size_t{width} * height + 1) {
        for (const Sample& s : samples) ++starts_[bucket(s) + 1];
        for (std::size_t b = 1; b < starts_.size(); ++b) starts_[b] += starts_[b - 1];
        Vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
        order_.resize(samples.size());
        for (std::size_t i = 0; i < samples.size(); ++i)
            order_[next[bucket(samples[i])]++] = static_cast<std::uint32_t>(i);
    }

    // Distances squared and numbers of at least `count` samples, or of all, around the pixel's middle: whole rings of
    // pixels until the nearest `count` are among them. Ascending, ties by number.
    using Near = std::pair<double, std::uint32_t>;
    void nearest(std::uint32_t column, std::uint32_t row, std::size_t count, Vector<Near>& found) const {
        found.clear();
        const int last = static_cast<int>(std::max(width_, height_));
        for (int ring = 0; ring <= last; ++ring) {
            visit_ring(static_cast<int>(column), static_cast<int>(row), ring, found);
            if (found.size() < count) continue;
            std::sort(found.begin(), found.end());
            // Everything beyond the rings seen so far is farther away than this.
            if (found[count - 1].first <= (ring + 0.5) * (ring + 0.5)) return;
        }
        std::sort(found.begin(), found.end());
    }

  private:
    [[nodiscard]] std::size_t bucket(const Sample& s) const {
        return static_cast<std::size_t>(s.y) * width_ + static_cast<std::size_t>(s.x);
    }
    void visit_ring(int column, int row, int ring, Vector<Near>& found) const {
        for (int y = row - ring; y <= row + ring; ++y) {
            if (y < 0 || y >= static_cast<int>(height_)) continue;
            const int step = ring > 0 && y != row - ring && y != row + ring ? 2 * ring : 1;
            for (int x = column - ring; x <= column + ring; x += step) {
                if (x < 0 || x >= static_cast<int>(width_)) continue;
                const std::size_t b = static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x);
                for (std::uint32_t k = starts_[b]; k < starts_[b + 1]; ++k) {
                    const Sample& s = samples_[order_[k]];
                    const double dx = s.x - column - 0.5, dy = s.y - row - 0.5;
                    found.push_back({dx * dx + dy * dy, order_[k]});
                }
            }
        }
    }

    const Vector<Sample>& samples_;
    std::uint32_t width_, height_;
    Vector<std::uint32_t> starts_, order_;
};

}  // namespace

Result<LightField> LightField::record(const lines::LineTracer& scene, LightAt light, const LightFieldOptions& options,
                                      Executor& executor) {
    if (options.lines < 1 || options.lines > std::uint64_t{1} << 28)
        return fail(ErrorCode::out_of_range, kNoItem, "light field: `lines` must lie in [1, 2^28]");
    const glm::dvec3 extents = 2.0 * scene.bounds().half_extents();
    // A uniform direction's shadow of a box is a quarter of its surface on average.
    const double shadow = 0.5 * (extents.x * extents.y + extents.y * extents.z + extents.z * extents.x);
    if (!(shadow > 0.0)) return fail(ErrorCode::degenerate, kNoItem, "light field: the scene has no extent");
    LightField field;
    field.sky_ = options.sky;
    field.diagonal_ = glm::length(extents);
    const auto count = static_cast<std::size_t>(std::ceil(kBundles * std::sqrt(static_cast<double>(options.lines))));
    const double cell_area = shadow * static_cast<double>(count) / static_cast<double>(options.lines);
    field.bundles_.resize(count);
    const sampling::UnitPoints points(options.seed);
    crofton::detail::StopSignal stop(options.should_stop, options.user);
    executor.parallel_for(count, 4, [&](std::size_t begin, std::size_t end, unsigned) {
        Vector<Line> lines;
        lines::LineHits hits;
        for (std::size_t b = begin; b < end; ++b) {
            if (stop.is_raised(0.0)) return;
            Bundle& bundle = field.bundles_[b];
            bundle.lines = lines::make_bundle(scene.bounds(), cell_area, points.at<2>(b),
                                              sampling::seed_of_repetition(options.seed, b, count));
            lines.clear();
            for (std::size_t c = 0; c < bundle.lines.cells(); ++c) lines.push_back(bundle.lines.line(c));
            scene.all_hits(lines, hits);
            bundle.ends = hits.ends;
            bundle.crossings.reserve(hits.hits.size());
            std::size_t i = 0;
            for (std::size_t c = 0; c < lines.size(); ++c)
                for (; i < hits.ends[c]; ++i) {
                    const lines::Hit& hit = hits.hits[i];
                    const glm::dvec3 at = lines[c].point + static_cast<double>(hit.t) * lines[c].direction;
                    const Leaving leaving = light(hit.triangle, at);
                    bundle.crossings.push_back(
                        {hit.t, glm::packHalf(leaving.light), packed(leaving.normal), hit.front});
                }
        }
    });
    if (stop.was_raised()) return fail(ErrorCode::cancelled, kNoItem, "light field: cancelled");
    for (const Bundle& bundle : field.bundles_) {
        field.crossings_ += bundle.crossings.size();
        for (std::size_t c = 0; c < bundle.ends.size(); ++c)
            field.lines_ += bundle.ends[c] > (c == 0 ? 0 : bundle.ends[c - 1]);
    }
    return field;
}

Vector<LightField::Arrival> LightField::arrivals(const glm::dvec3& eye, double aperture) const {
    Vector<Arrival> result;
    for (const Bundle& bundle : bundles_) {
        const lines::Bundle& b = bundle.lines;
        const glm::dvec3 from_corner = eye - b.corner;
        // A line lies anywhere in its cell.
        const auto cells = [&](const glm::dvec3& axis, std::uint32_t count) {
            const double at = glm::dot(from_corner, axis) / b.cell, half_width = aperture / b.cell;
            const double low = std::clamp(std::floor(at - half_width), 0.0, static_cast<double>(count));
            const double high = std::clamp(std::floor(at + half_width) + 1.0, 0.0, static_cast<double>(count));
            return std::pair(static_cast<std::size_t>(low), static_cast<std::size_t>(high));
        };
        // Parallel lines see the same place of the sky: the one nearest to the eye tells whether it is seen there.
        std::array<double, 2> nearest{kInfinity, kInfinity};
        std::array<bool, 2> sky{};
        const auto columns = cells(b.right, b.columns), rows = cells(b.up, b.rows);
        for (std::size_t row = rows.first; row < rows.second; ++row)
            for (std::size_t column = columns.first; column < columns.second; ++column) {
                const std::size_t cell = row * b.columns + column;
                const Line line = b.line(cell);
                const glm::dvec3 to_line = line.point - eye;
                const double here = -glm::dot(to_line, line.direction);
                const double offset = glm::length(to_line + here * line.direction);
                if (offset > aperture) continue;
                const std::size_t first = cell == 0 ? 0 : bundle.ends[cell - 1], last = bundle.ends[cell];
                std::size_t next = first;
                while (next < last && static_cast<double>(bundle.crossings[next].t) <= here) ++next;
                const auto arrive = [&](bool forward, bool any, std::size_t at) {
                    if (offset < nearest[forward]) nearest[forward] = offset, sky[forward] = !any;
                    // A line that first meets a back passes the eye within a solid, or behind a wall.
                    if (!any || bundle.crossings[at].front != forward) return;
                    const Crossing& crossing = bundle.crossings[at];
                    const glm::dvec3 point = to_line + static_cast<double>(crossing.t) * line.direction;
                    if (glm::dot(point, glm::dvec3(crossing.normal)) < 0.0)
                        result.push_back({point, glm::unpackHalf(crossing.light), false, offset});
                };
                arrive(true, next < last, next);
                arrive(false, next > first, next - 1);
            }
        for (const bool forward : {true, false})
            if (sky[forward]) result.push_back({forward ? b.direction : -b.direction, sky_, true, nearest[forward]});
    }
    return result;
}

Result<LightField::Drawn> LightField::draw(const Camera& camera, std::uint32_t width, std::uint32_t height,
                                           const DrawOptions& options) const {
    const auto rays = PictureRays::of(camera, width, height);
    if (!rays) return rays.error();
    if (bundles_.empty()) return fail(ErrorCode::empty, kNoItem, "light field: nothing was recorded");
    if (!(options.samples >= 1e-3 && options.samples <= 1e3) || options.blend < 1 || options.blend > options.hiders ||
        options.hiders > 64 || !(options.depth_step > 0.0))
        return fail(ErrorCode::out_of_range, kNoItem, "light field: draw options out of range");
    const std::size_t pixels = std::size_t{width} * height;
    const auto wanted = static_cast<std::size_t>(std::ceil(options.samples * static_cast<double>(pixels)));
    Vector<Sample> samples;
    double aperture = bundles_.front().lines.cell;
    for (;; aperture *= 2.0) {
        samples.clear();
        for (const Arrival& a : arrivals(camera.position, aperture)) {
            const auto at = rays->pixel_of(a.point);
            if (!at) continue;
            samples.push_back({at->x, at->y, a.sky ? kInfinity : glm::length(a.point), a.offset, a.light});
        }
        if (samples.size() >= wanted || aperture > diagonal_) break;
    }
    if (samples.empty())
        return fail(ErrorCode::empty, kNoItem, "light field: no line passes near the eye, within the picture");
    std::stable_sort(samples.begin(), samples.end(),
                     [](const Sample& a, const Sample& b) { return a.offset < b.offset; });
    samples.resize(std::min(samples.size(), wanted));
    Drawn drawn;
    drawn.aperture = samples.back().offset;
    drawn.samples = samples.size();
    drawn.picture = {width, height, Vector<glm::vec3>(pixels), Vector<double>(pixels)};
    const Buckets buckets(samples, width, height);
    Vector<Buckets::Near> near;
    // Pixels squared: four times what so many samples take on average.
    const double hiding =
        4.0 * options.hiders * static_cast<double>(pixels) / (std::numbers::pi * static_cast<double>(samples.size()));
    for (std::size_t p = 0; p < pixels; ++p) {
        buckets.nearest(static_cast<std::uint32_t>(p % width), static_cast<std::uint32_t>(p / width), options.hiders,
                        near);
        near.resize(std::min<std::size_t>(near.size(), options.hiders));
        double depth = samples[near[0].second].depth;
        for (const auto& [distance, i] : near)
            if (distance <= hiding) depth = std::min(depth, samples[i].depth);
        // Nearer ones count more; a pixel is about as wide as the samples' distance.
        glm::dvec3 sum(0.0);
        double weights = 0.0;
        std::uint32_t blended = 0;
        for (const auto& [distance, i] : near) {
            if (samples[i].depth > (1.0 + options.depth_step) * depth) continue;
            if (blended++ == options.blend) break;
            const double weight = 1.0 / (distance + 0.05);
            sum += weight * glm::dvec3(samples[i].light);
            weights += weight;
        }
        drawn.picture.pixels[p] = glm::vec3(sum / weights);
        drawn.picture.depths[p] = depth;
    }
    return drawn;
}

std::size_t LightField::bytes() const {
    std::size_t sum = sizeof(*this) + bundles_.capacity() * sizeof(Bundle);
    for (const Bundle& bundle : bundles_)
        sum += bundle.ends.capacity() * sizeof(std::uint32_t) + bundle.crossings.capacity() * sizeof(Crossing);
    return sum;
}

Result<LightPicture> direct_picture(const lines::LineTracer& scene, LightAt light, const glm::vec3& sky,
                                    const Camera& camera, std::uint32_t width, std::uint32_t height,
                                    Executor& executor) {
    const auto rays = PictureRays::of(camera, width, height);
    if (!rays) return rays.error();
    const std::size_t pixels = std::size_t{width} * height;
    LightPicture picture{width, height, Vector<glm::vec3>(pixels), Vector<double>(pixels, kInfinity)};
    executor.parallel_for(height, 8, [&](std::size_t begin, std::size_t end, unsigned) {
        Vector<lines::FirstHitQuery> queries(width);
        Vector<lines::Hit> hits(width);
        for (std::size_t row = begin; row < end; ++row) {
            for (std::uint32_t x = 0; x < width; ++x)
                queries[x].line = {camera.position, rays->direction(x + 0.5, static_cast<double>(row) + 0.5)};
            scene.first_hits(queries, hits);
            for (std::uint32_t x = 0; x < width; ++x) {
                const std::size_t p = row * width + x;
                picture.pixels[p] = sky;
                if (hits[x].triangle == lines::Hit::kNothing) continue;
                const glm::dvec3 way = static_cast<double>(hits[x].t) * queries[x].line.direction;
                picture.pixels[p] =
                    hits[x].front ? light(hits[x].triangle, camera.position + way).light : glm::vec3(0.0f);
                picture.depths[p] = glm::length(way);
            }
        }
    });
    return picture;
}

double relative_difference(const LightPicture& picture, const LightPicture& truth) {
    double apart = 0.0, sum = 0.0;
    for (std::size_t p = 0; p < truth.pixels.size(); ++p)
        for (int k = 0; k < 3; ++k) {
            apart += static_cast<double>(std::abs(picture.pixels[p][k] - truth.pixels[p][k]));
            sum += static_cast<double>(truth.pixels[p][k]);
        }
    return apart == 0.0 ? 0.0 : apart / sum;
}

}  // namespace crofton::study
