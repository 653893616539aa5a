// SPDX-License-Identifier: MIT
// Light in a scene of patches, by random walks along global lines. It is usable after the first run, and better with
// every run.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/core/stop.hpp>
#include <crofton/lines/lines.hpp>
#include <crofton/radiosity/patches.hpp>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

namespace crofton::detail {
class StopSignal;
}

namespace crofton::radiosity {

// Light from outside the scene.
struct Outside {
    glm::vec3 sky{0.0f};  // radiosity of a uniform sky in every direction
    glm::vec3 sun{0.0f};  // irradiance on a surface that faces the sun
    glm::dvec3 to_sun{0.0, 1.0, 0.0};
};

enum class Transport : std::uint8_t {
    global,  // every bounce by global lines, each stretch used both ways (multipath)
    local,   // every bounce by local lines from each patch, as many rays as global lines would give
};

struct SolverOptions {
    std::uint64_t lines = 0;       // global lines of a run's first gathering; 0: 64 bundles
    std::uint64_t first_shot = 0;  // rays from the lamps per run; 0: a quarter of the lines, within [2^12, 2^18]
    std::optional<lines::LineMethod> method{};  // default: bundles
    Transport transport = Transport::global;
    sampling::Sequence sequence = sampling::Sequence::quasi_random;
    std::uint64_t seed = 1;
    double cutoff = 1e-3;  // a run ends when the light that still travels is below this share of all light
    std::uint32_t most_bounces = 200;
    Outside outside{};
};

// Computes light in runs.
//
// In a run, lamps first shoot local lines, and patches test whether they see the sun, because global lines would rarely
// meet small bright lamps. Then each patch gathers the mean of the light that its rays along N global lines bring: the
// sky's, and the light of all patches as known from earlier runs. The light that a gathering finds in addition to the
// known light travels on: it is gathered along new and fewer lines, until it is spent. The expected value of a run is
// the exact light, whatever the earlier runs found: their result is a control variate. The better it is, the less the
// many bounces spread.
//
// The result is the mean of the runs. Its error is their spread, which falls as 1/√runs. With quasi-random numbers the
// true error is smaller than this estimate, because runs share a sequence and compensate each other.
//
// If solids intersect, parts of patches lie inside a solid. A ray from such a part meets a back face first and is not
// counted, so a patch's light is that of its visible part. One step is not exact: a patch that gets no ray in a
// gathering gets four local rays. unseen() is the share of patches that saw nothing even then, because they are buried.
class Solver {
  public:
    // The patches must outlive the solver. Errors: no light at all, neither emission, sky nor sun; numbers out of
    // range.
    [[nodiscard]] static Result<Solver> create(const Patches& patches, const SolverOptions& options = {});

    // Makes one more run. The bits are the same for any executor.
    void run(Executor& executor = serial_executor());
    // Does the same, unless `should_stop` returns true meanwhile. The run is then discarded as if it had not begun, and
    // the function returns false. `share_done` is always 0.
    bool run(StopCallback should_stop, void* user, Executor& executor = serial_executor());

    [[nodiscard]] std::uint64_t runs() const { return runs_; }
    [[nodiscard]] std::span<const glm::vec3> radiosity() const { return mean_; }  // by patch; the mean over runs
    // Returns the incoming light per unit area, also for patches of reflectance 0.
    [[nodiscard]] Vector<glm::vec3> irradiance() const;
    // Returns the root of the area-weighted mean square standard error over that of the radiosity, all channels
    // together. It is infinite before the second run.
    [[nodiscard]] double relative_error() const;
    // Returns the share of patches, by number, whose radiosity is within `tolerance` of its own size, all channels
    // together.
    //
    // relative_error() is a mean in which bright patches weigh most; this is not. It uses the spread of the runs and
    // Student's t, so it tends to be too small after few runs, and is 0 before the third. Patches that give off no
    // light are left out.
    [[nodiscard]] double share_within(double tolerance) const;
    [[nodiscard]] double unseen() const;
    // Returns the share of a patch that is not buried, by its rays so far. It is 0 if all of it is buried, and 1 before
    // the first run.
    [[nodiscard]] double exposed_share(std::size_t patch) const;
    [[nodiscard]] lines::LineMethod method() const { return method_; }
    [[nodiscard]] std::uint64_t lines_traced() const { return lines_traced_; }
    [[nodiscard]] std::uint32_t bounces_of_last_run() const { return bounces_; }
    // Returns the memory of this object without the patches, which is linear in the triangles.
    [[nodiscard]] std::size_t bytes() const;

    // checkpoint() returns the data that resume() needs to continue with the same bits, on machines of the same byte
    // order. Errors of resume: damaged bytes; a checkpoint of other patches or options.
    [[nodiscard]] Vector<std::byte> checkpoint() const;
    [[nodiscard]] Result<void> resume(std::span<const std::byte> bytes);

  private:
    friend class Bake;
    using Light = Vector<glm::dvec3>;  // by patch

    struct Gathering {
        const Light* leaving = nullptr;
        glm::dvec3 sky{0.0};
        std::uint64_t lines = 0;
        std::uint64_t stream = 0;  // of numbers, shared by all runs
    };

