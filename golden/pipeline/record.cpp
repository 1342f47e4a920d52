// SPDX-License-Identifier: Apache-2.0
#include "golden/pipeline/record.hpp"

#include "golden/packet/trace.hpp"

namespace photonloom {

struct PacketRecorder::Files {
  Files(const Plan& plan, const std::string& folder)
      : gather_query(folder + "/gather_query.jsonl", plan),
        gather_result(folder + "/gather_result.jsonl", plan),
        gather_photon(folder + "/gather_photon.jsonl", plan),
        reorder_in(folder + "/reorder_in.jsonl", plan),
        reorder_out(folder + "/reorder_out.jsonl", plan),
        sampler_input(folder + "/sampler_input.jsonl", plan),
        sample(folder + "/sample.jsonl", plan) {}

  TraceWriter<GatherQuery> gather_query;
  TraceWriter<GatherResult> gather_result;
  TraceWriter<GatherPhoton> gather_photon;
  TraceWriter<GatherQuery> reorder_in, reorder_out;
  TraceWriter<SamplerInput> sampler_input;
  TraceWriter<Sample> sample;
};

namespace {

template <class P>
void write(TraceWriter<P>& file, std::span<const P> packets) {
  for (const P& p : packets) file.write(p);
}

// What a call appended to `all`, which had `before` packets.
template <class P>
std::span<const P> since(const std::vector<P>& all, size_t before) {
  return std::span<const P>(all).subspan(before);
}

class RecordedGatherer final : public PhotonGatherer {
 public:
  RecordedGatherer(std::unique_ptr<PhotonGatherer> unit, PacketRecorder::Files& files)
      : unit_(std::move(unit)), files_(files) {}
  void load(const PhotonMap& global, const PhotonMap& caustic) override {
    unit_->load(global, caustic);
  }
  void process(std::span<const GatherQuery> in, std::vector<GatherResult>& results,
               std::vector<GatherPhoton>& photons) override {
    const size_t results_before = results.size(), photons_before = photons.size();
    unit_->process(in, results, photons);
    write(files_.gather_query, in);
    write(files_.gather_result, since(results, results_before));
    write(files_.gather_photon, since(photons, photons_before));
  }
  Counters counters() const override { return unit_->counters(); }

 private:
  std::unique_ptr<PhotonGatherer> unit_;
  PacketRecorder::Files& files_;
};

class RecordedReorderBuffer final : public ReorderBuffer {
 public:
  RecordedReorderBuffer(std::unique_ptr<ReorderBuffer> unit, PacketRecorder::Files& files)
      : unit_(std::move(unit)), files_(files) {}
  void process(std::span<const GatherQuery> in, std::vector<GatherQuery>& out) override {
    const size_t before = out.size();
    unit_->process(in, out);
    write(files_.reorder_in, in);
    write(files_.reorder_out, since(out, before));
  }
  Counters counters() const override { return unit_->counters(); }

 private:
  std::unique_ptr<ReorderBuffer> unit_;
  PacketRecorder::Files& files_;
};

class RecordedSampler final : public CdfSampler {
 public:
  RecordedSampler(std::unique_ptr<CdfSampler> unit, PacketRecorder::Files& files)
      : unit_(std::move(unit)), files_(files) {}
  void process(std::span<const SamplerInput> in, std::vector<Sample>& out) override {
    const size_t before = out.size();
    unit_->process(in, out);
    write(files_.sampler_input, in);
    write(files_.sample, since(out, before));
  }
  Counters counters() const override { return unit_->counters(); }

 private:
  std::unique_ptr<CdfSampler> unit_;
  PacketRecorder::Files& files_;
};

}  // namespace

PacketRecorder::PacketRecorder(const Plan& plan, const std::string& folder)
    : files_(std::make_unique<Files>(plan, folder)) {}
PacketRecorder::~PacketRecorder() = default;

FrameUnits PacketRecorder::wrap(FrameUnits units) {
  return {std::make_unique<RecordedGatherer>(std::move(units.photon_gatherer), *files_),
          std::make_unique<RecordedReorderBuffer>(std::move(units.reorder_buffer), *files_),
          std::make_unique<RecordedSampler>(std::move(units.cdf_sampler), *files_)};
}

void PacketRecorder::close() {
  files_->gather_query.commit();
  files_->gather_result.commit();
  files_->gather_photon.commit();
  files_->reorder_in.commit();
  files_->reorder_out.commit();
  files_->sampler_input.commit();
  files_->sample.commit();
}

}  // namespace photonloom
