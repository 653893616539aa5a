// SPDX-License-Identifier: MIT
#include "check.hpp"

#include <LinearMath/btAabbUtil2.h>
#include <random>
#include <set>

namespace crofton::bullet {
namespace {

struct Told final : btBroadphaseRayCallback {
    std::set<const btBroadphaseProxy*> proxies;
    bool process(const btBroadphaseProxy* proxy) override {
        proxies.insert(proxy);
        return true;
    }
};

struct ToldOfBox final : btBroadphaseAabbCallback {
    std::set<const btBroadphaseProxy*> proxies;
    bool process(const btBroadphaseProxy* proxy) override {
        proxies.insert(proxy);
        return true;
    }
};

std::vector<btBroadphaseProxy*> proxies_of(Scene& scene) {
    std::vector<btBroadphaseProxy*> proxies;
    const btCollisionObjectArray& objects = scene.world().getCollisionObjectArray();
    for (int i = 0; i < objects.size(); ++i) proxies.push_back(objects[i]->getBroadphaseHandle());
    return proxies;
}

bool meet(const btBroadphaseProxy& a, const btBroadphaseProxy& b) {
    return TestAabbAgainstAabb2(a.m_aabbMin, a.m_aabbMax, b.m_aabbMin, b.m_aabbMax);
}

std::string missing_pair(Scene& scene, const std::vector<btBroadphaseProxy*>& proxies) {
    btOverlappingPairCache& pairs = *scene.world().getPairCache();
    std::size_t wanted = 0;
    for (std::size_t i = 0; i < proxies.size(); ++i)
        for (std::size_t j = i + 1; j < proxies.size(); ++j) {
            const bool passes = (proxies[i]->m_collisionFilterGroup & proxies[j]->m_collisionFilterMask) != 0 &&
                                (proxies[j]->m_collisionFilterGroup & proxies[i]->m_collisionFilterMask) != 0;
            if (!passes || !meet(*proxies[i], *proxies[j])) continue;
            ++wanted;
            if (pairs.findPair(proxies[i], proxies[j]) == nullptr)
                return "bodies " + std::to_string(i) + " and " + std::to_string(j) + " are no pair";
        }
    return wanted > 0 ? "" : "no boxes meet";
}

std::string missing_answer(Scene& scene, const std::vector<btBroadphaseProxy*>& proxies, unsigned seed) {
    std::mt19937 random(seed);
    const auto uniform = [&](float low, float high) {
        return low + (high - low) * static_cast<float>(random()) * 0x1p-32f;
    };
    btBroadphaseInterface& broadphase = *scene.world().getBroadphase();
    std::size_t hits = 0;
    for (int k = 0; k < 100; ++k) {
        const btVector3 from(uniform(-20, 20), uniform(-1, 20), uniform(-20, 20));
        const btVector3 to(uniform(-20, 20), uniform(-1, 20), uniform(-20, 20)), grown(0.3f, 0.2f, 0.1f);
        Told ray, thick;
        broadphase.rayTest(from, to, ray, btVector3(0, 0, 0), btVector3(0, 0, 0));
        broadphase.rayTest(from, to, thick, -grown, grown);
        ToldOfBox box;
        broadphase.aabbTest(from - grown, from + grown, box);
        for (const btBroadphaseProxy* proxy : proxies) {
            btVector3 normal;
            btScalar along = 1, along_grown = 1;
            const bool met = btRayAabb(from, to, proxy->m_aabbMin, proxy->m_aabbMax, along, normal);
            const bool met_thick =
                btRayAabb(from, to, proxy->m_aabbMin - grown, proxy->m_aabbMax + grown, along_grown, normal);
            const bool within = TestAabbAgainstAabb2(from - grown, from + grown, proxy->m_aabbMin, proxy->m_aabbMax);
            hits += met ? 1 : 0;
            if (met && ray.proxies.count(proxy) == 0) return "a ray misses a box";
            if (met_thick && thick.proxies.count(proxy) == 0) return "a thick ray misses a box";
            if (within != (box.proxies.count(proxy) != 0)) return "a box query is wrong";
        }
    }
    return hits > 0 ? "" : "no ray hits";
}

}  // namespace

std::string find_fault(Scene& scene, unsigned seed) {
    const std::vector<btBroadphaseProxy*> proxies = proxies_of(scene);
    const std::string fault = missing_pair(scene, proxies);
    return fault.empty() ? missing_answer(scene, proxies, seed) : fault;
}

}  // namespace crofton::bullet
