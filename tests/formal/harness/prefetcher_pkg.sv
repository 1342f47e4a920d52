// SPDX-License-Identifier: Apache-2.0
// Packets of the proofs of line_prefetcher: maps of four lines of four beats, two requests.
package photonloom_pkg;
  localparam int unsigned LutRamWords = 64;
  localparam int unsigned PositionBits = 1;
  localparam int unsigned Bucket = 2;
  localparam int unsigned PhotonBytes = 4;
  localparam int unsigned GlobalPresent = 1;
  localparam int unsigned GlobalPhotons = 8;
  localparam int unsigned CausticPresent = 1;
  localparam int unsigned CausticPhotons = 8;
  localparam int unsigned NodeWords = 8;
  localparam int unsigned R2Bits = 2;
  localparam int unsigned LineBits = 2;
  localparam int unsigned LineAddressBits = 2;
  localparam int unsigned LineBeatBits = 16;
  localparam int unsigned LineTagBits = 2;

  localparam int unsigned GatherQueryPacketBits = 6;
  typedef struct packed {
    logic tag;
    logic map;
    logic flush;
    logic [2:0] position;
  } gather_query_t;
endpackage
