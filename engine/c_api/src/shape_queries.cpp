// SPDX-License-Identifier: MIT
// Questions asked of two shapes, and the contacts of a pair that last.
#include <algorithm>
#include <crofton/mesh/mesh_query.hpp>
#include <limits>

#include <crofton/capi/numbers.hpp>
#include <crofton/capi/queries.hpp>
#include <crofton/capi/shapes.hpp>

using namespace crofton;
using namespace crofton::capi;

struct crofton_shape_contacts {
    static constexpr std::uint32_t kKind = 0x43724f11;
    Header header;
    convex::PairCache cache{};
    convex::Manifolds found{};
    Vector<convex::TrackedPoint> points{};
};

static_assert(CROFTON_CAST_UNRESOLVED == static_cast<int>(convex::CastResult::unresolved) &&
              CROFTON_CAST_HIT == static_cast<int>(convex::CastResult::hit) &&
              CROFTON_FEATURE_FACE == static_cast<int>(convex::FeatureKind::face));

namespace {

crofton_part to_c_part(const convex::PartId& part) {
    return {part.child, part.triangle};
}

// What distances, penetrations and impacts have in common.
template <class Answer, class Struct>
void give_points(const Answer& answer, Struct& result) {
    copy_out(answer.on_a, result.on_a);
    copy_out(answer.on_b, result.on_b);
    copy_out(answer.normal, result.normal);
    result.part_a = to_c_part(answer.part_a);
    result.part_b = to_c_part(answer.part_b);
}

crofton_shape_distance to_c_distance(const convex::Distance& answer) {
    crofton_shape_distance result{};
    result.distance = answer.distance;
    result.lower = answer.lower;
    result.upper = answer.upper;
    give_points(answer, result);
    return result;
}

bool is_identity(const RigidTransform& pose) {
    return pose.rotation == glm::dmat3(1.0) && pose.translation == glm::dvec3(0.0);
}

// Whether mesh::hits_any answers as exactly as for other rays.
bool is_in_range(const Ray& ray) {
    const glm::dvec3 from = glm::abs(ray.origin), along = glm::abs(ray.direction);
    const double largest = std::max({along.x, along.y, along.z});
    return std::max({from.x, from.y, from.z}) <= 1e36 && largest >= 1e-149 && largest <= 1e149;
}

// Lines for the caller's function.
auto line_teller(crofton_line_visitor visit, void* user) {
    return [=](const glm::dvec3& from, const glm::dvec3& to) { visit(user, &from.x, &to.x); };
}

// The caller's cache for the length of a call.
class CallersCache {
  public:
    explicit CallersCache(crofton_pair_cache* kept) : kept_(kept) {
        if (kept_) std::memcpy(static_cast<void*>(&cache_), kept_, sizeof cache_);
    }
    ~CallersCache() {
        if (kept_) std::memcpy(kept_, &cache_, sizeof cache_);
    }
    CallersCache(const CallersCache&) = delete;
    CallersCache& operator=(const CallersCache&) = delete;
    [[nodiscard]] convex::PairCache* get() { return kept_ ? &cache_ : nullptr; }

  private:
    crofton_pair_cache* kept_;
    convex::PairCache cache_;
};

}  // namespace

crofton_status capi::to_manifold_options(const crofton_manifold_options* options, const char* function,
                                         convex::ManifoldOptions& result) {
    if (!options) return CROFTON_OK;
    crofton_manifold_options given{};
    CROFTON_CHECK(read_growing(options, function, given));
    CROFTON_CHECK(check_length(given.margin, "margin", function));
    if (given.max_points > 8) return report(CROFTON_OUT_OF_RANGE, function, "max_points is more than 8");
    result.margin = given.margin;
    if (given.max_points != 0) result.max_points = static_cast<int>(given.max_points);
    return CROFTON_OK;
}

convex::Motion capi::to_motion(const crofton_motion* motion) {
    convex::Motion result;
    if (motion) result = {to_vector(motion->velocity), to_vector(motion->spin), to_vector(motion->pivot)};
    return result;
}

crofton_status capi::to_cast_options(const crofton_cast_options* options, const char* function,
                                     convex::CastOptions& result) {
    if (!options) return CROFTON_OK;
    crofton_cast_options given{};
    CROFTON_CHECK(read_growing(options, function, given));
    result.duration = given.duration;
    if (given.tolerance != 0.0) result.tolerance = given.tolerance;
    if (given.max_steps > INT32_MAX) return report(CROFTON_OUT_OF_RANGE, function, "max_steps is more than 2^31 - 1");
    if (given.max_steps != 0) result.max_steps = static_cast<int>(given.max_steps);
    result.ignore_initial_overlaps = given.ignore_initial_overlaps != 0;
    return CROFTON_OK;
}

