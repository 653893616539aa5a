// SPDX-License-Identifier: MIT
// Queries of all objects with any shape.
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/convex/push_out_of_union.hpp>
#include <crofton/convex/query.hpp>
#include <crofton/convex/slides.hpp>
#include <crofton/world/object_manifold.hpp>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <new>
#include <optional>
#include <span>

#include "world_state.hpp"

namespace crofton {
namespace {

constexpr double kSameSurface = 0.996;         // normals within 5 degrees
constexpr double kSameDirection = 1.0 - 1e-7;  // within 0.03 degrees

// Around a shape, and some more.
Aabb bounds_of(const convex::Shape& shape, const RigidTransform& pose) {
    const glm::dvec3 half = shape.bounds().half_extents();
    glm::dvec3 half_size(0.0);
    for (int k = 0; k < 3; ++k) half_size += half[k] * glm::abs(pose.rotation[k]);
    const glm::dvec3 offset = shape.bounds().center();
    const glm::dvec3 center = pose.rotation * offset + pose.translation;
    // The centre's sums round by 2^-53 of their parts, which may cancel.
    const double parts = std::abs(offset.x) + std::abs(offset.y) + std::abs(offset.z);
    half_size = half_size * (1.0 + 1e-9) + 1e-12 * glm::abs(center) + 1e-14 * (parts + glm::abs(pose.translation));
    return {center - half_size, center + half_size};
}

// All that the shape passes in a time: a box whose center moves along a path.
struct SweptBox {
    Ray path;
    glm::dvec3 half_size;

    // A sphere around its pivot where it turns.
    SweptBox(const convex::Shape& shape, const RigidTransform& pose, const convex::Motion& motion, double time,
             double tolerance) {
        Aabb bounds = bounds_of(shape, pose);
        if (motion.spin != glm::dvec3(0.0)) {
            const glm::dvec3 pivot = pose.rotation * motion.pivot + pose.translation;
            const double radius =
                glm::length(shape.bounds().half_extents()) + glm::length(shape.bounds().center() - motion.pivot);
            bounds = {pivot - radius * (1.0 + 1e-5), pivot + radius * (1.0 + 1e-5)};
        }
        path = {bounds.center(), motion.velocity, time};
        const glm::dvec3 size = glm::abs(bounds.min) + glm::abs(bounds.max) + glm::abs(time * motion.velocity);
        half_size = bounds.half_extents() + tolerance + 1e-9 * size;
    }
    // Of the box at both ends.
    [[nodiscard]] Aabb bounds() const {
        const glm::dvec3 way = path.max_t * path.direction;
        Aabb bounds{path.origin - half_size, path.origin + half_size};
        bounds.include(Aabb{bounds.min + way, bounds.max + way});
        return bounds;
    }
    // Whether it leaves its own size so far behind that all around both ends would be too much.
    [[nodiscard]] bool is_long() const {
        const glm::dvec3 way = glm::abs(path.max_t * path.direction);
        return std::max({way.x, way.y, way.z}) > 4.0 * std::max({half_size.x, half_size.y, half_size.z});
    }
};

// Objects that a cast begins in contact with. Of very many the first are enough: the others have the same normals.
class TouchedObjects {
  public:
    void add(std::uint32_t id, const convex::Shape& shape, const RigidTransform& pose) {
        if (count_ == kMost) return;
        const Touched& touched = touched_[count_].emplace(Touched{id, shape, pose});
        new (placed_[count_++]) convex::ShapeAtPose{touched.shape, touched.pose};
    }
    // Whether there are others than this.
    [[nodiscard]] bool has_others(std::uint32_t id) const {
        return count_ > 1 || (count_ == 1 && touched_[0]->id != id);
    }
    [[nodiscard]] const convex::ShapeAtPose* find(std::uint32_t id) const {
        for (std::size_t i = 0; i < count_; ++i)
            if (touched_[i]->id == id) return &placed()[i];
        return nullptr;
    }
    [[nodiscard]] std::span<const convex::ShapeAtPose> placed() const {
        return {std::launder(reinterpret_cast<const convex::ShapeAtPose*>(placed_)), count_};
    }

