// SPDX-License-Identifier: MIT
#include "verify.hpp"

#include <algorithm>
#include <bit>
#include <crofton/geometry/box.hpp>
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

// Checks instances one by one: of a scene, or of attached regions.
class FrameVerifier : public FrameReport {
  public:
    FrameVerifier(const Drawables& drawables, std::span<const cull::Verdict> verdicts, const FrameStatistics& frame,
                  Verification& verification)
        : FrameReport(frame, verification),
          drawables_(drawables),
          verdicts_(verdicts),
          frustum_(*frustum_of(frame.camera)) {
        const double depth = std::isfinite(frame.camera.far_distance)
                                 ? 0.5 * (frame.camera.near_distance + frame.camera.far_distance)
                                 : 2.0 * frame.camera.near_distance + 1.0;
        interior_ = frame.camera.position + depth * glm::normalize(frame.camera.forward);
    }

    void check_hidden(scene::InstanceId i) {
        if (verdicts_[i] != cull::Verdict::outside)
            report(verification_.wrong_verdicts, "instance " + std::to_string(i) + " is hidden but was listed");
    }

    void check_shown(scene::InstanceId i) {
        const ObjectTruth object = clip_object(i);
        if (object.meets == Truth::yes && verdicts_[i] == cull::Verdict::outside)
            report(verification_.culled_but_visible, "instance " + std::to_string(i) + " is visible but was culled");
        if (verdicts_[i] == cull::Verdict::outside) return;
        ++listed_;
        passed_ += object.passed;
        unclear_passed_ += object.unclear;
        submitted_ += drawables_.mesh(drawables_.mesh_of(i)).triangle_count();
    }

    void check_box(scene::InstanceId i, const Obb& box) { check_bound(i, clip_box(frustum_, box, interior_)); }
    void check_sphere(scene::InstanceId i, const Sphere& sphere) {
        check_bound(i, clip_sphere(frustum_, sphere.center, sphere.radius));
    }

    // Reports a region that meets the frustum and is not attached.
    void check_away(const std::string& name, const Aabb& bounds) {
        if (clip_box(frustum_, obb_of(bounds), interior_).meets == Truth::yes)
            report(verification_.culled_but_visible, name + " meets the frustum but was not attached");
    }

    void check_listed() { expect("visible", listed_, frame_.visible); }

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
        const TriangleMesh& mesh = drawables_.mesh(drawables_.mesh_of(instance));
        const Transform world = drawables_.world_of(instance);
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

    void check_bound(scene::InstanceId instance, const BodyTruth& truth) {
        const cull::Verdict verdict = verdicts_[instance];
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

    const Drawables& drawables_;
    std::span<const cull::Verdict> verdicts_;  // by instance
    Frustum frustum_;
    glm::dvec3 interior_{0.0};
    std::uint64_t listed_ = 0, submitted_ = 0, passed_ = 0, unclear_passed_ = 0;
};

void check_instances(const scene::Scene& scene, const Pipeline& pipeline, bool bounds_decide, FrameVerifier& verifier) {
    const Bounds& bounds = pipeline.bounds();
    for (scene::InstanceId i = 0; i < scene.instance_count(); ++i) {
        if (scene.is_removed(i)) continue;
        if (scene.layer_masks()[i] == 0) {
            verifier.check_hidden(i);
            continue;
        }
        verifier.check_shown(i);
        if (!bounds_decide) continue;
        if (bounds.spheres().empty())
            verifier.check_box(i, bounds.boxes()[i]);
        else
            verifier.check_sphere(i, bounds.spheres()[i]);
    }
}

void check_pairs(const scene::Scene& scene, const Pipeline& pipeline, const FrameStatistics& frame,
                 Verification& verification, FrameVerifier& verifier) {
    const auto movers = pipeline.movers();
    const auto& found = frame.colliding_ids;
    for (std::size_t a = 0; a < movers.size(); ++a)
        for (std::size_t b = a + 1; b < movers.size(); ++b) {
            const std::pair<std::uint32_t, std::uint32_t> pair{movers[a], movers[b]};
            if (scene.is_removed(pair.first) || scene.is_removed(pair.second)) continue;
            const Truth truth = boxes_meet(scene.world_boxes()[pair.first], scene.world_boxes()[pair.second]);
            const bool listed = std::binary_search(found.begin(), found.end(), pair);
            verification.unclear += truth == Truth::unclear;
            if (truth != Truth::unclear && listed != (truth == Truth::yes))
                verifier.report(verification.wrong_pairs,
                                "pair " + std::to_string(pair.first) + ", " + std::to_string(pair.second) +
                                    (listed ? " does not meet but was listed" : " meets but was not listed"));
        }
    if (found.size() != frame.colliding_pairs)
        verifier.report(verification.wrong_pairs, "colliding_pairs is not the number of pairs listed");
}

}  // namespace

void verify_frame(const scene::Scene& scene, const Pipeline& pipeline, const PipelineOptions& options,
                  const FrameStatistics& frame, bool gpu_counts_exactly, Verification& verification) {
    const SceneDrawables drawables(scene);
    FrameVerifier verifier(drawables, pipeline.verdicts(), frame, verification);
    check_instances(scene, pipeline, options.cull != CullMode::none, verifier);
    check_pairs(scene, pipeline, frame, verification, verifier);
    verifier.check_counts(options.count_triangles, gpu_counts_exactly);
    ++verification.frames;
}

void verify_frame(const RegionPipeline& pipeline, const FrameStatistics& frame, bool gpu_counts_exactly,
                  Verification& verification) {
    const RegionStream& stream = pipeline.stream();
    const auto drawables = pipeline.drawables();
    FrameVerifier verifier(*drawables, pipeline.verdicts(), frame, verification);
    std::vector<bool> is_attached(stream.index().size());
    for (const RegionStream::Attached& entry : stream.attached()) {
        is_attached[entry.place] = true;
        const StreamedRegion& region = *entry.region;
        for (std::uint32_t i = 0; i < region.mesh_of.size(); ++i) {
            const scene::InstanceId instance = pipeline.first_of(entry.place) + i;
            if (std::binary_search(region.hidden.begin(), region.hidden.end(), i)) {
                verifier.check_hidden(instance);
                continue;
            }
            verifier.check_shown(instance);
            const auto box = stream.world().box_of(stream.world().object_in(entry.handle, i).value_or(ObjectHandle{}));
            if (box)
                verifier.check_box(instance, *box);
            else
                verifier.report(verification.wrong_verdicts,
                                "instance " + std::to_string(instance) + ": " + box.error().message);
        }
    }
    for (std::uint32_t place = 0; place < is_attached.size(); ++place) {
        const bake::RegionFile& file = stream.index()[place];
        if (!is_attached[place])
            verifier.check_away(file.name, {file.bounds.min + file.origin, file.bounds.max + file.origin});
    }
    verifier.check_listed();
    verifier.check_counts(true, gpu_counts_exactly);
    ++verification.frames;
}

void verify_occlusion(const Drawables& drawables, const BothOwners& owners, std::uint64_t changed_pixels,
                      bool gpu_counts_exactly, const FrameStatistics& frame, Verification& verification) {
    const OccludedFrame& result = *frame.occlusion;
    FrameReport report(frame, verification);
    const auto triangles_of = [&](std::span<const scene::InstanceId> instances) {
        std::uint64_t sum = 0;
        for (const scene::InstanceId i : instances) sum += drawables.mesh(drawables.mesh_of(i)).triangle_count();
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
