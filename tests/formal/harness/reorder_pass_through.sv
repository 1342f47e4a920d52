// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/lut_ram.sv rtl/common/block_ram.sv rtl/common/lowest_bit.sv rtl/common/skid_buffer.sv rtl/common/skid_buffer_ahead.sv
// sources: rtl/common/fifo.sv rtl/common/counter.sv rtl/common/hilbert_index.sv
// sources: rtl/reorder_buffer/free_list.sv rtl/reorder_buffer/pool_ram.sv rtl/reorder_buffer/reorder_counts.sv
// sources: rtl/reorder_buffer/reorder_fullest.sv rtl/reorder_buffer/reorder_key.sv rtl/reorder_buffer/reorder_lists.sv
// sources: rtl/reorder_buffer/reorder_sweep_counts.sv rtl/reorder_buffer/reorder_sweep_scan.sv
// sources: rtl/reorder_buffer/reorder_sweep.sv rtl/reorder_buffer/reorder_buffer.sv
// sources: tests/formal/harness/stream_checks.sv
// reorder_buffer that passes through (Key 0): packets and flushes come out once, unchanged, in order, by the law of streams,
// without deadlock. One bit of the packet, any, is followed.
module reorder_pass_through (
    input logic clk_i,
    input logic rst_i,
    input logic in_valid_i,
    input photonloom_pkg::gather_query_t in_i,
    input logic out_ready_i
);
  (* anyconst *) logic [2:0] followed;
  logic in_ready, out_valid;
  photonloom_pkg::gather_query_t out;

  reorder_buffer #(
      .Key(0),
      .Drain(0),
      .Packets(4),
      .Bins(4),
      .CellBits(1),
      .PositionBits(1)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i),
      .in_ready_o(in_ready),
      .in_i(in_i),
      .out_valid_o(out_valid),
      .out_ready_i(out_ready_i),
      .out_o(out),
      .count_packets_o(),
      .count_flushes_o(),
      .count_cycles_busy_o(),
      .count_choice_waits_o()
  );

  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;
  always_comb assume (rst_i == !started_q);
  always_comb assume (followed < 3'd7);

  logic [6:0] in_bits, out_bits;
  assign in_bits  = in_i;
  assign out_bits = out;
  stream_checks #(
      .Limit(2)
  ) checks (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i),
      .in_ready_i(in_ready),
      .in_i(in_bits[followed]),
      .out_valid_i(out_valid),
      .out_ready_i(out_ready_i),
      .out_i(out_bits[followed])
  );
endmodule
