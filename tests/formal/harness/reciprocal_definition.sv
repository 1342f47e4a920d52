// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/reciprocal.sv
// reciprocal of one number, any but 0: x with its highest bit e is rounded half up to W + 1 bits m, a carry moving e; the
// mantissa is R = floor(2^(2W) / m), R m <= 2^(2W) < (R + 1) m. One operation is all: at its start, as after reset,
// nothing but the idle state is known, so it stands for every operation. It must end within Cycles.
module reciprocal_definition #(
    parameter int unsigned XBits = 12,
    parameter int unsigned W = 8,
    parameter int unsigned Cycles = 20,
    localparam int unsigned ExponentBits = $clog2(XBits + 1)
) (
    input logic clk_i
);
  (* anyconst *) logic [XBits-1:0] x;
  logic in_ready, out_valid;
  logic [W:0] mantissa;
  logic [ExponentBits-1:0] exponent;
  logic started_q = 1'b0, accepted_q = 1'b0, done_q = 1'b0;
  logic [5:0] age_q = '0;

  reciprocal #(
      .XBits(XBits),
      .W(W)
  ) dut (
      .clk_i(clk_i),
      .rst_i(!started_q),
      .in_valid_i(started_q && !accepted_q),
      .in_ready_o(in_ready),
      .in_i(x),
      .out_valid_o(out_valid),
      .out_ready_i(1'b1),
      .mantissa_o(mantissa),
      .exponent_o(exponent)
  );

  always_ff @(posedge clk_i) begin
    started_q <= 1'b1;
    if (started_q && in_ready) accepted_q <= 1'b1;
    if (accepted_q && out_valid) done_q <= 1'b1;
    age_q <= age_q + 1'b1;
  end

  // The definition.
  logic [ExponentBits-1:0] highest, e;
  logic [XBits+W:0] shifted;
  logic [W+1:0] rounded;
  logic [W:0] m;
  always_comb begin
    highest = '0;
    for (int unsigned b = 0; b < XBits; b++) if (x[b]) highest = ExponentBits'(b);
    shifted = {x, {W + 1{1'b0}}} >> highest;  // one bit beyond the last
    rounded = {1'b0, shifted[W+1:1]} + {{W + 1{1'b0}}, shifted[0]};
    m = rounded[W+1] ? rounded[W+1:1] : rounded[W:0];
    e = highest + ExponentBits'(rounded[W+1]);
  end

  logic [2*W+1:0] product, one;
  assign one = (2 * W + 2)'(1) << (2 * W);
  assign product = (2 * W + 2)'(mantissa) * (2 * W + 2)'(m);
  always_comb begin
    assume (x != '0);
    if (accepted_q && !done_q) begin
      assert (age_q < 6'(Cycles));
      if (out_valid) begin
        assert (exponent == e);
        assert (product <= one && one - product < (2 * W + 2)'(m));
      end
    end
  end
endmodule
