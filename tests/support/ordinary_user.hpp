// Drops root's rights: what works for root says nothing about other users.
#pragma once

#include <unistd.h>

namespace palpa::test {

/// While it lives, tests that run as root have the rights of "nobody"; tests of any other user keep theirs.
class OrdinaryUser {
 public:
  OrdinaryUser() : was_root_(::geteuid() == 0 && ::seteuid(65534) == 0) {}
  ~OrdinaryUser() {
    if (was_root_ && ::seteuid(0) != 0) ::_exit(1);
  }
  OrdinaryUser(const OrdinaryUser&) = delete;
  OrdinaryUser& operator=(const OrdinaryUser&) = delete;

 private:
  bool was_root_;
};

}  // namespace palpa::test
