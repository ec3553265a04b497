// Finds missing barriers in what any test records, without the validation layer, which does not see all of them.
#pragma once

#include <string>

namespace palpa::test {

/// From now on, every dispatch of this process throws failure if it uses what an earlier one of the same command buffer
/// uses, and no barrier lies between them. Both kernels' names are in its line. Dispatches of one kernel may all write
/// one buffer: each writes its own part. Does not see what another command buffer did.
void watch_barriers();

/// While this lives, barriers between a dispatch of `kernel` and the next command that uses a buffer do not count. They
/// are still recorded.
class NoBarrierAfter {
 public:
  explicit NoBarrierAfter(const std::string& kernel);
  ~NoBarrierAfter();
  NoBarrierAfter(const NoBarrierAfter&) = delete;
  NoBarrierAfter& operator=(const NoBarrierAfter&) = delete;
};

}  // namespace palpa::test
