// SPDX-License-Identifier: MIT
#include "verify.hpp"

#include <algorithm>
#include <bit>
#include <glm/geometric.hpp>
#include <iterator>

#include "brute_force.hpp"

namespace crofton::pipeline {
namespace {

constexpr std::size_t kMaxMessages = 50;

// Compares with a frame's numbers and notes what is wrong with it.
class FrameReport {
  public:
    FrameReport(const FrameStatistics& frame, Verification& verification)
        : frame_(frame), verification_(verification) {}

    void check_gpu(const std::string& name, const std::optional<render::GpuCounters>& gpu, std::uint64_t submitted,
                   std::uint64_t clipped, bool exactly) {
        if (!gpu) return;
        expect(name + ".input_assembly_primitives", submitted, gpu->input_assembly_primitives);
        if (!exactly) return;
        expect(name + ".clipping_invocations", submitted, gpu->clipping_invocations);
        expect(name + ".clipping_primitives", clipped, gpu->clipping_primitives);
    }

    void expect(const std::string& what, std::uint64_t expected, std::uint64_t got) {
        if (expected != got)
            report(verification_.wrong_counts,
                   what + " is " + std::to_string(got) + ", expected " + std::to_string(expected));
    }

    void report(std::uint64_t& counter, const std::string& message) {
        ++counter;
        if (verification_.messages.size() < kMaxMessages)
            verification_.messages.push_back("frame " + std::to_string(frame_.index) + ": " + message);
    }

  protected:
    const FrameStatistics& frame_;
    Verification& verification_;
};

class FrameVerifier : FrameReport {
  public:
    FrameVerifier(const scene::Scene& scene, const Pipeline& pipeline, const FrameStatistics& frame,
                  Verification& verification)
        : FrameReport(frame, verification), scene_(scene), pipeline_(pipeline), frustum_(*frustum_of(frame.camera)) {
        const double depth = std::isfinite(frame.camera.far_distance)
                                 ? 0.5 * (frame.camera.near_distance + frame.camera.far_distance)
                                 : 2.0 * frame.camera.near_distance + 1.0;
        interior_ = frame.camera.position + depth * glm::normalize(frame.camera.forward);
    }

    void check_instances(CullMode mode) {
        for (scene::InstanceId i = 0; i < scene_.instance_count(); ++i) {
            if (scene_.is_removed(i)) continue;
            const cull::Verdict verdict = pipeline_.verdicts()[i];
            if (scene_.layer_masks()[i] == 0) {
                if (verdict != cull::Verdict::outside)
                    report(verification_.wrong_verdicts, "instance " + std::to_string(i) + " is hidden but was listed");
                continue;
            }
            const ObjectTruth object = clip_object(i);
            if (object.meets == Truth::yes && verdict == cull::Verdict::outside)
                report(verification_.culled_but_visible,
                       "instance " + std::to_string(i) + " is visible but was culled");
            if (verdict != cull::Verdict::outside) {
                passed_ += object.passed;
                unclear_passed_ += object.unclear;
                submitted_ += scene_.mesh(scene_.mesh_of(i)).triangle_count();
            }
            if (mode != CullMode::none) check_verdict(i, verdict);
        }
    }

    void check_pairs() {
        const auto movers = pipeline_.movers();
        std::vector<std::pair<std::uint32_t, std::uint32_t>> found = frame_.colliding_ids;
        for (std::size_t a = 0; a < movers.size(); ++a)
            for (std::size_t b = a + 1; b < movers.size(); ++b) {
                const std::pair<std::uint32_t, std::uint32_t> pair{movers[a], movers[b]};
                if (scene_.is_removed(pair.first) || scene_.is_removed(pair.second)) continue;
                const Truth truth = boxes_meet(scene_.world_boxes()[pair.first], scene_.world_boxes()[pair.second]);
                const bool listed = std::binary_search(found.begin(), found.end(), pair);
                verification_.unclear += truth == Truth::unclear;
                if (truth != Truth::unclear && listed != (truth == Truth::yes))
                    report(verification_.wrong_pairs,
                           "pair " + std::to_string(pair.first) + ", " + std::to_string(pair.second) +
                               (listed ? " does not meet but was listed" : " meets but was not listed"));
            }
        if (found.size() != frame_.colliding_pairs)
            report(verification_.wrong_pairs, "colliding_pairs is not the number of pairs listed");
    }

    void check_counts(bool count_triangles, bool gpu_counts_exactly) {
        if (count_triangles) {
            expect("triangles_submitted", submitted_, frame_.triangles_submitted);
            verification_.unclear += unclear_passed_;
            if (frame_.triangles_passed < passed_ || frame_.triangles_passed > passed_ + unclear_passed_)
                expect("triangles_passed", passed_, frame_.triangles_passed);
        }
        check_gpu("gpu", frame_.gpu, frame_.triangles_submitted, frame_.triangles_clipped, gpu_counts_exactly);
    }

