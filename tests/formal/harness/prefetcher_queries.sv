// SPDX-License-Identifier: Apache-2.0
// package: tests/formal/harness/prefetcher_pkg.sv
// sources: rtl/common/lut_ram.sv rtl/common/block_ram.sv rtl/common/ram_fifo.sv rtl/common/squared_distance.sv
// sources: rtl/photon_gatherer/photon_gatherer_registers.sv rtl/photon_gatherer/photon_gatherer_node_memory.sv
// sources: rtl/photon_gatherer/photon_gatherer_nodes.sv rtl/board/line_prefetcher.sv tests/formal/harness/stream_checks.sv
// line_prefetcher: queries keep the laws of a stream, whatever lines are asked for and whatever comes back. One bit of a query,
// any, is followed.
module prefetcher_queries #(
    parameter int unsigned Order = 1,
    parameter int unsigned Law = 1,
    parameter int unsigned Progress = 1
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
    input logic [1:0] line_rsp_tag_i,
    output logic in_ready,
    output logic out_valid,
    output logic line_req_valid
);
  localparam int unsigned Ahead = 2;
  localparam int unsigned QueryBits = photonloom_pkg::GatherQueryPacketBits;
  (* anyconst *) logic [2:0] followed;
  logic [QueryBits-1:0] sent, out;

  line_prefetcher #(
      .Ahead(Ahead),
      .Requests(2)
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
      .out_valid_o(out_valid),
      .out_ready_i(out_ready_i),
      .out_o(out),
      .line_req_valid_o(line_req_valid),
      .line_req_ready_i(line_req_ready_i),
      .line_req_addr_o(),
      .line_req_tag_o(),
      .line_rsp_valid_i(line_rsp_valid_i),
      .line_rsp_tag_i(line_rsp_tag_i),
      .busy_o()
  );
  assign sent = in_i;

  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;
  always_comb begin
    assume (rst_i == !started_q);
    assume (followed < 3'(QueryBits));
  end

  stream_checks #(
      .Order(Order),
      .Law(Law),
      .Progress(Progress),
      .Limit(Ahead + 3)
  ) checks (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i),
      .in_ready_i(in_ready),
      .in_i(sent[followed]),
      .out_valid_i(out_valid),
      .out_ready_i(out_ready_i),
      .out_i(out[followed])
  );
endmodule
