// SPDX-License-Identifier: Apache-2.0
// Block RAM: one write port, one read port, one clock; a read takes one cycle (put a register behind it where the path
// matters). Not reset. Collision rule: a read of the word being written in the same cycle gives a word nobody may use;
// simulation returns the complement of the old one, so that whoever uses it fails. A memory of at most LutWords words is
// made of LUTs, with a register behind it: the same from outside, for parts whose block RAM is short.
module block_ram #(
    parameter int unsigned Width = 8,
    parameter int unsigned Depth = 512,
    /* verilator lint_off UNUSEDPARAM */  // what a memory is made of does not show in simulation
    parameter int unsigned LutWords = photonloom_pkg::LutRamWords,
    /* verilator lint_on UNUSEDPARAM */
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
`ifdef SYNTHESIS
  if (Depth <= LutWords) begin : gen_luts
    (* no_rw_check, ram_style = "distributed" *) logic [Width-1:0] memory[0:Depth-1];
    always_ff @(posedge clk_i) if (write_i) memory[write_address_i] <= write_data_i;
    always_ff @(posedge clk_i) if (read_i) read_data_o <= memory[read_address_i];
  end else begin : gen_block
    (* no_rw_check, ram_style = "block" *) logic [Width-1:0] memory[0:Depth-1];
    always_ff @(posedge clk_i) if (write_i) memory[write_address_i] <= write_data_i;
    always_ff @(posedge clk_i) if (read_i) read_data_o <= memory[read_address_i];
  end
`else
  logic [Width-1:0] memory[0:Depth-1];
  always_ff @(posedge clk_i) if (write_i) memory[write_address_i] <= write_data_i;
  logic collision;
  assign collision = write_i && write_address_i == read_address_i;
  always_ff @(posedge clk_i) begin
    if (read_i) read_data_o <= collision ? ~memory[read_address_i] : memory[read_address_i];
  end
`endif
endmodule
