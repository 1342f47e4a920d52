// SPDX-License-Identifier: Apache-2.0
#include "command/scene_option.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace photonloom {

void SceneOption::add_to(CLI::App& command) {
  command.add_option("SCENE", path_, "Mitsuba XML file (docs/scene.md says which elements)")
      ->required();
  command
      .add_option("-D,--define", definitions_,
                  "Value of a $NAME in the scene file; wins over its <default>")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);  // -D NAME=VALUE SCENE must not take the scene too
}

Parameters SceneOption::parameters() const {
  Parameters parameters;
  for (const std::string& definition : definitions_) {
    const size_t at = definition.find('=');
    if (at == 0 || at == std::string::npos)
      throw UsageError(fmt::format("-D {}: expected NAME=VALUE", definition));
    const std::string name = definition.substr(0, at);
    if (std::any_of(parameters.begin(), parameters.end(),
                    [&](const auto& known) { return known.first == name; }))
      throw UsageError(fmt::format("parameter '{}' is given twice with -D", name));
    parameters.emplace_back(name, definition.substr(at + 1));
  }
  return parameters;
}

}  // namespace photonloom
