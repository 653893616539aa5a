// SPDX-License-Identifier: MIT
// Crofton behind an OpenSceneGraph group of many children: the cull traversal enters only those that the view sees.
#pragma once
#include <osg/Group>
#include <osg/NodeCallback>

#include <crofton/crofton.hpp>
#include <vector>

namespace crofton::osg_adapter {

// Set it as the cull callback of one group. Children are taken as they are at construction; call child_moved when one's
// transform or shape has changed.
class CullCallback final : public osg::NodeCallback {
  public:
    explicit CullCallback(osg::Group& group);

    void child_moved(unsigned child);
    void operator()(osg::Node* node, osg::NodeVisitor* visitor) override;

    [[nodiscard]] double last_cull_microseconds() const { return last_cull_microseconds_; }

  private:
    void update_world(unsigned frame);

    World world_{{.pairs = false}};
    ViewResult visible_;
    std::vector<ObjectHandle> objects_;  // by child
    bool world_changed_ = true;          // since its last update
    unsigned updated_frame_ = 0;
    osg::Group& group_;
    double last_cull_microseconds_ = 0.0;
};

}  // namespace crofton::osg_adapter
