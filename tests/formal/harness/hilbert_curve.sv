// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/hilbert_index.sv
// hilbert_index of two cells, any: equal indices are of the same cell, so that it is a bijection; indices that follow each
// other are of cells that share a face; the first 3 j bits of the index follow from the first j of each coordinate.
module hilbert_curve #(
    parameter int unsigned Bits = 4
) (
    input logic clk_i
);
  localparam int unsigned AgeBits = $clog2(Bits + 2);
  (* anyconst *) logic [3*Bits-1:0] cell_a, cell_b;
  logic [3*Bits-1:0] index_a, index_b;

  hilbert_index #(
      .Bits(Bits)
  ) dut_a (
      .clk_i(clk_i),
      .cell_i(cell_a),
      .index_o(index_a)
  );
  hilbert_index #(
      .Bits(Bits)
  ) dut_b (
      .clk_i(clk_i),
      .cell_i(cell_b),
      .index_o(index_b)
  );

  logic [AgeBits-1:0] age_q = '0;
  // Looked at once, when the index of both is there.
  always_ff @(posedge clk_i) if (age_q != AgeBits'(Bits + 1)) age_q <= age_q + 1'b1;

  // Steps between the cells, over all axes.
  logic [Bits+1:0] steps;
  always_comb begin
    steps = '0;
    for (int unsigned c = 0; c < 3; c++) begin
      if (cell_a[Bits*c+:Bits] > cell_b[Bits*c+:Bits])
        steps = steps + (Bits + 2)'(cell_a[Bits*c+:Bits] - cell_b[Bits*c+:Bits]);
      else steps = steps + (Bits + 2)'(cell_b[Bits*c+:Bits] - cell_a[Bits*c+:Bits]);
    end
  end

  logic [Bits-1:0] same;  // the first bits of all coordinates, from the top bit down to this one
  for (genvar b = 0; b < Bits; b++) begin : gen_same
    assign same[b] = (cell_a[Bits-1:b] == cell_b[Bits-1:b]) && (cell_a[2*Bits-1:Bits+b] == cell_b[2*Bits-1:Bits+b]) &&
        (cell_a[3*Bits-1:2*Bits+b] == cell_b[3*Bits-1:2*Bits+b]);
  end

  always_comb begin
    if (age_q == AgeBits'(Bits)) begin
      assert (index_a != index_b || cell_a == cell_b);
      assert ({1'b0, index_a} + 1'b1 != {1'b0, index_b} || steps == 1);
    end
  end
  for (genvar b = 0; b < Bits; b++) begin : gen_prefix
    always_comb begin
      if (age_q == AgeBits'(Bits) && same[b]) assert (index_a[3*Bits-1:3*b] == index_b[3*Bits-1:3*b]);
    end
  end
endmodule
