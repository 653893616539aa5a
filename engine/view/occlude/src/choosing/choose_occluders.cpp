// SPDX-License-Identifier: MIT
// choose_occluders: the occluders that hide most in a view.
#include <algorithm>
#include <bit>
#include <cmath>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/finite.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <span>
#include <string>

#include "choosing/candidate_storage.hpp"
#include "choosing/choose_kernel.hpp"
#include "choosing/large_worth.hpp"
#include "exact_turn.hpp"

namespace crofton::occlude {
namespace {

constexpr double kMostCoordinate = 1e15;
constexpr std::uint64_t kSpare = 32;  // sorted beyond the budget

ChooseView choose_view_of(const glm::dvec3& origin, const OcclusionView& given, const ChooseBudget& budget) {
    ChooseView view;
    const auto row = [&](std::size_t r) { return glm::dvec3(given.rows[r][0], given.rows[r][1], given.rows[r][2]); };
    const glm::dvec3 eye = given.origin - origin, forward = -row(3);
    const Frustum& frustum = given.frustum;
    view.plane_count = std::min<std::size_t>(frustum.plane_count, view.planes.size());
    for (std::size_t p = 0; p < view.plane_count; ++p) {
        const Plane& plane = frustum.planes[p];
        for (int k = 0; k < 3; ++k) view.planes[p][static_cast<std::size_t>(k)] = static_cast<float>(plane.normal[k]);
        view.planes[p][3] = static_cast<float>(plane.offset + glm::dot(plane.normal, given.origin - frustum.origin));
    }
    view.perspective = given.perspective;
    // The window is 2 units wide and high.
    const double whole = given.perspective ? 4.0 * std::numbers::pi : 4.0 / glm::length(glm::cross(row(0), row(1)));
    view.scale = static_cast<float>(1.0 / whole);
    view.large_square = given.perspective ? 0.0f : static_cast<float>(whole / 64.0);
    view.least = std::max(budget.least_cover, 1e-30f);
    view.bounded = !budget.objects.is_empty();
    for (int k = 0; k < 3; ++k) {
        const auto i = static_cast<std::size_t>(k);
        view.eye[i] = static_cast<float>(eye[k]);
        view.forward[i] = static_cast<float>(forward[k]);
        view.low[i] = static_cast<float>(budget.objects.min[k] - origin[k]);
        view.high[i] = static_cast<float>(budget.objects.max[k] - origin[k]);
    }
    return view;
}

// Sorted by worth, then by id: 32 bits of each in a key, the larger worth as the smaller number. Bits of
// positive floats are ordered as the floats are.
std::uint64_t key_of(float worth, std::uint32_t id) {
    return std::uint64_t{~std::bit_cast<std::uint32_t>(worth)} << 32 | id;
}

// The point of the box that is nearest to `p`.
glm::dvec3 nearest_in(const Aabb& box, const glm::dvec3& p) {
    return glm::clamp(p, box.min, box.max);
}

// A direction across the mesh's sides of axis k, along which this axis rises: right in each component, however sheared
// the mesh stands. A transform that flattens has none: NaN.
glm::dvec3 rising_across(const glm::dmat3& linear, int turn, int k) {
    if (turn == 0) return glm::dvec3(std::numeric_limits<double>::quiet_NaN());
    return static_cast<double>(turn) * direction_across(linear[(k + 1) % 3], linear[(k + 2) % 3]);
}

// The plane at right angles to `normal` through translation + along. What an eye far away makes of the normal's
// rounding, may_use() takes off. What rounding does to the offset is taken off generously. No eye is beyond a plane of
// NaN.
Plane side_through(const glm::dvec3& translation, const glm::dvec3& along, const glm::dvec3& normal) {
    Plane plane;
    plane.normal = normal;
    plane.offset = -glm::dot(normal, translation + along) -
                   0x1p-40 * glm::dot(glm::abs(normal), glm::abs(translation) + glm::abs(along));
    return plane;
}

// Whether a box along the axes stays one.
bool is_along_axes(const glm::dmat3& linear) {
    int zeros = 0;
    for (int k = 0; k < 3; ++k)
        for (int i = 0; i < 3; ++i) zeros += linear[k][i] == 0.0;
    return zeros >= 6;
}

// Whether the eye is more than `room` beyond the plane, whatever rounding did.
bool is_beyond(const Plane& plane, const glm::dvec3& eye, double room) {
    const double error_bound =
        0x1p-48 * glm::dot(glm::abs(plane.normal), glm::abs(eye)) + room * glm::length(plane.normal);
    return glm::dot(plane.normal, eye) + plane.offset >= error_bound;
}

EyeLimits limits_of(const FoundOccluder& found, const Transform& transform) {
    EyeLimits limits;
    const Aabb& piece = found.piece_bounds;
    for (unsigned i = 0; i < 8; ++i)
        limits.left_out_within.include(transform * glm::dvec3((i & 1u) ? piece.max.x : piece.min.x,
                                                              (i & 2u) ? piece.max.y : piece.min.y,
                                                              (i & 4u) ? piece.max.z : piece.min.z));
    // Covers four roundings of numbers of these sizes.
    glm::dvec3 error_bound = glm::abs(transform.translation);
    for (int k = 0; k < 3; ++k)
        error_bound += glm::abs(transform.linear[k]) * std::max(std::abs(piece.min[k]), std::abs(piece.max[k]));
    limits.left_out_within.min -= 0x1p-49 * error_bound;
    limits.left_out_within.max += 0x1p-49 * error_bound;
    const int turn = sign_of_determinant(transform.linear);
    const bool is_turned = !is_along_axes(transform.linear);
    for (int k = 0; k < 3; ++k) {
        const double eyes_from = found.eyes_within.min[k], eyes_to = found.eyes_within.max[k];
        if (!is_turned && std::isinf(eyes_from) && std::isinf(eyes_to)) continue;
        const glm::dvec3 rising = rising_across(transform.linear, turn, k);
        const auto side = [&](double at, const glm::dvec3& normal) {
            return side_through(transform.translation, at * transform.linear[k], normal);
        };
        if (!std::isinf(eyes_to)) limits.planes[limits.plane_count++] = side(eyes_to, -rising);
        if (!std::isinf(eyes_from)) limits.planes[limits.plane_count++] = side(eyes_from, rising);
        if (!is_turned) continue;
        limits.piece_sides[limits.piece_side_count++] = side(piece.max[k], rising);
        limits.piece_sides[limits.piece_side_count++] = side(piece.min[k], -rising);
    }
    return limits;
}

}  // namespace

OccluderCandidate candidate_of(const Obb& box) {
    OccluderCandidate result;
    result.center = box.center;
    const glm::dvec3 half(box.half_extents);
    for (int k = 0; k < 3; ++k)
        result.areas[static_cast<std::size_t>(k)] =
            box.axes[k] * (4.0f * box.half_extents[(k + 1) % 3] * box.half_extents[(k + 2) % 3]);
    double square = 0.0;
    for (const glm::dvec3& corner : corners(box))
        square = std::max(square, glm::dot(corner - box.center, corner - box.center));
    result.radius = std::sqrt(square);
    for (int k = 0; k < 3; ++k) result.half_size += glm::abs(box.axes[k]) * box.half_extents[k];
    return result;
}

namespace {

void set_areas_of_box(const Obb& box, const Transform& transform, OccluderCandidate& result) {
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const glm::dvec3 u = transform.linear * glm::dvec3(box.axes[i] * box.half_extents[i]),
                         v = transform.linear * glm::dvec3(box.axes[j] * box.half_extents[j]);
        result.areas[static_cast<std::size_t>(k)] = glm::vec3(4.0 * glm::cross(u, v));
    }
}

void set_areas_of_surface(const FoundOccluder& found, const Transform& transform, OccluderCandidate& result) {
    const TriangleMesh& mesh = found.surface;
    double area = 0.0;
    glm::dvec3 normals(0.0), shadows(0.0);
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const glm::dvec3 a = transform.linear * glm::dvec3(mesh.positions[mesh.indices[i]]),
                         b = transform.linear * glm::dvec3(mesh.positions[mesh.indices[i + 1]]),
                         c = transform.linear * glm::dvec3(mesh.positions[mesh.indices[i + 2]]);
        const glm::dvec3 normal = 0.5 * glm::cross(b - a, c - a);
        normals += normal;
        shadows += 0.5 * glm::abs(normal);
        area += glm::length(normal);
    }
    if (found.kind == OccluderKind::convex) {
        for (int k = 0; k < 3; ++k) result.areas[static_cast<std::size_t>(k)][k] = static_cast<float>(area / 6.0);
        return;
    }
    // A reflection reverses the winding, and with it the sides that are drawn.
    if (sign_of_determinant(transform.linear) < 0) normals = -normals;
    const double mean = glm::length(normals);
    if (mean >= 0.9 * area) {
        result.areas[0] = glm::vec3(normals);
        // Parts that face away from the others are visible from behind those.
        result.front_only = found.sides == Sides::front && mean >= 0.999 * area;
        return;
    }
    for (int k = 0; k < 3; ++k) result.areas[static_cast<std::size_t>(k)][k] = static_cast<float>(shadows[k]);
}

}  // namespace

