// SPDX-License-Identifier: Apache-2.0
// Count numbers, 0 .. Count - 1. One is handed out with take_i, to be found at number_o two cycles later, until it is given
// back: first in ascending order, then in the order of their return. There is no empty signal: its owner never has more
// than Count - 4 numbers out, so the number read came back at least two cycles ago.
module free_list #(
    parameter int unsigned Count = 16,
    localparam int unsigned Bits = $clog2(Count)
) (
    input  logic            clk_i,
    input  logic            rst_i,
    input  logic            take_i,
    output logic [Bits-1:0] number_o,
    input  logic            give_i,
    input  logic [Bits-1:0] number_i
);
  localparam logic [Bits-1:0] Last = Bits'(Count - 1);

  logic [Bits-1:0] head_q, tail_q, fresh_number_q, fresh_number2_q, returned;
  logic first_round_q, fresh_q, fresh2_q;

  pool_ram #(
      .Width(Bits),
      .Depth(Count)
  ) ring (
      .clk_i(clk_i),
      .write_i(give_i),
      .write_address_i(tail_q),
      .write_data_i(number_i),
      .read_address_i(head_q),
      .read_data_o(returned)
  );

  assign number_o = fresh2_q ? fresh_number2_q : returned;

  always_ff @(posedge clk_i) begin
    fresh_number_q <= head_q;
    fresh_q <= first_round_q;
    fresh_number2_q <= fresh_number_q;
    fresh2_q <= fresh_q;
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
