// SPDX-License-Identifier: Apache-2.0
// package: tests/formal/harness/prefetcher_pkg.sv
// sources: rtl/common/lut_ram.sv tests/formal/harness/stubs/block_ram.sv tests/formal/harness/stubs/ram_fifo.sv
// sources: rtl/common/squared_distance.sv rtl/photon_gatherer/photon_gatherer_registers.sv
// sources: rtl/photon_gatherer/photon_gatherer_node_memory.sv rtl/photon_gatherer/photon_gatherer_nodes.sv
// sources: rtl/board/line_prefetcher.sv
// line_prefetcher: a line is asked for by a tag of which every line before came whole, so at most Requests are on their way; a
// request stays and holds, bit for bit, until it is taken. Where busy_o is 0 no line is on its way, nor is one asked for before another
// query came. Queries and trees are any.
//
// A memory answers what it was asked for, in any order, once, after any time, all beats of a line on end.
module prefetcher_requests #(
    parameter int unsigned What = 0,  // 0: tags, 1: the law of requests, 2: busy_o
    localparam int unsigned Requests = 2
) (
    input logic clk_i,
    input logic rst_i,
    input logic cfg_valid_i,
    input logic [23:0] cfg_addr_i,
    input logic [63:0] cfg_data_i,
    input logic in_valid_i,
    input photonloom_pkg::gather_query_t in_i,
    input logic out_ready_i,
    input logic line_req_ready_i,
    input logic line_rsp_valid_i,
    input logic [1:0] line_rsp_tag_i
);
  localparam int unsigned WordBits = photonloom_pkg::LineTagBits + photonloom_pkg::LineAddressBits + 1;
  logic req_valid, in_ready, busy;
  logic [photonloom_pkg::LineTagBits-1:0] req_tag;
  logic [photonloom_pkg::LineAddressBits:0] req_addr;

  line_prefetcher #(
      .Ahead(2),
      .Requests(Requests)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .cfg_valid_i(cfg_valid_i),
      .cfg_addr_i(cfg_addr_i),
      .cfg_data_i(cfg_data_i),
      .shared_node_address_o(),
      .shared_node_data_i(3'd0),
      .in_valid_i(in_valid_i),
      .in_ready_o(in_ready),
      .in_i(in_i),
      .out_valid_o(),
      .out_ready_i(out_ready_i),
      .out_o(),
      .line_req_valid_o(req_valid),
      .line_req_ready_i(line_req_ready_i),
      .line_req_addr_o(req_addr),
      .line_req_tag_o(req_tag),
      .line_rsp_valid_i(line_rsp_valid_i),
      .line_rsp_tag_i(line_rsp_tag_i),
      .busy_o(busy)
  );

  logic started_q = 1'b0;
  logic [3:0] asked_q;  // of each tag: a line is on its way
  logic [2:0] on_way_q;
  logic [1:0] beat_q;  // of a line of four
  logic [1:0] line_tag_q;
  logic taken, came;
  logic stalled_q, idle_q;
  logic [WordBits-1:0] shown_q;
  assign taken = req_valid && line_req_ready_i;
  assign came = line_rsp_valid_i && beat_q == 2'd3;
  always_ff @(posedge clk_i) begin
    started_q <= 1'b1;
    if (came) asked_q[line_rsp_tag_i] <= 1'b0;
    if (taken) asked_q[req_tag] <= 1'b1;
    on_way_q <= on_way_q + 3'(taken) - 3'(came);
    if (line_rsp_valid_i) begin
      beat_q <= beat_q + 1'b1;
      line_tag_q <= line_rsp_tag_i;
    end
    stalled_q <= !rst_i && req_valid && !line_req_ready_i;
    shown_q <= {req_tag, req_addr};
    idle_q <= !rst_i && !busy && !(in_valid_i && in_ready);
    if (rst_i) begin
      asked_q <= '0;
      on_way_q <= '0;
      beat_q <= '0;
    end
  end

  always_comb begin
    assume (rst_i == !started_q);
    if (rst_i) assume (!line_rsp_valid_i);
    if (!rst_i) begin
      if (beat_q != '0) assume (line_rsp_valid_i && line_rsp_tag_i == line_tag_q);
      else if (line_rsp_valid_i) assume (asked_q[line_rsp_tag_i]);
    end
  end

  always_comb begin
    if (!rst_i) begin
      if (What == 0) begin
        if (req_valid) assert (!asked_q[req_tag]);
        assert (3'(req_valid) + on_way_q <= 3'(Requests));
      end
      if (What == 1 && stalled_q) assert (req_valid && {req_tag, req_addr} == shown_q);
      if (What == 2) begin
        if (!busy) assert (on_way_q == '0 && !req_valid);
        if (idle_q) assert (!busy);
      end
    end
  end
endmodule
