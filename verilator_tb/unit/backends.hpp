// SPDX-License-Identifier: Apache-2.0
// Units as RTL, or what was made of it (RunOptions::kind), behind golden/unit/backend.hpp, and what
// a run of them tells beyond packets.
#pragma once
#include <memory>
#include <string>

#include "golden/unit/backend.hpp"
#include "verilator_tb/rig/clocked.hpp"
#include "verilator_tb/rig/rig.hpp"

namespace photonloom {

template <class Unit>
class ClockedUnit : public Unit, public Clocked {};

// Of each unit: ClockedInterface; make_rtl_NAME, which verilator_tb/unit/NAME.cpp defines; and the
// same by type.
#define PHOTONLOOM_MAKE_RTL(Interface, name, ...)                                              \
  using Clocked##Interface = ClockedUnit<Interface>;                                           \
  std::unique_ptr<Clocked##Interface> make_rtl_##name(const Plan&, const RunOptions& options); \
  inline std::unique_ptr<Clocked##Interface> make_rtl(                                         \
      std::type_identity<Interface>, const Plan& plan, const RunOptions& options) {            \
    return make_rtl_##name(plan, options);                                                     \
  }
PHOTONLOOM_UNITS(PHOTONLOOM_MAKE_RTL)
#undef PHOTONLOOM_MAKE_RTL

// All gatherers of the plan's board on its photon memory, with the behavioural SDRAM where that is
// one. With `reordered` queries pass the reorder buffer: results come in its order, and process()
// gives those that are due, which are as many as golden's buffer has let go. With `back_door` lines
// are put into the SDRAM's cells, not written through its controller.
std::unique_ptr<ClockedPhotonGatherer> make_rtl_gather_engine(const Plan& plan,
                                                              const RunOptions& options,
                                                              bool reordered,
                                                              bool back_door = false);

}  // namespace photonloom
