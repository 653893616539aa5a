// SPDX-License-Identifier: MIT
// crofton_ogre: OGRE's culling and Crofton's, on the same frames of the same scene.
#include <OgreViewport.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <limits>

#include "frame_check.hpp"
#include "headless.hpp"

namespace crofton::ogre {
namespace {

struct Request {
    CitySize drawn;
    unsigned frames = 12;
    unsigned timed_entities = 0;
    unsigned timed_frames = 40;
    bool occlude = false;
    std::string picture;
};

enum class Culling { ogre, crofton, crofton_occluded };

struct DrawnFrame {
    std::vector<QueueRecorder::Pass> passes;
    Ogre::RenderTarget::FrameStats statistics;
    std::vector<std::uint32_t> pixels;
};

std::vector<std::uint32_t> read_pixels(Ogre::RenderWindow& window) {
    std::vector<std::uint32_t> pixels(std::size_t{window.getWidth()} * window.getHeight());
    const Ogre::PixelBox box(window.getWidth(), window.getHeight(), 1, Ogre::PF_A8R8G8B8, pixels.data());
    window.copyContentsToMemory(Ogre::Box(0, 0, window.getWidth(), window.getHeight()), box);
    return pixels;
}

std::size_t count_different(const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) {
    std::size_t different = a.size() == b.size() ? 0 : 1;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) different += a[i] != b[i];
    return different;
}

DrawnFrame draw(Headless& headless, City& city, QueueRecorder& recorder, Culling culling) {
    city.manager().use_ogre_culling(culling == Culling::ogre);
    city.manager().use_occlusion(culling == Culling::crofton_occluded);
    headless.root()._fireFrameStarted();
    headless.window().resetStatistics();
    headless.window().update(false);
    headless.root()._fireFrameEnded();
    return {recorder.take(), headless.window().getStatistics(), read_pixels(headless.window())};
}

// Draws every frame both ways and compares what was queued. Returns whether all was as promised.
bool compare_frames(Headless& headless, const Request& request) {
    City city(headless.root(), request.drawn);
    headless.window().removeAllViewports();
    headless.window().addViewport(&city.camera())->setBackgroundColour(Ogre::ColourValue(0.5f, 0.6f, 0.7f));
    QueueRecorder recorder(city.manager());
    MeshTriangles meshes;
    std::printf("%u entities, %u moving; a frame is drawn with OGRE's culling, then with Crofton's\n",
                request.drawn.entities, request.drawn.moving);
    std::puts("frame  pass     queued: OGRE  Crofton  not in OGRE's  missing | batches      triangles        find, us");
    bool good = true;
    for (unsigned frame = 0; frame < request.frames; ++frame) {
        city.set_frame(frame);
        const DrawnFrame theirs = draw(headless, city, recorder, Culling::ogre),
                         ours = draw(headless, city, recorder, Culling::crofton);
        good = good && theirs.passes.size() == ours.passes.size();
        for (std::size_t i = 0; good && i < ours.passes.size(); ++i) {
            const auto& ogre = theirs.passes[i];
            const auto& crofton = ours.passes[i];
            const FrameCheck check = check_pass(city, ogre, crofton, meshes);
            good = good && ogre.camera == crofton.camera && check.not_in_ogre == 0 && check.missing == 0;
            std::printf("%5u  %-7s %13zu %8zu %14zu %8zu |", frame, crofton.shadows ? "shadow" : "picture", check.ogre,
                        check.crofton, check.not_in_ogre, check.missing);
            if (crofton.shadows)
                std::printf("%34s", "");
            else
                std::printf(" %5zu %5zu  %8zu %8zu  ", theirs.statistics.batchCount, ours.statistics.batchCount,
                            theirs.statistics.triangleCount, ours.statistics.triangleCount);
            std::printf("%8.0f %7.0f\n", ogre.times.total, crofton.times.total);
        }
    }
    if (!request.picture.empty()) headless.window().writeContentsToFile(request.picture);
    return good;
}

// Draws every frame with all that is in view and without what is hidden. Returns whether the pictures are the same
// bits. Without shadows: OGRE fits their textures to what it draws, which changes a few pixels by a step of colour.
bool compare_occluded(Headless& headless, const Request& request) {
    City city(headless.root(), {request.drawn.entities, request.drawn.moving, false});
    headless.window().removeAllViewports();
    headless.window().addViewport(&city.camera())->setBackgroundColour(Ogre::ColourValue(0.5f, 0.6f, 0.7f));
    QueueRecorder recorder(city.manager());
    std::puts(
        "without shadows, by Crofton's culling: all that is in view, and of it what is not hidden\n"
        "frame  queued: all  rest  occluders | triangles: all    rest |  find, us: all    rest | pixels that differ");
    bool good = true;
    for (unsigned frame = 0; frame < request.frames; ++frame) {
        city.set_frame(frame);
        const DrawnFrame all = draw(headless, city, recorder, Culling::crofton);
        const DrawnFrame rest = draw(headless, city, recorder, Culling::crofton_occluded);
        const auto& queued = all.passes.back().queued;
        const auto& left = rest.passes.back().queued;
        const std::size_t different = count_different(all.pixels, rest.pixels);
        good = good && different == 0 && left.size() < queued.size() &&
               std::includes(queued.begin(), queued.end(), left.begin(), left.end());
        std::printf("%5u %12zu %5zu %10u | %14zu %7zu | %14.0f %7.0f | %zu\n", frame, queued.size(), left.size(),
                    city.manager().occlusion_statistics().occluders_drawn, all.statistics.triangleCount,
                    rest.statistics.triangleCount, all.passes.back().times.total, rest.passes.back().times.total,
                    different);
    }
    return good;
}

// _findVisibleObjects alone, on a large static scene: the smallest time of several frames from several places.
void time_culling(City& city, double view_distance, unsigned frames) {
    city.camera().setFarClipDistance(static_cast<float>(view_distance));
    FindTimes ogre_best{0, 0}, best{0, 0};
    std::size_t visible = 0;
    for (unsigned frame = 0; frame < 4; ++frame) {
        city.set_frame(7 * frame);
        city.manager()._updateSceneGraph(&city.camera());
        FindTimes least[2];
        for (bool ogre_culling : {true, false}) {
            FindTimes& time = least[ogre_culling];
            time = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
            city.manager().use_ogre_culling(ogre_culling);
            for (unsigned i = 0; i < frames; ++i) {
                city.manager().getRenderQueue()->clear();
                Ogre::VisibleObjectsBoundsInfo bounds;
                city.manager()._findVisibleObjects(&city.camera(), &bounds, false);
                time.cull = std::min(time.cull, city.manager().find_times().cull);
                time.total = std::min(time.total, city.manager().find_times().total);
            }
        }
        visible += city.manager().visible_nodes();
        ogre_best.total += least[true].total / 4;
        best.cull += least[false].cull / 4;
        best.total += least[false].total / 4;
    }
    std::printf("%13.0f m %8zu %9.0f us %9.0f us %8.2f %13.1f us\n", view_distance, visible / 4, ogre_best.total,
                best.total, ogre_best.total / best.total, best.cull);
}

int run(const Request& request) {
    Headless headless;
    SceneManagerFactory factory;
    headless.root().addSceneManagerFactory(&factory);
    bool good = true;
    if (request.frames > 0) good = compare_frames(headless, request);
    if (request.frames > 0 && request.occlude) good = compare_occluded(headless, request) && good;
    if (request.timed_entities > 0) {
        City city(headless.root(), {request.timed_entities, 0, false});
        std::printf(
            "%u static entities: _findVisibleObjects\nview distance  in view         OGRE      Crofton  faster, times  "
            "of it the cull\n",
            request.timed_entities);
        for (const double view_distance : {300.0, 600.0, 1200.0, 5000.0})
            time_culling(city, view_distance, request.timed_frames);
    }
    headless.root().removeSceneManagerFactory(&factory);
    if (!good) std::fputs("crofton_ogre: the visible sets are not what they must be\n", stderr);
    return good ? 0 : 1;
}

}  // namespace
}  // namespace crofton::ogre

int main(int argc, char** argv) {
    crofton::ogre::Request request;
    CLI::App app{"Draws frames with OGRE's own culling and with Crofton's and compares them."};
    app.add_option("--entities", request.drawn.entities, "Entities in the frames drawn")->capture_default_str();
    app.add_option("--moving", request.drawn.moving, "How many of them move")->capture_default_str();
    app.add_option("--frames", request.frames, "Frames drawn, each both ways")->capture_default_str();
    app.add_option("--time", request.timed_entities, "Also time _findVisibleObjects with this many static entities");
    app.add_flag("--occlude", request.occlude, "Also draw the frames without what is hidden, and compare the pictures");
    app.add_option("--png", request.picture, "Write the last frame here");
    app.footer(
        "Needs a display; without one: xvfb-run -a crofton_ogre --time 100000\nExit status: 0, 1 where a visible "
        "set is wrong, 2 bad usage, no display or no OpenGL.");
    CLI11_PARSE(app, argc, argv);
    try {
        return crofton::ogre::run(request);
    } catch (const Ogre::Exception& error) {
        std::fprintf(stderr, "crofton_ogre: %s\n", error.getDescription().c_str());
        return 2;
    }
}
