// SPDX-License-Identifier: MIT
// mass_properties: volume, centre of mass and inertia of a shape.
#include <crofton/convex/shape.hpp>
#include <glm/matrix.hpp>
#include <numbers>

#include "mass_integrals.hpp"
#include "rounded_mass.hpp"

namespace crofton::convex {
namespace {

constexpr double kPi = std::numbers::pi;

// Symmetric about y: ∫ x² = ∫ z² and ∫ y², both about the center of mass.
MassProperties turned(double volume, double center_y, double across, double along) {
    MassProperties mass;
    mass.volume = volume;
    mass.center.y = center_y;
    mass.inertia[0][0] = mass.inertia[2][2] = across + along;
    mass.inertia[1][1] = 2.0 * across;
    return mass;
}

MassProperties of_capsule(double h, double r) {
    // A cylinder of height 2h and two half spheres, whose centers of mass are 3r/8 beyond its ends.
    const double cylinder = 2.0 * kPi * r * r * h, sphere = 4.0 / 3.0 * kPi * r * r * r;
    const double across = cylinder * r * r / 4.0 + sphere * r * r / 5.0;
    const double along = cylinder * h * h / 3.0 + sphere * (r * r / 5.0 + h * h + 0.75 * h * r);
    return turned(cylinder + sphere, 0.0, across, along);
}

MassProperties of_cylinder(double h, double r) {
    const double volume = 2.0 * kPi * r * r * h;
    return turned(volume, 0.0, volume * r * r / 4.0, volume * h * h / 3.0);
}

MassProperties of_cone(double h, double r) {
    // Height 2h: the center of mass is a quarter up, ∫ y² about it is 3/80 (2h)² of the volume.
    const double volume = 2.0 / 3.0 * kPi * r * r * h;
    return turned(volume, -0.5 * h, volume * 0.15 * r * r, volume * 0.15 * h * h);
}

MassProperties of_box(const glm::dvec3& h) {
    MassProperties mass;
    mass.volume = 8.0 * h.x * h.y * h.z;
    for (int k = 0; k < 3; ++k) {
        const double u = h[(k + 1) % 3], v = h[(k + 2) % 3];
        mass.inertia[k][k] = mass.volume * (u * u + v * v) / 3.0;
    }
    return mass;
}

Result<MassProperties> of_compound(const Compound& compound) {
    // About the middle, so that a compound far from its frame's origin loses nothing.
    const glm::dvec3 origin = compound.bounds().center();
    Moments sum;
    for (std::size_t i = 0; i < compound.children().size(); ++i) {
        const CompoundChild& child = compound.children()[i];
        const Result<MassProperties> mass = mass_properties(child.shape);
        if (!mass) return fail(mass.error().code, i, mass.error().message);
        const glm::dmat3& turn = child.pose.rotation;
        const glm::dvec3 at = turn * mass->center + child.pose.translation - origin;
        // ∫ x xᵀ about the center is half the trace of the inertia, less the inertia.
        const glm::dmat3& inertia = mass->inertia;
        const double half_trace = 0.5 * (inertia[0][0] + inertia[1][1] + inertia[2][2]);
        const glm::dmat3 central = turn * (half_trace * glm::dmat3(1.0) - inertia) * glm::transpose(turn);
        sum.volume += mass->volume;
        sum.first += mass->volume * at;
        sum.second += central + mass->volume * glm::outerProduct(at, at);
    }
    return mass_of(sum, origin);
}

}  // namespace

Result<MassProperties> mass_properties(const Shape& shape) {
    const glm::dvec3& half = shape.half_extents();
    const double radius = shape.radius();
    switch (shape.kind()) {
        case Kind::sphere:
            return of_capsule(0.0, radius);
        case Kind::capsule:
            return of_capsule(shape.vertex(1).y, radius);
        case Kind::half_space:
            return fail(ErrorCode::unsupported, kNoItem, "mass_properties: a half-space has no finite volume");
        default:
            break;
    }
    if (shape.kind() == Kind::compound) return of_compound(*shape.compound());
    if (!shape.is_convex())
        return fail(ErrorCode::unsupported, kNoItem,
                    "mass_properties: a surface has no volume; use the hull of its points or a compound of pieces");
    if (radius > 0.0) {
        const bool turns = shape.kind() == Kind::cylinder || shape.kind() == Kind::cone;
        return turns ? mass_of_rounded_revolution(shape) : mass_of_rounded_polytope(shape);
    }
    if (shape.kind() == Kind::cylinder) return of_cylinder(half.y, half.x);
    if (shape.kind() == Kind::cone) return of_cone(half.y, half.x);
    if (shape.kind() == Kind::box) return of_box(half);
    if (shape.kind() == Kind::hull) return shape.hull()->mass();
    MassProperties flat;
    flat.center = (shape.vertex(0) + shape.vertex(1) + shape.vertex(2)) / 3.0;
    return flat;
}

}  // namespace crofton::convex
