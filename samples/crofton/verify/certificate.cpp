// SPDX-License-Identifier: MIT
#include "certificate.hpp"

#include <oracle/frustum_rows.hpp>

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

}  // namespace crofton::cli
