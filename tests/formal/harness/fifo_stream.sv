// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/lut_ram.sv rtl/common/fifo.sv tests/formal/harness/stream_checks.sv
// fifo keeps the laws of a stream.
module fifo_stream #(
    parameter int unsigned Depth = 4,
    parameter int unsigned Ahead = 0,
    parameter bit ValidAhead = 1'b0,
    parameter int unsigned Order = 1,
    parameter int unsigned Law = 1,
    parameter int unsigned Progress = 1
) (
    input logic clk_i,
    input logic rst_i,
    input logic in_valid_i,
    input logic in_i,
    input logic out_ready_i
);
  logic in_ready, out_valid, out;

  fifo #(
      .Width(1),
      .Depth(Depth),
      .Ahead(Ahead),
      .ValidAhead(ValidAhead)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i),
      .in_ready_o(in_ready),
      .in_i(in_i),
      .out_valid_o(out_valid),
      .out_ready_i(out_ready_i),
      .out_o(out)
  );

  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;
  always_comb assume (rst_i == !started_q);

  stream_checks #(
      .Order(Order),
      .Law(Law),
      .Progress(Progress),
      .Limit(Depth)
  ) checks (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i),
      .in_ready_i(in_ready),
      .in_i(in_i),
      .out_valid_i(out_valid),
      .out_ready_i(out_ready_i),
      .out_i(out)
  );
endmodule
