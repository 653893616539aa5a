// SPDX-License-Identifier: MIT
#include "crofton_contacts.hpp"

#include <crofton/convex/query.hpp>
#include <cstring>
#include <new>
#include <string_view>
#include <vector>

namespace crofton::bullet {
namespace {

// What the shape is made of: half extents, a radius, or points; the last is the rounding.
std::vector<float> numbers_of(const btCollisionShape& shape) {
    std::vector<float> numbers;
    const auto add = [&](const btVector3& v) { numbers.insert(numbers.end(), {v.x(), v.y(), v.z()}); };
    switch (shape.getShapeType()) {
        case BOX_SHAPE_PROXYTYPE:
            add(static_cast<const btBoxShape&>(shape).getHalfExtentsWithMargin());
            break;
        case SPHERE_SHAPE_PROXYTYPE:
            numbers.push_back(static_cast<const btSphereShape&>(shape).getRadius());
            break;
        default: {
            const auto& hull = static_cast<const btConvexHullShape&>(shape);
            for (int i = 0; i < hull.getNumPoints(); ++i) add(hull.getScaledPoint(i));
            numbers.push_back(hull.getMargin());
        }
    }
    return numbers;
}

std::size_t fingerprint_of(const btCollisionShape& shape, const std::vector<float>& numbers) {
    const std::string_view bytes(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(float));
    return std::hash<std::string_view>()(bytes) + static_cast<std::size_t>(shape.getShapeType());
}

void make(const btCollisionShape& shape, const std::vector<float>& numbers, KeptShape& made) {
    const auto take = [&](const Result<convex::Shape>& found) {
        if (found) made.shape = *found;
    };
    switch (shape.getShapeType()) {
        case BOX_SHAPE_PROXYTYPE:
            return take(convex::Shape::box({numbers[0], numbers[1], numbers[2]}));
        case SPHERE_SHAPE_PROXYTYPE:
            return take(convex::Shape::sphere(numbers[0]));
        default: {
            std::vector<glm::vec3> points;
            for (std::size_t i = 0; i + 3 < numbers.size(); i += 3)
                points.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
            auto hull = convex::Hull::build(points);
            if (!hull) return;
            const convex::Shape core = convex::Shape::hull(made.hull.emplace(std::move(*hull)));
            if (numbers.back() == 0.0f) return take(core);
            return take(convex::Shape::rounded(core, numbers.back()));
        }
    }
}

RigidTransform to_pose(const btTransform& from) {
    RigidTransform pose;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            pose.rotation[column][row] = static_cast<double>(from.getBasis()[row][column]);
    const btVector3& origin = from.getOrigin();
    pose.translation = {origin.x(), origin.y(), origin.z()};
    return pose;
}

btVector3 to_bullet(const glm::dvec3& v) {
    return {static_cast<btScalar>(v.x), static_cast<btScalar>(v.y), static_cast<btScalar>(v.z)};
}

std::uint64_t id_of(const convex::ContactPoint& point) {
    const auto half = [](const convex::Feature& f) {
        return static_cast<std::uint64_t>(f.kind) << 16 | static_cast<std::uint64_t>(f.index);
    };
    return half(point.on_a) << 32 | half(point.on_b);
}

// Materials that Bullet sets up for each new point: its own way knows how.
bool is_special(const btCollisionObject& object) {
    constexpr int kFlags = btCollisionObject::CF_HAS_CONTACT_STIFFNESS_DAMPING |
                           btCollisionObject::CF_HAS_FRICTION_ANCHOR | btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK;
    return (object.getCollisionFlags() & kFlags) != 0;
}

constexpr double kLeastGap = 1e-3;

class Contacts final : public btActivatingCollisionAlgorithm {
  public:
    Contacts(const btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* a,
             const btCollisionObjectWrapper* b, std::shared_ptr<const KeptShape> shape_a,
             std::shared_ptr<const KeptShape> shape_b, PointCounts& counts)
        : btActivatingCollisionAlgorithm(info, a, b),
          manifold_(info.m_manifold),
          shape_a_(std::move(shape_a)),
          shape_b_(std::move(shape_b)),
          counts_(counts) {
        is_own_ = manifold_ == nullptr;
        if (is_own_) manifold_ = m_dispatcher->getNewManifold(a->getCollisionObject(), b->getCollisionObject());
        threshold_ = manifold_->getContactBreakingThreshold();
        fills_ = is_own_ && !is_special(*a->getCollisionObject()) && !is_special(*b->getCollisionObject());
    }
    ~Contacts() override {
        if (is_own_) m_dispatcher->releaseManifold(manifold_);
    }