crofton_status crofton_shapes_meet(const crofton_placed* a, const crofton_placed* b, crofton_pair_cache* cache,
                                   int* meet) {
    CROFTON_CHECK(check_pointer(meet, __func__));
    const PlacedPair pair(a, b, __func__);
    CROFTON_CHECK(pair.status());
    CallersCache kept(cache);
    *meet = convex::intersects(pair.first(), pair.second(), kept.get()) ? 1 : 0;
    return CROFTON_OK;
}

crofton_status crofton_shapes_distance(const crofton_placed* a, const crofton_placed* b, crofton_pair_cache* cache,
                                       crofton_shape_distance* distance) {
    CROFTON_CHECK(check_growing(distance, __func__));
    const PlacedPair pair(a, b, __func__);
    CROFTON_CHECK(pair.status());
    CallersCache kept(cache);
    write_growing(to_c_distance(convex::distance(pair.first(), pair.second(), kept.get())), distance);
    return CROFTON_OK;
}

crofton_status crofton_shapes_penetration(const crofton_placed* a, const crofton_placed* b, crofton_pair_cache* cache,
                                          crofton_shape_penetration* penetration) {
    CROFTON_CHECK(check_growing(penetration, __func__));
    const PlacedPair pair(a, b, __func__);
    CROFTON_CHECK(pair.status());
    CallersCache kept(cache);
    const convex::Penetration answer = convex::penetration(pair.first(), pair.second(), kept.get());
    crofton_shape_penetration result{};
    result.depth = answer.depth;
    result.lower = answer.lower;
    result.upper = answer.upper;
    give_points(answer, result);
    result.overlapping = answer.overlapping ? 1 : 0;
    write_growing(result, penetration);
    return CROFTON_OK;
}

crofton_status crofton_shape_closest_point(const crofton_placed* shape, const double point[3],
                                           crofton_shape_distance* distance) {
    CROFTON_CHECK(check_growing(distance, __func__));
    CROFTON_CHECK(check_place(point, "point", __func__));
    const PlacedShape placed(shape, __func__);
    CROFTON_CHECK(placed.status());
    write_growing(to_c_distance(convex::closest_point(placed.placed(), to_vector(point))), distance);
    return CROFTON_OK;
}

crofton_status crofton_shape_raycast(const crofton_placed* shape, const crofton_ray* ray, crofton_shape_ray_hit* hit) {
    CROFTON_CHECK(check_pointer(ray, __func__));
    CROFTON_CHECK(check_growing(hit, __func__));
    Ray checked;
    CROFTON_CHECK(to_ray(*ray, __func__, kNoItem, checked));
    const PlacedShape placed(shape, __func__);
    CROFTON_CHECK(placed.status());
    crofton_shape_ray_hit result{};
    result.t = std::numeric_limits<double>::infinity();
    if (const auto met = convex::raycast(placed.placed(), checked)) {
        result.t = met->t;
        copy_out(met->point, result.point);
        copy_out(met->normal, result.normal);
        result.part = to_c_part(met->part);
        result.started_inside = met->started_inside ? 1 : 0;
    }
    write_growing(result, hit);
    return CROFTON_OK;
}

crofton_status crofton_shape_raycast_any(const crofton_placed* shape, const crofton_ray* ray, int* hit) {
    CROFTON_CHECK(check_pointer(ray, __func__));
    CROFTON_CHECK(check_pointer(hit, __func__));
    Ray checked;
    CROFTON_CHECK(to_ray(*ray, __func__, kNoItem, checked));
    const PlacedShape placed(shape, __func__);
    CROFTON_CHECK(placed.status());
    const auto& mesh = shape->shape->data->mesh;
    const bool is_quick =
        mesh && placed.shape().sides() == convex::Sides::both && is_identity(placed.pose()) && is_in_range(checked);
    const bool is_hit =
        is_quick ? mesh::hits_any(checked, *mesh) : convex::raycast(placed.placed(), checked).has_value();
    *hit = is_hit ? 1 : 0;
    return CROFTON_OK;
}

crofton_status crofton_shape_outline(const crofton_placed* shape, crofton_line_visitor visit, void* user) {
    if (!visit) return report(CROFTON_INVALID_ARGUMENT, __func__, "the visitor is NULL");
    const PlacedShape placed(shape, __func__);
    CROFTON_CHECK(placed.status());
    convex::outline(placed.placed(), line_teller(visit, user));
    return CROFTON_OK;
}

