// SPDX-License-Identifier: Apache-2.0
// Packets of the proofs: the fields that control reads, and a bit or two for all that it only carries.
package photonloom_pkg;
  localparam int unsigned LutRamWords = 64;
  localparam int unsigned FarGatherers = 0;
  localparam int unsigned Gatherers = 2;
  localparam int unsigned Contexts = 0;
  localparam int unsigned NodesPerCycle = 1;
  localparam int unsigned QueuedBeats = 16;
  localparam int unsigned PositionBits = 1;
  localparam int unsigned ReorderKey = 1;
  localparam int unsigned ReorderDrain = 0;
  localparam int unsigned ReorderPackets = 4;
  localparam int unsigned ReorderBins = 4;
  localparam int unsigned ReorderCellBits = 1;

  localparam int unsigned NormalBits = 1;
  localparam int unsigned CacheRecords = 1;
  localparam int unsigned CacheRecordBits = 1;
  localparam int unsigned CacheHits = 1;
  localparam int unsigned CacheHitBits = 1;
  localparam int unsigned CacheWeightBits = 2;
  localparam int unsigned CacheAngleBits = 1;
  localparam int unsigned CacheFalloffBits = 2;
  localparam int unsigned CacheFalloffExponentBits = 1;

  localparam int unsigned GatherQueryPacketBits = 7;
  typedef struct packed {
    logic [1:0] tag;
    logic flush;
    logic want_photons;
    logic [2:0] position;
  } gather_query_t;

  localparam int unsigned GatherResultPacketBits = 2;
  typedef struct packed {
    logic tag;
    logic count;
  } gather_result_t;

  localparam int unsigned GatherPhotonPacketBits = 2;
  typedef struct packed {
    logic tag;
    logic last;
  } gather_photon_t;

  localparam int unsigned CacheLookupPacketBits = 14;
  typedef struct packed {
    logic pixel;
    logic sample;
    logic clear;
    logic insert;
    logic [2:0] position;
    logic [2:0] normal;
    logic [2:0] falloff;
    logic falloff_exponent;
  } cache_lookup_t;

  localparam int unsigned CacheResultPacketBits = 10;
  typedef struct packed {
    logic pixel;
    logic sample;
    logic count;
    logic record;
    logic [2:0] weight;
    logic inserted;
    logic full;
    logic number;
  } cache_result_t;
endpackage
