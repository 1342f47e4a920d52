// SPDX-License-Identifier: Apache-2.0
// Sum of the squares of three signed offsets of Bits bits, exact, one a cycle, no stall. Three multipliers of
// Bits x Bits. The two additions take a stage (latency 2) or, in a third less logic, one each (Stages = 3, latency 3).
module squared_distance #(
    parameter int unsigned Bits = 17,
    parameter int unsigned Stages = 2,
    localparam int unsigned SumBits = 2 * Bits
) (
    input  logic               clk_i,
    input  logic [ 3*Bits-1:0] offset_i,
    output logic [SumBits-1:0] sum_o
);
  logic [SumBits-1:0] square_q[0:2];

  for (genvar axis = 0; axis < 3; axis++) begin : gen_axis
    logic signed [Bits-1:0] offset;
    assign offset = offset_i[Bits*axis+:Bits];
    always_ff @(posedge clk_i) square_q[axis] <= offset * offset;
  end

  // |offset| <= 2^(Bits-1), so three squares are below 2^(2 Bits).
  if (Stages == 2) begin : gen_one_addition
    always_ff @(posedge clk_i) sum_o <= square_q[0] + square_q[1] + square_q[2];
  end else begin : gen_two_additions
    logic [SumBits-1:0] two_q, third_q;
    always_ff @(posedge clk_i) begin
      two_q <= square_q[0] + square_q[1];
      third_q <= square_q[2];
      sum_o <= two_q + third_q;
    end
  end
endmodule