  private:
    static constexpr std::size_t kMost = 32;
    struct Touched {
        std::uint32_t id;
        convex::Shape shape;
        RigidTransform pose;
    };
    std::array<std::optional<Touched>, kMost> touched_;
    alignas(convex::ShapeAtPose) std::byte placed_[kMost][sizeof(convex::ShapeAtPose)];
    std::size_t count_ = 0;
};

// Whether a touch at a hit's time is nearer: by `margin`, or along another normal by any amount.
bool is_nearer(const convex::Impact& touch, const ShapeHit& hit, double margin) {
    const bool other_way = glm::dot(touch.normal, hit.normal) < kSameDirection;
    return touch.distance < (other_way ? hit.distance : hit.distance - margin);
}

// Whether a touch is what a hit tells.
bool is_same(const convex::Impact& touch, const ShapeHit& hit, double margin) {
    return glm::dot(touch.normal, hit.normal) >= kSameDirection && std::abs(touch.distance - hit.distance) <= margin;
}

// Whether what is touched is in the way: by the velocity of the point of touch, the shape comes at least as far along
// the normal in the time left as the gap is wide. Otherwise it slides along, or parts.
bool is_in_the_way(const convex::Impact& touch, const convex::ShapeAtPose& shape, const convex::Motion& motion,
                   double left) {
    const glm::dvec3 arm = touch.on_a - (shape.pose.rotation * motion.pivot + shape.pose.translation);
    const glm::dvec3 way = left * (motion.velocity + glm::cross(motion.spin, arm));
    const double slack = 0x1p-40 * (shape.shape.core_radius() + shape.shape.radius() + glm::length(way));
    return glm::dot(way, touch.normal) >= std::max(touch.distance, slack);
}

Result<void> check(const convex::Shape& probe, const RigidTransform& pose) {
    if (!probe.is_bounded())
        return fail(ErrorCode::unsupported, kNoItem,
                    "world: a half-space overlaps nearly everything; use a bounded shape");
    return convex::validate_pose(pose);
}

}  // namespace

void World::overlap(const convex::Shape& probe, const RigidTransform& pose, Vector<ObjectRef>& found,
                    const QueryFilter& filter) const {
    found.clear();
    if (!check(probe, pose)) return;
    const State& s = *state_;
    s.visit_near(bounds_of(probe, pose), 0.0, filter, [&](std::uint32_t id) {
        if (s.overlaps({probe, pose}, id)) found.push_back(s.ref_of(id));
        return 0.0;
    });
    world::sort_by_object(found);
}

std::optional<ClosestObject> World::closest(const convex::Shape& probe, const RigidTransform& pose, double max_distance,
                                            const QueryFilter& filter) const {
    if (!check(probe, pose)) return std::nullopt;
    const State& s = *state_;
    return s.closest(bounds_of(probe, pose), max_distance, filter, [&](std::uint32_t id, double limit) {
        return s.gap_to_shape({probe, pose}, id, limit);
    });
}

// A shape that moves among the objects.
struct World::State::Sweep {
    const State& world;
    convex::ShapeAtPose shape;
    const convex::Motion& motion;
    const convex::CastOptions& options;
    const QueryFilter& filter;

