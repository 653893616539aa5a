// SPDX-License-Identifier: MIT
#include "certificate.hpp"

#include <oracle/sphere_verdict.hpp>

#include "exact_numbers.hpp"

namespace crofton::cli {
namespace {

template <class Box>
Proof prove_box(const Frustum& frustum, const Box& box) {
    const auto feasible = oracle::proven_feasible<Dyadic>(
        [&]<class Number>() { return oracle::quick::rows_of_box<Number>(frustum, box); });
    return !feasible ? Proof::none : *feasible ? Proof::meets : Proof::disjoint;
}

}  // namespace

Proof prove(const Frustum& frustum, const Obb& box) {
    return prove_box(frustum, box);
}
Proof prove(const Frustum& frustum, const Aabb& box) {
    return prove_box(frustum, box);
}

Proof prove(const Frustum& frustum, const Sphere& sphere) {
    const auto verdict =
        oracle::decide_by<Dyadic>([&]<class Number>() { return oracle::SphereVerdict<Number>(frustum, sphere)(); });
    return verdict == cull::Verdict::outside ? Proof::disjoint : Proof::meets;
}

}  // namespace crofton::cli
