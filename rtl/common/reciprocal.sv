// SPDX-License-Identifier: Apache-2.0
// reciprocal(x) of golden/numeric/reciprocal.hpp: x > 0 is normalised and rounded half up to W+1 bits m, then
// R = floor(2^(2W) / m) by non-restoring division, two bits a cycle, so it is the definition for every m by construction.
// 1/x = mantissa * 2^-(W + exponent). One at a time; each takes ceil((W+1)/2) + 5 cycles, and to normalise it one for
// each four leading zeros and one for each of the up to three that remain, and until out_ready_i.
module reciprocal #(
    parameter int unsigned XBits = 34,
    parameter int unsigned W = 18,
    localparam int unsigned ExponentBits = $clog2(XBits + 1)
) (
    input  logic                    clk_i,
    input  logic                    rst_i,
    input  logic                    in_valid_i,
    output logic                    in_ready_o,
    input  logic [       XBits-1:0] in_i,
    output logic                    out_valid_o,
    input  logic                    out_ready_i,
    output logic [             W:0] mantissa_o,
    output logic [ExponentBits-1:0] exponent_o
);
  localparam int unsigned Steps = (W + 2) / 2;       // cycles of division
  localparam int unsigned Extra = 2 * Steps - W - 1;  // quotient bits beyond the last
  localparam int unsigned YBits = XBits > W + 2 ? XBits : W + 2;
  localparam int unsigned StepBits = $clog2(Steps + 1);

  localparam logic [2:0] Idle = 3'd0, Normalise = 3'd1, Round = 3'd2, Triple = 3'd3, Divide = 3'd4, Out = 3'd5;
  logic [2:0] state_q;
  logic [YBits-1:0] y_q;
  logic [ExponentBits-1:0] exponent_q;
  logic [W+1:0] rounded;
  logic signed [W+2:0] remainder_q, remainder_2;  // in -divisor .. divisor - 1
  logic [W:0] divisor_q;
  logic [W+2:0] triple_q;  // of the divisor
  logic [2*Steps-1:0] quotient_q;
  logic [StepBits-1:0] step_q;
  logic bit_1, bit_2, four;

  // Leading zeros go four at a time, then one at a time.
  assign four = y_q[YBits-1-:4] == '0;

  assign rounded = {1'b0, y_q[YBits-1-:W+1]} + {{(W + 1) {1'b0}}, y_q[YBits-W-2]};

  // A quotient bit is 1 iff twice the remainder, less the divisor if the remainder was not negative, else with it added
  // again, is not negative. The remainder after a second bit is computed for both values of the first: 4 r - 3 d or
  // 4 r - d, with the signs of d turned where r is negative. The bit below the numbers is the carry into a subtraction.
  logic negative;
  /* verilator lint_off UNUSEDSIGNAL */  // the carry's bit, and of the first remainder all but its sign
  logic signed [W+3:0] sum_1, sum_one, sum_three;
  /* verilator lint_on UNUSEDSIGNAL */
  assign negative = remainder_q[W+2];
  assign sum_1 = {remainder_q[W+1:0], 1'b0, 1'b1} + ({2'b00, divisor_q, 1'b0} ^ {W + 4{!negative}});
  assign sum_one = {remainder_q[W:0], 2'b00, 1'b1} + ({2'b00, divisor_q, 1'b0} ^ {W + 4{!negative}});
  assign sum_three = {remainder_q[W:0], 2'b00, 1'b1} + ({triple_q, 1'b0} ^ {W + 4{!negative}});
  assign bit_1 = !sum_1[W+3];
  assign remainder_2 = bit_1 == negative ? sum_one[W+3:1] : sum_three[W+3:1];
  assign bit_2 = !remainder_2[W+2];

  assign in_ready_o = state_q == Idle;
  assign out_valid_o = state_q == Out;
  assign mantissa_o = quotient_q[Extra+:W+1];
  assign exponent_o = exponent_q;

  always_ff @(posedge clk_i) begin
    unique case (state_q)
      Idle: begin
        y_q <= YBits'(in_i) << (YBits - XBits);
        exponent_q <= ExponentBits'(XBits - 1);
        if (in_valid_i) state_q <= Normalise;
      end
      Normalise: begin
        if (y_q[YBits-1]) begin
          state_q <= Round;
        end else begin
          y_q <= four ? y_q << 4 : y_q << 1;
          exponent_q <= exponent_q - (four ? ExponentBits'(4) : ExponentBits'(1));
        end
      end
      Round: begin
        divisor_q <= rounded[W+1] ? rounded[W+1:1] : rounded[W:0];
        if (rounded[W+1]) exponent_q <= exponent_q + 1'b1;
        remainder_q <= (W + 3)'(1) << (W - 1);
        step_q <= StepBits'(Steps - 1);
        state_q <= Triple;
      end
      Triple: begin
        triple_q <= {2'b00, divisor_q} + {1'b0, divisor_q, 1'b0};
        state_q <= Divide;
      end
      Divide: begin
        remainder_q <= remainder_2;
        quotient_q <= {quotient_q[2*Steps-3:0], bit_1, bit_2};
        step_q <= step_q - 1'b1;
        if (step_q == '0) state_q <= Out;
      end
      default: if (out_ready_i) state_q <= Idle;
    endcase
    if (rst_i) state_q <= Idle;
  end
endmodule