    void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b, const btDispatcherInfo&,
                          btManifoldResult* result) override {
        const RigidTransform pose_a = to_pose(a->getWorldTransform()), pose_b = to_pose(b->getWorldTransform());
        // Points begin with a touch: only those that are there may have a gap.
        const double margin = fills_ && count_ == 0 ? kLeastGap : static_cast<double>(threshold_);
        convex::Manifold found = convex::contact_manifold({*shape_a_->shape, pose_a}, {*shape_b_->shape, pose_b},
                                                          {.margin = margin}, &cache_);
        // Pairs that do not touch are many: their manifolds are not even looked at.
        if (fills_ && found.count == 0 && count_ == 0) return;
        result->setPersistentManifold(manifold_);
        if (fills_) return fill(found, *a, *b);
        for (int i = 0; i < found.count; ++i) {
            const convex::ContactPoint& p = found.points[i];
            result->addContactPoint(to_bullet(-found.normal), to_bullet(p.position - 0.5 * p.depth * found.normal),
                                    btScalar(-p.depth));
        }
        if (is_own_) result->refreshContactPoints();
    }

    btScalar calculateTimeOfImpact(btCollisionObject*, btCollisionObject*, const btDispatcherInfo&,
                                   btManifoldResult*) override {
        return 1;  // as Bullet's box and box: motion clamping is the world's
    }

    void getAllContactManifolds(btManifoldArray& manifolds) override {
        if (is_own_) manifolds.push_back(manifold_);
    }

  private:
    // Replaces the manifold's points. Those of the same id keep their impulses, and what the user has put there. A
    // point whose features have changed takes over from the nearest one that is gone, as where a box slides off a
    // corner.
    void fill(convex::Manifold& found, const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b) {
        const int old_count = count_;
        int from[4] = {};
        unsigned used = match(found, from);
        leave_out_gaps(found, from);
        bool in_place = true;
        for (int i = 0; i < found.count; ++i) in_place &= from[i] == i;
        btManifoldPoint old[4];
        if (!in_place)
            for (int i = 0; i < old_count; ++i) old[i] = manifold_->getContactPoint(i);
        manifold_->setNumContacts(found.count > old_count ? found.count : old_count);
        for (int i = 0; i < found.count; ++i) {
            btManifoldPoint& point = manifold_->getContactPoint(i);
            from[i] >= 0 ? ++counts_.kept : ++counts_.begun;
            ids_[i] = id_of(found.points[i]);
            if (from[i] < 0) from[i] = nearest(found, i, old, old_count, used);
            if (from[i] < 0) {
                point = new_point(a, b);
            } else {
                used |= 1u << from[i];
                if (!in_place) point = old[from[i]];
                ++point.m_lifeTime;
            }
            place(found, i, a, b, point);
        }
        finish(found.count, old_count, in_place, used, old);
        count_ = found.count;
    }

    // As Bullet: a point begins with a touch, and ends with a gap beyond the threshold.
    static void leave_out_gaps(convex::Manifold& found, int* from) {
        int kept = 0;
        for (int i = 0; i < found.count; ++i) {
            if (from[i] < 0 && found.points[i].depth < -kLeastGap) continue;
            from[kept] = from[i];
            found.points[kept++] = found.points[i];
        }
        found.count = kept;
    }

    // Which old point has each one's id, −1: none. Returns which have been found.
    unsigned match(const convex::Manifold& found, int* from) const {
        unsigned used = 0;
        for (int i = 0; i < found.count; ++i) {
            from[i] = -1;
            for (int j = 0; j < count_ && from[i] < 0; ++j)
                if (ids_[j] == id_of(found.points[i]) && (used >> j & 1u) == 0) from[i] = j;
            if (from[i] >= 0) used |= 1u << from[i];
        }
        return used;
    }

    // The nearest old point within Bullet's threshold that nobody has taken.
    int nearest(const convex::Manifold& found, int i, const btManifoldPoint* old, int old_count, unsigned used) const {
        const btVector3 place = to_bullet(found.points[i].position);
        btScalar least = threshold_ * threshold_;
        int best = -1;
        for (int j = 0; j < old_count; ++j) {
            const btScalar distance = old[j].m_positionWorldOnB.distance2(place);
            if ((used >> j & 1u) != 0 || distance >= least) continue;
            least = distance;
            best = j;
        }
        return best;
    }

    void finish(int count, int old_count, bool in_place, unsigned used, btManifoldPoint* old) {
        if (in_place)
            for (int i = count; i < old_count; ++i) manifold_->clearUserCache(manifold_->getContactPoint(i));
        else
            for (int i = 0; i < old_count; ++i)
                if ((used >> i & 1u) == 0) manifold_->clearUserCache(old[i]);
        manifold_->setNumContacts(count);
        if (count > 0 && old_count == 0 && gContactStartedCallback != nullptr) gContactStartedCallback(manifold_);
        if (count == 0 && old_count > 0 && gContactEndedCallback != nullptr) gContactEndedCallback(manifold_);
    }

    static btManifoldPoint new_point(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b) {
        const btCollisionObject *first = a.getCollisionObject(), *second = b.getCollisionObject();
        btManifoldPoint point(btVector3(0, 0, 0), btVector3(0, 0, 0), btVector3(0, 0, 0), 0);
        point.m_combinedFriction = btManifoldResult::calculateCombinedFriction(first, second);
        point.m_combinedRestitution = btManifoldResult::calculateCombinedRestitution(first, second);
        point.m_combinedRollingFriction = btManifoldResult::calculateCombinedRollingFriction(first, second);
        point.m_combinedSpinningFriction = btManifoldResult::calculateCombinedSpinningFriction(first, second);
        return point;
    }

