// SPDX-License-Identifier: Apache-2.0
#include "golden/pipeline/record.hpp"

#include <array>
#include <iterator>
#include <tuple>

#include "golden/packet/trace.hpp"

namespace photonloom {

class PacketRecorder::File {
 public:
  virtual ~File() = default;
  virtual void commit() = 0;
};

namespace {

template <class P>
class FileOf final : public PacketRecorder::File {
 public:
  FileOf(const std::string& path, const Plan& plan) : writer_(path, plan) {}
  void write(std::span<const P> packets) {
    for (const P& p : packets) writer_.write(p);
  }
  void commit() override { writer_.commit(); }

 private:
  TraceWriter<P> writer_;
};

template <class Unit, class In, class... Out>
class Recorded final : public InFront<Unit> {
 public:
  using Files = std::tuple<std::shared_ptr<FileOf<In>>, std::shared_ptr<FileOf<Out>>...>;
  Recorded(std::unique_ptr<Unit> unit, Files files)
      : InFront<Unit>({unit.get()}), unit_(std::move(unit)), files_(std::move(files)) {}

  void process(std::span<const In> in, std::vector<Out>&... out) override {
    const std::array<size_t, sizeof...(Out)> before{out.size()...};
    unit_->process(in, out...);
    std::apply(
        [&](auto& in_file, auto&... out_file) {
          in_file->write(in);
          size_t stream = 0;
          (out_file->write(std::span<const Out>(out).subspan(before[stream++])), ...);
        },
        files_);
  }
  Counters counters() const override { return unit_->counters(); }

 private:
  std::unique_ptr<Unit> unit_;
  Files files_;
};

// `file(std::type_identity<P>{}, name)` begins a file.
template <class Unit, class Begin, class In, class... Out>
std::unique_ptr<Unit> recorded(std::unique_ptr<Unit> unit, const PacketUnit<In, Out...>*,
                               Begin begin) {
  static_assert(std::size(Unit::kRecorded) == 1 + sizeof...(Out));
  size_t n = 0;
  const auto file = [&](auto packet) { return begin(packet, Unit::kRecorded[n++]); };
  // In braces: from left to right.
  typename Recorded<Unit, In, Out...>::Files files{file(std::type_identity<In>{}),
                                                   file(std::type_identity<Out>{})...};
  return std::make_unique<Recorded<Unit, In, Out...>>(std::move(unit), std::move(files));
}

}  // namespace

PacketRecorder::PacketRecorder(const Plan& plan, const std::string& folder)
    : plan_(plan), folder_(folder) {}
PacketRecorder::~PacketRecorder() = default;

FrameUnits PacketRecorder::wrap(FrameUnits units) {
  for_each_unit([&](auto unit) {
    auto& inner = units.of(unit);
    const auto* kind = inner.get();
    inner = recorded(std::move(inner), kind, [&](auto packet, const char* name) {
      using P = typename decltype(packet)::type;
      auto file = std::make_shared<FileOf<P>>(folder_ + "/" + name + ".jsonl", plan_);
      files_.push_back(file);
      return file;
    });
  });
  return units;
}

void PacketRecorder::close() {
  for (const auto& file : files_) file->commit();
}

}  // namespace photonloom
