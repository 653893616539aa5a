// SPDX-License-Identifier: MIT
#include "radiosity_output.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/lines/lines.hpp>
#include <crofton/render/device.hpp>
#include <crofton/render/rasterizer.hpp>
#include <cstdio>
#include <cstring>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>
#include <optional>
#include <utility>

#include "assets/print.hpp"
#include "assets/split_mesh.hpp"
#include "interrupt.hpp"
#include "json/json.hpp"
#include "pipeline/png.hpp"
#include "progress_bar.hpp"
#include "report.hpp"

namespace crofton::cli {

namespace {

constexpr double kOnSide = 2e-4;  // metres between a vertex and the side it is meant to lie on
constexpr double kLeastTriangles = 50'000.0;
constexpr float kMiddle = 0.30f;  // where the mean of the logarithm of the light goes
constexpr float kWhite = 5.0f;    // the exposed light that just becomes white
constexpr std::size_t kTrianglesPerPiece = 2048;

float luminance(const glm::vec3& c) {
    return glm::dot(c, glm::vec3(0.2126f, 0.7152f, 0.0722f));
}

// How long edges may be where: `edge` around the middle of the scene's triangles, and beyond the three quarters of them
// that are nearest ever longer, so that a town's countryside does not take the town's patches.
struct EdgeLengths {
    glm::dvec3 center{0.0};
    double radius = 0.0, edge = 0.0;

