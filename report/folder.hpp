// SPDX-License-Identifier: Apache-2.0
// Reading what cosim and sweep left. All functions throw std::runtime_error naming the file.
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "golden/image/image.hpp"
#include "report/payload.hpp"
#include "report/report.hpp"

namespace photonloom {

// A JSON object from a file; `what` says whose it is in errors ("of a run").
nlohmann::ordered_json read_object(const std::string& path);
// A member that has to be there; `path` is the file's.
const nlohmann::ordered_json& member(const nlohmann::ordered_json& object, const std::string& name,
                                     const std::string& path);

// Images of one size for one viewer, in the order in which they are added; an image equal to an
// earlier one is stored once.
class ImageSet {
 public:
  ImageSet(int mantissa, Payloads& payloads) : mantissa_(mantissa), payloads_(payloads) {}
  // `about` says in a sentence what the image is.
  void add(const std::string& label, const std::string& file, const std::string& about,
           Image image);
  void add_file(const std::string& label, const std::string& file, const std::string& about);
  // Every image must have the size of this file's, and the error names the one that has not.
  void expect_size_of(const std::string& file);
  bool empty() const { return images_.empty(); }
  // {width, height, mantissa, list: [{label, file, about, same_as, layers}], pairs: [{a, b,
  // metrics, flip}]}: every later image against every earlier one, where they differ.
  nlohmann::ordered_json json();

 private:
  struct Entry {
    std::string label, file, about;
    Image image;
    std::string same_as;
  };
  int mantissa_;
  Payloads& payloads_;
  std::vector<Entry> images_;
  std::string like_;  // whose size images must have; empty: the first one's
  int width_ = 0, height_ = 0;
};

// A plan's lines: {hash, lines: [{section, key, value, meaning, reason}]}.
nlohmann::ordered_json read_plan_lines(const std::string& path);

bool is_run(const std::string& folder);
bool is_study(const std::string& folder);
nlohmann::ordered_json run_json(const std::string& folder, const std::vector<ExtraImage>& images,
                                Payloads& payloads);
nlohmann::ordered_json study_json(const std::string& folder, const std::vector<ExtraImage>& images,
                                  Payloads& payloads);

}  // namespace photonloom
