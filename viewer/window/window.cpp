#include "viewer/window/window.hpp"

#include <fmt/core.h>
// After volk.h, so that GLFW declares its Vulkan functions.
#include <GLFW/glfw3.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string>
#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"
#include "gpu/check.hpp"
#include "viewer/window/fixed_keys.hpp"

namespace palpa::viewer {
namespace {

std::string last_fault() {
  const char* fault = nullptr;
  glfwGetError(&fault);
  std::string text = fault ? fault : "no reason given";
  return text.substr(0, text.find('\n'));
}

#ifdef GLFW_PLATFORM
bool given(const char* variable) {
  const char* const value = std::getenv(variable);
  return value != nullptr && *value != '\0';
}
#endif

/// What GTK programs enlarge everything by; 1 if it is not set.
double gdk_scale() {
  const char* const value = std::getenv("GDK_SCALE");
  return value != nullptr && value[0] >= '1' && value[0] <= '4' && value[1] == '\0' ? value[0] - '0' : 1.0;
}

double ratio_of(float content_scale) {
  return std::clamp(std::max(static_cast<double>(content_scale), gdk_scale()), 0.5, 4.0);
}

/// Pixels per point before there is a window.
double scale_at_first() {
  float x = 1, y = 1;
  if (GLFWmonitor* const monitor = glfwGetPrimaryMonitor()) glfwGetMonitorContentScale(monitor, &x, &y);
  return ratio_of(x);
}

/// The size in pixels, reduced to what the first monitor has room for.
struct FirstSize {
  int width = 0, height = 0;
};
FirstSize fitted(double width, double height) {
  int x = 0, y = 0, most_wide = 0, most_high = 0;
  if (GLFWmonitor* const monitor = glfwGetPrimaryMonitor())
    glfwGetMonitorWorkarea(monitor, &x, &y, &most_wide, &most_high);
  const auto limited = [](double length, int most) {
    return static_cast<int>(std::lround(most > 0 ? std::min(length, static_cast<double>(most)) : length));
  };
  return {limited(width, most_wide), limited(height, most_high)};
}

/// Whether a person could take hold of the window there.
bool is_on_a_monitor(const WindowPlace& place) {
  int count = 0;
  GLFWmonitor** const all = glfwGetMonitors(&count);
  const int x = place.x + static_cast<int>(place.width / 2), y = place.y;
  for (int i = 0; i < count; ++i) {
    int left = 0, top = 0, width = 0, height = 0;
    glfwGetMonitorWorkarea(all[i], &left, &top, &width, &height);
    if (x >= left && x < left + width && y >= top && y < top + height) return true;
  }
  return false;
}

/// GLFW 3.4 tries Wayland first, and libwayland complains on stderr if the environment names no compositor. Then only
/// X11 is possible.
bool start_glfw() {
#ifdef GLFW_PLATFORM
  const bool wayland = given("WAYLAND_SOCKET") || (given("WAYLAND_DISPLAY") && given("XDG_RUNTIME_DIR"));
  if (!wayland && glfwPlatformSupported(GLFW_PLATFORM_X11)) glfwInitHint(GLFW_PLATFORM, GLFW_PLATFORM_X11);
#endif
  return glfwInit() == GLFW_TRUE;
}

/// Letters according to the keyboard's layout, digits also from the number pad.
Key key_pressed(int key, int code) {
  if (const std::optional<Key> known = fixed_key(key)) return *known;
  const char* name = glfwGetKeyName(key, code);
  if (name != nullptr && name[0] > 0 && name[1] == '\0') return key_of(name[0]);
  return key >= ' ' && key < 127 ? key_of(static_cast<char>(key >= 'A' && key <= 'Z' ? key + 'a' - 'A' : key))
                                 : Key::other;
}

}  // namespace

struct Window::State {
  using Clock = std::chrono::steady_clock;
  GLFWwindow* window = nullptr;
  std::vector<WindowEvent> events;
  inline static int open = 0;  ///< number of windows

  static void close() {
    if (--open == 0) glfwTerminate();
  }
  void listen();
  /// Takes the time first: it is that of answers in a study.
  void add(WindowEvent event, Clock::time_point now) {
    event.at_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(now.time_since_epoch()).count();
    events.push_back(std::move(event));
  }
  static State& of(GLFWwindow* window) { return *static_cast<State*>(glfwGetWindowUserPointer(window)); }