crofton_status crofton_shape_parts_near(const crofton_placed* shape, const crofton_placed* other, double margin,
                                        crofton_part* parts, size_t capacity, size_t* found) {
    CROFTON_CHECK(check_pointer(found, __func__));
    CROFTON_CHECK(check_array(parts, capacity, __func__));
    CROFTON_CHECK(check_length(margin, "margin", __func__));
    const PlacedPair pair(shape, other, __func__);
    CROFTON_CHECK(pair.status());
    Vector<convex::Part> near;
    convex::parts_near(pair.first(), pair.second(), margin, near);
    for (std::size_t i = 0; i < (std::min)(near.size(), capacity); ++i) parts[i] = to_c_part(near[i].id);
    *found = near.size();
    return CROFTON_OK;
}

crofton_status crofton_shapes_manifold(const crofton_placed* a, const crofton_placed* b,
                                       const crofton_manifold_options* options, crofton_pair_cache* cache,
                                       crofton_shape_manifold* manifold) {
    CROFTON_CHECK(check_growing(manifold, __func__));
    const PlacedPair pair(a, b, __func__);
    CROFTON_CHECK(pair.status());
    convex::ManifoldOptions wanted;
    CROFTON_CHECK(to_manifold_options(options, __func__, wanted));
    CallersCache kept(cache);
    const convex::Manifold answer = convex::contact_manifold(pair.first(), pair.second(), wanted, kept.get());
    crofton_shape_manifold result{};
    copy_out(answer.normal, result.normal);
    result.depth = answer.depth;
    result.point_count = static_cast<std::uint32_t>(answer.count);
    std::memcpy(static_cast<void*>(result.points), answer.points, result.point_count * sizeof *result.points);
    write_growing(result, manifold);
    return CROFTON_OK;
}

crofton_status crofton_shapes_cast(const crofton_placed* a, const crofton_motion* motion_a, const crofton_placed* b,
                                   const crofton_motion* motion_b, const crofton_cast_options* options,
                                   crofton_impact* impact) {
    CROFTON_CHECK(check_growing(impact, __func__));
    const PlacedPair pair(a, b, __func__);
    CROFTON_CHECK(pair.status());
    convex::CastOptions wanted;
    CROFTON_CHECK(to_cast_options(options, __func__, wanted));
    const auto answer = convex::cast(pair.first(), to_motion(motion_a), pair.second(), to_motion(motion_b), wanted);
    if (!answer) return report(answer.error(), __func__);
    crofton_impact result{};
    result.time = answer->time;
    result.distance = answer->distance;
    give_points(*answer, result);
    result.result = static_cast<std::uint32_t>(answer->result);
    result.steps = static_cast<std::uint32_t>(answer->steps);
    write_growing(result, impact);
    return CROFTON_OK;
}

crofton_status crofton_shape_contacts_create(crofton_shape_contacts** contacts) {
    CROFTON_CHECK(check_pointer(contacts, __func__));
    return create(contacts, __func__);
}

crofton_status crofton_shape_contacts_destroy(crofton_shape_contacts* contacts) {
    return destroy(contacts, __func__);
}

crofton_status crofton_shape_contacts_update(crofton_shape_contacts* contacts, const crofton_placed* a,
                                             const crofton_placed* b, const crofton_manifold_options* options,
                                             crofton_tracked_point** points, size_t* count, size_t* ended) {
    CROFTON_CHANGE(contacts);
    const PlacedPair pair(a, b, __func__);
    CROFTON_CHECK(pair.status());
    convex::ManifoldOptions wanted;
    CROFTON_CHECK(to_manifold_options(options, __func__, wanted));
    convex::contact_manifolds(pair.first(), pair.second(), wanted, contacts->found, &contacts->cache);
    const std::size_t gone = convex::track(contacts->found.all(), contacts->points);
    if (points) *points = reinterpret_cast<crofton_tracked_point*>(contacts->points.data());
    if (count) *count = contacts->points.size();
    if (ended) *ended = gone;
    return CROFTON_OK;
}

crofton_status crofton_shape_contacts_outline(crofton_shape_contacts* contacts, double length,
                                              crofton_line_visitor visit, void* user) {
    CROFTON_CHANGE(contacts);
    if (!visit) return report(CROFTON_INVALID_ARGUMENT, __func__, "the visitor is NULL");
    CROFTON_CHECK(check_length(length, "length", __func__));
    convex::outline(contacts->points, length, line_teller(visit, user));
    return CROFTON_OK;
}
