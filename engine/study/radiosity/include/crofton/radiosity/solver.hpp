// SPDX-License-Identifier: MIT
// Light in a scene of patches, by random walks along global lines: usable at any time, better with every run.
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
    std::optional<lines::LineMethod> method{};  // absent: bundles
    Transport transport = Transport::global;
    sampling::Sequence sequence = sampling::Sequence::quasi_random;
    std::uint64_t seed = 1;
    double cutoff = 1e-3;  // a run ends when what still travels is below this share of all light
    std::uint32_t most_bounces = 200;
    Outside outside{};
};

// One run. First lamps shoot local lines and patches look for the sun; global lines would rarely meet what is small and
// bright. Then each patch gathers the mean of what its rays along N global lines bring. That is the sky, and what the
// runs before know of all patches' light. What that gathering finds beyond what was known travels on, gathered along
// new and fewer lines, until it is spent. A run's expectation is the light itself, whatever the runs before knew: that
// serves as a control variate. The better it is known, the less the many bounces spread.
//
// The result is the mean of the runs, its error their spread: it falls as 1/√runs. With quasi-random numbers the true
// error is smaller than this estimate, since runs share a sequence and make up for each other.
//
// Where solids intersect, parts of patches lie inside: a ray from there meets a back first. Such rays count as not
// drawn, so a patch's light is that of the part that can be seen.
// What is not exact: a patch without any ray in a gathering is given four local ones. unseen() is the share of patches
// that even so saw nothing: those buried.
class Solver {
  public:
    // The patches must outlive the solver. Errors: no light at all, neither emission, sky nor sun; numbers out of
    // range.
    [[nodiscard]] static Result<Solver> create(const Patches& patches, const SolverOptions& options = {});

    // One more run. The same bits for any executor.
    void run(Executor& executor = serial_executor());
    // The same, unless `should_stop` returns true on the way: then the run is dropped as if it had not begun, and the
    // result is false. `share_done` is always 0.
    bool run(StopCallback should_stop, void* user, Executor& executor = serial_executor());

    [[nodiscard]] std::uint64_t runs() const { return runs_; }
    [[nodiscard]] std::span<const glm::vec3> radiosity() const { return mean_; }  // by patch; the mean over runs
    // What arrives per unit area; of patches of reflectance 0 too.
    [[nodiscard]] Vector<glm::vec3> irradiance() const;
    // Root of the area-weighted mean square standard error over that of the radiosity, all channels together; infinite
    // before the second run.
    [[nodiscard]] double relative_error() const;
    // relative_error() is a mean: bright patches weigh most. This is the share of patches, by number, whose radiosity
    // is within `tolerance` of its own size, all channels together. By the spread of their runs and Student's t; so it
    // is rather too small after few runs, and 0 before the third. Patches that give off nothing are left out.
    [[nodiscard]] double share_within(double tolerance) const;
    [[nodiscard]] double unseen() const;
    // The share of a patch that lies in the open, as its rays so far tell. It is 0 where all is buried, 1 before the
    // first run.
    [[nodiscard]] double exposed_share(std::size_t patch) const;
    [[nodiscard]] lines::LineMethod method() const { return method_; }
    [[nodiscard]] std::uint64_t lines_traced() const { return lines_traced_; }
    [[nodiscard]] std::uint32_t bounces_of_last_run() const { return bounces_; }
    // All that this object keeps, patches apart: linear in the triangles.
    [[nodiscard]] std::size_t bytes() const;

    // All that resume() needs to go on as if nothing had happened, on machines of the same byte order. Errors of
    // resume: damaged bytes; a checkpoint of other patches or options.
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

// A bake in parts: as many runs as one likes, on any machines, to the same bytes.

// Runs that know of each other's light. Those of other chains are independent: each part of a bake is some chains.
inline constexpr std::uint64_t kRunsOfChain = 8;

// One of `count` parts of a bake, which may run on different machines.
struct Shard {
    std::uint32_t index = 0, count = 1;
};

struct BakeLimits {
    double seconds = std::numeric_limits<double>::infinity();  // no further chain is begun then; one always is
    Shard shard = {};
    // Once it returns true, the bake stops and keeps the chains that are complete.
    StopCallback should_stop = nullptr;
    void* user = nullptr;
};

// Runs of a Solver in chains of kRunsOfChain. Chain c is a function of the patches, the options and c. Sums over chains
// are added up in one binary tree, by their numbers. So any executor, order, stop and split gives the same bytes.
class Bake {
  public:
    // `runs` in all. The patches must outlive the bake. Errors: as Solver::create; no run, or more than 2^32.
    [[nodiscard]] static Result<Bake> create(const Patches& patches, const SolverOptions& options, std::uint64_t runs);

    // Makes what is left of a shard, up to the limits. Errors: a shard's index that is not below its count; a count of
    // 0; out of memory. What was found before is kept.
    [[nodiscard]] Result<void> run(const BakeLimits& limits = {}, Executor& executor = serial_executor());
    [[nodiscard]] std::uint64_t runs_planned() const { return sums_.runs; }
    [[nodiscard]] std::uint64_t runs_done() const { return solver_.runs(); }
    [[nodiscard]] bool is_complete() const { return runs_done() == runs_planned(); }
    // The light that all runs so far found, with their error.
    [[nodiscard]] const Solver& solver() const { return solver_; }

    // All that is known, to be stored: the same bytes for the same chains.
    [[nodiscard]] Result<Vector<std::byte>> state() const;
    // Adds what a state of the same bake holds: a checkpoint, a part. Twice is once. Errors: damaged (parse); of other
    // patches, options or another number of runs (invalid_argument); then nothing has changed.
    [[nodiscard]] Result<void> add_state(std::span<const std::byte> state);

    // What some neighbouring chains found together.
    struct Sum {
        std::uint64_t begin = 0, end = 0;  // chains: as many as a power of two, of which `begin` is a multiple
        std::uint64_t lines = 0, unseen = 0, seen = 0;
        Vector<glm::dvec3> light, squares;    // by patch
        Vector<std::uint64_t> drawn, buried;  // rays, by patch
    };
    struct Sums {
        std::uint64_t fingerprint = 0, patches = 0, runs = 0;
        Vector<Sum> all;  // ascending, no two that belong together
    };

  private:
    Bake(Solver solver, std::uint64_t runs);
    void show_sum();  // in solver_
    Solver solver_;
    Sums sums_;
};

// Whether these bytes begin as a state of a bake of light does.
[[nodiscard]] bool is_bake_state(std::span<const std::byte> bytes);

// Parts of one bake as one: the same bytes as from a single run. Errors: none given; item, the part: damaged, or of
// another bake.
[[nodiscard]] Result<Vector<std::byte>> merge_states(std::span<const std::span<const std::byte>> states);

// Runs that a state lacks, as shards of `count`: those that must run again. Ascending. Errors: damaged; a count of 0.
[[nodiscard]] Result<Vector<std::uint32_t>> missing_shards(std::span<const std::byte> state, std::uint32_t count);

}  // namespace crofton::radiosity
