// SPDX-License-Identifier: Apache-2.0
#include "golden/pipeline/watch.hpp"

#include <fmt/core.h>

#include <bit>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "golden/packet/layout.hpp"
#include "golden/pipeline/tap.hpp"

namespace photonloom {

using Json = nlohmann::ordered_json;

class PacketWatch::Stream {
 public:
  virtual ~Stream() = default;
  virtual Json json() const = 0;
};

namespace {

// The widest integer that every JSON reader keeps.
constexpr int kJsonBits = 53;

Json json_value(uint64_t value, int bits) {
  return bits > kJsonBits ? Json(fmt::format("{}", value)) : Json(value);
}

template <class P>
class WatchedStream final : public PacketWatch::Stream {
 public:
  WatchedStream(const std::string& unit, const std::string& stream, const Plan& plan, size_t kept)
      : unit_(unit), stream_(stream), layout_(PacketLayout::of<P>(plan)), kept_(kept) {
    for (const FieldPlace& f : layout_.fields())
      if (f.present()) fields_.push_back(f);
    most_.resize(fields_.size());
  }

  void see(std::span<const P> packets) {
    for (const P& p : packets) {
      for (size_t i = 0; i < fields_.size(); ++i)
        for (int e = 0; e < fields_[i].elements; ++e)
          most_[i] = std::max(most_[i], layout_.get(&p, fields_[i], e));
      if (rows_.size() < kept_) rows_.push_back(p);
      ++count_;
    }
  }

  Json json() const override {
    Json fields = Json::array(), rows = Json::array();
    for (size_t i = 0; i < fields_.size(); ++i) {
      const FieldPlace& f = fields_[i];
      fields.push_back({{"name", f.name},
                        {"elements", f.elements},
                        {"bits", f.bits},
                        {"used", std::bit_width(most_[i])},
                        {"most", json_value(most_[i], f.bits)},
                        {"unit", f.unit},
                        {"meaning", f.meaning}});
    }
    for (const P& p : rows_) {
      Json row = Json::array();
      for (const FieldPlace& f : fields_)
        for (int e = 0; e < f.elements; ++e)
          row.push_back(json_value(layout_.get(&p, f, e), f.bits));
      rows.push_back(row);
    }
    return {{"unit", unit_},
            {"stream", stream_},
            {"count", count_},
            {"fields", fields},
            {"rows", rows}};
  }

 private:
  std::string unit_, stream_;
  PacketLayout layout_;
  size_t kept_;
  std::vector<FieldPlace> fields_;  // that are present
  std::vector<uint64_t> most_;
  std::vector<P> rows_;
  uint64_t count_ = 0;
};

}  // namespace

PacketWatch::PacketWatch(const Plan& plan, size_t kept) : plan_(plan), kept_(kept) {}
PacketWatch::~PacketWatch() = default;

FrameUnits PacketWatch::wrap(FrameUnits units) {
  for_each_unit([&](auto unit) {
    if (!unit_info<typename decltype(unit)::type>.lacks(plan_).empty()) return;
    auto& inner = units.of(unit);
    const auto* kind = inner.get();
    inner = tapped<WatchedStream>(std::move(inner), kind, [&](auto packet, const char* name) {
      using P = typename decltype(packet)::type;
      auto stream = std::make_shared<WatchedStream<P>>(unit_name<typename decltype(unit)::type>,
                                                       name, plan_, kept_);
      streams_.push_back(stream);
      return stream;
    });
  });
  return units;
}

std::string PacketWatch::json() const {
  Json streams = Json::array();
  for (const auto& stream : streams_) streams.push_back(stream->json());
  return Json{{"streams", streams}}.dump() + "\n";
}

}  // namespace photonloom
