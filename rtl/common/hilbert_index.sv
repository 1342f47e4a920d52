// SPDX-License-Identifier: Apache-2.0
// Hilbert index of three Bits-bit coordinates (Skilling 2004), one level of the curve a stage: latency Bits cycles, one
// index a cycle, never stalls. Mirrors hilbert_index of golden/numeric/hilbert.hpp.
module hilbert_index #(
    parameter int unsigned Bits = 3
) (
    input  logic              clk_i,
    input  logic [3*Bits-1:0] cell_i,  // z, y, x from the top
    output logic [3*Bits-1:0] index_o
);
  // Stage s holds the coordinates after the levels Bits-1 down to Bits-s.
  logic [3*Bits*Bits-1:0] stages;
  logic [3*Bits-1:0] result;

  assign stages[0+:3*Bits] = cell_i;

  for (genvar s = 0; s + 1 < Bits; s++) begin : gen_level
    localparam int unsigned Level = Bits - 1 - s;
    localparam logic [Bits-1:0] Low = Bits'((1 << Level) - 1);
    logic [Bits-1:0] x, y, z, x_out, y_out, z_out, swap_y, swap_z, x_after_y;
    logic [3*Bits-1:0] stage_q;

    assign {z, y, x} = stages[3*Bits*s+:3*Bits];

    // The bits of this level decide: invert the lower bits of x, or exchange them with the coordinate's.
    always_comb begin
      x_out = x[Level] ? x ^ Low : x;
      swap_y = (x_out ^ y) & Low;
      x_after_y = y[Level] ? x_out ^ Low : x_out ^ swap_y;
      y_out = y[Level] ? y : y ^ swap_y;
      swap_z = (x_after_y ^ z) & Low;
      z_out = z[Level] ? z : z ^ swap_z;
    end

    always_ff @(posedge clk_i) begin
      stage_q <= {z_out, y_out, z[Level] ? x_after_y ^ Low : x_after_y ^ swap_z};
    end
    assign stages[3*Bits*(s+1)+:3*Bits] = stage_q;
  end

  // Gray code.
  logic [Bits-1:0] last_x, last_y, last_z, gray_y, gray_z, flip;
  assign {last_z, last_y, last_x} = stages[3*Bits*(Bits-1)+:3*Bits];
  assign gray_y = last_y ^ last_x;
  assign gray_z = last_z ^ gray_y;

  for (genvar b = 0; b < Bits; b++) begin : gen_index
    if (b + 1 < Bits) begin : gen_flip
      assign flip[b] = ^gray_z[Bits-1:b+1];
    end else begin : gen_top
      assign flip[b] = 1'b0;
    end
    assign result[3*b+:3] = {last_x[b] ^ flip[b], gray_y[b] ^ flip[b], gray_z[b] ^ flip[b]};
  end

  always_ff @(posedge clk_i) index_o <= result;
endmodule
