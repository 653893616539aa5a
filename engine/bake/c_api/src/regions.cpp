// SPDX-License-Identifier: MIT
#include <crofton/capi/bake.h>

#include <algorithm>
#include <crofton/bake/region_files.hpp>
#include <string>
#include <utility>

#include <crofton/capi/call.hpp>
#include <crofton/capi/convert.hpp>
#include <crofton/capi/growing.hpp>
#include <crofton/capi/region.hpp>

using namespace crofton;
using namespace crofton::capi;

struct crofton_region_index {
    static constexpr std::uint32_t kKind = 0x43724f13;
    Header header;
    std::string folder;
    Vector<bake::RegionFile> files;
    Vector<crofton_region_file> listed;  // of `files`
};

namespace {

crofton_status read_options(const crofton_baked_region_options* options, const char* function,
                            bake::BakedRegionOptions& result) {
    crofton_baked_region_options given = crofton_default_baked_region_options();
    if (options) {
        CROFTON_CHECK(check_growing(options, function));
        std::memcpy(&given, options, options->size);
    }
    result.triangles = given.triangles != 0;
    result.occluders = given.occluders != 0;
    result.collides_with = given.collides_with;
    result.trust_contents = given.trust_contents != 0;
    result.region.max_objects = static_cast<std::size_t>(std::min<std::uint64_t>(given.max_objects, SIZE_MAX));
    result.region.max_origin = given.max_origin;
    return CROFTON_OK;
}

crofton_region_file to_c(const bake::RegionFile& file) {
    crofton_region_file result{file.name.c_str(), {}, {}, {}, file.objects, file.bytes};
    for (int k = 0; k < 3; ++k) {
        result.origin[k] = file.origin[k];
        result.min[k] = file.bounds.min[k];
        result.max[k] = file.bounds.max[k];
    }
    return result;
}

}  // namespace

crofton_baked_region_options crofton_default_baked_region_options(void) {
    const bake::BakedRegionOptions options;
    return {sizeof(crofton_baked_region_options),
            options.triangles,
            options.occluders,
            options.collides_with,
            options.trust_contents,
            options.region.max_objects,
            options.region.max_origin};
}

crofton_status crofton_baked_region_open(const char* path, const crofton_baked_region_options* options,
                                         const crofton_jobs* jobs, crofton_region** region) {
    CROFTON_CHECK(check_pointer(path, __func__));
    CROFTON_CHECK(check_jobs(jobs, __func__));
    CROFTON_CHECK(check_pointer(region, __func__));
    bake::BakedRegionOptions given;
    CROFTON_CHECK(read_options(options, __func__, given));
    HostJobs executor(jobs);
    const char* const function = __func__;
    return recover(function, [&] {
        auto scene = bake::BakedScene::open(path, executor);
        if (!scene) return report(scene.error(), function);
        auto prepared = bake::prepare_region(std::move(*scene), given, executor);
        if (!prepared) return report(prepared.error(), function);
        return create(region, function, std::move(*prepared));
    });
}

crofton_status crofton_region_index_open(const char* folder, crofton_region_index** index) {
    CROFTON_CHECK(check_pointer(folder, __func__));
    CROFTON_CHECK(check_pointer(index, __func__));
    const char* const function = __func__;
    return recover(function, [&] {
        auto files = bake::open_region_index(folder);
        if (!files) return report(files.error(), function);
        Vector<crofton_region_file> listed;
        for (const bake::RegionFile& file : *files) listed.push_back(to_c(file));
        // The names stay where they are: the handle takes the array over.
        return create(index, function, std::string(folder), std::move(*files), std::move(listed));
    });
}

crofton_status crofton_region_index_destroy(crofton_region_index* index) {
    return destroy(index, __func__);
}

crofton_status crofton_region_index_files(const crofton_region_index* index, const crofton_region_file** files,
                                          size_t* count) {
    CROFTON_READ(index);
    CROFTON_CHECK(check_pointer(files, __func__));
    CROFTON_CHECK(check_pointer(count, __func__));
    *files = index->listed.data();
    *count = index->listed.size();
    return CROFTON_OK;
}

crofton_status crofton_region_index_prepare(const crofton_region_index* index, size_t place,
                                            const crofton_baked_region_options* options, const crofton_jobs* jobs,
                                            crofton_region** region) {
    CROFTON_READ(index);
    CROFTON_CHECK(check_jobs(jobs, __func__));
    CROFTON_CHECK(check_pointer(region, __func__));
    if (place >= index->files.size())
        return report(CROFTON_OUT_OF_RANGE, __func__, "the index has no region at that place", place);
    bake::BakedRegionOptions given;
    CROFTON_CHECK(read_options(options, __func__, given));
    HostJobs executor(jobs);
    const char* const function = __func__;
    return recover(function, [&] {
        auto prepared = bake::open_region(index->folder, index->files[place], given, {}, executor);
        if (!prepared) return report(prepared.error(), function);
        return create(region, function, std::move(*prepared));
    });
}
