// SPDX-License-Identifier: Apache-2.0
// The scene file and its -D parameters, for every command that takes a scene.
#pragma once
#include <string>
#include <vector>

#include "command/command.hpp"
#include "golden/scene/scene.hpp"

namespace photonloom {

class SceneOption {
 public:
  void add_to(CLI::App& command);
  // Throws UsageError for a malformed -D, SceneError for a bad scene.
  Scene load() const { return load_scene(path_, parameters()); }
  const std::string& path() const { return path_; }
  Parameters parameters() const;

 private:
  std::string path_;
  std::vector<std::string> definitions_;
};

}  // namespace photonloom
