// SPDX-License-Identifier: Apache-2.0
// Packets of the proofs of a dispatcher whose gatherers lie far: those of narrow_pkg that it has.
package photonloom_pkg;
  localparam int unsigned LutRamWords = 64;
  localparam int unsigned FarGatherers = 1;
  localparam int unsigned Gatherers = 2;
  localparam int unsigned Contexts = 0;
  localparam int unsigned NodesPerCycle = 1;

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
