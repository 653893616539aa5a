#include <crofton/geometry/expansion.hpp>
#include <crofton/geometry/predicates.hpp>
#include <cstdint>

namespace crofton {
namespace {

// Shewchuk 1997, figure 23 (bound A of the three-dimensional orientation test).
constexpr double kOrientation3Bound = (7.0 + 56.0 * detail::kRounding) * detail::kRounding;

template <std::size_t N>
auto cross(const Expansion<N>& ax, const Expansion<N>& ay, const Expansion<N>& bx, const Expansion<N>& by) {
    return ax * by - ay * bx;
}

// Where every difference is one double the expansions are eight times shorter, which grids and small integers profit
// from.
bool representable(double a, double b, Expansion<1>& difference) {
    const auto [high, low] = detail::two_sum(a, -b);
    difference = exact(high);
    return low == 0.0;
}

template <std::size_t N>
int in_circle_sign(const Expansion<N>& ax, const Expansion<N>& ay, const Expansion<N>& bx, const Expansion<N>& by,
                   const Expansion<N>& cx, const Expansion<N>& cy) {
    const auto a_lift = ax * ax + ay * ay;
    const auto b_lift = bx * bx + by * by;
    const auto c_lift = cx * cx + cy * cy;
    const auto a_part = a_lift * cross(bx, by, cx, cy);
    const auto b_part = b_lift * cross(cx, cy, ax, ay);
    const auto c_part = c_lift * cross(ax, ay, bx, by);
    return (a_part + b_part + c_part).sign();
}

}  // namespace

int detail::orientation_exact(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return cross(exact_difference(a.x, c.x), exact_difference(a.y, c.y), exact_difference(b.x, c.x),
                 exact_difference(b.y, c.y))
        .sign();
}

int detail::in_circle_exact(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c, const glm::dvec2& d) {
    Expansion<1> ax, ay, bx, by, cx, cy;
    if (representable(a.x, d.x, ax) && representable(a.y, d.y, ay) && representable(b.x, d.x, bx) &&
        representable(b.y, d.y, by) && representable(c.x, d.x, cx) && representable(c.y, d.y, cy)) {
        return in_circle_sign(ax, ay, bx, by, cx, cy);
    }
    return in_circle_sign(exact_difference(a.x, d.x), exact_difference(a.y, d.y), exact_difference(b.x, d.x),
                          exact_difference(b.y, d.y), exact_difference(c.x, d.x), exact_difference(c.y, d.y));
}

int orientation(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
    const glm::dvec3 ad = a - d, bd = b - d, cd = c - d;
    const double bxcy = bd.x * cd.y, cxby = cd.x * bd.y;
    const double cxay = cd.x * ad.y, axcy = ad.x * cd.y;
    const double axby = ad.x * bd.y, bxay = bd.x * ad.y;
    const double determinant = ad.z * (bxcy - cxby) + bd.z * (cxay - axcy) + cd.z * (axby - bxay);
    const double permanent = (std::fabs(bxcy) + std::fabs(cxby)) * std::fabs(ad.z) +
                             (std::fabs(cxay) + std::fabs(axcy)) * std::fabs(bd.z) +
                             (std::fabs(axby) + std::fabs(bxay)) * std::fabs(cd.z);
    if (std::fabs(determinant) >= kOrientation3Bound * permanent) return detail::sign_of(determinant);
    const auto ax = exact_difference(a.x, d.x), ay = exact_difference(a.y, d.y), az = exact_difference(a.z, d.z);
    const auto bx = exact_difference(b.x, d.x), by = exact_difference(b.y, d.y), bz = exact_difference(b.z, d.z);
    const auto cx = exact_difference(c.x, d.x), cy = exact_difference(c.y, d.y), cz = exact_difference(c.z, d.z);
    return (cross(bx, by, cx, cy) * az + cross(cx, cy, ax, ay) * bz + cross(ax, ay, bx, by) * cz).sign();
}

}  // namespace crofton
