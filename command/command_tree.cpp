// SPDX-License-Identifier: Apache-2.0
#include "command/command_tree.hpp"

#include <sstream>

namespace photonloom {
namespace {

// CLI11 says a value as "N:INT in [1 - 256]", "TEXT:{a,b}" or "FILE".
void split_type(const std::string& type, OptionText& option) {
  option.value = type.substr(0, type.find(':'));
  if (const size_t at = type.find(" in ["); at != std::string::npos)
    option.range = type.substr(at + 4, type.find(']', at) - at - 3);
  if (const size_t at = type.find(":{"); at != std::string::npos) {
    std::istringstream in(type.substr(at + 2, type.find('}', at) - at - 2));
    for (std::string choice; std::getline(in, choice, ',');) option.choices.push_back(choice);
  }
}

OptionText option_text(const CLI::Option& from) {
  OptionText option;
  option.description = from.get_description();
  if (from.get_positional()) {
    option.names = {from.get_name(true)};
    split_type(from.get_type_name(), option);
    option.value = option.names.front();
    return option;
  }
  for (const std::string& name : from.get_snames()) option.names.push_back("-" + name);
  for (const std::string& name : from.get_lnames()) option.names.push_back("--" + name);
  if (from.get_items_expected_max() > 0) split_type(from.get_type_name(), option);
  return option;
}

CommandText tree_below(const CLI::App& app, const std::string& above) {
  CommandText command;
  command.name = app.get_name();
  command.path = above.empty() ? command.name : above + " " + command.name;
  command.description = app.get_description();
  command.footer = app.get_footer();
  for (const CLI::Option* option : app.get_options())
    (option->get_positional() ? command.positionals : command.options)
        .push_back(option_text(*option));
  for (const CLI::App* below : app.get_subcommands([](const CLI::App*) { return true; }))
    command.commands.push_back(tree_below(*below, command.path));
  return command;
}

}  // namespace

CommandText command_tree(const CLI::App& app) { return tree_below(app, ""); }

}  // namespace photonloom
