// What a source leaves out. Each kind is reported when it first happens, and counted for a line at the end.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>

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
  /// also says why.
  void add(const std::string& kind, const std::string& why = {});

 private:
  std::string source_;
  std::map<std::string, std::uint64_t> counts_;
};

}  // namespace palpa::sensing
