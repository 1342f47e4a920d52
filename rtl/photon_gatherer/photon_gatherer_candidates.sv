// SPDX-License-Identifier: Apache-2.0
// Beats to the lists of their queries, a candidate a cycle. Of several of these each has some of the unit's contexts. Pairs
// of neighbouring candidates come from photon_gatherer_pairs, the oldest is compared with the bound again until it is in
// hand, and what is in hand goes to photon_gatherer_list. So candidates that lie behind the surface or that the bound has
// left behind seldom take a cycle of the list.
//
// What goes to the list, in the order of slots: tokens {a candidate, the last of its leaf, a start, a
// snapshot}. Starts and snapshots carry only a context and go before the next pair, within two cycles. leaf_done_o
// follows the last token of a leaf by a cycle. Where all candidates went before it was known that they were the last,
// the end goes beside what is in hand, or takes a token of its own if that ends a leaf too. Latency 9 from a beat to its
// first token.
//
// With photonloom_pkg::ListCodeBits the list is a photon_gatherer_coded_list. While that is not ready, the hand stays, and so does what
// was under way with its tokens: loads, and the ends of leaves, which go with them as far as where all is written.
module photon_gatherer_candidates #(
    parameter int unsigned Contexts = 16,
    parameter int unsigned Lanes = 4,
    parameter int unsigned RowBits = 6,
    parameter int unsigned Behind = 16,  // rows of beats that may have left the FIFO
    // Of several trees and lists (Wide) and of far gatherers the clock is what is short: what decides is known earlier, for more LUTs.
    parameter bit Wide = 1'b0,
    parameter bit ReadAlways = Wide,  // as in photon_gatherer_pairs
    parameter bit SlowCodes = Wide,  // codes spread over the part: compared a cycle later, of more than 24 places written a cycle later too
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned K = photonloom_pkg::K,
    localparam int unsigned CountBits = photonloom_pkg::CountBits,
    localparam int unsigned PlaceBits = K > 1 ? $clog2(K) : 1,
    localparam int unsigned R2Bits = photonloom_pkg::R2Bits,
    localparam int unsigned LineBits = photonloom_pkg::LineBits,
    localparam int unsigned IndexBits = photonloom_pkg::IndexBits,
    localparam int unsigned Bucket = photonloom_pkg::Bucket,
    localparam int unsigned NormalBits = photonloom_pkg::NormalBits,
    localparam int unsigned DirectionBits = photonloom_pkg::DirectionBits,
    localparam int unsigned LoadBits = 2 * DirectionBits + photonloom_pkg::Channels * photonloom_pkg::MantissaBits +
        photonloom_pkg::ExponentBits,
    localparam int unsigned StoreBits = LoadBits + R2Bits + IndexBits,
    localparam int unsigned Beats = Bucket / Lanes,
    localparam int unsigned BeatBits = Beats > 1 ? $clog2(Beats) : 1
) (
    input  logic                             clk_i,
    input  logic                             rst_i,
    // a query starts
    input  logic                             search_i,
    input  logic [          ContextBits-1:0] search_context_i,
    input  logic [     3*(NormalBits+2)-1:0] search_normal_i,    // decoded, z negated
    // its list is emptied
    input  logic                             start_i,
    output logic                             start_taken_o,
    input  logic [          ContextBits-1:0] start_context_i,
    input  logic [               R2Bits-1:0] start_r2_max_i,     // held until done
    output logic                             start_done_o,
    // beats
    input  logic                             in_valid_i,
    output logic                             in_ready_o,
    input  logic [          ContextBits-1:0] in_context_i,
    input  logic [             BeatBits-1:0] in_beat_i,
    input  logic [              RowBits-1:0] in_row_i,
    input  logic                             in_last_i,
    input  logic [                Lanes-1:0] in_mask_i,
    input  logic [         Lanes*R2Bits-1:0] in_d2_i,
    output logic                             direction_read_o,
    input  logic [2*Lanes*DirectionBits-1:0] directions_i,
    output logic [              RowBits-1:0] load_row_o,
    input  logic [       Lanes*LoadBits-1:0] loads_i,
    // the line of a context's leaf
    output logic [          ContextBits-1:0] line_context_o,
    input  logic [             LineBits-1:0] line_i,
    // ends of leaves
    output logic                             leaf_done_o,
    output logic [          ContextBits-1:0] leaf_done_context_o,
    // a bound is written
    output logic                             bound_write_o,
    output logic [          ContextBits-1:0] bound_context_o,
    output logic [               R2Bits-1:0] bound_o,
    // what was found for a context
    input  logic [          ContextBits-1:0] found_context_i,
    output logic [            CountBits-1:0] found_count_o,
    output logic [              IndexBits:0] found_insertions_o,
    // its photons: load, d2, index, a cycle after the address
    input  logic                             store_read_i,
    input  logic [          ContextBits-1:0] store_context_i,
    input  logic [            PlaceBits-1:0] store_place_i,
    output logic [            StoreBits-1:0] store_word_o,
    // a snapshot of their places in list order, the first lowest
    input  logic                             snapshot_i,
    output logic                             snapshot_taken_o,
    input  logic [          ContextBits-1:0] snapshot_context_i,
    output logic                             snapshot_done_o,
    output logic [            CountBits-1:0] snapshot_count_o,
    output logic [          K*PlaceBits-1:0] snapshot_places_o,
    // counted events: one came to the list, entered it
    output logic                             candidates_o,
    output logic                             insertions_o
);
  localparam int unsigned SlotBits = $clog2(Bucket);
  localparam int unsigned LaneBits = Lanes > 1 ? $clog2(Lanes) : 1;
  localparam int unsigned CandidateBits = SlotBits + R2Bits;
  localparam bit Coded = photonloom_pkg::ListCodeBits != 0;
  // Far: the bounds of the pair that waits and of the next one are both read, before it is known which it will be, and in hand a
  // candidate has the exponent of its code.
  localparam bit Far = Wide || photonloom_pkg::FarGatherers != 0;
  // Memories with a word for each of more than 16 contexts are a choice of two cells of LUT RAM, or more, and spread over the part.
  localparam bit ManyContexts = photonloom_pkg::FarGatherers != 0 && Contexts > 16;
  localparam int unsigned ExponentBits = photonloom_pkg::ListCodeBits < 20 ? 4 : 3;  // with 16 bits, 4 leave the coarsest codes 10 bits of their keys of 42, 3 only 8
  localparam int unsigned KeyLow = IndexBits > 8 ? 8 : IndexBits;  // of the index in a code; less than a mantissa's bits

  logic [ContextBits-1:0] normal_context, pair_context;
  logic [3*(NormalBits+2)-1:0] normal;
  logic pair_valid, pair_taken, pair_last, pair_first;
  logic [RowBits-1:0] pair_row;
  logic [1:0] pair_front;
  logic [2*CandidateBits-1:0] pair_candidates;

  lut_ram #(
      .Width(3 * (NormalBits + 2)),
      .Depth(Contexts)
  ) normals (
      .clk_i(clk_i),
      .write_i(search_i),
      .write_address_i(search_context_i),
      .write_data_i(search_normal_i),
      .read_address_i(normal_context),
      .read_data_o(normal)
  );

  photon_gatherer_pairs #(
      .R2Bits(R2Bits),
      .Contexts(Contexts),
      .Bucket(Bucket),
      .Lanes(Lanes),
      .RowBits(RowBits),
      .DirectionBits(DirectionBits),
      .NormalBits(NormalBits),
      .RoomLater(32'(Far)),
      .ReadAlways(ReadAlways),
      .DistanceRows(Wide)
  ) pairs (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i && !(Coded && !rows_left_q)),
      .in_ready_o(pairs_ready),
      .in_context_i(in_context_i),
      .in_beat_i(in_beat_i),
      .in_row_i(in_row_i),
      .in_last_i(in_last_i),
      .in_mask_i(in_mask_i),
      .in_d2_i(in_d2_i),
      .direction_read_o(direction_read_o),
      .directions_i(directions_i),
      .normal_context_o(normal_context),
      .normal_i(normal),
      .out_valid_o(pair_valid),
      .out_ready_i(pair_taken),
      .out_context_o(pair_context),
      .out_row_o(pair_row),
      .out_last_o(pair_last),
      .out_first_o(pair_first),
      .out_front_o(pair_front),
      .out_candidates_o(pair_candidates)
  );

  assign in_ready_o = Coded ? pairs_ready && rows_left_q : pairs_ready;

  // ---- the oldest pair loses what the bound leaves behind while it waits ----
  // When nothing is left of it, it goes without being taken. If it ends its leaf, that is merged with the pair in hand where
  // this is of the same leaf, and else is done now where the hand does not end another one. The bound is that of a cycle
  // ago: it only shrinks, so what is beyond it stays so.
  logic wait_valid_q, wait_last_q, wait_first_q, gone, first_gone_q, wait_alone, wait_merge, wait_end, wait_take;
  logic [ContextBits-1:0] wait_context_q, wait_bound_context;
  logic [RowBits-1:0] wait_row_q;
  logic [1:0] wait_mask_q, wait_near;
  logic [R2Bits-1:0] wait_bound, wait_bound_q;
  /* verilator lint_off UNDRIVEN */
  /* verilator lint_off UNUSEDSIGNAL */
  // where Far
  logic far_taken, far_rows_left;
  logic [R2Bits-1:0] next_bound;
  /* verilator lint_on UNUSEDSIGNAL */
  /* verilator lint_on UNDRIVEN */
  logic [2*CandidateBits-1:0] wait_candidates_q;
  logic hand_q, hand_last_q, hand_other_q, ask, hand_two, hand_free, hand_end;
  logic [LineBits-1:0] hand_line_q;
  logic token_candidate, token_start_q, token_snapshot_q;
  logic [ContextBits-1:0] token_context_q;
  logic [IndexBits-1:0] token_index;
  logic [R2Bits-1:0] token_d2;
  logic [1:0] hand_mask_q;
  logic [2*CandidateBits-1:0] hand_candidates_q;
  /* verilator lint_off UNDRIVEN */
  /* verilator lint_off UNUSEDSIGNAL */
  // Only where Coded: the other list is always ready. Each use says so itself, so that nothing of it is left there.
  logic list_ready, list_waits_q;
  logic hand_two_q;  // where Wide: the hand's mask, which chooses a candidate's every bit, does not decide besides what is taken
  logic rows_left_q;  // where Coded: a beat may be taken
  /* verilator lint_on UNUSEDSIGNAL */
  /* verilator lint_on UNDRIVEN */
  logic ended_q, pairs_ready;
  logic [ContextBits-1:0] ended_context_q;

  assign gone = wait_valid_q && wait_mask_q == '0 && !wait_last_q;
  assign wait_alone = wait_valid_q && wait_mask_q == '0 && wait_last_q;
  assign wait_merge = wait_alone && !wait_first_q && hand_q && !hand_other_q && !(Coded && !list_ready);
  assign wait_end = wait_alone && !wait_merge && !hand_end && !(Coded && !list_ready);
  assign wait_take = wait_valid_q && !gone && !wait_merge && !wait_end && hand_free && !ask;
  assign pair_taken = Far ? far_taken : !wait_valid_q || gone || wait_merge || wait_end || wait_take;
  if (Far) begin : gen_taken
    // The same, of what is known first.
    logic end_goes, hand_takes;
    assign end_goes = !(Coded && !list_ready) && ((!wait_first_q && hand_q && !hand_other_q) || !hand_end);
    assign hand_takes = !(Coded && !list_ready) && !ask && !(hand_q && hand_two);
    assign far_taken = !wait_valid_q || (wait_mask_q == '0 && (!wait_last_q || end_goes)) || hand_takes;
  end
  for (genvar c = 0; c < 2; c++) begin : gen_near
    logic beyond;
    less_than #(
        .Width(R2Bits)
    ) compare (
        .a_i(wait_bound_q),
        .b_i(wait_candidates_q[CandidateBits*c+:R2Bits]),
        .less_o(beyond)
    );
    assign wait_near[c] = !beyond;
  end
  assign wait_bound_context = pair_taken ? pair_context : wait_context_q;

  always_ff @(posedge clk_i) begin
    wait_bound_q <= Far && pair_taken ? next_bound : wait_bound;
    if (pair_taken) begin
      wait_valid_q <= pair_valid;
      {wait_context_q, wait_row_q, wait_last_q} <= {pair_context, pair_row, pair_last};
      wait_first_q <= pair_first || (gone ? wait_first_q : first_gone_q);
      {wait_mask_q, wait_candidates_q} <= {pair_front, pair_candidates};
    end else begin
      wait_mask_q <= wait_mask_q & wait_near;
    end
    if (pair_taken && pair_valid) first_gone_q <= 1'b0;
    else if (gone) first_gone_q <= wait_first_q;
    if (rst_i) begin
      wait_valid_q <= 1'b0;
      first_gone_q <= 1'b0;
    end
  end

  // ---- the pair in hand: a token a cycle ----
  assign line_context_o = wait_context_q;
  assign hand_two = Wide ? hand_two_q : hand_mask_q == 2'b11;
  assign hand_free = (!hand_q || !hand_two) && !(Coded && !list_ready);
  assign hand_end = hand_q && !hand_two && hand_last_q;
  assign ask = start_i || snapshot_i;
  assign start_taken_o = start_i && hand_free;
  assign snapshot_taken_o = snapshot_i && !start_i && hand_free;

  always_ff @(posedge clk_i) begin
    if (hand_free) begin
      hand_q <= ask || wait_take;
      hand_other_q <= ask;
      token_start_q <= start_i;
      token_snapshot_q <= snapshot_i && !start_i;
      token_context_q <= start_i ? start_context_i : snapshot_i ? snapshot_context_i : wait_context_q;
      hand_line_q <= line_i;
      load_row_o <= wait_row_q;
      hand_last_q <= wait_last_q && !ask;
      hand_mask_q <= ask ? '0 : wait_mask_q & wait_near;
      hand_candidates_q <= wait_candidates_q;
    end else begin
      hand_mask_q <= (Coded && !list_ready) ? hand_mask_q : 2'b10;
      if (wait_merge) hand_last_q <= 1'b1;
    end
    ended_q <= (Coded && !list_ready) ? ended_q : hand_end || (wait_merge && !hand_two) || wait_end;
    ended_context_q <= (Coded && !list_ready) ? ended_context_q : wait_end ? wait_context_q : token_context_q;
    if (rst_i) begin
      hand_q <= 1'b0;
      ended_q <= 1'b0;
    end
  end

  if (Wide) begin : gen_hand_two
    always_ff @(posedge clk_i) begin
      if (hand_free) hand_two_q <= !ask && (wait_mask_q & wait_near) == 2'b11;
      else if (!(Coded && !list_ready)) hand_two_q <= 1'b0;
    end
  end

  assign token_candidate = hand_mask_q != '0;
  assign token_index[IndexBits-1:SlotBits] = hand_line_q;
  assign {token_index[SlotBits-1:0], token_d2} =
      hand_mask_q[0] ? hand_candidates_q[0+:CandidateBits] : hand_candidates_q[CandidateBits+:CandidateBits];

  // ---- its load: row | register, zero but for its lane | or ----
  logic [LaneBits-1:0] lane_1_q;
  logic [Lanes*LoadBits-1:0] loads_q;
  logic [LoadBits-1:0] choice, token_load_q;

  always_comb begin
    choice = '0;
    for (int unsigned i = 0; i < Lanes; i++) choice = choice | loads_q[LoadBits*i+:LoadBits];
  end

  always_ff @(posedge clk_i) begin
    lane_1_q <= (Coded && list_waits_q) ? lane_1_q : LaneBits'(token_index[SlotBits-1:0]) & LaneBits'(Lanes - 1);
    for (int unsigned i = 0; i < Lanes; i++)
      loads_q[LoadBits*i+:LoadBits] <= (Coded && list_waits_q) ? loads_q[LoadBits*i+:LoadBits] : lane_1_q == LaneBits'(i) ?
          loads_i[LoadBits*i+:LoadBits] : '0;
    token_load_q <= (Coded && list_waits_q) ? token_load_q : choice;
  end

  if (Coded) begin : gen_coded
    logic [LoadBits-1:0] coded_load_q;
    logic ended_b_q, ended_c_q, pending;
    logic [RowBits-1:0] oldest_row;
    logic [ContextBits-1:0] ended_b_context_q, ended_c_context_q;

    // While the hand stays, beats of which nothing is kept may pass it, any number: none is taken that is so far ahead of the
    // oldest row still to be read that a beat behind it could be written there. What was left a cycle ago may be two rows less now.
    assign pending = (hand_q && !hand_other_q) || wait_valid_q || pair_valid;
    assign oldest_row = hand_q && !hand_other_q ? load_row_o : wait_valid_q ? wait_row_q : pair_row;
    always_ff @(posedge clk_i) begin
      rows_left_q <= in_valid_i && (Far ? far_rows_left : !pending || RowBits'(in_row_i - oldest_row) < RowBits'(Behind - 3));
      if (rst_i) rows_left_q <= 1'b0;
    end
    if (Far) begin : gen_rows
      // Where none waits, a pair goes to where it would in this cycle.
      logic waits;
      logic [RowBits-1:0] row;
      assign waits = (hand_q && !hand_other_q) || wait_valid_q;
      assign row = hand_q && !hand_other_q ? load_row_o : wait_row_q;
      assign far_rows_left = waits ? RowBits'(in_row_i - row) < RowBits'(Behind - 3) : !pair_valid;
    end

    // A row that the hand asks for while the list is not ready is there in the next cycle: loads stay a cycle later.
    always_ff @(posedge clk_i) begin
      list_waits_q <= !list_ready;
      if (!list_waits_q) coded_load_q <= token_load_q;
      if (list_ready) begin
        {ended_b_q, ended_b_context_q} <= {ended_q, ended_context_q};
        {ended_c_q, ended_c_context_q} <= {ended_b_q, ended_b_context_q};
      end
      if (rst_i) begin
        list_waits_q <= 1'b0;
        ended_b_q <= 1'b0;
        ended_c_q <= 1'b0;
      end
    end
    assign leaf_done_o = ended_c_q && list_ready;
    assign leaf_done_context_o = ended_c_context_q;

    // The exponent of a code depends on d2 alone.
    localparam int unsigned Known = Far ? 1 : 0;
    logic [R2Bits+Known*ExponentBits-1:0] coded_d2;
    if (Far) begin : gen_known
      localparam int unsigned CodeBits = photonloom_pkg::ListCodeBits;
      logic [ExponentBits-1:0] exponent_q[0:1];

      if (CodeBits - ExponentBits < KeyLow) begin : gen_bad_code
        a_mantissa_needs_the_bits_of_the_index bad_code ();
      end
      for (genvar c = 0; c < 2; c++) begin : gen_exponent
        /* verilator lint_off UNUSEDSIGNAL */  // its mantissa
        logic [CodeBits-1:0] code;
        /* verilator lint_on UNUSEDSIGNAL */
        photon_gatherer_key_code #(
            .KeyBits(R2Bits + KeyLow),
            .CodeBits(CodeBits),
            .ExponentBits(ExponentBits)
        ) find (
            .key_i({wait_candidates_q[CandidateBits*c+:R2Bits], KeyLow'(0)}),
            .code_o(code)
        );
        always_ff @(posedge clk_i) if (hand_free) exponent_q[c] <= code[CodeBits-1-:ExponentBits];
      end
      assign coded_d2 = {hand_mask_q[0] ? exponent_q[0] : exponent_q[1], token_d2};
    end else begin : gen_found
      assign coded_d2 = token_d2;
    end

    photon_gatherer_coded_list #(
        .K(K),
        .R2Bits(R2Bits),
        .IndexBits(IndexBits),
        .Contexts(Contexts),
        .LoadBits(LoadBits),
        .CodeBits(photonloom_pkg::ListCodeBits),
        .ExponentBits(ExponentBits),
        .Known(Known),
        .CountAhead(ManyContexts || SlowCodes),
        .WriteLater(ManyContexts || (SlowCodes && K > 24))
    ) list (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .ready_o(list_ready),
        .in_valid_i(hand_q),
        .in_context_i(token_context_q),
        .in_candidate_i(token_candidate),
        .in_start_i(token_start_q),
        .in_snapshot_i(token_snapshot_q),
        .in_index_i(token_index),
        .in_d2_i(coded_d2),
        .load_i(coded_load_q),
        .started_o(start_done_o),
        .r2_max_i(start_r2_max_i),
        .bound_write_o(bound_write_o),
        .bound_context_o(bound_context_o),
        .bound_o(bound_o),
        .read_context_i(found_context_i),
        .count_o(found_count_o),
        .insertions_o(found_insertions_o),
        .store_read_i(store_read_i),
        .store_context_i(store_context_i),
        .store_place_i(store_place_i),
        .store_word_o(store_word_o),
        .snapshot_o(snapshot_done_o),
        .snapshot_count_o(snapshot_count_o),
        .snapshot_places_o(snapshot_places_o),
        .insert_o(insertions_o)
    );
  end else begin : gen_whole
    assign leaf_done_o = ended_q;
    assign leaf_done_context_o = ended_context_q;

    photon_gatherer_list #(
        .K(K),
        .R2Bits(R2Bits),
        .IndexBits(IndexBits),
        .Contexts(Contexts),
        .LoadBits(LoadBits)
    ) list (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .in_valid_i(hand_q),
        .in_context_i(token_context_q),
        .in_candidate_i(token_candidate),
        .in_start_i(token_start_q),
        .in_snapshot_i(token_snapshot_q),
        .in_index_i(token_index),
        .in_d2_i(token_d2),
        .load_i(token_load_q),
        .started_o(start_done_o),
        .r2_max_i(start_r2_max_i),
        .bound_write_o(bound_write_o),
        .bound_context_o(bound_context_o),
        .bound_o(bound_o),
        .read_context_i(found_context_i),
        .count_o(found_count_o),
        .insertions_o(found_insertions_o),
        .store_read_i(store_read_i),
        .store_context_i(store_context_i),
        .store_place_i(store_place_i),
        .store_word_o(store_word_o),
        .snapshot_o(snapshot_done_o),
        .snapshot_count_o(snapshot_count_o),
        .snapshot_places_o(snapshot_places_o),
        .insert_o(insertions_o)
    );
  end
  lut_ram #(
      .Width(R2Bits),
      .Depth(Contexts)
  ) bounds_to_wait (
      .clk_i(clk_i),
      .write_i(bound_write_o),
      .write_address_i(bound_context_o),
      .write_data_i(bound_o),
      .read_address_i(Far ? wait_context_q : wait_bound_context),
      .read_data_o(wait_bound)
  );
  if (Far) begin : gen_next_bound
    lut_ram #(
        .Width(R2Bits),
        .Depth(Contexts)
    ) bounds_to_next (
        .clk_i(clk_i),
        .write_i(bound_write_o),
        .write_address_i(bound_context_o),
        .write_data_i(bound_o),
        .read_address_i(pair_context),
        .read_data_o(next_bound)
    );
  end
  assign candidates_o = hand_q && token_candidate && !(Coded && !list_ready);
endmodule
