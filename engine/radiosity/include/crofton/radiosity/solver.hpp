// Light in a scene of patches, by random walks along global lines: usable at any time, better with every run.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/radiosity/line_source.hpp>
#include <crofton/radiosity/line_tracer.hpp>
#include <crofton/radiosity/patches.hpp>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace crofton::radiosity {

// Light from outside the scene.
struct Outside {
    glm::vec3 sky{0.0f};  // radiosity of a uniform sky in every direction
    glm::vec3 sun{0.0f};  // irradiance on a surface that faces the sun
    glm::dvec3 to_sun{0.0, 1.0, 0.0};
};

enum class Transport : std::uint8_t {
    global,  // every bounce by global lines, each stretch used both ways (multipath); the first shot by local lines
    local,   // every bounce by local lines from each patch, as many rays as global lines would give
};

struct SolverOptions {
    std::uint64_t lines = 1u << 18;       // global lines per bounce, rounded up to whole blocks
    std::uint64_t first_shot = 1u << 18;  // rays from the light sources per run
    std::optional<LineMethod> method;     // absent: choose_method
    Transport transport = Transport::global;
    std::uint64_t seed = 1;
    double cutoff = 1e-4;  // a run ends when what still travels is below this share of all light
    std::uint32_t most_bounces = 200;
    Outside outside;
};

// One run: the light sources shoot local lines once (the first-shot improvement: small bright lamps are a waste of
// global lines), then in every bounce each patch gathers the mean of what its rays along N new global lines bring, and
// gives back its share. Runs are independent; the result is their mean, its error their spread: it falls as 1/√runs.
// What is not exact: a bounce's mean is unbiased wherever at least one ray starts on the patch; one without any (about
// e^−(expected rays) of the time) gathers nothing. unseen() counts them: give more lines where it is not small.
class Solver {
  public:
    // The patches must outlive the solver. Errors: no light at all, neither emission, sky nor sun; numbers out of
    // range.
    [[nodiscard]] static Result<Solver> create(const Patches& patches, const SolverOptions& options = {});

    // One more run. The same bits for any executor.
    void run(Executor& executor = serial_executor());

    [[nodiscard]] std::uint64_t runs() const { return runs_; }
    [[nodiscard]] std::span<const glm::vec3> radiosity() const { return mean_; }  // by patch; the mean over runs
    // Root of the area-weighted mean square standard error over that of the radiosity, all channels together; infinite
    // before the second run.
    [[nodiscard]] double relative_error() const;
    [[nodiscard]] double unseen() const;  // mean share of patches that no ray of a bounce started on
    [[nodiscard]] LineMethod method() const { return source_.method(); }
    [[nodiscard]] std::uint64_t lines_traced() const { return lines_traced_; }
    [[nodiscard]] std::uint32_t bounces_of_last_run() const { return bounces_; }

    // All that resume() needs to go on as if nothing had happened, on machines of the same byte order. Errors of
    // resume: damaged bytes; a checkpoint of other patches or options.
    [[nodiscard]] Vector<std::byte> checkpoint() const;
    [[nodiscard]] Result<void> resume(std::span<const std::byte> bytes);

  private:
    using Light = Vector<glm::dvec3>;  // by patch

    Solver(const Patches& patches, const SolverOptions& options, LineTracer tracer, LineMethod method);
    void shoot_lamps(Light& arrived, Executor& executor) const;
    void shoot_sun(Light& arrived, Executor& executor) const;
    void gather_global(const Light& leaving, bool sky, std::uint64_t stream, Light& arrived, Executor& executor);
    void gather_local(const Light& leaving, bool sky, std::uint64_t stream, Light& arrived, Executor& executor);
    [[nodiscard]] double power(const Light& light) const;
    void add_run(const Light& total);
    [[nodiscard]] std::uint64_t fingerprint() const;

    const Patches* patches_;
    SolverOptions options_;
    LineTracer tracer_;
    LineSource source_;
    std::uint64_t runs_ = 0, lines_traced_ = 0, unseen_ = 0, seen_ = 0;
    std::uint32_t bounces_ = 0;
    Light sum_, squares_;
    Vector<glm::vec3> mean_;
    Vector<std::uint32_t> rays_;  // scratch of a bounce
};

}  // namespace crofton::radiosity
