// SPDX-License-Identifier: MIT
#include "free_space.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "largest_region.hpp"

namespace crofton::pipeline {
namespace {

constexpr std::uint32_t kNotReached = ~0u;
// Shares of the eye's height: the highest step, room above the floor, half the width of who walks, the lower line.
constexpr std::uint64_t kMostTriangles = 8u << 20;  // of larger scenes nothing is found: lines would take gigabytes
constexpr double kStep = 0.7, kRoom = 1.3, kHalfWidth = 0.25, kKnee = 0.5;
// A straight way that leaves out places stays this near to them in height.
constexpr double kHeightTolerance = 0.25;
constexpr std::size_t kLongestStraight = 24;
// Directions that are tried from an eye, and eyes.
constexpr std::uint32_t kDirections = 256, kMostStands = 300;
constexpr int kHeadings = 24;
// What tells a level from a thing that stands in the open, measured on those of shared/data: of the level lines from
// all places 0.85 to 1 meet something in levels, 0.33 to 0.57 on things (1 within a horse that is inside out); of the
// ways 0.39 to 0.92 are level in levels, 0.22 within the horse.
constexpr double kSurrounded = 0.75, kLevel = 0.35, kLevelFloors = 0.3, kLevelSlope = 0.15;
// Share of lines that may meet a back: more, and the eye is within something solid.
constexpr double kMostBacks = 0.2;

// Evenly spread over the sphere.
glm::dvec3 direction_of(std::uint32_t i) {
    const double y = 1.0 - (2.0 * i + 1.0) / kDirections;
    const double ring = std::sqrt(1.0 - y * y), angle = i * std::numbers::pi * (3.0 - std::sqrt(5.0));
    return {ring * std::cos(angle), y, ring * std::sin(angle)};
}

std::uint32_t count_distinct(std::vector<std::uint32_t>& objects) {
    std::sort(objects.begin(), objects.end());
    return static_cast<std::uint32_t>(std::unique(objects.begin(), objects.end()) - objects.begin());
}

}  // namespace

FreeSpace::FreeSpace(pvs::Subject subject, lines::LineTracer tracer, const Aabb& focus)
    : subject_(std::move(subject)), tracer_(std::move(tracer)) {
    const glm::dvec3 size = focus.max - focus.min;
    size_ = std::hypot(size.x, size.z);
    eye_height_ = std::min(0.2 * std::max(size.y, 1e-3 * size.x), 0.01 * size_);
    spacing_ = std::max(size.x, size.z) / kColumns;
}

std::optional<FreeSpace> FreeSpace::find(const scene::Scene& scene, const Aabb& focus) {
    if (focus.is_empty()) return std::nullopt;
    std::uint64_t triangles = 0;
    for (scene::InstanceId i = 0; i < scene.instance_count(); ++i)
        if (!scene.is_removed(i)) triangles += scene.mesh(scene.mesh_of(i)).triangle_count();
    if (triangles > kMostTriangles) return std::nullopt;
    auto subject = pvs::subject_of(scene);
    if (!subject) return std::nullopt;
    auto tracer = lines::LineTracer::build(subject->mesh);
    if (!tracer) return std::nullopt;
    FreeSpace space(std::move(*subject), std::move(*tracer), focus);
    if (!(space.eye_height_ > 0.0)) return std::nullopt;
    space.find_places(focus);
    if (space.places_.empty()) return std::nullopt;
    space.keep_largest_region();
    return space;
}

void FreeSpace::find_places(const Aabb& focus) {
    const auto along = [&](double length) {
        return std::clamp(static_cast<std::uint32_t>(length / spacing_), 1u, kColumns);
    };
    columns_ = {along(focus.max.x - focus.min.x), along(focus.max.z - focus.min.z)};
    const double top = tracer_.bounds().max.y + 1.0;
    std::vector<Line> lines;
    for (std::uint32_t z = 0; z < columns_.y; ++z)
        for (std::uint32_t x = 0; x < columns_.x; ++x) {
            const glm::dvec3 at(focus.min.x + (x + 0.5) / columns_.x * (focus.max.x - focus.min.x), 0.0,
                                focus.min.z + (z + 0.5) / columns_.y * (focus.max.z - focus.min.z));
            lines.push_back({glm::dvec3(at.x - subject_.origin.x, top, at.z - subject_.origin.z), {0.0, -1.0, 0.0}});
        }
    lines::LineHits found;
    tracer_.all_hits(lines, found);
    std::uint32_t begin = 0;
    for (std::uint32_t column = 0; column < lines.size(); ++column) {
        first_of_column_.push_back(static_cast<std::uint32_t>(places_.size()));
        const auto hits = std::span(found.hits).subspan(begin, found.ends[column] - begin);
        for (std::size_t i = 0; i < hits.size(); ++i) {
            const double t = static_cast<double>(hits[i].t);
            const double room = i == 0 ? kRoom * eye_height_ : t - static_cast<double>(hits[i - 1].t);
            if (!hits[i].front || room < kRoom * eye_height_) continue;
            const glm::dvec3 eye = lines[column].point + glm::dvec3(0.0, eye_height_ - t, 0.0) + subject_.origin;
            if (eye.y < focus.min.y || eye.y > focus.max.y + 2.0 * eye_height_) continue;
            places_.push_back(eye);
            column_of_.push_back(column);
        }
        begin = found.ends[column];
    }
    first_of_column_.push_back(static_cast<std::uint32_t>(places_.size()));
    ways_.resize(places_.size());
    for (std::uint32_t place = 0; place < places_.size(); ++place)
        for (const std::uint32_t other : neighbours_of(place))
            if (other > place && is_free(places_[place], places_[other])) {
                ways_[place].push_back(other);
                ways_[other].push_back(place);
            }
}

// In the eight columns around, no more than a step higher or lower.
std::vector<std::uint32_t> FreeSpace::neighbours_of(std::uint32_t place) const {
    std::vector<std::uint32_t> result;
    const auto x = static_cast<int>(column_of_[place] % columns_.x),
               z = static_cast<int>(column_of_[place] / columns_.x);
    for (int dz = -1; dz <= 1; ++dz)
        for (int dx = -1; dx <= 1; ++dx) {
            const int nx = x + dx, nz = z + dz;
            if ((dx == 0 && dz == 0) || nx < 0 || nz < 0 || nx >= static_cast<int>(columns_.x) ||
                nz >= static_cast<int>(columns_.y))
                continue;
            const auto column = static_cast<std::uint32_t>(nz) * columns_.x + static_cast<std::uint32_t>(nx);
            for (std::uint32_t other = first_of_column_[column]; other < first_of_column_[column + 1]; ++other)
                if (std::abs(places_[other].y - places_[place].y) <= kStep * eye_height_) result.push_back(other);
        }
    return result;
}

bool FreeSpace::is_free(const glm::dvec3& from, const glm::dvec3& to) const {
    const double length = glm::distance(from, to);
    if (!(length > 0.0)) return true;
    const glm::dvec3 along = (to - from) / length;
    const glm::dvec3 across(-along.z, 0.0, along.x);
    const double half = kHalfWidth * eye_height_ / std::max(glm::length(across), 1e-6);
    std::array<lines::FirstHitQuery, 4> queries;
    std::array<lines::Hit, 4> hits;
    const std::array<glm::dvec3, 4> offsets{glm::dvec3(0.0), half * across, -half * across,
                                            glm::dvec3(0.0, -kKnee * eye_height_, 0.0)};
    for (std::size_t i = 0; i < offsets.size(); ++i) queries[i].line = {from - subject_.origin + offsets[i], along};
    tracer_.first_hits(queries, hits);
    return std::all_of(hits.begin(), hits.end(), [&](const lines::Hit& hit) {
        return hit.triangle == lines::Hit::kNothing || static_cast<double>(hit.t) > 1.001 * length;
    });
}

std::vector<std::uint32_t> FreeSpace::steps_from(std::uint32_t place, std::vector<std::uint32_t>& order) const {
    std::vector<std::uint32_t> steps(places_.size(), kNotReached);
    order.assign(1, place);
    steps[place] = 0;
    for (std::size_t next = 0; next < order.size(); ++next)
        for (const std::uint32_t other : ways_[order[next]])
            if (steps[other] == kNotReached) {
                steps[other] = steps[order[next]] + 1;
                order.push_back(other);
            }
    return steps;
}

void FreeSpace::keep_largest_region() {
    const std::vector<std::uint32_t> best = largest_region(places_, ways_);
    std::vector<std::uint32_t> now(places_.size(), kNotReached);
    for (std::size_t i = 0; i < best.size(); ++i) now[best[i]] = static_cast<std::uint32_t>(i);
    std::vector<glm::dvec3> places;
    std::vector<std::vector<std::uint32_t>> ways;
    for (const std::uint32_t old : best) {
        places.push_back(places_[old]);
        ways.emplace_back();
        for (const std::uint32_t other : ways_[old]) ways.back().push_back(now[other]);
    }
    places_.swap(places);
    ways_.swap(ways);
    column_of_.clear();
    first_of_column_.clear();
}

bool FreeSpace::is_straight(std::span<const std::uint32_t> way) const {
    const glm::dvec3 &from = places_[way.front()], &to = places_[way.back()];
    const double length = std::hypot(to.x - from.x, to.z - from.z);
    for (const std::uint32_t place : way) {
        const glm::dvec3& p = places_[place];
        const double share = length > 0.0 ? std::hypot(p.x - from.x, p.z - from.z) / length : 0.0;
        if (std::abs(p.y - (from.y + share * (to.y - from.y))) > kHeightTolerance * eye_height_) return false;
    }
    return is_free(from, to);
}

std::vector<glm::dvec3> FreeSpace::walk() const {
    if (places_.size() < 2) return {};
    std::vector<std::uint32_t> order;
    steps_from(0, order);
    const std::uint32_t start = order.back();
    const std::vector<std::uint32_t> steps = steps_from(start, order);
    std::vector<std::uint32_t> way{order.back()};
    while (way.back() != start)
        way.push_back(*std::min_element(ways_[way.back()].begin(), ways_[way.back()].end(),
                                        [&](std::uint32_t a, std::uint32_t b) { return steps[a] < steps[b]; }));
    std::vector<glm::dvec3> walk{places_[way[0]]};
    for (std::size_t i = 0; i + 1 < way.size();) {
        std::size_t next = std::min(i + kLongestStraight, way.size() - 1);
        while (next > i + 1 && !is_straight(std::span(way).subspan(i, next - i + 1))) --next;
        walk.push_back(places_[way[next]]);
        i = next;
    }
    return walk;
}

FreeSpace::Sight FreeSpace::look_around(const glm::dvec3& eye) const {
    std::vector<lines::FirstHitQuery> queries(kDirections);
    Sight sight;
    sight.hits.resize(kDirections);
    for (std::uint32_t i = 0; i < kDirections; ++i) queries[i].line = {eye - subject_.origin, direction_of(i)};
    tracer_.first_hits(queries, sight.hits);
    std::vector<std::uint32_t> objects;
    double level = 0.0, level_hits = 0.0;
    for (std::uint32_t i = 0; i < kDirections; ++i) {
        const bool hit = sight.hits[i].triangle != lines::Hit::kNothing;
        const bool is_level = std::abs(direction_of(i).y) < kLevel;
        level += is_level ? 1.0 : 0.0;
        level_hits += is_level && hit ? 1.0 : 0.0;
        if (!hit) continue;
        sight.backs += sight.hits[i].front ? 0.0 : 1.0 / kDirections;
        objects.push_back(subject_.object_of[sight.hits[i].triangle]);
    }
    sight.surrounded = level_hits / level;
    sight.objects = count_distinct(objects);
    return sight;
}

// Level, where most objects are and the view is long.
glm::dvec3 FreeSpace::best_heading(const Sight& sight) const {
    glm::dvec3 result(0.0);
    double best = -1.0;
    std::vector<std::uint32_t> objects;
    for (int heading = 0; heading < kHeadings; ++heading) {
        const double angle = 2.0 * std::numbers::pi * heading / kHeadings;
        const glm::dvec3 forward(std::sin(angle), 0.0, -std::cos(angle));
        objects.clear();
        double openness = 0.0;
        for (std::uint32_t i = 0; i < kDirections; ++i) {
            const lines::Hit& hit = sight.hits[i];
            if (glm::dot(direction_of(i), forward) < 0.75 || hit.triangle == lines::Hit::kNothing) continue;
            objects.push_back(subject_.object_of[hit.triangle]);
            openness += std::min(static_cast<double>(hit.t) / size_, 1.0) / kDirections;
        }
        const double worth = count_distinct(objects) + 20.0 * openness;
        if (worth <= best) continue;
        best = worth;
        result = forward;
    }
    return result;
}

double FreeSpace::level_share() const {
    std::size_t ways = 0, level = 0;
    for (std::uint32_t place = 0; place < places_.size(); ++place)
        for (const std::uint32_t other : ways_[place]) {
            ++ways;
            level += std::abs(places_[other].y - places_[place].y) < kLevelSlope * spacing_ ? 1 : 0;
        }
    return ways > 0 ? static_cast<double>(level) / static_cast<double>(ways) : 0.0;
}

std::optional<Stand> FreeSpace::best_stand() const {
    if (level_share() < kLevelFloors) return std::nullopt;
    const std::size_t step = std::max<std::size_t>(1, places_.size() / kMostStands);
    std::optional<Sight> best;
    glm::dvec3 eye(0.0);
    double surrounded = 0.0, tried = 0.0;
    for (std::size_t i = 0; i < places_.size(); i += step) {
        Sight sight = look_around(places_[i]);
        surrounded += sight.surrounded;
        tried += 1.0;
        if (sight.backs > kMostBacks || (best && best->objects >= sight.objects)) continue;
        best = std::move(sight);
        eye = places_[i];
    }
    if (!best || surrounded < kSurrounded * tried) return std::nullopt;
    return Stand{eye, best_heading(*best), best->objects};
}

}  // namespace crofton::pipeline
