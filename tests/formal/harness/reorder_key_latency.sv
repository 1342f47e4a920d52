// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/hilbert_index.sv rtl/reorder_buffer/reorder_key.sv
// reorder_key: the bin is that of the position Latency cycles before, whatever came before it and after. Of two keys that get any
// positions the bins are the same where the positions were.
module reorder_key_latency #(
    parameter int unsigned Key = 1,
    parameter int unsigned CellBits = 2
) (
    input logic clk_i,
    input logic [3*CellBits-1:0] a_i,
    input logic [3*CellBits-1:0] b_i
);
  localparam int unsigned Latency = Key == 1 ? CellBits : 3;
  localparam int unsigned BinBits = 3;
  logic [BinBits-1:0] bin_a, bin_b;
  reorder_key #(
      .Key(Key),
      .PositionBits(CellBits),
      .CellBits(CellBits),
      .Bins(1 << BinBits),
      .BinBits(BinBits)
  ) dut_a (
      .clk_i(clk_i),
      .position_i(a_i),
      .bin_o(bin_a)
  );
  reorder_key #(
      .Key(Key),
      .PositionBits(CellBits),
      .CellBits(CellBits),
      .Bins(1 << BinBits),
      .BinBits(BinBits)
  ) dut_b (
      .clk_i(clk_i),
      .position_i(b_i),
      .bin_o(bin_b)
  );

  logic [Latency-1:0] same_q = '0;
  always_ff @(posedge clk_i) same_q <= Latency'({same_q, a_i == b_i});
  always_comb if (same_q[Latency-1]) assert (bin_a == bin_b);
endmodule
