// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/lut_ram.sv rtl/common/fifo.sv rtl/photon_gatherer/photon_gatherer_uncached.sv tests/formal/harness/stream_checks.sv
// photon_gatherer_uncached: leaves are asked for once, in their order, each by the tag of its context, and keep the laws of a
// stream. A line is announced where there is room for it, and only then: one for each request.
//
// Word 0: what is followed is an address; 1: a context. Where Progress is 1 there is always room.
module uncached_requests #(
    parameter int unsigned Word = 0,
    parameter int unsigned Order = 1,
    parameter int unsigned Law = 1,
    parameter int unsigned Progress = 1
) (
    input logic clk_i,
    input logic rst_i,
    input logic in_valid_i,
    input logic [1:0] in_context_i,
    input logic in_address_i,
    input logic ready_i,
    input logic line_req_ready_i
);
  localparam int unsigned Contexts = 4;
  localparam int unsigned Limit = 2 * Contexts;
  logic issue, line_req_valid, line_req_addr;
  logic [1:0] line_req_tag;

  photon_gatherer_uncached #(
      .Contexts(Contexts),
      .AddressBits(1),
      .Items(1),
      .ItemBytes(1),
      .ItemBits(1),
      .Parts(1),
      .BeatBits(8)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i),
      .in_context_i(in_context_i),
      .in_address_i(in_address_i),
      .ready_i(ready_i),
      .issue_o(issue),
      .out_valid_o(),
      .out_context_o(),
      .out_part_o(),
      .out_data_o(),
      .out_wrong_o(),
      .line_req_valid_o(line_req_valid),
      .line_req_ready_i(line_req_ready_i),
      .line_req_addr_o(line_req_addr),
      .line_req_tag_o(line_req_tag),
      .line_rsp_valid_i(1'b0),
      .line_rsp_tag_i(2'd0),
      .line_rsp_data_i(8'd0)
  );

  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;
  always_comb assume (rst_i == !started_q);

  // As many leaves as contexts at most are on their way to a request.
  logic [2:0] inside_q;
  logic taken;
  assign taken = line_req_valid && line_req_ready_i;
  always_ff @(posedge clk_i) begin
    inside_q <= inside_q + 3'(in_valid_i) - 3'(taken);
    if (rst_i) inside_q <= '0;
  end
  always_comb begin
    if (in_valid_i) assume (inside_q < 3'(Contexts));
    if (Progress == 1) assume (ready_i);
    if (Word == 1) assume (!in_context_i[1]);
  end

  stream_checks #(
      .Order(Order),
      .Law(Law),
      .Progress(Progress),
      .Limit(Limit)
  ) checks (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i),
      .in_ready_i(1'b1),
      .in_i(Word == 1 ? in_context_i[0] : in_address_i),
      .out_valid_i(line_req_valid),
      .out_ready_i(line_req_ready_i),
      .out_i(Word == 1 ? line_req_tag[0] : line_req_addr)
  );

  // What was announced is in the request's register until it is taken.
  logic announced_q;
  always_ff @(posedge clk_i) begin
    announced_q <= issue || (announced_q && !line_req_ready_i);
    if (rst_i) announced_q <= 1'b0;
  end
  always_comb begin
    if (!rst_i) begin
      assert (!issue || ready_i);
      assert (announced_q == line_req_valid);
      if (Word == 1) assert (!line_req_valid || !line_req_tag[1]);
    end
  end
endmodule
