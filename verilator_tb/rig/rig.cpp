// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/rig/rig.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <utility>

namespace photonloom {

namespace {

uint64_t read_port(const ModelPort& p) {
  uint64_t value = 0;
  std::memcpy(&value, p.data, std::min<size_t>(p.bytes, 8));
  return value;
}

void write_port(const ModelPort& p, uint64_t value) {
  std::memset(p.data, 0, p.bytes);
  std::memcpy(p.data, &value, std::min<size_t>(p.bytes, 8));
}

// Storage of a packet's port must be what its layout says, or C++ and RTL disagree on the packet.
void check_width(const ModelPort& p, int bits, const std::string& unit) {
  const size_t words = (static_cast<size_t>(bits) + 31) / 32;
  const size_t expected = bits <= 8 ? 1 : bits <= 16 ? 2 : 4 * words;
  if (p.bytes != expected)
    throw RigError(unit, fmt::format(", port {}: is {} bytes wide, its packet of {} bits takes {}",
                                     p.name, p.bytes, bits, expected));
}

}  // namespace

Source::Source(Model& model, const std::string& name, int bits, const RunOptions& options,
               const std::string& unit)
    : name_(name),
      valid_(model.port(name + "_valid_i")),
      ready_(model.port(name + "_ready_o")),
      data_(model.port(name + "_i")),
      stall_(options.stall_in, options.seed, unit + "." + name),
      random_(options.seed, unit + "." + name + ".idle payload"),
      timeline_(options.timeline),
      stride_(std::max<size_t>(1, (static_cast<size_t>(bits) + 31) / 32)) {
  check_width(data_, bits, unit);
  *valid_.data = 0;
  // Random idle payload may not set bits beyond the port's width.
  mask_.assign(stride_, ~0u);
  if (bits % 32) mask_.back() = (1u << (bits % 32)) - 1;
  scramble();
}

void Source::push(const uint32_t* words) {
  if (empty()) {
    queue_.clear();
    next_ = 0;
  }
  queue_.insert(queue_.end(), words, words + stride_);
}

void Source::scramble() {
  uint32_t noise[2] = {0, 0};
  for (size_t w = 0; 4 * w < data_.bytes; ++w) {
    noise[0] = static_cast<uint32_t>(random_.bits()) & mask_[w];
    std::memcpy(data_.data + 4 * w, noise, std::min<size_t>(4, data_.bytes - 4 * w));
  }
}

void Source::drive() {
  if (!offering_ && !empty() && !stall_.holds_source(was_ready_)) {
    offering_ = true;
    std::memcpy(data_.data, queue_.data() + next_ * stride_, data_.bytes);
    *valid_.data = 1;
  }
}

bool Source::sample(uint64_t cycle) {
  was_ready_ = *ready_.data != 0;
  if (!offering_) return false;
  if (!was_ready_) {
    ++stalled_;
    return false;
  }
  ++accepted_;
  ++next_;
  offering_ = false;
  if (timeline_) cycles_.push_back(cycle);
  return true;
}

void Source::after_edge() {
  if (offering_ || *valid_.data == 0) return;
  *valid_.data = 0;
  scramble();
}

void Source::restart() {
  queue_.clear();
  next_ = 0;
  offering_ = was_ready_ = false;
  accepted_ = stalled_ = 0;
  cycles_.clear();
  *valid_.data = 0;
  scramble();
}

std::vector<uint64_t> Source::take_cycles() {
  std::vector<uint64_t> taken;
  taken.swap(cycles_);
  return taken;
}

std::string Source::state() const {
  return fmt::format("{}: valid {} ready {}, {} accepted, {} waiting to go in", name_,
                     offering_ ? 1 : 0, was_ready_ ? 1 : 0, accepted_,
                     queue_.size() / stride_ - next_);
}

Taker::Taker(Model& model, const std::string& name, int bits, const RunOptions& options,
             const std::string& unit)
    : name_(name),
      unit_(unit),
      valid_(model.port(name + "_valid_o")),
      ready_(model.port(name + "_ready_i")),
      data_(model.port(name + "_o")),
      stall_(options.stall_out, options.seed, unit + "." + name),
      stride_(std::max<size_t>(1, (static_cast<size_t>(bits) + 31) / 32)),
      held_(stride_),
      pause_(name == "photon" ? options.photon_pause : 0) {
  check_width(data_, bits, unit);
  *ready_.data = 0;
}

void Taker::drive() {
  const bool paused = pause_ && driven_++ % (pause_ + pause_ / 4) < pause_;
  *ready_.data = stall_.holds_taker(was_valid_) || paused ? 0 : 1;
}

bool Taker::sample(uint64_t cycle) {
  was_valid_ = *valid_.data != 0;
  if (holding_) {
    if (!was_valid_)
      throw RigError(unit_,
                     fmt::format(", stream {}, packet {}, cycle {}: valid was withdrawn "
                                 "before the packet was taken",
                                 name_, taken_, cycle),
                     cycle);
    if (std::memcmp(held_.data(), data_.data, data_.bytes) != 0)
      throw RigError(unit_,
                     fmt::format(", stream {}, packet {}, cycle {}: the packet changed "
                                 "before it was taken",
                                 name_, taken_, cycle),
                     cycle);
  }
  holding_ = false;
  if (!was_valid_) return false;
  if (*ready_.data == 0) {
    ++stalled_;
    holding_ = true;
    std::memcpy(held_.data(), data_.data, data_.bytes);
    return false;
  }
  if (first_ == cycles_.size()) {
    words_.clear();
    cycles_.clear();
    first_ = 0;
  }
  words_.resize(words_.size() + stride_);
  std::memcpy(words_.data() + words_.size() - stride_, data_.data, data_.bytes);
  cycles_.push_back(cycle);
  ++taken_;
  return true;
}

void Taker::pop() { ++first_; }

void Taker::restart() {
  words_.clear();
  cycles_.clear();
  first_ = 0;
  was_valid_ = holding_ = false;
  taken_ = stalled_ = 0;
  *ready_.data = 0;
}

std::string Taker::state() const {
  return fmt::format("{}: valid {} ready {}, {} taken", name_, was_valid_ ? 1 : 0,
                     *ready_.data ? 1 : 0, taken_);
}

LineMemory::LineMemory(Model& model, const Plan& plan, const RunOptions& options,
                       const std::string& unit)
    : unit_(unit),
      req_valid_(model.port("line_req_valid_o")),
      req_ready_(model.port("line_req_ready_i")),
      req_addr_(model.port("line_req_addr_o")),
      req_tag_(model.port("line_req_tag_o")),
      rsp_valid_(model.port("line_rsp_valid_i")),
      rsp_tag_(model.port("line_rsp_tag_i")),
      rsp_data_(model.port("line_rsp_data_i")),
      stall_req_(options.stall_memory, options.seed, unit + ".line_req"),
      stall_rsp_(options.stall_memory, options.seed, unit + ".line_rsp"),
      random_(options.seed, unit + ".latency"),
      latency_(std::max(1, options.latency)),
      random_latency_(options.random_latency),
      bank_cycles_(options.bank_cycles),
      line_bits_(plan.line_address_bits()),
      faults_(options.faults),
      line_bytes_(static_cast<size_t>(plan.bucket) * static_cast<size_t>(plan.photon_bytes)),
      // The port has a bit more with parity, and whole words.
      beat_bytes_(static_cast<size_t>(plan.beat_bits) / 8),
      bank_free_(static_cast<size_t>(std::max(1, options.banks)), 0) {
  if (rsp_data_.bytes < beat_bytes_ || rsp_data_.bytes >= beat_bytes_ + sizeof(uint64_t))
    throw RigError(unit,
                   fmt::format(": its line port has {} bytes, expected the {} of the plan's beats",
                               rsp_data_.bytes, beat_bytes_),
                   0);
  *req_ready_.data = 0;
  *rsp_valid_.data = 0;
}

void LineMemory::drive(uint64_t cycle) {
  *req_ready_.data = stall_req_.holds_taker(was_valid_) ? 0 : 1;
  beat_now_ = false;
  if (!in_line_) {
    size_t best = pending_.size();
    for (size_t i = 0; i < pending_.size(); ++i)
      if (pending_[i].ready_at <= cycle &&
          (best == pending_.size() || pending_[i].ready_at < pending_[best].ready_at))
        best = i;
    if (best < pending_.size()) {
      in_line_ = true;
      sending_ = best;
      beat_ = 0;
    }
  }
  // Nobody may refuse a reply, so the adversary treats the requester as always ready.
  if (in_line_ && !stall_rsp_.holds_source(true)) {
    beat_now_ = true;
    const Request& r = pending_[sending_];
    const size_t bytes = std::min(beat_bytes_, line_bytes_ - beat_ * beat_bytes_);
    std::memset(rsp_data_.data, 0, rsp_data_.bytes);
    std::memcpy(rsp_data_.data, r.data + beat_ * beat_bytes_, bytes);
    if (beat_ >= r.bad_from && beat_ < r.bad_to) {
      for (size_t i = 0; i < bytes; ++i) rsp_data_.data[i] = static_cast<uint8_t>(random_.bits());
      rsp_data_.data[beat_bytes_] = 1;
    }
    write_port(rsp_tag_, r.tag);
  }
  *rsp_valid_.data = beat_now_ ? 1 : 0;
}

bool LineMemory::sample(uint64_t cycle) {
  bool moved = beat_now_;
  if (beat_now_) {
    bytes_ += beat_bytes_;
    if (++beat_ * beat_bytes_ >= line_bytes_) {
      pending_.erase(pending_.begin() + static_cast<std::ptrdiff_t>(sending_));
      in_line_ = false;
    }
  }
  was_valid_ = *req_valid_.data != 0;
  if (was_valid_ && *req_ready_.data != 0) {
    moved = true;
    const uint64_t address = read_port(req_addr_), tag = read_port(req_tag_);
    const uint64_t map = address >> line_bits_, line = address & ones(line_bits_);
    const bool beyond = faults_ && map <= 1 && line >= faults_->lines[map];
    const bool bad = faults_ && faults_->error_of > 0 && random_.below(faults_->error_of) == 0;
    const size_t beats = line_bytes_ / beat_bytes_;
    size_t bad_from = 0, bad_to = 0;
    if (beyond) {
      bad_to = beats;
    } else if (bad) {
      bad_from = random_.below(beats);
      bad_to = bad_from + 1;
    }
    if (bad_to > 0) {
      ++faults_->errors;
      nothing_.resize(line_bytes_);
    }
    if (beyond) {
      // Nothing is read there.
    } else if (!lines_ || map > 1 || (line + 1) * line_bytes_ > (*lines_)[map].size())
      throw RigError(unit_,
                     fmt::format(", cycle {}: the line port asks for line {} of map {}, "
                                 "which has {} lines",
                                 cycle, line, map,
                                 lines_ && map <= 1 ? (*lines_)[map].size() / line_bytes_ : 0),
                     cycle);
    for (const Request& r : pending_)
      if (r.tag == tag)
        throw RigError(unit_,
                       fmt::format(", cycle {}: the line port uses tag {} again before its "
                                   "reply is complete",
                                   cycle, tag),
                       cycle);
    const uint64_t wait = random_latency_ ? 1 + random_.below(2 * static_cast<uint64_t>(latency_))
                                          : static_cast<uint64_t>(latency_);
    uint64_t& bank = bank_free_[line % bank_free_.size()];
    const uint64_t start = std::max(cycle, bank);
    bank = start + static_cast<uint64_t>(bank_cycles_);
    pending_.push_back({start + wait, tag,
                        beyond ? nothing_.data() : (*lines_)[map].data() + line * line_bytes_,
                        bad_from, bad_to});
    ++requests_;
  }
  return moved;
}

void LineMemory::restart() {
  pending_.clear();
  bank_free_.assign(bank_free_.size(), 0);
  beat_ = sending_ = 0;
  in_line_ = beat_now_ = was_valid_ = false;
  requests_ = bytes_ = 0;
  *req_ready_.data = 0;
  *rsp_valid_.data = 0;
}

std::string LineMemory::state() const {
  return fmt::format("line port: request valid {} ready {}, {} requests, {} unanswered",
                     was_valid_ ? 1 : 0, *req_ready_.data ? 1 : 0, requests_, pending_.size());
}

Rig::Rig(const Plan& plan, const std::string& unit, const RunOptions& options)
    : unit_(unit),
      options_(options),
      model_(build_model(plan, {unit,
                                options.rtl_dir,
                                options.work_dir,
                                !options.waveform.empty(),
                                {},
                                options.kind,
                                options.yosys,
                                options.netlist,
                                options.faults && !options.faults->memories.empty(),
                                options.watch_queues}),
             options.seed * 0x9e3779b97f4a7c15ull + options.initial_seed),
      fault_random_(options.seed, unit + ".faults") {
  clock_ = model_.port("clk_i").data;
  reset_ = model_.port("rst_i").data;
  for (const ModelPort& p : model_.ports())
    if (!p.output) std::memset(p.data, 0, p.bytes);
  for (const ModelQueue& q : model_.queues()) queue_fills_.push_back({q.name, q.depth, 0, 0, 0});
}

Source& Rig::add_source(const std::string& name, int bits) {
  sources_.push_back(std::make_unique<Source>(model_, name, bits, options_, unit_));
  return *sources_.back();
}

Taker& Rig::add_taker(const std::string& name, int bits) {
  takers_.push_back(std::make_unique<Taker>(model_, name, bits, options_, unit_));
  return *takers_.back();
}

LineMemory& Rig::add_memory(const Plan& plan) {
  memory_ = std::make_unique<LineMemory>(model_, plan, options_, unit_);
  return *memory_;
}

void Rig::add_clock(const std::string& name, double period, std::function<void(uint64_t)> pins) {
  second_clock_ = model_.port(name).data;
  second_period_ = period;
  second_pins_ = std::move(pins);
}

void Rig::set(const std::string& port, uint64_t value) { write_port(model_.port(port), value); }

uint64_t Rig::get(const std::string& port) const { return read_port(model_.port(port)); }

std::vector<std::string> Rig::counter_ports() const {
  std::vector<std::string> names;
  for (const ModelPort& p : model_.ports())
    if (p.output && p.name.starts_with("count_")) names.push_back(p.name);
  return names;
}

void Rig::reset() {
  *reset_ = 1;
  for (int i = 0; i < 4; ++i) {
    *clock_ = 0;
    settle();
    *clock_ = 1;
    settle();
  }
  *reset_ = 0;
}

bool Rig::restart(const std::function<void()>& give) {
  if (options_.restart_after == 0 || std::exchange(restarted_, true)) return false;
  give();
  // A unit may make itself ready first.
  const auto started = [&] {
    return std::any_of(sources_.begin(), sources_.end(),
                       [](const auto& s) { return s->accepted() > 0; });
  };
  run_until([&] {
    return started() ||
           std::all_of(sources_.begin(), sources_.end(), [](const auto& s) { return s->empty(); });
  });
  for (uint64_t i = 0; i < options_.restart_after; ++i) cycle();
  for (auto& s : sources_) s->restart();
  for (auto& t : takers_) t->restart();
  if (memory_) memory_->restart();
  reset();
  return true;
}

std::string Rig::streams() const {
  std::string text;
  for (const auto& s : sources_) text += "\n  " + s->state();
  for (const auto& t : takers_) text += "\n  " + t->state();
  if (memory_) text += "\n  " + memory_->state();
  return text;
}

void Rig::settle() {
  try {
    model_.eval();
  } catch (const ModelStopped&) {
    std::fflush(stdout);  // where the simulator said which assertion it is
    // The waveform's end is what the assertion saw.
    if (waveform_open_) model_.dump(2 * cycle_ + *clock_);
    throw RigError(unit_,
                   fmt::format(" stopped in cycle {}, seed {}: an assertion failed, which the "
                               "simulator names above{}",
                               cycle_, options_.seed, streams()),
                   cycle_);
  }
}

void Rig::flip_bits() {
  Faults& f = *options_.faults;
  if (flip_at_ == ~0ull) flip_at_ = cycle_ + fault_random_.below(f.within);
  if (cycle_ < flip_at_) return;
  flip_at_ = ~0ull;
  std::vector<size_t> chosen;
  uint64_t bits = 0;
  for (size_t m = 0; m < model_.memories().size(); ++m) {
    const ModelMemory& memory = model_.memories()[m];
    for (const std::string& part : f.memories)
      if (memory.name.find(part) != std::string::npos) {
        chosen.push_back(m);
        bits += memory.words * memory.bits;
        break;
      }
  }
  if (bits == 0) throw RigError(unit_, ": none of its memories has one of the names to be harmed");
  for (;;) {
    uint64_t at = fault_random_.below(bits);
    size_t c = 0;
    const auto size = [&] {
      const ModelMemory& memory = model_.memories()[chosen[c]];
      return memory.words * memory.bits;
    };
    for (; at >= size(); ++c) at -= size();
    const ModelMemory& memory = model_.memories()[chosen[c]];
    const size_t word = at / memory.bits, bit = at % memory.bits;
    uint8_t* data = memory.data + word * memory.stride;
    std::vector<uint8_t>& left = flipped_words_[{chosen[c], word}];
    if (left == std::vector<uint8_t>(data, data + memory.stride)) continue;
    data[bit / 8] = static_cast<uint8_t>(data[bit / 8] ^ (1u << (bit % 8)));
    left.assign(data, data + memory.stride);
    break;
  }
  ++f.flipped;
  --f.flips;
}

void Rig::cycle() {
  if (options_.faults && options_.faults->flips > 0) flip_bits();
  for (auto& s : sources_) s->drive();
  for (auto& t : takers_) t->drive();
  if (memory_) memory_->drive(cycle_);
  *clock_ = 0;
  settle();
  const bool recording = !options_.waveform.empty() && cycle_ >= options_.waveform_from &&
                         cycle_ <= options_.waveform_to;
  if (recording) {
    if (!waveform_open_) {
      model_.open_waveform(options_.waveform);
      waveform_open_ = true;
    }
    model_.dump(2 * cycle_);
  } else if (waveform_open_) {
    model_.close_waveform();
    waveform_open_ = false;
  }
  // Edges of the second clock since the last rising edge of the first.
  for (; second_clock_ &&
         static_cast<double>(second_edges_) * second_period_ < static_cast<double>(cycle_ + 1);
       ++second_edges_) {
    second_pins_(second_edges_);
    *second_clock_ = 1;
    settle();
    *second_clock_ = 0;
    settle();
  }
  bool moved = false;
  for (auto& s : sources_) moved |= s->sample(cycle_);
  for (auto& t : takers_) moved |= t->sample(cycle_);
  if (memory_) moved |= memory_->sample(cycle_);
  quiet_ = moved ? 0 : quiet_ + 1;
  *clock_ = 1;
  settle();
  if (recording) model_.dump(2 * cycle_ + 1);
  for (auto& s : sources_) s->after_edge();
  ++cycle_;
  for (size_t i = 0; !*reset_ && i < queue_fills_.size(); ++i) {
    QueueFill& f = queue_fills_[i];
    const size_t fill = model_.queues()[i].fill();
    f.most = std::max(f.most, fill);
    f.full += fill == f.depth;
    ++f.cycles;
  }
}

void Rig::run_until(const std::function<bool()>& done) {
  quiet_ = 0;
  while (!done()) {
    cycle();
    if (quiet_ < options_.watchdog) continue;
    throw RigError(unit_,
                   fmt::format(" is stuck: nothing moved for {} cycles before cycle {}, "
                               "seed {}{}",
                               quiet_, cycle_, options_.seed, streams()),
                   cycle_ - quiet_);
  }
}

}  // namespace photonloom
