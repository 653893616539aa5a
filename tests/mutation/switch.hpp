// SPDX-License-Identifier: MIT
// Read by sources into which together.py has put several mutants: CROFTON_MUTANT says which one is in force.
#pragma once
#include <cstdlib>

namespace crofton::mutation {

inline const int kOn = std::getenv("CROFTON_MUTANT") ? std::atoi(std::getenv("CROFTON_MUTANT")) : 0;

// `a < Less<7>() < b` is a < b, or a <= b while mutant 7 is in force. Operators bind as they did.
#define CROFTON_SWITCH(NAME, OPERATOR, OTHER)                     \
    template <int N>                                              \
    struct NAME {};                                               \
    template <class A, int N>                                     \
    struct NAME##Left {                                           \
        const A& a;                                               \
    };                                                            \
    template <class A, int N>                                     \
    NAME##Left<A, N> operator OPERATOR(const A& a, NAME<N>) {     \
        return {a};                                               \
    }                                                             \
    template <class A, int N, class B>                            \
    auto operator OPERATOR(NAME##Left<A, N> left, const B& b) {   \
        return kOn == N ? (left.a OTHER b) : (left.a OPERATOR b); \
    }

CROFTON_SWITCH(Less, <, <=)
CROFTON_SWITCH(LessEqual, <=, <)
CROFTON_SWITCH(Greater, >, >=)
CROFTON_SWITCH(GreaterEqual, >=, >)
CROFTON_SWITCH(Equal, ==, !=)
CROFTON_SWITCH(NotEqual, !=, ==)
CROFTON_SWITCH(Plus, +, -)
CROFTON_SWITCH(Minus, -, +)
#undef CROFTON_SWITCH

}  // namespace crofton::mutation
