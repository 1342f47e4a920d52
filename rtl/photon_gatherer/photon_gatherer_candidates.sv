// SPDX-License-Identifier: Apache-2.0
// One candidate a cycle from beats, lowest slot first; those that the bound has left behind meanwhile are passed over;
// the back side is tested: o(direction) . o(normal) > 0, exact. What comes out, without stall, in the order of slots:
// tokens {a candidate and whether it is in front, the last of its leaf, a snapshot, a clear}. Snapshot and clear carry
// only a context; a snapshot goes before the next candidate, a clear when there is none. The last candidate of a leaf
// carries its end; a leaf without any candidate leaves by empty_*, without a token; only where the candidates had gone
// before it was known that they are the last does the end take a token of its own.
// Latency 3 from a beat's register to the token.
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
    output logic [     ContextBits-1:0] bound_context_o,
    input  logic [          R2Bits-1:0] bound_i,
    output logic [     ContextBits-1:0] state_context_o,
    input  logic [3*(NormalBits+2)-1:0] normal_i,         // decoded
    input  logic [        LineBits-1:0] line_i,
    // snapshots
    input  logic                        snapshot_i,
    output logic                        snapshot_taken_o,
    input  logic [     ContextBits-1:0] snapshot_context_i,
    // clears
    input  logic                        clear_i,
    output logic                        clear_taken_o,
    input  logic [     ContextBits-1:0] clear_context_i,
    // tokens
    output logic                        out_valid_o,
    output logic [     ContextBits-1:0] out_context_o,
    output logic                        out_candidate_o,  // and in front
    output logic                        out_last_o,
    output logic                        out_snapshot_o,
    output logic                        out_clear_o,
    output logic [       IndexBits-1:0] out_index_o,
    output logic [          R2Bits-1:0] out_d2_o,
    output logic [        LoadBits-1:0] out_load_o
);
  localparam int unsigned SlotBits = $clog2(Bucket);
  localparam int unsigned LaneBits = Lanes > 1 ? $clog2(Lanes) : 1;
  localparam int unsigned D = DirectionBits + 2;
  localparam int unsigned N = NormalBits + 2;

  // ---- the beat in hand ----
  logic held_q, last_q, finished, emit, nothing, merge, take;
  logic [ContextBits-1:0] context_q;
  logic [BeatBits-1:0] beat_q;
  logic [Lanes-1:0] mask_q, near, rest;
  logic [Lanes*R2Bits-1:0] d2_q;
  logic [LaneBits-1:0] lane;
  logic [R2Bits-1:0] d2;
  logic [LoadBits-1:0] load;

  assign bound_context_o = context_q;
  for (genvar i = 0; i < Lanes; i++) begin : gen_near
    assign near[i] = d2_q[R2Bits*i+:R2Bits] <= bound_i;
  end

  always_comb begin
    lane = '0;
    d2 = d2_q[0+:R2Bits];
    load = load_i[0+:LoadBits];
    for (int unsigned i = Lanes; i > 0; i--) begin
      if (mask_q[i-1]) begin
        lane = LaneBits'(i - 1);
        d2 = d2_q[R2Bits*(i-1)+:R2Bits];
        load = load_i[LoadBits*(i-1)+:LoadBits];
      end
    end
    rest = mask_q & (mask_q - 1'b1) & near;
  end

  assign snapshot_taken_o = snapshot_i;
  assign emit = held_q && !snapshot_i;
  assign finished = emit && rest == '0;
  assign clear_taken_o = clear_i && !held_q && !snapshot_i;

  // A beat without candidates is the end of a leaf: of the beat in hand if an earlier one of the leaf was kept and has
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
      if (emit) mask_q <= rest;
      if (merge) last_q <= 1'b1;
    end
    if (rst_i) held_q <= 1'b0;
  end

  // ---- decode | multiply | sum and sign, beside the list's comparison ----
  localparam int unsigned Stages = 3;
  logic [Stages-1:0] valid_q, candidate_q, leaf_last_q, snapshot_q, clear_q;
  logic [ContextBits-1:0] context_s_q[0:Stages-1];
  logic [R2Bits-1:0] d2_s_q[0:Stages-1];
  logic [LoadBits-1:0] load_s_q[0:Stages-1];
  logic [SlotBits-1:0] slot_q;
  logic [IndexBits-1:0] index_s_q[1:Stages-1];
  logic [3*D-1:0] direction, direction_q;
  logic [3*N-1:0] normal_q;
  logic signed [D+N-1:0] product_q[0:2];
  logic signed [D+N+1:0] dot;
  logic front;

  oct_decode #(
      .Bits(DirectionBits)
  ) decode (
      .code_i(load_s_q[0][2*DirectionBits-1:0]),
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

  assign front = !dot[D+N+1] && dot != '0;
  assign state_context_o = context_s_q[0];

  always_ff @(posedge clk_i) begin
    valid_q <= {valid_q[Stages-2:0], emit || snapshot_i || clear_taken_o};
    candidate_q <= {candidate_q[Stages-2:0], emit && mask_q != '0};
    leaf_last_q <= {leaf_last_q[Stages-2:0], finished && (last_q || merge)};
    snapshot_q <= {snapshot_q[Stages-2:0], snapshot_i};
    clear_q <= {clear_q[Stages-2:0], clear_taken_o};
    context_s_q[0] <= snapshot_i ? snapshot_context_i : held_q ? context_q : clear_context_i;
    d2_s_q[0] <= d2;
    load_s_q[0] <= load;
    slot_q <= SlotBits'(beat_q * Lanes) + SlotBits'(lane);
    index_s_q[1] <= {line_i, slot_q};
    for (int unsigned i = 1; i < Stages; i++) begin
      context_s_q[i] <= context_s_q[i-1];
      d2_s_q[i] <= d2_s_q[i-1];
      load_s_q[i] <= load_s_q[i-1];
    end
    for (int unsigned i = 2; i < Stages; i++) index_s_q[i] <= index_s_q[i-1];
    direction_q <= direction;
    normal_q <= normal_i;
    if (rst_i) valid_q <= '0;
  end

  assign out_valid_o = valid_q[Stages-1];
  assign out_context_o = context_s_q[Stages-1];
  assign out_candidate_o = candidate_q[Stages-1] && front;
  assign out_last_o = leaf_last_q[Stages-1];
  assign out_snapshot_o = snapshot_q[Stages-1];
  assign out_clear_o = clear_q[Stages-1];
  assign out_index_o = index_s_q[Stages-1];
  assign out_d2_o = d2_s_q[Stages-1];
  assign out_load_o = load_s_q[Stages-1];
endmodule
