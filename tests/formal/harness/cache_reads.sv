// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/lut_ram.sv rtl/common/block_ram.sv rtl/common/fifo.sv rtl/common/cache_lines.sv rtl/common/cache_victim.sv rtl/common/cache.sv
// cache: a read returns what memory holds, whatever the order in which lines come; each request is answered at most
// once, by nobody else's line. A word holds one bit of its own address, any, so a word of another address is seen by some bit; all
// words may change before an invalidate. No tag is asked for twice at a time, a line begins only where there is room for it.
module cache_reads #(
    parameter int unsigned AddressBits = 2,
    parameter int unsigned Clients = 2,
    parameter int unsigned Parts = 1,
    parameter int unsigned Sets = 2,
    parameter int unsigned Ways = 1,
    parameter int unsigned Misses = 2,
    parameter bit CompareStage = 1'b0,
    localparam int unsigned ClientBits = Clients > 1 ? $clog2(Clients) : 1,
    localparam int unsigned MissBits = Misses > 1 ? $clog2(Misses) : 1,
    localparam int unsigned SetBits = Sets > 1 ? $clog2(Sets) : 1,
    localparam int unsigned PartBits = Parts > 1 ? $clog2(Parts) : 1
) (
    input logic clk_i,
    input logic rst_i,
    input logic invalidate_i,
    input logic in_valid_i,
    input logic [ClientBits-1:0] in_client_i,
    input logic [AddressBits-1:0] in_address_i,
    input logic ready_i,
    input logic line_req_ready_i,
    input logic line_rsp_valid_i,
    input logic [MissBits-1:0] line_rsp_tag_i
);
  (* anyconst *) logic [SetBits-1:0] set_mask;
  (* anyconst *) logic bypass;
  (* anyconst *) logic [AddressBits-1:0] watched;  // one bit set

  logic issue, out_valid, out_data, line_req_valid;
  logic [ClientBits-1:0] out_client;
  logic [PartBits-1:0] out_part;
  logic [AddressBits-1:0] line_req_addr;
  logic [MissBits-1:0] line_req_tag;
  logic [7:0] line_rsp_data;

  cache #(
      .AddressBits(AddressBits),
      .Clients(Clients),
      .Items(Parts),
      .ItemBytes(1),
      .ItemBits(1),
      .Parts(Parts),
      .BeatBits(8),
      .Sets(Sets),
      .Ways(Ways),
      .Misses(Misses),
      .CompareStage(CompareStage)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .invalidate_i(invalidate_i),
      .set_mask_i(set_mask),
      .bypass_i(bypass),
      .in_valid_i(in_valid_i),
      .in_client_i(in_client_i),
      .in_address_i(in_address_i),
      .ready_i(ready_i),
      .issue_o(issue),
      .out_valid_o(out_valid),
      .out_client_o(out_client),
      .out_part_o(out_part),
      .out_data_o(out_data),
      .line_req_valid_o(line_req_valid),
      .line_req_ready_i(line_req_ready_i),
      .line_req_addr_o(line_req_addr),
      .line_req_tag_o(line_req_tag),
      .line_rsp_valid_i(line_rsp_valid_i),
      .line_rsp_tag_i(line_rsp_tag_i),
      .line_rsp_data_i(line_rsp_data),
      .hit_o(),
      .miss_o()
  );

  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;
  always_comb assume (rst_i == !started_q);

  // Clients wait for their answers, tags for their lines; the watched bit of their addresses. All that memory holds
  // changes with flip_q, and from part to part.
  logic [Clients-1:0] waits_q, wants_q;
  logic [Misses-1:0] asked_q, asked_watched_q;
  logic flip_q;
  logic [PartBits-1:0] beat_q, part_q;
  logic beating_q, last_part;
  logic [MissBits-1:0] beat_tag_q;

  assign last_part = part_q == PartBits'(Parts - 1);
  assign line_rsp_data = {7'd0, asked_watched_q[line_rsp_tag_i] ^ beat_q[0] ^ flip_q};

  always_ff @(posedge clk_i) begin
    if (in_valid_i) begin
      waits_q[in_client_i] <= 1'b1;
      wants_q[in_client_i] <= (in_address_i & watched) != '0;
    end
    if (out_valid) begin
      part_q <= last_part ? '0 : part_q + 1'b1;
      if (last_part) waits_q[out_client] <= 1'b0;
    end
    if (line_req_valid && line_req_ready_i) begin
      asked_q[line_req_tag] <= 1'b1;
      asked_watched_q[line_req_tag] <= (line_req_addr & watched) != '0;
    end
    if (line_rsp_valid_i) begin
      beat_q <= beat_q == PartBits'(Parts - 1) ? '0 : beat_q + 1'b1;
      beating_q <= beat_q != PartBits'(Parts - 1);
      beat_tag_q <= line_rsp_tag_i;
      if (beat_q == PartBits'(Parts - 1)) asked_q[line_rsp_tag_i] <= 1'b0;
    end
    if (invalidate_i) flip_q <= !flip_q;
    if (rst_i) begin
      waits_q <= '0;
      asked_q <= '0;
      flip_q <= 1'b0;
      beat_q <= '0;
      part_q <= '0;
      beating_q <= 1'b0;
    end
  end

  // The environment: one request of a client at a time, lines that were asked for and not interleaved.
  always_comb begin
    if (Sets == 1) assume (set_mask == '0);
    assume (watched != '0 && (watched & (watched - 1'b1)) == '0);
    if (!rst_i) begin
      if (in_valid_i) assume (in_client_i < Clients && !waits_q[in_client_i]);
      if (invalidate_i) assume (waits_q == '0 && !in_valid_i);
      if (line_rsp_valid_i) assume (line_rsp_tag_i < Misses && asked_q[line_rsp_tag_i]);
      if (line_rsp_valid_i && beating_q) assume (line_rsp_tag_i == beat_tag_q);
    end
  end

  always_comb begin
    if (!rst_i) begin
      if (issue) assert (ready_i);
      if (line_req_valid) assert (!asked_q[line_req_tag]);
      if (out_valid) begin
        assert (waits_q[out_client]);
        assert (out_part == part_q);
        assert (out_data == (wants_q[out_client] ^ part_q[0] ^ flip_q));
      end
    end
  end
endmodule
