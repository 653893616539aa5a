// SPDX-License-Identifier: MIT
// Occlusion culling of a town: what is found hidden, what it costs, and Intel's MaskedOcclusionCulling beside it where
// CROFTON_MASKED_OCCLUSION_CULLING names its sources.
#include <algorithm>
#include <bit>
#include <chrono>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <utility>

#include "occlude_peer.hpp"
#include "occlude_reference.hpp"
#include "occlude_town.hpp"
#include "simd_target.hpp"

namespace {

using namespace crofton;
using namespace crofton::bench;

struct Outcome {
    std::size_t culled_visible = 0, culled_hidden = 0;
    double draw = 1e9, query = 1e9;  // least seconds
};

Outcome judge(const std::vector<std::uint64_t>& hidden, const OcclusionReference& reference) {
    Outcome outcome;
    for (std::size_t i = 0; i < reference.seen.size(); ++i) {
        const bool culled = hidden[i / 64] >> (i % 64) & 1;
        outcome.culled_visible += culled && reference.seen[i];
        outcome.culled_hidden += culled && reference.in_view[i] && !reference.seen[i];
    }
    return outcome;
}

template <class Work>
double seconds_of(const Work& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

Outcome run_ours(const OcclusionTown& town, const Camera& camera, const OcclusionReference& reference,
                 const occlude::BufferSize& size, int repeats) {
    occlude::OccluderSet set;
    for (const Obb& house : town.houses) (void)set.place(house);
    auto buffer = *occlude::OcclusionBuffer::create(size);
    const auto view = *occlude::occlusion_view_of(camera);
    std::vector<std::uint64_t> hidden((town.objects.size() + 63) / 64);
    buffer.draw(set, view);
    buffer.find_hidden(town.objects, hidden);
    Outcome outcome = judge(hidden, reference);
    for (int i = 0; i < repeats; ++i) {
        outcome.draw = std::min(outcome.draw, seconds_of([&] { buffer.draw(set, view); }));
        outcome.query = std::min(outcome.query, seconds_of([&] { buffer.find_hidden(town.objects, hidden); }));
    }
    return outcome;
}

#if defined(CROFTON_HAVE_MOC)
Outcome run_peer(const OcclusionTown& town, const Camera& camera, const OcclusionReference& reference,
                 const occlude::BufferSize& size, int repeats) {
    MaskedPeer peer(size.width, size.height);
    std::vector<std::uint64_t> hidden((town.objects.size() + 63) / 64);
    peer.draw(town.houses, camera);
    peer.find_hidden(town.objects, hidden);
    Outcome outcome = judge(hidden, reference);
    for (int i = 0; i < repeats; ++i) {
        outcome.draw = std::min(outcome.draw, seconds_of([&] { peer.draw(town.houses, camera); }));
        outcome.query = std::min(outcome.query, seconds_of([&] { peer.find_hidden(town.objects, hidden); }));
    }
    return outcome;
}
#endif

void print(const char* name, const occlude::BufferSize& size, const Outcome& o, std::size_t hidden) {
    std::printf(
        "  %-24s %4ux%-4u  visible culled %4zu   hidden culled %6.2f %%   draw %6.3f ms   query %6.3f ms   both %6.3f "
        "ms\n",
        name, size.width, size.height, o.culled_visible,
        100.0 * static_cast<double>(o.culled_hidden) / static_cast<double>(hidden), 1e3 * o.draw, 1e3 * o.query,
        1e3 * (o.draw + o.query));
}

// The same boxes at rest, in a tree.
void run_rested(const OcclusionTown& town, const Camera& camera, int repeats) {
    occlude::OccluderSet set;
    for (const Obb& house : town.houses) (void)set.place(house);
    const auto tree = *boxtree::BoxTree::build(town.objects);
    const auto view = *occlude::occlusion_view_of(camera);
    for (const occlude::BufferSize& size : {occlude::BufferSize{320, 180}, {640, 360}}) {
        auto buffer = *occlude::OcclusionBuffer::create(size);
        occlude::VisibleSet visible;
        double draw = 1e9, query = 1e9;
        for (int i = 0; i < repeats; ++i) {
            draw = std::min(draw, seconds_of([&] { buffer.draw(set, view); }));
            query = std::min(query, seconds_of([&] { occlude::find_visible(tree, buffer, visible); }));
        }
        std::printf(
            "  the boxes in a tree,      %4ux%-4u  %5zu not hidden, draw %6.3f ms   query %6.3f ms   both %6.3f ms\n",
            size.width, size.height, visible.size(), 1e3 * draw, 1e3 * query, 1e3 * (draw + query));
    }
}

// A cube of half extent 1 whose faces are grids of n × n squares, closed.
TriangleMesh cube_of_grids(std::uint32_t n) {
    TriangleMesh mesh;
    for (int face = 0; face < 6; ++face) {
        const int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        for (std::uint32_t i = 0; i <= n; ++i)
            for (std::uint32_t j = 0; j <= n; ++j) {
                glm::vec3 p;
                p[axis] = face % 2 ? 1.0f : -1.0f;
                p[u] = 2.0f * static_cast<float>(i) / static_cast<float>(n) - 1.0f;
                p[v] = 2.0f * static_cast<float>(j) / static_cast<float>(n) - 1.0f;
                mesh.positions.push_back(p);
            }
        for (std::uint32_t i = 0; i < n; ++i)
            for (std::uint32_t j = 0; j < n; ++j) {
                const std::uint32_t a = first + i * (n + 1) + j, b = a + n + 1;
                const std::uint32_t front[6] = {a, b, a + 1, a + 1, b, b + 1}, back[6] = {a, a + 1, b, a + 1, b + 1, b};
                mesh.indices.insert(mesh.indices.end(), face % 2 ? front : back, (face % 2 ? front : back) + 6);
            }
    }
    return mesh;
}

// The same houses as meshes of more and more triangles.
void run_meshes(const OcclusionTown& town, const Camera& camera, int repeats) {
    for (const std::uint32_t n : {1u, 4u, 16u}) {
        occlude::OccluderSet set;
        const auto mesh = set.add_mesh(cube_of_grids(n));
        if (!mesh) {
            std::printf("  %s\n", mesh.error().message.c_str());
            return;
        }
        for (const Obb& house : town.houses) {
            Transform transform;
            for (int k = 0; k < 3; ++k)
                transform.linear[k] = glm::dvec3(house.axes[k]) * static_cast<double>(house.half_extents[k]);
            transform.translation = house.center;
            (void)set.place(*mesh, transform);
        }
        for (const occlude::BufferSize& size : {occlude::BufferSize{320, 180}, {640, 360}}) {
            auto buffer = *occlude::OcclusionBuffer::create(size);
            const auto view = *occlude::occlusion_view_of(camera);
            std::vector<std::uint64_t> hidden((town.objects.size() + 63) / 64);
            double draw = 1e9;
            for (int i = 0; i < repeats; ++i) draw = std::min(draw, seconds_of([&] { buffer.draw(set, view); }));
            buffer.find_hidden(town.objects, hidden);
            std::size_t count = 0;
            for (const std::uint64_t word : hidden) count += static_cast<std::size_t>(std::popcount(word));
            std::printf(
                "  houses as meshes of %4u triangles, %4ux%-4u  %7llu drawn, %5zu boxes hidden, draw %6.3f ms\n",
                12 * n * n, size.width, size.height,
                static_cast<unsigned long long>(buffer.statistics().triangles_drawn), count, 1e3 * draw);
        }
    }
}

// A tree of a million objects among 4,096 houses, seen from a street: with the nearest 256 houses as occluders, and
// without.
void run_tree(int repeats) {
    const OcclusionTown town = occlusion_town(7, 4096, 1'000'000, 1.7);
    const auto tree = *boxtree::BoxTree::build(town.objects);
    Camera camera = town.cameras[0];
    camera.position.x = 12.0;  // in the middle of the town, between rows of houses
    camera.position.z = 0.0;
    std::vector<std::pair<double, const Obb*>> nearest;
    for (const Obb& house : town.houses)
        if (glm::dot(house.center - camera.position, camera.forward) > -12.0)
            nearest.push_back({glm::length(house.center - camera.position), &house});
    std::sort(nearest.begin(), nearest.end());
    occlude::OccluderSet set;
    for (std::size_t i = 0; i < std::min<std::size_t>(256, nearest.size()); ++i) (void)set.place(*nearest[i].second);
    auto buffer = *occlude::OcclusionBuffer::create({480, 270});
    const auto view = *occlude::occlusion_view_of(camera);
    cull::VisibleSet in_frustum;
    occlude::VisibleSet visible;
    double draw = 1e9, with = 1e9, without = 1e9;
    for (int i = 0; i < repeats + 2; ++i) {
        draw = std::min(draw, seconds_of([&] { buffer.draw(set, view); }));
        with = std::min(with, seconds_of([&] { occlude::find_visible(tree, buffer, visible); }));
        without = std::min(without, seconds_of([&] { cull::find_visible(tree, {view.frustum}, in_frustum); }));
    }
    std::printf(
        "tree of 1,000,000, street: %zu in the frustum, %zu not hidden; query without occlusion %.3f ms, "
        "with %.3f ms, drawing %.3f ms: ratio %.2f, with drawing %.2f\n",
        in_frustum.size(), visible.size(), 1e3 * without, 1e3 * with, 1e3 * draw, with / without,
        (with + draw) / without);
}

}  // namespace

int main(int argc, char** argv) {
    if (!take_target_option(argc, argv)) return 1;
    int repeats = 15;
    double height = 60.0, house_size = 1.0;
    for (int i = 1; i < argc; ++i)
        if (std::string_view(argv[i]).starts_with("--repeats=")) repeats = std::atoi(argv[i] + 10);
    for (int i = 1; i < argc; ++i)
        if (std::string_view(argv[i]).starts_with("--height=")) height = std::atof(argv[i] + 9);
    for (int i = 1; i < argc; ++i)
        if (std::string_view(argv[i]).starts_with("--house-size=")) house_size = std::atof(argv[i] + 13);
    std::printf("Instruction set: %s\n", target_in_use());
    const occlude::BufferSize sizes[] = {{320, 180}, {480, 270}, {640, 360}, {1280, 720}, {1920, 1080}};
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
        const OcclusionTown town = occlusion_town(seed, 250, 20'000, height, house_size);
        const Camera& camera = town.cameras[0];
        const OcclusionReference reference(town, camera, 1920, 1080);
        const std::size_t hidden = reference.in_view_count - reference.seen_count;
        std::printf("town %llu: 250 houses, 20,000 boxes, %zu in view, %zu seen\n",
                    static_cast<unsigned long long>(seed), reference.in_view_count, reference.seen_count);
        for (const auto& size : sizes) print("crofton", size, run_ours(town, camera, reference, size, repeats), hidden);
#if defined(CROFTON_HAVE_MOC)
        for (const auto& size : {sizes[2], sizes[4]})
            print("MaskedOcclusionCulling", size, run_peer(town, camera, reference, size, repeats), hidden);
#endif
        if (seed == 1) {
            run_rested(town, camera, repeats);
            run_meshes(town, camera, repeats);
        }
    }
    run_tree(repeats);
    return 0;
}
