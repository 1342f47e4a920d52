// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/less_than.sv rtl/common/lowest_bit.sv rtl/common/oct_decode.sv rtl/common/squared_distance.sv
// less_than, lowest_bit, oct_decode and squared_distance against what they are to compute, of all operands at once; one of
// them, chosen by Unit from 0.
module arithmetic #(
    parameter int unsigned Unit = 0,
    parameter int unsigned Bits = 6
) (
    input logic clk_i
);
  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;

  if (Unit == 0) begin : gen_less_than
    (* anyseq *) logic [Bits-1:0] a, b;
    logic less;
    less_than #(
        .Width(Bits)
    ) dut (
        .a_i(a),
        .b_i(b),
        .less_o(less)
    );
    always_comb if (started_q) assert (less == (a < b));
  end else if (Unit == 1) begin : gen_lowest_bit
    localparam int unsigned IndexBits = $clog2(Bits);
    (* anyseq *) logic [Bits-1:0] bits;
    (* anyseq *) logic [IndexBits-1:0] other;
    logic any;
    logic [IndexBits-1:0] index;
    lowest_bit #(
        .Width(Bits)
    ) dut (
        .bits_i(bits),
        .any_o(any),
        .index_o(index)
    );
    always_comb if (started_q) begin
      assert (any == (bits != '0));
      if (any) assert (bits[index]);
      if (other < index) assert (!bits[other]);
    end
  end else if (Unit == 2) begin : gen_oct_decode
    // |x| + |y| + |z| = 2^Bits; the upper half is the code's own point, the lower half is folded, its point outside.
    localparam int unsigned OutBits = Bits + 2;
    localparam logic signed [OutBits-1:0] One = OutBits'(1) << Bits;
    (* anyseq *) logic [2*Bits-1:0] code;
    logic [3*OutBits-1:0] direction;
    logic signed [OutBits-1:0] x, y, z, s, t, abs_x, abs_y, abs_z, abs_s, abs_t;
    oct_decode #(
        .Bits(Bits)
    ) dut (
        .code_i(code),
        .direction_o(direction)
    );
    assign {z, y, x} = direction;
    assign s = signed'({1'b0, code[Bits-1:0], 1'b1}) - One;
    assign t = signed'({1'b0, code[2*Bits-1:Bits], 1'b1}) - One;
    assign abs_x = x < 0 ? -x : x;
    assign abs_y = y < 0 ? -y : y;
    assign abs_z = z < 0 ? -z : z;
    assign abs_s = s < 0 ? -s : s;
    assign abs_t = t < 0 ? -t : t;
    always_comb if (started_q) begin
      assert (abs_x + abs_y + abs_z == One);
      assert ((z < 0) == (abs_s + abs_t > One));
      if (z >= 0) assert (x == s && y == t);
      else assert (abs_x == One - abs_t && abs_y == One - abs_s && (x < 0) == (s < 0) && (y < 0) == (t < 0));
    end
  end else begin : gen_squared_distance
    localparam int unsigned Stages = Unit - 1;  // 2 or 3
    (* anyconst *) logic [3*Bits-1:0] offset;
    logic [2*Bits-1:0] sum, square0, square1, square2;
    logic [2:0] age_q = '0;
    squared_distance #(
        .Bits(Bits),
        .Stages(Stages)
    ) dut (
        .clk_i(clk_i),
        .offset_i(offset),
        .sum_o(sum)
    );
    function automatic logic [2*Bits-1:0] square(input logic signed [Bits-1:0] value);
      logic [Bits-1:0] magnitude;
      magnitude = value < 0 ? -value : value;
      square = (2 * Bits)'(magnitude) * (2 * Bits)'(magnitude);
    endfunction
    assign square0 = square(offset[0+:Bits]);
    assign square1 = square(offset[Bits+:Bits]);
    assign square2 = square(offset[2*Bits+:Bits]);
    always_ff @(posedge clk_i) if (age_q != 3'(Stages + 1)) age_q <= age_q + 1'b1;
    always_comb begin
      if (age_q == 3'(Stages)) assert ({2'b00, sum} == {2'b00, square0} + {2'b00, square1} + {2'b00, square2});
    end
  end
endmodule
