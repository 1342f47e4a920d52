// SPDX-License-Identifier: Apache-2.0
#include "golden/pipeline/record.hpp"

#include "golden/packet/trace.hpp"
#include "golden/pipeline/tap.hpp"

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
  void see(std::span<const P> packets) {
    for (const P& p : packets) writer_.write(p);
  }
  void commit() override { writer_.commit(); }

 private:
  TraceWriter<P> writer_;
};

}  // namespace

PacketRecorder::PacketRecorder(const Plan& plan, const std::string& folder)
    : plan_(plan), folder_(folder) {}
PacketRecorder::~PacketRecorder() = default;

FrameUnits PacketRecorder::wrap(FrameUnits units) {
  for_each_unit([&](auto unit) {
    auto& inner = units.of(unit);
    const auto* kind = inner.get();
    inner = tapped<FileOf>(std::move(inner), kind, [&](auto packet, const char* name) {
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
