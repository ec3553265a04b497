// How the options of a run are called in the panels, and how their fields are filled in.
#pragma once

#include <string>

#include "line/option_table.hpp"

namespace palpa::viewer {

/// What a field offers beside typing.
enum class FieldKind {
  plain,
  object,    ///< a glTF file; palpa's own are in a list
  rig,       ///< a rig's TOML; palpa's own are in a list
  layout,    ///< a built-in layout, or a TOML
  source,    ///< where frames come from
  link,      ///< where drives go
  folder,    ///< a folder that exists
  new_file,  ///< a file to be written
  new_folder,
};

struct OptionWords {
  std::string name;   ///< "--dwell"
  std::string label;  ///< "dwell"
  std::string unit;   ///< that a bare number gets: "ms"; empty: it has no unit
  std::string about;  ///< explains it
  FieldKind kind = FieldKind::plain;
};
/// For an option without words of its own, those of its name.
OptionWords words_of(const line::OptionInfo& info);

/// The label with its unit: "dwell, ms".
std::string label_of(const OptionWords& words);
/// What a field shows of an option that is not given.
std::string shown_default(const line::OptionInfo& info);
/// The typed text as the option's value: a bare number gets the unit of the label.
std::string with_unit(const std::string& text, const OptionWords& words);

/// What a word means that an option can be set to, as one part of a sentence: "one focus in the middle of the contacts,
/// modulated". Empty for a word that needs no explanation.
std::string meaning_of(const std::string& option, const std::string& word);

}  // namespace palpa::viewer
