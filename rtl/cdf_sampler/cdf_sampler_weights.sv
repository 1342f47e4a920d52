// SPDX-License-Identifier: Apache-2.0
// Weights of the cells, one a cycle in the order of their numbers: the exact S(c) of docs/cdf_sampler.md from Q(c), the
// photons' power spread over Levels, and B(c), the cosine; narrowed once by a shift, at least 1 where the cell touches the
// open upper hemisphere, else 0. Latency 11 + Delay from walk_i to weight_valid_o, Delay being ceil(log2 Levels), and 3
// where Combine is 2. TB must be there 5 cycles after the first walk_i, TP 4 cycles, and both stay until the last weight.
// Mirrors build_sample_table of golden/unit/cdf_sampler.cpp.
//
//   cycle 0  number -> centre                             5-7  products, limb by limb
//         1  centre x normal                              8    sum
//         2  dot product, J                               9    shift, coarse
//         3  B; how far the highest corner lies above     10   shift, fine; floor
//            the centre; the cell's power is read         Delay cycles later from 5 on; the read so that Q comes with B
//         4  is the highest corner above the horizon
module cdf_sampler_weights #(
    parameter int unsigned CellBits = 4,
    parameter int unsigned NormalBits = 8,
    parameter int unsigned PowerBits = 48,  // of TP
    parameter int unsigned CosineBits = 28,  // of TB
    parameter int unsigned ProbabilityBits = 16,
    parameter int unsigned Combine = 0,  // 0 sum, 1 product, 2 weighted, 3 photons, 4 cosine
    parameter int unsigned Levels = 1,
    parameter int unsigned CosineSamples = 50,  // Combine 2: photons that the cosine counts as
    parameter int unsigned CountBits = 6,  // of a table's photons
    localparam int unsigned IndexBits = 2 * CellBits,
    localparam int unsigned SpreadBits = PowerBits + 2 * (Levels - 1) + $clog2(Levels),
    localparam int unsigned AxisBits = NormalBits + 2
) (
    input  logic                       clk_i,
    input  logic                       rst_i,
    input  logic                       walk_i,
    input  logic [      IndexBits-1:0] cell_i,
    input  logic [     3*AxisBits-1:0] normal_i,        // decoded; z, y, x from the top
    output logic                       power_read_o,
    output logic [      IndexBits-1:0] power_cell_o,
    input  logic [     SpreadBits-1:0] spread_i,        // Q, 2 + ceil(log2 Levels) cycles after power_read_o
    input  logic [      PowerBits-1:0] power_total_i,   // TP
    input  logic [      CountBits-1:0] photons_i,       // of the table, as early as TP
    input  logic [     CosineBits-1:0] cosine_total_i,  // TB
    output logic                       weight_valid_o,
    output logic [      IndexBits-1:0] weight_cell_o,
    output logic [ProbabilityBits-1:0] weight_o
);
  localparam int unsigned CentreBits = CellBits + 2;
  localparam int unsigned DotBits = CellBits + NormalBits + 3;
  localparam int unsigned BBits = CellBits + NormalBits + 8;
  localparam int unsigned HalfBits = CellBits > 1 ? CellBits - 1 : 1;
  localparam int unsigned ShareBits = Combine == 2 ? $clog2((1 << CountBits) + CosineSamples) : 1;  // of photons and N_B
  localparam int unsigned WidthBits = $clog2(SpreadBits + CosineBits + BBits + ShareBits + ProbabilityBits + 2);  // of a number of bits
  localparam int unsigned LevelDelay = $clog2(Levels);
  localparam int unsigned Delay = Combine == 2 && LevelDelay < 3 ? 3 : LevelDelay;
  localparam int unsigned Last = 11 + Delay;

  // What goes along: number and validity of the cell in each cycle.
  logic [Last:1] valid_q;
  logic [Last*IndexBits-1:0] cells_q;
  always_ff @(posedge clk_i) begin
    valid_q <= {valid_q[Last-1:1], walk_i};
    cells_q <= (Last * IndexBits)'({cells_q, cell_i});
    if (rst_i) valid_q <= '0;
  end
  localparam int unsigned ReadCycle = 3 + Delay - LevelDelay;
  assign power_read_o = valid_q[ReadCycle];
  assign power_cell_o = cells_q[(ReadCycle-1)*IndexBits+:IndexBits];
  assign weight_valid_o = valid_q[Last];
  assign weight_cell_o = cells_q[(Last-1)*IndexBits+:IndexBits];

  // 0: the centre.
  logic [CellBits-1:0] column, row;
  logic [3*CentreBits-1:0] centre;
  logic signed [CentreBits-1:0] x1_q, y1_q, z1_q;
  logic left1_q, front1_q;
  logic [HalfBits-1:0] quadrant_column1_q, quadrant_row1_q, quadrant_column2_q, quadrant_row2_q;

  assign {row, column} = cell_i;
  oct_decode #(
      .Bits(CellBits)
  ) centre_of_cell (
      .code_i({row, column}),
      .direction_o(centre)
  );
  always_ff @(posedge clk_i) begin
    {z1_q, y1_q, x1_q} <= centre;
    // The side of the unfolded square.
    left1_q <= !column[CellBits-1];
    front1_q <= !row[CellBits-1];
    quadrant_column1_q <= HalfBits'(column[CellBits-1] ? column : ~column);
    quadrant_row1_q <= HalfBits'(row[CellBits-1] ? row : ~row);
    quadrant_column2_q <= quadrant_column1_q;
    quadrant_row2_q <= quadrant_row1_q;
  end

  // 1: products with the normal, and the differences whose sum is how far the highest corner lies above the centre:
  // |a - nz| + |b - nz| on the upper half of the octahedron, |a + nz| + |b + nz| on the lower, and on the cells that fold
  // over its equator the larger of |a - b| and 2 |nz| - a - b, where a and b are nx and ny with the quadrant's signs.
  localparam int unsigned WideBits = AxisBits + 3;
  logic signed [AxisBits-1:0] nx, ny, nz;
  logic signed [WideBits-1:0] wide_x, wide_y, wide_z, minus_x_q, minus_y_q, twice_z_q, a, b;
  logic signed [WideBits-1:0] first, second, first2_q, second2_q;
  logic signed [DotBits-1:0] px2_q, py2_q, pz2_q;
  logic equator2_q, equator3_q;

  assign {nz, ny, nx} = normal_i;
  assign wide_x = WideBits'(nx);
  assign wide_y = WideBits'(ny);
  assign wide_z = WideBits'(nz);
  assign a = left1_q ? minus_x_q : wide_x;
  assign b = front1_q ? minus_y_q : wide_y;
  always_comb begin
    if (z1_q == '0) begin
      first  = a - b;
      second = twice_z_q - a - b;
    end else if (z1_q[CentreBits-1]) begin
      first  = a + wide_z;
      second = b + wide_z;
    end else begin
      first  = a - wide_z;
      second = b - wide_z;
    end
  end
  always_ff @(posedge clk_i) begin
    minus_x_q <= -wide_x;
    minus_y_q <= -wide_y;
    twice_z_q <= nz[AxisBits-1] ? -wide_z - wide_z : wide_z + wide_z;
    px2_q <= DotBits'(x1_q) * DotBits'(nx);
    py2_q <= DotBits'(y1_q) * DotBits'(ny);
    pz2_q <= DotBits'(z1_q) * DotBits'(nz);
    first2_q <= first;
    second2_q <= second;
    equator2_q <= z1_q == '0;
  end

  // 2: the dot product, the magnitudes, the Jacobian.
  logic signed [DotBits-1:0] dot3_q;
  logic signed [WideBits-1:0] first3_q, second3_q;
  logic [7:0] jacobian, jacobian3_q;
  cdf_sampler_jacobian #(
      .CellBits(CellBits)
  ) jacobian_of_cell (
      .column_i(quadrant_column2_q),
      .row_i(quadrant_row2_q),
      .jacobian_o(jacobian)
  );
  always_ff @(posedge clk_i) begin
    dot3_q <= px2_q + py2_q + pz2_q;
    first3_q <= first2_q[WideBits-1] ? -first2_q : first2_q;
    second3_q <= second2_q[WideBits-1] && !equator2_q ? -second2_q : second2_q;
    equator3_q <= equator2_q;
    jacobian3_q <= jacobian;
  end

  // 3 and 4: B, on its way from one multiplier to others for a cycle, and whether the highest corner is above the horizon.
  logic signed [DotBits-1:0] margin4_q, dot4_q, highest;
  logic [BBits-1:0] b4_q, b5_q;
  assign highest = dot4_q + margin4_q;
  always_ff @(posedge clk_i) begin
    b4_q <= dot3_q[DotBits-1] ? '0 : BBits'(unsigned'(dot3_q)) * BBits'(jacobian3_q);
    b5_q <= b4_q;
    dot4_q <= dot3_q;
    margin4_q <= equator3_q ? (first3_q >= second3_q ? DotBits'(first3_q) : DotBits'(second3_q)) :
        DotBits'(first3_q) + DotBits'(second3_q);
  end

  // B on its way to where Q comes.
  logic [(Delay+1)*BBits-1:0] bs;
  assign bs[0+:BBits] = b5_q;
  for (genvar i = 0; i < Delay; i++) begin : gen_delay
    logic [BBits-1:0] b_q;
    always_ff @(posedge clk_i) b_q <= bs[i*BBits+:BBits];
    assign bs[(i+1)*BBits+:BBits] = b_q;
  end
  logic [BBits-1:0] cosine;
  assign cosine = bs[Delay*BBits+:BBits];

  // What stands for a whole table: D TP', D = Levels 4^(Levels-1) being what a photon counts in all cells together.
  logic [PowerBits-1:0] power_weight;  // max(TP, 1)
  logic [SpreadBits-1:0] spread_weight;
  logic no_power_q, power_low_q;
  always_ff @(posedge clk_i) begin
    no_power_q  <= power_total_i == '0;
    power_low_q <= power_total_i[0] || power_total_i == '0;
  end
  if (PowerBits > 1) begin : gen_power_weight
    assign power_weight = {power_total_i[PowerBits-1:1], power_low_q};
  end else begin : gen_power_bit
    assign power_weight = power_low_q;
  end
  if (Levels == 1) begin : gen_no_spread
    assign spread_weight = power_weight;
  end else begin : gen_spread
    logic [SpreadBits-1:0] spread, spread_q;
    always_comb begin
      spread = '0;
      for (int unsigned i = 0; i < 3; i++) begin
        if (((Levels >> i) & 1) != 0) spread = spread + (SpreadBits'(power_weight) << (2 * (Levels - 1) + i));
      end
    end
    always_ff @(posedge clk_i) spread_q <= spread;
    assign spread_weight = spread_q;
  end

  // 5 to 8: the exact weight.
  localparam int unsigned PowerFactorBits = CosineBits + (Combine == 2 ? CountBits : 0);
  localparam int unsigned CosineFactorBits = SpreadBits + (Combine == 2 ? 8 : 0);
  localparam int unsigned FineBits = ProbabilityBits + 7;
  localparam int unsigned AloneBits = Combine == 3 && SpreadBits > BBits ? SpreadBits : BBits;
  localparam int unsigned ExactBits = Combine == 0 || Combine == 2 ? SpreadBits + CosineBits + ShareBits :
      Combine == 1 ? SpreadBits + BBits : AloneBits > FineBits ? AloneBits : FineBits;
  logic [ExactBits-1:0] exact9_q;

  if (Combine == 0 || Combine == 2) begin : gen_sum
    logic [PowerFactorBits-1:0] power_factor;
    logic [CosineFactorBits-1:0] cosine_factor;
    if (Combine == 2) begin : gen_shares
      multiplier #(
          .ABits(CosineBits),
          .BBits(CountBits)
      ) photons_times_total (
          .clk_i(clk_i),
          .a_i(cosine_total_i),
          .b_i(photons_i),
          .product_o(power_factor)
      );
      multiplier #(
          .ABits(SpreadBits),
          .BBits(8)
      ) samples_times_total (
          .clk_i(clk_i),
          .a_i(spread_weight),
          .b_i(8'(CosineSamples)),
          .product_o(cosine_factor)
      );
    end else begin : gen_halves
      assign power_factor = cosine_total_i;
      assign cosine_factor = spread_weight;
    end
    logic [SpreadBits+PowerFactorBits-1:0] power_product;
    logic [CosineFactorBits+BBits-1:0] cosine_product;
    multiplier #(
        .ABits(SpreadBits),
        .BBits(PowerFactorBits)
    ) power_times_total (
        .clk_i(clk_i),
        .a_i(spread_i),
        .b_i(power_factor),
        .product_o(power_product)
    );
    multiplier #(
        .ABits(CosineFactorBits),
        .BBits(BBits)
    ) cosine_times_total (
        .clk_i(clk_i),
        .a_i(cosine_factor),
        .b_i(cosine),
        .product_o(cosine_product)
    );
    always_ff @(posedge clk_i) exact9_q <= ExactBits'(power_product) + ExactBits'(cosine_product);
  end else if (Combine == 1) begin : gen_product
    logic [ExactBits-1:0] product;
    multiplier #(
        .ABits(SpreadBits),
        .BBits(BBits)
    ) power_times_cosine (
        .clk_i(clk_i),
        .a_i(no_power_q ? spread_weight : spread_i),
        .b_i(cosine),
        .product_o(product)
    );
    always_ff @(posedge clk_i) exact9_q <= product;
  end else begin : gen_alone
    logic [ExactBits-1:0] exact6_q, exact7_q, exact8_q;
    always_ff @(posedge clk_i) begin
      if (Combine == 3 && !no_power_q) exact6_q <= ExactBits'(spread_i);
      else exact6_q <= ExactBits'(cosine);
      exact7_q <= exact6_q;
      exact8_q <= exact7_q;
      exact9_q <= exact8_q;
    end
  end

  // The shift: bits of an upper bound of the table's exact total less those of a weight, at least 0. Leading zeros of the
  // totals: the highest bit is isolated, its number found, the numbers are added, a cycle each.
  // What is compared with constants alone Yosys 0.52 takes for the state of a machine, whose transitions it then looks for without end.
  (* fsm_encoding = "none" *)
  logic [WidthBits-1:0] power_zeros_q, cosine_zeros_q, share_zeros_q;
  logic [WidthBits-1:0] narrow_q, bound;
  logic [SpreadBits-1:0] power_reversed, power_highest_q;
  logic [CosineBits-1:0] cosine_reversed, cosine_highest_q;
  logic [ShareBits-1:0] share, share_reversed, share_highest_q;
  logic [WidthBits-1:0] power_zeros, cosine_zeros, share_zeros;
  for (genvar i = 0; i < SpreadBits; i++) begin : gen_reverse_power
    assign power_reversed[i] = spread_weight[SpreadBits-1-i];
  end
  for (genvar i = 0; i < CosineBits; i++) begin : gen_reverse_cosine
    assign cosine_reversed[i] = cosine_total_i[CosineBits-1-i];
  end
  for (genvar i = 0; i < ShareBits; i++) begin : gen_reverse_share
    assign share_reversed[i] = share[ShareBits-1-i];
  end
  if (Combine == 2) begin : gen_share
    logic [ShareBits-1:0] share_q;
    always_ff @(posedge clk_i) share_q <= ShareBits'(photons_i) + ShareBits'(CosineSamples);
    assign share = share_q;
  end else begin : gen_no_share
    assign share = 1'b1;
  end
  always_comb begin
    power_zeros = '0;
    for (int unsigned i = 0; i < SpreadBits; i++) begin
      if (power_highest_q[i]) power_zeros = power_zeros | WidthBits'(i);
    end
    cosine_zeros = '0;
    for (int unsigned i = 0; i < CosineBits; i++) begin
      if (cosine_highest_q[i]) cosine_zeros = cosine_zeros | WidthBits'(i);
    end
    share_zeros = '0;
    for (int unsigned i = 0; i < ShareBits; i++) begin
      if (share_highest_q[i]) share_zeros = share_zeros | WidthBits'(i);
    end
  end
  if (Combine == 0 || Combine == 2) begin : gen_bound_sum
    assign bound = WidthBits'(SpreadBits + CosineBits + ShareBits) - (power_zeros_q + cosine_zeros_q + share_zeros_q);
  end else if (Combine == 1) begin : gen_bound_product
    assign bound = WidthBits'(SpreadBits + BBits) - power_zeros_q;
  end else begin : gen_bound_alone
    assign bound = Combine == 3 && !no_power_q ? WidthBits'(SpreadBits) - power_zeros_q :
        WidthBits'(CosineBits) - cosine_zeros_q;
  end
  always_ff @(posedge clk_i) begin
    power_highest_q <= power_reversed & (~power_reversed + 1'b1);
    cosine_highest_q <= cosine_reversed & (~cosine_reversed + 1'b1);
    share_highest_q <= share_reversed & (~share_reversed + 1'b1);
    power_zeros_q <= power_zeros;
    cosine_zeros_q <= cosine_zeros;
    share_zeros_q <= share_zeros;
    narrow_q <= bound > WidthBits'(ProbabilityBits) ? bound - WidthBits'(ProbabilityBits) : '0;
  end
  logic unused;
  assign unused = &{1'b0, no_power_q, spread_i, spread_weight, cosine_total_i, photons_i, bound, share_zeros_q,
      cosine_zeros_q, power_zeros_q};

  // 9 and 10: shifted by its multiples of 8, then by the rest; what is left fits. The floor.
  localparam int unsigned ShiftedBits = ExactBits > FineBits ? ExactBits : FineBits;
  logic [FineBits-1:0] coarse10_q;
  logic [ProbabilityBits-1:0] narrow;
  logic [10+Delay:5] touches_q;
  assign narrow = ProbabilityBits'(coarse10_q >> narrow_q[2:0]);
  always_ff @(posedge clk_i) begin
    coarse10_q <= FineBits'(ShiftedBits'(exact9_q) >> {narrow_q[WidthBits-1:3], 3'b000});
    touches_q <= {touches_q[9+Delay:5], !highest[DotBits-1] && highest != '0};
    weight_o  <= !touches_q[10+Delay] ? '0 : narrow == '0 ? ProbabilityBits'(1) : narrow;
  end
endmodule
