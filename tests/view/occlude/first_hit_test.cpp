// SPDX-License-Identifier: MIT
// Pictures of what each pixel's ray meets first, with all objects and with those alone that are not hidden.
#include <doctest/doctest.h>
#include <crofton/occlude/occlusion.hpp>
#include <oracle/occlusion_scenes.hpp>

using namespace crofton;
using namespace crofton::test;

namespace {

constexpr std::size_t kNothing = ~std::size_t{0};

// Which of the boxes the ray enters first, beyond the near plane. What lies closer together than double can tell is
// taken in the order of the list, in both pictures alike.
std::size_t first_hit(const oracle::WitnessRay& ray, const std::vector<Obb>& boxes, const std::vector<bool>& shown) {
    std::size_t first = kNothing;
    double nearest = HUGE_VAL;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (!shown[i]) continue;
        const oracle::Interval at = oracle::interval(ray, boxes[i]);
        if (std::isinf(at.error) || at.enter > at.leave || at.enter < ray.t_near || at.enter >= nearest) continue;
        nearest = at.enter;
        first = i;
    }
    return first;
}

}  // namespace

TEST_SUITE("occlude/first hit") {
    TEST_CASE("pictures at four resolutions are the same without what is hidden") {
        Random random(44);
        constexpr occlude::BufferSize kSizes[] = {{64, 36}, {160, 90}, {320, 180}, {640, 360}};
        std::size_t hidden = 0, owners = 0;
        for (const double offset : {0.0, 1e7})
            for (const auto& size : kSizes) {
                OcclusionScene scene = random_scene(random, offset, 60);
                scene.size = size;
                auto buffer = *occlude::OcclusionBuffer::create(size);
                buffer.draw(set_of(scene.occluders), *occlude::occlusion_view_of(scene.camera));
                std::vector<Obb> boxes = scene.occluders;
                boxes.insert(boxes.end(), scene.objects.begin(), scene.objects.end());
                const std::vector<bool> all(boxes.size(), true);
                std::vector<bool> left = all, owns(boxes.size(), false);
                for (std::size_t i = scene.occluders.size(); i < boxes.size(); ++i) {
                    left[i] = !buffer.hides(boxes[i]);
                    hidden += !left[i];
                }
                std::size_t different = 0;
                for (std::uint32_t y = 0; y < size.height; ++y)
                    for (std::uint32_t x = 0; x < size.width; ++x) {
                        const auto ray = ray_through(scene, x + 0.5, y + 0.5, 100.0);
                        const std::size_t seen = first_hit(ray, boxes, all);
                        if (seen == kNothing) continue;
                        owns[seen] = true;
                        different += !left[seen];
                    }
                CHECK(different == 0);
                owners += static_cast<std::size_t>(std::count(owns.begin(), owns.end(), true));
            }
        MESSAGE(hidden << " hidden, " << owners << " own a pixel");
        CHECK(hidden > 20);
        CHECK(owners > 100);
    }
}
