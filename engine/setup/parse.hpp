// The command line read, and whatever is wrong with it told in palpa's own words.
#pragma once

namespace CLI {
class App;
}

namespace palpa::setup {

/// Reads a line with `app`, the program. Throws bad_usage, one line that names the option or the word, what is right
/// and which --help tells more; and the parser's own CLI::CallForHelp and CLI::CallForVersion.
void parse(CLI::App& app, int argc, const char* const* argv);

}  // namespace palpa::setup
