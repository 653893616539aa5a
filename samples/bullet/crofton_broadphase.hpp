// SPDX-License-Identifier: MIT
// Bullet's broadphase, made of Crofton's: collide::Broadphase finds the pairs, a BoxTree answers rays and boxes.
#pragma once
#include <btBulletDynamicsCommon.h>

#include <crofton/boxtree/box_tree.hpp>
#include <crofton/collide/broadphase.hpp>
#include <memory>
#include <optional>
#include <vector>

namespace crofton::bullet {

// A box is kept with `margin` (in lengths) around it, so that what rests or creeps costs nothing. rayTest and aabbTest
// bring the tree up to date first: from one thread at a time.
class Broadphase final : public btBroadphaseInterface {
  public:
    explicit Broadphase(float margin = 0.05f);

    btBroadphaseProxy* createProxy(const btVector3& min, const btVector3& max, int shape_type, void* user, int group,
                                   int mask, btDispatcher* dispatcher) override;
    void destroyProxy(btBroadphaseProxy* proxy, btDispatcher* dispatcher) override;
    void setAabb(btBroadphaseProxy* proxy, const btVector3& min, const btVector3& max,
                 btDispatcher* dispatcher) override;
    void getAabb(btBroadphaseProxy* proxy, btVector3& min, btVector3& max) const override;
    void rayTest(const btVector3& from, const btVector3& to, btBroadphaseRayCallback& callback, const btVector3& min,
                 const btVector3& max) override;
    void aabbTest(const btVector3& min, const btVector3& max, btBroadphaseAabbCallback& callback) override;
    void calculateOverlappingPairs(btDispatcher* dispatcher) override;
    btOverlappingPairCache* getOverlappingPairCache() override { return &pairs_; }
    const btOverlappingPairCache* getOverlappingPairCache() const override { return &pairs_; }
    void getBroadphaseAabb(btVector3& min, btVector3& max) const override;
    void printStats() override {}

  private:
    struct Proxy final : btBroadphaseProxy {
        btVector3 kept_min, kept_max;  // with the margin
        std::uint32_t slot = 0;
    };
    void keep(Proxy& proxy);
    [[nodiscard]] bool refresh_tree();

    float margin_;
    std::vector<std::unique_ptr<Proxy>> proxies_;  // by slot; none: free
    std::vector<Obb> boxes_;
    std::vector<collide::CollisionFilter> filters_;
    std::vector<std::uint32_t> moved_, moved_in_tree_, free_, free_after_update_;
    collide::Broadphase broadphase_{{.exact_boxes = false}};
    std::optional<boxtree::BoxTree> tree_;  // none: not all boxes are in it
    Vector<boxtree::ItemId> found_;
    btHashedOverlappingPairCache pairs_;
};

}  // namespace crofton::bullet
