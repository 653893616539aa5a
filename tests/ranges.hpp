// SPDX-License-Identifier: MIT
// Algorithms on whole ranges, as std::ranges has them: libc++ 14 does not.
#pragma once
#include <algorithm>
#include <iterator>

namespace crofton::test::ranges {

template <class A, class B>
[[nodiscard]] bool equal(const A& a, const B& b) {
    return std::equal(std::begin(a), std::end(a), std::begin(b), std::end(b));
}
template <class A, class B, class Same>
[[nodiscard]] bool equal(const A& a, const B& b, Same same) {
    return std::equal(std::begin(a), std::end(a), std::begin(b), std::end(b), same);
}
template <class A, class B>
[[nodiscard]] bool is_permutation(const A& a, const B& b) {
    return std::is_permutation(std::begin(a), std::end(a), std::begin(b), std::end(b));
}
template <class A, class B>
[[nodiscard]] bool includes(const A& a, const B& b) {
    return std::includes(std::begin(a), std::end(a), std::begin(b), std::end(b));
}
template <class A, class B, class Out>
void set_difference(const A& a, const B& b, Out out) {
    std::set_difference(std::begin(a), std::end(a), std::begin(b), std::end(b), out);
}
template <class A, class B, class Out>
void set_intersection(const A& a, const B& b, Out out) {
    std::set_intersection(std::begin(a), std::end(a), std::begin(b), std::end(b), out);
}
template <class A>
void sort(A& a) {
    std::sort(std::begin(a), std::end(a));
}
template <class A>
[[nodiscard]] bool is_sorted(const A& a) {
    return std::is_sorted(std::begin(a), std::end(a));
}
template <class A, class Value>
[[nodiscard]] bool binary_search(const A& a, const Value& value) {
    return std::binary_search(std::begin(a), std::end(a), value);
}
template <class A, class Value>
[[nodiscard]] auto find(A& a, const Value& value) {
    return std::find(std::begin(a), std::end(a), value);
}
template <class A, class Value>
[[nodiscard]] auto count(const A& a, const Value& value) {
    return std::count(std::begin(a), std::end(a), value);
}
template <class A, class Test>
[[nodiscard]] auto count_if(const A& a, Test test) {
    return std::count_if(std::begin(a), std::end(a), test);
}
template <class A, class Test>
[[nodiscard]] bool all_of(const A& a, Test test) {
    return std::all_of(std::begin(a), std::end(a), test);
}
template <class A, class Before>
[[nodiscard]] auto min_element(A& a, Before before) {
    return std::min_element(std::begin(a), std::end(a), before);
}
template <class A, class Before>
[[nodiscard]] auto max_element(A& a, Before before) {
    return std::max_element(std::begin(a), std::end(a), before);
}

}  // namespace crofton::test::ranges
