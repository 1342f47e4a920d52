// SPDX-License-Identifier: Apache-2.0
// A 256 Mbit SDR SDRAM (4 banks x 8192 rows x 512 columns x 16 bits) as its data sheet describes
// it: its answers in time, and an error as soon as a rule is broken. What is supported: bursts of
// 1, 2, 4 or 8 words read in sequence, single words written, PRECHARGE by hand, AUTO REFRESH, LOAD
// MODE REGISTER. Auto precharge, self refresh, power down and BURST TERMINATE are errors. Times and
// their source: docs/photon_memory.md.
#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <stdexcept>
#include <string>
#include <vector>

namespace photonloom {

// Picoseconds, but for `mode_clocks`.
struct SdramTimes {
  int64_t power_up = 100'000'000;  // clock and NOP before the first command
  int64_t clock_2 = 10'000;        // shortest clock with CAS latency 2
  int64_t clock_3 = 7'500;         // and with 3
  int64_t row_to_column = 21'000;  // tRCD
  int64_t precharge = 21'000;      // tRP
  int64_t row_active = 44'000;     // tRAS
  int64_t row_active_most = 120'000'000;
  int64_t row_cycle = 66'000;            // tRC
  int64_t row_to_row = 15'000;           // tRRD, different banks
  int64_t write_recovery = 15'000;       // tWR
  int64_t refresh = 66'000;              // tRFC
  int64_t refresh_every = 7'812'500;     // tREFI on average, 64 ms for 8192 rows
  int64_t row_refresh = 64'000'000'000;  // from a row's refresh to its next one
  int mode_clocks = 2;                   // tMRD
  int init_refreshes = 2;
  int64_t access_2 = 6'000, access_3 = 5'400;  // tAC: clock to data
  int64_t hold = 2'500;                        // tOH: how long data stay after the next clock
};

// A rule of the chip was broken; `rule` is its name ("tRCD").
struct SdramError : std::runtime_error {
  SdramError(const std::string& rule_name, int64_t time, const std::string& what);
  std::string rule;
};

struct SdramPins {
  bool cke = false, cs_n = true, ras_n = true, cas_n = true, we_n = true;
  unsigned bank = 0, address = 0, dqm = 3;
  bool driven = false;  // the other side drives the data pins
  uint16_t data = 0;
};

class SdramChip {
 public:
  explicit SdramChip(const SdramTimes& times = {});

  // A rising edge of the chip's clock, later than the last one.
  void edge(int64_t time, const SdramPins& pins);
  // The data pins at a time not before the last edge: what the chip drives once it is stable, else
  // noise.
  uint16_t data(int64_t time);
  // Puts a word into a cell, as if it had been written.
  void poke(unsigned bank, unsigned row, unsigned column, uint16_t data) {
    cell(bank, row, column) = data;
  }
  bool initialised() const { return initialised_; }
  uint64_t refreshes() const { return refreshes_; }
  uint64_t reads() const { return reads_; }
  // Times that the bank of the last READ was told to close its row, for another one: no data of
  // another bank can hide its PRECHARGE and the ACTIVATE after it.
  uint64_t row_changes() const { return row_changes_; }

 private:
  struct Bank {
    bool open = false;
    unsigned row = 0;
    int64_t activated = kLongAgo, precharged = kLongAgo, written = kLongAgo;
  };
  struct Beat {
    uint64_t edge;  // after which it is driven
    uint16_t data;
  };
  static constexpr int64_t kLongAgo = -(int64_t{1} << 50);
  static constexpr unsigned kNoBank = 4;

  void fail(const std::string& rule, const std::string& what) const;
  void need(int64_t since, int64_t time, const std::string& rule, const std::string& what) const;
  void activate(unsigned bank, unsigned row);
  void precharge(unsigned bank);
  void read(unsigned bank, unsigned column);
  void write(unsigned bank, unsigned column, const SdramPins& pins);
  void load_mode(unsigned mode);
  uint16_t& cell(unsigned bank, unsigned row, unsigned column);

  SdramTimes times_;
  std::vector<uint16_t> cells_;
  std::array<Bank, 4> banks_;
  int64_t now_ = kLongAgo, period_ = 0, first_edge_ = 0, last_activate_ = kLongAgo,
          last_refresh_ = kLongAgo, initialised_at_ = 0;
  uint64_t edge_ = 0, mode_edge_ = 0;
  bool started_ = false, all_precharged_ = false, mode_set_ = false, initialised_ = false,
       commanded_ = false;
  int init_refreshes_ = 0;
  uint64_t refreshes_ = 0, reads_ = 0, row_changes_ = 0;
  // When each row was refreshed last; the chip counts the rows itself.
  std::array<int64_t, 8192> row_refreshed_{};
  unsigned last_read_bank_ = kNoBank;
  unsigned burst_ = 1, latency_ = 3;
  std::deque<Beat> beats_;
  bool driving_ = false, was_driving_ = false;
  uint16_t current_ = 0, previous_ = 0;
  // Bytes of a READ that DQM masks two clocks later: nobody drives them.
  unsigned dqm_ = 3;
  uint16_t floating_ = 0, previous_floating_ = 0;
  uint64_t noise_ = 1;
};

}  // namespace photonloom
