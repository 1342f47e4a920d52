// SPDX-License-Identifier: Apache-2.0
// In place of photon_gatherer_node_memory where its words were written before and are any. A word is there in the cycle after its
// address.
module photon_gatherer_node_memory #(
    parameter int unsigned Trees = 1,
    parameter int unsigned Width = 18,
    parameter int unsigned Depth = 8192,
    localparam int unsigned AddressBits = Depth > 1 ? $clog2(Depth) : 1
) (
    input  logic                         clk_i,
    input  logic                         write_i,
    input  logic [      AddressBits-1:0] write_address_i,
    input  logic [            Width-1:0] write_data_i,
    input  logic [Trees*AddressBits-1:0] read_address_i,
    output logic [      Trees*Width-1:0] read_data_o
);
  (* anyconst *) logic [Depth*Width-1:0] words;
  for (genvar tree = 0; tree < Trees; tree++) begin : gen_tree
    always_ff @(posedge clk_i)
      read_data_o[Width*tree+:Width] <= words[Width*32'(read_address_i[AddressBits*tree+:AddressBits])+:Width];
  end
endmodule
