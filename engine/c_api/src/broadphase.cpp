// SPDX-License-Identifier: MIT
// All pairs of many moving boxes.
#include <crofton/capi/modules.h>

#include <crofton/collide/broadphase.hpp>

#include <crofton/capi/call.hpp>
#include <crofton/capi/convert.hpp>

using namespace crofton;
using namespace crofton::capi;

struct crofton_broadphase {
    static constexpr std::uint32_t kKind = 0x43724f04;
    Header header;
    collide::Broadphase broadphase{};
};

static_assert(sizeof(crofton_pair) == sizeof(IdPair) && sizeof(crofton_filter) == sizeof(collide::CollisionFilter));

namespace {

std::span<const IdPair> pairs_of(const collide::Broadphase& broadphase, uint32_t which) {
    switch (which) {
        case CROFTON_PAIRS_BEGAN:
            return broadphase.began();
        case CROFTON_PAIRS_STAYED:
            return broadphase.stayed();
        case CROFTON_PAIRS_ENDED:
            return broadphase.ended();
        default:
            return broadphase.pairs();
    }
}

}  // namespace

crofton_status crofton_broadphase_create(crofton_broadphase** broadphase) {
    CROFTON_CHECK(check_pointer(broadphase, __func__));
    return create(broadphase, __func__);
}

crofton_status crofton_broadphase_destroy(crofton_broadphase* broadphase) {
    return destroy(broadphase, __func__);
}

crofton_status crofton_broadphase_update(crofton_broadphase* broadphase, const crofton_box* boxes,
                                         const crofton_filter* filters, size_t count, const crofton_jobs* jobs) {
    CROFTON_CHANGE(broadphase);
    CROFTON_CHECK(check_array(boxes, count, __func__));
    CROFTON_CHECK(check_jobs(jobs, __func__));
    HostJobs executor(jobs);
    const std::span all_filters(reinterpret_cast<const collide::CollisionFilter*>(filters), filters ? count : 0);
    return status_of(broadphase->broadphase.update(to_boxes(boxes, count), all_filters, executor), __func__);
}

crofton_status crofton_broadphase_pairs(const crofton_broadphase* broadphase, uint32_t which,
                                        const crofton_pair** pairs, size_t* count) {
    CROFTON_READ(broadphase);
    CROFTON_CHECK(check_pointer(pairs, __func__));
    CROFTON_CHECK(check_pointer(count, __func__));
    if (which > CROFTON_PAIRS_ENDED) return report(CROFTON_INVALID_ARGUMENT, __func__, "unknown kind of pairs");
    const auto found = pairs_of(broadphase->broadphase, which);
    *pairs = reinterpret_cast<const crofton_pair*>(found.data());
    *count = found.size();
    return CROFTON_OK;
}

crofton_status crofton_broadphase_get_statistics(const crofton_broadphase* broadphase,
                                                 crofton_broadphase_statistics* statistics) {
    CROFTON_READ(broadphase);
    CROFTON_CHECK(check_struct(statistics, __func__));
    const collide::BroadphaseStatistics& s = broadphase->broadphase.statistics();
    *statistics = {sizeof *statistics, s.bound_pairs, s.box_pairs, s.nodes_tested, s.rejected};
    return CROFTON_OK;
}