OccluderCandidate candidate_of(const FoundOccluder& found, const Transform& transform) {
    OccluderCandidate result;
    Aabb bounds;
    const TriangleMesh& mesh = found.surface;
    for (const glm::vec3& p : mesh.positions) bounds.include(transform * glm::dvec3(p));
    result.center = bounds.is_empty() ? transform.translation : bounds.center();
    double square = 0.0;
    for (const glm::vec3& p : mesh.positions) {
        const glm::dvec3 offset = transform * glm::dvec3(p) - result.center;
        square = std::max(square, glm::dot(offset, offset));
    }
    result.radius = std::sqrt(square);
    if (!bounds.is_empty()) result.half_size = glm::vec3(0.5 * (bounds.max - bounds.min));
    result.edges = found.edges;
    if (found.kind != OccluderKind::patch) result.limits = limits_of(found, transform);
    if (found.kind == OccluderKind::patch || found.kind == OccluderKind::convex)
        set_areas_of_surface(found, transform, result);
    else
        set_areas_of_box(found.box, transform, result);
    return result;
}

bool may_use(const EyeLimits& limits, const Camera& camera) {
    const auto view = occlusion_view_of(camera);
    return view && may_use(limits, *view);
}

namespace {

// What the occluder hides from the eye, the piece of `box` and `sides` hides too (EyeLimits).
bool is_clear_of(const Aabb& box, std::span<const Plane> sides, const OcclusionView& view) {
    if (box.is_empty()) return true;
    const glm::dvec3& eye = view.origin;
    if (view.perspective) {
        const double near_radius = (1.0 + 1e-9) * (view.near_radius + view.eye_error);
        const auto is_outside = [&](const Plane& side) { return is_beyond(side, eye, near_radius); };
        return glm::distance(nearest_in(box, eye), eye) > near_radius ||
               std::any_of(sides.begin(), sides.end(), is_outside);
    }
    const Plane& near_plane = view.frustum.planes[4];
    const glm::dvec3 &normal = near_plane.normal, &origin = view.frustum.origin;
    const glm::dvec3 nearest(normal.x > 0.0 ? box.min.x : box.max.x, normal.y > 0.0 ? box.min.y : box.max.y,
                             normal.z > 0.0 ? box.min.z : box.max.z);
    const double error_bound =
        0x1p-48 * (glm::dot(glm::abs(normal), glm::abs(nearest) + glm::abs(origin)) + std::abs(near_plane.offset));
    return glm::dot(normal, nearest - origin) + near_plane.offset >= error_bound;
}

bool is_inside_of(std::span<const Plane> planes, const OcclusionView& view) {
    const glm::dvec3 forward(-view.rows[3][0], -view.rows[3][1], -view.rows[3][2]);
    return std::all_of(planes.begin(), planes.end(), [&](const Plane& plane) {
        if (view.perspective) return is_beyond(plane, view.origin, view.eye_error);
        return glm::dot(forward, plane.normal) <= -0x1p-40 * glm::length(plane.normal);
    });
}

}  // namespace

