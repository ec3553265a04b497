// Results as bytes, for pickle. A struct with memory of its own, or with padding, whose bytes may be anything, has a
// function `fields`. It names all members in a structured binding: a member that is added later does not compile until
// it is named there, too.
#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/error.hpp"

namespace palpa::python {

/// Writes values into bytes, or reads them back in the same order.
class Archive {
 public:
  Archive() = default;
  explicit Archive(std::string_view bytes) : from_(bytes), reads_(true) {}
  std::string take() { return std::move(to_); }

  template <typename... Values>
  void operator()(Values&... values) {
    (one(values), ...);
  }
  bool at_end() const { return from_.empty(); }

 private:
  void raw(void* data, std::size_t size) {
    if (!reads_) return static_cast<void>(to_.append(static_cast<const char*>(data), size));
    if (size > from_.size()) throw bad_usage("the pickle is cut off");
    std::memcpy(data, from_.data(), size);
    from_.remove_prefix(size);
  }
  /// The number of elements that follow.
  template <typename Range>
  void count(Range& range) {
    std::uint64_t size = range.size();
    raw(&size, sizeof size);
    if (!reads_) return;
    if (size > from_.size()) throw bad_usage("the pickle is cut off");  // an element has a byte at least
    range.resize(size);
  }

  void one(std::string& text) {
    count(text);
    raw(text.data(), text.size());
  }
  void one(std::vector<bool>& values) {
    count(values);
    for (std::size_t i = 0; i < values.size(); ++i) {
      bool value = values[i];
      one(value);
      values[i] = value;
    }
  }
  template <typename T>
  void one(std::vector<T>& values) {
    count(values);
    for (T& value : values)
      one(value);
  }
  template <typename T>
  void one(std::optional<T>& value) {
    bool there = value.has_value();
    one(there);
    if (there && !value) value.emplace();
    if (there) one(*value);
  }
  template <typename A, typename B>
  void one(std::pair<A, B>& pair) {
    one(pair.first);
    one(pair.second);
  }
  template <typename T>
  void one(std::shared_ptr<const T>& value) {
    T copy = value ? *value : T();
    bool there = value != nullptr;
    one(there);
    if (!there) return;
    one(copy);
    if (reads_) value = std::make_shared<const T>(std::move(copy));
  }
  template <typename T>
  void one(std::shared_ptr<T>& value) {
    bool there = value != nullptr;
    one(there);
    if (there && !value) value = std::make_shared<T>();
    if (there) one(*value);
  }
  template <typename T>
  void one(T& value) {
    if constexpr (requires { fields(*this, value); }) {
      fields(*this, value);
    } else {
      static_assert(std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>, "name its members in fields()");
      raw(&value, sizeof value);
    }
  }

  std::string to_;
  std::string_view from_;
  bool reads_ = false;
};

}  // namespace palpa::python