    [[nodiscard]] double factor(const glm::dvec3& p) const {
        return std::max(1.0, glm::length(p - center) / std::max(radius, 1e-30));
    }
    double operator()(const glm::vec3& p) const { return edge * factor(glm::dvec3(p)); }
};

EdgeLengths automatic_edges(const TriangleMesh& mesh) {
    const std::size_t count = mesh.triangle_count();
    std::vector<glm::dvec3> middles(count);
    for (std::size_t t = 0; t < count; ++t)
        for (std::size_t k = 0; k < 3; ++k) middles[t] += glm::dvec3(mesh.positions[mesh.indices[3 * t + k]]) / 3.0;
    const auto quantile = [](std::vector<double> values, double share) {
        const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
        std::nth_element(values.begin(), at, values.end());
        return *at;
    };
    EdgeLengths lengths;
    std::vector<double> values(count);
    for (int k = 0; k < 3; ++k) {
        for (std::size_t t = 0; t < count; ++t) values[t] = middles[t][k];
        lengths.center[k] = quantile(values, 0.5);
    }
    for (std::size_t t = 0; t < count; ++t) values[t] = glm::length(middles[t] - lengths.center);
    lengths.radius = quantile(values, 0.75);
    double cells = 0.0;  // that an edge of 1 would make
    for (std::size_t t = 0; t < count; ++t) {
        const auto at = [&](std::size_t k) { return glm::dvec3(mesh.positions[mesh.indices[3 * t + k]]); };
        cells +=
            0.5 * glm::length(glm::cross(at(1) - at(0), at(2) - at(0))) / std::pow(lengths.factor(middles[t]), 2.0);
    }
    lengths.edge = 2.0 * std::sqrt(cells / std::max(kLeastTriangles, static_cast<double>(count)));
    return lengths;
}

radiosity::Material operator+(const radiosity::Material& a, const radiosity::Material& b) {
    return {a.emission + b.emission, a.reflectance + b.reflectance};
}

// Means over the patches' triangles.
Vector<radiosity::Material> mean_materials(const LitScene& scene, std::span<const std::uint32_t> patches) {
    const TriangleMesh& mesh = scene.patches.mesh;
    Vector<radiosity::Material> sums(*std::max_element(patches.begin(), patches.end()) + 1,
                                     {glm::vec3(0.0f), glm::vec3(0.0f)});
    Vector<float> areas(sums.size(), 0.0f);
    for (std::size_t t = 0; t < patches.size(); ++t) {
        const auto at = [&](std::size_t k) { return mesh.positions[mesh.indices[3 * t + k]]; };
        const auto color = [&](std::size_t k) { return mesh.colors[mesh.indices[3 * t + k]]; };
        const float area = glm::length(glm::cross(at(1) - at(0), at(2) - at(0)));
        radiosity::Material& sum = sums[patches[t]];
        sum = sum + radiosity::Material{area * scene.emission[t], area / 3.0f * (color(0) + color(1) + color(2))};
        areas[patches[t]] += area;
    }
    for (std::size_t i = 0; i < sums.size(); ++i) {
        sums[i].emission /= areas[i];
        sums[i].reflectance = glm::clamp(sums[i].reflectance / areas[i], 0.0f, kMostReflectance);
    }
    return sums;
}

double sum_of(const glm::vec3& v) {
    return static_cast<double>(v.x) + static_cast<double>(v.y) + static_cast<double>(v.z);
}

}  // namespace

Result<LitScene> lit_scene(const assets::FlatScene& scene, double edge, const std::optional<SunEdges>& sun) {
    EdgeLengths lengths;
    if (edge == 0.0) {
        lengths = automatic_edges(scene.mesh);
        edge = lengths.edge;
    }
    auto mended = radiosity::mend_t_junctions(scene.mesh, kOnSide);
    if (!mended) return mended.error();
    auto refined = lengths.edge > 0.0 ? radiosity::refine(mended->mesh, radiosity::EdgeLength(lengths))
                                      : radiosity::refine(mended->mesh, edge);
    if (!refined) return refined.error();
    std::optional<lines::LineTracer> tracer;
    if (sun) {
        auto built = lines::LineTracer::build(refined->mesh);
        if (!built) return built.error();
        tracer.emplace(std::move(*built));
        auto cut = radiosity::refine_at_shadows(*tracer, refined->mesh, sun->to_sun, sun->halvings);
        if (!cut) return cut.error();
        for (std::uint32_t& source : cut->source) source = refined->source[source];
        *refined = std::move(*cut);
    }
    LitScene result;
    result.patches.mesh.positions = std::move(refined->mesh.positions);
    result.patches.mesh.colors = std::move(refined->mesh.colors);
    for (glm::vec3& color : result.patches.mesh.colors) color = glm::clamp(color, 0.0f, kMostReflectance);
    Vector<std::uint32_t> labels;  // what may not share a patch
    for (std::size_t t = 0; t < refined->source.size(); ++t) {
        const std::uint32_t* v = &refined->mesh.indices[3 * t];
        const auto at = [&](std::size_t k) { return glm::dvec3(result.patches.mesh.positions[v[k]]); };
        // Halving may leave slivers that round to nothing.
        if (!(glm::length(glm::cross(at(1) - at(0), at(2) - at(0))) > 0.0)) continue;
        result.patches.mesh.indices.insert(result.patches.mesh.indices.end(), v, v + 3);
        result.emission.push_back(scene.emission[mended->source[refined->source[t]]]);
        labels.push_back(result.emission.back() == glm::vec3(0.0f) ? 0 : 1);
    }
    if (sun) {
        const auto lit = radiosity::sunlit_triangles(*tracer, result.patches.mesh, sun->to_sun);
        if (!lit) return lit.error();
        for (std::size_t t = 0; t < labels.size(); ++t) labels[t] += 2 * (*lit)[t];
    }
    const auto patches = radiosity::group_small_triangles(result.patches.mesh, labels, edge);
    const auto materials = mean_materials(result, patches);
    auto made = radiosity::make_patches(std::move(result.patches.mesh), patches, materials);
    if (!made) return made.error();
    result.patches = std::move(*made);
    return result;
}

float automatic_exposure(const LitScene& scene, const radiosity::Solver& solver) {
    double sum = 0.0, area = 0.0;
    for (std::size_t i = 0; i < scene.patches.count(); ++i) {
        const double weight = scene.patches.areas[i] * solver.exposed_share(i);
        const double light = static_cast<double>(luminance(glm::max(solver.radiosity()[i], glm::vec3(0.0f))));
        sum += weight * std::log(light + 1e-6);
        area += weight;
    }
    return area > 0.0 ? kMiddle / static_cast<float>(std::exp(sum / area)) : 1.0f;
}

TriangleMesh lit_mesh(const LitScene& scene, const radiosity::Solver& solver) {
    Vector<double> weights(scene.patches.count());
    for (std::size_t i = 0; i < weights.size(); ++i) weights[i] = solver.exposed_share(i);
    const auto corners = radiosity::corner_values(scene.patches, solver.irradiance(), weights);
    TriangleMesh mesh;
    mesh.indices.resize(corners.size());
    std::iota(mesh.indices.begin(), mesh.indices.end(), 0u);
    for (std::size_t c = 0; c < corners.size(); ++c) {
        const std::uint32_t vertex = scene.patches.mesh.indices[c];
        mesh.positions.push_back(scene.patches.mesh.positions[vertex]);
        mesh.colors.push_back(scene.emission[c / 3] +
                              scene.patches.mesh.colors[vertex] * glm::max(corners[c], glm::vec3(0.0f)));
    }
    return mesh;
}

// Reinhard et al., "Photographic tone reproduction for digital images", 2002, equation 4, on luminance, so that hues
// stay; what then still exceeds 1 in a channel is cut.
glm::vec3 compressed(const glm::vec3& light) {
    const float l = luminance(light);
    return glm::clamp(light * ((1.0f + l / (kWhite * kWhite)) / (1.0f + l)), 0.0f, 1.0f);
}

Result<void> write_glb(const std::string& path, const TriangleMesh& whole) {
    std::string binary;
    Json views = Json::array(), accessors = Json::array(), primitives = Json::array();
    const auto append = [&](const void* data, std::size_t bytes) {
        views.push_back({{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", bytes}});
        binary.append(static_cast<const char*>(data), bytes);
    };
    const auto accessor = [&](int component, std::size_t count, const char* type) {
        accessors.push_back(
            {{"bufferView", views.size() - 1}, {"componentType", component}, {"count", count}, {"type", type}});
        return accessors.size() - 1;
    };
    for (const TriangleMesh& mesh : assets::split_mesh(whole, kTrianglesPerPiece)) {
        const std::size_t bytes = mesh.positions.size() * sizeof(glm::vec3);
        glm::vec3 low = mesh.positions[0], high = low;
        for (const glm::vec3& p : mesh.positions) {
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
        append(mesh.positions.data(), bytes);
        const std::size_t position = accessor(5126, mesh.positions.size(), "VEC3");
        accessors.back()["min"] = {low.x, low.y, low.z};
        accessors.back()["max"] = {high.x, high.y, high.z};
        append(mesh.colors.data(), bytes);
        const std::size_t color = accessor(5126, mesh.positions.size(), "VEC3");
        append(mesh.indices.data(), mesh.indices.size() * sizeof(std::uint32_t));
        const std::size_t indices = accessor(5125, mesh.indices.size(), "SCALAR");
        primitives.push_back(
            {{"attributes", {{"POSITION", position}, {"COLOR_0", color}}}, {"indices", indices}, {"material", 0}});
    }
    const Json document = {{"asset", {{"version", "2.0"}, {"generator", "crofton study radiosity"}}},
                           {"extensionsUsed", {"KHR_materials_unlit"}},
                           {"scene", 0},
                           {"scenes", {{{"nodes", {0}}}}},
                           {"nodes", {{{"mesh", 0}, {"name", "lit"}}}},
                           {"materials", {{{"extensions", {{"KHR_materials_unlit", Json::object()}}}}}},
                           {"meshes", {{{"primitives", primitives}}}},
                           {"accessors", accessors},
                           {"bufferViews", views},
                           {"buffers", {{{"byteLength", binary.size()}}}}};
    std::string json = document.dump();
    json.resize((json.size() + 3) / 4 * 4, ' ');
    std::string file;
    const auto word = [&](std::size_t value) {
        for (int shift = 0; shift < 32; shift += 8) file += static_cast<char>(value >> shift & 255u);
    };
    const std::size_t size = 12 + 8 + json.size() + 8 + binary.size();
    if (size >> 32 != 0) return fail(ErrorCode::out_of_range, kNoItem, path + ": glTF holds 4 GiB at most");
    file += "glTF";
    word(2);
    word(size);
    word(json.size());
    file += "JSON" + json;
    word(binary.size());
    file += std::string("BIN\0", 4) + binary;
    return write_file(path, file);
}

Result<void> write_lit_picture(const std::string& path, const TriangleMesh& mesh, const Camera& camera,
                               std::uint32_t width, std::uint32_t height, float sky) {
    render::DeviceOptions wanted;
    wanted.kind = render::DeviceKind::any;
    auto device = render::Device::create(wanted);
    if (!device) return device.error();
    auto rasterizer = render::Rasterizer::create(*device, {.width = width, .height = height});
    if (!rasterizer) return rasterizer.error();
    Vector<render::Vertex> vertices;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v)
        vertices.push_back(
            {glm::vec3(glm::dvec3(mesh.positions[v]) - camera.position), glm::vec3(0, 1, 0), mesh.colors[v]});
    if (auto set = rasterizer->set_geometry(vertices, mesh.indices); !set) return set;
    Camera here = camera;
    here.position = glm::dvec3(0.0);
    render::DrawTransform transform = render::draw_transform(glm::mat4(world_to_clip(here)), glm::dmat3(1.0));
    transform.unlit = 1.0f;
    const render::DrawRange range{0, static_cast<std::uint32_t>(mesh.indices.size()), 0, true};
    render::Frame frame;
    frame.camera = here;
    frame.transforms = {&transform, 1};
    frame.ranges = {&range, 1};
    frame.environment.haze_distance = 0.0f;
    for (glm::vec3* color : {&frame.environment.zenith, &frame.environment.horizon, &frame.environment.ground})
        *color *= sky;
    if (auto drawn = rasterizer->draw(frame); !drawn) return drawn.error();
    render::Image image;
    if (auto read = rasterizer->read_pixels(image); !read) return read;
    return write_file(path, pipeline::encode_png(image));
}

Result<ReferenceReport> compare_to_reference(const radiosity::Patches& patches, radiosity::SolverOptions options,
                                             std::uint64_t runs, const radiosity::Solver& found, Executor& executor) {
    options.seed += 1;
    auto reference = radiosity::Solver::create(patches, options);
    if (!reference) return reference.error();
    {
        ProgressBar bar("radiosity: reference", runs);
        for (; reference->runs() < runs; bar.set(reference->runs()))
            if (!reference->run(should_stop, nullptr, executor))
                return fail(ErrorCode::cancelled, kNoItem, "interrupted in the runs to compare with");
    }
    std::vector<double> errors;
    for (std::size_t i = 0; i < patches.count(); ++i) {
        const glm::vec3 light = reference->radiosity()[i];
        if (sum_of(light) > 0.0) errors.push_back(sum_of(glm::abs(found.radiosity()[i] - light)) / sum_of(light));
    }
    ReferenceReport report;
    report.runs = runs;
    report.reference_error = reference->relative_error();
    if (errors.empty()) return report;
    std::sort(errors.begin(), errors.end());
    const auto share_up_to = [&](double error) {
        const auto end = std::upper_bound(errors.begin(), errors.end(), error);
        return static_cast<double>(end - errors.begin()) / static_cast<double>(errors.size());
    };
    report.within_10 = share_up_to(0.10);
    report.beyond_25 = 1.0 - share_up_to(0.25);
    report.median = errors[errors.size() / 2];
    report.worst_of_95 = errors[static_cast<std::size_t>(0.95 * static_cast<double>(errors.size() - 1))];
    return report;
}

Json to_json(const ReferenceReport& report) {
    return {{"runs", report.runs},
            {"reference_error", report.reference_error},
            {"within_10_percent", report.within_10},
            {"beyond_25_percent", report.beyond_25},
            {"median_error", report.median},
            {"error_of_95_percent", report.worst_of_95}};
}

void print(const ReferenceReport& report) {
    print_to(
        stdout,
        "compared with %llu runs of another seed (%.2f %%): %.1f %% of patches within 10 %% of their light, %.1f %% "
        "off by "
        "more than 25 %%; half within %.1f %%, 95 %% within %.1f %%\n",
        static_cast<unsigned long long>(report.runs), 100.0 * report.reference_error, 100.0 * report.within_10,
        100.0 * report.beyond_25, 100.0 * report.median, 100.0 * report.worst_of_95);
}

}  // namespace crofton::cli
