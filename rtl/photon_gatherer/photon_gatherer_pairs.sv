// SPDX-License-Identifier: Apache-2.0
// Beats to pairs of candidates. Two neighbouring lanes of a beat a cycle, those with candidates, lowest slots first,
// are tested for the side that they light: o(direction) . o(normal) > 0, exact. Pairs that keep one, and the last of
// each leaf, wait in a FIFO. Mirrors the test of the side in search_gather of golden/unit/photon_gatherer.cpp.
//
// One pair a cycle. Latency 7 from a beat to its first pair, which goes past an empty FIFO.
module photon_gatherer_pairs #(
    parameter int unsigned R2Bits = 34,
    parameter int unsigned Contexts = 16,
    parameter int unsigned Bucket = 8,
    parameter int unsigned Lanes = 4,
    parameter int unsigned RowBits = 6,
    parameter int unsigned DirectionBits = 8,
    parameter int unsigned NormalBits = 8,
    parameter int unsigned RoomLater = 0,  // room that comes back is counted a cycle later, of any number of lanes
    parameter bit ReadAlways = 1'b0,  // the directions of the next beat are read in each cycle, and kept here; whether a pair waits, or has room, is a register
    parameter bit DistanceRows = 1'b0,  // in_d2_i comes when directions_i do
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned Beats = Bucket / Lanes,
    localparam int unsigned BeatBits = Beats > 1 ? $clog2(Beats) : 1,
    localparam int unsigned SlotBits = $clog2(Bucket),
    localparam int unsigned CandidateBits = SlotBits + R2Bits
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
    input  logic [     3*(NormalBits+2)-1:0] normal_i,          // decoded, z negated
    // pairs
    output logic                             out_valid_o,
    input  logic                             out_ready_i,
    output logic [          ContextBits-1:0] out_context_o,
    output logic [              RowBits-1:0] out_row_o,
    output logic                             out_last_o,        // of its leaf
    output logic                             out_first_o,       // of its leaf
    output logic [                      1:0] out_front_o,       // which of the two are candidates
    output logic [      2*CandidateBits-1:0] out_candidates_o   // slot, d2
);
  localparam int unsigned LaneBits = Lanes > 1 ? $clog2(Lanes) : 1;
  localparam int unsigned Groups = Lanes > 1 ? Lanes / 2 : 1;  // of two lanes
  localparam int unsigned D = DirectionBits + 2;
  localparam int unsigned N = NormalBits + 2;
  localparam int unsigned PairBits = ContextBits + RowBits + 4 + 2 * CandidateBits;
  localparam int unsigned Depth = 8;
  localparam int unsigned RoomBits = $clog2(Depth + 1);

  // ---- the beat to be tested ----
  logic held_q, last_q, begins, test, finished, merge, take, room_back, discard, returned, discarded;
  logic [RoomBits-1:0] room_q;
  /* verilator lint_off UNDRIVEN */
  /* verilator lint_off UNUSEDSIGNAL */
  logic some_room_q;  // where ReadAlways
  /* verilator lint_on UNUSEDSIGNAL */
  /* verilator lint_on UNDRIVEN */
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
  assign test = held_q && (ReadAlways ? some_room_q : room_q != '0);

  // Of many groups it is known ahead whether one is left: block RAM, which lies far away, waits for the end of a beat.
  if (Groups > 2) begin : gen_ahead
    logic [Groups-1:0] next;
    logic one_left_q;

    always_comb begin
      next = some & ~group;
      if (take) for (int unsigned g = 0; g < Groups; g++) next[g] = in_mask_i[2*g] || in_mask_i[2*g+1];
    end
    always_ff @(posedge clk_i) if (take || test) one_left_q <= (next & (next - 1'b1)) == '0;
    assign finished = test && one_left_q;

    // Room that comes back is counted a cycle later.
    logic room_back_q, discard_q;
    always_ff @(posedge clk_i) {room_back_q, discard_q} <= rst_i ? '0 : {room_back, discard};
    assign returned = room_back_q;
    assign discarded = discard_q;
  end else if (RoomLater != 0) begin : gen_later
    logic room_back_q, discard_q;
    always_ff @(posedge clk_i) {room_back_q, discard_q} <= rst_i ? '0 : {room_back, discard};
    assign finished = test && rest == '0;
    assign returned = room_back_q;
    assign discarded = discard_q;
  end else begin : gen_now
    assign finished = test && rest == '0;
    assign returned = room_back;
    assign discarded = discard;
  end

  if (ReadAlways) begin : gen_some_room
    logic [RoomBits-1:0] room;
    assign room = room_q - RoomBits'(test) + RoomBits'(returned) + RoomBits'(discarded);
    always_ff @(posedge clk_i) some_room_q <= rst_i || room != '0;
  end

  // A beat without candidates is the end of the beat here, if that has not gone yet.
  assign merge = in_valid_i && in_mask_i == '0 && held_q;
  assign take = !held_q || finished;
  assign begins = take && in_valid_i && !merge;
  assign direction_read_o = ReadAlways || begins;
  assign in_ready_o = merge || take;

  always_ff @(posedge clk_i) begin
    if (take) begin
      held_q <= begins;
      context_q <= in_context_i;
      beat_q <= in_beat_i;
      row_q <= in_row_i;
      last_q <= in_last_i;
      mask_q <= in_mask_i;
      if (!DistanceRows) d2_q <= in_d2_i;
    end else begin
      if (test) mask_q <= rest;
      if (merge) last_q <= 1'b1;
    end
    room_q <= room_q - RoomBits'(test) + RoomBits'(returned) + RoomBits'(discarded);
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

  // Whether block RAM reads is late. Those of a beat come a cycle after it begins.
  /* verilator lint_off UNDRIVEN */
  /* verilator lint_off UNUSEDSIGNAL */
  logic directions_come;  // where ReadAlways
  /* verilator lint_on UNUSEDSIGNAL */
  /* verilator lint_on UNDRIVEN */
  if (ReadAlways) begin : gen_come
    logic begins_q;
    always_ff @(posedge clk_i) begins_q <= begins;
    assign directions_come = begins_q;
  end

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
    directions_q <= ReadAlways && !directions_come ? directions_q : directions_i;
    normal_q <= normal_i;
    if (rst_i) valid_q <= '0;
  end

  // Distances from rows, chosen with the directions.
  /* verilator lint_off UNDRIVEN */
  /* verilator lint_off UNUSEDSIGNAL */
  logic [Lanes*R2Bits-1:0] distances;  // where DistanceRows
  /* verilator lint_on UNUSEDSIGNAL */
  /* verilator lint_on UNDRIVEN */
  if (DistanceRows) begin : gen_distances
    logic [Lanes*R2Bits-1:0] distances_q;
    always_ff @(posedge clk_i) distances_q <= ReadAlways && !directions_come ? distances_q : in_d2_i;
    assign distances = distances_q;
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

    /* verilator lint_off UNDRIVEN */
    /* verilator lint_off UNUSEDSIGNAL */
    logic [R2Bits-1:0] row_distance;  // where DistanceRows
    /* verilator lint_on UNUSEDSIGNAL */
    /* verilator lint_on UNDRIVEN */
    if (DistanceRows) begin : gen_row_distance
      logic [R2Bits-1:0] chosen;
      always_comb begin
        chosen = distances[R2Bits*((2*(Groups-1)+c)%Lanes)+:R2Bits];
        for (int unsigned g = Groups - 1; g > 0; g--) if (group_q[g-1]) chosen = distances[R2Bits*((2*(g-1)+c)%Lanes)+:R2Bits];
      end
      assign row_distance = chosen;
    end

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
      if (DistanceRows) candidate_q[1][R2Bits-1:0] <= row_distance;
      direction_q <= direction;
      sum_q <= (D + N + 1)'(product_q[0]) + (D + N + 1)'(product_q[1]);
      third_q <= (D + N + 1)'(product_q[2]);
    end
  end

  // ---- pairs; one goes past an empty FIFO ----
  logic keep, kept_q, queue_valid;
  logic [PairBits-1:0] kept_word, queue_word;
  /* verilator lint_off UNUSEDSIGNAL */  // room was reserved
  logic fifo_ready;
  /* verilator lint_on UNUSEDSIGNAL */

  assign keep = valid_q[Stages-1] && (leaf_last_q[Stages-1] || front != '0);
  assign discard = valid_q[Stages-1] && !keep;
  assign kept_word = {
    context_s_q[Stages-1], row_s_q[Stages-1], leaf_last_q[Stages-1], !kept_q, front, tested
  };
  assign out_valid_o = queue_valid || keep;
  assign {out_context_o, out_row_o, out_last_o, out_first_o, out_front_o, out_candidates_o} =
      queue_valid ? queue_word : kept_word;
  assign room_back = out_ready_i && out_valid_o;

  always_ff @(posedge clk_i) begin
    if (valid_q[Stages-1]) kept_q <= (keep || kept_q) && !leaf_last_q[Stages-1];
    if (rst_i) kept_q <= 1'b0;
  end

  fifo #(
      .Width(PairBits),
      .Depth(Depth),
      .Ahead(RoomLater),
      .ValidAhead(ReadAlways)
  ) pairs (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(keep && (queue_valid || !out_ready_i)),
      .in_ready_o(fifo_ready),
      .in_i(kept_word),
      .out_valid_o(queue_valid),
      .out_ready_i(out_ready_i),
      .out_o(queue_word)
  );
endmodule
