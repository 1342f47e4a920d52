// SPDX-License-Identifier: Apache-2.0
// What can stand for a unit: the list of backends, as a command line names them, and the options of
// those that are boards.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "command/command.hpp"
#include "golden/unit/photon_gatherer.hpp"
#include "host/photon_gatherer.hpp"
#include "verilator_tb/unit/backends.hpp"

namespace photonloom {

// Of a board on a command line.
class BoardFlags {
 public:
  void add_to(CLI::App& command);
  // The board is there and holds the plan's bitstream, or an error says what is wrong.
  void check(const Plan& plan, const std::string& device) const;
  // Throws UsageError where an option is given although no unit is a board.
  void refuse_alone() const;
  // Says on stderr when the board goes away and comes back; keeps its journal in `work_dir`. Each
  // unit of BoardPlace::kLink has one.
  std::unique_ptr<PhotonGatherer> make(std::type_identity<PhotonGatherer>, const Plan& plan,
                                       const std::string& device,
                                       const std::string& work_dir) const;

 private:
  CLI::App* command_ = nullptr;
  double wait_ = 10;
  bool no_resume_ = false;
};

enum class BackendSource { kGolden, kBrute, kModel, kBoard };

// A line of the list.
struct BackendKind {
  std::string name;
  std::string argument;  // behind the name, as help shows it: ":DEVICE[@BAUD]"
  std::string meaning;   // a phrase
  BackendSource source;
  std::optional<ModelKind> model;  // of kModel
  bool in_frames;                  // cosim takes it
  bool (*serves)(const UnitInfo& unit);
};
// Every model kind is one.
std::vector<BackendKind> backend_kinds();
// "rtl, netlist, ..., board:DEVICE", the kinds that cosim takes, or all that there are.
std::string backend_kinds_text(bool in_frames);

// One of them as a command line gives it.
struct Backend {
  BackendKind kind;
  std::string device;  // of a board
};
// The extension of the waveforms that it writes; empty: it writes none.
std::string waveform_of(const Backend& backend);
// Nothing for a text that is no backend. Throws UsageError for a DEVICE that is none.
std::optional<Backend> parse_backend(const std::string& text);

// A unit by a backend that serves it.
template <class Unit>
std::unique_ptr<Unit> make_backend(std::type_identity<Unit> unit, const Backend& backend,
                                   const Plan& plan, RunOptions run, const BoardFlags& board) {
  switch (backend.kind.source) {
    case BackendSource::kModel:
      run.kind = *backend.kind.model;
      return make_rtl(unit, plan, run);
    case BackendSource::kBoard:
      if constexpr (requires { board.make(unit, plan, backend.device, run.work_dir); })
        return board.make(unit, plan, backend.device, run.work_dir);
      break;
    case BackendSource::kBrute:
      if constexpr (std::is_same_v<Unit, PhotonGatherer>) return make_brute_photon_gatherer(plan);
      break;
    case BackendSource::kGolden:
      return make_golden(unit, plan);
  }
  throw std::logic_error(backend.kind.name + " does not serve " + unit_name<Unit>);
}

}  // namespace photonloom
