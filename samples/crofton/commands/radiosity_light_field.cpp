// SPDX-License-Identifier: MIT
#include "radiosity_light_field.hpp"

#include <cmath>
#include <crofton/study/light_field.hpp>
#include <cstdio>
#include <glm/geometric.hpp>

#include "assets/print.hpp"
#include "interrupt.hpp"
#include "pipeline/png.hpp"
#include "progress_bar.hpp"
#include "radiosity_output.hpp"
#include "report.hpp"

namespace crofton::cli {
namespace {

constexpr std::uint32_t kPictureWidth = 640, kPictureHeight = 360;

// Between the triangle's corners, by areas.
study::Leaving light_at(const TriangleMesh& mesh, std::uint32_t triangle, const glm::dvec3& point) {
    const std::size_t v = std::size_t{3} * triangle;
    const glm::dvec3 a(mesh.positions[v]), b(mesh.positions[v + 1]), c(mesh.positions[v + 2]);
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const double whole = glm::dot(normal, normal);
    const double at_b = glm::dot(glm::cross(point - a, c - a), normal) / whole,
                 at_c = glm::dot(glm::cross(b - a, point - a), normal) / whole;
    const glm::dvec3 light = (1.0 - at_b - at_c) * glm::dvec3(mesh.colors[v]) + at_b * glm::dvec3(mesh.colors[v + 1]) +
                             at_c * glm::dvec3(mesh.colors[v + 2]);
    return {glm::vec3(glm::max(light, glm::dvec3(0.0))), glm::vec3(glm::normalize(normal))};
}

// IEC 61966-2-1.
std::uint8_t srgb_byte(float linear) {
    const float value = linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
    return static_cast<std::uint8_t>(std::lround(255.0f * glm::clamp(value, 0.0f, 1.0f)));
}

render::Image shown(const study::LightPicture& picture, float exposure) {
    render::Image image{picture.width, picture.height, {}};
    for (const glm::vec3& light : picture.pixels) {
        const glm::vec3 color = compressed(exposure * light);
        for (int k = 0; k < 3; ++k) image.rgba.push_back(srgb_byte(color[k]));
        image.rgba.push_back(255);
    }
    return image;
}

// The mean absolute difference, of 255 steps.
double steps_apart(const render::Image& a, const render::Image& b) {
    double apart = 0.0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i) apart += std::abs(a.rgba[i] - b.rgba[i]);
    return apart / (0.75 * static_cast<double>(a.rgba.size()));
}

}  // namespace

Result<LightFieldReport> draw_light_field(const LightFieldRun& run, Executor& executor) {
    const auto light = [&](std::uint32_t triangle, const glm::dvec3& point) {
        return light_at(run.light, triangle, point);
    };
    study::LightFieldOptions options;
    options.lines = run.lines;
    options.seed = run.seed;
    options.sky = run.sky;
    options.should_stop = should_stop;
    ProgressBar bar("radiosity: light field");
    const auto field = study::LightField::record(run.tracer, light, options, executor);
    if (!field) return field.error();
    const auto drawn = field->draw(run.camera, kPictureWidth, kPictureHeight, {});
    if (!drawn) return drawn.error();
    const auto direct =
        study::direct_picture(run.tracer, light, run.sky, run.camera, kPictureWidth, kPictureHeight, executor);
    if (!direct) return direct.error();
    const render::Image from_lines = shown(drawn->picture, run.exposure), from_scene = shown(*direct, run.exposure);
    if (auto written = write_file(run.png_path, pipeline::encode_png(from_lines)); !written) return written.error();
    return LightFieldReport{field->lines(),
                            field->crossings(),
                            field->bytes(),
                            drawn->samples,
                            drawn->aperture,
                            study::relative_difference(drawn->picture, *direct),
                            steps_apart(from_lines, from_scene) / 255.0};
}

Json to_json(const LightFieldReport& report) {
    return {{"lines", report.lines},
            {"crossings", report.crossings},
            {"bytes", report.bytes},
            {"samples", report.samples},
            {"aperture", report.aperture},
            {"relative_error", report.relative_error},
            {"color_error", report.color_error}};
}

void print(const LightFieldReport& report) {
    print_to(stdout,
             "light field: %llu stored lines with %llu crossings, %.0f MB; those within %.3g m of the eye give %llu "
             "points;\n"
             "the picture from them is %.2f %% off in light, %.2f %% in colour\n",
             static_cast<unsigned long long>(report.lines), static_cast<unsigned long long>(report.crossings),
             1e-6 * static_cast<double>(report.bytes), report.aperture, static_cast<unsigned long long>(report.samples),
             100.0 * report.relative_error, 100.0 * report.color_error);
}

}  // namespace crofton::cli
