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
inline int told(const mpq_class& a) {
    return sgn(a);
}
inline int told(const mpz_class& a) {
    return sgn(a);
}

// How many questions each kind of number has answered.
struct Decisions {
    std::uint64_t doubles = 0, pairs = 0, rationals = 0;
};
inline Decisions decisions;

// ask.operator()<Number>() in the first kind of number that can tell.
template <class Ask>
auto decide(const Ask& ask) {
    try {
        const auto answer = ask.template operator()<Tracked>();
        ++decisions.doubles;
        return answer;
    } catch (const Undecided&) {
    }
    try {
        const auto answer = ask.template operator()<TrackedPair>();
        ++decisions.pairs;
        return answer;
    } catch (const Undecided&) {
    }
    ++decisions.rationals;
    return ask.template operator()<Rational>();
}

}  // namespace crofton::oracle
