// SPDX-License-Identifier: Apache-2.0
// Octahedral code of 2 x Bits bits to its unnormalised integer direction, |x| + |y| + |z| = 2^Bits, each signed with
// Bits + 2 bits. Combinational. Mirrors oct_decode of golden/numeric/octahedral.hpp.
module oct_decode #(
    parameter int unsigned Bits = 8,
    localparam int unsigned OutBits = Bits + 2
) (
    input  logic [   2*Bits-1:0] code_i,      // v high, u low
    output logic [3*OutBits-1:0] direction_o  // z, y, x from the top
);
  localparam logic signed [OutBits-1:0] One = OutBits'(1) << Bits;

  logic signed [OutBits-1:0] x, y, z, abs_x, abs_y, fold_x, fold_y;

  always_comb begin
    x = signed'({1'b0, code_i[Bits-1:0], 1'b1}) - One;
    y = signed'({1'b0, code_i[2*Bits-1:Bits], 1'b1}) - One;
    abs_x = x[OutBits-1] ? -x : x;
    abs_y = y[OutBits-1] ? -y : y;
    z = One - abs_x - abs_y;
    fold_x = One - abs_y;
    fold_y = One - abs_x;
    if (z[OutBits-1]) begin
      direction_o[0+:OutBits] = x[OutBits-1] ? -fold_x : fold_x;
      direction_o[OutBits+:OutBits] = y[OutBits-1] ? -fold_y : fold_y;
    end else begin
      direction_o[0+:OutBits] = x;
      direction_o[OutBits+:OutBits] = y;
    end
    direction_o[2*OutBits+:OutBits] = z;
  end
endmodule
