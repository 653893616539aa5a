// SPDX-License-Identifier: MIT
// Requests of views, and their results, as Python has them.
#pragma once
#include <crofton/crofton.hpp>
#include <memory>
#include <mutex>
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
};

// The arguments of World.view and of ViewRequest; None: not given.
struct RequestArguments {
    py::handle camera, matrix, volume, layers, occlusion, picture, limits, candidates, order, conservative;

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

}  // namespace crofton::python
