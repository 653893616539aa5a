// SPDX-License-Identifier: MIT
#include "free_space.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <iterator>
#include <numbers>

#include "largest_region.hpp"

namespace crofton::pipeline {
namespace {

constexpr std::uint32_t kNotReached = ~0u;
constexpr std::uint64_t kMostTriangles = 8u << 20;  // of larger scenes nothing is found: lines would take gigabytes
// Shares of the eye's height: the highest step, room above the floor, half the width of who walks, the lower line.
constexpr double kStep = 0.7, kRoom = 1.02, kHalfWidth = 0.15, kKnee = 0.5;
// Longer ways than this, in eye heights, follow the floor in pieces; no more than so many, and none steeper.
constexpr double kLongWay = 2.0, kPiece = 1.5, kSteepest = 0.8;
constexpr int kMostPieces = 12;
// Where a person walks columns are this far apart if there are not too many.
constexpr double kPersonSpacing = 0.5;
// The value of a place: under a roof, under the sky, within a closed object, on a closed object with nothing around.
constexpr float kUnderRoof = 4.0f, kUnderSky = 1.0f, kWithin = 0.05f, kOnBareRoof = 0.001f;
// A roof is bare where fewer level lines meet something; within a thing most do.
constexpr double kBare = 0.35, kClosed = 0.75;
constexpr int kLevelLines = 12;
// A person needs a plan this long to walk on in the open, in eye heights. Where the unit is unknown, half of the rooms
// and houses are lower than this, in metres, and the plan is not longer.
constexpr double kLeastPlan = 2.4, kHighestRoom = 60.0, kLongestPlan = 50'000.0;
// A straight way that leaves out places stays this near to them in height.
constexpr double kHeightTolerance = 0.25;
constexpr std::size_t kLongestStraight = 24;
// How high a person's eye is in a room of three metres.
constexpr double kEyeOfRoom = FreeSpace::kPersonEye / 3.0;
// Directions that are tried from an eye, and eyes.
constexpr std::uint32_t kDirections = 256, kMostStands = 300;
constexpr int kHeadings = 24;
// Tell a level from an object in the open, as measured on the scenes of shared/data. Of the horizontal lines from all
// places, 0.85 to 1 hit something in levels, and 0.33 to 0.57 on objects (1 within a horse that is inside out). Of the
// ways, 0.39 to 0.92 are level in levels, and 0.22 within the horse.
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

FreeSpace::FreeSpace(pvs::BakeGeometry geometry, lines::LineTracer tracer, const Aabb& focus)
    : geometry_(std::move(geometry)), tracer_(std::move(tracer)) {
    const glm::dvec3 size = focus.max - focus.min;
    size_ = std::hypot(size.x, size.z);
}

std::optional<FreeSpace> FreeSpace::find(const scene::Scene& scene, const Aabb& focus,
                                         const FreeSpaceOptions& options) {
    if (focus.is_empty()) return std::nullopt;
    std::uint64_t triangles = 0;
    for (scene::InstanceId i = 0; i < scene.instance_count(); ++i)
        if (!scene.is_removed(i)) triangles += scene.mesh(scene.mesh_of(i)).triangle_count();
    if (triangles > kMostTriangles) return std::nullopt;
    auto geometry = pvs::geometry_of(scene);
    if (!geometry) return std::nullopt;
    auto tracer = lines::LineTracer::build(geometry->mesh);
    if (!tracer) return std::nullopt;
    FreeSpace space(std::move(*geometry), std::move(*tracer), focus);
    const glm::dvec3 size = focus.max - focus.min;
    const double share = std::min(0.2 * std::max(size.y, 1e-3 * size.x), 0.01 * space.size_);
    const bool is_known = options.unit > 0.0;
    if (space.find_places_of_a_person(focus, options, is_known ? options.unit : 1.0)) return space;
    if (!is_known && !space.is_indoors())  // rooms tell the eye's height better than a unit does
        for (const double unit : {0.01, 0.001})
            if (space.find_places_of_a_person(focus, options, unit)) return space;
    if (!(share > 0.0) || !space.find_places(focus, options, share)) return std::nullopt;
    const double room = space.median_room();
    if (!space.is_indoors() || kEyeOfRoom * room <= share) return space;
    if (space.find_places(focus, options, kEyeOfRoom * room))
        space.room_height_ = room;
    else
        space.find_places(focus, options, share);
    return space;
}

// The hits of a vertical line, from above.
struct FreeSpace::Column {
    std::uint32_t number;
    glm::dvec3 top;  // where the line begins
    std::span<const lines::Hit> hits;

