// SPDX-License-Identifier: MIT
// Boxes against all of a chunk's planes, then against those that each of them crosses. Compiled once per instruction
// set (Highway).
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
        VF normal[3], offset, error_bound;
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
            numbers_[4][count_] = local[i].error_bound;
            largest_error_bound_ = std::max(largest_error_bound_, local[i].error_bound);
        }
    }

    [[nodiscard]] HWY_INLINE unsigned count() const { return count_; }
    [[nodiscard]] HWY_INLINE VF number(unsigned which, unsigned entry) const {
        return hn::Set(DF(), numbers_[which][entry]);
    }
    [[nodiscard]] HWY_INLINE float largest_error_bound() const { return largest_error_bound_; }

    [[nodiscard]] HWY_INLINE Plane at(VU entries) const {
        const DF d;
        const auto indices = hn::IndicesFromVec(d, entries);
        const auto look = [&](unsigned which)
                              HWY_ATTR { return hn::TableLookupLanes(hn::Load(d, numbers_[which]), indices); };
        return {{look(0), look(1), look(2)}, look(3), look(4)};
    }

  private:
    alignas(64) float numbers_[5][kEntries];  // normal, offset, error bound
    unsigned count_ = 0;
    float largest_error_bound_ = 0.0f;
};

// Planes as bits, lane by lane: bit n + 1 is entry n of the table, and so is bit n + 17. Lanes take them one after the
// other, those of the first half first. Up to twelve planes have bits of their own, more than a table may have entries.
class PlaneBits {
  public:
    static constexpr std::uint32_t bit(unsigned entry) { return 2u << entry; }
    static constexpr std::uint32_t late_bit(unsigned entry) { return bit(entry) << 16; }

    HWY_INLINE explicit PlaneBits(VU bits) : bits_(hn::BitCast(DI(), bits)) {}
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

// As test_boxes(), with the largest of the planes' error bounds for each of them. `cut` are the planes that a box is
// not certainly inside of, as PlaneBits; first those that its centre is not: pairs of others need no test.
HWY_INLINE BoxTest test_all_planes(const PlaneTable& table, const BoxLanes& bounds, bool exact, VU& cut) {
    const DF d;
    const DU du;
    const VF error = hn::Add(bounds.edge_error_bound, hn::Set(d, table.largest_error_bound())),
             most = hn::Set(d, 3e38f);
    VF top = most, bottom = most, middle = most;  // the least of all planes
    cut = hn::Zero(du);
    for (unsigned n = 1; n <= table.count(); ++n) {
        const VF x = table.number(0, n), y = table.number(1, n), z = table.number(2, n);
        const VF base = hn::MulAdd(x, bounds.x, hn::MulAdd(y, bounds.y, hn::MulAdd(z, bounds.z, table.number(3, n))));
        VF slope[3];
        const VF normal[3] = {x, y, z};
        bounds.slopes(normal, slope);
        const VF projected_radius = hn::Add(hn::Add(hn::Abs(slope[0]), hn::Abs(slope[1])), hn::Abs(slope[2]));
        const VF low = hn::NegMulAdd(projected_radius, bounds.unit, base);
        top = hn::Min(top, hn::MulAdd(projected_radius, bounds.unit, base));
        bottom = hn::Min(bottom, low);
        middle = hn::Min(middle, base);
        const auto open = hn::RebindMask(du, hn::Lt(low, error));
        const auto out = hn::RebindMask(du, hn::Lt(base, error));
        const VU bit = hn::IfThenElse(out, hn::Set(du, PlaneBits::bit(n)), hn::Set(du, PlaneBits::late_bit(n)));
        cut = hn::Or(cut, hn::IfThenElseZero(open, bit));
    }
    const VF beyond = hn::Neg(error);
    BoxTest result;
    result.false_positives = hn::FirstN(d, 0);
    result.inside = hn::And(bounds.present, hn::Ge(bottom, error));
    const MF crossing = hn::And(bounds.present, hn::And(hn::Ge(top, error), hn::Lt(bottom, beyond)));
    // A box that crosses one plane and lies inside all others meets the frustum; so does one whose centre is inside.
    const auto once = hn::Eq(hn::And(cut, hn::Sub(cut, hn::Set(du, 1))), hn::Zero(du));
    const MF meets = exact ? hn::Or(hn::RebindMask(d, once), hn::Ge(middle, error)) : bounds.present;
    result.straddling = hn::And(crossing, meets);
    result.needs_edge_test = hn::AndNot(meets, crossing);
    const MF decided = hn::Or(hn::Or(result.inside, crossing), hn::Lt(top, beyond));
    result.undecided = hn::AndNot(decided, bounds.present);
    return result;
}

// The second stage, of boxes that need it, against the planes in `cut`; all others contain them.
HWY_INLINE BoxTest resolve_own_planes(const PlaneTable& table, const BoxLanes& bounds, VU cut) {
    const DF d;
    PlaneBits open(cut);
    BoxRows box(bounds.unit);
    unsigned count = 0;
    for (; open.any(); ++count) {
        const PlaneTable::Plane plane = table.at(open.next());
        BoxRows::Row& row = box.rows[count];
        row.error_bound = hn::Add(plane.error_bound, bounds.edge_error_bound);
        row.base =
            hn::MulAdd(plane.normal[0], bounds.x,
                       hn::MulAdd(plane.normal[1], bounds.y, hn::MulAdd(plane.normal[2], bounds.z, plane.offset)));
        bounds.slopes(plane.normal, row.slope);
        row.projected_radius = hn::Add(hn::Add(hn::Abs(row.slope[0]), hn::Abs(row.slope[1])), hn::Abs(row.slope[2]));
    }
    BoxTest result;
    result.inside = result.straddling = result.undecided = result.false_positives = hn::FirstN(d, 0);
    result.needs_edge_test = bounds.present;
    box.keep_first(count, bounds.present);
    resolve(box, result);
    return result;
}

}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