bool may_use(const EyeLimits& limits, const OcclusionView& view) {
    return is_clear_of(limits.left_out_within, std::span(limits.piece_sides).first(limits.piece_side_count), view) &&
           is_inside_of(std::span(limits.planes).first(limits.plane_count), view);
}

OccluderCandidates::OccluderCandidates() : data_(Owner<Data>::make()) {}
OccluderCandidates::~OccluderCandidates() = default;
OccluderCandidates::OccluderCandidates(OccluderCandidates&&) noexcept = default;
OccluderCandidates& OccluderCandidates::operator=(OccluderCandidates&&) noexcept = default;

namespace {

Result<void> check(std::uint64_t id, const OccluderCandidate& candidate) {
    bool finite =
        is_finite(candidate.center) && std::isfinite(candidate.radius) && is_finite(glm::dvec3(candidate.half_size));
    for (const glm::vec3& area : candidate.areas) finite = finite && is_finite(glm::dvec3(area));
    if (!finite) return fail(ErrorCode::non_finite, id, "occluder candidate: NaN or infinite");
    const glm::dvec3 size = glm::abs(candidate.center);
    if (std::max({size.x, size.y, size.z, candidate.radius}) > kMostCoordinate || candidate.radius < 0.0)
        return fail(ErrorCode::out_of_range, id, "occluder candidate: beyond 1e15, or a negative radius");
    return {};
}

}  // namespace

