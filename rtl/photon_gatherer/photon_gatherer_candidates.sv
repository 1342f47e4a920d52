// SPDX-License-Identifier: Apache-2.0
// Beats to candidates, one a cycle. Two neighbouring lanes of a beat a cycle, those with candidates, lowest slots first,
// are tested for the side that they light: o(direction) . o(normal) > 0, exact; pairs that keep one, and the last of each leaf, wait in a FIFO. The oldest pair
// is compared with the bound again until it is in hand, so candidates that lie behind the surface or that the bound
// has left behind seldom take a cycle of the list.
//
// What comes out, without stall, in the order of slots: tokens {a candidate, the last of its leaf, a start, a
// snapshot}. Starts and snapshots carry only a context and go before the next pair, within two cycles. leaf_done_o follows the last token of a leaf by a
// cycle. Where all candidates went before it was known that they were the last, the end takes a token of its own.
// Latency 10 from a beat to its first token.
module photon_gatherer_candidates #(
    parameter int unsigned R2Bits = 34,
    parameter int unsigned LineBits = 13,
    parameter int unsigned Contexts = 16,
    parameter int unsigned Bucket = 8,
    parameter int unsigned Lanes = 4,
    parameter int unsigned RowBits = 6,
    parameter int unsigned LoadBits = 48,
    parameter int unsigned DirectionBits = 8,
    parameter int unsigned NormalBits = 8,
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned Beats = Bucket / Lanes,
    localparam int unsigned BeatBits = Beats > 1 ? $clog2(Beats) : 1,
    localparam int unsigned IndexBits = LineBits + $clog2(Bucket)
) (
    input  logic                             clk_i,
    input  logic                             rst_i,
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
    // context state
    output logic [          ContextBits-1:0] normal_context_o,
    input  logic [     3*(NormalBits+2)-1:0] normal_i,            // decoded, z negated
    output logic [          ContextBits-1:0] wait_context_o,
    input  logic [             LineBits-1:0] wait_line_i,
    output logic [          ContextBits-1:0] bound_context_o,     // of the pair that waits in the next cycle
    input  logic [               R2Bits-1:0] bound_i,
    // starts of queries, and snapshots behind them
    input  logic                             start_i,
    output logic                             start_taken_o,
    input  logic [          ContextBits-1:0] start_context_i,
    input  logic                             snapshot_i,
    output logic                             snapshot_taken_o,
    input  logic [          ContextBits-1:0] snapshot_context_i,
    // tokens
    output logic                             out_valid_o,
    output logic [          ContextBits-1:0] out_context_o,
    output logic                             out_candidate_o,
    output logic                             out_start_o,
    output logic                             out_snapshot_o,
    output logic [            IndexBits-1:0] out_index_o,
    output logic [               R2Bits-1:0] out_d2_o,
    output logic [              RowBits-1:0] load_row_o,
    input  logic [       Lanes*LoadBits-1:0] loads_i,
    output logic [             LoadBits-1:0] out_load_o,          // three cycles after its token
    // ends of leaves
    output logic                             leaf_done_o,
    output logic [          ContextBits-1:0] leaf_done_context_o
);
  localparam int unsigned SlotBits = $clog2(Bucket);
  localparam int unsigned LaneBits = Lanes > 1 ? $clog2(Lanes) : 1;
  localparam int unsigned Groups = Lanes > 1 ? Lanes / 2 : 1;  // of two lanes
  localparam int unsigned D = DirectionBits + 2;
  localparam int unsigned N = NormalBits + 2;
  localparam int unsigned CandidateBits = SlotBits + R2Bits;
  localparam int unsigned PairBits = ContextBits + RowBits + 4 + 2 * CandidateBits;
  localparam int unsigned Depth = 16;
  localparam int unsigned RoomBits = $clog2(Depth + 1);

  // ---- the beat to be tested ----
  logic held_q, last_q, test, finished, merge, take, room_back, discard;
  logic [RoomBits-1:0] room_q;
  logic [ContextBits-1:0] context_q;
  logic [BeatBits-1:0] beat_q;
  logic [RowBits-1:0] row_q;
  logic [Lanes-1:0] mask_q, rest;
  logic [Groups-1:0] some, group;
  logic [Lanes*R2Bits-1:0] d2_q;

  // The first group in which a lane is left.
  always_comb begin
    rest = mask_q;
    for (int unsigned g = 0; g < Groups; g++) begin
      some[g] = mask_q[2*g] || (Lanes > 1 && mask_q[Lanes>1?2*g+1 : 0]);
      group[g] = some[g];
      for (int unsigned h = 0; h < g; h++) if (some[h]) group[g] = 1'b0;
      if (group[g]) begin
        rest[2*g] = 1'b0;
        if (Lanes > 1) rest[Lanes>1?2*g+1 : 0] = 1'b0;
      end
    end
  end
  assign test = held_q && room_q != '0;
  assign finished = test && rest == '0;

  // A beat without candidates is the end of the beat here, if that has not gone yet.
  assign merge = in_valid_i && in_mask_i == '0 && held_q;
  assign take = !held_q || finished;
  assign direction_read_o = take && in_valid_i && !merge;
  assign in_ready_o = merge || take;

  always_ff @(posedge clk_i) begin
    if (take) begin
      held_q <= direction_read_o;
      context_q <= in_context_i;
      beat_q <= in_beat_i;
      row_q <= in_row_i;
      last_q <= in_last_i;
      mask_q <= in_mask_i;
      d2_q <= in_d2_i;
    end else begin
      if (test) mask_q <= rest;
      if (merge) last_q <= 1'b1;
    end
    room_q <= room_q - RoomBits'(test) + RoomBits'(room_back) + RoomBits'(discard);
    if (rst_i) begin
      held_q <= 1'b0;
      room_q <= RoomBits'(Depth);
    end
  end

  // ---- register | select | decode | multiply | x + y, -z | compare | into the FIFO ----
  localparam int unsigned Stages = 6;
  logic [Stages-1:0] valid_q, leaf_last_q;
  logic [ContextBits-1:0] context_s_q[0:Stages-1];
  logic [RowBits-1:0] row_s_q[0:Stages-1];
  logic [Groups-1:0] group_q;
  logic [2*Lanes*DirectionBits-1:0] directions_q;  // nothing between block RAM and its register
  logic [3*N-1:0] normal_q;
  logic [1:0] front;
  logic [2*CandidateBits-1:0] tested;

  assign normal_context_o = context_s_q[1];

  always_ff @(posedge clk_i) begin
    valid_q <= {valid_q[Stages-2:0], test};
    leaf_last_q <= {leaf_last_q[Stages-2:0], finished && (last_q || merge)};
    context_s_q[0] <= context_q;
    row_s_q[0] <= row_q;
    for (int unsigned i = 1; i < Stages; i++) begin
      context_s_q[i] <= context_s_q[i-1];
      row_s_q[i] <= row_s_q[i-1];
    end
    group_q <= group;
    directions_q <= directions_i;
    normal_q <= normal_i;
    if (rst_i) valid_q <= '0;
  end

  for (genvar c = 0; c < 2; c++) begin : gen_tester
    logic some_lane;
    logic [LaneBits-1:0] lane;
    logic [R2Bits-1:0] d2;
    logic [2*DirectionBits-1:0] code, code_q;
    logic [Stages-2:0] some_q;
    logic front_q;
    logic [CandidateBits-1:0] candidate_q[0:Stages-1];
    logic [3*D-1:0] direction, direction_q;
    logic signed [D+N-1:0] product_q[0:2];
    logic signed [D+N:0] sum_q, third_q;  // x + y, -z
    /* verilator lint_off UNUSEDSIGNAL */  // only its sign
    logic signed [D+N+1:0] difference;
    /* verilator lint_on UNUSEDSIGNAL */

    // Lane 2 g + c of the group; the last group if the others are empty.
    always_comb begin
      some_lane = 1'b0;
      lane = LaneBits'(2 * (Groups - 1) + c);
      d2 = d2_q[R2Bits*((2*(Groups-1)+c)%Lanes)+:R2Bits];
      code = '0;
      for (int unsigned g = Groups; g > 0; g--) begin
        if (group_q[g-1]) code = directions_q[2*DirectionBits*((2*(g-1)+c)%Lanes)+:2*DirectionBits];
        if (some[g-1]) begin
          some_lane = 2 * (g - 1) + c < Lanes && mask_q[(2*(g-1)+c)%Lanes];
          lane = LaneBits'(2 * (g - 1) + c);
          d2 = d2_q[R2Bits*((2*(g-1)+c)%Lanes)+:R2Bits];
        end
      end
    end

    oct_decode #(
        .Bits(DirectionBits)
    ) decode (
        .code_i(code_q),
        .direction_o(direction)
    );

    for (genvar axis = 0; axis < 3; axis++) begin : gen_product
      logic signed [D-1:0] a;
      logic signed [N-1:0] b;
      assign a = direction_q[D*axis+:D];
      assign b = normal_q[N*axis+:N];
      always_ff @(posedge clk_i) product_q[axis] <= a * b;
    end
    assign difference = (D + N + 2)'(third_q) - (D + N + 2)'(sum_q);
    assign front[c] = front_q;
    assign tested[CandidateBits*c+:CandidateBits] = candidate_q[Stages-1];

    always_ff @(posedge clk_i) begin
      some_q <= {some_q[Stages-3:0], some_lane};
      front_q <= some_q[Stages-2] && difference[D+N+1];
      candidate_q[0] <= {SlotBits'(beat_q * Lanes) + SlotBits'(lane), d2};
      code_q <= code;
      for (int unsigned i = 1; i < Stages; i++) candidate_q[i] <= candidate_q[i-1];
      direction_q <= direction;
      sum_q <= (D + N + 1)'(product_q[0]) + (D + N + 1)'(product_q[1]);
      third_q <= (D + N + 1)'(product_q[2]);
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
  assign kept_word = {
    context_s_q[Stages-1], row_s_q[Stages-1], leaf_last_q[Stages-1], !kept_q, front, tested
  };
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
  // hand if that is of the same leaf. The bound is that of a cycle ago: it only shrinks, so what is beyond it stays so.
  logic wait_valid_q, wait_last_q, wait_first_q, gone, first_gone_q, wait_merge, wait_take;
  logic [RowBits-1:0] wait_row_q;
  logic [1:0] wait_mask_q, wait_near;
  logic [R2Bits-1:0] wait_bound_q;
  logic [2*CandidateBits-1:0] wait_candidates_q;
  logic hand_q, hand_last_q, hand_other_q, ask, hand_two, hand_free, first;
  logic [LineBits-1:0] hand_line_q;
  logic [1:0] hand_mask_q;
  logic [2*CandidateBits-1:0] hand_candidates_q;

  assign gone = wait_valid_q && wait_mask_q == '0 && !wait_last_q;
  assign wait_merge = wait_valid_q && wait_mask_q == '0 && wait_last_q && !wait_first_q && hand_q && !hand_other_q;
  assign wait_take = wait_valid_q && !gone && !wait_merge && hand_free && !ask;
  assign queue_ready = !wait_valid_q || gone || wait_merge || wait_take;
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
  assign first = next_word[2*CandidateBits+2];
  assign bound_context_o = queue_ready ? next_word[PairBits-1-:ContextBits] : wait_context_o;

  always_ff @(posedge clk_i) begin
    wait_bound_q <= bound_i;
    if (queue_ready) begin
      wait_valid_q <= next_valid;
      {wait_context_o, wait_row_q, wait_last_q} <= next_word[PairBits-1:2*CandidateBits+3];
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
  assign hand_two = hand_mask_q == 2'b11;
  assign hand_free = !hand_q || !hand_two;
  assign ask = start_i || snapshot_i;
  assign start_taken_o = start_i && hand_free;
  assign snapshot_taken_o = snapshot_i && !start_i && hand_free;

  always_ff @(posedge clk_i) begin
    if (hand_free) begin
      hand_q <= ask || wait_take;
      hand_other_q <= ask;
      out_start_o <= start_i;
      out_snapshot_o <= snapshot_i && !start_i;
      out_context_o <= start_i ? start_context_i : snapshot_i ? snapshot_context_i : wait_context_o;
      hand_line_q <= wait_line_i;
      load_row_o <= wait_row_q;
      hand_last_q <= wait_last_q && !ask;
      hand_mask_q <= ask ? '0 : wait_mask_q & wait_near;
      hand_candidates_q <= wait_candidates_q;
    end else begin
      hand_mask_q <= 2'b10;
      if (wait_merge) hand_last_q <= 1'b1;
    end
    leaf_done_o <= hand_q && !hand_two && (hand_last_q || wait_merge);
    leaf_done_context_o <= out_context_o;
    if (rst_i) begin
      hand_q <= 1'b0;
      leaf_done_o <= 1'b0;
    end
  end

  assign out_valid_o = hand_q;
  assign out_candidate_o = hand_mask_q != '0;
  assign out_index_o[IndexBits-1:SlotBits] = hand_line_q;
  assign {out_index_o[SlotBits-1:0], out_d2_o} =
      hand_mask_q[0] ? hand_candidates_q[0+:CandidateBits] : hand_candidates_q[CandidateBits+:CandidateBits];

  // ---- its load: row | register, zero but for its lane | or ----
  logic [LaneBits-1:0] lane_1_q;
  logic [Lanes*LoadBits-1:0] loads_q;
  logic [LoadBits-1:0] choice;

  always_comb begin
    choice = '0;
    for (int unsigned i = 0; i < Lanes; i++) choice = choice | loads_q[LoadBits*i+:LoadBits];
  end

  always_ff @(posedge clk_i) begin
    lane_1_q <= LaneBits'(out_index_o[SlotBits-1:0]) & LaneBits'(Lanes - 1);
    for (int unsigned i = 0; i < Lanes; i++)
      loads_q[LoadBits*i+:LoadBits] <= lane_1_q == LaneBits'(i) ? loads_i[LoadBits*i+:LoadBits] : '0;
    out_load_o <= choice;
  end
endmodule
