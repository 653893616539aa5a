// SPDX-License-Identifier: MIT
// The quick oracles of the fuzzers give the answers of the slow ones, on shapes that touch or nearly do.
#include <doctest/doctest.h>

#include <cmath>
#include <fuzz/shapes.hpp>
#include <oracle/exact_boxes.hpp>
#include <oracle/exact_triangles.hpp>
#include <oracle/quick_frustum.hpp>
#include <random>

using namespace crofton;

namespace {

std::vector<std::uint8_t> random_bytes(std::mt19937& random) {
    std::vector<std::uint8_t> bytes(160);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    return bytes;
}

template <class Number>
void check_numbers(double a, double b, double c) {
    // (a + b) c − a c − b c is 0, and (a + b) c + 2^-200 is not (a + b) c.
    const Number exact = (Number(a) + Number(b)) * Number(c), other = Number(a) * Number(c) + Number(b) * Number(c);
    const int sign = told(Number(exact - other));
    CHECK((sign == 0 || sign == oracle::kUnknown));
    const mpq_class truth = (mpq_class(a) + mpq_class(b)) * mpq_class(c);
    const int side = told(exact);
    CHECK((side == sgn(truth) || side == oracle::kUnknown));
    const int beside = told(Number(exact - other + Number(0x1p-200)));
    CHECK((beside == 1 || beside == oracle::kUnknown));
}

}  // namespace

TEST_SUITE("oracle/quick") {
    TEST_CASE("numbers with an error bound never have a wrong sign") {
        std::mt19937 random(1);
        for (int i = 0; i < 20000; ++i) {
            const auto bytes = random_bytes(random);
            fuzz::Shapes in(bytes.data(), bytes.size());
            const double a = in.number(), b = in.number(), c = in.number();
            check_numbers<oracle::Tracked>(a, b, c);
            check_numbers<oracle::TrackedPair>(a, b, c);
            check_numbers<oracle::Tracked>(a, std::nextafter(-a, b), c);
            check_numbers<oracle::TrackedPair>(a, std::nextafter(-a, b), c);
        }
    }
    TEST_CASE("overflow and NaN have no sign, and underflow does not count as 0") {
        CHECK(told(oracle::Tracked(1e300) * oracle::Tracked(1e300)) == oracle::kUnknown);
        CHECK(told(oracle::TrackedPair(1e300) * oracle::TrackedPair(1e300)) == oracle::kUnknown);
        CHECK(told(oracle::Tracked(std::nan(""))) == oracle::kUnknown);
        CHECK(told(oracle::Tracked(1e-200) * oracle::Tracked(1e-200)) == oracle::kUnknown);
        CHECK(told(oracle::TrackedPair(1e-200) * oracle::TrackedPair(1e-200)) == oracle::kUnknown);
    }
    TEST_CASE("a wrong guess proves nothing") {
        using oracle::detail::Programme;
        // A cube, and x + y + z ≥ 2.5, which cuts a corner off; with x ≤ −0.5 nothing is left.
        std::vector<oracle::Row<oracle::Tracked>> rows;
        for (std::size_t k = 0; k < 3; ++k)
            for (const double side : {-1.0, 1.0}) {
                rows.push_back({{0.0, 0.0, 0.0}, 1.0});
                rows.back().normal[k] = side;
            }
        rows.push_back({{1.0, 1.0, 1.0}, -2.5});
        const Programme::Answer beside{true, 3, {1, 3, 5}, {}}, in_it{true, 3, {0, 2, 4}, {}};
        CHECK(oracle::detail::proven(rows, beside) == std::nullopt);
        CHECK(oracle::detail::proven(rows, in_it) == true);
        const Programme::Answer empty{false, 4, {0, 2, 4, 6}, {}};
        CHECK(oracle::detail::proven(rows, empty) == std::nullopt);
        rows.push_back({{-1.0, 0.0, 0.0}, -0.5});
        CHECK(oracle::detail::proven(rows, in_it) == std::nullopt);
        const Programme::Answer none{false, 4, {2, 4, 6, 7}, {}};
        CHECK(oracle::detail::proven(rows, none) == false);
    }
    TEST_CASE("boxes, views and triangles: the answers of the slow oracles") {
        std::mt19937 random(2);
        int differences = 0;
        for (int i = 0; i < 1500; ++i) {
            const auto bytes = random_bytes(random);
            fuzz::Shapes in(bytes.data(), bytes.size());
            const Obb a = in.box(), b = in.box_near(a);
            differences += oracle::boxes_meet(a, b) != oracle::boxes_meet_by_integers(a, b);
            const Triangle t = in.triangle();
            Triangle u = in.triangle();
            if (in.flag()) u[0] = t[in.below(3)];
            if (in.flag()) u[1] = 0.5 * (t[0] + t[1]) + in.nudge();
            differences += oracle::triangles_meet_quickly(t, u) != oracle::triangles_meet(t, u);
        }
        for (int i = 0; i < 300; ++i) {
            const auto bytes = random_bytes(random);
            fuzz::Shapes in(bytes.data(), bytes.size());
            const Frustum frustum = in.frustum();
            const Obb box = in.box_at(in.point_of(frustum));
            differences += oracle::quick::classify(frustum, box) != oracle::classify(frustum, box);
            differences +=
                oracle::quick::is_rejected_by_a_plane(frustum, box) != oracle::is_rejected_by_a_plane(frustum, box);
            const Triangle t = in.triangle();
            differences += oracle::quick::meets(frustum, t[0], t[1], t[2]) != oracle::meets(frustum, t[0], t[1], t[2]);
        }
        CHECK(differences == 0);
        // Most are settled without fractions.
        CHECK(oracle::decisions.rationals * 20 < oracle::decisions.doubles);
        CHECK(oracle::feasibilities.eliminated * 20 < oracle::feasibilities.proven);
    }
}
