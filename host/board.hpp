// SPDX-License-Identifier: Apache-2.0
// A board at the other end of a link: what it says of itself, sessions, loading photon maps, and
// the replayer.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "golden/packet/packet.hpp"
#include "golden/unit/backend.hpp"
#include "golden/unit/photon_gatherer_image.hpp"
#include "host/connection.hpp"
#include "host/registers.hpp"

namespace photonloom {

// What answers is not what was asked for: another plan's bitstream, or no Photonloom board.
struct WrongBoard : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The registers, read at one time.
struct BoardState {
  uint32_t version = 0, session = 0, gatherers = 0, rx_bytes = 0;
  uint64_t plan_hash = 0;
  uint32_t input_room = 0, input_position = 0, output_first = 0, output_end = 0;
  uint32_t clock_khz = 0;  // 0: simulated
  uint32_t flags = 0, frames_bad = 0, bytes_lost = 0;
  uint32_t self_test = 0;  // a SelfTestState
  uint32_t faults = 0;     // words of memory that were not right
  uint64_t replay_cycles = 0, replay_signature = 0, replay_results = 0;
  Counters counters;
};

class Board {
 public:
  // Reads the registers and checks magic and version: LinkLost where nobody answers within
  // `patience` seconds, WrongBoard where something else does.
  Board(std::unique_ptr<ByteLink> link, double patience);

  const std::string& name() const { return connection_.name(); }
  Connection& connection() { return connection_; }
  const BoardState& first_state() const { return first_; }
  BoardState state();

  // Throws WrongBoard, naming both hashes and what to do, unless the bitstream is this plan's.
  void check_plan(const Plan& plan) const;

  // Empties both streams and stops the replayer; returns when nothing is inside. `session` is not
  // 0 and not the one that the board holds.
  void start_session(uint32_t session);

  // The maps into the gatherers and the photon memory; nothing may be inside.
  void load(const Plan& plan, const PhotonGathererImage& image);

  struct Replay {
    uint64_t cycles = 0, signature = 0, results = 0;
  };
  // Plays the queries `passes` times. want_photons is ignored; a replay through the reorder buffer
  // needs a flush as its last query.
  Replay replay(const Plan& plan, std::span<const GatherQuery> queries, uint32_t passes,
                uint32_t mode);

 private:
  // Polls Flags until `done`; a LinkLost saying `what` was waited for after `seconds`.
  template <class Done>
  void wait_flags(Done done, double seconds, const char* what);
  Connection connection_;
  double patience_;
  BoardState first_;
};

}  // namespace photonloom
