// SPDX-License-Identifier: Apache-2.0
// In place of reorder_sweep and reorder_fullest: at any time any bin may be chosen that holds something. That the real ones
// choose no empty bin is proved by themselves.
module reorder_choice_any #(
    parameter int unsigned BinBits = 9,
    parameter int unsigned CountBits = 12
) (
    input  logic               clk_i,
    input  logic               rst_i,
    output logic               ready_o,
    input  logic               insert_i,
    input  logic [BinBits-1:0] insert_bin_i,
    input  logic               take_i,
    output logic               take_ready_o,
    output logic               take_alone_o,
    output logic [BinBits-1:0] bin_o
);
  localparam int unsigned Bins = 1 << BinBits;
  (* anyseq *) logic ready, take_ready, take_alone;
  (* anyseq *) logic [BinBits-1:0] bin;
  assign ready_o = ready;
  assign take_ready_o = take_ready;
  assign take_alone_o = take_alone;
  assign bin_o = bin;

  logic taken;
  assign taken = take_i && take_ready;
  logic [Bins*CountBits-1:0] counts_q;  // packets of each bin
  logic [Bins-1:0] some;
  for (genvar b = 0; b < Bins; b++) begin : gen_bin
    assign some[b] = counts_q[CountBits*b+:CountBits] != '0;
    always_ff @(posedge clk_i) begin
      counts_q[CountBits*b+:CountBits] <= counts_q[CountBits*b+:CountBits] +
          CountBits'(insert_i && insert_bin_i == BinBits'(b)) - CountBits'(taken && bin == BinBits'(b));
      if (rst_i) counts_q[CountBits*b+:CountBits] <= '0;
    end
  end
  always_comb if (!rst_i && taken) assume (some[bin]);
endmodule

module reorder_sweep #(
    parameter int unsigned BinBits = 9,
    parameter int unsigned CountBits = 12
) (
    input  logic               clk_i,
    input  logic               rst_i,
    input  logic               clear_i,
    output logic               ready_o,
    input  logic               insert_i,
    input  logic [BinBits-1:0] insert_bin_i,
    input  logic               full_i,
    input  logic               take_i,
    output logic               take_ready_o,
    output logic               take_alone_o,
    output logic [BinBits-1:0] bin_o
);
  reorder_choice_any #(
      .BinBits(BinBits),
      .CountBits(CountBits)
  ) any (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .ready_o(ready_o),
      .insert_i(insert_i),
      .insert_bin_i(insert_bin_i),
      .take_i(take_i),
      .take_ready_o(take_ready_o),
      .take_alone_o(take_alone_o),
      .bin_o(bin_o)
  );
endmodule

module reorder_fullest #(
    parameter int unsigned BinBits = 9,
    parameter int unsigned CountBits = 12
) (
    input  logic               clk_i,
    input  logic               rst_i,
    input  logic               clear_i,
    output logic               ready_o,
    input  logic               insert_i,
    input  logic [BinBits-1:0] insert_bin_i,
    input  logic               take_i,
    output logic               take_ready_o,
    output logic               take_alone_o,
    output logic [BinBits-1:0] bin_o
);
  reorder_choice_any #(
      .BinBits(BinBits),
      .CountBits(CountBits)
  ) any (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .ready_o(ready_o),
      .insert_i(insert_i),
      .insert_bin_i(insert_bin_i),
      .take_i(take_i),
      .take_ready_o(take_ready_o),
      .take_alone_o(take_alone_o),
      .bin_o(bin_o)
  );
endmodule
