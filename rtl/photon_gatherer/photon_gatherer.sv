// SPDX-License-Identifier: Apache-2.0
// The photon gatherer: for each query the K photons of its map nearest to it in (d2, index) among those within r2_max
// and on the side of its normal, their exact sum of power, and on request the photons themselves. Results leave in the
// order of the queries, photons in the order of the queries that want them; neither stream ever waits for the other.
// Mirrors search_gather of golden/unit/photon_gatherer.cpp, with equal counts of nodes, leaves and insertions.
//
// Wires: a query starts, its tree gives its leaves one by one, each is searched, and when the tree has no more its
// answers are made. Up to Contexts queries are in flight. Each is at any time in one place: descending through inner
// nodes, waiting for its leaf line, in the lanes, entering its list, or taking subtrees off its stack; its next decision
// waits for its last insertion. Nodes, dropped stack entries, leaf beats and insertions each have a port of their own
// that takes one a cycle, of two Levels two nodes of one descent. Of trees, lists and sums there may be several: number n of
// N has the contexts c with c % N = n. docs/photon_gatherer.md has the drawing, the modules, the address map of cfg_*, and the figures.
//
// Latency: about 3 cycles an inner node, 3 for one or two stack entries, about 27 a leaf in the cache, 1 a candidate.
// Throughput: cycles per query near max(inner nodes / Trees, of two Levels two thirds of them, Bucket / Lanes * leaves,
// insertions / Lists, (K + 1) / Sums).
module photon_gatherer #(
    // These change when packets come, never which.
    parameter int unsigned Contexts = photonloom_pkg::Contexts,
    // Two nodes a cycle are those of two trees or, of far gatherers, which have no LUTs to spare, two levels of one.
    parameter int unsigned Levels = photonloom_pkg::FarGatherers != 0 ? photonloom_pkg::NodesPerCycle : 1,
    parameter int unsigned Trees = photonloom_pkg::FarGatherers != 0 ? 1 : photonloom_pkg::NodesPerCycle,
    parameter int unsigned Lists = photonloom_pkg::CandidatesPerCycle,
    parameter int unsigned Sums = photonloom_pkg::PowersPerCycle,
    parameter int unsigned Lanes = photonloom_pkg::Lanes,
    parameter int unsigned CacheBytes = photonloom_pkg::CacheBytes,
    parameter int unsigned CacheWays = photonloom_pkg::CacheWays,
    parameter int unsigned CacheMisses = photonloom_pkg::CacheMisses,
    parameter int unsigned LineBeatBits = photonloom_pkg::LineBeatBits,
    parameter bit EarlyReplies = 1'b1,  // a line's first beat may come sooner than 4 cycles after its request, 3 with two trees, 5 of two levels at once
    parameter bit OwnNodes = 1'b1,  // else it reads a node memory that it shares, by shared_node_*
    localparam int unsigned TagBits = CacheBytes == 0 ? (Contexts > 1 ? $clog2(Contexts) : 1) :
        CacheMisses > 1 ? $clog2(CacheMisses) : 1,
    localparam int unsigned LineBits = photonloom_pkg::LineBits,
    localparam int unsigned Parity = photonloom_pkg::Parity
) (
    input  logic                              clk_i,  // clock
    input  logic                              rst_i,  // reset, synchronous
    // queries
    input  logic                              in_valid_i,  // offered
    output logic                              in_ready_o,  // taken when offered
    input  photonloom_pkg::gather_query_t     in_i,  // the packet
    // results
    output logic                              result_valid_o,  // offered
    input  logic                              result_ready_i,  // taken when offered
    output photonloom_pkg::gather_result_t    result_o,  // the packet
    // photons
    output logic                              photon_valid_o,  // offered
    input  logic                              photon_ready_i,  // taken when offered
    output photonloom_pkg::gather_photon_t    photon_o,  // the packet
    // leaf lines; the address is {map, line}
    output logic                              line_req_valid_o,  // offered
    input  logic                              line_req_ready_i,  // taken when offered
    output logic [photonloom_pkg::LineAddressBits:0] line_req_addr_o,  // map, then line; 1 is the caustic map
    output logic [               TagBits-1:0] line_req_tag_o,  // comes back with every beat of the line
    input  logic                              line_rsp_valid_i,  // a beat is there; it is always taken
    input  logic [               TagBits-1:0] line_rsp_tag_i,  // of the request
    input  logic [   LineBeatBits+Parity-1:0] line_rsp_data_i,  // beats of a line in order, the lowest bytes first; with parity, the highest bit: not read right
    // node memory and registers, written while idle
    input  logic                              cfg_valid_i,  // a word is written
    input  logic [                      23:0] cfg_addr_i,  // where: docs/photon_gatherer.md
    input  logic [                      63:0] cfg_data_i,  // the word
    // a node memory elsewhere, read where it has none: a word comes in the cycle after its address
    output logic [$clog2(photonloom_pkg::NodeWords)-1:0] shared_node_address_o,  // 0 where it has its own
    input  logic [photonloom_pkg::PositionBits+1+photonloom_pkg::Parity:0] shared_node_data_i,  // axis, split; with parity, its bit the highest
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
    output logic [31:0] count_stalled_lines_o, // cycles a line request waited to be taken
    output logic [31:0] count_faults_o  // words of memory that were not right; 0 without parity
);
  localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1;
  // Of several trees and lists the clock is what is short: what decides there is known a cycle earlier, or used a cycle later, and
  // distances wait in block RAM.
  localparam bit Wide = Trees > 1 && Lists > 1;
  localparam bit StartLater = photonloom_pkg::FarGatherers != 0 && CacheBytes != 0;
  localparam int unsigned TreeContextBits = Contexts > Trees ? $clog2((Contexts + Trees - 1) / Trees) : 1;
  localparam int unsigned ListContextBits = Contexts > Lists ? $clog2((Contexts + Lists - 1) / Lists) : 1;
  localparam int unsigned SumContextBits = Contexts > Sums ? $clog2((Contexts + Sums - 1) / Sums) : 1;
  localparam int unsigned R2Bits = photonloom_pkg::R2Bits;
  localparam int unsigned IndexBits = photonloom_pkg::IndexBits;
  localparam int unsigned K = photonloom_pkg::K;
  localparam int unsigned PlaceBits = K > 1 ? $clog2(K) : 1;
  localparam int unsigned NodeBits = LineBits + 1;
  localparam int unsigned StackBits = $clog2(LineBits + 1);
  localparam int unsigned StoreBits = 2 * photonloom_pkg::DirectionBits +
      photonloom_pkg::Channels * photonloom_pkg::MantissaBits + photonloom_pkg::ExponentBits + R2Bits + IndexBits;

  // The largest power of two of sets that fits in CacheBytes.
  localparam int unsigned SetsThatFit =
      CacheBytes / (photonloom_pkg::Bucket * photonloom_pkg::PhotonBytes * CacheWays);
  localparam int unsigned Sets = SetsThatFit == 0 ? 0 : 1 << ($clog2(SetsThatFit + 1) - 1);
  localparam int unsigned SetBits = Sets > 1 ? $clog2(Sets) : 1;

  if (Sets == 0 && CacheBytes != 0) begin : gen_bad_cache
    cache_bytes_must_hold_one_line_in_each_way bad_cache ();
  end

  photonloom_pkg::gather_query_t query;
  logic forget, bypass, start, search, slot_ready, flush_ready, busy;
  logic token, token_taken, token_done, empty_done, photons_free, leaf_valid, leaf_map, leaf_first;
  logic [SetBits-1:0] set_mask;
  logic [Trees-1:0] tree_done, finish_valid, finish_ready, finish_stop, node_wrong;
  logic [Lists-1:0] bound_write;
  logic [Sums-1:0] sum_free;
  logic [ContextBits-1:0] search_context, token_context, photons_free_context, leaf_context;
  logic [Trees*TreeContextBits-1:0] tree_done_context, finish_context, node_wrong_context;
  logic [Lists*ListContextBits-1:0] bound_context;
  logic [Sums*SumContextBits-1:0] sum_free_context;
  logic [3*(photonloom_pkg::NormalBits+2)-1:0] search_normal;
  logic [R2Bits-1:0] token_r2_max;
  logic [LineBits-1:0] leaf_line;
  logic [StackBits-1:0] leaf_stack, leaf_steps;
  logic [Trees*StackBits-1:0] finish_stack;
  logic [Lists*R2Bits-1:0] bound;
  logic [$clog2(2*Trees+1)-1:0] nodes, dropped;

  photon_gatherer_descent #(
      .Contexts(Contexts),
      .Levels(Levels),
      .Wide(Wide),
      .OwnNodes(OwnNodes),
      .EarlyReplies(EarlyReplies),
      .Trees(Trees),
      .Lists(Lists),
      .Sums(Sums),
      .Sets(Sets)
  ) descent (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .cfg_valid_i(cfg_valid_i),
      .cfg_addr_i(cfg_addr_i),
      .cfg_data_i(cfg_data_i),
      .shared_node_address_o(shared_node_address_o),
      .shared_node_data_i(shared_node_data_i),
      .forget_o(forget),
      .set_mask_o(set_mask),
      .bypass_o(bypass),
      .in_valid_i(in_valid_i),
      .in_ready_o(in_ready_o),
      .in_i(in_i),
      .slot_ready_i(slot_ready),
      .flush_ready_i(flush_ready),
      .start_o(start),
      .search_o(search),
      .context_o(search_context),
      .query_o(query),
      .normal_o(search_normal),
      .token_o(token),
      .token_taken_i(token_taken),
      .token_context_o(token_context),
      .token_done_i(token_done),
      .token_r2_max_o(token_r2_max),
      .leaf_valid_o(leaf_valid),
      .leaf_context_o(leaf_context),
      .leaf_map_o(leaf_map),
      .leaf_first_o(leaf_first),
      .leaf_line_o(leaf_line),
      .leaf_stack_o(leaf_stack),
      .leaf_steps_o(leaf_steps),
      .finish_valid_i(finish_valid),
      .finish_ready_o(finish_ready),
      .finish_context_i(finish_context),
      .finish_stack_i(finish_stack),
      .finish_stop_i(finish_stop),
      .bound_write_i(bound_write),
      .bound_context_i(bound_context),
      .bound_i(bound),
      .done_o(tree_done),
      .done_context_o(tree_done_context),
      .empty_done_o(empty_done),
      .sum_free_i(sum_free),
      .sum_free_context_i(sum_free_context),
      .photons_free_i(photons_free),
      .photons_free_context_i(photons_free_context),
      .busy_o(busy),
      .wrong_o(node_wrong),
      .wrong_context_o(node_wrong_context),
      .nodes_o(nodes),
      .dropped_o(dropped)
  );

  logic leaf, hit, miss, snapshot, snapshot_taken, snapshot_done, line_wrong, tag_wrong;
  logic [ContextBits-1:0] line_wrong_context;
  logic [Sums-1:0] found_faulty;
  logic [Lists-1:0] store_read;
  logic [ContextBits-1:0] snapshot_context;
  logic [Sums*SumContextBits-1:0] found_context;
  logic [Lists*ListContextBits-1:0] store_context;
  logic [Sums*photonloom_pkg::CountBits-1:0] found_count;
  logic [photonloom_pkg::CountBits-1:0] snapshot_count;
  logic [Sums*R2Bits-1:0] found_r2;
  logic [Sums*(IndexBits+1)-1:0] found_insertions;
  logic [Sums*NodeBits-1:0] found_leaves, found_nodes;
  logic [Lists*PlaceBits-1:0] store_place;
  logic [Lists*StoreBits-1:0] store_word;
  logic [K*PlaceBits-1:0] snapshot_places;
  logic [$clog2(2*Lists+1)-1:0] candidates, insertions;

  photon_gatherer_leaves #(
      .Contexts(Contexts),
      .Wide(Wide),
      .Trees(Trees),
      .Lists(Lists),
      .Sums(Sums),
      .Lanes(Lanes),
      .Sets(Sets),
      .CacheWays(CacheWays),
      .CacheMisses(CacheMisses),
      .LineBeatBits(LineBeatBits)
  ) leaves (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .forget_i(forget),
      .set_mask_i(set_mask),
      .bypass_i(bypass),
      .start_i(search),
      .start_context_i(search_context),
      .start_position_i(query.position),
      .start_normal_i(search_normal),
      .token_i(token),
      .token_taken_o(token_taken),
      .token_context_i(token_context),
      .token_r2_max_i(token_r2_max),
      .token_done_o(token_done),
      .leaf_valid_i(leaf_valid),
      .leaf_context_i(leaf_context),
      .leaf_map_i(leaf_map),
      .leaf_first_i(leaf_first),
      .leaf_line_i(leaf_line),
      .leaf_stack_i(leaf_stack),
      .leaf_steps_i(leaf_steps),
      .finish_valid_o(finish_valid),
      .finish_ready_i(finish_ready),
      .finish_context_o(finish_context),
      .finish_stack_o(finish_stack),
      .finish_stop_o(finish_stop),
      .bound_write_o(bound_write),
      .bound_context_o(bound_context),
      .bound_o(bound),
      .line_req_valid_o(line_req_valid_o),
      .line_req_ready_i(line_req_ready_i),
      .line_req_addr_o(line_req_addr_o),
      .line_req_tag_o(line_req_tag_o),
      .line_rsp_valid_i(line_rsp_valid_i),
      .line_rsp_tag_i(line_rsp_tag_i),
      .line_rsp_data_i(line_rsp_data_i),
      .found_context_i(found_context),
      .found_count_o(found_count),
      .found_r2_o(found_r2),
      .found_insertions_o(found_insertions),
      .found_leaves_o(found_leaves),
      .found_nodes_o(found_nodes),
      .store_read_i(store_read),
      .store_context_i(store_context),
      .store_place_i(store_place),
      .store_word_o(store_word),
      .snapshot_i(snapshot),
      .snapshot_taken_o(snapshot_taken),
      .snapshot_context_i(snapshot_context),
      .snapshot_done_o(snapshot_done),
      .snapshot_count_o(snapshot_count),
      .snapshot_places_o(snapshot_places),
      .line_wrong_o(line_wrong),
      .line_wrong_context_o(line_wrong_context),
      .tag_wrong_o(tag_wrong),
      .leaf_o(leaf),
      .hit_o(hit),
      .miss_o(miss),
      .candidates_o(candidates),
      .insertions_o(insertions)
  );

  // Of far gatherers with a leaf cache, those before an SDRAM, what starts comes a cycle later to where results wait: they lie
  // far from the tree. What starts next does so two cycles later at the earliest, when a slot taken counts.
  logic answers_start, answers_search;
  logic [ContextBits-1:0] answers_context;
  photonloom_pkg::gather_query_t answers_query;
  if (StartLater) begin : gen_start_later
    logic start_q, search_q;
    logic [ContextBits-1:0] context_q;
    photonloom_pkg::gather_query_t query_q;
    always_ff @(posedge clk_i) begin
      {start_q, search_q} <= rst_i ? '0 : {start, search};
      {context_q, query_q} <= {search_context, query};
    end
    assign {answers_start, answers_search, answers_context, answers_query} = {start_q, search_q, context_q, query_q};
  end else begin : gen_start_now
    assign answers_start = start;
    assign answers_search = search;
    assign answers_context = search_context;
    assign answers_query = query;
  end

  photon_gatherer_answers #(
      .Contexts(Contexts),
      .Wide(Wide),
      .StartLater(StartLater),
      .Trees(Trees),
      .Lists(Lists),
      .Sums(Sums)
  ) answers (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .slot_ready_o(slot_ready),
      .flush_ready_o(flush_ready),
      .start_i(answers_start),
      .search_i(answers_search),
      .search_context_i(answers_context),
      .query_i(answers_query),
      .tree_done_i(tree_done),
      .tree_done_context_i(tree_done_context),
      .empty_done_i(empty_done),
      .empty_done_context_i(token_context),
      .found_context_o(found_context),
      .found_count_i(found_count),
      .found_r2_i(found_r2),
      .found_insertions_i(found_insertions),
      .found_leaves_i(found_leaves),
      .found_nodes_i(found_nodes),
      .found_faulty_i(found_faulty),
      .store_read_o(store_read),
      .store_context_o(store_context),
      .store_place_o(store_place),
      .store_word_i(store_word),
      .snapshot_o(snapshot),
      .snapshot_taken_i(snapshot_taken),
      .snapshot_context_o(snapshot_context),
      .snapshot_done_i(snapshot_done),
      .snapshot_count_i(snapshot_count),
      .snapshot_places_i(snapshot_places),
      .sum_free_o(sum_free),
      .sum_free_context_o(sum_free_context),
      .photons_free_o(photons_free),
      .photons_free_context_o(photons_free_context),
      .result_valid_o(result_valid_o),
      .result_ready_i(result_ready_i),
      .result_o(result_o),
      .photon_valid_o(photon_valid_o),
      .photon_ready_i(photon_ready_i),
      .photon_o(photon_o)
  );

  photon_gatherer_faults #(
      .Contexts(Contexts),
      .Trees(Trees),
      .Sums(Sums)
  ) faults (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .start_i(search),
      .start_context_i(search_context),
      .node_i(node_wrong),
      .node_context_i(node_wrong_context),
      .line_i(line_wrong),
      .line_context_i(line_wrong_context),
      .tag_i(tag_wrong),
      .found_context_i(found_context),
      .found_faulty_o(found_faulty),
      .count_o(count_faults_o)
  );

  // Of counted events there are two of each tree's and list's at most in a cycle.
  localparam int unsigned StepBits = $clog2(2 * (Trees > Lists ? Trees : Lists) + 1);

  photon_gatherer_counters #(
      .StepBits(StepBits)
  ) counters (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .step_i({
        {StepBits'(line_req_valid_o && !line_req_ready_i), StepBits'(photon_valid_o && !photon_ready_i)},
        {StepBits'(result_valid_o && !result_ready_i), StepBits'(in_valid_i && !in_ready_o)},
        {StepBits'(miss), StepBits'(hit), StepBits'(insertions), StepBits'(candidates), StepBits'(leaf)},
        {StepBits'(dropped), StepBits'(nodes), StepBits'(search), StepBits'(busy)}
      }),
      .count_o({
        {count_stalled_lines_o, count_stalled_photons_o, count_stalled_results_o, count_stalled_in_o},
        {count_cache_misses_o, count_cache_hits_o, count_insertions_o, count_candidates_o, count_leaves_o},
        {count_dropped_o, count_nodes_o, count_queries_o, count_busy_o}
      })
  );
endmodule
