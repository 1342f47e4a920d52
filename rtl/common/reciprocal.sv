// SPDX-License-Identifier: Apache-2.0
// reciprocal(x) of golden/numeric/reciprocal.hpp: x > 0 is normalised and rounded half up to W+1 bits m, then
// R = floor(2^(2W) / m) by restoring division, two bits a cycle, so it is the definition for every m by construction.
// 1/x = mantissa * 2^-(W + exponent). One at a time, ceil((W+1)/2) + 4 cycles each; out_valid_o is one cycle long.
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
    output logic [             W:0] mantissa_o,
    output logic [ExponentBits-1:0] exponent_o
);
  localparam int unsigned Steps = (W + 2) / 2;       // cycles of division
  localparam int unsigned Extra = 2 * Steps - W - 1;  // quotient bits beyond the last
  localparam int unsigned YBits = XBits > W + 2 ? XBits : W + 2;
  localparam int unsigned StepBits = $clog2(Steps + 1);

  localparam logic [2:0] Idle = 3'd0, Coarse = 3'd1, Fine = 3'd2, Round = 3'd3, Divide = 3'd4, Out = 3'd5;
  logic [2:0] state_q;
  logic [YBits-1:0] y_q, coarse, fine;
  logic [ExponentBits-1:0] exponent_q, coarse_shift, fine_shift;
  logic [W+1:0] remainder_q, remainder_1, remainder_2, rounded;
  logic [W:0] divisor_q;
  logic [2*Steps-1:0] quotient_q;
  logic [StepBits-1:0] step_q;
  logic bit_1, bit_2;

  // Leading zeros go in two cycles: by 32, 16, 8 and by 4, 2, 1.
  always_comb begin
    coarse = y_q;
    coarse_shift = '0;
    fine = y_q;
    fine_shift = '0;
    for (int unsigned s = 6; s > 0; s--) begin
      if ((1 << (s - 1)) < YBits) begin
        if (s > 3) begin
          if ((coarse >> (YBits - (1 << (s - 1)))) == '0) begin
            coarse = coarse << (1 << (s - 1));
            coarse_shift = coarse_shift + ExponentBits'(1 << (s - 1));
          end
        end else if ((fine >> (YBits - (1 << (s - 1)))) == '0) begin
          fine = fine << (1 << (s - 1));
          fine_shift = fine_shift + ExponentBits'(1 << (s - 1));
        end
      end
    end
  end

  assign rounded = {1'b0, y_q[YBits-1-:W+1]} + {{(W + 1) {1'b0}}, y_q[YBits-W-2]};

  always_comb begin
    bit_1 = remainder_q >= {1'b0, divisor_q};
    remainder_1 = bit_1 ? remainder_q - {1'b0, divisor_q} : remainder_q;
    remainder_1 = remainder_1 << 1;
    bit_2 = remainder_1 >= {1'b0, divisor_q};
    remainder_2 = bit_2 ? remainder_1 - {1'b0, divisor_q} : remainder_1;
    remainder_2 = remainder_2 << 1;
  end

  assign in_ready_o = state_q == Idle;
  assign out_valid_o = state_q == Out;
  assign mantissa_o = quotient_q[Extra+:W+1];
  assign exponent_o = exponent_q;

  always_ff @(posedge clk_i) begin
    unique case (state_q)
      Idle: begin
        y_q <= YBits'(in_i) << (YBits - XBits);
        exponent_q <= ExponentBits'(XBits - 1);
        if (in_valid_i) state_q <= Coarse;
      end
      Coarse: begin
        y_q <= coarse;
        exponent_q <= exponent_q - coarse_shift;
        state_q <= Fine;
      end
      Fine: begin
        y_q <= fine;
        exponent_q <= exponent_q - fine_shift;
        state_q <= Round;
      end
      Round: begin
        divisor_q <= rounded[W+1] ? rounded[W+1:1] : rounded[W:0];
        if (rounded[W+1]) exponent_q <= exponent_q + 1'b1;
        remainder_q <= (W + 2)'(1) << W;
        step_q <= StepBits'(Steps - 1);
        state_q <= Divide;
      end
      Divide: begin
        remainder_q <= remainder_2;
        quotient_q <= {quotient_q[2*Steps-3:0], bit_1, bit_2};
        step_q <= step_q - 1'b1;
        if (step_q == '0) state_q <= Out;
      end
      default: state_q <= Idle;
    endcase
    if (rst_i) state_q <= Idle;
  end
endmodule