    [[nodiscard]] double depth(std::size_t i) const { return static_cast<double>(hits[i].t); }
};

bool FreeSpace::find_places_of_a_person(const Aabb& focus, const FreeSpaceOptions& options, double unit) {
    unit_ = unit;
    if (find_places(focus, options, kPersonEye / unit) && fits_a_person(focus, options)) return true;
    unit_ = 0.0;
    return false;
}

bool FreeSpace::find_places(const Aabb& focus, const FreeSpaceOptions& options, double eye_height) {
    eye_height_ = eye_height;
    const double longer = std::max(focus.max.x - focus.min.x, focus.max.z - focus.min.z);
    const double wanted = std::ceil(longer * unit_ / kPersonSpacing);
    const auto most = static_cast<std::uint32_t>(std::clamp(wanted, double{kColumns}, double{kMostColumns}));
    spacing_ = longer / most;
    const auto along = [&](double length) {
        return spacing_ > 0.0 ? std::clamp(static_cast<std::uint32_t>(length / spacing_), 1u, most) : 1u;
    };
    columns_ = {along(focus.max.x - focus.min.x), along(focus.max.z - focus.min.z)};
    const double top = tracer_.bounds().max.y + 1.0;
    std::vector<Line> lines;
    for (std::uint32_t z = 0; z < columns_.y; ++z)
        for (std::uint32_t x = 0; x < columns_.x; ++x) {
            const glm::dvec3 at(focus.min.x + (x + 0.5) / columns_.x * (focus.max.x - focus.min.x), 0.0,
                                focus.min.z + (z + 0.5) / columns_.y * (focus.max.z - focus.min.z));
            lines.push_back({glm::dvec3(at.x - geometry_.origin.x, top, at.z - geometry_.origin.z), {0.0, -1.0, 0.0}});
        }
    lines::LineHits found;
    tracer_.all_hits(lines, found);
    places_.clear();
    worth_.clear();
    room_.clear();
    column_of_.clear();
    first_of_column_.clear();
    std::uint32_t begin = 0;
    for (std::uint32_t number = 0; number < lines.size(); ++number) {
        first_of_column_.push_back(static_cast<std::uint32_t>(places_.size()));
        add_places({number, lines[number].point, std::span(found.hits).subspan(begin, found.ends[number] - begin)},
                   focus, options);
        begin = found.ends[number];
    }
    first_of_column_.push_back(static_cast<std::uint32_t>(places_.size()));
    if (places_.empty()) return false;
    connect_places();
    find_edges_of_roofs();
    house_height_ = median_room();
    keep_best_region();
    return true;
}

void FreeSpace::add_places(const Column& column, const Aabb& focus, const FreeSpaceOptions& options) {
    const double least = kRoom * eye_height_;
    double widest_below = 0.0;
    for (std::size_t i = 1; i < column.hits.size(); ++i)
        if (!column.hits[i - 1].front || !column.hits[i].front)  // else two sheets, one over the other
            widest_below = std::max(widest_below, column.depth(i) - column.depth(i - 1));
    for (std::size_t i = 0; i < column.hits.size(); ++i) {
        const bool covered = i > 0, back = !column.hits[i].front;
        // Below what faces up, or above what faces down, is the inside of something closed.
        const bool is_within = covered && (back || column.hits[i - 1].front);
        const double room = covered ? column.depth(i) - column.depth(i - 1) : HUGE_VAL;
        if (room < least || (back && !covered)) continue;
        const glm::dvec3 eye = column.top + glm::dvec3(0.0, eye_height_ - column.depth(i), 0.0) + geometry_.origin;
        if (eye.y < focus.min.y || eye.y > focus.max.y + 2.0 * eye_height_) continue;
        if (!options.within.is_empty() &&
            (glm::any(glm::lessThan(eye, options.within.min)) || glm::any(glm::greaterThan(eye, options.within.max))))
            continue;
        float worth = covered ? kUnderRoof : kUnderSky;
        if (is_within) {
            const bool is_closed = surrounded_share(eye) >= kClosed;
            if (back && !is_closed) continue;
            worth = is_closed ? kWithin : kUnderSky;
        } else if (!covered && widest_below >= least && surrounded_share(eye) < kBare) {
            worth = kOnBareRoof;
        }
        places_.push_back(eye);
        worth_.push_back(worth);
        room_.push_back(static_cast<float>(room));
        column_of_.push_back(column.number);
    }
}

void FreeSpace::connect_places() {
    ways_.assign(places_.size(), {});
    std::vector<glm::dvec3> between;
    for (std::uint32_t place = 0; place < places_.size(); ++place)
        for (const std::uint32_t other : neighbours_of(place))
            if (other > place && follow_floor(places_[place], places_[other], between)) {
                ways_[place].push_back(other);
                ways_[other].push_back(place);
            }
}

// Where most places that hang together are on a bare roof, those under the sky are so too: there the closed thing is
// too thin to be told by its inside.
void FreeSpace::find_edges_of_roofs() {
    std::vector<std::uint8_t> seen(places_.size(), 0);
    std::vector<std::uint32_t> region;
    for (std::uint32_t first = 0; first < places_.size(); ++first) {
        if (seen[first] != 0) continue;
        region.assign(1, first);
        seen[first] = 1;
        std::size_t bare = 0;
        for (std::size_t next = 0; next < region.size(); ++next) {
            bare += worth_[region[next]] == kOnBareRoof;
            for (const std::uint32_t other : ways_[region[next]])
                if (seen[other] == 0) {
                    seen[other] = 1;
                    region.push_back(other);
                }
        }
        if (2 * bare < region.size()) continue;
        for (const std::uint32_t place : region)
            if (worth_[place] == kUnderSky) worth_[place] = kOnBareRoof;
    }
}

double FreeSpace::surrounded_share(const glm::dvec3& eye) const {
    std::array<lines::FirstHitQuery, kLevelLines> queries;
    std::array<lines::Hit, kLevelLines> hits;
    for (std::size_t i = 0; i < queries.size(); ++i) {
        const double angle = 2.0 * std::numbers::pi * (static_cast<double>(i) + 0.37) / kLevelLines;
        queries[i].line = {eye - geometry_.origin, {std::sin(angle), 0.0, std::cos(angle)}};
    }
    tracer_.first_hits(queries, hits);
    const auto met = std::count_if(hits.begin(), hits.end(),
                                   [](const lines::Hit& hit) { return hit.triangle != lines::Hit::kNothing; });
    return static_cast<double>(met) / kLevelLines;
}

bool FreeSpace::is_indoors() const {
    const auto roofed = std::count_if(room_.begin(), room_.end(), [](float room) { return std::isfinite(room); });
    return 2 * static_cast<std::size_t>(roofed) > places_.size();
}

double FreeSpace::median_room() const {
    std::vector<float> rooms;
    std::copy_if(room_.begin(), room_.end(), std::back_inserter(rooms), [](float room) { return std::isfinite(room); });
    if (rooms.empty()) return 0.0;
    std::nth_element(rooms.begin(), rooms.begin() + static_cast<std::ptrdiff_t>(rooms.size() / 2), rooms.end());
    return static_cast<double>(rooms[rooms.size() / 2]);
}

// Whether a person would walk there: not on the roof of something closed, nor on a thing that is smaller than a person.
bool FreeSpace::fits_a_person(const Aabb& focus, const FreeSpaceOptions& options) const {
    if (*std::max_element(worth_.begin(), worth_.end()) <= kOnBareRoof) return false;
    const double longer = std::max(focus.max.x - focus.min.x, focus.max.z - focus.min.z);
    if (!is_indoors() && longer < kLeastPlan * eye_height_) return false;
    if (options.unit > 0.0) return true;
    const double room = (is_indoors() ? median_room() : house_height_) * unit_;
    if (unit_ != 1.0 && room == 0.0) return false;  // without a house nothing tells the unit
    return longer * unit_ <= kLongestPlan && room <= kHighestRoom;
}

// In the eight columns around, no more than a step higher or lower; on long ways the floor may climb.
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
            for (std::uint32_t other = first_of_column_[column]; other < first_of_column_[column + 1]; ++other) {
                const glm::dvec3 way = places_[other] - places_[place];
                const double length = std::hypot(way.x, way.z);
                const double climb = length > kLongWay * eye_height_ ? kSteepest * length : 0.0;
                if (std::abs(way.y) <= std::max(kStep * eye_height_, climb)) result.push_back(other);
            }
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
    for (std::size_t i = 0; i < offsets.size(); ++i) queries[i].line = {from - geometry_.origin + offsets[i], along};
    tracer_.first_hits(queries, hits);
    return std::all_of(hits.begin(), hits.end(), [&](const lines::Hit& hit) {
        return hit.triangle == lines::Hit::kNothing || static_cast<double>(hit.t) > 1.001 * length;
    });
}

double FreeSpace::distance_to_thing(const glm::dvec3& eye, const glm::dvec3& direction) const {
    lines::FirstHitQuery query;
    query.line = {eye - geometry_.origin, direction};
    lines::Hit hit;
    tracer_.first_hits({&query, 1}, {&hit, 1});
    return hit.triangle == lines::Hit::kNothing ? HUGE_VAL : static_cast<double>(hit.t);
}

glm::dvec3 FreeSpace::over_floor(const glm::dvec3& eye) const {
    const double floor = distance_to_thing(eye, {0.0, -1.0, 0.0});
    if (!std::isfinite(floor)) return eye;
    const double up = eye_height_ - floor;
    const double most = up > 0.0 ? distance_to_thing(eye, {0.0, 1.0, 0.0}) : HUGE_VAL;
    return eye + glm::dvec3(0.0, up < most ? up : 0.5 * most, 0.0);
}

bool FreeSpace::follow_floor(const glm::dvec3& from, const glm::dvec3& to, std::vector<glm::dvec3>& between) const {
    between.clear();
    const double length = std::hypot(to.x - from.x, to.z - from.z);
    if (length <= kLongWay * eye_height_) return is_free(from, to);
    const int pieces = std::min(kMostPieces, static_cast<int>(std::ceil(length / (kPiece * eye_height_))));
    const double climb = std::max(kStep * eye_height_, kSteepest * length / pieces);
    glm::dvec3 last = from;
    for (int k = 1; k <= pieces; ++k) {
        glm::dvec3 next = glm::mix(from, to, static_cast<double>(k) / pieces);
        next.y = last.y;
        const double above = distance_to_thing(next, {0.0, 1.0, 0.0});
        next.y += std::min(climb, 0.5 * above);
        const double floor = distance_to_thing(next, {0.0, -1.0, 0.0});
        next.y += eye_height_ - floor;
        if (!(std::abs(next.y - last.y) <= climb) || !is_free(last, next)) return false;
        if (k == pieces) return std::abs(next.y - to.y) <= kHeightTolerance * eye_height_;
        between.push_back(next);
        last = next;
    }
    return true;
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

void FreeSpace::keep_best_region() {
    const std::vector<std::uint32_t> best = largest_region(places_, ways_, worth_);
    std::vector<std::uint32_t> now(places_.size(), kNotReached);
    for (std::size_t i = 0; i < best.size(); ++i) now[best[i]] = static_cast<std::uint32_t>(i);
    std::vector<glm::dvec3> places;
    std::vector<std::vector<std::uint32_t>> ways;
    std::vector<float> worth, room;
    for (const std::uint32_t old : best) {
        places.push_back(places_[old]);
        worth.push_back(worth_[old]);
        room.push_back(room_[old]);
        ways.emplace_back();
        for (const std::uint32_t other : ways_[old]) ways.back().push_back(now[other]);
    }
    places_.swap(places);
    worth_.swap(worth);
    room_.swap(room);
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
    if (places_.size() < 2) return places_;
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
        // The way was tried from the lower number to the higher one.
        std::vector<glm::dvec3> between;
        if (next == i + 1 && way[i] < way[next]) {
            follow_floor(places_[way[i]], places_[way[next]], between);
        } else if (next == i + 1) {
            follow_floor(places_[way[next]], places_[way[i]], between);
            std::reverse(between.begin(), between.end());
        }
        walk.insert(walk.end(), between.begin(), between.end());
        walk.push_back(places_[way[next]]);
        i = next;
    }
    return walk;
}

FreeSpace::Sight FreeSpace::look_around(const glm::dvec3& eye) const {
    std::vector<lines::FirstHitQuery> queries(kDirections);
    Sight sight;
    sight.hits.resize(kDirections);
    for (std::uint32_t i = 0; i < kDirections; ++i) queries[i].line = {eye - geometry_.origin, direction_of(i)};
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
        objects.push_back(geometry_.object_of[sight.hits[i].triangle]);
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
            objects.push_back(geometry_.object_of[hit.triangle]);
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
