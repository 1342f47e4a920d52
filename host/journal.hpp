// SPDX-License-Identifier: Apache-2.0
// Answers that a board gave, kept in a file so that a run that lost its board goes on where it
// stopped. An answer is a function of the query, the map and the plan alone, so a kept one is as
// good as a new one for the same three.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "golden/packet/layout.hpp"
#include "golden/packet/packet.hpp"

namespace photonloom {

class Journal {
 public:
  // FOLDER/board-PLAN-MAP.journal; `map` is a checksum of the loaded maps. With `resume` the
  // answers that stand in it are read: up to the first that is cut off or damaged, after which it
  // goes on. Without, it starts empty. An error if another run has it open.
  Journal(const Plan& plan, const std::string& map, const std::string& folder, bool resume);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  const std::string& path() const { return path_; }
  uint64_t kept() const { return kept_; }  // answers read at the start

  // Whether the next kept answer is one to this query; then takes it. A kept answer to another
  // query is dropped with all that follow it: the run asks something else from there on.
  bool take(const GatherQuery& query, GatherResult& result, std::vector<GatherPhoton>& photons);
  void add(const GatherQuery& query, const GatherResult& result,
           std::span<const GatherPhoton> photons);
  void flush();
  uint64_t size() const { return records_.size() + added_; }  // answers in it
  // The run is over: the file goes.
  void remove();

 private:
  struct Record {
    GatherQuery query;
    GatherResult result;
    std::vector<GatherPhoton> photons;
    uint64_t end = 0;  // in the file
  };
  bool read_record(Record& record);
  void cut(uint64_t end);

  Plan plan_;
  PacketLayout query_, result_, photon_;
  std::string path_, buffer_;
  int descriptor_ = -1;
  uint64_t kept_ = 0, taken_ = 0, added_ = 0;
  uint64_t end_ = 0;  // of what stands and is good
  std::vector<Record> records_;
};

}  // namespace photonloom
