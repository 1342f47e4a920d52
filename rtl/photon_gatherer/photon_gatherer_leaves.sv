// SPDX-License-Identifier: Apache-2.0
// Searches leaves: from a leaf that is reached, through its line, its photons and the candidates among them, to the
// lists of their queries and back to the tree. Wires three modules: photon_gatherer_leaf_state keeps what belongs to the
// leaf meanwhile, photon_gatherer_beats reads the line and measures distances, photon_gatherer_candidates tests sides
// and holds the lists. Mirrors the leaf step of search_gather in golden/unit/photon_gatherer.cpp.
//
// One leaf, one beat and one candidate a cycle; about 27 cycles from a leaf in the cache to its last insertion.
module photon_gatherer_leaves #(
    parameter int unsigned Contexts = 16,
    parameter int unsigned Lanes = 4,
    parameter int unsigned Sets = 64,
    parameter int unsigned CacheWays = 2,
    parameter int unsigned CacheMisses = 8,
    parameter int unsigned LineBeatBits = 128,
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned K = photonloom_pkg::K,
    localparam int unsigned CountBits = photonloom_pkg::CountBits,
    localparam int unsigned PlaceBits = K > 1 ? $clog2(K) : 1,
    localparam int unsigned PositionBits = photonloom_pkg::PositionBits,
    localparam int unsigned NormalBits = photonloom_pkg::NormalBits,
    localparam int unsigned R2Bits = photonloom_pkg::R2Bits,
    localparam int unsigned LineBits = photonloom_pkg::LineBits,
    localparam int unsigned NodeBits = LineBits + 1,
    localparam int unsigned StackBits = $clog2(LineBits + 1),
    localparam int unsigned IndexBits = photonloom_pkg::IndexBits,
    localparam int unsigned DirectionBits = photonloom_pkg::DirectionBits,
    localparam int unsigned LoadBits = 2 * DirectionBits + photonloom_pkg::Channels * photonloom_pkg::MantissaBits +
        photonloom_pkg::ExponentBits,
    localparam int unsigned StoreBits = LoadBits + R2Bits + IndexBits,
    localparam int unsigned SetBits = Sets > 1 ? $clog2(Sets) : 1,
    localparam int unsigned TagBits = CacheMisses > 1 ? $clog2(CacheMisses) : 1
) (
    input  logic                        clk_i,
    input  logic                        rst_i,
    // configuration of the cache
    input  logic                        forget_i,
    input  logic [         SetBits-1:0] set_mask_i,
    input  logic                        bypass_i,
    // a query starts
    input  logic                        start_i,
    input  logic [     ContextBits-1:0] start_context_i,
    input  logic [  3*PositionBits-1:0] start_position_i,
    input  logic [3*(NormalBits+2)-1:0] start_normal_i,      // decoded, z negated
    // its list is emptied
    input  logic                        token_i,
    output logic                        token_taken_o,
    input  logic [     ContextBits-1:0] token_context_i,
    input  logic [          R2Bits-1:0] token_r2_max_i,
    output logic                        token_done_o,
    // a leaf is reached
    input  logic                        leaf_valid_i,
    input  logic [     ContextBits-1:0] leaf_context_i,
    input  logic                        leaf_map_i,
    input  logic                        leaf_first_i,
    input  logic [        LineBits-1:0] leaf_line_i,
    input  logic [       StackBits-1:0] leaf_stack_i,
    input  logic [       StackBits-1:0] leaf_steps_i,
    // and done
    output logic                        finish_valid_o,
    input  logic                        finish_ready_i,
    output logic [     ContextBits-1:0] finish_context_o,
    output logic [       StackBits-1:0] finish_stack_o,
    output logic                        finish_stop_o,
    // a bound is written
    output logic                        bound_write_o,
    output logic [     ContextBits-1:0] bound_context_o,
    output logic [          R2Bits-1:0] bound_o,
    // leaf lines
    output logic                        line_req_valid_o,
    input  logic                        line_req_ready_i,
    output logic [          LineBits:0] line_req_addr_o,
    output logic [         TagBits-1:0] line_req_tag_o,
    input  logic                        line_rsp_valid_i,
    input  logic [         TagBits-1:0] line_rsp_tag_i,
    input  logic [    LineBeatBits-1:0] line_rsp_data_i,
    // what was found for a context
    input  logic [     ContextBits-1:0] found_context_i,
    output logic [       CountBits-1:0] found_count_o,
    output logic [          R2Bits-1:0] found_r2_o,
    output logic [         IndexBits:0] found_insertions_o,
    output logic [        NodeBits-1:0] found_leaves_o,
    output logic [        NodeBits-1:0] found_nodes_o,
    // its photons: load, d2, index, a cycle after the address
    input  logic                        store_read_i,
    input  logic [     ContextBits-1:0] store_context_i,
    input  logic [       PlaceBits-1:0] store_place_i,
    output logic [       StoreBits-1:0] store_word_o,
    // a snapshot of their places in list order
    input  logic                        snapshot_i,
    output logic                        snapshot_taken_o,
    input  logic [     ContextBits-1:0] snapshot_context_i,
    output logic                        snapshot_done_o,
    output logic [       CountBits-1:0] snapshot_count_o,
    output logic [     K*PlaceBits-1:0] snapshot_places_o,
    // counted events
    output logic                        leaf_o,
    output logic                        hit_o,
    output logic                        miss_o,
    output logic [                 1:0] candidates_o,        // how many
    output logic [                 1:0] insertions_o
);
  // Between a beat's place in the FIFO and its candidates' loads: the beat in hand, 16 pairs tested and to be tested, the
  // pair that waits, the pair in hand and 3 stages of the list.
  localparam int unsigned Behind = 24;
  localparam int unsigned Beats = photonloom_pkg::Bucket / Lanes;
  localparam int unsigned BeatBits = Beats > 1 ? $clog2(Beats) : 1;
  localparam int unsigned RowBits = $clog2((2 * Beats > 16 ? 1 << $clog2(2 * Beats) : 16) + Behind);

  logic [ContextBits-1:0] line_context;
  logic [LineBits-1:0] line;
  logic leaf_done, leaf_empty;
  logic [ContextBits-1:0] leaf_done_context, leaf_empty_context;

  photon_gatherer_leaf_state #(
      .Contexts(Contexts)
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
      .line_o(line),
      .done_i(leaf_done),
      .done_context_i(leaf_done_context),
      .empty_i(leaf_empty),
      .empty_context_i(leaf_empty_context),
      .finish_valid_o(finish_valid_o),
      .finish_ready_i(finish_ready_i),
      .finish_context_o(finish_context_o),
      .finish_stack_o(finish_stack_o),
      .finish_stop_o(finish_stop_o),
      .counts_context_i(found_context_i),
      .leaves_o(found_leaves_o),
      .nodes_o(found_nodes_o),
      .leaf_o(leaf_o)
  );

  logic beat_valid, beat_ready, beat_last, direction_read;
  logic [ContextBits-1:0] beat_context;
  logic [BeatBits-1:0] beat_number;
  logic [RowBits-1:0] beat_row, load_row;
  logic [Lanes-1:0] beat_mask;
  logic [Lanes*R2Bits-1:0] beat_d2;
  logic [2*Lanes*DirectionBits-1:0] directions;
  logic [Lanes*LoadBits-1:0] loads;

  photon_gatherer_beats #(
      .Contexts(Contexts),
      .Lanes(Lanes),
      .Sets(Sets),
      .CacheWays(CacheWays),
      .CacheMisses(CacheMisses),
      .LineBeatBits(LineBeatBits),
      .Behind(Behind)
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
      .leaf_address_i({leaf_map_i, leaf_line_i}),
      .line_req_valid_o(line_req_valid_o),
      .line_req_ready_i(line_req_ready_i),
      .line_req_addr_o(line_req_addr_o),
      .line_req_tag_o(line_req_tag_o),
      .line_rsp_valid_i(line_rsp_valid_i),
      .line_rsp_tag_i(line_rsp_tag_i),
      .line_rsp_data_i(line_rsp_data_i),
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

  photon_gatherer_candidates #(
      .Contexts(Contexts),
      .Lanes(Lanes),
      .RowBits(RowBits)
  ) candidates (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .search_i(start_i),
      .search_context_i(start_context_i),
      .search_normal_i(start_normal_i),
      .start_i(token_i),
      .start_taken_o(token_taken_o),
      .start_context_i(token_context_i),
      .start_r2_max_i(token_r2_max_i),
      .start_done_o(token_done_o),
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
      .load_row_o(load_row),
      .loads_i(loads),
      .line_context_o(line_context),
      .line_i(line),
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
