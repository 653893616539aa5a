// SPDX-License-Identifier: MIT
#include "closing.hpp"

#include <algorithm>
#include <cmath>

#include "parts.hpp"

namespace crofton::convex {
namespace {

bool is_solid_of_revolution(const Shape& shape) {
    const Kind kind = shape.kind();
    return kind == Kind::sphere || kind == Kind::capsule || kind == Kind::cylinder || kind == Kind::cone;
}

// Where the quadratic rate · s + bend · s² reaches `gap` > 0; infinite where it does not.
double reaches(double rate, double bend, double gap) {
    const double root = std::sqrt(rate * rate + 4.0 * bend * gap);
    return rate > 0.0 ? 2.0 * gap / (rate + root) : (root - rate) / (2.0 * bend);
}

double arm_of(const Shape& shape, const Motion& motion) {
    return motion.pivot == glm::dvec3(0.0) ? shape.core_radius() : shape.core_radius() + glm::length(motion.pivot);
}

}  // namespace

Advance::Advance(const ShapeAtPose& now, const Motion& motion, const glm::dvec3& d) : shape_(now.shape) {
    rate_ = drift_ = glm::dot(d, motion.velocity);
    if (motion.spin == glm::dvec3(0.0)) return;
    const double arm = arm_of(shape_, motion);
    if (turn_as_solid_of_revolution(now, motion, d, arm)) return;
    const glm::dvec3 across = glm::cross(d, motion.spin);
    bend_ = 0.5 * glm::length(across) * glm::length(motion.spin) * arm * 1.00001;  // matrices are rotations up to 1e-6
    // dot(d, spin × r) = dot(d × spin, r)
    turned_ = Pair::local(now.pose.rotation, across);
    drift_ -= glm::dot(turned_, motion.pivot);
    set_support(Pair::local(now.pose.rotation, d));
}

void Advance::set_support(const glm::dvec3& local) {
    const Support farthest = core_support(shape_, local);
    local_ = local;
    now_ = farthest.along;
    rate_ = drift_ + glm::dot(turned_, farthest.point);
    turns_ = true;
}

// Where that bound is the lesser one. A pose that is not quite a rotation makes an ellipse of the disc, which turns.
bool Advance::turn_as_solid_of_revolution(const ShapeAtPose& now, const Motion& motion, const glm::dvec3& d,
                                          double arm) {
    if (!is_solid_of_revolution(shape_) || motion.pivot.x != 0.0 || motion.pivot.z != 0.0) return false;
    const glm::dvec3 axis = now.pose.rotation[1], moves = glm::cross(motion.spin, axis);
    const double spin = glm::length(motion.spin), tilt = glm::length(moves) * 1.00001 + 0x1p-50 * spin;
    const double bend = 0.5 * (spin + tilt) * tilt * arm * 1.00001;
    if (!(bend < 0.5 * glm::length(glm::cross(d, motion.spin)) * spin * arm)) return false;
    turned_ = Pair::local(now.pose.rotation, glm::cross(d, glm::cross(axis, moves)));
    drift_ += spin * arm * 4.0 * skew(now.pose.rotation) - glm::dot(turned_, motion.pivot);
    bend_ = bend;
    set_support(Pair::local(now.pose.rotation, d));
    return true;
}

Flight::Flight(const ShapeAtPose& a, const Motion& motion_a, const ShapeAtPose& b, const Motion& motion_b)
    : shape_a_(a.shape),
      shape_b_(b.shape),
      start_a_{a.pose.rotation, glm::dvec3(0.0)},
      start_b_{b.pose.rotation, b.pose.translation - a.pose.translation},
      turn_a_{glm::dvec3(0.0), motion_a.spin, motion_a.pivot},
      way_b_{motion_b.velocity - motion_a.velocity, motion_b.spin, motion_b.pivot},
      origin_(a.pose.translation),
      velocity_(motion_a.velocity),
      pose_a_(start_a_),
      pose_b_(start_b_) {
    const double speed = glm::length(way_b_.velocity);
    growth_ = 0x1p-47 * speed;
    size_ = glm::length(start_b_.translation);
    const auto add = [&](const Shape& shape, const Motion& motion) {
        if (shape.kind() == Kind::half_space) return;
        const double arm = arm_of(shape, motion);
        error_at_start_ += 0x1p-47 * arm;
        if (motion.spin != glm::dvec3(0.0)) growth_ += 0x1p-47 * arm * glm::length(motion.spin);
        size_ += shape.core_radius() + shape.radius();
    };
    add(shape_a_, turn_a_);
    add(shape_b_, way_b_);
}

void Flight::move_to(double time) {
    if (time == time_) return;
    time_ = time;
    pose_a_ = moved(start_a_, turn_a_, time);
    pose_b_ = moved(start_b_, way_b_, time);
}

bool Flight::turns() const {
    return turn_a_.spin != glm::dvec3(0.0) || way_b_.spin != glm::dvec3(0.0);
}

bool Flight::rests() const {
    return !turns() && way_b_.velocity == glm::dvec3(0.0);
}

double Flight::way(double within) const {
    const auto turn = [](const Shape& shape, const Motion& motion) {
        return motion.spin == glm::dvec3(0.0) ? 0.0 : glm::length(motion.spin) * arm_of(shape, motion);
    };
    return within * (glm::length(way_b_.velocity) + turn(shape_a_, turn_a_) + turn(shape_b_, way_b_));
}

glm::dvec3 Flight::in_world(const glm::dvec3& point) const {
    return origin_ + (point + time_ * velocity_);
}

Closing Flight::closing(const glm::dvec3& normal) const {
    return {Advance(a(), turn_a_, normal), Advance(b(), way_b_, -normal), growth_};
}

// `*this` is convex and 0 at 0. As long as the same points are farthest, it is a quadratic.
double Closing::safe_step(double gap, double limit) const {
    const double rate = (a_.rate() + b_.rate()) + growth_;
    const bool turns = a_.turns() || b_.turns();
    double high = reaches(rate, a_.bend() + b_.bend(), gap) * (turns ? 0.995 : 1.0 - 0x1p-40);
    if (!(high < limit)) high = limit;
    double at_high = (*this)(high);
    if (at_high < gap || !turns) return high;
    double low = 0.0, at_low = 0.0;
    for (int i = 0; i < 200 && high - low > 0.01 * low; ++i) {
        // A chord of a convex function lies above it: where it reaches the gap is safe.
        const double chord = low + (gap - at_low) / (at_high - at_low) * (high - low);
        const double next = i % 2 == 0 && chord > low && chord < high ? chord : 0.5 * (low + high);
        if (next <= low || next >= high) break;
        const double at_next = (*this)(next);
        if (at_next < gap)
            low = next, at_low = at_next;
        else
            high = next, at_high = at_next;
    }
    return low;
}

}  // namespace crofton::convex
