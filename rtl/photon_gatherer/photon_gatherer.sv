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
// Latency: about 3 cycles an inner node, 3 for one or two stack entries, 20 a leaf in the cache, 1 a candidate.
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
    // counted since reset
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
  localparam int unsigned Slots = 4 * QueueDepth;
  localparam int unsigned SlotBits = $clog2(Slots);
  localparam int unsigned PlaceBits = K > 1 ? $clog2(K) : 1;
  localparam int unsigned NodeBits = LineBits + 1;
  localparam int unsigned StackBits = $clog2(LineBits + 1);

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

  // ---- start of a query ----
  // A context is free when it is summed and its photons are read.
  logic query_valid_q, start, start_search, free_any, slot_ready, bound_busy, new_valid_q;
  photonloom_pkg::gather_query_t query_q;
  logic [ContextBits-1:0] free_context, new_context_q;
  logic [Contexts-1:0] summing_q, streaming_q, map_q, offsets_zero_q;
  logic [SlotBits-1:0] start_slot;
  logic [3*(NormalBits+2)-1:0] start_normal;

  logic next_valid, next_leaf, next_inner;
  logic [ContextBits-1:0] next_context;
  logic [NodeBits-1:0] next_node;
  logic [StackBits-1:0] next_stack;
  logic [3*PositionBits-1:0] next_offsets;

  logic sum_valid, photons_free, stack_done, ask_valid, ask_taken;
  logic [ContextBits-1:0] sum_context, photons_free_context, stack_done_context, ask_context;

  always_comb begin
    free_any = 1'b0;
    free_context = '0;
    for (int unsigned c = Contexts; c > 0; c--) begin
      if (!summing_q[c-1] && !streaming_q[c-1]) begin
        free_any = 1'b1;
        free_context = ContextBits'(c - 1);
      end
    end
  end

  assign in_ready_o = !query_valid_q;
  assign start_search = query_valid_q && !query_q.flush && slot_ready && free_any && !new_valid_q && !bound_busy;
  assign start = start_search || (query_valid_q && query_q.flush && slot_ready);

  always_ff @(posedge clk_i) begin
    if (in_ready_o) begin
      query_valid_q <= in_valid_i;
      query_q <= in_i;
    end else if (start) begin
      query_valid_q <= 1'b0;
    end
    for (int unsigned c = 0; c < Contexts; c++) begin
      if (start_search && free_context == ContextBits'(c)) begin
        summing_q[c] <= 1'b1;
        streaming_q[c] <= query_q.want_photons;
        map_q[c] <= query_q.map;
        offsets_zero_q[c] <= 1'b1;
      end
      if (next_valid && next_context == ContextBits'(c)) offsets_zero_q[c] <= 1'b0;
      if (sum_valid && sum_context == ContextBits'(c)) summing_q[c] <= 1'b0;
      if (photons_free && photons_free_context == ContextBits'(c)) streaming_q[c] <= 1'b0;
    end
    if (rst_i) begin
      query_valid_q <= 1'b0;
      summing_q <= '0;
      streaming_q <= '0;
    end
  end

  oct_decode #(
      .Bits(NormalBits)
  ) decode_normal (
      .code_i(query_q.normal),
      .direction_o(start_normal)
  );

  // ---- where a query goes next: an inner node, a leaf, or its end in an empty map ----
  logic queue_valid, go_valid, go_taken, go_map, go_empty, go_inner, go_leaf_taken, go_empty_taken;
  logic [ContextBits-1:0] queue_context, go_context;
  logic [NodeBits-1:0] queue_node, go_node;
  logic [StackBits-1:0] queue_stack, go_stack;
  logic [LineBits:0] go_lines;
  logic nodes_ready, direct_valid, direct_taken;
  logic [ContextBits-1:0] direct_context;
  logic [NodeBits-1:0] direct_node;
  logic [StackBits-1:0] direct_stack;
  logic descent_leaf, leaf_done, empty_leaf, empty_leaf_taken;
  logic [ContextBits-1:0] descent_context, empty_leaf_context, leaf_done_context;
  logic [LineBits-1:0] descent_line;
  logic [StackBits-1:0] descent_stack;
  /* verilator lint_off UNUSEDSIGNAL */  // queues hold every context
  logic go_ready, direct_ready, leaf_queue_ready, finish_ready, done_ready;
  /* verilator lint_on UNUSEDSIGNAL */

  fifo #(
      .Width(ContextBits + NodeBits + StackBits),
      .Depth(QueueDepth)
  ) go_queue (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(next_inner),
      .in_ready_o(go_ready),
      .in_i({next_context, next_node, next_stack}),
      .out_valid_o(queue_valid),
      .out_ready_i(go_taken),
      .out_o({queue_context, queue_node, queue_stack})
  );

  // New queries have the longest way down, so they let the others go first.
  assign go_valid = queue_valid || new_valid_q;
  assign go_context = queue_valid ? queue_context : new_context_q;
  assign go_node = queue_valid ? queue_node : NodeBits'(1);
  assign go_stack = queue_valid ? queue_stack : '0;

  always_ff @(posedge clk_i) begin
    if (start_search) begin
      new_valid_q <= 1'b1;
      new_context_q <= free_context;
    end else if (go_taken && !queue_valid) begin
      new_valid_q <= 1'b0;
    end
    if (rst_i) new_valid_q <= 1'b0;
  end

  // Subtrees that are leaves do not wait for those that are not.
  fifo #(
      .Width(ContextBits + NodeBits + StackBits),
      .Depth(QueueDepth)
  ) go_leaf_queue (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(next_valid && next_leaf),
      .in_ready_o(direct_ready),
      .in_i({next_context, next_node, next_stack}),
      .out_valid_o(direct_valid),
      .out_ready_i(direct_taken),
      .out_o({direct_context, direct_node, direct_stack})
  );

  assign next_inner = next_valid && !next_leaf;
  assign direct_taken = direct_valid && !descent_leaf;
  assign go_map = map_q[go_context];
  assign go_lines = go_map ? lines_q[LineBits+1+:LineBits+1] : lines_q[0+:LineBits+1];
  assign go_empty = go_lines == '0;
  assign go_inner = go_node < go_lines;
  assign go_leaf_taken = go_valid && !go_empty && !go_inner && !descent_leaf && !direct_valid;
  assign go_empty_taken = go_valid && go_empty && !descent_leaf && !direct_valid && !leaf_done && !empty_leaf;
  assign go_taken = go_leaf_taken || go_empty_taken || (!go_empty && go_inner && nodes_ready);

  // ---- context state ----
  logic [ContextBits-1:0] node_context, lane_context, candidate_context;
  logic [3*PositionBits-1:0] node_query, node_offsets, node_offsets_stored, lane_query;
  logic [3*(NormalBits+2)-1:0] candidate_normal;
  logic [LineBits-1:0] candidate_line;

  lut_ram #(
      .Width(3 * PositionBits),
      .Depth(Contexts)
  ) query_for_nodes (
      .clk_i(clk_i),
      .write_i(start_search),
      .write_address_i(free_context),
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
      .write_address_i(free_context),
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
      .write_address_i(free_context),
      .write_data_i(start_normal),
      .read_address_i(candidate_context),
      .read_data_o(candidate_normal)
  );
  lut_ram #(
      .Width(3 * PositionBits),
      .Depth(Contexts)
  ) offsets (
      .clk_i(clk_i),
      .write_i(next_valid),
      .write_address_i(next_context),
      .write_data_i(next_offsets),
      .read_address_i(node_context),
      .read_data_o(node_offsets_stored)
  );
  assign node_offsets = offsets_zero_q[node_context] ? '0 : node_offsets_stored;

  // ---- inner nodes ----
  logic node_step, push;
  logic [ContextBits-1:0] node_step_context, push_context;
  logic [StackBits-1:0] push_stack;
  logic [NodeBits+3*PositionBits+DistanceBits:0] push_entry;
  logic [NodeBits-1:0] node_count, sum_nodes;

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
      .map_i(map_q[node_context]),
      .lines_i(map_q[node_context] ? lines_q[LineBits+1+:LineBits+1] : lines_q[0+:LineBits+1]),
      .in_valid_i(go_valid && !go_empty && go_inner),
      .in_ready_o(nodes_ready),
      .in_context_i(go_context),
      .in_map_i(go_map),
      .in_node_i(go_node),
      .in_stack_i(go_stack),
      .leaf_valid_o(descent_leaf),
      .leaf_context_o(descent_context),
      .leaf_line_o(descent_line),
      .leaf_stack_o(descent_stack),
      .step_o(node_step),
      .step_context_o(node_step_context),
      .push_o(push),
      .push_context_o(push_context),
      .push_stack_o(push_stack),
      .push_entry_o(push_entry)
  );

  photon_gatherer_tally #(
      .Width(NodeBits),
      .Contexts(Contexts)
  ) node_counts (
      .clk_i(clk_i),
      .clear_i(start_search),
      .clear_context_i(free_context),
      .step_i(node_step),
      .step_context_i(node_step_context),
      .step_value_o(node_count),
      .step_next_i(node_count + 1'b1),
      .read_context_i(sum_context),
      .read_value_o(sum_nodes)
  );

  // ---- a leaf is reached ----
  logic leaf_valid, leaf_stop;
  logic [ContextBits-1:0] leaf_context, waiting_context;
  logic [NodeBits-1:0] waiting_node, waiting_lines;
  logic [LineBits-1:0] leaf_line;
  logic [StackBits-1:0] leaf_stack;
  logic [NodeBits-1:0] leaf_count, leaf_count_next, sum_leaves;

  assign leaf_valid = descent_leaf || direct_valid || go_leaf_taken;
  assign leaf_context = descent_leaf ? descent_context : waiting_context;
  assign leaf_line = descent_leaf ? descent_line : LineBits'(waiting_node - waiting_lines);
  assign leaf_stack = descent_leaf ? descent_stack : direct_valid ? direct_stack : go_stack;
  assign waiting_context = direct_valid ? direct_context : go_context;
  assign waiting_node = direct_valid ? direct_node : go_node;
  assign waiting_lines = map_q[waiting_context] ? lines_q[LineBits+1+:LineBits+1] : lines_q[0+:LineBits+1];
  assign leaf_count_next = leaf_count + 1'b1;
  assign leaf_stop = photonloom_pkg::LeafLimit != 0 && 32'(leaf_count_next) == photonloom_pkg::LeafLimit;

  photon_gatherer_tally #(
      .Width(NodeBits),
      .Contexts(Contexts)
  ) leaf_counts (
      .clk_i(clk_i),
      .clear_i(start_search),
      .clear_context_i(free_context),
      .step_i(leaf_valid),
      .step_context_i(leaf_context),
      .step_value_o(leaf_count),
      .step_next_i(leaf_count_next),
      .read_context_i(sum_context),
      .read_value_o(sum_leaves)
  );

  lut_ram #(
      .Width(LineBits),
      .Depth(Contexts)
  ) lines_in_hand (
      .clk_i(clk_i),
      .write_i(leaf_valid),
      .write_address_i(leaf_context),
      .write_data_i(leaf_line),
      .read_address_i(candidate_context),
      .read_data_o(candidate_line)
  );

  logic finish_valid, finish_stop;
  logic [ContextBits-1:0] finish_context;
  logic [StackBits-1:0] finish_stack;

  lut_ram #(
      .Width(StackBits + 1),
      .Depth(Contexts)
  ) stack_pointers (
      .clk_i(clk_i),
      .write_i(leaf_valid || go_empty_taken),
      .write_address_i(leaf_context),
      .write_data_i(leaf_valid ? {leaf_stop, leaf_stack} : {1'b1, StackBits'(0)}),
      .read_address_i(finish_context),
      .read_data_o({finish_stop, finish_stack})
  );

  // ---- the cache ----
  logic lookup_valid, lookup_ready, lookup_waiting, lookup_map;
  logic [ContextBits+LineBits:0] leaf_word, lookup_oldest;
  logic [ContextBits-1:0] lookup_context, line_context;
  logic [LineBits-1:0] lookup_line;
  logic lanes_ready, line_issue, line_valid, cache_hit, cache_miss;
  logic [Bucket*PhotonBits-1:0] line;

  fifo #(
      .Width(ContextBits + 1 + LineBits),
      .Depth(QueueDepth)
  ) leaf_queue (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(leaf_valid && (lookup_waiting || !lookup_ready)),
      .in_ready_o(leaf_queue_ready),
      .in_i(leaf_word),
      .out_valid_o(lookup_waiting),
      .out_ready_i(lookup_ready),
      .out_o(lookup_oldest)
  );

  assign leaf_word = {leaf_context, map_q[leaf_context], leaf_line};
  assign lookup_valid = lookup_waiting || leaf_valid;
  assign {lookup_context, lookup_map, lookup_line} = lookup_waiting ? lookup_oldest : leaf_word;

  cache #(
      .AddressBits(LineBits + 1),
      .Clients(Contexts),
      .Items(Bucket),
      .ItemBytes(photonloom_pkg::PhotonBytes),
      .ItemBits(PhotonBits),
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
      .in_valid_i(lookup_valid),
      .in_ready_o(lookup_ready),
      .in_client_i(lookup_context),
      .in_address_i({lookup_map, lookup_line}),
      .out_ready_i(lanes_ready),
      .issue_o(line_issue),
      .out_valid_o(line_valid),
      .out_client_o(line_context),
      .out_line_o(line),
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
  localparam int unsigned BeatBits = Bucket / Lanes > 1 ? $clog2(Bucket / Lanes) : 1;
  logic beat_valid, beat_ready, beat_last, beat_first, load_read;
  logic [ContextBits-1:0] beat_context, lane_bound_context, wait_bound_context, hand_bound_context, stack_bound_context;
  logic [BeatBits-1:0] beat_number;
  logic [Lanes-1:0] beat_mask;
  logic [Lanes*R2Bits-1:0] beat_d2;
  logic [Lanes*LoadBits-1:0] load;
  logic [R2Bits-1:0] lane_bound, wait_bound, hand_bound, stack_bound, sum_r2;

  photon_gatherer_lanes #(
      .PositionBits(PositionBits),
      .Contexts(Contexts),
      .Bucket(Bucket),
      .Lanes(Lanes),
      .LoadBits(LoadBits),
      .MantissasBits(MantissasBits),
      .ExponentBits(ExponentBits)
  ) lanes (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .ready_o(lanes_ready),
      .issue_i(line_issue),
      .in_valid_i(line_valid),
      .in_context_i(line_context),
      .in_line_i(line),
      .query_context_o(lane_context),
      .query_i(lane_query),
      .bound_context_o(lane_bound_context),
      .bound_i(lane_bound),
      .out_valid_o(beat_valid),
      .out_ready_i(beat_ready),
      .out_context_o(beat_context),
      .out_beat_o(beat_number),
      .out_last_o(beat_last),
      .out_first_o(beat_first),
      .out_mask_o(beat_mask),
      .out_d2_o(beat_d2),
      .load_read_i(load_read),
      .load_o(load)
  );

  logic token_valid, token_candidate, token_snapshot;
  logic [ContextBits-1:0] token_context;
  logic [IndexBits-1:0] token_index;
  logic [R2Bits-1:0] token_d2;
  logic [LoadBits-1:0] token_load;

  photon_gatherer_candidates #(
      .R2Bits(R2Bits),
      .LineBits(LineBits),
      .Contexts(Contexts),
      .Bucket(Bucket),
      .Lanes(Lanes),
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
      .in_last_i(beat_last),
      .in_first_i(beat_first),
      .in_mask_i(beat_mask),
      .in_d2_i(beat_d2),
      .load_read_o(load_read),
      .load_i(load),
      .empty_valid_o(empty_leaf),
      .empty_ready_i(empty_leaf_taken),
      .empty_context_o(empty_leaf_context),
      .state_context_o(candidate_context),
      .normal_i(candidate_normal),
      .line_i(candidate_line),
      .wait_context_o(wait_bound_context),
      .wait_bound_i(wait_bound),
      .hand_context_o(hand_bound_context),
      .hand_bound_i(hand_bound),
      .snapshot_i(ask_valid),
      .snapshot_taken_o(ask_taken),
      .snapshot_context_i(ask_context),
      .out_valid_o(token_valid),
      .out_context_o(token_context),
      .out_candidate_o(token_candidate),
      .out_snapshot_o(token_snapshot),
      .out_index_o(token_index),
      .out_d2_o(token_d2),
      .out_load_o(token_load),
      .leaf_done_o(leaf_done),
      .leaf_done_context_o(leaf_done_context)
  );

  logic store, snapshot, insert;
  logic [ContextBits-1:0] store_context, done_context;
  logic [PlaceBits-1:0] store_place;
  logic [StoreBits-1:0] store_data;
  logic [CountBits-1:0] snapshot_count, stack_count, done_count;
  logic [K*PlaceBits-1:0] snapshot_places;
  logic [IndexBits:0] sum_insertions;

  photon_gatherer_list #(
      .K(K),
      .R2Bits(R2Bits),
      .IndexBits(IndexBits),
      .Contexts(Contexts),
      .LoadBits(LoadBits),
      .Readers(5)
  ) list (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .bound_busy_o(bound_busy),
      .start_i(start_search),
      .start_context_i(free_context),
      .start_r2_max_i(query_q.map ? r2_max_q[R2Bits+:R2Bits] : r2_max_q[0+:R2Bits]),
      .in_valid_i(token_valid),
      .in_context_i(token_context),
      .in_candidate_i(token_candidate),
      .in_snapshot_i(token_snapshot),
      .in_index_i(token_index),
      .in_d2_i(token_d2),
      .in_load_i(token_load),
      .bound_context_i({
        sum_context, stack_bound_context, hand_bound_context, wait_bound_context, lane_bound_context
      }),
      .bound_o({sum_r2, stack_bound, hand_bound, wait_bound, lane_bound}),
      .read_context_i(stack_done_context),
      .count_o(stack_count),
      .read_insertions_context_i(sum_context),
      .insertions_o(sum_insertions),
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
  // The end of a leaf comes with its last token, or without one. An empty map's query ends as if after a leaf, but
  // through the queue, since its stack pointer is only being written.
  logic finish_push, finish_waiting;
  logic [ContextBits-1:0] finish_pushed, finish_oldest;
  logic [1:0] dropped;
  logic stack_ready, done_valid, sum_ready, sum_take, take_ready;
  fifo #(
      .Width(ContextBits),
      .Depth(QueueDepth)
  ) finish_queue (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i((finish_push && (finish_waiting || !stack_ready)) || go_empty_taken),
      .in_ready_o(finish_ready),
      .in_i(finish_pushed),
      .out_valid_o(finish_waiting),
      .out_ready_i(stack_ready),
      .out_o(finish_oldest)
  );

  assign empty_leaf_taken = !leaf_done;
  assign finish_push = leaf_done || empty_leaf;
  assign finish_pushed = leaf_done ? leaf_done_context : empty_leaf ? empty_leaf_context : go_context;
  assign finish_valid = finish_waiting || finish_push;
  assign finish_context = finish_waiting ? finish_oldest : finish_pushed;

  photon_gatherer_stack #(
      .PositionBits(PositionBits),
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
      .in_valid_i(finish_valid),
      .in_ready_o(stack_ready),
      .in_context_i(finish_context),
      .in_stack_i(finish_stack),
      .in_stop_i(finish_stop),
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

  fifo #(
      .Width(ContextBits + CountBits),
      .Depth(QueueDepth)
  ) done_queue (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(stack_done),
      .in_ready_o(done_ready),
      .in_i({stack_done_context, stack_count}),
      .out_valid_o(done_valid),
      .out_ready_i(sum_ready && take_ready),
      .out_o({done_context, done_count})
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
  logic [CountBits-1:0] sum_count;
  logic [Channels*photonloom_pkg::FluxBits-1:0] sum_flux;
  logic [SlotBits-1:0] sum_slot;

  photon_gatherer_sum #(
      .K(K),
      .Contexts(Contexts),
      .Channels(Channels),
      .MantissaBits(photonloom_pkg::MantissaBits),
      .ExponentBits(ExponentBits),
      .FluxBits(photonloom_pkg::FluxBits)
  ) sum (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(sum_take),
      .in_ready_o(sum_ready),
      .in_context_i(done_context),
      .in_count_i(done_count),
      .read_o(sum_read),
      .read_context_o(sum_read_context),
      .read_place_o(sum_read_place),
      .read_power_i(store_word[StoreBits-1-:PowerBits]),
      .out_valid_o(sum_valid),
      .out_context_o(sum_context),
      .out_count_o(sum_count),
      .out_flux_o(sum_flux)
  );

  lut_ram #(
      .Width(SlotBits),
      .Depth(Contexts)
  ) result_slots (
      .clk_i(clk_i),
      .write_i(start_search),
      .write_address_i(free_context),
      .write_data_i(start_slot),
      .read_address_i(sum_context),
      .read_data_o(sum_slot)
  );

  photon_gatherer_results #(
      .Slots(Slots)
  ) results (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .start_ready_o(slot_ready),
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
      .start_context_i(free_context),
      .done_i(stack_done),
      .done_context_i(stack_done_context),
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
  logic both_dropped_q;
  logic [31:0] count_q[0:CounterCount-1];

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
      leaf_valid,
      dropped != '0,
      node_step,
      start_search,
      query_valid_q || (summing_q | streaming_q) != '0
    };
    both_dropped_q <= dropped[1];
    for (int unsigned i = 0; i < CounterCount; i++)
      count_q[i] <= rst_i ? '0 : count_q[i] + (i == 3 && both_dropped_q ? 32'd2 : 32'(event_q[i]));
    if (rst_i) event_q <= '0;
  end

  assign count_busy_o = count_q[0];
  assign count_queries_o = count_q[1];
  assign count_nodes_o = count_q[2];
  assign count_dropped_o = count_q[3];
  assign count_leaves_o = count_q[4];
  assign count_candidates_o = count_q[5];
  assign count_insertions_o = count_q[6];
  assign count_cache_hits_o = count_q[7];
  assign count_cache_misses_o = count_q[8];
  assign count_stalled_in_o = count_q[9];
  assign count_stalled_results_o = count_q[10];
  assign count_stalled_photons_o = count_q[11];
  assign count_stalled_lines_o = count_q[12];
endmodule
