// SPDX-License-Identifier: Apache-2.0
// photon_gatherer on a board, behind golden/unit/backend.hpp.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "golden/unit/backend.hpp"
#include "host/board.hpp"
#include "host/journal.hpp"

namespace photonloom {

struct BoardOptions {
  // Opens the link; throws LinkLost. Called again when the board went away.
  std::function<std::unique_ptr<ByteLink>()> open;
  std::string device;                    // what messages call it
  double wait = 10;                      // seconds for a silent or vanished board to come back
  std::string work_dir = "build/cosim";  // where the journal is
  bool resume = true;                    // take answers that an interrupted run left in the journal
  // One sentence for the user each time: the board is gone, is back, a run goes on.
  std::function<void(const std::string&)> tell = [](const std::string&) {};
};

// Results and photons as they come from the board. A board that goes away is waited for; when it
// does not come back the unit throws LinkLost, and the answers so far are in the journal.
class BoardPhotonGatherer final : public PhotonGatherer {
 public:
  // Checks at once that the board is there and holds this plan's bitstream.
  BoardPhotonGatherer(const Plan& plan, BoardOptions options);
  ~BoardPhotonGatherer() override;

  void load(const PhotonMap& global, const PhotonMap& caustic) override;
  void process(std::span<const GatherQuery> in, std::vector<GatherResult>& results,
               std::vector<GatherPhoton>& photons) override;
  // The board's counters since load(), and what went over the link.
  Counters counters() const override;

 private:
  struct Job;
  // Runs `step`; when the link is lost, waits for the board and runs it again.
  template <class Step>
  void keep_trying(Step step);
  void connect(double patience);
  void prepare();  // a new session, with the maps loaded
  void reconnect(const LinkLost& lost);
  void ask(Job& job);
  void check_session();
  void push(Job& job, size_t until);  // words of the input, as far as there is room
  void pull(Job& job);
  void deliver(Job& job);
  void expect_silence(Job& job);
  [[noreturn]] void forgot() const;
  BoardState take_counters();

  Plan plan_;
  BoardOptions options_;
  PacketLayout query_, result_, photon_;
  std::unique_ptr<Board> board_;
  std::optional<Journal> journal_;
  PhotonGathererImage image_;
  bool loaded_ = false;      // the board has the image, unless it was reset
  bool unfinished_ = false;  // the journal is still of use
  uint32_t session_ = 0;
  uint32_t input_next_ = 0, output_next_ = 0;  // positions of the session
  Counters seen_, total_;  // the board's: when last read, and the sum of what it counted for us
  LinkCounts ended_;       // of connections that were lost
  uint64_t packets_in_ = 0, resumed_ = 0, answers_ = 0, lost_ = 0;
  double seconds_ = 0;  // spent in process()
};

}  // namespace photonloom
