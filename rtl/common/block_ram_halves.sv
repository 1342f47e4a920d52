// SPDX-License-Identifier: Apache-2.0
// Block RAM of wide words of which there are few: a word lies in two, its lower half in front, so that a part's block RAM, 512 words
// deep where it is widest, is filled and half as many do. Not reset.
//
// A write takes the cycle of write_i and the next one: writes are at least two cycles apart. A read takes three cycles: what is at
// the output is the word whose address stood two and three cycles before, if neither of its halves was written in those.
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
  localparam int unsigned Low = (Width + 1) / 2;
  localparam int unsigned High = Width - Low;

  logic write_high_q;  // the half that was not written with write_i
  logic [AddressBits-1:0] write_address_q;
  logic [High-1:0] high_q;
  logic read_high_q;  // the half that is read, the other one is at the memory's output
  logic [Low-1:0] half;

  always_ff @(posedge clk_i) begin
    write_high_q <= write_i && !rst_i;
    write_address_q <= write_address_i;
    high_q <= write_data_i[Width-1:Low];
    read_high_q <= !read_high_q && !rst_i;
    if (read_high_q) read_data_o[Low-1:0] <= half;
    else read_data_o[Width-1:Low] <= half[High-1:0];
  end

  block_ram #(
      .Width(Low),
      .Depth(2 * Depth)
  ) halves (
      .clk_i(clk_i),
      .write_i(write_i || write_high_q),
      .write_address_i(write_high_q ? {write_address_q, 1'b1} : {write_address_i, 1'b0}),
      .write_data_i(write_high_q ? Low'(high_q) : write_data_i[Low-1:0]),
      .read_i(1'b1),
      .read_address_i({read_address_i, read_high_q}),
      .read_data_o(half)
  );
endmodule
