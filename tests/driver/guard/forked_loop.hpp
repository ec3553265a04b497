// A loop in a separate process, which a test may stop, continue and kill.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <functional>

#include "base/log.hpp"

namespace palpa::test {

class ForkedLoop {
 public:
  /// `loop` runs until the process is killed, and prints nothing.
  explicit ForkedLoop(const std::function<void()>& loop) : id_(fork()) {
    if (id_ != 0) return;
    log::set_level(log::Level::quiet);
    try {
      loop();
    } catch (...) {  // otherwise, this process would go on with the tests that follow
    }
    _exit(1);
  }
  ~ForkedLoop() { end(SIGKILL); }
  ForkedLoop(const ForkedLoop&) = delete;
  ForkedLoop& operator=(const ForkedLoop&) = delete;
  void signal(int which) const { kill(id_, which); }
  /// Whether it has ended by itself.
  bool ended() {
    if (id_ > 0 && waitpid(id_, nullptr, WNOHANG) == id_) id_ = -1;
    return id_ <= 0;
  }
  void end(int by) {
    if (id_ <= 0) return;
    kill(id_, by);
    waitpid(id_, nullptr, 0);
    id_ = -1;
  }

 private:
  pid_t id_;
};

}  // namespace palpa::test
