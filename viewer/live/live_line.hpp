// The options of `palpa run` as the viewer takes, shows and changes them.
#pragma once

#include <string>
#include <vector>

#include "setup/live_run.hpp"
#include "setup/option_table.hpp"

namespace palpa::viewer {

/// All of them that say what runs, in the order of `palpa run --help`.
const std::vector<setup::OptionInfo>& live_table();
/// The others: how long the command runs, what it reports, and whether it reads a saved scene again. The viewer runs
/// until it is closed, reports in its panels, and always reads a saved scene again, so it only copies them into the
/// command.
const std::vector<setup::OptionInfo>& copied_table();

/// The values of live_table()'s options. It is not checked whether they go together. Throws bad_usage for a text that
/// is not a value of its option.
setup::LiveOptions values_of(const setup::Given& given);
/// The same, and throws bad_usage if the options do not go together.
setup::LiveOptions live_options(const setup::Given& given);
/// Throws bad_usage for a text that is not a value of its option in copied_table().
void check_copied(const setup::Given& copied);

/// The `palpa run` command with the options `given`, and with those of copied_table() in `copied`.
std::string run_command(const setup::Given& given, const setup::Given& copied = {});

}  // namespace palpa::viewer
