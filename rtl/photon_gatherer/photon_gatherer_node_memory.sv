// SPDX-License-Identifier: Apache-2.0
// The inner nodes of both maps in block RAM, read by one tree or two. Two trees read on the two ports of the same blocks,
// of which one writes too: while idle, so writes and reads never meet. A word is there in the cycle after its address.
module photon_gatherer_node_memory #(
    parameter int unsigned Trees = 1,  // 1 or 2
    parameter int unsigned Width = 18,
    parameter int unsigned Depth = 8192,
    localparam int unsigned AddressBits = Depth > 1 ? $clog2(Depth) : 1
) (
    input  logic                         clk_i,
    input  logic                         write_i,
    input  logic [      AddressBits-1:0] write_address_i,
    input  logic [            Width-1:0] write_data_i,
    input  logic [Trees*AddressBits-1:0] read_address_i,   // tree 0 lowest
    output logic [      Trees*Width-1:0] read_data_o
);
  // Slices so narrow that no choice between blocks follows them: a block of 16 kbit is 2^14 x 1 to 2^9 x 32, on two
  // ports to 2^10 x 16.
  localparam int unsigned Widest = AddressBits >= 14 ? 1 : AddressBits == 13 ? 2 : AddressBits == 12 ? 4 :
      AddressBits == 11 ? 9 : AddressBits == 10 || Trees > 1 ? 18 : 36;

  if (Trees > 2) begin : gen_bad_trees
    node_memory_has_two_ports bad_trees ();
  end

  for (genvar low = 0; low < Width; low = low + Widest) begin : gen_slice
    localparam int unsigned Slice = Width - low < Widest ? Width - low : Widest;
    if (Trees == 1) begin : gen_one
      block_ram #(
          .Width(Slice),
          .Depth(Depth)
      ) nodes (
          .clk_i(clk_i),
          .write_i(write_i),
          .write_address_i(write_address_i),
          .write_data_i(write_data_i[low+:Slice]),
          .read_i(1'b1),
          .read_address_i(read_address_i),
          .read_data_o(read_data_o[low+:Slice])
      );
    end else begin : gen_two
      block_ram_two_reads #(
          .Width(Slice),
          .Depth(Depth)
      ) nodes (
          .clk_i(clk_i),
          .a_write_i(write_i),
          .a_write_data_i(write_data_i[low+:Slice]),
          .a_read_i(1'b1),
          .a_address_i(write_i ? write_address_i : read_address_i[0+:AddressBits]),
          .a_read_data_o(read_data_o[low+:Slice]),
          .b_read_i(1'b1),
          .b_address_i(read_address_i[AddressBits+:AddressBits]),
          .b_read_data_o(read_data_o[Width+low+:Slice])
      );
    end
  end
endmodule
