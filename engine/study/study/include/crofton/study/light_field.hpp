// SPDX-License-Identifier: MIT
// A light field: global lines stored with the light along them, from which pictures are drawn without the scene.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/core/stop.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/lines/lines.hpp>
#include <cstdint>
#include <glm/gtc/type_precision.hpp>
#include <glm/vec3.hpp>

namespace crofton::study {

// The light that leaves a triangle's front at a point, one value per colour channel. It is the same in all directions,
// because surfaces are diffuse. The unit normal points out of the front.
struct Leaving {
    glm::vec3 light{0.0f};
    glm::vec3 normal{0.0f};
};
using LightAt = FunctionRef<Leaving(std::uint32_t triangle, const glm::dvec3& point)>;

// A picture, row by row from the top. `depths` are distances from the eye, infinite for the sky.
struct LightPicture {
    std::uint32_t width = 0, height = 0;
    Vector<glm::vec3> pixels;
    Vector<double> depths;
};

struct LightFieldOptions {
    std::uint64_t lines = std::uint64_t{1} << 22;  // about so many that meet the scene's box, in [1, 2^28]
    std::uint64_t seed = 1;
    glm::vec3 sky{0.0f};                 // what comes along a line from beyond the scene
    StopCallback should_stop = nullptr;  // `share_done` is always 0
    void* user = nullptr;
};

// Stores uniform lines (docs/theory.md, section 6) in bundles of parallel ones, with all their crossings: their places,
// and the light that leaves there along the line. It stores neither triangles nor patches.
class LightField {
  public:
    // Errors: options out of range; a box that is flat in two directions; cancelled, by should_stop. The bits are the
    // same for any executor.
    [[nodiscard]] static Result<LightField> record(const lines::LineTracer& scene, LightAt light,
                                                   const LightFieldOptions& options = {},
                                                   Executor& executor = serial_executor());

    struct DrawOptions {
        double samples = 4.0;       // wanted per pixel, on average, in [1e-3, 1e3]
        std::uint32_t hiders = 12;  // of so many close to a pixel the nearest to the eye hides others, in [1, 64] …
        double depth_step = 0.05;   // … that lie farther away than this, relative to its distance
        std::uint32_t blend = 4;    // a pixel is the mean of so many at most of those not hidden, in [1, hiders]
    };
    struct Drawn {
        LightPicture picture;
        double aperture = 0.0;      // radius of the sphere around the eye through which the lines used pass
        std::uint64_t samples = 0;  // points in the picture that they gave
    };
    // Draws a picture from lines that pass near the eye, which see nearly what it sees.
    //
    // The first crossing of such a line, in either direction, is drawn at its true place in the picture. Pixels take
    // the nearest of these points, without hidden ones. The sphere around the eye is the smallest that gives the
    // desired samples. With more lines it shrinks, and with it the error. Errors: as validate(Camera); an orthographic
    // camera; a picture of no size or beyond 2^24 pixels; options out of range; no line near the eye, or nothing
    // recorded.
    [[nodiscard]] Result<Drawn> draw(const Camera& camera, std::uint32_t width, std::uint32_t height,
                                     const DrawOptions& options) const;

    // The first crossing of a line within `aperture` of the eye, to either side, and the distance at which the line
    // passes the eye. Crossings with backs, and with fronts that face away from the eye, are left out. Of parallel
    // lines only the nearest reaches the sky.
    struct Arrival {
        glm::dvec3 point{0.0};  // relative to the eye; of what comes from the sky a unit direction
        glm::vec3 light{0.0f};
        bool sky = false;
        double offset = 0.0;
    };
    [[nodiscard]] Vector<Arrival> arrivals(const glm::dvec3& eye, double aperture) const;

    [[nodiscard]] std::uint64_t lines() const { return lines_; }          // that meet something
    [[nodiscard]] std::uint64_t crossings() const { return crossings_; }  // of these lines
    [[nodiscard]] std::size_t bytes() const;

  private:
    struct Crossing {
        float t;
        glm::u16vec3 light;  // that leaves the front, in half precision
        glm::i8vec3 normal;  // of the front, in 127ths
        bool front;          // the front looks against the line's direction
    };
    struct Bundle {
        lines::Bundle lines;
        Vector<std::uint32_t> ends;  // by cell
        Vector<Crossing> crossings;
    };

    glm::vec3 sky_{0.0f};
    double diagonal_ = 0.0;  // of the scene's box
    std::uint64_t lines_ = 0, crossings_ = 0;
    Vector<Bundle> bundles_;
};

// Draws the picture from the scene itself: one ray through the middle of each pixel, no light from backs.
[[nodiscard]] Result<LightPicture> direct_picture(const lines::LineTracer& scene, LightAt light, const glm::vec3& sky,
                                                  const Camera& camera, std::uint32_t width, std::uint32_t height,
                                                  Executor& executor = serial_executor());

// Returns the mean absolute difference of all pixels and channels over the mean of `truth`; 0 for equal pictures.
// Requires equal sizes.
[[nodiscard]] double relative_difference(const LightPicture& picture, const LightPicture& truth);

}  // namespace crofton::study
