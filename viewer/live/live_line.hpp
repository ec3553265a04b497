// The options of `palpa run` as the viewer takes, shows and changes them.
#pragma once

#include <string>
#include <vector>

#include "line/option_table.hpp"
#include "setup/sessions/live_run.hpp"

namespace palpa::viewer {

/// All of them that say what runs, in the order of `palpa run --help`.
const std::vector<line::OptionInfo>& live_table();
/// The others: how long the command runs, what it reports, and whether it reads a saved scene again. The viewer runs
/// until it is closed, reports in its panels, and always reads a saved scene again, so it only copies them into the
/// command.
const std::vector<line::OptionInfo>& copied_table();

/// The values of live_table()'s options. It is not checked whether they go together. Throws bad_usage for a text that
/// is not a value of its option.
setup::LiveOptions values_of(const line::Given& given);
/// Throws bad_usage if the given options, which have these values, do not go together.
void check_live(const line::Given& given, const setup::LiveOptions& options);
/// The values, checked.
setup::LiveOptions live_options(const line::Given& given);
/// Throws bad_usage for a text that is not a value of its option in copied_table().
void check_copied(const line::Given& copied);

/// The `palpa run` command with the options `given`, and with those of copied_table() in `copied`.
std::string run_command(const line::Given& given, const line::Given& copied = {});

}  // namespace palpa::viewer
