// SPDX-License-Identifier: MIT
// Names of objects and of parts of command buffers, as debuggers (RenderDoc) and the validation layer show them.
#pragma once
#include <volk.h>

#include <cstdint>

namespace crofton::render {

// VK_EXT_debug_utils of one device. If the extension is off, all members are null and every call does nothing.
struct DebugLabels {
    PFN_vkSetDebugUtilsObjectNameEXT set_name = nullptr;
    PFN_vkCmdBeginDebugUtilsLabelEXT begin = nullptr;
    PFN_vkCmdEndDebugUtilsLabelEXT end = nullptr;

    // Names an object; ignores null handles. A call that fails changes nothing and is not reported.
    template <class Handle>
    void name(VkDevice device, VkObjectType type, Handle handle, const char* text) const {
        if (set_name == nullptr || handle == Handle{}) return;
        VkDebugUtilsObjectNameInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT};
        info.objectType = type;
        info.objectHandle = (std::uint64_t)handle;  // a pointer, or a number where pointers have 32 bits
        info.pObjectName = text;
        set_name(device, &info);
    }
};

// Labels all commands that are recorded during the life of this object.
class LabelledCommands {
  public:
    LabelledCommands(const DebugLabels& labels, VkCommandBuffer commands, const char* text)
        : labels_(labels), commands_(commands) {
        if (labels.begin == nullptr || labels.end == nullptr) return;
        VkDebugUtilsLabelEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT};
        info.pLabelName = text;
        labels.begin(commands, &info);
    }
    ~LabelledCommands() {
        if (labels_.begin != nullptr && labels_.end != nullptr) labels_.end(commands_);
    }
    LabelledCommands(const LabelledCommands&) = delete;
    LabelledCommands& operator=(const LabelledCommands&) = delete;

  private:
    const DebugLabels& labels_;
    VkCommandBuffer commands_;
};

}  // namespace crofton::render
