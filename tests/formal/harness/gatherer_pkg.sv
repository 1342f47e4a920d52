// SPDX-License-Identifier: Apache-2.0
// Packets of the proofs of photon_gatherer and cdf_sampler and of what lies in them: all fields, each as narrow as it may be.
package photonloom_pkg;
  localparam int unsigned LutRamWords = 64;
  localparam int unsigned FarGatherers = 0;
  localparam int unsigned Parity = 0;
  localparam int unsigned PositionBits = 2;
  localparam int unsigned DirectionBits = 2;
  localparam int unsigned NormalBits = 2;
  localparam int unsigned MantissaBits = 1;
  localparam int unsigned ExponentBits = 1;
  localparam int unsigned Channels = 2;
  localparam int unsigned Bucket = 2;
  localparam int unsigned PhotonBytes = 2;
  localparam int unsigned LinesCompressed = 0;
  localparam int unsigned GlobalPresent = 1;
  localparam int unsigned GlobalPhotons = 4;
  localparam int unsigned CausticPresent = 1;
  localparam int unsigned CausticPhotons = 4;
  localparam int unsigned NodeWords = 4;
  localparam int unsigned K = 2;
  localparam logic [5:0] R2Floor = 6'd1;
  localparam int unsigned EpsilonFactor = 1;
  localparam int unsigned EpsilonShift = 0;
  localparam int unsigned LeafLimit = 0;
  localparam int unsigned ReciprocalBits = 1;
  localparam int unsigned Reciprocals = 1;
  localparam int unsigned ReciprocalExponentBits = 3;
  localparam int unsigned Contexts = 2;
  localparam int unsigned Lanes = 1;
  localparam int unsigned NodesPerCycle = 1;
  localparam int unsigned CandidatesPerCycle = 1;
  localparam int unsigned QueuedBeats = 16;
  localparam int unsigned PowersPerCycle = 1;
  localparam int unsigned CacheBytes = 8;
  localparam int unsigned CacheWays = 2;
  localparam int unsigned CacheMisses = 2;
  localparam int unsigned LineBeatBits = 16;
  localparam int unsigned CellBits = 1;
  localparam int unsigned ProbabilityBits = 2;
  localparam int unsigned UBits = 2;
  localparam int unsigned VBits = 1;
  localparam int unsigned Combine = 0;
  localparam int unsigned Levels = 1;
  localparam int unsigned CosineSamples = 1;
  localparam int unsigned R2Bits = 6;
  localparam int unsigned LineBits = 1;
  localparam int unsigned IndexBits = 2;
  localparam int unsigned CountBits = 2;
  localparam int unsigned ListCodeBits = 0;
  localparam int unsigned FluxBits = 3;
  localparam int unsigned PixelBits = 1;
  localparam int unsigned SampleBits = 1;
  localparam int unsigned TagBits = 1;
  localparam int unsigned PhotonBits = 13;
  localparam int unsigned LineAddressBits = 1;
  localparam int unsigned RecordBits = 13;
  localparam int unsigned SlotHeaderBits = 0;
  localparam int unsigned CornerBits = 1;
  localparam int unsigned AxisOffsetBits = 0;
  localparam int unsigned OtherOffsetBits = 0;
  localparam int unsigned GatherQueryPacketBits = 16;
  localparam int unsigned GatherResultPacketBits = 37;
  localparam int unsigned GatherPhotonPacketBits = 16;
  localparam int unsigned SamplerInputPacketBits = 20;
  localparam int unsigned SamplePacketBits = 15;

  typedef struct packed {
    logic pixel;
    logic sample;
    logic tag;
    logic map;
    logic flush;
    logic want_photons;
    logic [5:0] position;
    logic [3:0] normal;
  } gather_query_t;

  typedef struct packed {
    logic pixel;
    logic sample;
    logic tag;
    logic map;
    logic flush;
    logic [1:0] count;
    logic [5:0] r2;
    logic [5:0] flux;
    logic [1:0] reciprocal;
    logic [2:0] reciprocal_exponent;
    logic full;
    logic clamped;
    logic [1:0] nodes;
    logic [1:0] leaves;
    logic [2:0] insertions;
  } gather_result_t;

  typedef struct packed {
    logic [1:0] index;
    logic [5:0] d2;
    logic [1:0] mantissa;
    logic exponent;
    logic [3:0] direction;
    logic last;
  } gather_photon_t;

  typedef struct packed {
    logic [1:0] kind;
    logic pixel;
    logic sample;
    logic tag;
    logic [3:0] normal;
    logic [1:0] mantissa;
    logic exponent;
    logic [3:0] direction;
    logic [1:0] u;
    logic [1:0] v;
  } sampler_input_t;

  typedef struct packed {
    logic pixel;
    logic sample;
    logic tag;
    logic [3:0] direction;
    logic [1:0] cell_index;
    logic [1:0] weight;
    logic [3:0] total;
  } sample_t;
endpackage
