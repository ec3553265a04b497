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

template <typename F>
F* XHand::function(const char* name) const {
  return reinterpret_cast<F*>(dlsym(library_, name));
}

XHand::XHand(const std::string& display) {
  library_ = dlopen("libX11.so.6", RTLD_NOW);
  if (!library_) return;
  // The window may just be appearing or disappearing: libX11 itself would end the program. The result is then empty.
  function<void*(int (*)(void*, void*))>("XSetErrorHandler")([](void*, void*) { return 0; });
  display_ = function<void*(const char*)>("XOpenDisplay")(display.c_str());
}

XHand::~XHand() {
  if (display_) function<int(void*)>("XCloseDisplay")(display_);
}

std::vector<unsigned long> XHand::windows() const {
  const auto root = function<unsigned long(void*)>("XDefaultRootWindow")(display_);
  unsigned long ignored_root = 0, parent = 0, *children = nullptr;
  unsigned count = 0;
  function<int(void*, unsigned long, unsigned long*, unsigned long*, unsigned long**, unsigned*)>("XQueryTree")(
      display_, root, &ignored_root, &parent, &children, &count);
  std::vector<unsigned long> all(children, children + count);
  if (children) function<int(void*)>("XFree")(children);
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
      if (function<int(void*, unsigned long, char**)>("XFetchName")(display_, window, &name) && name) {
        if (title == name || std::string_view(name).starts_with(title + ": ")) window_ = window;
        function<int(void*)>("XFree")(name);
      }
    }
    if (window_) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  } while (Clock::now() < end);
  return false;
}

void XHand::resize(unsigned width, unsigned height) {
  function<int(void*, unsigned long, unsigned, unsigned)>("XResizeWindow")(display_, window_, width, height);
  function<int(void*, int)>("XSync")(display_, 0);
}

void XHand::press(const char* key) {
  const auto symbol = function<unsigned long(const char*)>("XStringToKeysym")(key);
  XEvent event;
  std::memset(&event, 0, sizeof event);
  event.key.window = window_;
  event.key.root = function<unsigned long(void*)>("XDefaultRootWindow")(display_);
  event.key.keycode = function<unsigned char(void*, unsigned long)>("XKeysymToKeycode")(display_, symbol);
  event.key.same_screen = 1;
  for (const int type : {key_press, key_release}) {
    event.key.type = type;
    event.key.time = time_ += 100;  // two events at one time would count as one
    function<int(void*, unsigned long, int, long, XEvent*)>("XSendEvent")(display_, window_, 0, 0, &event);
  }
  function<int(void*, int)>("XSync")(display_, 0);
}

void XHand::damage() {
  function<int(void*, unsigned long, int, int, unsigned, unsigned, int)>("XClearArea")(display_, window_, 0, 0, 0, 0,
                                                                                       1);
  function<int(void*, int)>("XSync")(display_, 0);
}

XHand::Picture XHand::picture() const {
  Picture out;
  unsigned long root = 0;
  int x = 0, y = 0;
  unsigned width = 0, height = 0, border = 0, depth = 0;
  if (!function<int(void*, unsigned long, unsigned long*, int*, int*, unsigned*, unsigned*, unsigned*, unsigned*)>(
          "XGetGeometry")(display_, window_, &root, &x, &y, &width, &height, &border, &depth))
    return out;
  auto* const image =
      static_cast<Image*>(function<void*(void*, unsigned long, int, int, unsigned, unsigned, unsigned long, int)>(
          "XGetImage")(display_, window_, 0, 0, width, height, ~0ul, pixmaps));
  if (!image || image->bits_per_pixel != 32) return out;
  out.width = width;
  out.pixels.resize(std::size_t{width} * height);
  for (unsigned row = 0; row < height; ++row)
    std::memcpy(out.pixels.data() + std::size_t{row} * width,
                image->data + std::size_t{row} * static_cast<unsigned>(image->bytes_per_line), std::size_t{4} * width);
  for (std::uint32_t& pixel : out.pixels)
    pixel &= 0xffffff;
  function<int(void*)>("XFree")(image->data);
  function<int(void*)>("XFree")(image);
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

void XHand::iconify() {
  function<int(void*, unsigned long)>("XUnmapWindow")(display_, window_);
  function<int(void*, int)>("XSync")(display_, 0);
}

void XHand::restore() {
  function<int(void*, unsigned long)>("XMapWindow")(display_, window_);
  function<int(void*, int)>("XSync")(display_, 0);
}

void XHand::close() {
  const auto atom = function<unsigned long(void*, const char*, int)>("XInternAtom");
  XEvent event;
  std::memset(&event, 0, sizeof event);
  event.client.type = client_message;
  event.client.window = window_;
  event.client.message_type = atom(display_, "WM_PROTOCOLS", 0);
  event.client.format = 32;
  event.client.data[0] = static_cast<long>(atom(display_, "WM_DELETE_WINDOW", 0));
  function<int(void*, unsigned long, int, long, XEvent*)>("XSendEvent")(display_, window_, 0, 0, &event);
  function<int(void*, int)>("XSync")(display_, 0);
}

}  // namespace palpa::test
