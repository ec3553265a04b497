// A vector with room for a fixed number of elements, which allocates nothing (as std::inplace_vector of C++26).
#pragma once

#include <array>
#include <cassert>
#include <cstddef>

namespace palpa {

template <typename T, std::size_t most>
class InplaceVector {
 public:
  InplaceVector() = default;
  /// `count` times the same.
  InplaceVector(std::size_t count, const T& value) : count_(count) {
    assert(count <= most);
    for (std::size_t i = 0; i < count; ++i)
      elements_[i] = value;
  }

  void push_back(const T& value) {
    assert(count_ < most);
    elements_[count_++] = value;
  }
  void clear() { count_ = 0; }

  std::size_t size() const { return count_; }
  bool empty() const { return count_ == 0; }
  T* data() { return elements_.data(); }
  const T* data() const { return elements_.data(); }
  T* begin() { return data(); }
  T* end() { return data() + count_; }
  const T* begin() const { return data(); }
  const T* end() const { return data() + count_; }
  T& operator[](std::size_t i) { return elements_[i]; }
  const T& operator[](std::size_t i) const { return elements_[i]; }
  const T& front() const { return elements_[0]; }
  const T& back() const { return elements_[count_ - 1]; }

 private:
  std::array<T, most> elements_{};
  std::size_t count_ = 0;
};

}  // namespace palpa
