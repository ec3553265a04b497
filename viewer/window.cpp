#include "viewer/window.hpp"

#include <fmt/core.h>
// After volk.h, so that GLFW declares its Vulkan functions.
#include <GLFW/glfw3.h>

#include <algorithm>
#include <string>

#include "base/error.hpp"
#include "gpu/check.hpp"

namespace palpa::viewer {
namespace {

constexpr const char* advice = "use --headless --screenshot FILE.png";

std::string last_fault() {
  const char* fault = nullptr;
  glfwGetError(&fault);
  std::string text = fault ? fault : "no reason given";
  return text.substr(0, text.find('\n'));
}

Key key_of(int key) {
  switch (key) {
    case GLFW_KEY_1:
    case GLFW_KEY_KP_1:
      return Key::one;
    case GLFW_KEY_3:
    case GLFW_KEY_KP_3:
      return Key::three;
    case GLFW_KEY_5:
    case GLFW_KEY_KP_5:
      return Key::five;
    case GLFW_KEY_7:
    case GLFW_KEY_KP_7:
      return Key::seven;
    case GLFW_KEY_F:
      return Key::frame;
    case GLFW_KEY_SPACE:
      return Key::space;
    case GLFW_KEY_Q:
    case GLFW_KEY_ESCAPE:
      return Key::quit;
    default:
      return Key::other;
  }
}

}  // namespace

struct Window::State {
  GLFWwindow* window = nullptr;
  std::vector<WindowEvent> events;

  static State& of(GLFWwindow* window) { return *static_cast<State*>(glfwGetWindowUserPointer(window)); }

  /// GLFW counts in screen coordinates, of which one may be several pixels.
  WindowEvent pointer(WindowEvent::Kind kind) const {
    int width = 0, height = 0, pixels_x = 0, pixels_y = 0;
    glfwGetWindowSize(window, &width, &height);
    glfwGetFramebufferSize(window, &pixels_x, &pixels_y);
    WindowEvent event;
    event.kind = kind;
    glfwGetCursorPos(window, &event.x, &event.y);
    if (width > 0 && height > 0) {
      event.x *= static_cast<double>(pixels_x) / width;
      event.y *= static_cast<double>(pixels_y) / height;
    }
    return event;
  }
};

Window::Window(std::uint32_t width, std::uint32_t height, const char* title) : state_(std::make_unique<State>()) {
  if (!glfwInit()) throw Error(Exit::no_device, fmt::format("no display ({}): {}", last_fault(), advice));
  const auto refuse = [](const std::string& fault) {
    glfwTerminate();
    return Error(Exit::no_device, fmt::format("{}: {}", fault, advice));
  };
  if (!glfwVulkanSupported()) throw refuse("this display has no Vulkan surfaces");
  glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
  state_->window = glfwCreateWindow(static_cast<int>(width), static_cast<int>(height), title, nullptr, nullptr);
  if (!state_->window) throw refuse(fmt::format("no window ({})", last_fault()));

  GLFWwindow* window = state_->window;
  glfwSetWindowUserPointer(window, state_.get());
  glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int button, int action, int mods) {
    State& state = State::of(w);
    WindowEvent event = state.pointer(action == GLFW_PRESS ? WindowEvent::Kind::press : WindowEvent::Kind::release);
    event.button = button == GLFW_MOUSE_BUTTON_LEFT     ? Button::left
                   : button == GLFW_MOUSE_BUTTON_MIDDLE ? Button::middle
                                                        : Button::right;
    event.shift = mods & GLFW_MOD_SHIFT;
    state.events.push_back(event);
  });
  glfwSetCursorPosCallback(window, [](GLFWwindow* w, double, double) {
    State& state = State::of(w);
    state.events.push_back(state.pointer(WindowEvent::Kind::move));
  });
  glfwSetScrollCallback(window, [](GLFWwindow* w, double, double steps) {
    WindowEvent event;
    event.kind = WindowEvent::Kind::scroll;
    event.y = steps;
    State::of(w).events.push_back(event);
  });
  glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int) {
    if (action == GLFW_RELEASE) return;
    WindowEvent event;
    event.kind = WindowEvent::Kind::key;
    event.key = key_of(key);
    State::of(w).events.push_back(event);
  });
  glfwSetFramebufferSizeCallback(window, [](GLFWwindow* w, int, int) { State::of(w).events.emplace_back(); });
  glfwSetWindowRefreshCallback(window, [](GLFWwindow* w) { State::of(w).events.emplace_back(); });
}

Window::~Window() {
  glfwDestroyWindow(state_->window);
  glfwTerminate();
}

std::vector<const char*> Window::extensions() const {
  std::uint32_t count = 0;
  const char** names = glfwGetRequiredInstanceExtensions(&count);
  return {names, names + count};
}

VkSurfaceKHR Window::make_surface(VkInstance instance) const {
  VkSurfaceKHR surface = VK_NULL_HANDLE;
  PALPA_VK(glfwCreateWindowSurface(instance, state_->window, nullptr, &surface));
  return surface;
}

VkExtent2D Window::size() const {
  int width = 0, height = 0;
  glfwGetFramebufferSize(state_->window, &width, &height);
  if (glfwGetWindowAttrib(state_->window, GLFW_ICONIFIED)) return {0, 0};
  return {static_cast<std::uint32_t>(std::max(width, 0)), static_cast<std::uint32_t>(std::max(height, 0))};
}

double Window::pixel_ratio() const {
  float x = 1, y = 1;
  glfwGetWindowContentScale(state_->window, &x, &y);
  return std::clamp(static_cast<double>(x), 0.5, 4.0);
}

void Window::wait(double timeout_s, std::vector<WindowEvent>& events) {
  if (timeout_s < 0) {
    glfwWaitEvents();
  } else if (timeout_s == 0) {
    glfwPollEvents();
  } else {
    glfwWaitEventsTimeout(timeout_s);
  }
  events.insert(events.end(), state_->events.begin(), state_->events.end());
  state_->events.clear();
}

bool Window::closing() const {
  return glfwWindowShouldClose(state_->window);
}

}  // namespace palpa::viewer
