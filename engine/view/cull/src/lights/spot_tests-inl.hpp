// SPDX-License-Identifier: MIT
// Spot lights against froxels, a pair of them a lane. Compiled once per instruction set (Highway). Error bounds: δ and
// η of light_tests-inl.hpp. A point computed to be in froxel or light is one of the exact body's, moved by less than 4
// δ.
#include <hwy/highway.h>
#include <limits>

#include "lights/light_tests-inl.hpp"

#if defined(CROFTON_CULL_SPOT_TESTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_CULL_SPOT_TESTS_INL
#undef CROFTON_CULL_SPOT_TESTS_INL
#else
#define CROFTON_CULL_SPOT_TESTS_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {

// A point or a direction in each lane.
template <class D>
struct Vectors {
    hn::Vec<D> u, v, w;

    HWY_INLINE hn::Vec<D> dot(const Vectors& o) const {
        return hn::MulAdd(u, o.u, hn::MulAdd(v, o.v, hn::Mul(w, o.w)));
    }
    HWY_INLINE Vectors plus(const Vectors& o, hn::Vec<D> times) const {
        return {hn::MulAdd(o.u, times, u), hn::MulAdd(o.v, times, v), hn::MulAdd(o.w, times, w)};
    }
    HWY_INLINE Vectors plus(const Vectors& o) const { return {hn::Add(u, o.u), hn::Add(v, o.v), hn::Add(w, o.w)}; }
    HWY_INLINE Vectors minus(const Vectors& o) const { return {hn::Sub(u, o.u), hn::Sub(v, o.v), hn::Sub(w, o.w)}; }
    HWY_INLINE Vectors times(hn::Vec<D> by) const { return {hn::Mul(u, by), hn::Mul(v, by), hn::Mul(w, by)}; }
    HWY_INLINE Vectors cross(const Vectors& o) const {
        return {hn::MulSub(v, o.w, hn::Mul(w, o.v)), hn::MulSub(w, o.u, hn::Mul(u, o.w)),
                hn::MulSub(u, o.v, hn::Mul(v, o.u))};
    }
    HWY_INLINE hn::Vec<D> largest() const { return hn::Max(hn::Abs(u), hn::Max(hn::Abs(v), hn::Abs(w))); }
    static HWY_INLINE Vectors pick(hn::Mask<D> which, const Vectors& a, const Vectors& b) {
        return {hn::IfThenElse(which, a.u, b.u), hn::IfThenElse(which, a.v, b.v), hn::IfThenElse(which, a.w, b.w)};
    }
};

// A spot light's cone with its cap, in coordinates relative to its apex.
template <class D>
struct Sector {
    using V = hn::Vec<D>;
    Vectors<D> axis, across[2];  // perpendicular to each other
    V cosine, sine, range, eta;

    // The directions across the axis are those of orthonormal_frame.
    HWY_INLINE explicit Sector(const LightLanes<D>& light)
        : axis{light.axis[0], light.axis[1], light.axis[2]},
          cosine(light.cosine),
          sine(light.sine),
          range(light.radius),
          eta(light.eta) {
        const V one = hn::Set(D(), hn::TFromD<D>(1)), sign = hn::CopySign(one, axis.w);
        const V a = hn::Neg(hn::Div(one, hn::Add(sign, axis.w))), b = hn::Mul(hn::Mul(axis.u, axis.v), a);
        across[0] = {hn::MulAdd(hn::Mul(sign, axis.u), hn::Mul(axis.u, a), one), hn::Mul(sign, b),
                     hn::Neg(hn::Mul(sign, axis.u))};
        across[1] = {b, hn::MulAdd(axis.v, hn::Mul(axis.v, a), sign), hn::Neg(axis.v)};
    }

    // The part along the axis, and the rest.
    struct Split {
        V along, across;
        Vectors<D> rest;
    };
    HWY_INLINE Split split(const Vectors<D>& y) const {
        const V along = y.dot(axis);
        const Vectors<D> rest = y.plus(axis, hn::Neg(along));
        return {along, hn::Sqrt(rest.dot(rest)), rest};
    }

    // A sphere of radius η around y lies within.
    HWY_INLINE hn::Mask<D> contains(const Vectors<D>& y, const Split& of) const {
        const V margin = hn::Sub(range, eta);
        const V to_side = hn::Sub(hn::Mul(of.along, sine), hn::Mul(of.across, cosine));
        const auto in_range = hn::And(hn::Gt(margin, hn::Zero(D())), hn::Lt(y.dot(y), hn::Mul(margin, margin)));
        return hn::And(in_range, hn::Gt(to_side, eta));
    }

