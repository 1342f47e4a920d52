// SPDX-License-Identifier: Apache-2.0
// The commands and options of the command line as plain values, from which the manual page and the
// shell completions are written.
#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace photonloom {

struct OptionText {
  std::vector<std::string> names;    // "-o", "--output"; of a positional its one name
  std::string value;                 // "DIR"; empty where no value follows
  std::string range;                 // "[1 - 256]", or empty
  std::vector<std::string> choices;  // all values there are, where they are listed
  std::string description;
};

struct CommandText {
  std::string path;  // "photonloom", "photonloom board info"
  std::string name;  // the last word of it
  std::string description, footer;
  std::vector<OptionText> options, positionals;
  std::vector<CommandText> commands;
};

// `app` and all below it, in the order of --help.
CommandText command_tree(const CLI::App& app);

// Calls f(command) for `root` and each command below it, parents first.
template <class F>
void for_each_command(const CommandText& root, const F& f) {
  f(root);
  for (const CommandText& c : root.commands) for_each_command(c, f);
}

std::string manual_page(const CommandText& root, const std::string& version);  // roff, section 1
std::string bash_completion(const CommandText& root);
std::string zsh_completion(const CommandText& root);
std::string fish_completion(const CommandText& root);

}  // namespace photonloom
