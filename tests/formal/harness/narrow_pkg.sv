// SPDX-License-Identifier: Apache-2.0
// Packets of the proofs: the fields that control reads, and a bit or two for all that it only carries.
package photonloom_pkg;
  localparam int unsigned LutRamWords = 64;
  localparam int unsigned Gatherers = 2;
  localparam int unsigned Contexts = 0;
  localparam int unsigned PositionBits = 1;
  localparam int unsigned ReorderKey = 1;
  localparam int unsigned ReorderDrain = 0;
  localparam int unsigned ReorderPackets = 4;
  localparam int unsigned ReorderBins = 4;
  localparam int unsigned ReorderCellBits = 1;

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
endpackage
