// SPDX-License-Identifier: Apache-2.0
// The photon gatherer: for each query the K photons of its map nearest to it in (d2, index) among those within r2_max
// and on the side of its normal, their exact sum of power, and on request the photons themselves. Results leave in the
// order of the queries, photons in the order of the queries that want them; neither stream ever waits for the other.
// Mirrors search() of golden/unit/photon_gatherer.cpp, with equal counts of nodes, leaves and insertions.
//
// Up to Contexts queries are in flight. Each is at any time in one place: descending through inner nodes, waiting for
// its leaf line, in the lanes, entering its list, or taking subtrees off its stack; its next decision waits for its
// last insertion. Nodes, dropped stack entries, leaf beats and insertions each have a port of their own that takes one
// a cycle. docs/photon_gatherer.md has the drawing, the address map of cfg_*, and the figures.
//
// Latency: about 3 cycles an inner node, 3 for one or two stack entries, 40 a leaf in the cache, 1 a candidate.
// Throughput: cycles per query near max(inner nodes, Bucket / Lanes * leaves, insertions).
module photon_gatherer #(
    // These change when packets come, never which.
    parameter int unsigned Contexts = photonloom_pkg::Contexts,
    parameter int unsigned Lanes = photonloom_pkg::Lanes,
    parameter int unsigned CacheBytes = photonloom_pkg::CacheBytes,
    parameter int unsigned CacheWays = photonloom_pkg::CacheWays,
    parameter int unsigned CacheMisses = photonloom_pkg::CacheMisses,
    parameter int unsigned LineBeatBits = photonloom_pkg::LineBeatBits,
    localparam int unsigned TagBits = CacheMisses > 1 ? $clog2(CacheMisses) : 1,
    localparam int unsigned LineBits = photonloom_pkg::LineBits
) (
    input  logic                              clk_i,
    input  logic                              rst_i,
    // queries
    input  logic                              in_valid_i,
    output logic                              in_ready_o,
    input  photonloom_pkg::gather_query_t     in_i,
    // results
    output logic                              result_valid_o,
    input  logic                              result_ready_i,
    output photonloom_pkg::gather_result_t    result_o,
    // photons
    output logic                              photon_valid_o,
    input  logic                              photon_ready_i,
    output photonloom_pkg::gather_photon_t    photon_o,
    // leaf lines; the address is {map, line}
    output logic                              line_req_valid_o,
    input  logic                              line_req_ready_i,
    output logic [                LineBits:0] line_req_addr_o,
    output logic [               TagBits-1:0] line_req_tag_o,
    input  logic                              line_rsp_valid_i,
    input  logic [               TagBits-1:0] line_rsp_tag_i,
    input  logic [          LineBeatBits-1:0] line_rsp_data_i,
    // node memory and registers, written while idle
    input  logic                              cfg_valid_i,
    input  logic [                      23:0] cfg_addr_i,
    input  logic [                      63:0] cfg_data_i,
    // counted since reset, shown at most 18 cycles late
    output logic [31:0] count_busy_o, // cycles with a query in flight
    output logic [31:0] count_queries_o, // queries started, flushes apart
    output logic [31:0] count_nodes_o, // inner nodes
    output logic [31:0] count_dropped_o, // stack entries dropped by the bound
    output logic [31:0] count_leaves_o, // leaves
    output logic [31:0] count_candidates_o, // candidates in front that came to the list
    output logic [31:0] count_insertions_o, // candidates that entered it
    output logic [31:0] count_cache_hits_o, // leaves found in the cache or on their way to it
    output logic [31:0] count_cache_misses_o, // lines requested
    output logic [31:0] count_stalled_in_o, // cycles a query waited to be taken
    output logic [31:0] count_stalled_results_o, // cycles a result waited to be taken
    output logic [31:0] count_stalled_photons_o, // cycles a photon waited to be taken
    output logic [31:0] count_stalled_lines_o  // cycles a line request waited to be taken
);
  localparam int unsigned PositionBits = photonloom_pkg::PositionBits;
  localparam int unsigned R2Bits = photonloom_pkg::R2Bits;
  localparam int unsigned K = photonloom_pkg::K;
  localparam int unsigned Bucket = photonloom_pkg::Bucket;
  localparam int unsigned Channels = photonloom_pkg::Channels;
  localparam int unsigned IndexBits = photonloom_pkg::IndexBits;
  localparam int unsigned CountBits = photonloom_pkg::CountBits;
  localparam int unsigned NormalBits = photonloom_pkg::NormalBits;
  localparam int unsigned DirectionBits = photonloom_pkg::DirectionBits;
  localparam int unsigned MantissasBits = Channels * photonloom_pkg::MantissaBits;
  localparam int unsigned ExponentBits = photonloom_pkg::ExponentBits;
  localparam int unsigned PowerBits = MantissasBits + ExponentBits;
  localparam int unsigned LoadBits = 2 * DirectionBits + PowerBits;
  localparam int unsigned PhotonBits = 3 * PositionBits + LoadBits;
  localparam int unsigned StoreBits = LoadBits + R2Bits + IndexBits;

  localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1;
  localparam int unsigned QueueDepth = Contexts > 2 ? (1 << $clog2(Contexts)) : 2;
  // Of results; 64 of them are enough, and as many as LUTs hold well.
  localparam int unsigned Slots = QueueDepth > 16 ? 2 * QueueDepth : 4 * QueueDepth;
  localparam int unsigned SlotBits = $clog2(Slots);
  localparam int unsigned PlaceBits = K > 1 ? $clog2(K) : 1;
  localparam int unsigned NodeBits = LineBits + 1;
  localparam int unsigned StackBits = $clog2(LineBits + 1);
  localparam int unsigned OffsetsBits = 3 * (PositionBits + 1);  // signed

  // E * distance^2 <= E * 2^R2Bits.
  localparam int unsigned DistanceBits = R2Bits + $clog2(photonloom_pkg::EpsilonFactor);
  localparam int unsigned GlobalLines = photonloom_pkg::GlobalPresent == 0 ? 0 :
      (photonloom_pkg::GlobalPhotons + Bucket - 1) / Bucket;
  localparam int unsigned CausticLines = photonloom_pkg::CausticPresent == 0 ? 0 :
      (photonloom_pkg::CausticPhotons + Bucket - 1) / Bucket;
  localparam int unsigned NodeWords = GlobalLines + CausticLines > 2 ? GlobalLines + CausticLines : 2;
  localparam int unsigned NodeAddressBits = $clog2(NodeWords);

  // The largest power of two of sets that fits in CacheBytes.
  localparam int unsigned LineBytes = Bucket * photonloom_pkg::PhotonBytes;
  localparam int unsigned SetsThatFit = CacheBytes / (LineBytes * CacheWays);
  localparam int unsigned Sets = SetsThatFit == 0 ? 0 : 1 << ($clog2(SetsThatFit + 1) - 1);
  localparam int unsigned SetBits = Sets > 1 ? $clog2(Sets) : 1;

  if (Sets == 0) begin : gen_bad_cache
    cache_bytes_must_hold_one_line_in_each_way bad_cache ();
  end
  if (8 * photonloom_pkg::PhotonBytes < PhotonBits) begin : gen_bad_photon
    photon_bytes_must_hold_all_fields_of_a_photon bad_photon ();
  end

  // ---- registers ----
  logic [2*R2Bits-1:0] r2_max_q;
  logic [2*(LineBits+1)-1:0] lines_q;  // of the caustic, the global map
  logic [SetBits-1:0] set_mask_q;
  logic bypass_q, cfg_node;
  /* verilator lint_off UNUSEDSIGNAL */  // not every address and data bit is used in every plan
  logic [23:0] cfg_addr;
  logic [63:0] cfg_data;
  /* verilator lint_on UNUSEDSIGNAL */

  assign cfg_addr = cfg_addr_i;
  assign cfg_data = cfg_data_i;
  assign cfg_node = cfg_valid_i && !cfg_addr[23];

  always_ff @(posedge clk_i) begin
    if (cfg_valid_i && cfg_addr[23]) begin
      unique case (cfg_addr[2:0])
        3'd0: lines_q[0+:LineBits+1] <= cfg_data[LineBits:0];
        3'd1: r2_max_q[0+:R2Bits] <= cfg_data[R2Bits-1:0];
        3'd2: lines_q[LineBits+1+:LineBits+1] <= cfg_data[LineBits:0];
        3'd3: r2_max_q[R2Bits+:R2Bits] <= cfg_data[R2Bits-1:0];
        3'd4: {bypass_q, set_mask_q} <= {cfg_data[63], cfg_data[SetBits-1:0]};
        default: ;
      endcase
    end
    if (rst_i) begin
      lines_q <= '0;
      set_mask_q <= SetBits'(Sets - 1);
      bypass_q <= 1'b0;
    end
  end

  // ---- maps ----
  localparam bit HasBoth = GlobalLines != 0 && CausticLines != 0;
  localparam bit OnlyCaustic = GlobalLines == 0 && CausticLines != 0;

  function automatic logic [LineBits:0] lines_of(input logic map, input logic [2*(LineBits+1)-1:0] lines);
    lines_of = (HasBoth ? map : OnlyCaustic) ? lines[LineBits+1+:LineBits+1] : lines[0+:LineBits+1];
  endfunction

  // ---- start of a query ----
  // Starts are at least two cycles apart, so what they need can be looked up a cycle ahead. A context is free when its
  // loads are read for the sum and for its photons. A query begins at the root: an inner node, a leaf, or its end in an
  // empty map. Meanwhile its list is emptied by a token, two cycles at most and five stages later: before a lane asks
  // for its bound, 8 cycles after the start at the earliest, and before the end of a query in an empty map is noted.
  logic query_valid_q, start, start_search, slot_ready, flush_ready, free_q, query_r2_map_q;
  logic init_ask, init_taken, init_done;
  localparam logic [1:0] InitIdle = 2'd0, InitAsk = 2'd1, InitWait = 2'd2, InitEnd = 2'd3;
  logic [1:0] init_q;
  logic init_empty_q;
  logic [ContextBits-1:0] init_context_q;
  logic [1:0] map_empty_q, map_leaf_q;  // no line, one line
  logic query_empty, query_leaf;
  photonloom_pkg::gather_query_t query_q;
  logic [ContextBits-1:0] free_context_q;
  logic [Contexts-1:0] summing_q, streaming_q;
  logic [SlotBits:0] start_slot;
  logic [3*(NormalBits+2)-1:0] start_normal, start_normal_z;

  logic next_valid, next_leaf, next_map;
  logic [ContextBits-1:0] next_context;
  logic [NodeBits-1:0] next_node;
  logic [StackBits-1:0] next_stack;
  logic [OffsetsBits-1:0] next_offsets;

  logic sum_free, photons_free, stack_done, ask_valid, ask_taken;
  logic [ContextBits-1:0] sum_free_context, photons_free_context, stack_done_context, ask_context;

  assign in_ready_o = !query_valid_q;
  assign query_empty = map_empty_q[query_q.map];
  assign query_leaf = map_leaf_q[query_q.map];
  assign start_search = query_valid_q && !query_q.flush && slot_ready && free_q && init_q == InitIdle && !next_valid;
  assign start = start_search || (query_valid_q && query_q.flush && flush_ready);

  always_ff @(posedge clk_i) begin
    map_empty_q <= {lines_q[LineBits+1+:LineBits+1] == '0, lines_q[0+:LineBits+1] == '0};
    map_leaf_q <= {lines_q[LineBits+1+:LineBits+1] == (LineBits + 1)'(1), lines_q[0+:LineBits+1] == (LineBits + 1)'(1)};
    free_q <= (summing_q | streaming_q) != '1;
    for (int unsigned c = Contexts; c > 0; c--)
      if (!summing_q[c-1] && !streaming_q[c-1]) free_context_q <= ContextBits'(c - 1);
    if (in_ready_o) begin
      query_valid_q <= in_valid_i;
      query_q <= in_i;
    end else if (start) begin
      query_valid_q <= 1'b0;
    end
    for (int unsigned c = 0; c < Contexts; c++) begin
      if (start_search && free_context_q == ContextBits'(c)) begin
        summing_q[c] <= 1'b1;
        streaming_q[c] <= query_q.want_photons;
      end
      if (sum_free && sum_free_context == ContextBits'(c)) summing_q[c] <= 1'b0;
      if (photons_free && photons_free_context == ContextBits'(c)) streaming_q[c] <= 1'b0;
    end
    if (rst_i) begin
      query_valid_q <= 1'b0;
      summing_q <= '0;
      streaming_q <= '0;
    end
  end

  assign init_ask = init_q == InitAsk;

  always_ff @(posedge clk_i) begin
    unique case (init_q)
      InitIdle: begin
        init_context_q <= free_context_q;
        init_empty_q <= query_empty;
        query_r2_map_q <= query_q.map;
        if (start_search) init_q <= InitAsk;
      end
      InitAsk: if (init_taken) init_q <= InitWait;
      InitWait: if (init_done) init_q <= init_empty_q ? InitEnd : InitIdle;
      default: if (!stack_done) init_q <= InitIdle;
    endcase
    if (rst_i) init_q <= InitIdle;
  end

  // z is stored negated: what is asked is whether x + y > -z.
  oct_decode #(
      .Bits(NormalBits)
  ) decode_normal (
      .code_i(query_q.normal),
      .direction_o(start_normal)
  );
  assign start_normal_z = {-start_normal[2*(NormalBits+2)+:NormalBits+2], start_normal[2*(NormalBits+2)-1:0]};

  // ---- where a query goes next: an inner node or a leaf; one goes past an empty queue ----
  localparam int unsigned GoBits = ContextBits + 2 + NodeBits + StackBits;
  logic go_valid, go_map, go_first, nodes_ready, direct_valid, direct_taken, direct_map, direct_first;
  logic [ContextBits-1:0] go_context, direct_context;
  logic [NodeBits-1:0] go_node, direct_node;
  logic [StackBits-1:0] go_stack, direct_stack;
  logic go_push, go_waiting, direct_push, direct_waiting;
  logic [GoBits-1:0] go_word, go_oldest, direct_oldest;
  /* verilator lint_off UNUSEDSIGNAL */  // queues hold every context
  logic go_ready, direct_ready, finish_ready, empty_ready, done_ready;
  /* verilator lint_on UNUSEDSIGNAL */

  assign go_word = next_valid ? {next_context, next_map, 1'b0, next_node, next_stack} :
                                {free_context_q, query_q.map, 1'b1, NodeBits'(1), StackBits'(0)};

  fifo #(
      .Width(GoBits),
      .Depth(QueueDepth)
  ) go_queue (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(go_push && (go_waiting || !nodes_ready)),
      .in_ready_o(go_ready),
      .in_i(go_word),
      .out_valid_o(go_waiting),
      .out_ready_i(nodes_ready),
      .out_o(go_oldest)
  );
  assign go_push = (next_valid && !next_leaf) || (start_search && !query_empty && !query_leaf);
  assign go_valid = go_waiting || go_push;
  assign {go_context, go_map, go_first, go_node, go_stack} = go_waiting ? go_oldest : go_word;

  // Subtrees that are leaves do not wait for those that are not.
  fifo #(
      .Width(GoBits),
      .Depth(QueueDepth)
  ) go_leaf_queue (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(direct_push && (direct_waiting || !direct_taken)),
      .in_ready_o(direct_ready),
      .in_i(go_word),
      .out_valid_o(direct_waiting),
      .out_ready_i(direct_taken),
      .out_o(direct_oldest)
  );
  assign direct_push = (next_valid && next_leaf) || (start_search && query_leaf);
  assign direct_valid = direct_waiting || direct_push;
  assign {direct_context, direct_map, direct_first, direct_node, direct_stack} =
      direct_waiting ? direct_oldest : go_word;

  // ---- context state ----
  logic [ContextBits-1:0] node_context, lane_context, normal_context, wait_context;
  logic [3*PositionBits-1:0] node_query, lane_query;
  logic [OffsetsBits-1:0] node_offsets;
  logic [3*(NormalBits+2)-1:0] candidate_normal;
  logic [LineBits-1:0] wait_line;

  lut_ram #(
      .Width(3 * PositionBits),
      .Depth(Contexts)
  ) query_for_nodes (
      .clk_i(clk_i),
      .write_i(start_search),
      .write_address_i(free_context_q),
      .write_data_i(query_q.position),
      .read_address_i(node_context),
      .read_data_o(node_query)
  );
  lut_ram #(
      .Width(3 * PositionBits),
      .Depth(Contexts)
  ) query_for_lanes (
      .clk_i(clk_i),
      .write_i(start_search),
      .write_address_i(free_context_q),
      .write_data_i(query_q.position),
      .read_address_i(lane_context),
      .read_data_o(lane_query)
  );
  lut_ram #(
      .Width(3 * (NormalBits + 2)),
      .Depth(Contexts)
  ) normals (
      .clk_i(clk_i),
      .write_i(start_search),
      .write_address_i(free_context_q),
      .write_data_i(start_normal_z),
      .read_address_i(normal_context),
      .read_data_o(candidate_normal)
  );
  lut_ram #(
      .Width(OffsetsBits),
      .Depth(Contexts)
  ) offsets (
      .clk_i(clk_i),
      .write_i(next_valid),
      .write_address_i(next_context),
      .write_data_i(next_offsets),
      .read_address_i(node_context),
      .read_data_o(node_offsets)
  );

  if (HasBoth) begin : gen_maps
    lut_ram #(
        .Width(1),
        .Depth(Contexts)
    ) maps (
        .clk_i(clk_i),
        .write_i(start_search),
        .write_address_i(free_context_q),
        .write_data_i(query_q.map),
        .read_address_i(next_context),
        .read_data_o(next_map)
    );
  end else begin : gen_map
    assign next_map = OnlyCaustic;
  end

  // ---- inner nodes ----
  logic node_step, node_map, push, descent_valid, descent_map, descent_first;
  logic [ContextBits-1:0] push_context, descent_context;
  logic [StackBits-1:0] push_stack, descent_stack, descent_steps;
  logic [NodeBits+OffsetsBits+DistanceBits:0] push_entry;
  logic [LineBits-1:0] descent_line;

  photon_gatherer_nodes #(
      .PositionBits(PositionBits),
      .LineBits(LineBits),
      .Contexts(Contexts),
      .NodeWords(NodeWords),
      .CausticBase(GlobalLines),
      .EpsilonFactor(photonloom_pkg::EpsilonFactor),
      .StackBits(StackBits),
      .DistanceBits(DistanceBits)
  ) nodes (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .node_write_i(cfg_node),
      .node_address_i(cfg_addr[NodeAddressBits-1:0]),
      .node_data_i(cfg_data[PositionBits+1:0]),
      .context_o(node_context),
      .query_i(node_query),
      .offsets_i(node_offsets),
      .map_o(node_map),
      .lines_i(lines_of(node_map, lines_q)),
      .in_valid_i(go_valid),
      .in_ready_o(nodes_ready),
      .in_context_i(go_context),
      .in_map_i(HasBoth ? go_map : OnlyCaustic),
      .in_first_i(go_first),
      .in_node_i(go_node),
      .in_stack_i(go_stack),
      .leaf_valid_o(descent_valid),
      .leaf_context_o(descent_context),
      .leaf_map_o(descent_map),
      .leaf_first_o(descent_first),
      .leaf_line_o(descent_line),
      .leaf_stack_o(descent_stack),
      .leaf_steps_o(descent_steps),
      .step_o(node_step),
      .push_o(push),
      .push_context_o(push_context),
      .push_stack_o(push_stack),
      .push_entry_o(push_entry)
  );

  // ---- a leaf is reached: choose | count | write the counts ----
  logic leaf_valid, leaf_map;
  logic [ContextBits-1:0] leaf_context;
  logic [LineBits-1:0] leaf_line;
  logic leaf_valid_q, leaf_first_q, counted_valid_q, leaf_stop;
  logic [ContextBits-1:0] leaf_context_q, counted_context_q;
  logic [LineBits-1:0] leaf_line_q;
  logic [StackBits-1:0] leaf_stack_q, leaf_steps_q, counted_stack_q, counted_steps_q;
  logic [NodeBits-1:0] leaves_stored, nodes_stored, leaves_q, nodes_q, leaves_next, nodes_next, done_leaves, done_nodes;

  assign leaf_valid = descent_valid || direct_valid;
  assign leaf_context = descent_valid ? descent_context : direct_context;
  assign leaf_map = descent_valid ? descent_map : HasBoth ? direct_map : OnlyCaustic;
  assign leaf_line = descent_valid ? descent_line : LineBits'(direct_node - NodeBits'(lines_of(direct_map, lines_q)));
  assign direct_taken = !descent_valid;

  always_ff @(posedge clk_i) begin
    leaf_valid_q <= leaf_valid;
    leaf_context_q <= leaf_context;
    leaf_first_q <= descent_valid ? descent_first : direct_first;
    leaf_line_q <= leaf_line;
    leaf_stack_q <= descent_valid ? descent_stack : direct_stack;
    leaf_steps_q <= descent_valid ? descent_steps : '0;
    counted_valid_q <= leaf_valid_q;
    counted_context_q <= leaf_context_q;
    counted_stack_q <= leaf_stack_q;
    counted_steps_q <= leaf_steps_q;
    leaves_q <= leaf_first_q ? '0 : leaves_stored;
    nodes_q <= leaf_first_q ? '0 : nodes_stored;
    if (rst_i) begin
      leaf_valid_q <= 1'b0;
      counted_valid_q <= 1'b0;
    end
  end

  assign leaves_next = leaves_q + 1'b1;
  assign nodes_next = nodes_q + NodeBits'(counted_steps_q);
  assign leaf_stop = photonloom_pkg::LeafLimit != 0 && 32'(leaves_next) == photonloom_pkg::LeafLimit;

  lut_ram #(
      .Width(2 * NodeBits),
      .Depth(Contexts)
  ) counts_to_step (
      .clk_i(clk_i),
      .write_i(counted_valid_q),
      .write_address_i(counted_context_q),
      .write_data_i({leaves_next, nodes_next}),
      .read_address_i(leaf_context_q),
      .read_data_o({leaves_stored, nodes_stored})
  );
  lut_ram #(
      .Width(2 * NodeBits),
      .Depth(Contexts)
  ) counts_to_read (
      .clk_i(clk_i),
      .write_i(counted_valid_q),
      .write_address_i(counted_context_q),
      .write_data_i({leaves_next, nodes_next}),
      .read_address_i(done_context),
      .read_data_o({done_leaves, done_nodes})
  );
  lut_ram #(
      .Width(LineBits),
      .Depth(Contexts)
  ) lines_in_hand (
      .clk_i(clk_i),
      .write_i(leaf_valid_q),
      .write_address_i(leaf_context_q),
      .write_data_i(leaf_line_q),
      .read_address_i(wait_context),
      .read_data_o(wait_line)
  );

  logic oldest_stop;
  logic [ContextBits-1:0] oldest_context;
  logic [StackBits-1:0] oldest_stack;

  lut_ram #(
      .Width(StackBits + 1),
      .Depth(Contexts)
  ) stack_pointers (
      .clk_i(clk_i),
      .write_i(counted_valid_q),
      .write_address_i(counted_context_q),
      .write_data_i({leaf_stop, counted_stack_q}),
      .read_address_i(oldest_context),
      .read_data_o({oldest_stop, oldest_stack})
  );

  // ---- the cache ----
  localparam int unsigned Beats = Bucket / Lanes;
  localparam int unsigned BeatBits = Beats > 1 ? $clog2(Beats) : 1;
  logic lanes_ready, line_issue, line_valid, cache_hit, cache_miss;
  logic [ContextBits-1:0] line_context;
  logic [BeatBits-1:0] line_beat;
  logic [Lanes*PhotonBits-1:0] line_photons;

  cache #(
      .AddressBits(LineBits + 1),
      .Clients(Contexts),
      .Items(Bucket),
      .ItemBytes(photonloom_pkg::PhotonBytes),
      .ItemBits(PhotonBits),
      .Parts(Beats),
      .BeatBits(LineBeatBits),
      .Sets(Sets),
      .Ways(CacheWays),
      .Misses(CacheMisses)
  ) leaf_cache (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .invalidate_i(cfg_valid_i),
      .set_mask_i(set_mask_q),
      .bypass_i(bypass_q),
      .in_valid_i(leaf_valid),
      .in_client_i(leaf_context),
      .in_address_i({leaf_map, leaf_line}),
      .ready_i(lanes_ready),
      .issue_o(line_issue),
      .out_valid_o(line_valid),
      .out_client_o(line_context),
      .out_part_o(line_beat),
      .out_data_o(line_photons),
      .line_req_valid_o(line_req_valid_o),
      .line_req_ready_i(line_req_ready_i),
      .line_req_addr_o(line_req_addr_o),
      .line_req_tag_o(line_req_tag_o),
      .line_rsp_valid_i(line_rsp_valid_i),
      .line_rsp_tag_i(line_rsp_tag_i),
      .line_rsp_data_i(line_rsp_data_i),
      .hit_o(cache_hit),
      .miss_o(cache_miss)
  );

  // ---- lanes, candidates, list ----
  // Between a beat's place in the FIFO and its candidates' loads: the beat in hand, 16 pairs tested and to be tested, the
  // pair that waits, the pair in hand and 3 stages of the list.
  localparam int unsigned Behind = 24;
  localparam int unsigned RowBits = $clog2((2 * Beats > 16 ? 1 << $clog2(2 * Beats) : 16) + Behind);
  logic beat_valid, beat_ready, beat_last, direction_read, empty_leaf;
  logic [ContextBits-1:0] beat_context, empty_leaf_context, lane_bound_context, wait_bound_context, stack_bound_context;
  logic [BeatBits-1:0] beat_number;
  logic [RowBits-1:0] beat_row, load_row;
  logic [Lanes-1:0] beat_mask;
  logic [Lanes*R2Bits-1:0] beat_d2;
  logic [2*Lanes*DirectionBits-1:0] directions;
  logic [Lanes*LoadBits-1:0] loads;
  logic [R2Bits-1:0] lane_bound, wait_bound, stack_bound, done_r2;

  photon_gatherer_lanes #(
      .PositionBits(PositionBits),
      .Contexts(Contexts),
      .Bucket(Bucket),
      .Lanes(Lanes),
      .DirectionBits(DirectionBits),
      .LoadBits(LoadBits),
      .MantissasBits(MantissasBits),
      .ExponentBits(ExponentBits),
      .Behind(Behind)
  ) lanes (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .ready_o(lanes_ready),
      .issue_i(line_issue),
      .in_valid_i(line_valid),
      .in_context_i(line_context),
      .in_beat_i(line_beat),
      .in_photons_i(line_photons),
      .query_context_o(lane_context),
      .query_i(lane_query),
      .bound_context_o(lane_bound_context),
      .bound_i(lane_bound),
      .empty_valid_o(empty_leaf),
      .empty_context_o(empty_leaf_context),
      .out_valid_o(beat_valid),
      .out_ready_i(beat_ready),
      .out_context_o(beat_context),
      .out_beat_o(beat_number),
      .out_row_o(beat_row),
      .out_last_o(beat_last),
      .out_mask_o(beat_mask),
      .out_d2_o(beat_d2),
      .direction_read_i(direction_read),
      .directions_o(directions),
      .load_row_i(load_row),
      .loads_o(loads)
  );

  logic token_valid, token_candidate, token_start, token_snapshot, leaf_done;
  logic [ContextBits-1:0] token_context, leaf_done_context;
  logic [IndexBits-1:0] token_index;
  logic [R2Bits-1:0] token_d2;
  logic [LoadBits-1:0] token_load;

  photon_gatherer_candidates #(
      .R2Bits(R2Bits),
      .LineBits(LineBits),
      .Contexts(Contexts),
      .Bucket(Bucket),
      .Lanes(Lanes),
      .RowBits(RowBits),
      .LoadBits(LoadBits),
      .DirectionBits(DirectionBits),
      .NormalBits(NormalBits)
  ) candidates (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(beat_valid),
      .in_ready_o(beat_ready),
      .in_context_i(beat_context),
      .in_beat_i(beat_number),
      .in_row_i(beat_row),
      .in_last_i(beat_last),
      .in_mask_i(beat_mask),
      .in_d2_i(beat_d2),
      .direction_read_o(direction_read),
      .directions_i(directions),
      .normal_context_o(normal_context),
      .normal_i(candidate_normal),
      .wait_context_o(wait_context),
      .wait_line_i(wait_line),
      .bound_context_o(wait_bound_context),
      .bound_i(wait_bound),
      .start_i(init_ask),
      .start_taken_o(init_taken),
      .start_context_i(init_context_q),
      .snapshot_i(ask_valid),
      .snapshot_taken_o(ask_taken),
      .snapshot_context_i(ask_context),
      .out_valid_o(token_valid),
      .out_context_o(token_context),
      .out_candidate_o(token_candidate),
      .out_start_o(token_start),
      .out_snapshot_o(token_snapshot),
      .out_index_o(token_index),
      .out_d2_o(token_d2),
      .load_row_o(load_row),
      .loads_i(loads),
      .out_load_o(token_load),
      .leaf_done_o(leaf_done),
      .leaf_done_context_o(leaf_done_context)
  );

  logic store, snapshot, insert;
  logic [ContextBits-1:0] store_context, done_context;
  logic [PlaceBits-1:0] store_place;
  logic [StoreBits-1:0] store_data;
  logic [CountBits-1:0] snapshot_count, done_count;
  logic [K*PlaceBits-1:0] snapshot_places;
  logic [IndexBits:0] done_insertions;

  photon_gatherer_list #(
      .K(K),
      .R2Bits(R2Bits),
      .IndexBits(IndexBits),
      .Contexts(Contexts),
      .LoadBits(LoadBits),
      .Readers(4)
  ) list (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(token_valid),
      .in_context_i(token_context),
      .in_candidate_i(token_candidate),
      .in_start_i(token_start),
      .in_snapshot_i(token_snapshot),
      .in_index_i(token_index),
      .in_d2_i(token_d2),
      .load_i(token_load),
      .started_o(init_done),
      .r2_max_i(query_r2_map_q ? r2_max_q[R2Bits+:R2Bits] : r2_max_q[0+:R2Bits]),
      .bound_context_i({done_context, wait_bound_context, lane_bound_context, stack_bound_context}),
      .bound_o({done_r2, wait_bound, lane_bound, stack_bound}),
      .read_context_i(done_context),
      .count_o(done_count),
      .insertions_o(done_insertions),
      .store_o(store),
      .store_context_o(store_context),
      .store_place_o(store_place),
      .store_data_o(store_data),
      .snapshot_o(snapshot),
      .snapshot_count_o(snapshot_count),
      .snapshot_places_o(snapshot_places),
      .insert_o(insert)
  );

  // ---- after a leaf: the stack ----
  // The end of a leaf comes with its last token, or without one. With a token the stack reads the bound 5 cycles later
  // or more, when it is there: leaf_done, the queue, the register behind it, two stages of the stack.
  logic finish_waiting, finish_free, finish_valid_q, finish_stop_q;
  logic empty_waiting;
  logic [ContextBits-1:0] finish_oldest, empty_oldest, finish_context_q;
  logic [StackBits-1:0] finish_stack_q;
  logic [1:0] dropped;
  logic stack_ready, done_valid, done_empty, sum_ready, sum_take, take_ready;

  fifo #(
      .Width(ContextBits),
      .Depth(QueueDepth)
  ) finish_queue (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(leaf_done),
      .in_ready_o(finish_ready),
      .in_i(leaf_done_context),
      .out_valid_o(finish_waiting),
      .out_ready_i(finish_free),
      .out_o(finish_oldest)
  );
  fifo #(
      .Width(ContextBits),
      .Depth(QueueDepth)
  ) empty_queue (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(empty_leaf),
      .in_ready_o(empty_ready),
      .in_i(empty_leaf_context),
      .out_valid_o(empty_waiting),
      .out_ready_i(finish_free && !finish_waiting),
      .out_o(empty_oldest)
  );

  assign finish_free = !finish_valid_q || stack_ready;
  assign oldest_context = finish_waiting ? finish_oldest : empty_oldest;

  always_ff @(posedge clk_i) begin
    if (finish_free) begin
      finish_valid_q <= finish_waiting || empty_waiting;
      finish_context_q <= oldest_context;
      finish_stop_q <= oldest_stop;
      finish_stack_q <= oldest_stack;
    end
    if (rst_i) finish_valid_q <= 1'b0;
  end

  photon_gatherer_stack #(
      .OffsetsBits(OffsetsBits),
      .R2Bits(R2Bits),
      .LineBits(LineBits),
      .Contexts(Contexts),
      .EpsilonShift(photonloom_pkg::EpsilonShift),
      .StackBits(StackBits),
      .DistanceBits(DistanceBits)
  ) stack (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .push_i(push),
      .push_context_i(push_context),
      .push_stack_i(push_stack),
      .push_entry_i(push_entry),
      .in_valid_i(finish_valid_q),
      .in_ready_o(stack_ready),
      .in_context_i(finish_context_q),
      .in_stack_i(finish_stack_q),
      .in_stop_i(finish_stop_q),
      .bound_context_o(stack_bound_context),
      .bound_i(stack_bound),
      .next_valid_o(next_valid),
      .next_context_o(next_context),
      .next_leaf_o(next_leaf),
      .next_node_o(next_node),
      .next_stack_o(next_stack),
      .next_offsets_o(next_offsets),
      .done_valid_o(stack_done),
      .done_context_o(stack_done_context),
      .drop_o(dropped)
  );

  // A query in an empty map is done when its list is empty; no leaf was counted for it.
  logic done_push;
  logic [ContextBits-1:0] done_push_context;
  assign done_push = stack_done || init_q == InitEnd;
  assign done_push_context = stack_done ? stack_done_context : init_context_q;

  fifo #(
      .Width(ContextBits + 1),
      .Depth(QueueDepth)
  ) done_queue (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(done_push),
      .in_ready_o(done_ready),
      .in_i({done_push_context, !stack_done}),
      .out_valid_o(done_valid),
      .out_ready_i(sum_ready && take_ready),
      .out_o({done_context, done_empty})
  );
  assign sum_take = done_valid && sum_ready && take_ready;

  // ---- slot store: written by the list, read by the sum, else by the photon stream ----
  logic sum_read, photons_read;
  logic [ContextBits-1:0] sum_read_context, photons_read_context;
  logic [PlaceBits-1:0] sum_read_place, photons_read_place;
  logic [StoreBits-1:0] store_word;

  block_ram #(
      .Width(StoreBits),
      .Depth(1 << (ContextBits + PlaceBits))
  ) slot_store (
      .clk_i(clk_i),
      .write_i(store),
      .write_address_i({store_context, store_place}),
      .write_data_i(store_data),
      .read_i(sum_read || photons_read),
      .read_address_i(sum_read ? {sum_read_context, sum_read_place} : {photons_read_context, photons_read_place}),
      .read_data_o(store_word)
  );

  // ---- sums and results ----
  // What belongs to the context is read when the sum takes it, since the context may start anew before the sum is out.
  localparam int unsigned RideBits = SlotBits + 1 + R2Bits + 2 * NodeBits + IndexBits + 1;
  logic sum_valid;
  logic [CountBits-1:0] sum_count;
  logic [Channels*photonloom_pkg::FluxBits-1:0] sum_flux;
  logic [SlotBits:0] done_slot, sum_slot;
  logic [R2Bits-1:0] sum_r2;
  logic [NodeBits-1:0] sum_leaves, sum_nodes;
  logic [IndexBits:0] sum_insertions;

  photon_gatherer_sum #(
      .K(K),
      .Contexts(Contexts),
      .Channels(Channels),
      .MantissaBits(photonloom_pkg::MantissaBits),
      .ExponentBits(ExponentBits),
      .FluxBits(photonloom_pkg::FluxBits),
      .RideBits(RideBits)
  ) sum (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(sum_take),
      .in_ready_o(sum_ready),
      .in_context_i(done_context),
      .in_count_i(done_count),
      .in_ride_i({
        done_slot, done_r2, done_insertions, done_empty ? NodeBits'(0) : done_leaves, done_empty ? NodeBits'(0) : done_nodes
      }),
      .read_o(sum_read),
      .read_context_o(sum_read_context),
      .read_place_o(sum_read_place),
      .read_power_i(store_word[StoreBits-1-:PowerBits]),
      .free_o(sum_free),
      .free_context_o(sum_free_context),
      .out_valid_o(sum_valid),
      .out_count_o(sum_count),
      .out_ride_o({sum_slot, sum_r2, sum_insertions, sum_leaves, sum_nodes}),
      .out_flux_o(sum_flux)
  );

  lut_ram #(
      .Width(SlotBits + 1),
      .Depth(Contexts)
  ) result_slots (
      .clk_i(clk_i),
      .write_i(start_search),
      .write_address_i(free_context_q),
      .write_data_i(start_slot),
      .read_address_i(done_context),
      .read_data_o(done_slot)
  );

  photon_gatherer_results #(
      .Slots(Slots)
  ) results (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .start_ready_o(slot_ready),
      .flush_ready_o(flush_ready),
      .start_i(start),
      .start_flush_i(query_q.flush),
      .start_map_i(query_q.map),
      .start_tag_i(query_q.tag),
      .start_sample_i(query_q.sample),
      .start_pixel_i(query_q.pixel),
      .start_slot_o(start_slot),
      .take_ready_o(take_ready),
      .take_i(sum_take),
      .finish_i(sum_valid),
      .finish_slot_i(sum_slot),
      .finish_count_i(sum_count),
      .finish_r2_i(sum_r2),
      .finish_flux_i(sum_flux),
      .finish_nodes_i(sum_nodes),
      .finish_leaves_i(sum_leaves),
      .finish_insertions_i(sum_insertions),
      .result_valid_o(result_valid_o),
      .result_ready_i(result_ready_i),
      .result_o(result_o)
  );

  // ---- photons ----
  logic [StoreBits-1:0] photon_word;
  logic photon_last;

  photon_gatherer_photons #(
      .K(K),
      .Contexts(Contexts),
      .StoreBits(StoreBits)
  ) photons (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .start_i(start_search && query_q.want_photons),
      .start_context_i(free_context_q),
      .done_i(done_push),
      .done_context_i(done_push_context),
      .snapshot_valid_o(ask_valid),
      .snapshot_ready_i(ask_taken),
      .snapshot_context_o(ask_context),
      .snapshot_i(snapshot),
      .snapshot_count_i(snapshot_count),
      .snapshot_places_i(snapshot_places),
      .read_valid_o(photons_read),
      .read_ready_i(!sum_read),
      .read_context_o(photons_read_context),
      .read_place_o(photons_read_place),
      .read_data_i(store_word),
      .free_o(photons_free),
      .free_context_o(photons_free_context),
      .out_valid_o(photon_valid_o),
      .out_ready_i(photon_ready_i),
      .out_data_o(photon_word),
      .out_last_o(photon_last)
  );

  always_comb begin
    photon_o.index = photon_word[0+:IndexBits];
    photon_o.d2 = photon_word[IndexBits+:R2Bits];
    photon_o.direction = photon_word[IndexBits+R2Bits+:2*DirectionBits];
    photon_o.mantissa = photon_word[IndexBits+R2Bits+2*DirectionBits+:MantissasBits];
    photon_o.exponent = photon_word[StoreBits-1-:ExponentBits];
    photon_o.last = photon_last;
  end

  // ---- counters ----
  localparam int unsigned CounterCount = 13;
  logic [CounterCount-1:0] event_q;
  logic two_dropped_q;

  always_ff @(posedge clk_i) begin
    event_q <= {
      line_req_valid_o && !line_req_ready_i,
      photon_valid_o && !photon_ready_i,
      result_valid_o && !result_ready_i,
      in_valid_i && !in_ready_o,
      cache_miss,
      cache_hit,
      insert,
      token_valid && token_candidate,
      leaf_valid_q,
      dropped != '0,
      node_step,
      start_search,
      query_valid_q || (summing_q | streaming_q) != '0
    };
    two_dropped_q <= dropped[1];
    if (rst_i) event_q <= '0;
  end

  photon_gatherer_counters #(
      .Count(CounterCount),
      .Double(3)
  ) counters (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .event_i(event_q),
      .double_i(two_dropped_q),
      .count_o({
        count_stalled_lines_o,
        count_stalled_photons_o,
        count_stalled_results_o,
        count_stalled_in_o,
        count_cache_misses_o,
        count_cache_hits_o,
        count_insertions_o,
        count_candidates_o,
        count_leaves_o,
        count_dropped_o,
        count_nodes_o,
        count_queries_o,
        count_busy_o
      })
  );
endmodule
