// SPDX-License-Identifier: Apache-2.0
// The extremes suite: cases at the ends of what a unit, a named conversion or a frame can meet.
// Each case says what is right and why before it runs; reference arithmetic, golden and the RTL are
// held to that.
#pragma once
#include <exception>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "golden/image/image.hpp"
#include "golden/numeric/bits.hpp"
#include "golden/packet/layout.hpp"
#include "golden/packet/trace.hpp"
#include "golden/pipeline/prepare.hpp"
#include "golden/unit/backend.hpp"
#include "verilator_tb/unit/backends.hpp"

namespace photonloom::extremes {

struct Settings {
  bool rtl = false;   // unit cases run through the RTL too
  bool slow = false;  // cases that take more than a second
  std::string work = "build/cosim";
};

// What one case found. Checks fill it; the page shows the check that is furthest off, and of equal
// ones the first.
class Run {
 public:
  explicit Run(const Settings& settings) : settings_(settings) {}

  // An integer that is exactly so.
  template <class A, class B>
  void exact(const std::string& what, A due, B golden) {
    static_assert(std::is_integral_v<A> || std::is_same_v<A, UInt128>);
    const auto d = static_cast<Int128>(due), g = static_cast<Int128>(golden);
    add(what, to_decimal(d), to_decimal(g), d == g ? 0 : static_cast<double>(d > g ? d - g : g - d),
        0);
  }
  // A number that is `due` to within `bound`.
  void near(const std::string& what, double due, double golden, double bound);
  // Lists that are equal, value by value.
  template <class T>
  void same(const std::string& what, const std::vector<T>& due, const std::vector<T>& golden) {
    size_t wrong =
        due.size() > golden.size() ? due.size() - golden.size() : golden.size() - due.size();
    for (size_t i = 0; i < std::min(due.size(), golden.size()); ++i) wrong += due[i] != golden[i];
    add(what, std::to_string(due.size()) + " values", wrong ? "others" : "the same",
        static_cast<double>(wrong), 0);
  }
  void holds(const std::string& what, bool golden) {
    add(what, "yes", golden ? "yes" : "no", golden ? 0 : 1, 0);
  }
  // What a counter or a flag says. A case that is `saturation, counted` has such a check, and one
  // whose number is not 0.
  template <class A, class B>
  void counted(const std::string& what, A due, B golden) {
    reads_counter_ |= due > 0;
    showing_ = due > 0;
    exact(what, due, golden);
    showing_ = false;
  }
  // A counter whose number is of randomness: it is not 0.
  template <class B>
  void counted_some(const std::string& what, B golden) {
    reads_counter_ = showing_ = true;
    add(what, "more than 0", std::to_string(golden), golden > 0 ? 0 : 1, 0);
    showing_ = false;
  }
  // An error whose text has these words.
  void refused(const std::string& words, const std::function<void()>& f);

  // Golden's packets for these, and the RTL's beside them where it runs.
  template <class Unit>
  std::vector<typename Unit::FirstOut> process(const Plan& plan,
                                               const std::vector<typename Unit::In>& in) {
    const std::type_identity<Unit> unit;
    std::vector<typename Unit::FirstOut> due;
    make_golden(unit, plan)->process(in, due);
    asked_ = true;
    offered_ = true;
    if (settings_.rtl) {
      hardware([&] {
        const auto rtl = make_rtl(unit, plan, options());
        std::vector<typename Unit::FirstOut> out;
        rtl->process(in, out);
        rtl->finish();
        compare(plan, due, out);
      });
    }
    return due;
  }

  struct Gathered {
    PhotonMap map;
    std::vector<GatherResult> results;
    std::vector<GatherPhoton> photons;
  };
  // The gatherer on a global map of these photons.
  Gathered gather(const Plan& plan, std::span<const PackedPhoton> photons,
                  const std::vector<GatherQuery>& queries);

  // A golden frame of the scene, with what it counted.
  struct Rendered {
    Image image;
    FrameCounts counts;
    Plan plan;
    PackCounts packed;
    uint64_t photons = 0, paths = 0;
  };
  // `rtl`: with all units of the plan as RTL too, where it runs; images and counts must be equal.
  Rendered frame(const Scene& scene, const FrameRequest& request, bool rtl = false,
                 Arithmetic arithmetic = Arithmetic::kGolden);

  bool held() const { return failed_ == 0 && checks_ > 0 && differences_ == 0; }
  bool ran_rtl() const { return ran_rtl_; }
  bool reads_counter() const { return reads_counter_; }
  // Whether units had packets that no RTL is asked to answer too.
  bool leaves_out_rtl() const { return asked_ && !offered_; }
  uint64_t checks() const { return checks_; }
  uint64_t rtl_packets() const { return rtl_packets_; }
  uint64_t differences() const { return differences_; }
  const std::string& first_difference() const { return first_difference_; }
  // Of the check that is shown.
  const std::string& what() const { return what_; }
  const std::string& due() const { return due_; }
  const std::string& golden() const { return golden_; }
  std::string error() const;

 private:
  void add(const std::string& what, const std::string& due, const std::string& golden, double error,
           double bound);
  void hardware(const std::function<void()>& f);
  RunOptions options() const;
  void differ(const std::string& what) {
    if (differences_++ == 0) first_difference_ = what;
  }
  template <class P>
  void compare(const Plan& plan, const std::vector<P>& due, const std::vector<P>& out) {
    rtl_packets_ += due.size();
    if (due.size() != out.size())
      differ(std::to_string(out.size()) + " packets, golden has " + std::to_string(due.size()));
    const PacketLayout layout = PacketLayout::of<P>(plan);
    for (size_t i = 0; i < std::min(due.size(), out.size()); ++i)
      if (due[i] != out[i])
        differ("packet " + std::to_string(i) + ": golden " + packet_to_json(layout, &due[i]) +
               ", RTL " + packet_to_json(layout, &out[i]));
  }

  const Settings& settings_;
  uint64_t checks_ = 0, failed_ = 0;
  double worst_ = -1, worst_error_ = 0, worst_bound_ = 0;
  std::string what_, due_, golden_;
  bool ran_rtl_ = false, reads_counter_ = false, showing_ = false, shows_counter_ = false;
  bool asked_ = false, offered_ = false;
  uint64_t rtl_packets_ = 0, differences_ = 0;
  std::string first_difference_;
};

// How it is known what is right.
enum class Known { kClosedForm, kDefinition, kReference, kSaturation, kRefusal };

struct Case {
  std::string name;
  Known known;
  std::string right;  // what is right, and why
  std::function<void(Run&)> run;
  bool slow = false;
  std::string no_rtl = "";  // why no RTL answers the packets of this case
};

struct Group {
  std::string name;  // of a unit; "conversions" and "frame"
  std::string about;
  std::vector<Case> cases;
};

Group gatherer_cases();
Group reorder_cases();
Group sampler_cases();
Group cache_cases();
Group conversion_cases();
Group frame_cases();

}  // namespace photonloom::extremes