void OccluderCandidates::Data::write(std::size_t id, const OccluderCandidate& candidate) {
    CandidatePage& page = *pages[id / CandidatePage::kSize];
    const std::size_t i = id % CandidatePage::kSize;
    const glm::vec3 center(candidate.center - origin);
    for (int k = 0; k < 3; ++k) page.columns[static_cast<std::size_t>(k)][i] = center[k];
    page.columns[3][i] = static_cast<float>(candidate.radius);
    for (std::size_t a = 0; a < 3; ++a)
        for (int k = 0; k < 3; ++k) page.columns[4 + 3 * a + static_cast<std::size_t>(k)][i] = candidate.areas[a][k];
    page.columns[13][i] = candidate.front_only ? 1.0f : 0.0f;
    page.edges[i] = candidate.edges;
    page.layers[i] = candidate.layers;
    page.half_sizes[i] = candidate.half_size == glm::vec3(0.0f) ? glm::vec3(static_cast<float>(candidate.radius))
                                                                : glm::abs(candidate.half_size);
    page.left_out_within[i] = candidate.limits.left_out_within;
    set_limits(page.limits[i], candidate.limits);
}

void OccluderCandidates::Data::set_limits(std::uint32_t& place, const EyeLimits& limits) {
    const bool has_planes = limits.piece_side_count > 0 || limits.plane_count > 0;
    if (!has_planes) {
        if (place == CandidatePage::kNoPlanes) return;
        limits_with_planes[place].next_free = first_free;
        first_free = place;
        place = CandidatePage::kNoPlanes;
        return;
    }
    if (place == CandidatePage::kNoPlanes && first_free != CandidatePage::kNoPlanes) {
        place = first_free;
        first_free = limits_with_planes[place].next_free;
    } else if (place == CandidatePage::kNoPlanes) {
        place = static_cast<std::uint32_t>(limits_with_planes.size());
        limits_with_planes.push_back({});
    }
    limits_with_planes[place].limits = limits;
}

Result<std::uint32_t> OccluderCandidates::add(const OccluderCandidate& candidate) {
    const std::size_t id = data_->count;
    if (auto status = check(id, candidate); !status) return status.error();
    if (id == 0) data_->origin = candidate.center;
    reserve(id + 1);
    data_->write(id, candidate);
    ++data_->count;
    return static_cast<std::uint32_t>(id);
}

Result<void> OccluderCandidates::set(std::uint32_t id, const OccluderCandidate& candidate) {
    if (id >= size()) return fail(ErrorCode::out_of_range, id, "occluder candidate: no such id");
    if (auto status = check(id, candidate); !status) return status;
    data_->write(id, candidate);
    return {};
}

