// SPDX-License-Identifier: MIT
#include "camera_path.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <random>

#include "assets/file.hpp"
#include "assets/json_syntax.hpp"
#include "json/json.hpp"

namespace crofton::pipeline {
namespace {

using std::numbers::pi;

constexpr double kNearOfEyeHeight = 0.05;

struct Frame {
    glm::dvec3 center;
    double radius;  // of the ground plan
    double height;
};

Frame frame_of(const Aabb& bounds) {
    const glm::dvec3 half = bounds.half_extents();
    const glm::dvec3 center = bounds.center();
    // A single point still gets a place to look from.
    const double least = 1e-6 * std::max({1.0, std::abs(center.x), std::abs(center.y), std::abs(center.z)});
    return {center, std::max({std::hypot(half.x, half.z), 0.5 * half.y, least}), 2.0 * half.y};
}

Camera base_camera(const PathOptions& options, const Frame& frame) {
    Camera camera;
    camera.aspect = options.aspect;
    const double half_size = std::max({frame.radius, frame.height, 1e-6});
    camera.near_distance = 2e-4 * half_size;
    camera.far_distance = 8.0 * half_size;
    return camera;
}

// Once around, from a bird's height, closer and farther in turn; near enough that part of the scene is out of view.
Camera orbit(Camera camera, const Frame& frame, double t) {
    const double angle = 2.0 * pi * t;
    const double distance = frame.radius * (0.62 + 0.18 * std::cos(2.0 * angle));
    const double height = 0.16 * frame.radius + 0.5 * frame.height;
    const glm::dvec3 target = frame.center - glm::dvec3(0.0, 0.25 * frame.height, 0.0);
    camera.position = frame.center + glm::dvec3(distance * std::cos(angle), height, distance * std::sin(angle));
    camera.forward = glm::normalize(target - camera.position);
    return camera;
}

// At eye level along the walk, looking where it leads, now and then aside.
Camera street(Camera camera, const PathOptions& options, std::span<const glm::dvec3> walk, double t) {
    if (walk.size() == 1) {
        camera.position = walk[0];
        camera.forward = {std::sin(2.0 * pi * t), 0.0, -std::cos(2.0 * pi * t)};
        return camera;
    }
    std::vector<double> along(walk.size(), 0.0);
    for (std::size_t i = 1; i < walk.size(); ++i) along[i] = along[i - 1] + glm::distance(walk[i - 1], walk[i]);
    const auto at = [&](double distance) {
        distance = std::clamp(distance, 0.0, along.back());
        const auto after = std::upper_bound(along.begin() + 1, along.end() - 1, distance);
        const auto i = static_cast<std::size_t>(after - along.begin());
        const double length = along[i] - along[i - 1];
        return glm::mix(walk[i - 1], walk[i], length > 0.0 ? (distance - along[i - 1]) / length : 0.0);
    };
    const double here = t * along.back() * 0.97;
    camera.position = at(here);
    glm::dvec3 ahead = at(here + 0.03 * along.back()) - camera.position;
    ahead.y = 0.0;
    if (glm::length(ahead) < 1e-9 * (1.0 + along.back())) ahead = glm::dvec3(1.0, 0.0, 0.0);
    const double turn = 0.35 * std::sin(10.0 * pi * t);
    camera.forward = glm::normalize(glm::dvec3(ahead.x * std::cos(turn) - ahead.z * std::sin(turn), 0.0,
                                               ahead.x * std::sin(turn) + ahead.z * std::cos(turn)));
    if (options.over_floor) camera.position = options.over_floor(camera.position);
    return camera;
}

// Straight across, from corner to corner, over all that stands there, looking ahead and down.
Camera flight(Camera camera, const Aabb& bounds, const Frame& frame, double t) {
    const glm::dvec3 half = bounds.half_extents();
    const glm::dvec3 way(half.x, 0.0, half.z);
    camera.position = frame.center + (1.4 * t - 0.7) * way;
    camera.position.y = bounds.max.y + 0.1 * frame.height;
    const double length = glm::length(way);
    const glm::dvec3 ahead = length > 0.0 ? way / length : glm::dvec3(1.0, 0.0, 0.0);
    camera.forward = glm::normalize(ahead - glm::dvec3(0.0, 0.35, 0.0));
    return camera;
}

// Anywhere in the bounds, looking anywhere.
Camera random_camera(Camera camera, const Aabb& bounds, std::mt19937_64& random) {
    const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    // One after the other: in which order arguments are computed is left to the compiler.
    const double at_z = unit(), at_y = unit(), at_x = unit();
    camera.position = bounds.min + glm::dvec3(at_x, at_y, at_z) * (bounds.max - bounds.min);
    const double z = 2.0 * unit() - 1.0, angle = 2.0 * pi * unit(), ring = std::sqrt(std::max(0.0, 1.0 - z * z));
    camera.forward = {ring * std::cos(angle), z, ring * std::sin(angle)};
    if (std::abs(z) > 0.999) camera.up = {1.0, 0.0, 0.0};
    return camera;
}

Result<glm::dvec3> vector_from(const Json& entry, const char* field, const glm::dvec3& otherwise, std::uint64_t item) {
    const Json* value = entry.find(field);
    if (value == nullptr) return otherwise;
    const std::span<const Json> parts = value->elements();
    if (parts.size() != 3 || !std::all_of(parts.begin(), parts.end(), [](const Json& v) { return v.is_number(); }))
        return fail(ErrorCode::parse, item, std::string("camera: ") + field + " must be three numbers");
    return glm::dvec3(parts[0].number(), parts[1].number(), parts[2].number());
}

Result<double> number_from(const Json& entry, const char* field, double otherwise, std::uint64_t item) {
    const Json* value = entry.find(field);
    if (value == nullptr) return otherwise;
    if (value->text() == "infinity") return std::numeric_limits<double>::infinity();
    if (!value->is_number()) return fail(ErrorCode::parse, item, std::string("camera: ") + field + " must be a number");
    return value->number();
}

}  // namespace

Aabb focus_of(const scene::Scene& scene) {
    // From the meshes' own extents, not from the boxes fitted to them: the camera must not depend on the bounds
    // compared.
    std::vector<Aabb> mesh_extents(scene.mesh_count());
    for (scene::MeshId mesh = 0; mesh < scene.mesh_count(); ++mesh)
        for (const glm::vec3& p : scene.mesh(mesh).positions) mesh_extents[mesh].include(glm::dvec3(p));
    struct Extent {
        Aabb box;
        double weight;
    };
    std::vector<Extent> extents;
    double total = 0.0;
    for (scene::InstanceId i = 0; i < scene.instance_count(); ++i) {
        if (scene.layer_masks()[i] == 0) continue;
        const scene::MeshId mesh = scene.mesh_of(i);
        const Transform& world = scene.world(scene.node_of(i));
        const glm::dvec3 center = world.linear * mesh_extents[mesh].center() + world.translation;
        const glm::dvec3 half = mesh_extents[mesh].half_extents();
        const glm::dvec3 half_size = glm::abs(world.linear[0]) * half.x + glm::abs(world.linear[1]) * half.y +
                                     glm::abs(world.linear[2]) * half.z;
        extents.push_back(
            {{center - half_size, center + half_size}, static_cast<double>(scene.mesh(mesh).triangle_count())});
        total += extents.back().weight;
    }
    Aabb focus;
    for (int axis = 0; axis < 3; ++axis)
        for (const bool upper : {false, true}) {
            const auto end_of = [&](const Extent& e) { return upper ? -e.box.max[axis] : e.box.min[axis]; };
            std::sort(extents.begin(), extents.end(),
                      [&](const Extent& a, const Extent& b) { return end_of(a) < end_of(b); });
            double below = 0.0;
            for (const Extent& extent : extents) {
                below += extent.weight;
                if (below < 0.05 * total) continue;
                (upper ? focus.max : focus.min)[axis] = upper ? -end_of(extent) : end_of(extent);
                break;
            }
        }
    return focus;
}

Result<CameraPath> make_camera_path(const PathOptions& options, const Aabb& bounds, std::span<const glm::dvec3> walk) {
    const bool built_in =
        options.kind == "orbit" || options.kind == "street" || options.kind == "flight" || options.kind == "random";
    if (!built_in) {
        if (!std::filesystem::exists(options.kind))
            return fail(ErrorCode::invalid_argument, kNoItem,
                        "camera: '" + options.kind + "' is neither orbit, street, flight, random nor a file");
        auto recorded = load_camera_path(options.kind, options.limits);
        if (!recorded || options.frames == 0) return recorded;
        const std::size_t length = recorded->cameras.size();
        recorded->cameras.resize(options.frames);
        recorded->scene_frames.resize(options.frames);
        for (std::size_t i = length; i < options.frames; ++i) {
            recorded->cameras[i] = recorded->cameras[i % length];
            recorded->scene_frames[i] = recorded->scene_frames[i % length];
        }
        return recorded;
    }
    if (bounds.is_empty())
        return fail(ErrorCode::empty, kNoItem, "camera: the scene is empty, there is nothing to look at");
    const Frame frame = frame_of(bounds);
    const Camera base = base_camera(options, frame);
    Camera close_up = base;
    if (options.eye_height > 0.0)
        close_up.near_distance = std::min(base.near_distance, kNearOfEyeHeight * options.eye_height);
    std::vector<glm::dvec3> path(walk.begin(), walk.end());
    if (path.empty()) {
        const bool along_x = bounds.max.x - bounds.min.x >= bounds.max.z - bounds.min.z;
        const double eye = bounds.min.y + std::min(0.25 * frame.height, 0.02 * frame.radius);
        path = {bounds.min, bounds.max};
        for (glm::dvec3& p : path) {
            p.y = eye;
            (along_x ? p.z : p.x) = along_x ? frame.center.z : frame.center.x;
        }
    }
    std::mt19937_64 random(options.seed);
    const std::uint32_t frames = options.frames > 0 ? options.frames : kBuiltInFrames;
    CameraPath result;
    for (std::uint32_t i = 0; i < frames; ++i) {
        const double t = static_cast<double>(i) / static_cast<double>(frames);
        result.scene_frames.push_back(i);
        if (options.kind == "orbit")
            result.cameras.push_back(orbit(base, frame, t));
        else if (options.kind == "street")
            result.cameras.push_back(street(close_up, options, path, t));
        else if (options.kind == "flight")
            result.cameras.push_back(flight(base, bounds, frame, t));
        else
            result.cameras.push_back(random_camera(base, bounds, random));
    }
    return result;
}

Json to_json(const Camera& camera) {
    const auto vector = [](const glm::dvec3& v) { return Json::array({v.x, v.y, v.z}); };
    Json entry = {{"position", vector(camera.position)},
                  {"forward", vector(camera.forward)},
                  {"up", vector(camera.up)},
                  {"fov_y", camera.fov_y},
                  {"aspect", camera.aspect},
                  {"near", camera.near_distance},
                  {"far", std::isinf(camera.far_distance) ? Json("infinity") : Json(camera.far_distance)}};
    if (camera.projection == Projection::orthographic) entry["height"] = camera.height;
    return entry;
}

Result<Camera> camera_from_json(const Json& entry, std::uint64_t item) {
    if (!entry.is_object()) return fail(ErrorCode::parse, item, "camera: an entry is not an object");
    Camera camera;
    for (auto [field, value] : {std::pair{"position", &camera.position}, std::pair{"forward", &camera.forward},
                                std::pair{"up", &camera.up}}) {
        auto read = vector_from(entry, field, *value, item);
        if (!read) return read.error();
        *value = *read;
    }
    for (auto [field, value] : {std::pair{"fov_y", &camera.fov_y}, std::pair{"aspect", &camera.aspect},
                                std::pair{"near", &camera.near_distance}, std::pair{"far", &camera.far_distance}}) {
        auto read = number_from(entry, field, *value, item);
        if (!read) return read.error();
        *value = *read;
    }
    if (entry.find("height") != nullptr) {
        auto height = number_from(entry, "height", camera.height, item);
        if (!height) return height.error();
        camera.projection = Projection::orthographic;
        camera.height = *height;
    }
    if (auto valid = validate(camera); !valid) return fail(valid.error().code, item, valid.error().message);
    return camera;
}

Result<CameraPath> load_camera_path(const std::string& path, const assets::ReadLimits& limits) {
    const auto text = assets::read_file(path, limits.bytes);
    if (!text) return text.error();
    if (auto shape = assets::check_json_shape(*text, limits); !shape) return assets::in_file(path, "", shape.error());
    Json document;
    if (!parse_json(*text, document)) return fail(ErrorCode::parse, kNoItem, path + ": not valid JSON");
    const Json* list = &document;
    for (const char* name : {"cameras", "frames"})
        if (const Json* found = document.find(name)) list = found;
    if (list->elements().empty())
        return fail(ErrorCode::parse, kNoItem,
                    path + ": no cameras; expected an array, {\"cameras\": […]} or the JSON of 'crofton frames'");
    CameraPath result;
    for (const Json& entry : list->elements()) {
        const std::size_t number = result.cameras.size();
        const Json* wrapped = entry.find("camera");
        auto camera = camera_from_json(wrapped != nullptr ? *wrapped : entry, number);
        if (!camera) return fail(camera.error().code, camera.error().item, path + ": " + camera.error().message);
        result.cameras.push_back(*camera);
        result.scene_frames.push_back(static_cast<std::uint32_t>(number));
        const Json* scene_frame = entry.find("scene_frame");
        if (scene_frame == nullptr) continue;
        if (!scene_frame->is_number_unsigned() || scene_frame->whole() > std::numeric_limits<std::uint32_t>::max())
            return fail(ErrorCode::parse, number, path + ": scene_frame must be a whole number below 2^32");
        result.scene_frames.back() = static_cast<std::uint32_t>(scene_frame->whole());
    }
    return result;
}

}  // namespace crofton::pipeline
