// SPDX-License-Identifier: Apache-2.0
// Asks for the lines of queries that are still to come. Queries pass a FIFO of Ahead, unchanged and in order; of each that
// enters it the near leaf, in which its search begins, is found in a node memory, its own or one that it shares, and its line is asked for on a line port like
// a gatherer's. So a cache before a slow memory has it, or waits for it, when the query is dealt. What comes back is not
// looked at: a line not asked for, or asked for in vain, changes cycles and nothing else.
//
// Queries of one region come one after another: the first ones wait for its lines while gatherers have nothing to do, the
// others find them while the memory has nothing to do. With the lines of the next region on their way both work at once.
//
// Best effort: a query that comes while no descent can begin is not looked at, and a leaf that is found takes the place of one that
// still waits for one of Requests to come back. The line that was asked for last is not asked for again.
//
// Latency of a query 4 cycles where nothing waits, one a cycle. cfg_*: as of photon_gatherer.
module line_prefetcher #(
    parameter int unsigned Ahead = 128,
    parameter int unsigned Requests = photonloom_pkg::LineTagBits > 1 ? 4 : 2,  // on their way at most
    parameter int unsigned BeatBits = photonloom_pkg::LineBeatBits,
    parameter bit OwnNodes = 1'b1,  // else it reads a node memory that it shares, by shared_node_*
    localparam int unsigned NodeAddressBits = $clog2(photonloom_pkg::NodeWords),
    localparam int unsigned QueryBits = photonloom_pkg::GatherQueryPacketBits,
    localparam int unsigned TagBits = photonloom_pkg::LineTagBits,
    localparam int unsigned LineBits = photonloom_pkg::LineAddressBits
) (
    input  logic                          clk_i,
    input  logic                          rst_i,
    input  logic                          cfg_valid_i,
    input  logic [                  23:0] cfg_addr_i,
    input  logic [                  63:0] cfg_data_i,
    // a node memory elsewhere, read where it has none: a word comes in the cycle after its address
    output logic [   NodeAddressBits-1:0] shared_node_address_o,
    input  logic [photonloom_pkg::PositionBits+1:0] shared_node_data_i,
    // queries
    input  logic                          in_valid_i,
    output logic                          in_ready_o,
    input  photonloom_pkg::gather_query_t in_i,
    output logic                          out_valid_o,
    input  logic                          out_ready_i,
    output photonloom_pkg::gather_query_t out_o,
    // lines; an address is {map, line}
    output logic                          line_req_valid_o,
    input  logic                          line_req_ready_i,
    output logic [            LineBits:0] line_req_addr_o,
    output logic [           TagBits-1:0] line_req_tag_o,
    input  logic                          line_rsp_valid_i,
    input  logic [           TagBits-1:0] line_rsp_tag_i,
    output logic                          busy_o            // a line is looked for, or on its way
);
  localparam int unsigned Bucket = photonloom_pkg::Bucket;
  localparam int unsigned PositionBits = photonloom_pkg::PositionBits;
  localparam int unsigned MapLineBits = photonloom_pkg::LineBits;
  localparam int unsigned NodeBits = MapLineBits + 1;
  localparam int unsigned StackBits = $clog2(MapLineBits + 1);
  localparam int unsigned GlobalLines = photonloom_pkg::GlobalPresent == 0 ? 0 :
      (photonloom_pkg::GlobalPhotons + Bucket - 1) / Bucket;
  localparam int unsigned Beats = 8 * Bucket * photonloom_pkg::PhotonBytes / BeatBits;
  localparam int unsigned BeatsBits = Beats > 1 ? $clog2(Beats) : 1;
  localparam int unsigned Descents = 4;  // places for positions; the ring takes three
  localparam int unsigned RequestBits = $clog2(Requests);

  if (Requests > (1 << TagBits) || Requests < 2) begin : gen_bad_requests
    line_prefetcher_needs_a_tag_for_each_of_at_least_2_requests bad_requests ();
  end

  // ---- queries pass ----
  /* verilator lint_off UNUSEDSIGNAL */
  logic fifo_empty;
  logic [$clog2(Ahead):0] fifo_room;
  /* verilator lint_on UNUSEDSIGNAL */
  ram_fifo #(
      .Width(QueryBits),
      .Depth(Ahead)
  ) queries (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .clear_i(1'b0),
      .in_valid_i(in_valid_i),
      .in_ready_o(in_ready_o),
      .in_i(in_i),
      .out_valid_o(out_valid_o),
      .out_ready_i(out_ready_i),
      .out_o(out_o),
      .room_o(fifo_room),
      .empty_o(fifo_empty)
  );

  // ---- the tree ----
  logic node_write;
  logic [NodeAddressBits-1:0] node_write_address, node_address;
  logic [PositionBits+1:0] node_write_data, node_data;
  logic [2*NodeBits-1:0] lines;
  /* verilator lint_off UNUSEDSIGNAL */  // not of a prefetcher
  logic [2*photonloom_pkg::R2Bits-1:0] r2_max;
  logic forget, set_mask, bypass;
  /* verilator lint_on UNUSEDSIGNAL */
  photon_gatherer_registers #(
      .Sets(1),
      .NodeAddressBits(NodeAddressBits)
  ) registers (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .cfg_valid_i(cfg_valid_i),
      .cfg_addr_i(cfg_addr_i),
      .cfg_data_i(cfg_data_i),
      .node_write_o(node_write),
      .node_address_o(node_write_address),
      .node_data_o(node_write_data),
      .lines_o(lines),
      .r2_max_o(r2_max),
      .forget_o(forget),
      .set_mask_o(set_mask),
      .bypass_o(bypass)
  );
  /* verilator lint_off UNUSEDSIGNAL */
  logic unused;
  /* verilator lint_on UNUSEDSIGNAL */
  if (OwnNodes) begin : gen_own
    photon_gatherer_node_memory #(
        .Width(PositionBits + 2),
        .Depth(photonloom_pkg::NodeWords)
    ) node_memory (
        .clk_i(clk_i),
        .write_i(node_write),
        .write_address_i(node_write_address),
        .write_data_i(node_write_data),
        .read_address_i(node_address),
        .read_data_o(node_data)
    );
    assign shared_node_address_o = '0;
    assign unused = &{1'b0, shared_node_data_i};
  end else begin : gen_shared
    assign shared_node_address_o = node_address;
    assign node_data = shared_node_data_i;
    assign unused = &{1'b0, node_write, node_write_address, node_write_data};
  end

  // ---- a descent of each query that comes, while there is room for one; a map of one line has none ----
  logic came_q, came_map_q, begins, leaf_valid, leaf_map, read_map;
  logic [3*PositionBits-1:0] came_position_q;
  logic [1:0] several_q;  // of each map: it has inner nodes
  logic [Descents-1:0] busy_q;
  logic [1:0] next_q, enter_context_q, leaf_context, read_context;
  logic enter_q, enter_map_q, ready;
  logic [MapLineBits-1:0] leaf_line;
  logic [3*PositionBits-1:0] position;

  assign begins = came_q && several_q[came_map_q] && !busy_q[next_q] && (!enter_q || ready);
  always_ff @(posedge clk_i) begin
    came_q <= in_valid_i && in_ready_o && !in_i.flush && !rst_i;
    came_map_q <= in_i.map;
    came_position_q <= in_i.position;
    several_q <= {lines[2*NodeBits-1:NodeBits+1] != '0, lines[NodeBits-1:1] != '0};
    enter_q <= (begins || (enter_q && !ready)) && !rst_i;
    if (begins) begin
      enter_context_q <= next_q;
      enter_map_q <= came_map_q;
    end
    for (int unsigned d = 0; d < Descents; d++)
      if (begins && next_q == 2'(d)) busy_q[d] <= 1'b1;
      else if (leaf_valid && leaf_context == 2'(d)) busy_q[d] <= 1'b0;
    if (begins) next_q <= next_q + 1'b1;
    if (rst_i) {busy_q, next_q} <= '0;
  end

  lut_ram #(
      .Width(3 * PositionBits),
      .Depth(Descents)
  ) positions (
      .clk_i(clk_i),
      .write_i(begins),
      .write_address_i(next_q),
      .write_data_i(came_position_q),
      .read_address_i(read_context),
      .read_data_o(position)
  );

  /* verilator lint_off PINCONNECTEMPTY */
  photon_gatherer_nodes #(
      .PositionBits(PositionBits),
      .LineBits(MapLineBits),
      .Contexts(Descents),
      .NodeWords(photonloom_pkg::NodeWords),
      .CausticBase(GlobalLines),
      .StackBits(StackBits)
  ) nodes (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .node_address_o(node_address),
      .node_data_i(node_data),
      .context_o(read_context),
      .query_i(position),
      .offsets_i('0),
      .map_o(read_map),
      .lines_i(read_map ? lines[NodeBits+:NodeBits] : lines[0+:NodeBits]),
      .in_valid_i(enter_q),
      .in_ready_o(ready),
      .in_context_i(enter_context_q),
      .in_map_i(enter_map_q),
      .in_first_i(1'b1),
      .in_node_i(NodeBits'(1)),
      .in_stack_i('0),
      .leaf_valid_o(leaf_valid),
      .leaf_context_o(leaf_context),
      .leaf_map_o(leaf_map),
      .leaf_first_o(),
      .leaf_line_o(leaf_line),
      .leaf_stack_o(),
      .leaf_steps_o(),
      .step_o(),
      .wrong_o(),
      .wrong_context_o(),
      .push_o(),
      .push_context_o(),
      .push_stack_o(),
      .push_entry_o()
  );
  /* verilator lint_on PINCONNECTEMPTY */

  // ---- its line, unless it is the last one's ----
  logic want_valid_q, want_again, request_free, take, last_beat;
  logic [MapLineBits:0] want_q, asked_q;
  logic [Requests-1:0] asked_busy_q;
  logic [RequestBits-1:0] request_q;
  logic [BeatsBits-1:0] beat_q;

  assign want_again = want_q == asked_q;
  assign request_free = !asked_busy_q[request_q];
  assign busy_o = came_q || busy_q != '0 || want_valid_q || line_req_valid_o || asked_busy_q != '0;
  assign take = want_valid_q && !want_again && request_free && (!line_req_valid_o || line_req_ready_i);
  assign last_beat = line_rsp_valid_i && beat_q == BeatsBits'(Beats - 1);

  always_ff @(posedge clk_i) begin
    // One that comes while another waits takes its place.
    want_valid_q <= leaf_valid || (want_valid_q && !want_again && !take);
    if (leaf_valid) want_q <= {leaf_map, leaf_line};
    if (line_req_ready_i) line_req_valid_o <= 1'b0;
    if (take) begin
      line_req_valid_o <= 1'b1;
      line_req_addr_o <= {want_q[MapLineBits], LineBits'(want_q[MapLineBits-1:0])};
      line_req_tag_o <= TagBits'(request_q);
      asked_q <= want_q;
      request_q <= request_q + 1'b1;
    end
    for (int unsigned r = 0; r < Requests; r++)
      if (take && request_q == RequestBits'(r)) asked_busy_q[r] <= 1'b1;
      else if (last_beat && line_rsp_tag_i == TagBits'(r)) asked_busy_q[r] <= 1'b0;
    if (line_rsp_valid_i) beat_q <= last_beat ? '0 : beat_q + 1'b1;
    if (rst_i) begin
      {want_valid_q, line_req_valid_o, asked_busy_q, request_q, beat_q} <= '0;
      asked_q <= '1;
    end
  end
endmodule
