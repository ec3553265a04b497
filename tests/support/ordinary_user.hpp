// What root may do says nothing about anybody else.
#pragma once

#include <unistd.h>

namespace palpa::test {

/// While it lives, root's tests have the rights of "nobody"; those of anybody else have their own.
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