    static void place(const convex::Manifold& found, int i, const btCollisionObjectWrapper& a,
                      const btCollisionObjectWrapper& b, btManifoldPoint& point) {
        const convex::ContactPoint& p = found.points[i];
        point.m_positionWorldOnA = to_bullet(p.position + 0.5 * p.depth * found.normal);
        point.m_positionWorldOnB = to_bullet(p.position - 0.5 * p.depth * found.normal);
        point.m_localPointA = a.getWorldTransform().invXform(point.m_positionWorldOnA);
        point.m_localPointB = b.getWorldTransform().invXform(point.m_positionWorldOnB);
        point.m_normalWorldOnB = to_bullet(-found.normal);
        point.m_distance1 = static_cast<btScalar>(-p.depth);
        // Where Bullet keeps the triangles of meshes: the features that touch.
        point.m_partId0 = static_cast<int>(p.on_a.kind);
        point.m_partId1 = static_cast<int>(p.on_b.kind);
        point.m_index0 = p.on_a.index;
        point.m_index1 = p.on_b.index;
    }

    btPersistentManifold* manifold_;
    bool is_own_ = false, fills_ = false;
    int count_ = 0;  // of the manifold's points, where this fills them
    btScalar threshold_ = 0;
    std::shared_ptr<const KeptShape> shape_a_, shape_b_;
    PointCounts& counts_;
    convex::PairCache cache_;
    std::uint64_t ids_[4] = {};
};

btDefaultCollisionConstructionInfo with_room_for_contacts() {
    btDefaultCollisionConstructionInfo info;
    info.m_customCollisionAlgorithmMaxElementSize = sizeof(Contacts);
    return info;
}

}  // namespace

bool has_shape(int shape_type) {
    return shape_type == BOX_SHAPE_PROXYTYPE || shape_type == CONVEX_HULL_SHAPE_PROXYTYPE ||
           shape_type == SPHERE_SHAPE_PROXYTYPE;
}

std::shared_ptr<const KeptShape> KeptShapes::get(const btCollisionShape& shape) {
    const std::vector<float> numbers = numbers_of(shape);
    const std::size_t fingerprint = fingerprint_of(shape, numbers);
    std::shared_ptr<const KeptShape>& known = shapes_[&shape];
    if (!known || known->fingerprint != fingerprint) {
        auto made = std::make_shared<KeptShape>();
        made->fingerprint = fingerprint;
        make(shape, numbers, *made);
        known = std::move(made);
    }
    return known->shape ? known : nullptr;
}

struct Configuration::Create final : btCollisionAlgorithmCreateFunc {
    Create(KeptShapes& all, PointCounts& points) : shapes(all), counts(points) {}

    btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                   const btCollisionObjectWrapper* a,
                                                   const btCollisionObjectWrapper* b) override {
        auto shape_a = shapes.get(*a->getCollisionShape()), shape_b = shapes.get(*b->getCollisionShape());
        if (!shape_a || !shape_b) return fallback->CreateCollisionAlgorithm(info, a, b);
        void* memory = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(Contacts));
        return new (memory) Contacts(info, a, b, std::move(shape_a), std::move(shape_b), counts);
    }

    KeptShapes& shapes;
    PointCounts& counts;
    btCollisionAlgorithmCreateFunc* fallback = nullptr;  // for hulls of points in one plane: Bullet's own
};

Configuration::Configuration()
    : btDefaultCollisionConfiguration(with_room_for_contacts()), create_(std::make_unique<Create>(shapes_, counts_)) {
    create_->fallback = m_convexConvexCreateFunc;
}

Configuration::~Configuration() = default;

btCollisionAlgorithmCreateFunc* Configuration::getCollisionAlgorithmCreateFunc(int type_a, int type_b) {
    if (has_shape(type_a) && has_shape(type_b)) return create_.get();
    return btDefaultCollisionConfiguration::getCollisionAlgorithmCreateFunc(type_a, type_b);
}

void skip_pairs_apart(btBroadphasePair& pair, btCollisionDispatcher& dispatcher, const btDispatcherInfo& info) {
    const btBroadphaseProxy &a = *pair.m_pProxy0, &b = *pair.m_pProxy1;
    bool apart = false;
    for (int k = 0; k < 3; ++k) apart |= a.m_aabbMin[k] > b.m_aabbMax[k] || b.m_aabbMin[k] > a.m_aabbMax[k];
    if (apart) {
        if (pair.m_algorithm == nullptr) return;
        thread_local btManifoldArray manifolds;  // its memory stays
        manifolds.resize(0);
        pair.m_algorithm->getAllContactManifolds(manifolds);
        bool touched = false;
        for (int i = 0; i < manifolds.size(); ++i) touched |= manifolds[i]->getNumContacts() > 0;
        if (!touched) return;
    }
    btCollisionDispatcher::defaultNearCallback(pair, dispatcher, info);
}

}  // namespace crofton::bullet
