// SPDX-License-Identifier: MIT
#include <crofton/capi/bake.h>

#include <crofton/pvs/pvs.hpp>

#include <crofton/capi/call.hpp>
#include <crofton/capi/convert.hpp>
#include <crofton/capi/numbers.hpp>

using namespace crofton;
using namespace crofton::capi;

static_assert(CROFTON_PVS_NO_CELL == pvs::kNoCell);
static_assert(CROFTON_PVS_CONSERVATIVE == static_cast<int>(pvs::Mode::conservative) &&
              CROFTON_PVS_STATISTICAL == static_cast<int>(pvs::Mode::statistical));

struct crofton_pvs {
    static constexpr std::uint32_t kKind = 0x43724f0c;
    Header header;
    pvs::Pvs sets;
};

crofton_status crofton_pvs_open(const char* path, crofton_pvs** pvs) {
    CROFTON_CHECK(check_pointer(path, __func__));
    CROFTON_CHECK(check_pointer(pvs, __func__));
    const char* const function = __func__;
    return recover(function, [&] {
        auto opened = pvs::Pvs::open(path);
        if (!opened) return report(opened.error(), function);
        return create(pvs, function, std::move(*opened));
    });
}

crofton_status crofton_pvs_read(const uint8_t* bytes, size_t count, crofton_pvs** pvs) {
    CROFTON_CHECK(check_array(bytes, count, __func__));
    CROFTON_CHECK(check_pointer(pvs, __func__));
    const char* const function = __func__;
    return recover(function, [&] {
        const auto* const first = reinterpret_cast<const std::byte*>(bytes);
        const Vector<std::byte> copied(first, first + count);  // starts at a multiple of 64
        auto read = pvs::Pvs::from_memory(copied);
        if (!read) return report(read.error(), function);
        return create(pvs, function, std::move(*read));
    });
}

crofton_status crofton_pvs_destroy(crofton_pvs* pvs) {
    return destroy(pvs, __func__);
}

crofton_status crofton_pvs_counts(const crofton_pvs* pvs, size_t* cells, size_t* objects) {
    CROFTON_READ(pvs);
    if (cells) *cells = pvs->sets.cells().size();
    if (objects) *objects = pvs->sets.object_count();
    return CROFTON_OK;
}

crofton_status crofton_pvs_find_cell(const crofton_pvs* pvs, const double* eye, uint32_t* cell) {
    CROFTON_READ(pvs);
    CROFTON_CHECK(check_place(eye, "eye", __func__));
    CROFTON_CHECK(check_pointer(cell, __func__));
    *cell = pvs->sets.find_cell(to_vector(eye));
    return CROFTON_OK;
}

crofton_status crofton_pvs_visible(const crofton_pvs* pvs, const double* eye, uint32_t mode, const uint64_t** words,
                                   size_t* count) {
    CROFTON_READ(pvs);
    CROFTON_CHECK(check_place(eye, "eye", __func__));
    CROFTON_CHECK(check_pointer(words, __func__));
    CROFTON_CHECK(check_pointer(count, __func__));
    if (mode > CROFTON_PVS_STATISTICAL) return report(CROFTON_INVALID_ARGUMENT, __func__, "unknown mode");
    const auto set = pvs->sets.visible_from(to_vector(eye), static_cast<pvs::Mode>(mode));
    *words = set.data();
    *count = set.size();
    return CROFTON_OK;
}
