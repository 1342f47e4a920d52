// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/skid_buffer.sv tests/formal/harness/stream_checks.sv
// skid_buffer keeps the laws of a stream.
module skid_buffer_stream #(
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

  skid_buffer #(
      .Width(1)
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
      .Limit(2)
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
