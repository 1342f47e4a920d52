// SPDX-License-Identifier: Apache-2.0
// LUT RAM: one write port (clocked), one read port (combinational). A read of the word being written in the same cycle
// gives the old word. Not reset. For small depths; a second read port is a second instance.
module lut_ram #(
    parameter int unsigned Width = 8,
    parameter int unsigned Depth = 16,
    localparam int unsigned AddressBits = Depth > 1 ? $clog2(Depth) : 1
) (
    input  logic                   clk_i,
    input  logic                   write_i,
    input  logic [AddressBits-1:0] write_address_i,
    input  logic [      Width-1:0] write_data_i,
    input  logic [AddressBits-1:0] read_address_i,
    output logic [      Width-1:0] read_data_o
);
  (* ram_style = "distributed" *) logic [Width-1:0] memory[0:Depth-1];

  always_ff @(posedge clk_i) if (write_i) memory[write_address_i] <= write_data_i;

  assign read_data_o = memory[read_address_i];
endmodule
