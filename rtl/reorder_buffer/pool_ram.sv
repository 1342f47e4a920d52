// SPDX-License-Identifier: Apache-2.0
// A block_ram of any depth, its rule for collisions included, whose depth is little more than a power of two: block RAM up
// to the power of two, the few words beyond it in LUT RAM (block RAM where they are more than 64). One memory of such a
// depth would take half as many blocks again and a multiplexer behind each bit. A read takes two cycles: each part has a
// register behind it, and the choice between them comes after that. A power of two of 8,192 and more is in slices so narrow that a
// slice is one block.
module pool_ram #(
    parameter int unsigned Width = 8,
    parameter int unsigned Depth = 528,
    localparam int unsigned AddressBits = $clog2(Depth)
) (
    input  logic                   clk_i,
    input  logic                   write_i,
    input  logic [AddressBits-1:0] write_address_i,
    input  logic [      Width-1:0] write_data_i,
    input  logic [AddressBits-1:0] read_address_i,
    output logic [      Width-1:0] read_data_o
);
  localparam int unsigned Main = 1 << ($clog2(Depth + 1) - 1);
  localparam int unsigned Rest = Depth - Main;

  if (Main < 512 || Rest == 0) begin : gen_plain
    logic [Width-1:0] data;
    always_ff @(posedge clk_i) read_data_o <= data;
    block_ram #(
        .Width(Width),
        .Depth(Depth)
    ) words (
        .clk_i(clk_i),
        .write_i(write_i),
        .write_address_i(write_address_i),
        .write_data_i(write_data_i),
        .read_i(1'b1),
        .read_address_i(read_address_i),
        .read_data_o(data)
    );
  end else begin : gen_split
    localparam int unsigned RestBits = Rest > 1 ? $clog2(Rest) : 1;
    // Of 8,192 words and more: slices that are a block of that depth each, so that nothing is chosen between a block and its register.
    localparam int unsigned Widest = AddressBits >= 15 ? 1 : AddressBits == 14 ? 2 : Width;
    logic write_rest, read_rest_q, read_rest2_q;
    logic [Width-1:0] main_data, rest_data, main_q, rest_q;
    assign write_rest = write_address_i[AddressBits-1];
    assign read_data_o = read_rest2_q ? rest_q : main_q;
    always_ff @(posedge clk_i) begin
      read_rest_q <= read_address_i[AddressBits-1];
      read_rest2_q <= read_rest_q;
      main_q <= main_data;
      rest_q <= rest_data;
    end

    for (genvar low = 0; low < Width; low = low + Widest) begin : gen_slice
      localparam int unsigned Slice = Width - low < Widest ? Width - low : Widest;
      block_ram #(
          .Width(Slice),
          .Depth(Main)
      ) main_words (
          .clk_i(clk_i),
          .write_i(write_i && !write_rest),
          .write_address_i(write_address_i[AddressBits-2:0]),
          .write_data_i(write_data_i[low+:Slice]),
          .read_i(1'b1),
          .read_address_i(read_address_i[AddressBits-2:0]),
          .read_data_o(main_data[low+:Slice])
      );
    end

    if (Rest <= 64) begin : gen_few
      logic [Width-1:0] stored;
      lut_ram #(
          .Width(Width),
          .Depth(Rest)
      ) rest_words (
          .clk_i(clk_i),
          .write_i(write_i && write_rest),
          .write_address_i(write_address_i[RestBits-1:0]),
          .write_data_i(write_data_i),
          .read_address_i(read_address_i[RestBits-1:0]),
          .read_data_o(stored)
      );
      always_ff @(posedge clk_i) rest_data <= stored;
    end else begin : gen_many
      block_ram #(
          .Width(Width),
          .Depth(Rest)
      ) rest_words (
          .clk_i(clk_i),
          .write_i(write_i && write_rest),
          .write_address_i(write_address_i[RestBits-1:0]),
          .write_data_i(write_data_i),
          .read_i(1'b1),
          .read_address_i(read_address_i[RestBits-1:0]),
          .read_data_o(rest_data)
      );
    end
  end
endmodule
