// The outputs of a command, declared before anything is read or opened, so that a command never overwrites its own
// inputs.
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
  /// For a folder that is not empty.
  enum class Full {
    refused,
    may_be_replaced,  ///< refused, with a message that names --overwrite
    replaced,         ///< its files will be deleted, so none of them may be an input
  };

  std::string option;  ///< "--json", for messages
  std::string target;  ///< a file, "-" for stdout, a new or empty folder; "" if there is no output
  Kind kind = Kind::file;
  Full full = Full::refused;
};

/// The outputs of a command, declared in the register of files (base/file_register.hpp). While this object lives, they
/// may be written, and reading one of them under any name is refused. Devices and pipes may be read, and written twice.
/// If several objects live, as in the viewer, the same option of two of them may name the same file.
class Outputs {
 public:
  /// Throws, before anything is changed, failure() for an output that cannot be written there; bad_usage for a folder
  /// that is not empty, two outputs that are the same file, an output that was read, an output inside another's folder,
  /// and two outputs on stdout. For a folder that will be replaced, every file in it counts as an output.
  explicit Outputs(const std::vector<Output>& outputs);
  ~Outputs();
  Outputs(const Outputs&) = delete;
  Outputs& operator=(const Outputs&) = delete;

  /// Whether one of them is stdout. Nothing else may be printed to stdout then.
  bool on_stdout() const { return on_stdout_; }

 private:
  bool on_stdout_ = false;
};

/// For an input that is named now and read later, or never: remembers it, and throws bad_usage, naming the option, if
/// it is a declared output. Does nothing for "" and for names that are not files.
void refuse_output_as_input(const std::filesystem::path& file);

}  // namespace palpa
