// Ctrl-C during long work that leaves nothing behind.
#pragma once

namespace palpa::cli {

/// From its construction on, the first SIGINT, SIGTERM or SIGHUP only makes `requested()` true; a second one ends the
/// program as it always does. One at a time.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  bool requested() const;
};

}  // namespace palpa::cli
