// What a command is going to write, known before anything is read or opened, so that it never writes over what it
// reads.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/output_place.hpp"

namespace palpa {

/// One of a command's outputs, as the command line gave it.
struct Output {
  enum class Kind { file, folder };

  std::string option;  ///< "--json", for messages
  std::string target;  ///< a file, "-" for stdout, a new or empty folder; "" where there is none
  Kind kind = Kind::file;
};

/// The outputs of a command, declared in the register of files (base/file_register.hpp). While it lives, they may be
/// written, and reading one of them is refused, under whatever name. Devices and pipes may be read, and written twice.
/// Where several live, as in the viewer, an option of one may name the same file as the same option of another.
class Outputs {
 public:
  /// Throws, before anything is changed, failure() for an output that cannot be written there, bad_usage for a folder
  /// that is not empty, for two that are the same file, for one that was read, for one within another's folder, and for
  /// two on stdout.
  explicit Outputs(const std::vector<Output>& outputs);
  ~Outputs();
  Outputs(const Outputs&) = delete;
  Outputs& operator=(const Outputs&) = delete;

  /// Whether one of them is stdout: nothing else may be printed there.
  bool on_stdout() const { return on_stdout_; }

 private:
  bool on_stdout_ = false;
};

/// An input that is named now and read later, or not at all: throws bad_usage, naming the option, where it is a
/// declared output, and remembers it. Nothing for "" and for what is no file.
void refuse_output_as_input(const std::filesystem::path& file);

}  // namespace palpa