  /// GLFW counts in screen coordinates; one of them may be several pixels.
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
    const auto held = [&](int left, int right) {
      return glfwGetKey(window, left) == GLFW_PRESS || glfwGetKey(window, right) == GLFW_PRESS;
    };
    event.shift = held(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT);
    event.ctrl = held(GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL);
    return event;
  }
};

Window::Window(const WindowWish& wish, const char* title) : state_(std::make_unique<State>()) {
  if (!start_glfw()) throw Error(Exit::no_device, fmt::format("no display ({}): {}", last_fault(), wish.instead));
  ++State::open;
  const auto refuse = [&](const std::string& fault) {
    State::close();
    return Error(Exit::no_device, fmt::format("{}: {}", fault, wish.instead));
  };
  if (!glfwVulkanSupported()) throw refuse("this display has no Vulkan surfaces");
  glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
  const WindowPlace first = wish.before.value_or(WindowPlace{0, 0, wish.width, wish.height});
  const double points = scale_at_first();
  const auto [width, height] = !wish.before && wish.in_points
                                   ? fitted(first.width * points, first.height * points)
                                   : FirstSize{static_cast<int>(first.width), static_cast<int>(first.height)};
  glfwWindowHint(GLFW_VISIBLE, wish.before ? GLFW_FALSE : GLFW_TRUE);  // it is not seen to move
  state_->window = glfwCreateWindow(width, height, title, nullptr, nullptr);
  glfwDefaultWindowHints();
  if (!state_->window) throw refuse(fmt::format("no window ({})", last_fault()));
  if (wish.before) {
    if (is_on_a_monitor(first)) glfwSetWindowPos(state_->window, first.x, first.y);
    glfwShowWindow(state_->window);
  }
  state_->listen();
}

Window::Window(std::size_t monitor, const char* title, bool pointer) : state_(std::make_unique<State>()) {
  int count = 0;
  GLFWmonitor** const all = glfwGetMonitors(&count);
  if (count < 1) throw failure("there is no monitor for the participant");
  GLFWmonitor* const chosen = all[std::min(monitor, static_cast<std::size_t>(count) - 1)];
  const GLFWvidmode* const mode = glfwGetVideoMode(chosen);
  if (mode == nullptr)
    throw failure(fmt::format("the participant's monitor does not report its size ({})", last_fault()));
  glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
  glfwWindowHint(GLFW_REFRESH_RATE, mode->refreshRate);
  glfwWindowHint(GLFW_AUTO_ICONIFY, GLFW_FALSE);  // it stays while the other window is in use
  state_->window = glfwCreateWindow(mode->width, mode->height, title, chosen, nullptr);
  glfwDefaultWindowHints();
  if (!state_->window) throw failure(fmt::format("no window for the participant ({})", last_fault()));
  ++State::open;
  if (!pointer) glfwSetInputMode(state_->window, GLFW_CURSOR, GLFW_CURSOR_HIDDEN);
  state_->listen();
}

void Window::State::listen() {
  glfwSetWindowUserPointer(window, this);
  glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int button, int action, int mods) {
    const Clock::time_point now = Clock::now();
    State& state = State::of(w);
    WindowEvent event = state.pointer(action == GLFW_PRESS ? WindowEvent::Kind::press : WindowEvent::Kind::release);
    event.button = button == GLFW_MOUSE_BUTTON_LEFT     ? Button::left
                   : button == GLFW_MOUSE_BUTTON_MIDDLE ? Button::middle
                                                        : Button::right;
    event.shift = mods & GLFW_MOD_SHIFT;
    event.ctrl = mods & GLFW_MOD_CONTROL;
    state.add(event, now);
  });
  glfwSetCursorPosCallback(window, [](GLFWwindow* w, double, double) {
    State& state = State::of(w);
    state.events.push_back(state.pointer(WindowEvent::Kind::move));
  });
  glfwSetScrollCallback(window, [](GLFWwindow* w, double, double steps) {
    State& state = State::of(w);
    WindowEvent event = state.pointer(WindowEvent::Kind::scroll);
    event.steps = steps;
    state.events.push_back(event);
  });
  glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int code, int action, int mods) {
    const Clock::time_point now = Clock::now();
    WindowEvent event;
    event.kind = WindowEvent::Kind::key;
    event.key = key_pressed(key, code);
    event.down = action != GLFW_RELEASE;
    event.repeat = action == GLFW_REPEAT;
    event.shift = mods & GLFW_MOD_SHIFT;
    event.ctrl = mods & GLFW_MOD_CONTROL;
    State::of(w).add(event, now);
  });
  glfwSetCharCallback(window, [](GLFWwindow* w, unsigned int code) {
    WindowEvent event;
    event.kind = WindowEvent::Kind::text;
    event.text = utf8(code);
    State::of(w).events.push_back(event);
  });
  glfwSetDropCallback(window, [](GLFWwindow* w, int count, const char** paths) {
    for (int i = 0; i < count; ++i) {
      WindowEvent event;
      event.kind = WindowEvent::Kind::drop;
      event.text = paths[i];
      State::of(w).events.push_back(event);
    }
  });
  glfwSetFramebufferSizeCallback(window, [](GLFWwindow* w, int, int) { State::of(w).events.emplace_back(); });
  glfwSetWindowContentScaleCallback(window, [](GLFWwindow* w, float, float) { State::of(w).events.emplace_back(); });
  glfwSetWindowRefreshCallback(window, [](GLFWwindow* w) { State::of(w).events.emplace_back(); });
}

