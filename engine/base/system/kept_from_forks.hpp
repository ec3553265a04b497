// Descriptors that a fork() does not pass on.
#pragma once

namespace palpa {

/// During its lifetime, a process that fork() makes gets a descriptor without use in place of this one. A lock, a
/// camera or a board is then free as soon as its own process ends. For up to 256 descriptors; more are passed on.
class KeptFromForks {
 public:
  explicit KeptFromForks(int descriptor);
  ~KeptFromForks();
  KeptFromForks(const KeptFromForks&) = delete;
  KeptFromForks& operator=(const KeptFromForks&) = delete;

 private:
  int descriptor_;
};

}  // namespace palpa
