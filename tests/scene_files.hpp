// SPDX-License-Identifier: Apache-2.0
// Small scene files for tests: written to a folder of their own, loaded, removed.
#pragma once
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "golden/scene/scene.hpp"

namespace photonloom {

// A folder that lives as long as the object.
class TestFolder {
 public:
  TestFolder() {
    static int count = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("photonloom_test_" + std::to_string(getpid()) + "_" + std::to_string(count++));
    std::filesystem::create_directories(path_);
  }
  ~TestFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;

  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  std::string write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary) << text;
    return *this / name;
  }

 private:
  std::filesystem::path path_;
};

inline constexpr const char* kSensor = "<sensor type=\"perspective\"/>";
inline constexpr const char* kLamp = "<shape type=\"disk\"><emitter type=\"area\"/></shape>";

// A file of the given version around `body`.
inline std::string scene_text(const std::string& body, const std::string& version = "0.6.0") {
  return "<scene version=\"" + version + "\">\n" + body + "\n</scene>\n";
}

// Loads `body` with a camera and a lamp (the last shape) added.
inline Scene load_body(const std::string& body, const std::string& version = "0.6.0",
                       const Parameters& parameters = {}) {
  const TestFolder folder;
  return load_scene(folder.write("scene.xml", scene_text(body + kSensor + kLamp, version)),
                    parameters);
}

// The error of loading a file with exactly `text`; "" where it loads.
inline std::string load_error(const std::string& text, const Parameters& parameters = {}) {
  const TestFolder folder;
  try {
    load_scene(folder.write("scene.xml", text), parameters);
  } catch (const SceneError& error) {
    const std::string what = error.what();
    const size_t at = what.find("scene.xml");
    return at == std::string::npos ? what : what.substr(at);  // without the folder
  }
  return "";
}

inline std::string body_error(const std::string& body, const std::string& version = "0.6.0") {
  return load_error(scene_text(body + kSensor + kLamp, version));
}

}  // namespace photonloom
