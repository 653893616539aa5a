// SPDX-License-Identifier: MIT
// A lit scene as stored lines, and the picture that they give, beside the scene's own.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/lines/lines.hpp>
#include <string>

#include "json/json.hpp"

namespace crofton::cli {

struct LightFieldRun {
    const TriangleMesh& light;  // three vertices a triangle, colours: what leaves there
    const lines::LineTracer& tracer;
    glm::vec3 sky;
    const Camera& camera;
    float exposure;
    std::uint64_t lines, seed;
    std::string png_path;
};

struct LightFieldReport {
    std::uint64_t lines = 0, crossings = 0, bytes = 0, samples = 0;
    double aperture = 0.0;
    double relative_error = 0.0;  // against the direct picture: of light
    double color_error = 0.0;     // and of the colours shown, 1 being white against black
};

// Writes the picture from lines alone, 640 by 360. Error: cancelled, if interrupted; then nothing is written.
[[nodiscard]] Result<LightFieldReport> draw_light_field(const LightFieldRun& run, Executor& executor);
[[nodiscard]] Json to_json(const LightFieldReport& report);
void print(const LightFieldReport& report);

}  // namespace crofton::cli