    Solver(const Patches& patches, const SolverOptions& options, lines::LineTracer tracer, lines::BundleTracer bundles);
    void list_triangles();
    [[nodiscard]] double lines_of_bundle() const;
    [[nodiscard]] std::uint32_t triangle_of(std::size_t patch, double u) const;
    [[nodiscard]] Light arriving_in_a_run(Executor& executor);
    void shoot_lamps(Light& arrived, Executor& executor);
    void look_for_sun(Light& arrived, Executor& executor);
    void gather(const Gathering& what, Light& arrived, Executor& executor);
    void gather_lines(const Gathering& what, Light& arrived, Executor& executor);
    void gather_bundles(const Gathering& what, Light& arrived, Executor& executor);
    void gather_local(const Gathering& what, Light& arrived, Executor& executor);
    void gather_unseen(const Gathering& what, Light& arrived, Executor& executor);
    void cast_local(const Gathering& what, std::span<const std::uint32_t> patches, std::span<const std::uint64_t> ends,
                    std::uint64_t stream, Light& arrived, Executor& executor);
    void take(std::span<const lines::Hit> crossings, const Gathering& what, Light& arrived);
    void add_run(const Light& arrived);
    void update_mean();
    [[nodiscard]] std::uint64_t fingerprint() const;
    void forget();  // all runs

    const Patches* patches_;
    SolverOptions options_;
    lines::LineTracer tracer_;
    lines::BundleTracer bundles_;
    lines::LineMethod method_;
    double surface_ = 0.0, box_area_ = 0.0;
    Vector<std::uint32_t> triangles_, first_triangle_;  // of each patch: triangles_[first_triangle_[i] …]
    Vector<double> triangle_sums_;                      // their areas, added up within the patch

    std::uint64_t first_run_ = 0;  // the number of the first run, of those of all chains of a bake
    std::uint64_t runs_ = 0, lines_traced_ = 0, unseen_ = 0, seen_ = 0;
    std::uint32_t bounces_ = 0;
    Light sum_, squares_;                   // of what arrived, over runs
    Vector<std::uint64_t> drawn_, buried_;  // rays that started on each patch, and those that met a back first
    Vector<glm::vec3> mean_;
    Vector<std::uint32_t> rays_;                   // scratch of a gathering
    crofton::detail::StopSignal* stop_ = nullptr;  // of the run that is being made, if it may be stopped
};

// Bakes in parts: any number of runs, on any machines, with the same bytes as result.

// The number of consecutive runs that use each other's light. Chains are independent of each other; each part of a bake
// consists of chains.
inline constexpr std::uint64_t kRunsOfChain = 8;

// One of `count` parts of a bake, which may run on different machines.
struct Shard {
    std::uint32_t index = 0, count = 1;
};

struct BakeLimits {
    double seconds = std::numeric_limits<double>::infinity();  // no further chain begins after this; at least one does
    Shard shard = {};
    // If it returns true, the bake stops and keeps the complete chains.
    StopCallback should_stop = nullptr;
    void* user = nullptr;
};

// Makes runs of a Solver in chains of kRunsOfChain.
//
// Chain c is a function of the patches, the options and c. Sums over chains are added in one binary tree, by their
// numbers. So any executor, order, stop and split gives the same bytes.
class Bake {
  public:
    // Makes a bake of `runs` runs in total. The patches must outlive it. Errors: as Solver::create; no run, or more
    // than 2^32.
    [[nodiscard]] static Result<Bake> create(const Patches& patches, const SolverOptions& options, std::uint64_t runs);

    // Makes the remaining runs of a shard, up to the limits. Errors, which keep the results so far: a shard's index
    // that is not below its count; a count of 0; out of memory.
    [[nodiscard]] Result<void> run(const BakeLimits& limits = {}, Executor& executor = serial_executor());
    [[nodiscard]] std::uint64_t runs_planned() const { return sums_.runs; }
    [[nodiscard]] std::uint64_t runs_done() const { return solver_.runs(); }
    [[nodiscard]] bool is_complete() const { return runs_done() == runs_planned(); }
    // Returns the light of all runs so far, with its error.
    [[nodiscard]] const Solver& solver() const { return solver_; }

    // Returns all results so far, to be stored: the same bytes for the same chains.
    [[nodiscard]] Result<Vector<std::byte>> state() const;
    // Adds the results in a state of the same bake, such as a checkpoint or a part. Adding one twice counts once.
    // Errors, which change nothing: a damaged state (parse); a state of other patches, options or another number of
    // runs (invalid_argument).
    [[nodiscard]] Result<void> add_state(std::span<const std::byte> state);

    // The sum of the results of some consecutive chains.
    struct Sum {
        std::uint64_t begin = 0, end = 0;  // chains: as many as a power of two, of which `begin` is a multiple
        std::uint64_t lines = 0, unseen = 0, seen = 0;
        Vector<glm::dvec3> light, squares;    // by patch
        Vector<std::uint64_t> drawn, buried;  // rays, by patch
    };
    struct Sums {
        std::uint64_t fingerprint = 0, patches = 0, runs = 0;
        Vector<Sum> all;  // ascending, no two that could be merged
    };

  private:
    Bake(Solver solver, std::uint64_t runs);
    void show_sum();  // in solver_
    Solver solver_;
    Sums sums_;
};

// Tests whether these bytes begin like a state of a light bake.
[[nodiscard]] bool is_bake_state(std::span<const std::byte> bytes);

// Merges parts of one bake into the same bytes as those of a single run. Errors: no parts; a part that is damaged or of
// another bake (item: the part).
[[nodiscard]] Result<Vector<std::byte>> merge_states(std::span<const std::span<const std::byte>> states);

// Returns the shards of `count` whose runs a state lacks, and which must run again, ascending. Errors: a damaged state;
// a count of 0.
[[nodiscard]] Result<Vector<std::uint32_t>> missing_shards(std::span<const std::byte> state, std::uint32_t count);

}  // namespace crofton::radiosity
