// Typed options of a command line. Each shows its unit, default and range in --help. The error for an invalid value
// names the option, the value and the valid values. With this header, the commands' files need not include the parser's
// own header.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/units.hpp"
#include "base/words.hpp"

namespace CLI {
class App;
}

namespace palpa::line {

/// Bounds of a number, both included; `open` excludes the lower bound.
struct Range {
  double low = 0;
  double high = 1e300;
  bool open = false;
};
/// Everything above zero, up to `high`.
constexpr Range positive(double high = 1e300) {
  return {0, high, true};
}

/// Where the number of an option goes. Its value, if it has one, is the default.
template <typename T>
struct Target {
  template <std::convertible_to<T> Own>
  Target(Own& own) : initial(own), set([&own](T value) { own = static_cast<Own>(value); }) {}
  template <std::convertible_to<T> Own>
  Target(std::optional<Own>& own) : initial(own), set([&own](T value) { own = static_cast<Own>(value); }) {}

  std::optional<T> initial;
  std::function<void(T)> set;
};

/// The options under one heading of a subcommand's help. Targets must outlive the parsing. The value of a target when
/// the option is added is the default and is shown in the help. If the target has no value then, the help text may end
/// with the default in brackets: "the array that sounds [the rig's]". An invalid value throws bad_usage during parsing.
class Group {
 public:
  Group(CLI::App& app, std::string heading) : app_(&app), heading_(std::move(heading)) {}

  /// A number with a unit, "1.5mm"; a bare number is SI. `given`: set to true if the option is on the line.
  void quantity(const std::string& name, const Target<double>& target, Quantity quantity, const Range& range,
                const std::string& help, bool* given = nullptr) const;
  /// The same, or "auto", which leaves `target` unchanged.
  void quantity_or_auto(const std::string& name, double& target, bool& automatic, Quantity quantity, const Range& range,
                        const std::string& help) const;
  /// A number without a unit; `type` is its placeholder in the help. `given` as for quantity().
  void number(const std::string& name, const Target<double>& target, const Range& range, const std::string& type,
              const std::string& help, bool* given = nullptr) const;
  void integer(const std::string& name, const Target<std::uint64_t>& target, std::uint64_t low, std::uint64_t high,
               const std::string& help) const;
  /// A large whole number, optionally in thousands or millions: 400000, 400k, 1M.
  void count(const std::string& name, std::uint32_t& target, std::uint32_t low, std::uint32_t high,
             const std::string& help) const;
  /// Any text, such as a file name; empty text is refused. `check` throws bad_usage for invalid text, even if nothing
  /// uses it later.
  using Check = std::function<void(const std::string& text)>;
  void text(const std::string& name, std::string& target, const std::string& type, const std::string& help,
            const Check& check = {}) const;
  /// A point "X,Y,Z", as parse_point reads it, no farther from the origin than farthest_point_m along any axis.
  void point(const std::string& name, std::string& target, const std::string& help) const;
  /// An option that may be given several times, with one value each time.
  void texts(const std::string& name, std::vector<std::string>& target, const std::string& type,
             const std::string& help, const Check& check = {}) const;
  /// The same, read by `parse`, which throws bad_usage for invalid text.
  template <typename T, typename Parse>
  void values(const std::string& name, std::vector<T>& target, const std::string& type, const std::string& help,
              Parse parse) const {
    each(name, type, help, [&target, parse](const std::vector<std::string>& all) {
      target.clear();
      for (const std::string& text : all)
        target.push_back(parse(text));
    });
  }
  /// Words that are not options and follow the command's name; any number of them. The parser takes brackets around a
  /// word, "[a,b]", for a list of words.
  void words(const std::string& name, std::vector<std::string>& target, const std::string& type,
             const std::string& help) const;
  /// Two texts after one another: "--line A B".
  void pair(const std::string& name, std::array<std::string, 2>& target, const std::string& type,
            const std::string& help, const Check& check = {}) const;
  void flag(const std::string& name, bool& target, const std::string& help) const;
  /// One of several words, usually those of an enum's table. `given`: set to true if the option is on the line.
  template <typename T, std::size_t count>
  void choice(const std::string& name, T& target, const Word<std::type_identity_t<T>> (&words)[count],
              const std::string& help, bool* given = nullptr) const {
    pick<T>(name, words, target, help, [&target, given](T value) {
      target = value;
      if (given) *given = true;
    });
  }
  template <typename T, std::size_t count>
  void choice(const std::string& name, std::optional<T>& target, const Word<std::type_identity_t<T>> (&words)[count],
              const std::string& help) const {
    pick<T>(name, words, target, help, [&target](T value) { target = value; });
  }

 private:
  void each(const std::string& name, const std::string& type, const std::string& help,
            std::function<void(const std::vector<std::string>&)> take) const;
  template <typename T>
  void pick(const std::string& name, std::span<const Word<T>> words, const std::optional<T>& initial,
            const std::string& help, const std::function<void(T)>& set) const {
    std::vector<std::string> names;
    std::vector<T> values;
    for (const Word<T>& entry : words) {
      names.emplace_back(entry.word);
      values.push_back(entry.value);
    }
    const auto at = initial ? std::ranges::find(values, *initial) : values.end();
    pick(name, std::move(names), static_cast<std::size_t>(at - values.begin()), help,
         [values, set](std::size_t i) { set(values[i]); });
  }
  void pick(const std::string& name, std::vector<std::string> words, std::size_t initial, const std::string& help,
            std::function<void(std::size_t)> chosen) const;
  void add(const std::string& name, const std::string& type, const std::string& initial, const std::string& help,
           const std::function<void(const std::string&)>& take) const;

  CLI::App* app_;
  std::string heading_;
};

/// "1.5mm", "1.5ms", "40kHz", "343m/s": the shortest text that reads back as `value`, in a common unit.
std::string format_quantity(double value, Quantity quantity);

/// Throws bad_usage naming the option if `value`, which a C++ caller set, is outside of the option's range or not
/// finite.
void check_quantity(const std::string& option, double value, Quantity quantity, const Range& range);

/// Limit for Group::point; beyond it, results are not exact.
inline constexpr double farthest_point_m = 1e4;
/// Three numbers "x,y,z" with optional length units; throws bad_usage naming the option.
std::array<double, 3> parse_point(const std::string& option, const std::string& text);
/// A direction "x,y,z", scaled if its squares would overflow or underflow. Throws bad_usage for 0,0,0.
std::array<double, 3> parse_direction(const std::string& option, const std::string& text);

}  // namespace palpa::line
