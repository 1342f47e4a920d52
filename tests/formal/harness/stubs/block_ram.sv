// SPDX-License-Identifier: Apache-2.0
// In place of block_ram where one word of it matters, any: only that one is kept. All others, and one that is read while it is
// written, give any value.
module block_ram #(
    parameter int unsigned Width = 8,
    parameter int unsigned Depth = 512,
    parameter int unsigned LutWords = 0,
    localparam int unsigned AddressBits = Depth > 1 ? $clog2(Depth) : 1
) (
    input  logic                   clk_i,
    input  logic                   write_i,
    input  logic [AddressBits-1:0] write_address_i,
    input  logic [      Width-1:0] write_data_i,
    input  logic                   read_i,
    input  logic [AddressBits-1:0] read_address_i,
    output logic [      Width-1:0] read_data_o
);
  (* anyconst *) logic [AddressBits-1:0] watched;
  (* anyseq *) logic [Width-1:0] other;
  logic [Width-1:0] word_q;
  logic writes;
  assign writes = write_i && write_address_i == watched;
  always_ff @(posedge clk_i) begin
    if (writes) word_q <= write_data_i;
    if (read_i) read_data_o <= read_address_i == watched && !writes ? word_q : other;
  end
endmodule
