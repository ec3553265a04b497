// What a source leaves out. Each kind is reported when it first happens, then only with other reasons, and counted for
// a line at the end.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "base/sparing.hpp"

namespace palpa::sensing {

/// For one source, on one thread.
class LeftOut {
 public:
  explicit LeftOut(std::string source) : source_(std::move(source)) {}
  /// Warns of each kind that has happened more than once.
  ~LeftOut();
  LeftOut(const LeftOut&) = delete;
  LeftOut& operator=(const LeftOut&) = delete;

  /// `kind` is one of a few texts, such as "a datagram that is no frame". The first of its kind is a warning, which
  /// also says why. Another reason is a warning, too.
  void add(const std::string& kind, const std::string& why = {});

 private:
  std::string source_;
  std::map<std::string, std::uint64_t> counts_;
  Sparing reasons_;
};

}  // namespace palpa::sensing