    [[nodiscard]] Result<void> check() const {
        if (auto updated = world.check_updated(); !updated) return updated;
        if (auto good = crofton::check(shape.shape, shape.pose); !good) return good;
        // Bad motions and options are told also where nothing is near.
        static const convex::Shape kPoint = *convex::Shape::sphere(0.0);
        const RigidTransform far{glm::dmat3(1.0), glm::dvec3(1e15)};
        if (auto good = convex::cast(shape, motion, {kPoint, far}, {}, options); !good) return good.error();
        return {};
    }
    [[nodiscard]] ShapeHit hit_of(std::uint32_t id, const world::QueryShape& stand,
                                  const convex::Impact& impact) const {
        const ObjectRef ref = world.ref_of(id);
        ShapeHit hit{ref.object, ref.user, impact.time, impact.normal, impact.on_b};
        hit.triangle = world::triangle_of(stand.shape, impact.part_b);
        hit.child = impact.part_b.child;
        hit.resolved = impact.result == convex::CastResult::hit;
        hit.distance = impact.distance;
        return hit;
    }
    // Calls visit(id, stand, impact) for each object that the shape may meet first, near ones roughly first. The
    // visitor returns the time up to which others are of interest.
    template <class Visit>
    void visit_met(std::span<const convex::ShapeAtPose> touched, Visit visit) const {
        convex::CastOptions rest = options;
        const SweptBox swept(shape.shape, shape.pose, motion, options.duration, options.tolerance);
        const auto look_at = [&](std::uint32_t id) {
            if (const world::QueryShape stand = world.query_shape_of(id); stand.pose) {
                const auto impact = convex::cast(shape, motion, stand.placed(), {}, rest, {{}, touched});
                if (impact && impact->result != convex::CastResult::miss) rest.early_out = visit(id, stand, *impact);
            }
            return std::min(rest.early_out, options.duration);
        };
        if (swept.is_long()) return world.visit_swept(swept.path, swept.half_size, filter, look_at);
        world.visit_near(swept.bounds(), 0.0, filter, [&](std::uint32_t id) { return look_at(id), 0.0; });
    }
    [[nodiscard]] std::optional<ShapeHit> find_first(std::span<const convex::ShapeAtPose> touched) const {
        std::optional<ShapeHit> first;
        visit_met(touched, [&](std::uint32_t id, const world::QueryShape& stand, const convex::Impact& impact) {
            if (!first || impact.time < first->time || (impact.time == first->time && id < first->object.index))
                first = hit_of(id, stand, impact);
            return first->time;
        });
        return first;
    }
    // Objects that the shape touches at one time are one surface, to slide on or to land on.
    template <class Visit>
    void visit_touched(const RigidTransform& there, Visit visit) const {
        convex::CastOptions now = options;
        now.duration = 0.0;
        now.ignore_initial_overlaps = false;
        world.visit_near(bounds_of(shape.shape, there), options.tolerance, filter, [&](std::uint32_t id) {
            const world::QueryShape stand = world.query_shape_of(id);
            if (!stand.pose) return options.tolerance;
            const auto impact = convex::cast({shape.shape, there}, {}, stand.placed(), {}, now);
            if (impact && impact->result == convex::CastResult::hit) visit(id, stand, *impact);
            return options.tolerance;
        });
    }
    void find_touched_at_start(TouchedObjects& touched) const {
        visit_touched(shape.pose, [&](std::uint32_t id, const world::QueryShape& stand, const convex::Impact&) {
            touched.add(id, stand.shape, *stand.pose);
        });
    }
};

Result<std::optional<ShapeHit>> World::cast(const convex::Shape& probe, const RigidTransform& pose,
                                            const convex::Motion& motion, const convex::CastOptions& options,
                                            const QueryFilter& filter) const {
    const State::Sweep sweep{*state_, {probe, pose}, motion, options, filter};
    if (auto good = sweep.check(); !good) return good.error();
    std::optional<ShapeHit> first = sweep.find_first({});
    const auto overlaps = [&] { return first->time == 0.0 && first->distance <= -options.tolerance; };
    if (!first || overlaps()) return first;
    TouchedObjects at_start;
    sweep.find_touched_at_start(at_start);
    const bool slides = convex::slides_along({probe, pose}, motion, at_start.placed(), options);
    if (at_start.has_others(first->object.index)) first = sweep.find_first(at_start.placed());
    if (!first || !first->resolved) return first;
    if (first->time == 0.0 && at_start.has_others(first->object.index)) {
        std::optional<ShapeHit> told;
        sweep.visit_touched(pose, [&](std::uint32_t id, const world::QueryShape& stand, const convex::Impact& touch) {
            if (is_same(touch, *first, 1e-3 * options.tolerance) && !(told && told->object == first->object) &&
                (id == first->object.index || !told || touch.distance < told->distance))
                told = sweep.hit_of(id, stand, touch);
        });
        return told ? told : first;
    }
    if (first->time == 0.0 || options.ignore_initial_overlaps) return first;
    // The nearest of those that it touches then.
    std::optional<ShapeHit> nearest;
    TouchedObjects at_hit;
    const RigidTransform there = convex::moved(pose, motion, first->time);
    sweep.visit_touched(there, [&](std::uint32_t id, const world::QueryShape& stand, const convex::Impact& touch) {
        at_hit.add(id, stand.shape, *stand.pose);
        if (!is_in_the_way(touch, {probe, there}, motion, options.duration - first->time)) return;
        // What it slides on may seem to come nearer, within rounding.
        if (slides && glm::dot(touch.normal, first->normal) < kSameSurface) return;
        if (!is_nearer(touch, *first, 1e-3 * options.tolerance)) return;
        if (nearest && touch.distance > nearest->distance) return;
        if (nearest && touch.distance == nearest->distance && id > nearest->object.index) return;
        nearest = sweep.hit_of(id, stand, touch);
    });
    if (nearest) {
        nearest->time = first->time;
        first = nearest;
    }
    // Over a crack between flush objects the edges on both sides are nearest.
    const convex::ShapeAtPose* const object = at_hit.find(first->object.index);
    if (object == nullptr || !at_hit.has_others(first->object.index)) return first;
    convex::CastOptions rest = options;
    rest.duration -= first->time;
    if (const auto touch = convex::touch_over_crack({probe, there}, motion, *object, at_hit.placed(), rest)) {
        first->point = touch->on_b;
        first->normal = touch->normal;
        first->distance = touch->distance;
    }
    return first;
}

Result<void> World::cast_all(const convex::Shape& probe, const RigidTransform& pose, const convex::Motion& motion,
                             const convex::CastOptions& options, Vector<ShapeHit>& hits,
                             const QueryFilter& filter) const {
    hits.clear();
    const State::Sweep sweep{*state_, {probe, pose}, motion, options, filter};
    if (auto good = sweep.check(); !good) return good;
    TouchedObjects at_start;
    sweep.find_touched_at_start(at_start);
    sweep.visit_met(at_start.placed(),
                    [&](std::uint32_t id, const world::QueryShape& stand, const convex::Impact& impact) {
                        hits.push_back(sweep.hit_of(id, stand, impact));
                        return options.early_out;
                    });
    std::sort(hits.begin(), hits.end(), [](const ShapeHit& a, const ShapeHit& b) {
        return a.time != b.time ? a.time < b.time : a.object.index < b.object.index;
    });
    return {};
}

Result<void> World::contact_manifolds(const convex::Shape& probe, const RigidTransform& pose,
                                      const convex::ManifoldOptions& options, Vector<ObjectManifold>& found,
                                      const QueryFilter& filter) const {
    found.clear();
    if (auto updated = state_->check_updated(); !updated) return updated;
    if (auto good = check(probe, pose); !good) return good;
    if (!(options.margin >= 0.0 && options.margin <= kMaxCoordinate))
        return fail(ErrorCode::out_of_range, kNoItem, "world: a margin of contacts must be finite and at least 0");
    if (options.max_points < 1 || options.max_points > 8)
        return fail(ErrorCode::out_of_range, kNoItem, "world: a manifold has 1 to 8 points");
    struct Near {
        std::uint32_t id;
        world::QueryShape stand;
    };
    const State& s = *state_;
    Vector<Near> near;
    const auto wider = [&](const Obb& box, const convex::Shape& shape, const RigidTransform& stand) {
        return options.margin > 0.0 ? world::box_around(box, shape, stand, 0.5 * options.margin) : box;
    };
    const Obb box = wider(world::box_around(probe, pose), probe, pose);
    s.visit_near(bounds_of(probe, pose), options.margin, filter, [&](std::uint32_t id) {
        world::QueryShape stand = s.query_shape_of(id);
        if (!stand.pose) return options.margin;
        // Others that the tree may visit, as it is built now, must not take part as neighbours.
        const bool is_near =
            !stand.shape.is_bounded() || collide::intersects(box, wider(s.box_of_object(id), stand.shape, *stand.pose));
        if (is_near) near.push_back({id, std::move(stand)});
        return options.margin;
    });
    std::sort(near.begin(), near.end(), [](const Near& a, const Near& b) { return a.id < b.id; });
    const convex::ShapeAtPose placed{probe, pose};
    convex::Manifolds manifolds;
    convex::PairMemory memory;
    Vector<convex::ShapeAtPose> beside;
    Vector<std::uint32_t> numbers;
    for (const Near& object : near) {
        const convex::ShapeAtPose other = object.stand.placed();
        beside.clear();
        numbers.clear();
        for (const Near& neighbor : near) {
            if (neighbor.id == object.id) continue;
            beside.push_back(neighbor.stand.placed());
            numbers.push_back(neighbor.id);
        }
        if (probe.is_convex() && other.shape.is_convex()) {
            convex::PairCache cache;  // the union's search begins with what the two alone have found
            convex::contact_manifolds(placed, other, options, manifolds, &cache);
            convex::push_out_of_union(placed, other, {{{}, beside}, kNoIndex, object.id, {}, numbers}, options,
                                      manifolds, memory, cache);
        } else {
            convex::contact_manifolds(placed, other, {{}, beside}, options, manifolds);
        }
        const ObjectRef ref = s.ref_of(object.id);
        const std::size_t first = found.size();
        for (const convex::Manifold& manifold : manifolds.all()) found.push_back({ref.object, ref.user, manifold});
        std::stable_sort(
            found.begin() + static_cast<std::ptrdiff_t>(first), found.end(),
            [](const ObjectManifold& a, const ObjectManifold& b) { return a.manifold.depth > b.manifold.depth; });
    }
    return {};
}

}  // namespace crofton