    // The point nearest to y.
    HWY_INLINE Vectors<D> nearest(const Vectors<D>& y, const Split& of) const {
        const D d;
        const V zero = hn::Zero(d), least = hn::Set(d, hn::TFromD<D>(1e-30));
        const auto in_cone = hn::Le(hn::Mul(of.across, cosine), hn::Mul(of.along, sine));
        const V length = hn::Sqrt(hn::Max(y.dot(y), hn::Mul(least, least)));
        const V shrink = hn::Min(hn::Set(d, hn::TFromD<D>(1)), hn::Div(range, hn::Max(length, least)));
        const V on_side = hn::Max(zero, hn::Min(range, hn::MulAdd(of.along, cosine, hn::Mul(of.across, sine))));
        const V of_axis = hn::Mul(on_side, cosine),
                of_rest = hn::Div(hn::Mul(on_side, sine), hn::Max(of.across, least));
        const auto component = [&](V whole, V axial, V rest) HWY_ATTR {
            return hn::IfThenElse(in_cone, hn::Mul(whole, shrink), hn::MulAdd(axial, of_axis, hn::Mul(rest, of_rest)));
        };
        return {component(y.u, axis.u, of.rest.u), component(y.v, axis.v, of.rest.v),
                component(y.w, axis.w, of.rest.w)};
    }

    // The middle of the largest sphere within.
    HWY_INLINE Vectors<D> center() const {
        const V along = hn::Div(range, hn::Add(hn::Set(D(), hn::TFromD<D>(1)), sine));
        return {hn::Mul(axis.u, along), hn::Mul(axis.v, along), hn::Mul(axis.w, along)};
    }

    // The point farthest along m, which is not 0. What of m is across the axis is taken along two fixed directions.
    // Where there is little, taking away what is along the axis would leave nothing but rounding. Less than 1e-12 of
    // what is along it gives a point between the axis and the rim, which is as far but for rounding.
    HWY_INLINE Vectors<D> farthest(const Vectors<D>& m) const {
        const D d;
        const V zero = hn::Zero(d), least = hn::Set(d, hn::TFromD<D>(1e-30));
        const V along = m.dot(axis), p = m.dot(across[0]), q = m.dot(across[1]);
        const V beside = hn::Sqrt(hn::MulAdd(p, p, hn::Mul(q, q)));
        const auto in_cone = hn::Le(hn::Mul(beside, cosine), hn::Mul(along, sine));
        const auto behind = hn::Le(hn::MulAdd(along, cosine, hn::Mul(beside, sine)), zero);
        const V little = hn::MulAdd(hn::Abs(along), hn::Set(d, hn::TFromD<D>(1e-12)), least);
        const V of_whole = hn::Div(range, hn::Max(hn::Sqrt(m.dot(m)), least)), of_axis = hn::Mul(range, cosine),
                of_side = hn::Div(hn::Mul(range, sine), hn::Max(beside, little));
        const Vectors<D> side = across[0].times(p).plus(across[1], q);
        const auto component = [&](V whole, V axial, V sideways) HWY_ATTR {
            const V on_side = hn::IfThenZeroElse(behind, hn::MulAdd(axial, of_axis, hn::Mul(sideways, of_side)));
            return hn::IfThenElse(in_cone, hn::Mul(whole, of_whole), on_side);
        };
        return {component(m.u, axis.u, side.u), component(m.v, axis.v, side.v), component(m.w, axis.w, side.w)};
    }
};

// The point of the froxels farthest along m, relative to the apex.
template <class D>
HWY_INLINE Vectors<D> farthest(const FroxelLanes<D>& froxels, const Vectors<D>& apex, const Vectors<D>& m) {
    const hn::Vec<D> zero = hn::Zero(D());
    const auto right = hn::Gt(m.u, zero), above = hn::Gt(m.v, zero);
    const auto at = [&](hn::Vec<D> w) HWY_ATTR {
        const Vectors<D> corner{hn::IfThenElse(right, froxels.column(1, w), froxels.column(0, w)),
                                hn::IfThenElse(above, froxels.row(1, w), froxels.row(0, w)), w};
        return corner.minus(apex);
    };
    const Vectors<D> low = at(froxels.low), high = at(froxels.high);
    return Vectors<D>::pick(hn::Gt(low.dot(m), high.dot(m)), low, high);
}

