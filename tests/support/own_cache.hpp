// What is slow to compute, kept in a folder of a test's own.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace palpa::test {

/// During its lifetime, the commands of a test share what they keep between runs. Otherwise, tests keep nothing.
class OwnCache {
 public:
  explicit OwnCache(const std::filesystem::path& folder) {
    setenv("XDG_CACHE_HOME", folder.c_str(), 1);
    setenv("PALPA_CACHE", "on", 1);
  }
  ~OwnCache() {
    setenv("PALPA_CACHE", "off", 1);
    setenv("XDG_CACHE_HOME", before_.c_str(), 1);
  }
  OwnCache(const OwnCache&) = delete;
  OwnCache& operator=(const OwnCache&) = delete;

 private:
  const std::string before_ = std::getenv("XDG_CACHE_HOME") ? std::getenv("XDG_CACHE_HOME") : "";
};

}  // namespace palpa::test
