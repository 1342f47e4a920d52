// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/chip/sdram_chip.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "golden/numeric/random.hpp"

namespace photonloom {

SdramError::SdramError(const std::string& rule_name, int64_t time, const std::string& what)
    : std::runtime_error(fmt::format("SDRAM, {:.1f} ns: {}: {}", static_cast<double>(time) / 1000,
                                     rule_name, what)),
      rule(rule_name) {}

SdramChip::SdramChip(const SdramTimes& times) : times_(times), cells_(size_t{4} * 8192 * 512, 0) {}

void SdramChip::fail(const std::string& rule, const std::string& what) const {
  throw SdramError(rule, now_, what);
}

void SdramChip::need(int64_t since, int64_t time, const std::string& rule,
                     const std::string& what) const {
  if (now_ - since < time)
    fail(rule,
         fmt::format("{} after {:.1f} ns, expected {:.1f} ns", what,
                     static_cast<double>(now_ - since) / 1000, static_cast<double>(time) / 1000));
}

uint16_t& SdramChip::cell(unsigned bank, unsigned row, unsigned column) {
  return cells_[(static_cast<size_t>(bank) * 8192 + row) * 512 + column];
}

void SdramChip::activate(unsigned bank, unsigned row) {
  Bank& b = banks_[bank];
  if (!initialised_) fail("initialisation", "ACTIVE before it is complete");
  if (b.open) fail("ACTIVE", fmt::format("bank {} is open already", bank));
  need(b.precharged, times_.precharge, "tRP", fmt::format("ACTIVE of bank {}", bank));
  need(b.activated, times_.row_cycle, "tRC", fmt::format("ACTIVE of bank {}", bank));
  need(last_activate_, times_.row_to_row, "tRRD", fmt::format("ACTIVE of bank {}", bank));
  need(last_refresh_, times_.refresh, "tRFC", fmt::format("ACTIVE of bank {}", bank));
  b.open = true;
  b.row = row;
  b.activated = last_activate_ = now_;
}

void SdramChip::precharge(unsigned bank) {
  Bank& b = banks_[bank];
  if (!b.open) return;
  need(b.activated, times_.row_active, "tRAS", fmt::format("PRECHARGE of bank {}", bank));
  if (now_ - b.activated > times_.row_active_most)
    fail("tRAS max", fmt::format("bank {} was open too long", bank));
  need(b.written, times_.write_recovery, "tWR", fmt::format("PRECHARGE of bank {}", bank));
  b.open = false;
  b.precharged = now_;
}

void SdramChip::read(unsigned bank, unsigned column) {
  Bank& b = banks_[bank];
  if (!b.open) fail("READ", fmt::format("bank {} has no open row", bank));
  need(b.activated, times_.row_to_column, "tRCD", fmt::format("READ of bank {}", bank));
  // A READ takes the place of what is left of the one before.
  const uint64_t first = edge_ + latency_ - 1;
  while (!beats_.empty() && beats_.back().edge >= first) beats_.pop_back();
  for (unsigned i = 0; i < burst_; ++i) {
    const unsigned place = (column & ~(burst_ - 1)) | ((column + i) & (burst_ - 1));
    beats_.push_back({first + i, cell(bank, b.row, place)});
  }
  ++reads_;
  last_read_bank_ = bank;
}

void SdramChip::write(unsigned bank, unsigned column, const SdramPins& pins) {
  Bank& b = banks_[bank];
  if (!b.open) fail("WRITE", fmt::format("bank {} has no open row", bank));
  need(b.activated, times_.row_to_column, "tRCD", fmt::format("WRITE of bank {}", bank));
  if (!pins.driven) fail("WRITE", "nobody drives the data pins");
  uint16_t& c = cell(bank, b.row, column);
  if (!(pins.dqm & 1)) c = static_cast<uint16_t>((c & 0xff00) | (pins.data & 0x00ff));
  if (!(pins.dqm & 2)) c = static_cast<uint16_t>((c & 0x00ff) | (pins.data & 0xff00));
  b.written = now_;
  last_read_bank_ = kNoBank;
}

void SdramChip::load_mode(unsigned mode) {
  const unsigned length = mode & 7;
  latency_ = mode >> 4 & 7;
  if (length > 3 || mode & 8) fail("LOAD MODE", "only sequential bursts of 1 to 8 are modelled");
  if (latency_ != 2 && latency_ != 3) fail("LOAD MODE", "CAS latency is neither 2 nor 3");
  if (!(mode & 0x200)) fail("LOAD MODE", "only writes of single words are modelled");
  if (mode & 0x1d80) fail("LOAD MODE", "reserved bits are set");
  burst_ = 1u << length;
  mode_set_ = true;
  mode_edge_ = edge_;
}

void SdramChip::edge(int64_t time, const SdramPins& pins) {
  if (started_) {
    period_ = time - now_;
    if (period_ <= 0) throw std::logic_error("SDRAM: edges out of order");
  } else {
    first_edge_ = time;
    started_ = true;
  }
  now_ = time;
  ++edge_;
  if (mode_set_ && period_ < (latency_ == 2 ? times_.clock_2 : times_.clock_3))
    fail("tCK", fmt::format("clock of {:.2f} ns with CAS latency {}",
                            static_cast<double>(period_) / 1000, latency_));

  // What is driven from this edge on.
  was_driving_ = driving_;
  previous_ = current_;
  previous_floating_ = floating_;
  floating_ = static_cast<uint16_t>((dqm_ & 1 ? 0x00ff : 0) | (dqm_ & 2 ? 0xff00 : 0));
  dqm_ = pins.dqm;
  driving_ = !beats_.empty() && beats_.front().edge == edge_;
  if (driving_) {
    current_ = beats_.front().data;
    beats_.pop_front();
  }

  if (initialised_) {
    const int64_t due = (now_ - initialised_at_) / times_.refresh_every;
    if (due > static_cast<int64_t>(refreshes_) + 1)
      fail("refresh", fmt::format("{} were due, {} came", due, refreshes_));
  }

  const unsigned command =
      pins.cs_n ? 7u : (pins.ras_n ? 4u : 0u) | (pins.cas_n ? 2u : 0u) | (pins.we_n ? 1u : 0u);
  if (!pins.cke && (command != 7 || commanded_))
    fail("CKE", command != 7 ? "a command while it is low" : "power down is not modelled");
  if (command != 7) {
    commanded_ = true;
    if (now_ - first_edge_ < times_.power_up)
      fail("power up", "a command before the pause is over");
    if (mode_set_ && edge_ - mode_edge_ < static_cast<uint64_t>(times_.mode_clocks))
      fail("tMRD", "a command right after LOAD MODE REGISTER");
  }
  switch (command) {
    case 7:  // NOP
      break;
    case 3:
      activate(pins.bank, pins.address);
      break;
    case 5:
    case 4:
      if (pins.address & 0x400) fail("auto precharge", "is not modelled");
      if (command == 5) {
        read(pins.bank, pins.address & 511);
      } else {
        // The chip's own data end with this edge at the latest.
        if (driving_ || was_driving_) fail("WRITE", "the chip still drives the data pins");
        beats_.clear();
        write(pins.bank, pins.address & 511, pins);
      }
      break;
    case 2:
      if (pins.address & 0x400) {
        for (unsigned b = 0; b < 4; ++b) precharge(b);
        all_precharged_ = true;
        last_read_bank_ = kNoBank;
      } else {
        if (pins.bank == last_read_bank_) {
          ++row_changes_;
          last_read_bank_ = kNoBank;
        }
        precharge(pins.bank);
      }
      break;
    case 1:
    case 0: {
      const char* name = command == 1 ? "AUTO REFRESH" : "LOAD MODE";
      if (!all_precharged_) fail("initialisation", fmt::format("{} before PRECHARGE ALL", name));
      for (const Bank& b : banks_) {
        if (b.open) fail(name, "a bank is open");
        need(b.precharged, times_.precharge, "tRP", name);
      }
      need(last_refresh_, times_.refresh, "tRFC", name);
      if (command == 1) {
        last_refresh_ = now_;
        if (initialised_) {
          int64_t& row = row_refreshed_[refreshes_ % row_refreshed_.size()];
          if (now_ - std::max(row, initialised_at_) > times_.row_refresh)
            fail("refresh",
                 fmt::format("of row {} after {:.3f} ms, expected {:.3f} ms",
                             refreshes_ % row_refreshed_.size(),
                             static_cast<double>(now_ - std::max(row, initialised_at_)) / 1e9,
                             static_cast<double>(times_.row_refresh) / 1e9));
          row = now_;
          ++refreshes_;
        } else
          ++init_refreshes_;
      } else {
        if (pins.bank) fail("LOAD MODE", "reserved bits are set");
        load_mode(pins.address);
      }
      break;
    }
    default:
      fail("BURST TERMINATE", "is not modelled");
  }
  if (pins.driven && driving_) fail("data pins", "both sides drive them");
  if (!initialised_ && mode_set_ && init_refreshes_ >= times_.init_refreshes) {
    initialised_ = true;
    initialised_at_ = now_;
  }
}

uint16_t SdramChip::data(int64_t time) {
  const int64_t access = latency_ == 2 ? times_.access_2 : times_.access_3;
  noise_ = mix64(noise_ + static_cast<uint64_t>(time));
  const auto seen = [this](uint16_t driven, uint16_t floating) {
    return static_cast<uint16_t>((driven & ~floating) | (noise_ & floating));
  };
  if (driving_ && time - now_ >= access) return seen(current_, floating_);
  if (was_driving_ && time - now_ <= times_.hold) return seen(previous_, previous_floating_);
  return static_cast<uint16_t>(noise_);
}

}  // namespace photonloom
