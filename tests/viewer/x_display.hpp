// A private X server for the window's tests, and a hand that moves its windows. libX11 is loaded at run time, so that
// nothing is needed to build the tests.
#pragma once

#include <sys/types.h>

#include <string>

namespace palpa::test {

/// An Xvfb of its own, ended with the object. `name()` is empty where Xvfb is not installed or does not start.
class XServer {
 public:
  XServer();
  ~XServer();
  XServer(const XServer&) = delete;
  XServer& operator=(const XServer&) = delete;
  const std::string& name() const { return name_; }
  /// Ends it at once, as when it crashes.
  void kill();

 private:
  pid_t process_ = -1;
  std::string name_;
};

/// A client of the server beside the one under test.
class XHand {
 public:
  explicit XHand(const std::string& display);
  ~XHand();
  XHand(const XHand&) = delete;
  XHand& operator=(const XHand&) = delete;

  bool connected() const { return display_ != nullptr; }
  /// Waits up to `timeout_s` for a window with that title.
  bool find(const std::string& title, double timeout_s);
  void resize(unsigned width, unsigned height);
  void iconify();
  void restore();
  /// As a window manager does when the user clicks its cross.
  void close();

 private:
  template <typename F>
  F* function(const char* name) const;

  void* library_ = nullptr;
  void* display_ = nullptr;
  unsigned long window_ = 0;
};

}  // namespace palpa::test
