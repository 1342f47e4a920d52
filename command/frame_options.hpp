// SPDX-License-Identifier: Apache-2.0
// The options of every command that prepares a frame, and what they say on stderr.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "command/command.hpp"
#include "command/scene_option.hpp"
#include "golden/pipeline/gather_diagnosis.hpp"
#include "golden/pipeline/prepare.hpp"

namespace photonloom {

// Which lines --set may name: a plan's, or those of a study too, which stand for several.
enum class SetLines { kOfPlan, kOfStudy };

class FrameOptions {
 public:
  // SCENE and all that chooses photons, plan and samples.
  void add_to(CLI::App& command);

  // Checked; throws UsageError for options that exclude each other.
  FrameRequest request(SetLines lines = SetLines::kOfPlan) const;

  // Throws UsageError where an option is given that changes a plan which is derived: `plan_file` is
  // there already.
  void refuse_derivation(const std::string& plan_file) const;
  // The same for every option of a plan, --set too; `why` is what is said of it.
  void refuse_all(const std::string& why) const;
  bool has_seed() const;
  // Options given that only the photon mapper reads.
  std::vector<std::string> photon_options() const;

 private:
  CLI::App* command_ = nullptr;
  SceneOption scene_;
  FrameRequest request_;
  std::string size_;
};

// Whether a command that takes a scene or a plan was given a plan: a file name that ends in .toml.
bool is_plan(const std::string& path);

// "WxH" -> pixels; throws UsageError, which names the option.
std::pair<int, int> parse_size(const std::string& text, const std::string& option = "--size");

// Of --radius.
CLI::Validator radius_number();

// Throws UsageError where a line of --set is no NAME=VALUE, or two are of one name.
void check_set_lines(const std::vector<std::string>& lines, SetLines names = SetLines::kOfPlan);

// Throws UsageError where one of --set names no line of the plan, or a value that no plan has.
void check_set_values(const std::vector<std::string>& lines);

// An option that decides lines of the plan.
struct Shortcut {
  const char* option;
  std::vector<const char*> lines;
};
// Throws UsageError where one of --set is among them.
void refuse_decided(const std::vector<std::string>& lines, const Shortcut& shortcut);

// The files that a frame is made of, as far as the command line names them.
std::vector<std::string> frame_inputs(const FrameRequest& request);

// What a photon-mapped image says of itself; the same from every command, so that equal pixels are
// equal files.
void describe_frame(Image& image, const PreparedFrame& frame, const FrameRequest& request,
                    const std::string& arithmetic);

// Where the gathers of a frame found too few photons; adds the layers that show it.
GatherDiagnosis diagnose_into(Image& image, const GatherWatch& watch, const PreparedFrame& frame,
                              const FrameRequest& request);
nlohmann::ordered_json diagnosis_json(const GatherDiagnosis& diagnosis);
// Where the request names a plan, with what that decides.
std::vector<std::string> diagnosis_messages(const GatherDiagnosis& diagnosis,
                                            const FrameRequest& request);

// What happened in a frame, in packets, and what was taken as the largest that fits; messages for
// what a user should know of it.
nlohmann::ordered_json counts_json(const FrameCounts& counts);
// The part of it that counts ends of ranges, as JSON, and as words: those that are not 0, or
// "none".
nlohmann::ordered_json range_counts_json(const FrameCounts& counts);
std::string range_counts_text(const FrameCounts& counts);
std::vector<std::string> count_messages(const FrameCounts& counts);
// Photons that the power format made zero, those that it clipped, and those outside of the cube.
nlohmann::ordered_json packed_json(const PreparedFrame& frame);

void print_warnings(const std::vector<std::string>& warnings);

}  // namespace photonloom
