// SPDX-License-Identifier: Apache-2.0
// Beats to candidates, one a cycle. Two of a beat a cycle, lowest slots first, are tested for the side that they light:
// o(direction) . o(normal) > 0, exact; pairs that keep one, and the last of each leaf, wait in a FIFO. The oldest pair
// is compared with the bound again until it is in hand, so candidates that lie behind the surface or that the bound
// has left behind seldom take a cycle of the list.
//
// What comes out, without stall, in the order of slots: tokens {a candidate, the last of its leaf, a snapshot}. A
// snapshot carries only a context and goes before the next pair. leaf_done_o follows the last token of a leaf by a
// cycle. A beat that says that its leaf has no candidate at all leaves by empty_*; where all candidates went before it
// was known that they were the last, the end takes a token of its own. Latency 6 from a beat to its first token.
module photon_gatherer_candidates #(
    parameter int unsigned R2Bits = 34,
    parameter int unsigned LineBits = 13,
    parameter int unsigned Contexts = 16,
    parameter int unsigned Bucket = 8,
    parameter int unsigned Lanes = 4,
    parameter int unsigned LoadBits = 48,
    parameter int unsigned DirectionBits = 8,
    parameter int unsigned NormalBits = 8,
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned Beats = Bucket / Lanes,
    localparam int unsigned BeatBits = Beats > 1 ? $clog2(Beats) : 1,
    localparam int unsigned IndexBits = LineBits + $clog2(Bucket)
) (
    input  logic                        clk_i,
    input  logic                        rst_i,
    // beats
    input  logic                        in_valid_i,
    output logic                        in_ready_o,
    input  logic [     ContextBits-1:0] in_context_i,
    input  logic [        BeatBits-1:0] in_beat_i,
    input  logic                        in_last_i,
    input  logic                        in_first_i,
    input  logic [           Lanes-1:0] in_mask_i,
    input  logic [    Lanes*R2Bits-1:0] in_d2_i,
    output logic                        load_read_o,
    input  logic [  Lanes*LoadBits-1:0] load_i,
    // leaves without candidates
    output logic                        empty_valid_o,
    input  logic                        empty_ready_i,
    output logic [     ContextBits-1:0] empty_context_o,
    // context state
    output logic [     ContextBits-1:0] state_context_o,
    input  logic [3*(NormalBits+2)-1:0] normal_i,         // decoded
    input  logic [        LineBits-1:0] line_i,
    output logic [     ContextBits-1:0] wait_context_o,   // bounds
    input  logic [          R2Bits-1:0] wait_bound_i,
    output logic [     ContextBits-1:0] hand_context_o,
    input  logic [          R2Bits-1:0] hand_bound_i,
    // snapshots
    input  logic                        snapshot_i,
    output logic                        snapshot_taken_o,
    input  logic [     ContextBits-1:0] snapshot_context_i,
    // tokens
    output logic                        out_valid_o,
    output logic [     ContextBits-1:0] out_context_o,
    output logic                        out_candidate_o,
    output logic                        out_snapshot_o,
    output logic [       IndexBits-1:0] out_index_o,
    output logic [          R2Bits-1:0] out_d2_o,
    output logic [        LoadBits-1:0] out_load_o,
    // ends of leaves
    output logic                        leaf_done_o,
    output logic [     ContextBits-1:0] leaf_done_context_o
);
  localparam int unsigned SlotBits = $clog2(Bucket);
  localparam int unsigned LaneBits = Lanes > 1 ? $clog2(Lanes) : 1;
  localparam int unsigned D = DirectionBits + 2;
  localparam int unsigned N = NormalBits + 2;
  localparam int unsigned CandidateBits = SlotBits + R2Bits + LoadBits;
  localparam int unsigned PairBits = ContextBits + LineBits + 4 + 2 * CandidateBits;
  localparam int unsigned Depth = 8;
  localparam int unsigned RoomBits = $clog2(Depth + 1);

  // ---- the beat to be tested ----
  logic held_q, last_q, test, finished, nothing, merge, take, room_back, discard;
  logic [RoomBits-1:0] room_q;
  logic [ContextBits-1:0] context_q;
  logic [BeatBits-1:0] beat_q;
  logic [Lanes-1:0] mask_q, after_first, after_second;
  logic [Lanes*R2Bits-1:0] d2_q;

  assign after_first = mask_q & (mask_q - 1'b1);
  assign after_second = after_first & (after_first - 1'b1);
  assign test = held_q && room_q != '0;
  assign finished = test && after_second == '0;

  // A beat without candidates is the end of a leaf: of the beat here if an earlier one of the leaf was kept and has
  // not gone yet, of an empty leaf if none was kept.
  assign nothing = in_mask_i == '0;
  assign merge = in_valid_i && nothing && !in_first_i && held_q;
  assign empty_valid_o = in_valid_i && nothing && in_first_i;
  assign empty_context_o = in_context_i;
  assign take = !held_q || finished;
  assign load_read_o = take && in_valid_i && !merge && !empty_valid_o;
  assign in_ready_o = nothing && in_first_i ? empty_ready_i : merge || take;

  always_ff @(posedge clk_i) begin
    if (take) begin
      held_q <= load_read_o;
      context_q <= in_context_i;
      beat_q <= in_beat_i;
      last_q <= in_last_i;
      mask_q <= in_mask_i;
      d2_q <= in_d2_i;
    end else begin
      if (test) mask_q <= after_second;
      if (merge) last_q <= 1'b1;
    end
    room_q <= room_q - RoomBits'(test) + RoomBits'(room_back) + RoomBits'(discard);
    if (rst_i) begin
      held_q <= 1'b0;
      room_q <= RoomBits'(Depth);
    end
  end

  // ---- select | decode | multiply | sum and sign ----
  localparam int unsigned Stages = 3;
  logic [Stages-1:0] valid_q, leaf_last_q;
  logic [ContextBits-1:0] context_s_q[0:Stages-1];
  logic [LineBits-1:0] line_s_q[1:Stages-1];
  logic [3*N-1:0] normal_q;
  logic [1:0] front;
  logic [2*CandidateBits-1:0] tested;

  assign state_context_o = context_s_q[0];

  always_ff @(posedge clk_i) begin
    valid_q <= {valid_q[Stages-2:0], test};
    leaf_last_q <= {leaf_last_q[Stages-2:0], finished && (last_q || merge)};
    context_s_q[0] <= context_q;
    line_s_q[1] <= line_i;
    for (int unsigned i = 1; i < Stages; i++) context_s_q[i] <= context_s_q[i-1];
    for (int unsigned i = 2; i < Stages; i++) line_s_q[i] <= line_s_q[i-1];
    normal_q <= normal_i;
    if (rst_i) valid_q <= '0;
  end

  for (genvar c = 0; c < 2; c++) begin : gen_tester
    logic [Lanes-1:0] mask;
    logic [LaneBits-1:0] lane;
    logic [R2Bits-1:0] d2;
    logic [LoadBits-1:0] load;
    logic [Stages-1:0] some_q;
    logic [CandidateBits-1:0] candidate_q[0:Stages-1];
    logic [3*D-1:0] direction, direction_q;
    logic signed [D+N-1:0] product_q[0:2];
    logic signed [D+N+1:0] dot;

    assign mask = c == 0 ? mask_q : after_first;
    always_comb begin
      lane = '0;
      d2 = d2_q[0+:R2Bits];
      load = load_i[0+:LoadBits];
      for (int unsigned i = Lanes; i > 0; i--) begin
        if (mask[i-1]) begin
          lane = LaneBits'(i - 1);
          d2 = d2_q[R2Bits*(i-1)+:R2Bits];
          load = load_i[LoadBits*(i-1)+:LoadBits];
        end
      end
    end

    oct_decode #(
        .Bits(DirectionBits)
    ) decode (
        .code_i(candidate_q[0][2*DirectionBits-1:0]),
        .direction_o(direction)
    );

    for (genvar axis = 0; axis < 3; axis++) begin : gen_product
      logic signed [D-1:0] a;
      logic signed [N-1:0] b;
      assign a = direction_q[D*axis+:D];
      assign b = normal_q[N*axis+:N];
      always_ff @(posedge clk_i) product_q[axis] <= a * b;
    end
    assign dot = (D + N + 2)'(product_q[0]) + (D + N + 2)'(product_q[1]) + (D + N + 2)'(product_q[2]);
    assign front[c] = some_q[Stages-1] && !dot[D+N+1] && dot != '0;
    assign tested[CandidateBits*c+:CandidateBits] = candidate_q[Stages-1];

    always_ff @(posedge clk_i) begin
      some_q <= {some_q[Stages-2:0], mask != '0};
      candidate_q[0] <= {SlotBits'(beat_q * Lanes) + SlotBits'(lane), d2, load};
      for (int unsigned i = 1; i < Stages; i++) candidate_q[i] <= candidate_q[i-1];
      direction_q <= direction;
    end
  end

  // ---- pairs; one goes past an empty FIFO ----
  logic keep, kept_q, queue_valid, queue_ready, next_valid;
  logic [PairBits-1:0] kept_word, queue_word, next_word;
  /* verilator lint_off UNUSEDSIGNAL */  // room was reserved
  logic fifo_ready;
  /* verilator lint_on UNUSEDSIGNAL */

  assign keep = valid_q[Stages-1] && (leaf_last_q[Stages-1] || front != '0);
  assign discard = valid_q[Stages-1] && !keep;
  assign kept_word = {context_s_q[Stages-1], line_s_q[Stages-1], leaf_last_q[Stages-1], !kept_q, front, tested};
  assign next_valid = queue_valid || keep;
  assign next_word = queue_valid ? queue_word : kept_word;
  assign room_back = queue_ready && next_valid;

  always_ff @(posedge clk_i) begin
    if (valid_q[Stages-1]) kept_q <= (keep || kept_q) && !leaf_last_q[Stages-1];
    if (rst_i) kept_q <= 1'b0;
  end

  fifo #(
      .Width(PairBits),
      .Depth(Depth)
  ) pairs (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(keep && (queue_valid || !queue_ready)),
      .in_ready_o(fifo_ready),
      .in_i(kept_word),
      .out_valid_o(queue_valid),
      .out_ready_i(queue_ready),
      .out_o(queue_word)
  );

  // ---- the oldest pair loses what the bound leaves behind while it waits ----
  // When nothing is left of it, it goes without being taken, unless it ends its leaf; an end is merged with the pair in
  // hand if that is of the same leaf.
  logic wait_valid_q, wait_last_q, wait_first_q, gone, first_gone_q, wait_merge, wait_take;
  logic [LineBits-1:0] wait_line_q;
  logic [1:0] wait_mask_q, wait_near;
  logic [2*CandidateBits-1:0] wait_candidates_q;
  logic hand_q, hand_last_q, hand_snapshot_q, hand_done, hand_free, first;
  logic [LineBits-1:0] hand_line_q;
  logic [1:0] hand_mask_q, hand_rest;
  logic [2*CandidateBits-1:0] hand_candidates_q;

  assign gone = wait_valid_q && wait_mask_q == '0 && !wait_last_q;
  assign wait_merge = wait_valid_q && wait_mask_q == '0 && wait_last_q && !wait_first_q && hand_q && !hand_snapshot_q;
  assign wait_take = wait_valid_q && !gone && !wait_merge && hand_free && !snapshot_i;
  assign queue_ready = !wait_valid_q || gone || wait_merge || wait_take;
  for (genvar c = 0; c < 2; c++) begin : gen_near
    assign wait_near[c] = wait_candidates_q[CandidateBits*c+LoadBits+:R2Bits] <= wait_bound_i;
  end
  assign first = next_word[2*CandidateBits+2];

  always_ff @(posedge clk_i) begin
    if (queue_ready) begin
      wait_valid_q <= next_valid;
      {wait_context_o, wait_line_q, wait_last_q} <= next_word[PairBits-1:2*CandidateBits+3];
      wait_first_q <= first || (gone ? wait_first_q : first_gone_q);
      {wait_mask_q, wait_candidates_q} <= next_word[2*CandidateBits+1:0];
    end else begin
      wait_mask_q <= wait_mask_q & wait_near;
    end
    if (queue_ready && next_valid) first_gone_q <= 1'b0;
    else if (gone) first_gone_q <= wait_first_q;
    if (rst_i) begin
      wait_valid_q <= 1'b0;
      first_gone_q <= 1'b0;
    end
  end

  // ---- the pair in hand ----
  assign hand_rest = {hand_mask_q == 2'b11 && hand_candidates_q[CandidateBits+LoadBits+:R2Bits] <= hand_bound_i, 1'b0};
  assign hand_done = hand_q && hand_rest == '0;
  assign hand_free = !hand_q || hand_done;
  assign snapshot_taken_o = snapshot_i && hand_free;

  always_ff @(posedge clk_i) begin
    if (hand_free) begin
      hand_q <= snapshot_i || wait_take;
      hand_snapshot_q <= snapshot_i;
      hand_context_o <= snapshot_i ? snapshot_context_i : wait_context_o;
      hand_line_q <= wait_line_q;
      hand_last_q <= wait_last_q && !snapshot_i;
      hand_mask_q <= snapshot_i ? '0 : wait_mask_q & wait_near;
      hand_candidates_q <= wait_candidates_q;
    end else begin
      hand_mask_q <= hand_rest;
      if (wait_merge) hand_last_q <= 1'b1;
    end
    leaf_done_o <= hand_done && (hand_last_q || wait_merge);
    leaf_done_context_o <= hand_context_o;
    if (rst_i) begin
      hand_q <= 1'b0;
      leaf_done_o <= 1'b0;
    end
  end

  assign out_valid_o = hand_q;
  assign out_context_o = hand_context_o;
  assign out_candidate_o = hand_mask_q != '0;
  assign out_snapshot_o = hand_snapshot_q;
  assign out_index_o[IndexBits-1:SlotBits] = hand_line_q;
  assign {out_index_o[SlotBits-1:0], out_d2_o, out_load_o} =
      hand_mask_q[0] ? hand_candidates_q[0+:CandidateBits] : hand_candidates_q[CandidateBits+:CandidateBits];
endmodule
