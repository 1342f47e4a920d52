// SPDX-License-Identifier: Apache-2.0
// Searches leaves: from a leaf that is reached, through its line, its photons and the candidates among them, to the
// lists of their queries and back to the tree. Wires three modules: photon_gatherer_leaf_state keeps what belongs to the
// leaf meanwhile, photon_gatherer_beats reads the line and measures distances, photon_gatherer_lists tests sides and holds
// the lists. Where lines are compressed, photon_gatherer_further_lines makes one leaf of several
// lines, searched one after the other. Mirrors the leaf step of search_gather in golden/unit/photon_gatherer.cpp.
//
// Trees, lists and sums each have their part of the contexts: number n of N has the contexts c with c % N = n, as c / N.
//
// One leaf, one beat and Lists candidates a cycle; about 27 cycles from a leaf in the cache to its last insertion.
module photon_gatherer_leaves #(
    parameter int unsigned Contexts = 16,
    parameter int unsigned Trees = 1,
    parameter int unsigned Lists = 1,
    parameter int unsigned Sums = 1,
    parameter int unsigned Lanes = 4,
    parameter int unsigned Sets = 64,
    parameter int unsigned CacheWays = 2,
    parameter int unsigned CacheMisses = 8,
    parameter int unsigned LineBeatBits = 128,
    parameter bit Wide = 1'b0,  // of several trees and lists
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned TreeContexts = (Contexts + Trees - 1) / Trees,
    localparam int unsigned TreeContextBits = TreeContexts > 1 ? $clog2(TreeContexts) : 1,
    localparam int unsigned ListContexts = (Contexts + Lists - 1) / Lists,
    localparam int unsigned ListContextBits = ListContexts > 1 ? $clog2(ListContexts) : 1,
    localparam int unsigned SumContexts = (Contexts + Sums - 1) / Sums,
    localparam int unsigned SumContextBits = SumContexts > 1 ? $clog2(SumContexts) : 1,
    localparam int unsigned K = photonloom_pkg::K,
    localparam int unsigned CountBits = photonloom_pkg::CountBits,
    localparam int unsigned PlaceBits = K > 1 ? $clog2(K) : 1,
    localparam int unsigned PositionBits = photonloom_pkg::PositionBits,
    localparam int unsigned NormalBits = photonloom_pkg::NormalBits,
    localparam int unsigned R2Bits = photonloom_pkg::R2Bits,
    localparam int unsigned LineBits = photonloom_pkg::LineBits,
    localparam int unsigned AddressBits = photonloom_pkg::LineAddressBits,
    localparam int unsigned NodeBits = LineBits + 1,
    localparam int unsigned StackBits = $clog2(LineBits + 1),
    localparam int unsigned IndexBits = photonloom_pkg::IndexBits,
    localparam int unsigned DirectionBits = photonloom_pkg::DirectionBits,
    localparam int unsigned LoadBits = 2 * DirectionBits + photonloom_pkg::Channels * photonloom_pkg::MantissaBits +
        photonloom_pkg::ExponentBits,
    localparam int unsigned StoreBits = LoadBits + R2Bits + IndexBits,
    localparam int unsigned SetBits = Sets > 1 ? $clog2(Sets) : 1,
    localparam int unsigned TagBits = Sets == 0 ? ContextBits : CacheMisses > 1 ? $clog2(CacheMisses) : 1,
    localparam int unsigned StepBits = $clog2(2 * Lists + 1),
    localparam int unsigned Parity = photonloom_pkg::Parity
) (
    input  logic                             clk_i,
    input  logic                             rst_i,
    // configuration of the cache
    input  logic                             forget_i,
    input  logic [              SetBits-1:0] set_mask_i,
    input  logic                             bypass_i,
    // a query starts
    input  logic                             start_i,
    input  logic [          ContextBits-1:0] start_context_i,
    input  logic [       3*PositionBits-1:0] start_position_i,
    input  logic [     3*(NormalBits+2)-1:0] start_normal_i,      // decoded, z negated
    // its list is emptied
    input  logic                             token_i,
    output logic                             token_taken_o,
    input  logic [          ContextBits-1:0] token_context_i,
    input  logic [               R2Bits-1:0] token_r2_max_i,
    output logic                             token_done_o,
    // a leaf is reached
    input  logic                             leaf_valid_i,
    input  logic [          ContextBits-1:0] leaf_context_i,
    input  logic                             leaf_map_i,
    input  logic                             leaf_first_i,
    input  logic [             LineBits-1:0] leaf_line_i,
    input  logic [            StackBits-1:0] leaf_stack_i,
    input  logic [            StackBits-1:0] leaf_steps_i,
    // and done, for each tree
    output logic [                Trees-1:0] finish_valid_o,
    input  logic [                Trees-1:0] finish_ready_i,
    output logic [Trees*TreeContextBits-1:0] finish_context_o,
    output logic [      Trees*StackBits-1:0] finish_stack_o,
    output logic [                Trees-1:0] finish_stop_o,
    // a bound is written, by each list
    output logic [                Lists-1:0] bound_write_o,
    output logic [Lists*ListContextBits-1:0] bound_context_o,
    output logic [         Lists*R2Bits-1:0] bound_o,
    // leaf lines
    output logic                             line_req_valid_o,
    input  logic                             line_req_ready_i,
    output logic [            AddressBits:0] line_req_addr_o,
    output logic [              TagBits-1:0] line_req_tag_o,
    input  logic                             line_rsp_valid_i,
    input  logic [              TagBits-1:0] line_rsp_tag_i,
    input  logic [  LineBeatBits+Parity-1:0] line_rsp_data_i,
    // what was found for a context, for each sum
    input  logic [  Sums*SumContextBits-1:0] found_context_i,
    output logic [       Sums*CountBits-1:0] found_count_o,
    output logic [          Sums*R2Bits-1:0] found_r2_o,
    output logic [   Sums*(IndexBits+1)-1:0] found_insertions_o,
    output logic [        Sums*NodeBits-1:0] found_leaves_o,
    output logic [        Sums*NodeBits-1:0] found_nodes_o,
    // its photons, of each list: load, d2, index, a cycle after the address
    input  logic [                Lists-1:0] store_read_i,
    input  logic [Lists*ListContextBits-1:0] store_context_i,
    input  logic [      Lists*PlaceBits-1:0] store_place_i,
    output logic [      Lists*StoreBits-1:0] store_word_o,
    // a snapshot of their places in list order
    input  logic                             snapshot_i,
    output logic                             snapshot_taken_o,
    input  logic [          ContextBits-1:0] snapshot_context_i,
    output logic                             snapshot_done_o,
    output logic [            CountBits-1:0] snapshot_count_o,
    output logic [          K*PlaceBits-1:0] snapshot_places_o,
    // a line, a tag of the cache was not right
    output logic                             line_wrong_o,
    output logic [          ContextBits-1:0] line_wrong_context_o,
    output logic                             tag_wrong_o,
    // counted events
    output logic                             leaf_o,
    output logic                             hit_o,
    output logic                             miss_o,
    output logic [             StepBits-1:0] candidates_o,        // how many
    output logic [             StepBits-1:0] insertions_o
);
  // Between a beat's place in the FIFO and its candidates' loads: the beat in hand, 8 pairs tested and to be tested, the
  // pair that waits, the pair in hand and 3 stages of the list. Where more beats may wait, fewer: photon_gatherer_candidates takes
  // none of which that would be too many. Of lists without codes it does not. There beats of which no pair is kept pass the pair in hand,
  // some 6 where there are as many: of many contexts whose lines are few beats, which may all be such. They have twice the rows.
  localparam int unsigned Beats = photonloom_pkg::Bucket / Lanes;
  localparam int unsigned Behind = photonloom_pkg::ListCodeBits == 0 && ListContexts > 16 && Beats <= 2 ? 48 :
      photonloom_pkg::QueuedBeats > 16 ? 32 - photonloom_pkg::QueuedBeats : 16;
  localparam int unsigned BeatBits = Beats > 1 ? $clog2(Beats) : 1;
  localparam int unsigned RowBits = $clog2((2 * Beats > 16 ? 1 << $clog2(2 * Beats) : photonloom_pkg::QueuedBeats) + Behind);

  logic [Lists*ListContextBits-1:0] line_context, leaf_done_context;
  logic [Lists*LineBits-1:0] lines;
  logic [Lists-1:0] leaf_done;
  logic leaf_empty;
  logic [ContextBits-1:0] leaf_empty_context;

  // ---- further lines of a leaf ----
  logic next_valid, next_ready, line_last, line_more;
  logic [ContextBits-1:0] next_context, line_last_context;
  logic [AddressBits:0] next_address, line_next;
  logic [Trees-1:0] line_done, line_done_ready;

  if (photonloom_pkg::LinesCompressed != 0) begin : gen_further
    photon_gatherer_further_lines #(
        .Contexts(Contexts),
        .Trees(Trees)
    ) further_lines (
        .clk_i(clk_i),
        .line_valid_i(line_last),
        .line_context_i(line_last_context),
        .line_more_i(line_more),
        .line_next_i(line_next),
        .line_done_valid_i(line_done),
        .line_done_ready_o(line_done_ready),
        .line_done_context_i(finish_context_o),
        .leaf_done_valid_o(finish_valid_o),
        .leaf_done_ready_i(finish_ready_i),
        .ask_valid_o(next_valid),
        .ask_ready_i(next_ready),
        .ask_context_o(next_context),
        .ask_address_o(next_address)
    );
  end else begin : gen_one_line
    /* verilator lint_off UNUSEDSIGNAL */
    logic unused;
    /* verilator lint_on UNUSEDSIGNAL */
    assign unused = &{1'b0, next_ready, line_last, line_last_context, line_more, line_next};
    assign {next_valid, next_context, next_address} = '0;
    assign finish_valid_o = line_done;
    assign line_done_ready = finish_ready_i;
  end

  photon_gatherer_leaf_state #(
      .Contexts(Contexts),
      .Trees(Trees),
      .Lists(Lists),
      .Sums(Sums)
  ) state (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .leaf_valid_i(leaf_valid_i),
      .leaf_context_i(leaf_context_i),
      .leaf_first_i(leaf_first_i),
      .leaf_line_i(leaf_line_i),
      .leaf_stack_i(leaf_stack_i),
      .leaf_steps_i(leaf_steps_i),
      .line_context_i(line_context),
      .line_o(lines),
      .done_i(leaf_done),
      .done_context_i(leaf_done_context),
      .empty_i(leaf_empty),
      .empty_context_i(leaf_empty_context),
      .finish_valid_o(line_done),
      .finish_ready_i(line_done_ready),
      .finish_context_o(finish_context_o),
      .finish_stack_o(finish_stack_o),
      .finish_stop_o(finish_stop_o),
      .counts_context_i(found_context_i),
      .leaves_o(found_leaves_o),
      .nodes_o(found_nodes_o),
      .leaf_o(leaf_o)
  );

  logic [Lists-1:0] beat_valid, beat_ready, beat_last, direction_read;
  logic [Lists*ListContextBits-1:0] beat_context;
  logic [Lists*BeatBits-1:0] beat_number;
  logic [Lists*RowBits-1:0] beat_row, load_row;
  logic [Lists*Lanes-1:0] beat_mask;
  logic [Lists*Lanes*R2Bits-1:0] beat_d2;
  logic [2*Lists*Lanes*DirectionBits-1:0] directions;
  logic [Lists*Lanes*LoadBits-1:0] loads;

  // Of far gatherers with a leaf cache, as most before an SDRAM have, it is late whether a beat waits and whether it is kept.
  localparam bit ReadAlways = Wide || (photonloom_pkg::FarGatherers != 0 && Sets != 0);

  photon_gatherer_beats #(
      .Contexts(Contexts),
      .Lists(Lists),
      .Lanes(Lanes),
      .Sets(Sets),
      .CacheWays(CacheWays),
      .CacheMisses(CacheMisses),
      .LineBeatBits(LineBeatBits),
      .Behind(Behind),
      .Wide(Wide),
      .WriteAlways(ReadAlways)
  ) beats (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .forget_i(forget_i),
      .set_mask_i(set_mask_i),
      .bypass_i(bypass_i),
      .start_i(start_i),
      .start_context_i(start_context_i),
      .start_position_i(start_position_i),
      .leaf_valid_i(leaf_valid_i),
      .leaf_context_i(leaf_context_i),
      .leaf_address_i({leaf_map_i, AddressBits'(leaf_line_i)}),
      .line_last_o(line_last),
      .line_context_o(line_last_context),
      .line_more_o(line_more),
      .line_next_o(line_next),
      .next_valid_i(next_valid),
      .next_ready_o(next_ready),
      .next_context_i(next_context),
      .next_address_i(next_address),
      .line_req_valid_o(line_req_valid_o),
      .line_req_ready_i(line_req_ready_i),
      .line_req_addr_o(line_req_addr_o),
      .line_req_tag_o(line_req_tag_o),
      .line_rsp_valid_i(line_rsp_valid_i),
      .line_rsp_tag_i(line_rsp_tag_i),
      .line_rsp_data_i(line_rsp_data_i),
      .line_wrong_o(line_wrong_o),
      .line_wrong_context_o(line_wrong_context_o),
      .tag_wrong_o(tag_wrong_o),
      .bound_write_i(bound_write_o),
      .bound_context_i(bound_context_o),
      .bound_i(bound_o),
      .empty_valid_o(leaf_empty),
      .empty_context_o(leaf_empty_context),
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
      .loads_o(loads),
      .hit_o(hit_o),
      .miss_o(miss_o)
  );

  photon_gatherer_lists #(
      .Contexts(Contexts),
      .Lists(Lists),
      .Sums(Sums),
      .Lanes(Lanes),
      .RowBits(RowBits),
      .Behind(Behind),
      .Wide(Wide),
      .ReadAlways(ReadAlways)
  ) lists (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .start_i(start_i),
      .start_context_i(start_context_i),
      .start_normal_i(start_normal_i),
      .token_i(token_i),
      .token_taken_o(token_taken_o),
      .token_context_i(token_context_i),
      .token_r2_max_i(token_r2_max_i),
      .token_done_o(token_done_o),
      .beat_valid_i(beat_valid),
      .beat_ready_o(beat_ready),
      .beat_context_i(beat_context),
      .beat_number_i(beat_number),
      .beat_row_i(beat_row),
      .beat_last_i(beat_last),
      .beat_mask_i(beat_mask),
      .beat_d2_i(beat_d2),
      .direction_read_o(direction_read),
      .directions_i(directions),
      .load_row_o(load_row),
      .loads_i(loads),
      .line_context_o(line_context),
      .line_i(lines),
      .leaf_done_o(leaf_done),
      .leaf_done_context_o(leaf_done_context),
      .bound_write_o(bound_write_o),
      .bound_context_o(bound_context_o),
      .bound_o(bound_o),
      .found_context_i(found_context_i),
      .found_count_o(found_count_o),
      .found_r2_o(found_r2_o),
      .found_insertions_o(found_insertions_o),
      .store_read_i(store_read_i),
      .store_context_i(store_context_i),
      .store_place_i(store_place_i),
      .store_word_o(store_word_o),
      .snapshot_i(snapshot_i),
      .snapshot_taken_o(snapshot_taken_o),
      .snapshot_context_i(snapshot_context_i),
      .snapshot_done_o(snapshot_done_o),
      .snapshot_count_o(snapshot_count_o),
      .snapshot_places_o(snapshot_places_o),
      .candidates_o(candidates_o),
      .insertions_o(insertions_o)
  );
endmodule
