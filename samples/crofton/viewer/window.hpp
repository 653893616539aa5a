// SPDX-License-Identifier: MIT
// A window, its events, and the way a finished picture gets onto it.
#pragma once
#include <crofton/render/resources.hpp>
#include <glm/vec2.hpp>
#include <memory>
#include <string>
#include <vector>

struct GLFWwindow;

namespace crofton::viewer {

// An action of the user, by hand or by script. Keys are named "A", "1", "F5", "Space"; modifiers are prefixes:
// "Ctrl+S".
struct Event {
    enum class Kind { key_down, key_up, button_down, button_up, cursor, scroll, drop, scale } kind = Kind::key_down;
    std::string text;    // the key's name, or a dropped file
    int button = 0;      // 0 left, 1 right, 2 middle
    glm::dvec2 at{0.0};  // cursor in pixels of the picture, the wheel's steps, or the display's scale
};

class Window {
  public:
    // Starts the window system. Errors: unavailable – there is no display; says how to run without one.
    [[nodiscard]] static Result<std::unique_ptr<Window>> create(const std::string& title, int width, int height);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    // Returns the Vulkan extensions that attach() needs.
    [[nodiscard]] static std::vector<std::string> instance_extensions();
    [[nodiscard]] static std::vector<std::string> device_extensions();
    // Makes surface and swapchain. Errors: the device cannot present here; Vulkan's. The context must outlive the
    // window.
    [[nodiscard]] Result<void> attach(const render::VulkanContext& context);
    // Undoes attach(), before its device goes; another may follow.
    void detach();

    // Processes what the window system has to say; events gather until taken.
    void poll();
    [[nodiscard]] std::vector<Event> take_events();
    [[nodiscard]] bool should_close() const;
    [[nodiscard]] VkExtent2D framebuffer_size() const;  // 0 × 0 while minimised
    void wait_while_minimised() const;
    [[nodiscard]] float content_scale() const;  // how much larger texts should be (HiDPI)
    void set_title(const std::string& title) const;
    void set_size(int width, int height) const;
    [[nodiscard]] GLFWwindow* handle() const { return window_; }

    // Shows a picture that is in SHADER_READ_ONLY_OPTIMAL, scaled to the window; remakes the swapchain where it no
    // longer fits. Errors: unavailable when the device or the surface is lost.
    [[nodiscard]] Result<void> present(VkImage picture, VkExtent2D size);

  private:
    Window() = default;
    friend struct WindowCallbacks;
    [[nodiscard]] Result<void> create_swapchain();
    void record_copy(VkCommandBuffer commands, VkImage picture, VkExtent2D size, VkImage onto) const;

    GLFWwindow* window_ = nullptr;
    std::vector<Event> events_;
    glm::dvec2 cursor_{0.0};  // where the last event saw it: by now it may be elsewhere
    const render::VulkanContext* context_ = nullptr;
    VkSurfaceKHR surface_ = VK_NULL_HANDLE;
    VkSwapchainKHR swapchain_ = VK_NULL_HANDLE;
    std::vector<VkImage> images_;
    VkExtent2D extent_{};
    VkFormat format_ = VK_FORMAT_UNDEFINED;
    render::Commands commands_;
    VkSemaphore acquired_ = VK_NULL_HANDLE, copied_ = VK_NULL_HANDLE;
};

}  // namespace crofton::viewer
