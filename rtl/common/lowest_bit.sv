// SPDX-License-Identifier: Apache-2.0
// Number of the lowest set bit. Combinational: one carry chain to isolate the bit, then an OR tree for each bit of the
// number. index_o is 0 where no bit is set.
module lowest_bit #(
    parameter int unsigned Width = 16,
    localparam int unsigned IndexBits = Width > 1 ? $clog2(Width) : 1
) (
    input  logic [    Width-1:0] bits_i,
    output logic                 any_o,
    output logic [IndexBits-1:0] index_o
);
  logic [Width-1:0] isolated;

  assign any_o = |bits_i;
  assign isolated = bits_i & (~bits_i + 1'b1);

  always_comb begin
    index_o = '0;
    for (int unsigned i = 0; i < Width; i++) begin
      if (isolated[i]) index_o = index_o | IndexBits'(i);
    end
  end
endmodule
