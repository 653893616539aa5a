// SPDX-License-Identifier: MIT
// Tracked doubles, then pairs of them, then rationals (GMP): the first that can decide.
#pragma once
#include <gmpxx.h>

#include <oracle/tracked_numbers.hpp>

namespace crofton::oracle {

using Rational = mpq_class;

inline double quotient(const mpq_class& a, const mpq_class& b) {
    return mpq_class(a / b).get_d();
}

// ask.operator()<Number>() in the first kind of number that can tell.
template <class Ask>
auto decide(const Ask& ask) {
    return decide_by<Rational>(ask);
}

}  // namespace crofton::oracle
