// SPDX-License-Identifier: Apache-2.0
// package: tests/formal/harness/prefetcher_pkg.sv
// sources: rtl/common/lut_ram.sv tests/formal/harness/stubs/ram_fifo.sv
// sources: rtl/common/squared_distance.sv rtl/photon_gatherer/photon_gatherer_registers.sv
// sources: tests/formal/harness/stubs/photon_gatherer_node_memory.sv rtl/photon_gatherer/photon_gatherer_nodes.sv
// sources: rtl/board/line_prefetcher.sv
// line_prefetcher asks for no line but that of the leaf in which the search of a query that came begins; and a query that comes
// while nothing goes on has its line asked for within 12 cycles, if none comes behind it and the line is not the one that was asked for
// last. Any trees of at most four leaves, whose numbers are written before a query comes; any queries.
//
// A leaf is found here as docs/photon_map.md numbers a tree: from node 1 to 2n or 2n + 1 until the number is that of a leaf.
module prefetcher_lines #(
    parameter int unsigned What = 0  // 0: no other line, 1: its line
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
  localparam int unsigned Within = 12;
  logic req_valid, in_ready, busy;
  logic [photonloom_pkg::LineTagBits-1:0] req_tag;
  logic [photonloom_pkg::LineAddressBits:0] req_addr;

  line_prefetcher #(
      .Ahead(2),
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

  // ---- the maps: leaves as they were written, of the global and the caustic one ----
  logic [2:0] lines_q[2];
  always_ff @(posedge clk_i) begin
    if (cfg_valid_i && cfg_addr_i[23] && cfg_addr_i[2:0] == 3'd0) lines_q[0] <= cfg_data_i[2:0];
    if (cfg_valid_i && cfg_addr_i[23] && cfg_addr_i[2:0] == 3'd2) lines_q[1] <= cfg_data_i[2:0];
    if (rst_i) begin
      lines_q[0] <= '0;
      lines_q[1] <= '0;
    end
  end
  (* keep *) logic [23:0] nodes;  // probe: of each node axis and split; node n of the caustic map at 4 + n

  // ---- the leaf of the query that comes: two steps at most ----
  // The axes are x, y, z from the lowest bits of a position on; at the split and above lies the second child.
  logic has_leaf, second_1, second_2;
  logic [2:0] lines, word_1, word_2, number_2, number;
  logic [1:0] line;
  assign lines = lines_q[in_i.map];
  assign has_leaf = lines > 3'd1;
  assign word_1 = nodes[3*{in_i.map, 2'd1}+:3];
  assign second_1 = (word_1[2:1] == 2'd0 ? in_i.position[0] : word_1[2:1] == 2'd1 ? in_i.position[1] : in_i.position[2]) >= word_1[0];
  assign number_2 = {2'd1, second_1};
  assign word_2 = nodes[3*{in_i.map, number_2[1:0]}+:3];
  assign second_2 = (word_2[2:1] == 2'd0 ? in_i.position[0] : word_2[2:1] == 2'd1 ? in_i.position[1] : in_i.position[2]) >= word_2[0];
  assign number = number_2 < lines ? {number_2[1:0], second_2} : number_2;
  assign line = 2'(number - lines);

  // ---- what came, and what was asked for ----
  logic started_q = 1'b0;
  logic comes, any_q, quiet_q, waits_q;
  (* anyconst *) logic [2:0] other;  // a line for which no query comes
  logic [3:0] asked_q;  // of each tag: a line is on its way
  logic [1:0] beat_q, line_tag_q;
  logic [2:0] last_q, wanted_q;
  logic [4:0] since_q;
  assign comes = in_valid_i && in_ready && !in_i.flush && has_leaf;
  always_ff @(posedge clk_i) begin
    started_q <= 1'b1;
    any_q <= any_q || in_valid_i;
    if (line_rsp_valid_i) begin
      beat_q <= beat_q + 1'b1;
      line_tag_q <= line_rsp_tag_i;
      if (beat_q == 2'd3) asked_q[line_rsp_tag_i] <= 1'b0;
    end
    if (req_valid && line_req_ready_i) asked_q[req_tag] <= 1'b1;
    if (req_valid) last_q <= req_addr;
    // One alone: until its line is asked for, or another query comes.
    if (waits_q) since_q <= since_q + 1'b1;
    if (in_valid_i && in_ready) begin
      waits_q <= comes && quiet_q && !busy && !req_valid;
      wanted_q <= {in_i.map, line};
      since_q <= '0;
    end else if (req_valid && req_addr == wanted_q || last_q == wanted_q) begin
      waits_q <= 1'b0;
    end
    quiet_q <= !busy;
    if (rst_i) begin
      any_q <= 1'b0;
      asked_q <= '0;
      beat_q <= '0;
      waits_q <= 1'b0;
      quiet_q <= 1'b0;
      last_q <= '1;  // the first request of a prefetcher is for any other line
    end
  end

  always_comb begin
    assume (rst_i == !started_q);
    // A memory answers what it was asked for, all beats of a line on end.
    if (rst_i) assume (!line_rsp_valid_i && !cfg_valid_i);
    if (!rst_i) begin
      if (beat_q != '0) assume (line_rsp_valid_i && line_rsp_tag_i == line_tag_q);
      else if (line_rsp_valid_i) assume (asked_q[line_rsp_tag_i]);
    end
    // Written while nothing is inside and no query came, of four leaves at most.
    if (cfg_valid_i) assume (!busy && !in_valid_i && !any_q && (!cfg_addr_i[23] || cfg_data_i[2:0] <= 3'd4));
    if (What == 0 && in_valid_i && has_leaf) assume ({in_i.map, line} != other);
  end

  always_comb begin
    if (!rst_i) begin
      if (What == 0 && req_valid) assert (req_addr != other);
      if (What == 1 && waits_q) assert (since_q < 5'(Within));
    end
  end
endmodule
