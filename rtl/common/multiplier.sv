// SPDX-License-Identifier: Apache-2.0
// Exact product of two unsigned numbers of any width, in limbs of 18 bits, the width of the FPGA's multipliers: one a
// cycle, latency 3, never stalls.
module multiplier #(
    parameter int unsigned ABits = 18,
    parameter int unsigned BBits = 18
) (
    input  logic                   clk_i,
    input  logic [      ABits-1:0] a_i,
    input  logic [      BBits-1:0] b_i,
    output logic [ABits+BBits-1:0] product_o
);
  localparam int unsigned Limb = 18;
  localparam int unsigned ALimbs = (ABits + Limb - 1) / Limb;
  localparam int unsigned BLimbs = (BBits + Limb - 1) / Limb;
  localparam int unsigned OutBits = ABits + BBits;

  logic [ALimbs*Limb-1:0] a;
  logic [BLimbs*Limb-1:0] b;
  assign a = (ALimbs * Limb)'(a_i);
  assign b = (BLimbs * Limb)'(b_i);

  // Products of limbs, then for each limb of a their sum over b, then the sum over a.
  logic [2*Limb*ALimbs*BLimbs-1:0] limbs_q;
  logic [OutBits*ALimbs-1:0] row, row_q;
  logic [OutBits-1:0] sum;

  for (genvar i = 0; i < ALimbs; i++) begin : gen_a
    for (genvar j = 0; j < BLimbs; j++) begin : gen_b
      always_ff @(posedge clk_i) begin
        limbs_q[2*Limb*(i*BLimbs+j)+:2*Limb] <= a[Limb*i+:Limb] * b[Limb*j+:Limb];
      end
    end
  end

  always_comb begin
    row = '0;
    for (int unsigned i = 0; i < ALimbs; i++) begin
      for (int unsigned j = 0; j < BLimbs; j++) begin
        row[OutBits*i+:OutBits] = row[OutBits*i+:OutBits] +
            (OutBits'(limbs_q[2*Limb*(i*BLimbs+j)+:2*Limb]) << (Limb * (i + j)));
      end
    end
    sum = '0;
    for (int unsigned i = 0; i < ALimbs; i++) sum = sum + row_q[OutBits*i+:OutBits];
  end

  always_ff @(posedge clk_i) begin
    row_q <= row;
    product_o <= sum;
  end
endmodule
