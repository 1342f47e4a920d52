// SPDX-License-Identifier: Apache-2.0
// A record's weight at a point: 2^B (1 - d^2 / reach^2 - n^2 / 2^AngleBits), d the distance of the positions, n that of
// the normals, each quotient rounded down; 0 where that is not positive. The record's falloff is the reciprocal of
// reach^2 as golden/numeric/reciprocal.hpp has it, W = FalloffBits. Latency 11, one a cycle, no stall. Golden:
// cache_weight in golden/unit/irradiance_cache.cpp.
module irradiance_weight #(
    parameter int unsigned PositionBits = photonloom_pkg::PositionBits,
    parameter int unsigned NormalBits = photonloom_pkg::NormalBits,
    parameter int unsigned AngleBits = photonloom_pkg::CacheAngleBits,
    parameter int unsigned WeightBits = photonloom_pkg::CacheWeightBits,
    parameter int unsigned FalloffBits = photonloom_pkg::CacheFalloffBits,
    parameter int unsigned ExponentBits = photonloom_pkg::CacheFalloffExponentBits
) (
    input  logic                      clk_i,
    input  logic [3*PositionBits-1:0] point_i,
    input  logic [  3*NormalBits-1:0] point_normal_i,
    input  logic [3*PositionBits-1:0] record_i,
    input  logic [  3*NormalBits-1:0] record_normal_i,
    input  logic [     FalloffBits:0] falloff_i,
    input  logic [  ExponentBits-1:0] exponent_i,
    output logic [      WeightBits:0] weight_o
);
  localparam int unsigned R2Bits = 2 * PositionBits + 2;
  localparam int unsigned N2Bits = 2 * NormalBits + 2;
  localparam int unsigned WideBits = R2Bits + FalloffBits - 1;
  localparam int unsigned ProductBits = 2 * FalloffBits + 1;
  localparam int unsigned FarBits = WeightBits + 2;
  localparam int unsigned SumBits = FarBits + 1;
  localparam int unsigned LowBits = ExponentBits < 3 ? ExponentBits : 3;  // of the exponent, shifted by first

  // Stage 1: offsets.
  logic [3*(PositionBits+1)-1:0] offset_q;
  logic [3*(NormalBits+1)-1:0] normal_offset_q;
  for (genvar axis = 0; axis < 3; axis++) begin : gen_axis
    always_ff @(posedge clk_i) begin
      offset_q[(PositionBits+1)*axis+:PositionBits+1] <=
          {1'b0, point_i[PositionBits*axis+:PositionBits]} - {1'b0, record_i[PositionBits*axis+:PositionBits]};
      normal_offset_q[(NormalBits+1)*axis+:NormalBits+1] <=
          {1'b0, point_normal_i[NormalBits*axis+:NormalBits]} - {1'b0, record_normal_i[NormalBits*axis+:NormalBits]};
    end
  end

  // Stages 2 to 4: squares and their sums.
  logic [R2Bits-1:0] d2;
  logic [N2Bits-1:0] n2;
  squared_distance #(
      .Bits(PositionBits + 1),
      .Stages(3)
  ) distance (
      .clk_i(clk_i),
      .offset_i(offset_q),
      .sum_o(d2)
  );
  squared_distance #(
      .Bits(NormalBits + 1),
      .Stages(3)
  ) turn (
      .clk_i(clk_i),
      .offset_i(normal_offset_q),
      .sum_o(n2)
  );

  // The record's falloff meets its distance: the exponent behind stage 4 and 5, the mantissa behind stage 6.
  logic [4*ExponentBits-1:0] exponents_q;
  logic [6*(FalloffBits+1)-1:0] falloffs_q;
  logic [ExponentBits-1:0] exponent, exponent_q;
  logic [FalloffBits:0] falloff;
  assign exponent = exponents_q[3*ExponentBits+:ExponentBits];
  assign falloff  = falloffs_q[5*(FalloffBits+1)+:FalloffBits+1];

  // Stages 5 and 6: d^2 / 2^(e+1) with FalloffBits bits behind the point; what reaches above the point is too far.
  logic [WideBits-1:0] shifted_q, shifted;
  logic [FalloffBits-1:0] near_q;
  logic far_q;
  assign shifted = shifted_q >> {exponent_q >> LowBits, LowBits'(0)};

  // Stages 7 to 9: over reach^2 / 2^(e+1).
  /* verilator lint_off UNUSEDSIGNAL */  // rounded down
  logic [ProductBits-1:0] product;
  /* verilator lint_on UNUSEDSIGNAL */
  multiplier #(
      .ABits(FalloffBits),
      .BBits(FalloffBits + 1)
  ) quotient (
      .clk_i(clk_i),
      .a_i(near_q),
      .b_i(falloff),
      .product_o(product)
  );

  // The normals' part of the weight, and what is out of reach for sure, wait for the product.
  logic [N2Bits+WeightBits-1:0] turned;
  logic [WeightBits-1:0] turn_q;
  logic turned_off_q;
  assign turned = {n2, WeightBits'(0)} >> AngleBits;
  logic [4*WeightBits-1:0] turns_q;
  logic off_q;  // behind stage 6
  logic [2:0] offs_q;  // behind stages 7 to 9

  // Stages 10 and 11: what is left of one.
  logic [FarBits-1:0] far;
  logic [SumBits-1:0] sum_q;
  logic none_q, none;
  assign far  = product[ProductBits-1-:FarBits];
  assign none = none_q || sum_q >= (SumBits'(1) << WeightBits);

  always_ff @(posedge clk_i) begin
    exponents_q <= {exponents_q[0+:3*ExponentBits], exponent_i};
    falloffs_q <= {falloffs_q[0+:5*(FalloffBits+1)], falloff_i};
    exponent_q <= exponent;
    shifted_q <= {d2, (FalloffBits - 1)'(0)} >> exponent[LowBits-1:0];
    near_q <= shifted[FalloffBits-1:0];
    far_q <= |shifted[WideBits-1:FalloffBits];
    turn_q <= turned[WeightBits-1:0];
    turned_off_q <= |turned[N2Bits+WeightBits-1:WeightBits];
    turns_q <= {turns_q[0+:3*WeightBits], turn_q};
    off_q <= turned_off_q;
    offs_q <= {offs_q[1:0], off_q || far_q};
    sum_q <= SumBits'(far) + SumBits'(turns_q[3*WeightBits+:WeightBits]);
    none_q <= offs_q[2];
    weight_o <= none ? '0 : (WeightBits + 1)'((SumBits'(1) << WeightBits) - sum_q);
  end
endmodule
