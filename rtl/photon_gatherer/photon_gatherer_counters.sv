// SPDX-License-Identifier: Apache-2.0
// Count counters of 32 bits, of which only one adder is wide: each counts its lowest bits alone and notes a carry;
// once in 16 cycles its turn comes, when the carry is added to the upper bits, in LUT RAM, and the output is
// refreshed. Each takes steps of 2^(StepBits-1) at most. Modulo 2^32; an output shows its counter as it was at most 18
// cycles ago, exactly.
module photon_gatherer_counters #(
    parameter int unsigned Count = 13,  // at most 16
    parameter int unsigned StepBits = 2
) (
    input  logic                      clk_i,
    input  logic                      rst_i,
    input  logic [StepBits*Count-1:0] step_i,
    output logic [      32*Count-1:0] count_o
);
  localparam int unsigned LowBits = StepBits + 3;  // 16 of the largest steps carry at most once
  localparam int unsigned HighBits = 32 - LowBits;

  logic [3:0] turn_q, turn_1_q;
  logic first_round_q, carry_q;
  logic [Count-1:0] carry, turn;
  logic [HighBits-1:0] high, high_q, sum;
  logic [StepBits*Count-1:0] step_q;

  always_ff @(posedge clk_i) begin
    step_q <= step_i;
    turn_q <= turn_q + 1'b1;
    turn_1_q <= turn_q;
    if (turn_q == 4'd15) first_round_q <= 1'b0;
    high_q <= first_round_q ? '0 : high;
    carry_q <= (carry & turn) != '0;
    if (rst_i) begin
      step_q <= '0;
      turn_q <= '0;
      first_round_q <= 1'b1;
    end
  end

  lut_ram #(
      .Width(HighBits),
      .Depth(16)
  ) upper (
      .clk_i(clk_i),
      .write_i(1'b1),
      .write_address_i(turn_1_q),
      .write_data_i(sum),
      .read_address_i(turn_q),
      .read_data_o(high)
  );
  assign sum = high_q + HighBits'(carry_q);

  for (genvar i = 0; i < Count; i++) begin : gen_counter
    logic [LowBits-1:0] low_q, low_1_q;
    logic [LowBits:0] low_next;
    logic carry_i_q, turn_i_q;
    logic [31:0] count_q;

    assign low_next = {1'b0, low_q} + (LowBits + 1)'(step_q[StepBits*i+:StepBits]);
    assign turn[i] = turn_q == 4'(i);
    assign carry[i] = carry_i_q;

    always_ff @(posedge clk_i) begin
      low_q <= low_next[LowBits-1:0];
      carry_i_q <= low_next[LowBits] || (carry_i_q && !turn[i]);
      turn_i_q <= turn[i];
      if (turn[i]) low_1_q <= low_q;
      if (turn_i_q) count_q <= {sum, low_1_q};
      if (rst_i) begin
        low_q <= '0;
        carry_i_q <= 1'b0;
        turn_i_q <= 1'b0;
        count_q <= '0;
      end
    end
    assign count_o[32*i+:32] = count_q;
  end
endmodule
