// The threads that draw, which give way to those of a live run: the one that asks for pictures, and its driver's.
#pragma once

#include <vector>

#include "session/threads.hpp"

namespace palpa::viewer {

/// All of it on the thread that asks for pictures.
class DrawingThreads {
 public:
  /// What begins from here to have_begun() draws: a device is made in between.
  void expect() { others_ = session::threads_since(); }
  void have_begun() {
    if (!gives_way_) driver_ = session::threads_since(others_);
  }
  /// Once there is a live run, or will be. What this thread begins later gives way by itself.
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
