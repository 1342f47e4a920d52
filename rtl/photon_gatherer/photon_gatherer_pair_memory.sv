// SPDX-License-Identifier: Apache-2.0
// The inner nodes of both maps in block RAM, in words of three: an upper node and its two children. A map's upper nodes are those
// of every second level, so that its lowest inner level is one of children; where the root is a child, it is the right one of
// word 0. A node n is in word n if it is an upper one, else in word n / 2, on its left if n is even; a map has as many words as
// a power of two that is half of its numbers of nodes. Written node by node while idle; a word is there in the cycle after its
// address.
module photon_gatherer_pair_memory #(
    parameter int unsigned Width = 18,
    parameter int unsigned GlobalLines = 4096,
    parameter int unsigned CausticLines = 0,
    parameter int unsigned NodeAddressBits = 12,
    parameter int unsigned GlobalWords = 2048,
    parameter int unsigned CausticWords = 0,
    parameter int unsigned GlobalUpper = 1,     // levels of a map's upper nodes: 0 even, 1 odd
    parameter int unsigned CausticUpper = 1,
    localparam int unsigned Depth = GlobalWords + CausticWords,
    localparam int unsigned AddressBits = Depth > 1 ? $clog2(Depth) : 1
) (
    input  logic                       clk_i,
    input  logic                       write_i,
    input  logic [NodeAddressBits-1:0] write_address_i,  // of a node; those of the caustic map from GlobalLines
    input  logic [          Width-1:0] write_data_i,
    input  logic [    AddressBits-1:0] read_address_i,
    output logic [        3*Width-1:0] read_data_o       // the upper, the left, the right one
);
  // Slices so narrow that no choice between blocks follows them: a block of 16 kbit is 2^14 x 1 to 2^9 x 32.
  localparam int unsigned Widest = AddressBits >= 14 ? 1 : AddressBits == 13 ? 2 : AddressBits == 12 ? 4 :
      AddressBits == 11 ? 9 : AddressBits == 10 ? 18 : 36;

  logic caustic, odd, upper;
  logic [NodeAddressBits-1:0] node;
  logic [AddressBits-1:0] write_address;
  logic [2:0] write_here;

  assign caustic = CausticLines != 0 && (GlobalLines == 0 || write_address_i >= NodeAddressBits'(GlobalLines));
  assign node = write_address_i - (caustic ? NodeAddressBits'(GlobalLines) : '0);
  always_comb begin
    odd = 1'b0;
    for (int unsigned i = 0; i < NodeAddressBits; i++) if (node[i]) odd = i % 2 == 1;
  end
  assign upper = odd == (caustic ? CausticUpper != 0 : GlobalUpper != 0);
  assign write_address = AddressBits'(upper ? node : node >> 1) + (caustic ? AddressBits'(GlobalWords) : '0);
  assign write_here = !write_i ? 3'b000 : upper ? 3'b001 : node[0] ? 3'b100 : 3'b010;

  for (genvar w = 0; w < 3; w++) begin : gen_node
    for (genvar low = 0; low < Width; low = low + Widest) begin : gen_slice
      localparam int unsigned Slice = Width - low < Widest ? Width - low : Widest;
      block_ram #(
          .Width(Slice),
          .Depth(Depth)
      ) nodes (
          .clk_i(clk_i),
          .write_i(write_here[w]),
          .write_address_i(write_address),
          .write_data_i(write_data_i[low+:Slice]),
          .read_i(1'b1),
          .read_address_i(read_address_i),
          .read_data_o(read_data_o[Width*w+low+:Slice])
      );
    end
  end
endmodule
