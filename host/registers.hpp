// SPDX-License-Identifier: Apache-2.0
// The board's address space as docs/host-link.md lists it; a test holds the two to one another.
#pragma once
#include <cstdint>
#include <span>

namespace photonloom {

constexpr uint32_t kLinkMagic = 0x4D4C4850, kLinkVersion = 1;

// Bit 28 and up of an address.
enum class LinkSpace : uint32_t { kRegisters = 0, kConfiguration, kPhotonLines, kReplayQueries };

constexpr uint32_t link_address(LinkSpace space, uint64_t word) {
  return static_cast<uint32_t>(space) << 28 | static_cast<uint32_t>(word);
}

enum LinkRegister : uint32_t {
  kRegMagic = 0,
  kRegVersion = 1,
  kRegPlanHash = 2,  // two words, as those below that leave a gap
  kRegSession = 4,
  kRegGatherers = 5,
  kRegRxBytes = 6,
  kRegInputRoom = 7,
  kRegInputPosition = 8,
  kRegOutputFirst = 9,
  kRegOutputEnd = 10,
  kRegClockKhz = 11,
  kRegFlags = 12,
  kRegFramesBad = 13,
  kRegBytesLost = 14,
  kRegReplayControl = 16,
  kRegReplayQueries = 17,
  kRegReplayPasses = 18,
  kRegReplayMode = 19,
  kRegReplayCycles = 20,
  kRegReplaySignature = 22,
  kRegReplayResults = 24,
  kRegSelfTest = 26,
  kRegFaults = 27,
  kRegCounters = 32,
};

// Bits of kRegFlags and kRegReplayMode.
constexpr uint32_t kFlagQueriesInside = 1, kFlagMemoryReady = 2, kFlagReplayBusy = 4;
constexpr uint32_t kReplayReordered = 1, kReplayCold = 2;

// Of kRegSelfTest.
enum SelfTestState : uint32_t { kTestNone, kTestRunning, kTestPassed, kTestFailed };

// Names of the 64-bit counters from kRegCounters on, in order.
std::span<const char* const> link_counter_names();

}  // namespace photonloom
