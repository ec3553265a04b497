// A line of text in memory of fixed size, for code that must not allocate. Text that is too long is cut.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>
#include <utility>

namespace palpa::driver {

template <std::size_t Most>
class FixedText {
 public:
  FixedText() = default;
  template <typename... Args>
  explicit FixedText(fmt::format_string<Args...> text, Args&&... args) {
    format(text, std::forward<Args>(args)...);
  }

  template <typename... Args>
  void format(fmt::format_string<Args...> text, Args&&... args) {
    const auto end = fmt::format_to_n(room_.data(), Most, text, std::forward<Args>(args)...);
    size_ = std::min<std::size_t>(end.size, Most);
  }
  void assign(std::string_view text) { size_ = text.copy(room_.data(), Most); }
  void clear() { size_ = 0; }
  bool empty() const { return size_ == 0; }
  std::string_view view() const { return {room_.data(), size_}; }

 private:
  std::array<char, Most> room_{};
  std::size_t size_ = 0;
};

}  // namespace palpa::driver
