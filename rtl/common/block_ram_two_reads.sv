// SPDX-License-Identifier: Apache-2.0
// Block RAM with two ports, one clock: port a reads or writes, port b reads; a read takes one cycle (put a register behind
// it where the path matters). Not reset. Collision rule: what port a reads in a cycle in which it writes, and what port b
// reads of the word that port a writes, nobody may use; simulation returns the complement, so that whoever uses it fails.
module block_ram_two_reads #(
    parameter int unsigned Width = 8,
    parameter int unsigned Depth = 512,
    localparam int unsigned AddressBits = Depth > 1 ? $clog2(Depth) : 1
) (
    input  logic                   clk_i,
    input  logic                   a_write_i,
    input  logic [      Width-1:0] a_write_data_i,
    input  logic                   a_read_i,
    input  logic [AddressBits-1:0] a_address_i,
    output logic [      Width-1:0] a_read_data_o,
    input  logic                   b_read_i,
    input  logic [AddressBits-1:0] b_address_i,
    output logic [      Width-1:0] b_read_data_o
);
  (* no_rw_check, ram_style = "block" *) logic [Width-1:0] memory[0:Depth-1];

  always_ff @(posedge clk_i) if (a_write_i) memory[a_address_i] <= a_write_data_i;

`ifdef SYNTHESIS
  always_ff @(posedge clk_i) if (a_read_i) a_read_data_o <= memory[a_address_i];
  always_ff @(posedge clk_i) if (b_read_i) b_read_data_o <= memory[b_address_i];
`else
  always_ff @(posedge clk_i) begin
    if (a_read_i) a_read_data_o <= a_write_i ? ~memory[a_address_i] : memory[a_address_i];
    if (b_read_i)
      b_read_data_o <= a_write_i && a_address_i == b_address_i ? ~memory[b_address_i] : memory[b_address_i];
  end
`endif
endmodule