// Takes the point of the froxel nearest to the light's middle: if it is well inside the light, the two meet. From there
// it takes the direction m to the nearest point of the light: if the froxel is farther along m than the light, they do
// not meet. Both sides, along three axes, are off by less than 4 δ |m|, and η ≥ 8 δ.
template <class D>
HWY_INLINE Lit<D> test_spot(const FroxelLanes<D>& froxels, const LightLanes<D>& light) {
    using V = hn::Vec<D>;
    const D d;
    const Sector<D> sector(light);
    const Vectors<D> apex{light.at[0], light.at[1], light.at[2]};
    Lit<D> lit = test_sphere(froxels, light);
    lit.yes = hn::FirstN(d, 0);  // of the sphere of its range
    const Vectors<D> x = apex.plus(sector.center());
    V w = hn::Max(froxels.low, hn::Min(froxels.high, x.w));
    w = NearestAt<D>(froxels, x.u, x.v, x.w, w).next(froxels.low, froxels.high);
    w = NearestAt<D>(froxels, x.u, x.v, x.w, w).next(froxels.low, froxels.high);
    const NearestAt<D> p(froxels, x.u, x.v, x.w, w);
    const Vectors<D> y = Vectors<D>{p.u, p.v, p.w}.minus(apex);
    const auto split = sector.split(y);
    lit.yes = sector.contains(y, split);
    const Vectors<D> m = y.minus(sector.nearest(y, split));
    const Vectors<D> back = m.times(hn::Set(d, hn::TFromD<D>(-1)));
    const V gap = m.dot(farthest(froxels, apex, back).minus(sector.farthest(m)));
    lit.no = hn::Or(lit.no, hn::Gt(gap, hn::Mul(sector.eta, hn::Sqrt(m.dot(m)))));
    return lit;
}

// A portal in each lane (Snethen: "XenoCollide: Complex Collision Made Simple", 2008). Let A be the set of all
// differences of a point of the froxel and one of the light. A triangle of points of A is pierced by the ray from a
// point v0 within A through the origin. It is moved outwards until the origin is before it or A ends before the origin.
template <class D>
class Portal {
    using V = hn::Vec<D>;
    using M = hn::Mask<D>;

  public:
    HWY_INLINE Portal(const FroxelLanes<D>& froxels, const LightLanes<D>& light)
        : froxels_(froxels), sector_(light), apex_{light.at[0], light.at[1], light.at[2]} {
        const D d;
        lit_ = {hn::FirstN(d, 0), hn::FirstN(d, 0)};
        const V half = hn::Set(d, hn::TFromD<D>(0.5)), middle = hn::Mul(half, hn::Add(froxels.low, froxels.high));
        const Vectors<D> center{hn::Mul(half, hn::Add(froxels.column(0, middle), froxels.column(1, middle))),
                                hn::Mul(half, hn::Add(froxels.row(0, middle), froxels.row(1, middle))), middle};
        v_[0] = center.minus(apex_).minus(sector_.center());
        v_[1] = support(v_[0].times(hn::Set(d, hn::TFromD<D>(-1))));
        v_[2] = support(v_[1].cross(v_[0]));
        const Vectors<D> m = side();
        const M turned = hn::Gt(m.dot(v_[0]), hn::Zero(d));
        const Vectors<D> kept = v_[1];
        v_[1] = Vectors<D>::pick(turned, v_[2], v_[1]);
        v_[2] = Vectors<D>::pick(turned, kept, v_[2]);
        found_ = hn::FirstN(d, 0);
        v_[3] = v_[2];
    }

    HWY_INLINE Lit<D> run(int rounds) {
        const D d;
        for (int round = 0; round < rounds && !hn::AllTrue(d, hn::Or(lit_.yes, lit_.no)); ++round) {
            const Vectors<D> outward = v_[2].minus(v_[1]).cross(v_[3].minus(v_[1]));
            const Vectors<D> s = support(Vectors<D>::pick(found_, outward, side()));
            step(s);
            note_origin_inside();
        }
        return lit_;
    }

  private:
    // Returns the normal of the plane through v0, v1 and v2.
    HWY_INLINE Vectors<D> side() const { return v_[1].minus(v_[0]).cross(v_[2].minus(v_[0])); }

