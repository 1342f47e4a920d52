// SPDX-License-Identifier: Apache-2.0
// TB, the sum of B(c) = max(0, o(c) . o(n)) J(c) over all cells, in ceil((2^(CellBits-1) + 1) / 2) steps instead of
// 4^CellBits: the cells whose centres differ in signs only share J, and with a, b, c = |x nx|, |y ny|, |z nz| the eight of
// them add up to max(2 (a + b + c), 4 max(a, b, c)); the four of a centre on the octahedron's equator to half of that.
// Step 0 comes 2 cycles after start_i, last_o with the last step and next_last_o a cycle before it, the total 6 cycles after
// last_o; start_i begins anew at any time.
module cdf_sampler_cosine_total #(
    parameter int unsigned CellBits = 4,
    parameter int unsigned NormalBits = 8,
    parameter int unsigned TotalBits = 28
) (
    input  logic                    clk_i,
    input  logic                    rst_i,
    input  logic                    start_i,
    input  logic [2*NormalBits-1:0] normal_i,  // octahedral code, v high, u low
    output logic                    last_o,    // and after it, until the cycle after start_i
    output logic                    next_last_o,
    output logic [   TotalBits-1:0] total_o
);
  localparam int unsigned Half = 1 << (CellBits - 1);
  // Rows j and Half - 1 - j of the first quadrant's triangle have Half + 1 cells together: a track. Two lanes share it.
  localparam int unsigned Tracks = Half > 1 ? Half / 2 : 1;
  localparam int unsigned Length = Half > 1 ? Half + 1 : 1;
  localparam int unsigned Steps = (Length + 1) / 2;
  localparam int unsigned LanesOfTrack = Half > 1 ? 2 : 1;
  localparam int unsigned Lanes = Tracks * LanesOfTrack;
  localparam int unsigned StepBits = $clog2(Steps + 1);
  localparam int unsigned PlaceBits = $clog2(2 * Steps + 1);
  localparam int unsigned TermBits = CellBits + NormalBits + 1;  // a, b, c
  localparam int unsigned IndexBits = CellBits > 1 ? CellBits - 1 : 1;

  logic [StepBits-1:0] step_q;
  logic start_q, running_q;
  logic [3:0] valid_q;
  assign last_o = !(start_q || (running_q && step_q != StepBits'(Steps - 1)));
  assign next_last_o = Steps == 1 || last_o || (running_q && !start_q && step_q == StepBits'(Steps - 2));

  // value * factor by additions and subtractions, the factors being small constants: 15 is 16 - 1.
  function automatic [TermBits-1:0] times(input [NormalBits:0] value, input integer factor);
    integer i, rest;
    begin
      times = '0;
      rest  = factor;
      for (i = 0; i < CellBits + 2; i = i + 1) begin
        if (rest % 4 == 3) begin
          times = times - (TermBits'(value) << i);
          rest  = rest + 1;
        end else if (rest % 2 == 1) begin
          times = times + (TermBits'(value) << i);
        end
        rest = rest / 2;
      end
    end
  endfunction

  // Magnitudes of the decoded normal. Those of a code's coordinates are its bits below the sign; below the equator the
  // octahedron folds x and y over.
  localparam logic [NormalBits:0] One = (NormalBits + 1)'(1) << NormalBits;
  logic [NormalBits:0] flat_x, flat_y, x_q, y_q, z_q;
  logic [NormalBits+1:0] height;
  assign flat_x = {1'b0, normal_i[0+:NormalBits-1] ^ {(NormalBits - 1) {!normal_i[NormalBits-1]}}, 1'b1};
  assign flat_y = {1'b0, normal_i[NormalBits+:NormalBits-1] ^ {(NormalBits - 1) {!normal_i[2*NormalBits-1]}}, 1'b1};
  assign height = {1'b0, One} - {1'b0, flat_x} - {1'b0, flat_y};
  always_ff @(posedge clk_i) begin
    if (start_i) begin
      x_q <= height[NormalBits+1] ? One - flat_y : flat_x;
      y_q <= height[NormalBits+1] ? One - flat_x : flat_y;
      z_q <= (NormalBits + 1)'(height[NormalBits+1] ? -height : height);
    end
  end

  logic [Lanes*TotalBits-1:0] products;
  for (genvar lane = 0; lane < Lanes; lane++) begin : gen_lane
    localparam int unsigned Track = lane / LanesOfTrack;
    localparam int unsigned First = (lane % LanesOfTrack) * Steps;  // its first place on the track
    localparam int unsigned Other = Half - 1 - Track;
    localparam int unsigned Turn = Half - 1 - Track;  // last place on the track's first row
    localparam int unsigned FirstRow = First <= Turn ? Track : Other;
    localparam int unsigned FirstColumn = First <= Turn ? First : First - Turn - 1;

    logic [TermBits-1:0] a_q, b_q, c_q, turned_b_q, largest_q;
    logic [TermBits+1:0] sum_q;
    logic [TermBits+2:0] octants_q;
    logic [PlaceBits-1:0] place;
    logic equator, equator1_q, inside1_q, turning, turned;
    logic [IndexBits-1:0] column, row;
    logic [7:0] jacobian, jacobian1_q, jacobian2_q;
    logic [TotalBits-1:0] product_q;

    assign place = PlaceBits'(First) + PlaceBits'(step_q);
    assign turning = place == PlaceBits'(Turn);
    assign turned = place > PlaceBits'(Turn);
    assign column = IndexBits'(turned ? place - PlaceBits'(Turn) - 1'b1 : place);
    assign row = turned ? IndexBits'(Other) : IndexBits'(Track);
    assign equator = turning || place == PlaceBits'(Length - 1);

    cdf_sampler_jacobian #(
        .CellBits(CellBits)
    ) table_of_cells (
        .column_i(column),
        .row_i(row),
        .jacobian_o(jacobian)
    );

    always_ff @(posedge clk_i) begin
      turned_b_q <= times(y_q, 2 * Other + 1);  // stands before the first step
      if (start_q) begin
        a_q <= times(x_q, 2 * FirstColumn + 1);
        b_q <= times(y_q, 2 * FirstRow + 1);
        c_q <= times(z_q, 2 * Half - 2 - 2 * FirstRow - 2 * FirstColumn);
      end else if (turning) begin
        a_q <= TermBits'(x_q);
        b_q <= turned_b_q;
        c_q <= times(z_q, 2 * Half - 2 - 2 * Other);
      end else begin
        a_q <= a_q + (TermBits'(x_q) << 1);
        c_q <= c_q - (TermBits'(z_q) << 1);
      end

      sum_q <= (TermBits + 2)'(a_q) + (TermBits + 2)'(b_q) + (TermBits + 2)'(c_q);
      largest_q <= a_q >= b_q ? (a_q >= c_q ? a_q : c_q) : (b_q >= c_q ? b_q : c_q);
      equator1_q <= equator;
      inside1_q <= place < PlaceBits'(Length);
      jacobian1_q <= jacobian;

      octants_q <= !inside1_q ? '0 :
          (sum_q >= {1'b0, largest_q, 1'b0} ? {sum_q, 1'b0} : {1'b0, largest_q, 2'b00}) >> equator1_q;
      jacobian2_q <= jacobian1_q;

      product_q <= TotalBits'(octants_q) * TotalBits'(jacobian2_q);
    end
    assign products[TotalBits*lane+:TotalBits] = product_q;
  end

  // Half of the lanes each, both halves into the total a cycle later.
  logic [TotalBits-1:0] low_sum, high_sum, low_lanes_q, high_lanes_q, total_q;
  always_comb begin
    low_sum  = '0;
    high_sum = '0;
    for (int unsigned i = 0; i < Lanes; i++) begin
      if (2 * i < Lanes) low_sum = low_sum + products[TotalBits*i+:TotalBits];
      else high_sum = high_sum + products[TotalBits*i+:TotalBits];
    end
  end

  always_ff @(posedge clk_i) begin
    start_q <= start_i;
    step_q <= start_q ? '0 : step_q + 1'b1;
    running_q <= start_q || (running_q && step_q != StepBits'(Steps - 1));
    valid_q <= {valid_q[2:0], running_q};
    low_lanes_q <= low_sum;
    high_lanes_q <= high_sum;
    if (valid_q[3]) total_q <= total_q + low_lanes_q + high_lanes_q;
    total_o <= total_q;  // on its way from an adder to multipliers for a cycle
    if (start_q) begin
      valid_q <= '0;
      total_q <= '0;
    end
    if (rst_i) begin
      start_q   <= 1'b0;
      running_q <= 1'b0;
      valid_q   <= '0;
    end
  end
endmodule