Window::~Window() {
  glfwDestroyWindow(state_->window);
  State::close();
}

std::vector<std::string> Window::monitors() {
  int count = 0;
  GLFWmonitor** const all = glfwGetMonitors(&count);
  std::vector<std::string> names;
  for (int i = 0; i < count; ++i) {
    const char* const name = glfwGetMonitorName(all[i]);
    const GLFWvidmode* const mode = glfwGetVideoMode(all[i]);
    names.push_back(fmt::format("{} {}x{}", name != nullptr ? name : "?", mode != nullptr ? mode->width : 0,
                                mode != nullptr ? mode->height : 0));
  }
  return names;
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
  return ratio_of(x);
}

void Window::wait(double timeout_s, std::vector<WindowEvent>& events) {
  if (timeout_s < 0) {
    glfwWaitEvents();
  } else if (timeout_s == 0) {
    glfwPollEvents();
  } else {
    glfwWaitEventsTimeout(timeout_s);
  }
  take(events);
}

void Window::take(std::vector<WindowEvent>& events) {
  events.insert(events.end(), state_->events.begin(), state_->events.end());
  state_->events.clear();
}

void Window::wake() {
  glfwPostEmptyEvent();
}

void Window::resize(std::uint32_t width, std::uint32_t height) {
  glfwSetWindowSize(state_->window, static_cast<int>(width), static_cast<int>(height));
}

void Window::move(const WindowPlace& place) {
  glfwSetWindowPos(state_->window, place.x, place.y);
  resize(place.width, place.height);
}

std::optional<WindowPlace> Window::work_area() const {
  int x = 0, y = 0, width = 0, height = 0;
  GLFWmonitor* const monitor = glfwGetPrimaryMonitor();
  if (monitor != nullptr) glfwGetMonitorWorkarea(monitor, &x, &y, &width, &height);
  if (width < 16 || height < 16) return std::nullopt;
  return WindowPlace{x, y, static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
}

void Window::set_title(const std::string& title) {
  glfwSetWindowTitle(state_->window, title.c_str());
}

std::optional<WindowPlace> Window::place() const {
  GLFWwindow* const window = state_->window;
  const bool usual = glfwGetWindowAttrib(window, GLFW_VISIBLE) && !glfwGetWindowAttrib(window, GLFW_ICONIFIED) &&
                     !glfwGetWindowAttrib(window, GLFW_MAXIMIZED);
  int x = 0, y = 0, width = 0, height = 0;
  glfwGetWindowSize(window, &width, &height);
  if (!usual || width < 16 || height < 16) return std::nullopt;
  glfwGetWindowPos(window, &x, &y);
  return WindowPlace{x, y, static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
}

std::string Window::clipboard() const {
  const char* text = glfwGetClipboardString(state_->window);
  return text != nullptr ? text : "";
}

void Window::set_clipboard(const std::string& text) {
  glfwSetClipboardString(state_->window, text.c_str());
}

bool Window::closing() const {
  return glfwWindowShouldClose(state_->window);
}

}  // namespace palpa::viewer
