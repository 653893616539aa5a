// SPDX-License-Identifier: MIT
#include "crofton_broadphase.hpp"

#include <algorithm>
#include <cmath>

namespace crofton::bullet {
namespace {

// Planes and the like reach to 1e18 in Bullet.
constexpr double kFarthest = 1e12;

Aabb aabb_between(const btVector3& min, const btVector3& max) {
    const glm::dvec3 low(min.x(), min.y(), min.z()), high(max.x(), max.y(), max.z());
    return {glm::clamp(low, -kFarthest, kFarthest), glm::clamp(high, -kFarthest, kFarthest)};
}

bool contains(const btVector3& min, const btVector3& max, const btVector3& inner_min, const btVector3& inner_max) {
    for (int k = 0; k < 3; ++k)
        if (!(min[k] <= inner_min[k] && inner_max[k] <= max[k])) return false;
    return true;
}

bool meet(const btVector3& a_min, const btVector3& a_max, const btVector3& b_min, const btVector3& b_max) {
    for (int k = 0; k < 3; ++k)
        if (a_min[k] > b_max[k] || b_min[k] > a_max[k]) return false;
    return true;
}

}  // namespace

Broadphase::Broadphase(float margin) : margin_(margin) {}

btBroadphaseProxy* Broadphase::createProxy(const btVector3& min, const btVector3& max, int /*shape_type*/, void* user,
                                           int group, int mask, btDispatcher* /*dispatcher*/) {
    auto proxy = std::make_unique<Proxy>();
    proxy->m_clientObject = user;
    proxy->m_collisionFilterGroup = group;
    proxy->m_collisionFilterMask = mask;
    proxy->m_aabbMin = min;
    proxy->m_aabbMax = max;
    if (free_.empty()) {
        proxy->slot = static_cast<std::uint32_t>(proxies_.size());
        proxies_.emplace_back();
        boxes_.emplace_back();
        filters_.emplace_back();
        tree_.reset();
    } else {
        proxy->slot = free_.back();
        free_.pop_back();
    }
    proxy->m_uniqueId = static_cast<int>(proxy->slot) + 1;
    filters_[proxy->slot] = {static_cast<std::uint32_t>(group), static_cast<std::uint32_t>(mask)};
    keep(*proxy);
    return (proxies_[proxy->slot] = std::move(proxy)).get();
}

void Broadphase::destroyProxy(btBroadphaseProxy* proxy, btDispatcher* dispatcher) {
    pairs_.removeOverlappingPairsContainingProxy(proxy, dispatcher);
    const std::uint32_t slot = static_cast<Proxy*>(proxy)->slot;
    filters_[slot] = {0, 0};
    moved_.push_back(slot);
    // Another box in this slot before the next update would inherit pairs that are gone.
    free_after_update_.push_back(slot);
    proxies_[slot].reset();
}

void Broadphase::keep(Proxy& proxy) {
    const btVector3 grown(margin_, margin_, margin_);
    proxy.kept_min = proxy.m_aabbMin - grown;
    proxy.kept_max = proxy.m_aabbMax + grown;
    boxes_[proxy.slot] = obb_of(aabb_between(proxy.kept_min, proxy.kept_max));
    moved_.push_back(proxy.slot);
    moved_in_tree_.push_back(proxy.slot);
}

void Broadphase::setAabb(btBroadphaseProxy* proxy, const btVector3& min, const btVector3& max,
                         btDispatcher* /*dispatcher*/) {
    Proxy& changed = static_cast<Proxy&>(*proxy);
    changed.m_aabbMin = min;
    changed.m_aabbMax = max;
    if (!contains(changed.kept_min, changed.kept_max, min, max)) keep(changed);
}

void Broadphase::getAabb(btBroadphaseProxy* proxy, btVector3& min, btVector3& max) const {
    min = proxy->m_aabbMin;
    max = proxy->m_aabbMax;
}

void Broadphase::calculateOverlappingPairs(btDispatcher* dispatcher) {
    // An error, as of too many pairs, leaves no pairs: then all have ended.
    (void)broadphase_.update_moved(boxes_, moved_, filters_);
    moved_.clear();
    for (const IdPair& pair : broadphase_.ended()) {
        btBroadphaseProxy *first = proxies_[pair.first].get(), *second = proxies_[pair.second].get();
        if (first != nullptr && second != nullptr) pairs_.removeOverlappingPair(first, second, dispatcher);
    }
    for (const IdPair& pair : broadphase_.began())
        pairs_.addOverlappingPair(proxies_[pair.first].get(), proxies_[pair.second].get());
    free_.insert(free_.end(), free_after_update_.begin(), free_after_update_.end());
    free_after_update_.clear();
}

bool Broadphase::refresh_tree() {
    if (!tree_ || moved_in_tree_.size() > boxes_.size() / 2) {
        if (auto built = boxtree::BoxTree::build(boxes_)) tree_ = std::move(*built);
    } else if (!moved_in_tree_.empty()) {
        for (const std::uint32_t slot : moved_in_tree_) (void)tree_->move(slot, boxes_[slot]);
        tree_->refit();
    }
    moved_in_tree_.clear();
    return tree_.has_value();
}

void Broadphase::rayTest(const btVector3& from, const btVector3& to, btBroadphaseRayCallback& callback,
                         const btVector3& min, const btVector3& max) {
    // A shape that is swept along the ray is a ray against boxes that are larger: all boxes near its way.
    const auto tell = [&](std::uint32_t slot) {
        if (proxies_[slot]) callback.process(proxies_[slot].get());
    };
    if (!refresh_tree()) return;
    if (min.fuzzyZero() && max.fuzzyZero()) {
        const btVector3 way = to - from;
        const Ray ray{{from.x(), from.y(), from.z()}, {way.x(), way.y(), way.z()}, 1.0};
        collide::visit_along(ray, *tree_, [&](boxtree::ItemId item, double) {
            tell(item);
            return 1.0;
        });
        return;
    }
    btVector3 low = from, high = from;
    low.setMin(to);
    high.setMax(to);
    const Obb swept = obb_of(aabb_between(low + min, high + max));
    collide::overlapping(*tree_, swept, found_);
    for (const boxtree::ItemId item : found_) tell(item);
}

void Broadphase::aabbTest(const btVector3& min, const btVector3& max, btBroadphaseAabbCallback& callback) {
    if (!refresh_tree()) return;
    collide::overlapping(*tree_, obb_of(aabb_between(min, max)), found_);
    for (const boxtree::ItemId item : found_) {
        btBroadphaseProxy* proxy = proxies_[item].get();
        if (proxy != nullptr && meet(proxy->m_aabbMin, proxy->m_aabbMax, min, max)) callback.process(proxy);
    }
}

void Broadphase::getBroadphaseAabb(btVector3& min, btVector3& max) const {
    min.setValue(BT_LARGE_FLOAT, BT_LARGE_FLOAT, BT_LARGE_FLOAT);
    max = -min;
    for (const auto& proxy : proxies_)
        if (proxy) min.setMin(proxy->m_aabbMin), max.setMax(proxy->m_aabbMax);
}

}  // namespace crofton::bullet
