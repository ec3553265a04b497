#include "x_display.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <string_view>
#include <thread>

namespace palpa::test {
namespace {

using Clock = std::chrono::steady_clock;

/// The layout of libX11's ClientMessage event, inside its 24 longs.
struct ClientMessage {
  int type;
  unsigned long serial;
  int send_event;
  void* display;
  unsigned long window;
  unsigned long message_type;
  int format;
  long data[5];
};
/// The layout of its KeyPress and KeyRelease.
struct KeyEvent {
  int type;
  unsigned long serial;
  int send_event;
  void* display;
  unsigned long window, root, subwindow, time;
  int x, y, x_root, y_root;
  unsigned state, keycode;
  int same_screen;
};
/// The beginning of its XImage.
struct Image {
  int width, height, xoffset, format;
  char* data;
  int byte_order, bitmap_unit, bitmap_bit_order, bitmap_pad, depth, bytes_per_line, bits_per_pixel;
};
union XEvent {
  ClientMessage client;
  KeyEvent key;
  long pad[24];
};
constexpr int key_press = 2, key_release = 3, client_message = 33;
constexpr int pixmaps = 2;  // XGetImage: whole pixels

}  // namespace

XServer::XServer() {
  int ready[2];
  if (pipe(ready) != 0) return;
  const std::string descriptor = std::to_string(ready[1]);
  const int nothing = open("/dev/null", O_WRONLY | O_CLOEXEC);
  process_ = fork();
  if (process_ == 0) {
    close(ready[0]);
    // It must not live longer than the test, and must not hold up a program that reads the test's output.
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    dup2(nothing, STDOUT_FILENO);
    dup2(nothing, STDERR_FILENO);
    execlp("Xvfb", "Xvfb", "-displayfd", descriptor.c_str(), "-screen", "0", "1280x720x24", "-nolisten", "tcp",
           nullptr);
    _exit(127);
  }
  close(nothing);
  close(ready[1]);
  // Writes its number and a newline once it accepts clients.
  std::string number;
  pollfd wait{ready[0], POLLIN, 0};
  char c = 0;
  while (poll(&wait, 1, 20'000) > 0 && read(ready[0], &c, 1) == 1 && c != '\n')
    number += c;
  close(ready[0]);
  if (!number.empty()) name_ = ":" + number;
}

XServer::~XServer() {
  if (process_ <= 0) return;
  ::kill(process_, SIGTERM);
  waitpid(process_, nullptr, 0);
}

void XServer::kill() {
  if (process_ <= 0) return;
  ::kill(process_, SIGKILL);
  waitpid(process_, nullptr, 0);
  process_ = -1;
}

template <typename Result, typename... Arguments>
Result XHand::call(const char* name, Arguments... arguments) const {
  return reinterpret_cast<Result (*)(Arguments...)>(dlsym(library_, name))(arguments...);
}

XHand::XHand(const std::string& display) {
  library_ = dlopen("libX11.so.6", RTLD_NOW);
  if (!library_) return;
  // The window may just be appearing or disappearing: libX11 itself would end the program. The result is then empty.
  using Handler = int (*)(void*, void*);
  call<void*, Handler>("XSetErrorHandler", [](void*, void*) { return 0; });
  display_ = call<void*>("XOpenDisplay", display.c_str());
}

XHand::~XHand() {
  if (display_) call("XCloseDisplay", display_);
}

std::vector<unsigned long> XHand::windows() const {
  unsigned long root = 0, parent = 0, *children = nullptr;
  unsigned count = 0;
  call("XQueryTree", display_, call<unsigned long>("XDefaultRootWindow", display_), &root, &parent, &children, &count);
  std::vector<unsigned long> all(children, children + count);
  if (children) call("XFree", children);
  return all;
}

bool XHand::there() const {
  const std::vector<unsigned long> all = windows();
  return std::find(all.begin(), all.end(), window_) != all.end();
}

bool XHand::find(const std::string& title, double timeout_s) {
  const auto end = Clock::now() + std::chrono::duration<double>(timeout_s);
  do {
    for (const unsigned long window : windows()) {
      char* name = nullptr;
      if (!call("XFetchName", display_, window, &name) || !name) continue;
      if (title == name || std::string_view(name).starts_with(title + ": ")) window_ = window;
      call("XFree", name);
    }
    if (window_) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  } while (Clock::now() < end);
  return false;
}

void XHand::resize(unsigned width, unsigned height) {
  call("XResizeWindow", display_, window_, width, height);
  call("XSync", display_, 0);
}

void XHand::press(const char* key) {
  XEvent event;
  std::memset(&event, 0, sizeof event);
  event.key.window = window_;
  event.key.root = call<unsigned long>("XDefaultRootWindow", display_);
  event.key.keycode = call<unsigned char>("XKeysymToKeycode", display_, call<unsigned long>("XStringToKeysym", key));
  event.key.same_screen = 1;
  for (const int type : {key_press, key_release}) {
    event.key.type = type;
    event.key.time = time_ += 100;  // two events at one time would count as one
    call("XSendEvent", display_, window_, 0, 0L, &event);
  }
  call("XSync", display_, 0);
}

void XHand::damage() {
  call("XClearArea", display_, window_, 0, 0, 0U, 0U, 1);
  call("XSync", display_, 0);
}

XHand::Picture XHand::picture() const {
  Picture out;
  unsigned long root = 0;
  int x = 0, y = 0;
  unsigned width = 0, height = 0, border = 0, depth = 0;
  if (!call("XGetGeometry", display_, window_, &root, &x, &y, &width, &height, &border, &depth)) return out;
  auto* const image =
      static_cast<Image*>(call<void*>("XGetImage", display_, window_, 0, 0, width, height, ~0ul, pixmaps));
  if (!image || image->bits_per_pixel != 32) return out;
  out.width = width;
  out.pixels.resize(std::size_t{width} * height);
  for (unsigned row = 0; row < height; ++row)
    std::memcpy(out.pixels.data() + std::size_t{row} * width,
                image->data + std::size_t{row} * static_cast<unsigned>(image->bytes_per_line), std::size_t{4} * width);
  for (std::uint32_t& pixel : out.pixels)
    pixel &= 0xffffff;
  call("XFree", image->data);
  call("XFree", image);
  return out;
}

std::size_t XHand::Picture::colours() const {
  std::vector<char> seen(std::size_t{1} << 24);
  std::size_t count = 0;
  for (const std::uint32_t pixel : pixels) {
    count += seen[pixel] == 0 ? 1 : 0;
    seen[pixel] = 1;
  }
  return count;
}

bool XHand::Picture::has_red() const {
  const auto red = [](std::uint32_t pixel) {
    const std::uint32_t others = std::max(pixel >> 8U & 0xffU, pixel & 0xffU);
    return pixel >> 16U > others + 100;
  };
  return std::ranges::count_if(pixels, red) > 200;
}

void XHand::iconify() {
  call("XUnmapWindow", display_, window_);
  call("XSync", display_, 0);
}

void XHand::restore() {
  call("XMapWindow", display_, window_);
  call("XSync", display_, 0);
}

void XHand::close() {
  XEvent event;
  std::memset(&event, 0, sizeof event);
  event.client.type = client_message;
  event.client.window = window_;
  event.client.message_type = call<unsigned long>("XInternAtom", display_, "WM_PROTOCOLS", 0);
  event.client.format = 32;
  event.client.data[0] = call<long>("XInternAtom", display_, "WM_DELETE_WINDOW", 0);
  call("XSendEvent", display_, window_, 0, 0L, &event);
  call("XSync", display_, 0);
}

}  // namespace palpa::test
