// SPDX-License-Identifier: Apache-2.0
// plan.toml: the plan as a complete, readable, editable file, its checks and its hash.
#pragma once
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "golden/plan/plan.hpp"

namespace photonloom {

// What is wrong with a plan: one sentence that names file and line where known, section.key, and
// what was expected.
class PlanError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Why a line has its value, by "section.key". Lines without a reason are commented with their
// meaning.
using PlanReasons = std::map<std::string, std::string>;

struct PlanProblem {
  std::string line;  // "section.key"
  std::string what;  // what was expected and why
};

// The first line that is out of its range or does not go with the others; nothing for a plan that
// can be built. A plan that passes cannot overflow any width: docs/plan.md says why.
std::optional<PlanProblem> find_problem(const Plan& plan);
// The same of the cube's edge alone, and of channels and their colour alone, where the rest of a
// plan is not yet known.
std::optional<PlanProblem> extent_problem(const Plan& plan);
std::optional<PlanProblem> channel_problem(const Plan& plan);

// Addresses of a gatherer's nodes, the first of its configuration; registers come after them
// (docs/photon_gatherer.md).
inline constexpr uint32_t kNodeAddresses = 1u << 23;
// What keeps a plan that golden can render from hardware: more lines than there are of these.
std::optional<PlanProblem> hardware_problem(const Plan& plan);

// Words of 32 bits of photon lines that a board's link has addresses for (docs/host-link.md).
inline constexpr uint64_t kLinkWords = 1u << 28;

// What keeps a plan whose units can be built from a board: as many words of lines as these, or
// beats that are no whole words, by which a photon memory of block RAM is written.
std::optional<PlanProblem> board_problem(const Plan& plan);

// Throws PlanError with the first problem.
void check_plan(const Plan& plan);
// The same of a plan whose lines were changed by assignments, as set_plan_line has them. An error
// names the one that assigned the wrong line, or else `file`, which is "plan" for one without a
// file, and all of them.
void check_plan(const Plan& plan, const std::string& file,
                const std::vector<std::string>& assignments);
// The same where only one check was made; does nothing without a problem.
void throw_problem(const std::optional<PlanProblem>& problem, const std::string& file,
                   const std::vector<std::string>& assignments);

// Whether a file may lack the line "section.key", which then has its default value. So it is with
// each line that came after the first release: older files stay readable, and a plan in which the
// line has its default keeps the hash that it had before there was the line.
bool may_be_left_out(const std::string& line);

// 64-bit FNV-1a of the canonical text of all lines but scene.name, and but those that may be left
// out and have their default value.
uint64_t plan_hash(const Plan& plan);
std::string plan_hash_text(const Plan& plan);  // 16 hexadecimal digits

// The file's text. Reading it gives the same plan to the bit.
std::string plan_text(const Plan& plan, const PlanReasons& reasons = {});

// Reasons that stay where `from`, whose file has `text`, becomes `to`: what comments at the ends of
// lines say beside the line's meaning, but of those lines that change.
PlanReasons kept_reasons(const std::string& text, const Plan& from, const Plan& to);

// Each section and key must be there but those that may be left out, no other may be; the result
// passes check_plan. `file` is what errors call it.
Plan parse_plan(const std::string& text, const std::string& file);
Plan read_plan(const std::string& path);

// Whole or not at all.
void write_plan(const Plan& plan, const std::string& path, const PlanReasons& reasons = {});

// Sets one line from "section.key=value", the value spelt as in the file (quotes may be left out);
// what follows from it is derived again. Checks the value's type and range, not the whole plan.
void set_plan_line(Plan& plan, const std::string& assignment);

// All that a line of the plan may be which is true or false, or one of some words; empty for lines
// of other values.
std::vector<std::string> plan_line_words(const std::string& line);

// Sets what is no line of the file but follows from the lines: r2_max of both maps.
void derive_plan(Plan& plan);

// A radius in scene units that radius_to_r2_max turns into exactly this squared distance.
double radius_for_r2_max(const Plan& plan, uint64_t r2_max);

}  // namespace photonloom
