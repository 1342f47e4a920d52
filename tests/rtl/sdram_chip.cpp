// SPDX-License-Identifier: Apache-2.0
// The behavioural SDRAM keeps what was written, answers in time, and finds every rule broken.
#include "verilator_tb/chip/sdram_chip.hpp"

#include <functional>

#include "tests/catch.hpp"

using namespace photonloom;

namespace {

constexpr int64_t kClock = 10'000;

// Commands at edges of a 100 MHz clock; idle(n) lets n edges pass.
class Driver {
 public:
  explicit Driver(const SdramTimes& times = {}) : chip(times) {}

  void command(bool ras_n, bool cas_n, bool we_n, unsigned bank, unsigned address,
               bool driven = false, uint16_t data = 0, unsigned dqm = 0) {
    SdramPins pins;
    pins.cke = true;
    pins.cs_n = false;
    pins.ras_n = ras_n;
    pins.cas_n = cas_n;
    pins.we_n = we_n;
    pins.bank = bank;
    pins.address = address;
    pins.dqm = dqm;
    pins.driven = driven;
    pins.data = data;
    chip.edge(time += kClock, pins);
  }
  void idle(int n = 1) {
    for (int i = 0; i < n; ++i) command(true, true, true, 0, 0);
  }
  void active(unsigned bank, unsigned row) { command(false, true, true, bank, row); }
  void read(unsigned bank, unsigned column) { command(true, false, true, bank, column); }
  void write(unsigned bank, unsigned column, uint16_t data, unsigned dqm = 0) {
    command(true, false, false, bank, column, true, data, dqm);
  }
  void precharge(unsigned bank) { command(false, true, false, bank, 0); }
  void precharge_all() { command(false, true, false, 0, 0x400); }
  void refresh() { command(false, false, true, 0, 0); }
  void mode(unsigned word = 0x233) { command(false, false, false, 0, word); }
  void power_up() { idle(10'001); }
  void initialise() {
    power_up();
    precharge_all();
    idle(3);
    for (int i = 0; i < 2; ++i) {
      refresh();
      idle(7);
    }
    mode();
    idle(1);
  }

  SdramChip chip;
  int64_t time = 0;
};

std::string broken(const std::function<void(Driver&)>& sequence, const SdramTimes& times = {}) {
  Driver d(times);
  try {
    sequence(d);
  } catch (const SdramError& error) {
    return error.rule;
  }
  return "none";
}

// The same on an initialised chip.
std::string broken_later(const std::function<void(Driver&)>& sequence,
                         const SdramTimes& times = {}) {
  return broken(
      [&](Driver& d) {
        d.initialise();
        sequence(d);
      },
      times);
}

}  // namespace

TEST_CASE("what is written comes back, in bursts of 8, three clocks after READ") {
  Driver d;
  d.initialise();
  CHECK(d.chip.initialised());
  d.active(2, 77);
  d.idle(2);
  for (unsigned i = 0; i < 8; ++i) d.write(2, 40 + i, static_cast<uint16_t>(0x1000 + 0x111 * i));
  d.write(2, 41, 0xffff, 2);  // low byte alone
  d.read(2, 42);
  d.idle(1);
  for (unsigned i = 0; i < 8; ++i) {
    d.idle(1);  // the clock after which beat i is driven
    const unsigned place = 40 + (2 + i) % 8;
    const uint16_t expected =
        place == 41 ? 0x11ff : static_cast<uint16_t>(0x1000 + 0x111 * (place - 40));
    CHECK(d.chip.data(d.time + 5'400) == expected);
    CHECK(d.chip.data(d.time + 9'999) == expected);
    if (i == 0) CHECK(d.chip.data(d.time + 5'399) != d.chip.data(d.time + 5'398));
    // It stays for a while after the next clock.
    if (i == 7) {
      d.idle(1);
      CHECK(d.chip.data(d.time + 2'500) == expected);
      CHECK(d.chip.data(d.time + 2'501) != d.chip.data(d.time + 2'502));
    }
  }
}

TEST_CASE("DQM masks bytes of a READ two clocks later") {
  Driver d;
  d.initialise();
  d.active(0, 1);
  d.idle(2);
  for (unsigned i = 0; i < 8; ++i) d.write(0, i, static_cast<uint16_t>(0x1100 + i));
  d.read(0, 0);
  d.idle(1);
  d.command(true, true, true, 0, 0, false, 0, 2);  // after this edge beat 0 is driven
  d.idle(1);
  // Beat 1, its high byte masked: noise.
  CHECK((d.chip.data(d.time + 6'000) & 0xff) == 1);
  bool noise = false;
  for (int i = 0; i < 8; ++i) noise |= d.chip.data(d.time + 6'000 + i) >> 8 != 0x11;
  CHECK(noise);
  d.idle(1);
  CHECK(d.chip.data(d.time + 6'000) == 0x1102);
}

TEST_CASE("a READ takes over from the one before without a gap") {
  Driver d;
  d.initialise();
  d.active(0, 1);
  d.idle(1);
  d.active(1, 2);
  d.idle(2);
  d.write(0, 0, 7);
  d.write(1, 8, 9);
  d.read(0, 0);
  d.idle(7);
  d.read(1, 8);
  d.idle(2);
  CHECK(d.chip.data(d.time + 6'000) == 9);
}

TEST_CASE("row changes are those of the bank that was read last, alone") {
  Driver d;
  d.initialise();
  for (unsigned bank : {0u, 1u}) d.active(bank, 1), d.idle(4);
  d.precharge(0);  // nothing was read
  d.idle(2);
  d.active(0, 2);
  d.idle(4);
  d.read(0, 0);
  d.idle(7);
  CHECK(d.chip.row_changes() == 0);
  d.precharge(0);  // at once: tRP and tRCD nobody can hide
  d.idle(2);
  d.active(0, 3);
  d.idle(4);
  CHECK(d.chip.row_changes() == 1);
  d.read(1, 0);
  d.precharge(0);  // beside the data of bank 1
  d.idle(7);
  CHECK(d.chip.row_changes() == 1);
  d.precharge_all();  // a refresh's
  CHECK(d.chip.row_changes() == 1);
}

TEST_CASE("a legal sequence breaks nothing, each rule broken is named") {
  CHECK(broken_later([](Driver& d) {
          d.active(0, 0);
          d.idle(2);
          d.write(0, 0, 1);
          d.idle(2);
          d.precharge(0);
          d.idle(2);
          d.refresh();
          d.idle(6);
          d.active(0, 0);
          d.idle(1);
          d.active(1, 0);
          d.idle(4);
          d.read(0, 0);
          d.idle(10);
          d.precharge_all();
        }) == "none");

  CHECK(broken([](Driver& d) {
          d.idle(100);
          d.precharge_all();
        }) == "power up");
  CHECK(broken([](Driver& d) {
          d.power_up();
          d.refresh();
        }) == "initialisation");
  CHECK(broken([](Driver& d) {
          d.power_up();
          d.precharge_all();
          d.idle(3);
          d.refresh();
          d.idle(7);
          d.mode();
          d.idle(7);
          d.active(0, 0);
        }) == "initialisation");
  CHECK(broken([](Driver& d) {
          d.power_up();
          d.precharge_all();
          d.idle(3);
          d.refresh();
          d.idle(3);
          d.refresh();
        }) == "tRFC");
  CHECK(broken_later([](Driver& d) { d.mode(), d.active(0, 0); }) == "tMRD");
  CHECK(broken_later([](Driver& d) { d.mode(0x230), d.idle(2); }, {}) == "none");
  CHECK(broken_later([](Driver& d) { d.mode(0x33); }) == "LOAD MODE");
  CHECK(broken_later([](Driver& d) { d.mode(0x243); }) == "LOAD MODE");
  CHECK(broken_later([](Driver& d) { d.mode(0x237); }) == "LOAD MODE");
  CHECK(broken_later([](Driver& d) { d.active(0, 0), d.idle(1), d.read(0, 0); }) == "tRCD");
  CHECK(broken_later([](Driver& d) { d.active(0, 0), d.idle(1), d.write(0, 0, 0); }) == "tRCD");
  CHECK(broken_later([](Driver& d) { d.active(0, 0), d.idle(3), d.precharge(0); }) == "tRAS");
  CHECK(broken_later([](Driver& d) { d.active(0, 0), d.active(1, 0); }) == "tRRD");
  CHECK(broken_later([](Driver& d) { d.active(0, 0), d.idle(9), d.active(0, 1); }) == "ACTIVE");
  CHECK(broken_later([](Driver& d) {
          d.active(0, 0), d.idle(9), d.precharge(0), d.idle(1), d.active(0, 1);
        }) == "tRP");
  SdramTimes slow_row;
  slow_row.row_cycle = 90'000;
  CHECK(broken_later(
            [](Driver& d) { d.active(0, 0), d.idle(4), d.precharge(0), d.idle(2), d.active(0, 1); },
            slow_row) == "tRC");
  CHECK(broken_later([](Driver& d) {
          d.active(0, 0), d.idle(9), d.write(0, 0, 0), d.precharge(0);
        }) == "tWR");
  CHECK(broken_later([](Driver& d) { d.refresh(), d.idle(5), d.active(0, 0); }) == "tRFC");
  CHECK(broken_later([](Driver& d) { d.active(0, 0), d.idle(9), d.refresh(); }) == "AUTO REFRESH");
  CHECK(broken_later([](Driver& d) {
          d.active(0, 0), d.idle(9), d.precharge(0), d.idle(1), d.refresh();
        }) == "tRP");
  CHECK(broken_later([](Driver& d) { d.read(3, 0); }) == "READ");
  CHECK(broken_later([](Driver& d) { d.write(3, 0, 0); }) == "WRITE");
  CHECK(broken_later([](Driver& d) {
          d.active(0, 0), d.idle(9), d.command(true, false, false, 0, 0);
        }) == "WRITE");
  CHECK(broken_later([](Driver& d) {
          d.active(0, 0), d.idle(9), d.read(0, 0), d.idle(3), d.write(0, 0, 0);
        }) == "WRITE");
  CHECK(broken_later([](Driver& d) {
          d.active(0, 0), d.idle(9), d.read(0, 0), d.idle(3);
          d.command(true, true, true, 0, 0, true, 1);
        }) == "data pins");
  CHECK(broken_later([](Driver& d) { d.active(0, 0), d.idle(9), d.read(0, 0x400); }) ==
        "auto precharge");
  CHECK(broken_later([](Driver& d) { d.command(true, true, false, 0, 0); }) == "BURST TERMINATE");
  CHECK(broken_later([](Driver& d) { d.idle(1600); }) == "refresh");

  // Refreshes that fall due in the mean do not keep a row that waits too long for its next one.
  for (const bool late : {false, true}) {
    SdramTimes times;
    times.refresh_every = times.row_refresh;
    times.row_refresh = 8192 * 10 * kClock;
    Driver d(times);
    d.initialise();
    const auto rows = [&] {
      for (int i = 0; i < 8192; ++i) d.refresh(), d.idle(9);
    };
    rows();
    if (late) {
      d.idle();
      CHECK_THROWS_AS(d.refresh(), SdramError);
    } else {
      rows();
    }
  }
  SdramTimes short_row;
  short_row.row_active_most = 5'000'000;
  CHECK(broken_later([](Driver& d) { d.active(0, 0), d.idle(600), d.precharge(0); }, short_row) ==
        "tRAS max");
  SdramTimes slow_clock;
  slow_clock.clock_3 = 10'001;
  CHECK(broken_later([](Driver&) {}, slow_clock) == "tCK");
  CHECK(broken_later([](Driver& d) { d.chip.edge(d.time + kClock, SdramPins{}); }) == "CKE");
  CHECK(broken([](Driver& d) {
          d.power_up();
          d.precharge_all();
          d.idle(3);
          d.command(false, false, false, 1, 0x233);
        }) == "LOAD MODE");
  CHECK(broken([](Driver& d) {
          d.power_up();
          SdramPins pins;
          pins.cs_n = pins.ras_n = pins.we_n = false;
          d.chip.edge(d.time + kClock, pins);
        }) == "CKE");
}
