// SPDX-License-Identifier: Apache-2.0
// Sum of the squares of three signed offsets of Bits bits, exact. Latency 2, one a cycle, no stall. Three multipliers
// of Bits x Bits.
module squared_distance #(
    parameter int unsigned Bits = 17,
    localparam int unsigned SumBits = 2 * Bits
) (
    input  logic                clk_i,
    input  logic [  3*Bits-1:0] offset_i,
    output logic [SumBits-1:0] sum_o
);
  logic [2*Bits-1:0] square_q[0:2];

  for (genvar axis = 0; axis < 3; axis++) begin : gen_axis
    logic signed [Bits-1:0] offset;
    assign offset = offset_i[Bits*axis+:Bits];
    always_ff @(posedge clk_i) square_q[axis] <= offset * offset;
  end

  // |offset| <= 2^(Bits-1), so three squares are below 2^(2 Bits).
  always_ff @(posedge clk_i) sum_o <= square_q[0] + square_q[1] + square_q[2];
endmodule
