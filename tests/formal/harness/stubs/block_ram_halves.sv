// SPDX-License-Identifier: Apache-2.0
// In place of block_ram_halves where one word of it matters, any: only that one is kept. All others, and what did not stand for long
// enough or was written since, give any value.
module block_ram_halves #(
    parameter int unsigned Width = 8,
    parameter int unsigned Depth = 256,
    localparam int unsigned AddressBits = Depth > 1 ? $clog2(Depth) : 1
) (
    input  logic                   clk_i,
    input  logic                   rst_i,
    input  logic                   write_i,
    input  logic [AddressBits-1:0] write_address_i,
    input  logic [      Width-1:0] write_data_i,
    input  logic [AddressBits-1:0] read_address_i,
    output logic [      Width-1:0] read_data_o
);
  (* anyconst *) logic [AddressBits-1:0] watched;
  (* anyseq *) logic [Width-1:0] other;
  logic [Width-1:0] word_q;
  logic [2:0] reads_q;  // of the last cycles
  logic [2:0] writes_q;  // each and the cycle after it
  logic written_q;
  always_ff @(posedge clk_i) begin
    reads_q <= {reads_q[1:0], read_address_i == watched};
    written_q <= write_i && write_address_i == watched;
    writes_q <= {writes_q[1:0], (write_i && write_address_i == watched) || written_q};
    if (write_i && write_address_i == watched) word_q <= write_data_i;
  end
  assign read_data_o = reads_q[2:1] == 2'b11 && writes_q == '0 ? word_q : other;
endmodule
