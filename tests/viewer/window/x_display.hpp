// A private X server for the window's tests, and a hand that moves its windows. libX11 is loaded at run time, so that
// nothing is needed to build the tests.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

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
  /// Whether it is still there.
  bool there() const;
  /// A key by its X name: "v", "Next", "Escape".
  void press(const char* key);
  struct Picture {
    unsigned width = 0;
    std::vector<std::uint32_t> pixels;  ///< 0xrrggbb, rows from the top
    std::size_t colours() const;        ///< how many different ones
    bool operator==(const Picture&) const = default;
  };
  /// What it shows; empty where it is not visible.
  Picture picture() const;
  /// Wipes away what it shows and tells it so, as when another window was in its way.
  void damage();
  void resize(unsigned width, unsigned height);
  void iconify();
  void restore();
  /// As a window manager does when the user clicks its cross.
  void close();

 private:
  template <typename F>
  F* function(const char* name) const;

  std::vector<unsigned long> windows() const;

  void* library_ = nullptr;
  void* display_ = nullptr;
  unsigned long window_ = 0, time_ = 0;
};

}  // namespace palpa::test
