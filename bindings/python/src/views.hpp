// SPDX-License-Identifier: MIT
// Requests of views, and their results, as Python has them.
#pragma once
#include <crofton/crofton.hpp>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "convert.hpp"

namespace crofton::python {

// Draw limits with the arrays that they look at.
struct HeldLimits {
    cull::DrawLimits limits;
    std::vector<float> layer_distances, item_distances;
    std::vector<std::uint64_t> drawn_before;
};

// A request with what it points to.
struct HeldRequest {
    ViewRequest request;
    std::shared_ptr<const HeldLimits> limits;
    std::vector<std::uint64_t> candidates;
    py::object seen;  // by the camera, for the view of a light
};

// The receivers of a light's view: the camera's ViewResult, and the radius of lookups.
struct HeldReceivers {
    py::object seen;
    float radius = 1.0f;
};

// The arguments of World.view and of ViewRequest; None: not given.
struct RequestArguments {
    py::handle camera, matrix, volume, layers, occlusion, picture, receivers, limits, candidates, order, conservative;

    // The first that is given besides the camera, or nullptr.
    [[nodiscard]] const char* first_given() const;
};
// Raises TypeError for what is of another type, Error for numbers out of range. The spans lead into `result`.
void read_request(const RequestArguments& given, HeldRequest& result);

// An answer and what must be looked up in the World at once. Its memory is used again by later views.
template <class Result>
struct Answer {
    Result found;
    std::vector<ObjectRef> objects;
    std::vector<std::uint32_t> view_masks;  // of many views
};

// Answers that nobody has any more.
template <class Result>
class AnswerPool {
  public:
    [[nodiscard]] std::unique_ptr<Answer<Result>> take() {
        {
            const std::lock_guard lock(mutex_);
            if (!free_.empty()) {
                auto answer = std::move(free_.back());
                free_.pop_back();
                return answer;
            }
        }
        return std::make_unique<Answer<Result>>();
    }
    void give_back(std::unique_ptr<Answer<Result>> answer) {
        const std::lock_guard lock(mutex_);
        if (free_.size() < kMost) free_.push_back(std::move(answer));
    }

  private:
    static constexpr std::size_t kMost = 4;
    std::mutex mutex_;
    std::vector<std::unique_ptr<Answer<Result>>> free_;
};

struct AnswerPools {
    AnswerPool<ViewResult> one;
    AnswerPool<MultiViewResult> many;
};

// What a view saw, or several. The handles and user numbers were looked up with it, so that the World may change
// afterwards; arrays are made when they are asked for, and keep this alive.
template <class Result>
class Seen {
  public:
    explicit Seen(std::shared_ptr<AnswerPools> pools, AnswerPool<Result>& pool)
        : pools_(std::move(pools)), pool_(&pool), answer_(pool.take()) {}
    Seen(Seen&&) noexcept = default;
    Seen& operator=(Seen&&) = delete;
    ~Seen() {
        if (answer_) pool_->give_back(std::move(answer_));
    }
    [[nodiscard]] Answer<Result>& answer() { return *answer_; }
    [[nodiscard]] const Answer<Result>& answer() const { return *answer_; }
    [[nodiscard]] const Result& found() const { return answer_->found; }

    // While the World is locked.
    void look_up() {
        answer_->objects.clear();
        for (std::size_t i = 0; i < found().size(); ++i) answer_->objects.push_back(found()[i]);
    }

  private:
    std::shared_ptr<AnswerPools> pools_;
    AnswerPool<Result>* pool_;
    std::unique_ptr<Answer<Result>> answer_;
};
using SeenByOne = Seen<ViewResult>;
using SeenByMany = Seen<MultiViewResult>;

}  // namespace crofton::python
