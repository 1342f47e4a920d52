// SPDX-License-Identifier: Apache-2.0
// package: tests/formal/harness/gatherer_pkg.sv
// sources: rtl/common/lut_ram.sv rtl/common/block_ram.sv rtl/common/block_ram_two_reads.sv rtl/common/skid_buffer.sv
// sources: rtl/common/fifo.sv rtl/common/less_than.sv rtl/common/lowest_bit.sv rtl/common/multiplier.sv
// sources: rtl/common/oct_decode.sv rtl/common/parity_check.sv rtl/common/squared_distance.sv rtl/common/reciprocal.sv
// sources: rtl/common/counter.sv rtl/common/arbiter.sv rtl/common/cache_lines.sv rtl/common/cache_victim.sv rtl/common/cache.sv
// sources: rtl/photon_gatherer/photon_gatherer.sv rtl/photon_gatherer/photon_gatherer_answers.sv
// sources: rtl/photon_gatherer/photon_gatherer_beat_queue.sv rtl/photon_gatherer/photon_gatherer_beats.sv
// sources: rtl/photon_gatherer/photon_gatherer_bounds.sv rtl/photon_gatherer/photon_gatherer_candidates.sv
// sources: rtl/photon_gatherer/photon_gatherer_contexts.sv rtl/photon_gatherer/photon_gatherer_counters.sv
// sources: rtl/photon_gatherer/photon_gatherer_decoder.sv rtl/photon_gatherer/photon_gatherer_descent.sv
// sources: rtl/photon_gatherer/photon_gatherer_ends.sv rtl/photon_gatherer/photon_gatherer_faults.sv
// sources: rtl/photon_gatherer/photon_gatherer_further_lines.sv rtl/photon_gatherer/photon_gatherer_lanes.sv
// sources: rtl/photon_gatherer/photon_gatherer_leaf_state.sv rtl/photon_gatherer/photon_gatherer_leaves.sv
// sources: rtl/photon_gatherer/photon_gatherer_list.sv rtl/photon_gatherer/photon_gatherer_lists.sv
// sources: rtl/photon_gatherer/photon_gatherer_next.sv rtl/photon_gatherer/photon_gatherer_node_memory.sv
// sources: rtl/photon_gatherer/photon_gatherer_nodes.sv rtl/photon_gatherer/photon_gatherer_pairs.sv
// sources: rtl/photon_gatherer/photon_gatherer_photons.sv rtl/photon_gatherer/photon_gatherer_registers.sv
// sources: rtl/photon_gatherer/photon_gatherer_results.sv rtl/photon_gatherer/photon_gatherer_stack.sv
// sources: rtl/photon_gatherer/photon_gatherer_start.sv rtl/photon_gatherer/photon_gatherer_sum.sv
// sources: rtl/photon_gatherer/photon_gatherer_tree.sv rtl/photon_gatherer/photon_gatherer_trees.sv
// photon_gatherer, whole: what it offers at each of its three ports, results, photons and requests of lines, stays and holds,
// bit for bit, until it is taken, whatever comes in, lines of memory that nobody asked for included. One bit of each, any,
// is followed.
module gatherer_ports (
    input logic clk_i,
    input logic rst_i,
    input logic in_valid_i,
    input photonloom_pkg::gather_query_t in_i,
    input logic result_ready_i,
    input logic photon_ready_i,
    input logic line_req_ready_i,
    input logic line_rsp_valid_i,
    input logic line_rsp_tag_i,
    input logic [15:0] line_rsp_data_i,
    input logic cfg_valid_i,
    input logic [23:0] cfg_addr_i,
    input logic [63:0] cfg_data_i,
    output logic in_ready,
    output logic result_valid,
    output logic photon_valid,
    output logic line_req_valid
);
  (* anyconst *) logic [5:0] followed;
  photonloom_pkg::gather_result_t result;
  photonloom_pkg::gather_photon_t photon;
  logic [photonloom_pkg::LineAddressBits:0] line_req_addr;
  logic line_req_tag;

  photon_gatherer dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i),
      .in_ready_o(in_ready),
      .in_i(in_i),
      .result_valid_o(result_valid),
      .result_ready_i(result_ready_i),
      .result_o(result),
      .photon_valid_o(photon_valid),
      .photon_ready_i(photon_ready_i),
      .photon_o(photon),
      .line_req_valid_o(line_req_valid),
      .line_req_ready_i(line_req_ready_i),
      .line_req_addr_o(line_req_addr),
      .line_req_tag_o(line_req_tag),
      .line_rsp_valid_i(line_rsp_valid_i),
      .line_rsp_tag_i(line_rsp_tag_i),
      .line_rsp_data_i(line_rsp_data_i),
      .cfg_valid_i(cfg_valid_i),
      .cfg_addr_i(cfg_addr_i),
      .cfg_data_i(cfg_data_i),
      .shared_node_address_o(),
      .shared_node_data_i(4'd0),
      .count_busy_o(),
      .count_queries_o(),
      .count_nodes_o(),
      .count_dropped_o(),
      .count_leaves_o(),
      .count_candidates_o(),
      .count_insertions_o(),
      .count_cache_hits_o(),
      .count_cache_misses_o(),
      .count_stalled_in_o(),
      .count_stalled_results_o(),
      .count_stalled_photons_o(),
      .count_stalled_lines_o(),
      .count_faults_o()
  );

  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;
  always_comb assume (rst_i == !started_q);

  // Of each port: that a word was refused, and its followed bit.
  logic [63:0] result_bits, photon_bits, line_bits;
  logic [2:0] shown, shown_q, stalled_q;
  assign result_bits = 64'(result);
  assign photon_bits = 64'(photon);
  assign line_bits = 64'({line_req_addr, line_req_tag});
  assign shown = {line_bits[followed], photon_bits[followed], result_bits[followed]};
  always_ff @(posedge clk_i) begin
    stalled_q <= rst_i ? '0 : {line_req_valid, photon_valid, result_valid} & ~{line_req_ready_i, photon_ready_i, result_ready_i};
    shown_q   <= shown;
  end
  always_comb begin
    if (!rst_i) begin
      if (stalled_q[0]) assert (result_valid && shown[0] == shown_q[0]);
      if (stalled_q[1]) assert (photon_valid && shown[1] == shown_q[1]);
      if (stalled_q[2]) assert (line_req_valid && shown[2] == shown_q[2]);
    end
  end
endmodule