  private:
    struct ObjectTruth {
        Truth meets = Truth::no;
        std::uint64_t passed = 0, unclear = 0;
    };

    ObjectTruth clip_object(scene::InstanceId instance) const {
        const TriangleMesh& mesh = scene_.mesh(scene_.mesh_of(instance));
        const Transform& world = scene_.world(scene_.node_of(instance));
        ObjectTruth truth;
        for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
            glm::dvec3 triangle[3];
            for (std::size_t k = 0; k < 3; ++k)
                triangle[k] = world.linear * glm::dvec3(mesh.positions[mesh.indices[t + k]]) + world.translation;
            const Truth meets = clip_polygon(frustum_, triangle).meets;
            truth.passed += meets == Truth::yes;
            truth.unclear += meets == Truth::unclear;
        }
        truth.meets = truth.passed > 0 ? Truth::yes : truth.unclear > 0 ? Truth::unclear : Truth::no;
        return truth;
    }

    void check_verdict(scene::InstanceId instance, cull::Verdict verdict) {
        const Bounds& bounds = pipeline_.bounds();
        const BodyTruth truth = bounds.spheres().empty() ? clip_box(frustum_, bounds.boxes()[instance], interior_)
                                                         : clip_sphere(frustum_, bounds.spheres()[instance].center,
                                                                       bounds.spheres()[instance].radius);
        const bool meets = verdict != cull::Verdict::outside, contained = verdict == cull::Verdict::inside;
        if (truth.meets == Truth::unclear || truth.contained == Truth::unclear) ++verification_.unclear;
        if (truth.meets != Truth::unclear && meets != (truth.meets == Truth::yes))
            report(verification_.wrong_verdicts,
                   "the bound of instance " + std::to_string(instance) +
                       (meets ? " misses the frustum but passed" : " meets the frustum but was culled"));
        else if (truth.contained != Truth::unclear && contained != (truth.contained == Truth::yes))
            report(verification_.wrong_verdicts,
                   "the bound of instance " + std::to_string(instance) +
                       (contained ? " is not inside but was called so" : " is inside but was called straddling"));
    }

    const scene::Scene& scene_;
    const Pipeline& pipeline_;
    Frustum frustum_;
    glm::dvec3 interior_{0.0};
    std::uint64_t submitted_ = 0, passed_ = 0, unclear_passed_ = 0;
};

}  // namespace

void verify_frame(const scene::Scene& scene, const Pipeline& pipeline, const PipelineOptions& options,
                  const FrameStatistics& frame, bool gpu_counts_exactly, Verification& verification) {
    FrameVerifier verifier(scene, pipeline, frame, verification);
    verifier.check_instances(options.cull);
    verifier.check_pairs();
    verifier.check_counts(options.count_triangles, gpu_counts_exactly);
    ++verification.frames;
}

void verify_occlusion(const scene::Scene& scene, const BothOwners& owners, std::uint64_t changed_pixels,
                      bool gpu_counts_exactly, const FrameStatistics& frame, Verification& verification) {
    const OccludedFrame& result = *frame.occlusion;
    FrameReport report(frame, verification);
    const auto triangles_of = [&](std::span<const scene::InstanceId> instances) {
        std::uint64_t sum = 0;
        for (const scene::InstanceId i : instances) sum += scene.mesh(scene.mesh_of(i)).triangle_count();
        return sum;
    };
    std::vector<OwnerTriangle> differing;
    std::set_symmetric_difference(owners.of_all.begin(), owners.of_all.end(), owners.of_shown.begin(),
                                  owners.of_shown.end(), std::back_inserter(differing));
    for (const OwnerTriangle& owner : differing)
        report.report(verification.hidden_but_seen, "triangle " + std::to_string(owner.triangle) + " of instance " +
                                                        std::to_string(owner.instance) +
                                                        " owns a pixel with or without occlusion only");
    verification.changed_pixels += changed_pixels;
    if (changed_pixels > 0)
        report.report(verification.changed_pictures, std::to_string(changed_pixels) + " pixels differ with occlusion");
    if (!std::includes(frame.visible_ids.begin(), frame.visible_ids.end(), result.visible_ids.begin(),
                       result.visible_ids.end()))
        report.report(verification.wrong_verdicts, "with occlusion more is visible than without");
    std::uint64_t submitted = 0;
    for (const depth::VisibleCluster& cluster : result.clusters)
        submitted += static_cast<std::uint64_t>(std::popcount(cluster.triangles));
    if (!result.by_depth) submitted = triangles_of(result.visible_ids);
    report.expect("occlusion.triangles_submitted", submitted, result.triangles_submitted);
    report.check_gpu("occlusion.gpu", result.gpu, result.triangles_submitted, result.triangles_clipped,
                     gpu_counts_exactly);
}

}  // namespace crofton::pipeline