    // The point of A farthest along m. If even that is before the origin, they are apart.
    HWY_INLINE Vectors<D> support(const Vectors<D>& m) {
        const D d;
        const V least = hn::Set(d, hn::TFromD<D>(1e-30));
        const Vectors<D> unit = m.times(hn::Div(hn::Set(d, hn::TFromD<D>(1)), hn::Max(m.largest(), least)));
        const Vectors<D> back = unit.times(hn::Set(d, hn::TFromD<D>(-1)));
        const Vectors<D> result = farthest(froxels_, apex_, unit).minus(sector_.farthest(back));
        const V limit = hn::Neg(hn::Mul(sector_.eta, hn::Sqrt(unit.dot(unit))));
        lit_.no = hn::Or(lit_.no, hn::Lt(result.dot(unit), limit));
        return result;
    }

    HWY_INLINE void step(const Vectors<D>& s) {
        const V zero = hn::Zero(D());
        const Vectors<D> by = s.cross(v_[0]);
        const V of_1 = v_[1].dot(by), of_2 = v_[2].dot(by), of_3 = v_[3].dot(by);
        // No portal yet: the ray passes beyond the side of v1 and s, or of s and v2, or s completes it.
        const M beyond_2 = hn::Lt(of_1, zero), beyond_1 = hn::AndNot(beyond_2, hn::Gt(of_2, zero));
        const M complete = hn::Not(hn::Or(beyond_1, beyond_2));
        // In a portal, which of its three parts around s the ray pierces.
        const M after_1 = hn::Gt(of_1, zero), after_2 = hn::Gt(of_2, zero), after_3 = hn::Gt(of_3, zero);
        const M part_1 = hn::Or(hn::And(after_1, after_2), hn::AndNot(after_1, hn::Not(after_3)));
        const M part_2 = hn::AndNot(after_1, after_3);
        const M part_3 = hn::AndNot(after_2, after_1);
        v_[1] = Vectors<D>::pick(hn::Or(hn::And(found_, part_1), hn::AndNot(found_, beyond_1)), s, v_[1]);
        v_[2] = Vectors<D>::pick(hn::Or(hn::And(found_, part_2), hn::AndNot(found_, beyond_2)), s, v_[2]);
        v_[3] = Vectors<D>::pick(hn::Or(hn::And(found_, part_3), hn::AndNot(found_, complete)), s, v_[3]);
        found_ = hn::Or(found_, complete);
    }

    // The origin is more than η within the tetrahedron. λ_i is its determinant with v_i replaced by the origin, n_i
    // the normal of the face across from v_i. Determinants are off by less than 2^-18 M³, M the largest coordinate.
    HWY_INLINE void note_origin_inside() {
        const D d;
        const Vectors<D> a = v_[1].cross(v_[2]), b = v_[2].cross(v_[3]), c = v_[3].cross(v_[1]);
        const Vectors<D> p = v_[0].cross(v_[1]), q = v_[0].cross(v_[2]), r = v_[0].cross(v_[3]);
        const V lambda[4] = {v_[1].dot(b), hn::Neg(v_[0].dot(b)), hn::Neg(v_[0].dot(c)), hn::Neg(v_[0].dot(a))};
        const Vectors<D> normal[4] = {a.plus(b).plus(c), q.plus(b).minus(r), r.plus(c).minus(p), p.plus(a).minus(q)};
        V largest = v_[0].largest();
        for (int i = 1; i < 4; ++i) largest = hn::Max(largest, v_[i].largest());
        // (8 M)³ overflows before any sum of products does: six of them are below 6 M³. It is infinite then, and so is
        // the margin: nothing is claimed.
        largest = hn::Mul(largest, hn::Set(d, 8));
        const V error = hn::MulAdd(hn::Mul(hn::Mul(largest, largest), largest), hn::Set(d, hn::TFromD<D>(0x1p-27)),
                                   hn::Set(d, hn::TFromD<D>(1e-36)));
        M above = found_, below = found_;
        for (int i = 0; i < 4; ++i) {
            const V margin = hn::MulAdd(sector_.eta, hn::Sqrt(normal[i].dot(normal[i])), error);
            above = hn::And(above, hn::Gt(lambda[i], margin));
            below = hn::And(below, hn::Lt(lambda[i], hn::Neg(margin)));
        }
        lit_.yes = hn::Or(lit_.yes, hn::Or(above, below));
    }

    const FroxelLanes<D>& froxels_;
    Sector<D> sector_;
    Vectors<D> apex_, v_[4];
    M found_;
    Lit<D> lit_;
};

}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
