// The threads that draw: the one that asks for pictures, and those of its driver. They give way to the threads of a
// live run.
#pragma once

#include <vector>

#include "session/threads.hpp"

namespace palpa::viewer {

/// Use it only on the thread that asks for pictures.
class DrawingThreads {
 public:
  /// Threads that begin between here and have_begun() draw: a device is made in between.
  void expect() { others_ = session::threads_since(); }
  void have_begun() {
    if (!gives_way_) driver_ = session::threads_since(others_);
  }
  /// Call once there is a live run, or will be one. Threads that this thread begins later give way by themselves.
  void give_way() {
    gives_way_ = true;
    session::give_way();
    for (const int thread : driver_)
      session::give_way(thread);
  }

 private:
  std::vector<int> others_, driver_;
  bool gives_way_ = false;
};

}  // namespace palpa::viewer