void OccluderCandidates::reserve(std::size_t count) {
    while (data_->pages.size() * CandidatePage::kSize < count) data_->pages.push_back(Owner<CandidatePage>::make());
}

void OccluderCandidates::clear() {
    data_->count = 0;
    data_->limits_with_planes.clear();
    data_->first_free = CandidatePage::kNoPlanes;
    for (Owner<CandidatePage>& page : data_->pages) page->limits.fill(CandidatePage::kNoPlanes);
}

std::size_t OccluderCandidates::size() const {
    return data_->count;
}

std::uint32_t OccluderCandidates::layers(std::uint32_t id) const {
    return data_->pages[id / CandidatePage::kSize]->layers[id % CandidatePage::kSize];
}

namespace {

// Keys of all candidates in view that are worth something.
void list_worth(const OccluderCandidates& candidates, const OcclusionView& view, const ChooseBudget& budget,
                Vector<std::uint64_t>& keys) {
    const glm::dvec3& origin = CandidateStorage::origin(candidates);
    const ChooseView choose_view = choose_view_of(origin, view, budget);
    const LargeWorth large(view, budget.objects, origin);
    std::array<float, CandidatePage::kSize> values;
    std::array<std::uint32_t, CandidatePage::kSize> seen;
    keys.clear();
    std::uint32_t first = 0;
    for (const Owner<CandidatePage>& page : CandidateStorage::pages(candidates)) {
        if (first >= candidates.size()) break;
        std::array<const float*, CandidatePage::kColumns> columns;
        for (std::size_t k = 0; k < columns.size(); ++k) columns[k] = page->columns[k].data();
        const std::size_t count = std::min(candidates.size() - first, CandidatePage::kSize);
        const std::size_t found = measure_cover(columns.data(), count, choose_view, seen.data(), values.data());
        for (std::size_t i = 0; i < found; ++i) {
            if (!(page->layers[seen[i]] & budget.layer_mask)) continue;
            float worth = values[i];
            if (worth < 0.0f) worth = large.of(*page, seen[i], -worth, choose_view.least);
            if (worth > 0.0f) keys.push_back(key_of(worth, first + seen[i]));
        }
        first += CandidatePage::kSize;
    }
}

}  // namespace

Result<void> choose_occluders(const OccluderCandidates& candidates, const Camera& camera, const ChooseBudget& budget,
                              OccluderChoice& choice) {
    choice.ids.clear();
    const auto view = occlusion_view_of(camera);
    if (!view) return view.error();
    choose_occluders(candidates, *view, budget, choice);
    return {};
}

void choose_occluders(const OccluderCandidates& candidates, const OcclusionView& view, const ChooseBudget& budget,
                      OccluderChoice& choice) {
    choice.ids.clear();
    list_worth(candidates, view, budget, choice.order);
    // Sorted as far as needed: those that may not be used are few, and the next ones take their places.
    auto sorted = choice.order.begin();
    std::uint32_t edges = 0;
    while (choice.ids.size() < budget.max_occluders && sorted != choice.order.end()) {
        const auto first = sorted;
        const auto left = static_cast<std::uint64_t>(choice.order.end() - first);
        sorted += static_cast<std::ptrdiff_t>(std::min(left, std::uint64_t{budget.max_occluders} + kSpare));
        std::nth_element(first, sorted, choice.order.end());
        std::sort(first, sorted);
        for (auto key = first; key != sorted && choice.ids.size() < budget.max_occluders; ++key) {
            const auto id = static_cast<std::uint32_t>(*key);
            const CandidatePage& page = *CandidateStorage::pages(candidates)[id / CandidatePage::kSize];
            const std::size_t i = id % CandidatePage::kSize;
            if (page.edges[i] > budget.max_edges - edges) continue;
            const EyeLimits* const limits = CandidateStorage::limits_with_planes(candidates, page.limits[i]);
            if (limits ? !may_use(*limits, view) : !is_clear_of(page.left_out_within[i], {}, view)) continue;
            edges += page.edges[i];
            choice.ids.push_back(id);
        }
    }
}

}  // namespace crofton::occlude
