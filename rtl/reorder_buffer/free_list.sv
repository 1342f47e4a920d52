// SPDX-License-Identifier: Apache-2.0
// Numbers 0 .. Count-1 shifted by First, each handed out until it is given back: first in ascending order, then in the
// order of their return. A number asked for with take_i is at number_o two cycles later. There is no empty signal: its
// owner never has more than Count - 4 numbers out, so the number read came back at least two cycles ago.
module free_list #(
    parameter int unsigned Count = 16,
    parameter int unsigned First = 0,
    localparam int unsigned NumberBits = $clog2(First + Count)
) (
    input  logic                  clk_i,
    input  logic                  rst_i,
    input  logic                  take_i,
    output logic [NumberBits-1:0] number_o,
    input  logic                  give_i,
    input  logic [NumberBits-1:0] number_i
);
  localparam int unsigned RingBits = $clog2(Count);
  localparam logic [RingBits-1:0] Last = RingBits'(Count - 1);

  logic [RingBits-1:0] head_q, tail_q;
  logic [NumberBits-1:0] fresh_q, returned, number_q;
  logic first_round_q, fresh_valid_q;

  block_ram #(
      .Width(NumberBits),
      .Depth(Count)
  ) ring (
      .clk_i(clk_i),
      .write_i(give_i),
      .write_address_i(tail_q),
      .write_data_i(number_i),
      .read_i(1'b1),
      .read_address_i(head_q),
      .read_data_o(returned)
  );

  assign number_o = number_q;

  always_ff @(posedge clk_i) begin
    fresh_q <= NumberBits'(First) + NumberBits'(head_q);
    fresh_valid_q <= first_round_q;
    number_q <= fresh_valid_q ? fresh_q : returned;
    if (take_i) begin
      head_q <= head_q == Last ? '0 : head_q + 1'b1;
      if (head_q == Last) first_round_q <= 1'b0;
    end
    if (give_i) tail_q <= tail_q == Last ? '0 : tail_q + 1'b1;
    if (rst_i) begin
      head_q <= '0;
      tail_q <= '0;
      first_round_q <= 1'b1;
    end
  end
endmodule
