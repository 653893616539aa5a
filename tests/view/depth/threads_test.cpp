// SPDX-License-Identifier: MIT
// One call on several threads, and with a limit of work.
#include <doctest/doctest.h>

#include <algorithm>
#include <crofton/core/executor.hpp>
#include <vector>

#include "../../backwards.hpp"
#include "depth_scenes.hpp"

namespace crofton::testing {
namespace {

using depth::DepthCuller;
using depth::DepthObject;
using depth::DepthStatistics;
using depth::PictureView;
using depth::VisibleCluster;

struct PictureAnswer {
    std::vector<VisibleCluster> clusters;
    DepthStatistics statistics;
    std::vector<float> nearness;
};

PictureAnswer answer_of(DepthCuller& culler, std::span<const DepthObject> objects, const PictureView& view,
                        Executor& executor) {
    PictureAnswer answer;
    const auto found = culler.find_visible(objects, view, executor);
    REQUIRE(found);
    answer.clusters.assign(found->begin(), found->end());
    answer.statistics = culler.statistics();
    for (std::uint32_t y = 0; y < view.height; ++y)
        for (std::uint32_t x = 0; x < view.width; ++x) answer.nearness.push_back(culler.nearness(x, y));
    return answer;
}

void check_equal(const PictureAnswer& a, const PictureAnswer& b) {
    CHECK(std::equal(a.clusters.begin(), a.clusters.end(), b.clusters.begin(), b.clusters.end(),
                     [](const VisibleCluster& p, const VisibleCluster& q) {
                         return p.object == q.object && p.cluster == q.cluster && p.triangles == q.triangles;
                     }));
    CHECK(a.statistics.objects_listed == b.statistics.objects_listed);
    CHECK(a.statistics.objects_asked == b.statistics.objects_asked);
    CHECK(a.statistics.clusters_asked == b.statistics.clusters_asked);
    CHECK(a.statistics.clusters_drawn == b.statistics.clusters_drawn);
    CHECK(a.statistics.triangles_drawn == b.statistics.triangles_drawn);
    CHECK(a.statistics.triangles_listed == b.statistics.triangles_listed);
    CHECK(a.nearness == b.nearness);
}

struct AskedPicture {
    std::vector<DepthObject> objects;
    PictureView picture;
};

// Some scenes have an object that cannot be placed.
AskedPicture random_picture(const Scene& scene, oracle::NearMisses& random) {
    AskedPicture view;
    Camera camera = random_camera(random);
    view.picture.width = static_cast<std::uint32_t>(1 + random.index(random.index(4) == 0 ? 40 : 300));
    view.picture.height = static_cast<std::uint32_t>(1 + random.index(150));
    camera.aspect = double(view.picture.width) / view.picture.height;
    for (const PlacedMesh& o : scene.objects)
        view.objects.push_back(
            {&o.mesh->clusters, glm::mat4(world_to_clip(camera) * o.world), o.one_sided, o.hides, o.position_error});
    if (random.index(5) == 0)
        view.objects[random.index(static_cast<std::uint32_t>(view.objects.size()))].position_error = HUGE_VALF;
    return view;
}

std::uint64_t work_of(const DepthStatistics& s) {
    return s.clusters_asked + s.triangles_drawn;
}

TEST_CASE("any number of threads lists the same triangles, and finds the same depth") {
    ThreadPool two(2), five(5);
    Backwards three(3), many(40);
    DepthCuller culler, other;
    for (std::uint64_t seed = 1; seed <= 400; ++seed) {
        CAPTURE(seed);
        oracle::NearMisses random(seed);
        const Scene scene = random_scene(random);
        for (int i = 0; i < 2; ++i) {
            const AskedPicture view = random_picture(scene, random);
            const PictureAnswer alone = answer_of(culler, view.objects, view.picture, serial_executor());
            for (Executor* executor : std::initializer_list<Executor*>{&two, &five, &three, &many})
                check_equal(alone, answer_of(other, view.objects, view.picture, *executor));
        }
    }
}

TEST_CASE("a limit of work is kept to, loses nothing, and is the same for any number of threads") {
    ThreadPool two(2);
    Backwards seven(7);
    DepthCuller culler, other;
    std::uint64_t exceeded = 0;
    for (std::uint64_t seed = 1; seed <= 300; ++seed) {
        CAPTURE(seed);
        oracle::NearMisses random(seed);
        const Scene scene = random_scene(random);
        AskedPicture view = random_picture(scene, random);
        const PictureAnswer all = answer_of(culler, view.objects, view.picture, serial_executor());
        std::uint64_t most_at_once = depth::Cluster::kMaxTriangles;
        for (const DepthObject& o : view.objects)
            most_at_once = std::max<std::uint64_t>(most_at_once, o.mesh->clusters().size());
        for (const std::uint64_t limit : {std::uint64_t{1}, std::uint64_t(1 + random.index(200)),
                                          std::uint64_t(1 + random.index(5000)), work_of(all.statistics)}) {
            CAPTURE(limit);
            view.picture.work_limit = std::max<std::uint64_t>(limit, 1);
            const PictureAnswer some = answer_of(culler, view.objects, view.picture, serial_executor());
            CHECK(work_of(some.statistics) <= view.picture.work_limit + most_at_once);
            // Less depth is known, so more is listed.
            CHECK(std::includes(some.clusters.begin(), some.clusters.end(), all.clusters.begin(), all.clusters.end(),
                                [](const VisibleCluster& a, const VisibleCluster& b) {
                                    return a.object != b.object ? a.object < b.object : a.cluster < b.cluster;
                                }));
            auto at = some.clusters.begin();
            std::uint64_t lost = 0;
            for (const VisibleCluster& c : all.clusters) {
                while (at != some.clusters.end() && (at->object != c.object || at->cluster != c.cluster)) ++at;
                lost += at == some.clusters.end() || (c.triangles & ~at->triangles) != 0;
            }
            CHECK(lost == 0);
            exceeded += work_of(some.statistics) > view.picture.work_limit;
            check_equal(some, answer_of(other, view.objects, view.picture, two));
            check_equal(some, answer_of(other, view.objects, view.picture, seven));
            if (limit == work_of(all.statistics)) check_equal(all, some);
        }
    }
    CHECK(exceeded > 300);
}

}  // namespace
}  // namespace crofton::testing
