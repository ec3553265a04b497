// A private X server for the window's tests, and a client that controls its windows. libX11 is loaded at run time, so
// that building the tests needs nothing.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace palpa::test {

/// A separate Xvfb, which ends with the object. `name()` is empty if Xvfb is not installed or does not start.
class XServer {
 public:
  XServer();
  ~XServer();
  XServer(const XServer&) = delete;
  XServer& operator=(const XServer&) = delete;
  const std::string& name() const { return name_; }
  /// Ends it at once, like a crash.
  void kill();

 private:
  pid_t process_ = -1;
  std::string name_;
};

/// A client of the server in addition to the one under test.
class XHand {
 public:
  explicit XHand(const std::string& display);
  ~XHand();
  XHand(const XHand&) = delete;
  XHand& operator=(const XHand&) = delete;

  bool connected() const { return display_ != nullptr; }
  /// Waits up to `timeout_s` for a window with that title, or with that title and a colon and what is shown.
  bool find(const std::string& title, double timeout_s);
  /// Whether the window still exists.
  bool there() const;
  /// Presses a key, by its X name: "v", "Next", "Escape".
  void press(const char* key);
  struct Picture {
    unsigned width = 0;
    std::vector<std::uint32_t> pixels;  ///< 0xrrggbb, rows from the top
    std::size_t colours() const;        ///< the number of different colours
    bool has_red() const;               ///< of some area
    bool operator==(const Picture&) const = default;
  };
  /// The window's picture; empty if it is not visible.
  Picture picture() const;
  /// Clears the window's content and notifies it, as if another window had covered it.
  void damage();
  void resize(unsigned width, unsigned height);
  void iconify();
  void restore();
  /// Does what a window manager does when the user clicks the close button.
  void close();

 private:
  /// Calls the function of libX11 with that name. The arguments have its types.
  template <typename Result = int, typename... Arguments>
  Result call(const char* name, Arguments... arguments) const;
  std::vector<unsigned long> windows() const;

  void* library_ = nullptr;
  void* display_ = nullptr;
  unsigned long window_ = 0, time_ = 0;
};

}  // namespace palpa::test
