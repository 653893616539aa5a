// SPDX-License-Identifier: MIT
#include "window.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <array>
#include <cctype>
#include <utility>

namespace crofton::viewer {
namespace {

std::string glfw_reason() {
    const char* description = nullptr;
    glfwGetError(&description);
    return description != nullptr ? description : "unknown reason";
}

std::string key_name(int key, int modifiers) {
    static constexpr std::array<std::pair<int, const char*>, 19> kNamed{{{GLFW_KEY_SPACE, "Space"},
                                                                         {GLFW_KEY_ESCAPE, "Escape"},
                                                                         {GLFW_KEY_ENTER, "Enter"},
                                                                         {GLFW_KEY_TAB, "Tab"},
                                                                         {GLFW_KEY_HOME, "Home"},
                                                                         {GLFW_KEY_LEFT, "Left"},
                                                                         {GLFW_KEY_RIGHT, "Right"},
                                                                         {GLFW_KEY_UP, "Up"},
                                                                         {GLFW_KEY_DOWN, "Down"},
                                                                         {GLFW_KEY_PERIOD, "."},
                                                                         {GLFW_KEY_COMMA, ","},
                                                                         {GLFW_KEY_MINUS, "-"},
                                                                         {GLFW_KEY_EQUAL, "+"},
                                                                         {GLFW_KEY_KP_SUBTRACT, "-"},
                                                                         {GLFW_KEY_KP_ADD, "+"},
                                                                         {GLFW_KEY_LEFT_SHIFT, "Shift"},
                                                                         {GLFW_KEY_RIGHT_SHIFT, "Shift"},
                                                                         {GLFW_KEY_PAGE_UP, "PageUp"},
                                                                         {GLFW_KEY_PAGE_DOWN, "PageDown"}}};
    std::string name;
    for (const auto& [code, text] : kNamed)
        if (code == key) name = text;
    if (key >= GLFW_KEY_F1 && key <= GLFW_KEY_F12) name = "F" + std::to_string(key - GLFW_KEY_F1 + 1);
    if (name.empty() && key >= 32 && key < 127) name = std::string(1, static_cast<char>(std::toupper(key)));
    return (modifiers & GLFW_MOD_CONTROL) != 0 ? "Ctrl+" + name : name;
}

}  // namespace

// GLFW's callbacks, as a friend so that the window's queue stays private.
struct WindowCallbacks {
    static Window& of(GLFWwindow* window) { return *static_cast<Window*>(glfwGetWindowUserPointer(window)); }
    // GLFW speaks in screen coordinates; a picture may have more pixels.
    static glm::dvec2 in_pixels(GLFWwindow* window, double x, double y) {
        int width = 0, height = 0, pixels_x = 0, pixels_y = 0;
        glfwGetWindowSize(window, &width, &height);
        glfwGetFramebufferSize(window, &pixels_x, &pixels_y);
        return {width > 0 ? x * pixels_x / width : x, height > 0 ? y * pixels_y / height : y};
    }
    static void key(GLFWwindow* window, int code, int, int action, int modifiers) {
        if (action == GLFW_REPEAT) return;
        const auto kind = action == GLFW_PRESS ? Event::Kind::key_down : Event::Kind::key_up;
        of(window).events_.push_back({kind, key_name(code, kind == Event::Kind::key_down ? modifiers : 0), 0, {}});
    }
    static void button(GLFWwindow* window, int which, int action, int) {
        const auto kind = action == GLFW_PRESS ? Event::Kind::button_down : Event::Kind::button_up;
        of(window).events_.push_back({kind, {}, which, of(window).cursor_});
    }
    static void cursor(GLFWwindow* window, double x, double y) {
        of(window).cursor_ = in_pixels(window, x, y);
        of(window).events_.push_back({Event::Kind::cursor, {}, 0, of(window).cursor_});
    }
    static void scroll(GLFWwindow* window, double x, double y) {
        of(window).events_.push_back({Event::Kind::scroll, {}, 0, {x, y}});
    }
    static void scale(GLFWwindow* window, float x, float y) {
        of(window).events_.push_back({Event::Kind::scale, {}, 0, {x, y}});
    }
    static void drop(GLFWwindow* window, int count, const char** paths) {
        for (int i = 0; i < count; ++i) of(window).events_.push_back({Event::Kind::drop, paths[i], 0, {}});
    }
};

Result<std::unique_ptr<Window>> Window::create(const std::string& title, int width, int height) {
    glfwInitHint(GLFW_JOYSTICK_HAT_BUTTONS, GLFW_FALSE);
    if (glfwInit() != GLFW_TRUE)
        return fail(ErrorCode::unavailable, kNoItem,
                    "no window can be opened (" + glfw_reason() +
                        "). Without a display: 'crofton view --no-window --after 1 --screenshot FILE', "
                        "'xvfb-run -a crofton view', or 'crofton frames --png DIR'");
    std::unique_ptr<Window> window(new Window());
    if (glfwVulkanSupported() != GLFW_TRUE)
        return fail(ErrorCode::unavailable, kNoItem,
                    "the window system finds no Vulkan driver (Debian: mesa-vulkan-drivers), so nothing can be drawn");
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    window->window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
    if (window->window_ == nullptr)
        return fail(ErrorCode::unavailable, kNoItem, "no window can be opened (" + glfw_reason() + ")");
    glfwSetWindowUserPointer(window->window_, window.get());
    glfwSetKeyCallback(window->window_, WindowCallbacks::key);
    glfwSetMouseButtonCallback(window->window_, WindowCallbacks::button);
    glfwSetCursorPosCallback(window->window_, WindowCallbacks::cursor);
    glfwSetScrollCallback(window->window_, WindowCallbacks::scroll);
    glfwSetDropCallback(window->window_, WindowCallbacks::drop);
    glfwSetWindowContentScaleCallback(window->window_, WindowCallbacks::scale);
    double x = 0.0, y = 0.0;
    glfwGetCursorPos(window->window_, &x, &y);
    window->cursor_ = WindowCallbacks::in_pixels(window->window_, x, y);
    return window;
}

std::vector<std::string> Window::instance_extensions() {
    std::uint32_t count = 0;
    const char** names = glfwGetRequiredInstanceExtensions(&count);
    return names != nullptr ? std::vector<std::string>(names, names + count) : std::vector<std::string>();
}
std::vector<std::string> Window::device_extensions() {
    return {VK_KHR_SWAPCHAIN_EXTENSION_NAME};
}

void Window::poll() {
    glfwPollEvents();
}
std::vector<Event> Window::take_events() {
    return std::exchange(events_, {});
}
bool Window::should_close() const {
    return glfwWindowShouldClose(window_) == GLFW_TRUE;
}
VkExtent2D Window::framebuffer_size() const {
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    if (glfwGetWindowAttrib(window_, GLFW_ICONIFIED) == GLFW_TRUE) return {0, 0};
    return {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
}
void Window::wait_while_minimised() const {
    while (framebuffer_size().width == 0 && !should_close()) glfwWaitEventsTimeout(0.1);
}
float Window::content_scale() const {
    float x = 1.0f, y = 1.0f;
    glfwGetWindowContentScale(window_, &x, &y);
    return x > 0.0f ? x : 1.0f;
}
void Window::set_title(const std::string& title) const {
    glfwSetWindowTitle(window_, title.c_str());
}
void Window::set_size(int width, int height) const {
    glfwSetWindowSize(window_, width, height);
}

}  // namespace crofton::viewer
