// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/lut_ram.sv rtl/common/block_ram.sv rtl/common/lowest_bit.sv rtl/common/skid_buffer.sv rtl/common/skid_buffer_ahead.sv
// sources: rtl/common/fifo.sv rtl/common/counter.sv rtl/common/hilbert_index.sv
// sources: rtl/reorder_buffer/free_list.sv rtl/reorder_buffer/pool_ram.sv rtl/reorder_buffer/reorder_counts.sv
// sources: rtl/reorder_buffer/reorder_fullest.sv rtl/reorder_buffer/reorder_key.sv rtl/reorder_buffer/reorder_lists.sv
// sources: rtl/reorder_buffer/reorder_sweep_counts.sv rtl/reorder_buffer/reorder_sweep_scan.sv
// sources: rtl/reorder_buffer/reorder_sweep.sv rtl/reorder_buffer/reorder_buffer.sv
// reorder_buffer that reorders, whole: in_ready and out_valid, for paths.
module reorder_ports #(
    parameter int unsigned Key = 1,
    parameter int unsigned Drain = 0
) (
    input logic clk_i,
    input logic rst_i,
    input logic in_valid_i,
    input photonloom_pkg::gather_query_t in_i,
    input logic out_ready_i,
    output logic in_ready,
    output logic out_valid
);
  photonloom_pkg::gather_query_t out;
  reorder_buffer #(
      .Key(Key),
      .Drain(Drain),
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
endmodule
