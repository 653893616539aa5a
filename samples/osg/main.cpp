// SPDX-License-Identifier: MIT
// crofton_osg: OpenSceneGraph's cull traversal of a large group, its own and through Crofton. Needs no display.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <osg/Geode>
#include <osg/MatrixTransform>
#include <osg/ShapeDrawable>
#include <osgUtil/CullVisitor>
#include <osgUtil/StateGraph>
#include <random>
#include <set>

#include "crofton_cull_callback.hpp"

namespace {

using crofton::osg_adapter::CullCallback;

constexpr double kSpacing = 12.0;

struct City {
    osg::ref_ptr<osg::Group> group = new osg::Group;
    double half_width = 0.0;
};

City make_city(unsigned count) {
    City city;
    city.half_width = 0.5 * kSpacing * std::sqrt(count);
    std::mt19937 random(1);
    const auto uniform = [&](double low, double high) { return low + (high - low) * double(random()) / 4294967296.0; };
    for (unsigned i = 0; i < count; ++i) {
        const osg::Vec3d size(uniform(1, 8), uniform(1, 8), uniform(2, 30));
        auto* geode = new osg::Geode;
        // A drawable each, so that the drawables name what was seen.
        geode->addDrawable(new osg::ShapeDrawable(new osg::Box(osg::Vec3(), 1.0f)));
        auto* node = new osg::MatrixTransform(
            osg::Matrix::scale(size) * osg::Matrix::rotate(uniform(0, 6.283), osg::Vec3d(0, 0, 1)) *
            osg::Matrix::translate(uniform(-city.half_width, city.half_width),
                                   uniform(-city.half_width, city.half_width), 0.5 * size.z()));
        node->addChild(geode);
        city.group->addChild(node);
    }
    return city;
}

struct Cull {
    std::set<const osg::Drawable*> seen;
    double microseconds = 0.0;
};

void collect(const osgUtil::StateGraph& graph, std::set<const osg::Drawable*>& seen) {
    for (const auto& leaf : graph._leaves) seen.insert(leaf->getDrawable());
    for (const auto& child : graph._children) collect(*child.second, seen);
}

// One cull traversal as osgUtil::SceneView sets it up, without a context to draw in.
Cull cull(osg::Group& group, const osg::Matrix& view, const osg::Matrix& projection) {
    osg::ref_ptr<osgUtil::CullVisitor> visitor = osgUtil::CullVisitor::create();
    osg::ref_ptr<osgUtil::StateGraph> graph = new osgUtil::StateGraph;
    osg::ref_ptr<osgUtil::RenderStage> stage = new osgUtil::RenderStage;
    visitor->setStateGraph(graph);
    visitor->setRenderStage(stage);
    visitor->setCullingMode(osg::CullSettings::VIEW_FRUSTUM_CULLING);
    visitor->setComputeNearFarMode(osg::CullSettings::DO_NOT_COMPUTE_NEAR_FAR);
    visitor->setTraversalMode(osg::NodeVisitor::TRAVERSE_ACTIVE_CHILDREN);
    const auto start = std::chrono::steady_clock::now();
    osg::ref_ptr<osg::Viewport> viewport = new osg::Viewport(0, 0, 640, 360);
    visitor->pushViewport(viewport);
    visitor->pushProjectionMatrix(new osg::RefMatrix(projection));
    visitor->pushModelViewMatrix(new osg::RefMatrix(view), osg::Transform::ABSOLUTE_RF);
    group.accept(*visitor);
    visitor->popModelViewMatrix();
    visitor->popProjectionMatrix();
    visitor->popViewport();
    Cull result;
    result.microseconds = std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
    collect(*graph, result.seen);
    return result;
}

// True where a corner of the drawable's shape lies in clip space: OpenSceneGraph's matrices, nobody's planes.
bool corner_in_view(const osg::Node& node, const osg::Matrix& world_to_clip) {
    const osg::Matrix to_clip = static_cast<const osg::MatrixTransform&>(node).getMatrix() * world_to_clip;
    for (int i = 0; i < 8; ++i) {
        const osg::Vec4d corner(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5, 1.0);
        const osg::Vec4d clip = corner * to_clip;
        const double w = clip.w() * (1 - 1e-5);  // rounding of the matrices is not what is judged here
        if (std::abs(clip.x()) <= w && std::abs(clip.y()) <= w && std::abs(clip.z()) <= w) return true;
    }
    return false;
}

void keep_faster(Cull& best, Cull next) {
    if (next.microseconds < best.microseconds) best = std::move(next);
}

int run(unsigned count, unsigned frames, double view_distance) {
    City city = make_city(count);
    osg::ref_ptr<CullCallback> callback = new CullCallback(*city.group);
    const osg::Matrix projection = osg::Matrix::perspective(60.0, 16.0 / 9.0, 0.5, view_distance);
    std::printf(
        "%u children\nframe  OpenSceneGraph  Crofton  not in OSG's  missing   OSG, us  Crofton, us  of it the cull\n",
        count);
    bool good = true;
    for (unsigned frame = 0; frame < frames; ++frame) {
        const double angle = 0.9 * frame;
        const osg::Vec3d eye(0.3 * city.half_width * std::cos(angle), 0.3 * city.half_width * std::sin(angle), 12.0);
        const osg::Matrix view = osg::Matrix::lookAt(
            eye, eye + osg::Vec3d(std::cos(2 * angle), std::sin(2 * angle), -0.1), osg::Vec3d(0, 0, 1));
        // A tenth of the children move, as far as to the other side of the street.
        for (unsigned child = frame % 10; child < count; child += 10) {
            auto& node = static_cast<osg::MatrixTransform&>(*city.group->getChild(child));
            node.postMult(osg::Matrix::translate(0.5, 0.0, 0.0));
            callback->child_moved(child);
        }
        city.group->getBound();
        Cull theirs, ours;
        theirs.microseconds = ours.microseconds = std::numeric_limits<double>::infinity();
        double cull_alone = std::numeric_limits<double>::infinity();
        for (int repetition = 0; repetition < 5; ++repetition) {  // the least time of each
            city.group->setCullCallback(nullptr);
            keep_faster(theirs, cull(*city.group, view, projection));
            city.group->setCullCallback(callback);
            keep_faster(ours, cull(*city.group, view, projection));
            cull_alone = std::min(cull_alone, callback->last_cull_microseconds());
        }
        unsigned extra = 0, missing = 0;
        for (const osg::Drawable* drawable : ours.seen) extra += theirs.seen.count(drawable) == 0;
        for (unsigned child = 0; child < count; ++child) {
            const osg::Node& node = *city.group->getChild(child);
            const osg::Drawable* drawable = node.asGroup()->getChild(0)->asGeode()->getDrawable(0);
            missing += ours.seen.count(drawable) == 0 && corner_in_view(node, view * projection);
        }
        good = good && extra == 0 && missing == 0;
        std::printf("%5u %15zu %8zu %13u %8u %9.0f %12.0f %15.1f\n", frame, theirs.seen.size(), ours.seen.size(), extra,
                    missing, theirs.microseconds, ours.microseconds, cull_alone);
    }
    if (!good) std::fputs("crofton_osg: the visible sets are not what they must be\n", stderr);
    return good ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    unsigned children = 20000, frames = 8;
    double view_distance = 600.0;
    CLI::App app{"Culls a large group with OpenSceneGraph and with Crofton and compares what was seen."};
    app.add_option("--children", children, "Children of the group")->capture_default_str();
    app.add_option("--frames", frames, "Camera places")->capture_default_str();
    app.add_option("--distance", view_distance, "Far plane, metres")->capture_default_str();
    app.footer("Exit status: 0, 1 where a visible set is wrong, 2 bad usage.");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    return run(children, frames, view_distance);
}
