// The results that the test matrix compares between its legs.
#pragma once

#include <cstdint>
#include <cstring>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <type_traits>

namespace palpa::test {

/// An FNV-1a hash of the bytes of values without padding.
class Digest {
 public:
  template <typename T>
  void add(const T& value) {
    static_assert(std::has_unique_object_representations_v<T> || std::is_floating_point_v<T>);
    unsigned char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    for (const unsigned char byte : bytes)
      hash_ = (hash_ ^ byte) * 0x100000001b3ull;
  }
  void add(const glm::vec2& p) {
    for (int i = 0; i < 2; ++i)
      add(p[i]);
  }
  void add(const glm::vec3& p) {
    for (int i = 0; i < 3; ++i)
      add(p[i]);
  }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325ull;
};

/// Prints the hash of a result. With PALPA_DIGESTS=FOLDER, also writes it to the file `name` there:
/// tests/house/matrix.sh checks that it is the same for any number of threads, vector width and memory.
void tell_digest(const std::string& name, std::uint64_t hash);

}  // namespace palpa::test
