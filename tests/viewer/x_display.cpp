#include "x_display.hpp"

#include <dlfcn.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <thread>

namespace palpa::test {
namespace {

using Clock = std::chrono::steady_clock;

/// What libX11 calls a ClientMessage event, inside its 24 longs.
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
union XEvent {
  ClientMessage client;
  long pad[24];
};
constexpr int client_message = 33;

}  // namespace

XServer::XServer() {
  int ready[2];
  if (pipe(ready) != 0) return;
  process_ = fork();
  if (process_ == 0) {
    close(ready[0]);
    const std::string descriptor = std::to_string(ready[1]);
    freopen("/dev/null", "w", stderr);
    execlp("Xvfb", "Xvfb", "-displayfd", descriptor.c_str(), "-screen", "0", "1280x720x24", "-nolisten", "tcp",
           nullptr);
    _exit(127);
  }
  close(ready[1]);
  // Writes its number and a newline once it takes clients.
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
  if (library_) display_ = function<void*(const char*)>("XOpenDisplay")(display.c_str());
}

XHand::~XHand() {
  if (display_) function<int(void*)>("XCloseDisplay")(display_);
}

bool XHand::find(const std::string& title, double timeout_s) {
  const auto end = Clock::now() + std::chrono::duration<double>(timeout_s);
  const auto root = function<unsigned long(void*)>("XDefaultRootWindow")(display_);
  do {
    unsigned long ignored_root = 0, parent = 0, *children = nullptr;
    unsigned count = 0;
    function<int(void*, unsigned long, unsigned long*, unsigned long*, unsigned long**, unsigned*)>("XQueryTree")(
        display_, root, &ignored_root, &parent, &children, &count);
    for (unsigned i = 0; i < count; ++i) {
      char* name = nullptr;
      if (function<int(void*, unsigned long, char**)>("XFetchName")(display_, children[i], &name) && name) {
        if (title == name) window_ = children[i];
        function<int(void*)>("XFree")(name);
      }
    }
    if (children) function<int(void*)>("XFree")(children);
    if (window_) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  } while (Clock::now() < end);
  return false;
}

void XHand::resize(unsigned width, unsigned height) {
  function<int(void*, unsigned long, unsigned, unsigned)>("XResizeWindow")(display_, window_, width, height);
  function<int(void*, int)>("XSync")(display_, 0);
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
