// SPDX-License-Identifier: MIT
// Boxes against the few planes that each of them may cross. Compiled once per instruction set (Highway).
#include "tree/block_tests-inl.hpp"

#if defined(CROFTON_CULL_OWN_PLANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_CULL_OWN_PLANES_INL
#undef CROFTON_CULL_OWN_PLANES_INL
#else
#define CROFTON_CULL_OWN_PLANES_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {

// Planes before a chunk, as tables of registers: every lane looks its own plane up. Entry 0 is a plane that contains
// everything, for lanes that have no further one.
class PlaneTable {
  public:
    static constexpr std::size_t kEntries = hn::MaxLanes(DF());
    // Tables of four entries would hold too few planes.
    static bool takes(std::uint32_t planes) { return kEntries >= 8 && hwy::PopCount(planes) < kEntries; }

    struct Plane {
        VF normal[3], offset, slack;
    };

    HWY_INLINE PlaneTable(const KernelView& view, std::uint32_t planes, const LocalPlane* local) {
        for (unsigned j = 0; j < 3; ++j) numbers_[j][0] = 0.0f;
        numbers_[3][0] = 1e30f;
        numbers_[4][0] = 0.0f;
        for (std::uint32_t rest = planes; rest; rest &= rest - 1) {
            const auto i = hwy::Num0BitsBelowLS1Bit_Nonzero32(rest);
            ++count_;
            for (unsigned j = 0; j < 3; ++j) numbers_[j][count_] = view.planes[i].normal_f[j];
            numbers_[3][count_] = local[i].offset;
            numbers_[4][count_] = local[i].slack;
        }
    }

    [[nodiscard]] HWY_INLINE unsigned count() const { return count_; }
    [[nodiscard]] HWY_INLINE VF number(unsigned which, unsigned entry) const {
        return hn::Set(DF(), numbers_[which][entry]);
    }
    [[nodiscard]] HWY_INLINE float scalar(unsigned which, unsigned entry) const { return numbers_[which][entry]; }

    [[nodiscard]] HWY_INLINE Plane at(VU entries) const {
        const DF d;
        const auto indices = hn::IndicesFromVec(d, entries);
        const auto look = [&](unsigned which)
                              HWY_ATTR { return hn::TableLookupLanes(hn::Load(d, numbers_[which]), indices); };
        return {{look(0), look(1), look(2)}, look(3), look(4)};
    }

  private:
    alignas(64) float numbers_[5][kEntries];  // normal, offset, slack
    unsigned count_ = 0;
};

// Planes as bits, lane by lane: bit n + 1 is entry n of the table. Lanes take them one after the other.
class PlaneBits {
  public:
    HWY_INLINE explicit PlaneBits(unsigned planes) : bits_(hn::Set(DI(), (4 << planes) - 4)) {}
    HWY_INLINE void remove(unsigned entry, MF lanes) {
        const DI di;
        bits_ = hn::AndNot(hn::IfThenElseZero(hn::RebindMask(di, lanes), hn::Set(di, 2 << entry)), bits_);
    }
    [[nodiscard]] HWY_INLINE bool any() const { return !hn::AllTrue(DI(), hn::Eq(bits_, hn::Zero(DI()))); }
    // Each lane's next entry, 0 for none: from the exponent of its lowest bit, which is 127 + 1 + entry.
    HWY_INLINE VU next() {
        const DU du;
        const VI low = hn::And(bits_, hn::Neg(bits_));
        bits_ = hn::AndNot(low, bits_);
        const VU exponent = hn::ShiftRight<23>(hn::BitCast(du, hn::ConvertTo(DF(), low)));
        return hn::And(exponent, hn::Set(du, static_cast<std::uint32_t>(PlaneTable::kEntries - 1)));
    }

  private:
    VI bits_;
};

// All planes against the balls around the boxes. A box is certainly inside a plane whose value at the centre exceeds
// its slack and the radius, for normals up to 1.0005 long. The slacks have room for the roundings here. They include a
// box's own, where it is far from the eye and the plane's slack does not know of it.
HWY_INLINE PlaneBits planes_open(const PlaneTable& table, const BoxLanes& bounds) {
    const DF d;
    PlaneBits open(table.count());
    const VF radius = hn::MulAdd(bounds.ball, hn::Set(d, 1.0006f), bounds.edge_slack);
    for (unsigned n = 1; n <= table.count(); ++n) {
        const VF offset = hn::Set(d, table.scalar(3, n) - table.scalar(4, n));
        const VF value =
            hn::MulAdd(table.number(0, n), bounds.x,
                       hn::MulAdd(table.number(1, n), bounds.y, hn::MulAdd(table.number(2, n), bounds.z, offset)));
        open.remove(n, hn::Ge(value, radius));
    }
    return open;
}

// As test_boxes() and resolve() together. `needs_edge_test` are those that went through the second stage.
HWY_INLINE BoxTest test_own_planes(const PlaneTable& table, const BoxLanes& bounds, bool exact) {
    const DF d;
    const DI di;
    const VI zero = hn::Zero(di);
    PlaneBits open = planes_open(table, bounds);
    BoxRows box(bounds.unit);
    MF sure = bounds.present;
    VI cuts = zero, rejected = zero, outside = zero;  // how many planes cut; the others as signs
    unsigned count = 0;
    for (; open.any(); ++count) {
        const PlaneTable::Plane plane = table.at(open.next());
        BoxRows::Row& row = box.rows[count];
        row.slack = hn::Add(plane.slack, bounds.edge_slack);
        row.base =
            hn::MulAdd(plane.normal[0], bounds.x,
                       hn::MulAdd(plane.normal[1], bounds.y, hn::MulAdd(plane.normal[2], bounds.z, plane.offset)));
        bounds.slopes(plane.normal, row.slope);
        row.reach = hn::Add(hn::Add(hn::Abs(row.slope[0]), hn::Abs(row.slope[1])), hn::Abs(row.slope[2]));
        // Beyond 0 the plane does not cut the bound, and the base's sign tells on which side that lies.
        const VF beyond = hn::NegMulAdd(row.reach, box.unit, hn::Abs(row.base));
        sure = hn::And(sure, hn::Gt(hn::Abs(beyond), row.slack));
        const VI side = hn::BitCast(di, beyond);
        cuts = hn::Sub(cuts, hn::ShiftRight<31>(side));
        rejected = hn::Or(rejected, hn::AndNot(side, hn::BitCast(di, row.base)));
        outside = hn::Or(outside, hn::BitCast(di, hn::Sub(row.base, row.slack)));
    }
    const auto mask = [&](hn::Mask<DI> lanes) HWY_ATTR { return hn::RebindMask(d, lanes); };
    BoxTest result;
    result.undecided = hn::AndNot(sure, bounds.present);
    result.improper = result.needs_edge_test = hn::FirstN(d, 0);
    const MF kept = hn::AndNot(mask(hn::Lt(rejected, zero)), sure);
    result.straddling = hn::And(kept, mask(hn::Gt(cuts, zero)));
    result.inside = hn::AndNot(result.straddling, kept);
    if (!exact) return result;
    const MF needed = hn::And(hn::And(kept, mask(hn::Gt(cuts, hn::Set(di, 1)))), mask(hn::Lt(outside, zero)));
    if (hn::AllFalse(d, needed)) return result;
    result.straddling = hn::AndNot(needed, result.straddling);
    result.needs_edge_test = needed;
    box.keep_first(count, needed);
    resolve(box, result);
    result.needs_edge_test = needed;
    return result;
}

}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
