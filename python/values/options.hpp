// Keyword arguments as options of the command line: the same names with _ instead of -, the same ranges, defaults and
// messages, because they are read by the same tables (line/values.hpp). Numbers are SI; texts such as "1.5mm" are read
// as on the command line.
#pragma once

#include <pybind11/pybind11.h>

#include <functional>
#include <initializer_list>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "line/option_table.hpp"

namespace CLI {
class App;
}  // namespace CLI

namespace palpa::python {

namespace py = pybind11;

/// The options of one function. Reading them is quick, because the table is made once.
class OptionTable {
 public:
  /// `function` is the name in messages and in stubs. `add` adds the options to the command, as setup's functions do;
  /// their targets must outlive this object. The options in `hidden` have no keyword.
  OptionTable(std::string function, const std::function<void(CLI::App&)>& add,
              std::initializer_list<const char*> hidden);
  ~OptionTable();
  OptionTable(const OptionTable&) = delete;
  OptionTable& operator=(const OptionTable&) = delete;

  /// The options that these keyword arguments give; None means that an option is not given. May run Python code. Throws
  /// bad_usage for an unknown keyword, naming the nearest one.
  line::Given given_by(const py::kwargs& arguments) const;
  /// Reads them into the targets. Throws bad_usage for values that the command line would refuse.
  void read(const line::Given& given);
  /// `doc` with the options at its end, as "Other Parameters".
  std::string documented(const std::string& doc) const;

 private:
  std::string function_;
  std::unique_ptr<CLI::App> app_;
  std::vector<line::OptionInfo> infos_;  ///< those with a keyword
  /// An option with a keyword.
  struct Known {
    std::string name;      ///< "--finger-gap"
    bool flag = false;     ///< it has no value
    bool several = false;  ///< it may be given several times
  };
  std::map<std::string, Known> options_;  ///< by keyword
};

/// The options of one function, and their values.
template <typename Values>
class Declared {
 public:
  Declared(const char* function, void (*add)(CLI::App&, Values&), std::initializer_list<const char*> hidden = {})
      : table_(
            function, [&](CLI::App& app) { add(app, values_); }, hidden),
        usual_(values_) {}

  /// The values of these keyword arguments; without any, the defaults.
  Values read(const py::kwargs& arguments) {
    if (arguments.empty()) return usual_;
    const line::Given given = table_.given_by(arguments);
    values_ = usual_;  // no Python code runs from here on, so that no other thread comes between
    table_.read(given);
    return values_;
  }
  std::string documented(const std::string& doc) const { return table_.documented(doc); }

 private:
  Values values_{};
  OptionTable table_;
  Values usual_;
};

/// The options of one function, declared at the first call. They are never destroyed, because threads may still run
/// when the process ends.
template <typename Values>
class DeclaredOnce {
 public:
  /// `hidden` must never be destroyed either.
  constexpr DeclaredOnce(const char* function, void (*add)(CLI::App&, Values&),
                         std::initializer_list<const char*> hidden = {})
      : function_(function), add_(add), hidden_(hidden) {}

  /// Needs the GIL.
  Declared<Values>& operator()() {
    if (!made_) made_ = new Declared<Values>(function_, add_, hidden_);
    return *made_;
  }

 private:
  const char* function_;
  void (*add_)(CLI::App&, Values&);
  std::initializer_list<const char*> hidden_;
  Declared<Values>* made_ = nullptr;
};

/// Whether it has parts to be read one after the other: neither a text nor an array without dimensions. Take the parts
/// as py::object: an array makes them when they are asked for.
bool is_list(py::handle value);

/// The options of outputs, for which the module has results.
inline constexpr std::initializer_list<const char*> outputs_of_commands = {"--json", "--quiet", "--log-level"};

}  // namespace palpa::python
