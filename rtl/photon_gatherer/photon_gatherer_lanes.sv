// SPDX-License-Identifier: Apache-2.0
// Beats of leaf lines, Lanes photons each, to beats of candidates. Each lane computes its photon's exact squared
// distance and drops it when the slot is unused or it is beyond the bound of that moment (a bound only shrinks, so
// this never drops what the list would take). A line that keeps none leaves by empty_*; else beats that keep a photon,
// and the last of the line, are kept, for a photon_gatherer_beat_queue. Latency 5, with FromRegister 4; one beat a cycle.
module photon_gatherer_lanes #(
    parameter int unsigned PositionBits = 16,
    parameter int unsigned Contexts = 16,
    parameter int unsigned Bucket = 8,
    parameter int unsigned Lanes = 4,
    parameter int unsigned LoadBits = 48,      // direction, mantissas, exponent of a photon
    parameter int unsigned MantissasBits = 27,
    parameter int unsigned ExponentBits = 5,
    parameter bit UsedGiven = 1'b0,            // which slots are used is said, not in their photons
    parameter bit FromRegister = 1'b0,         // what brings the beats is a register, so none is here; not with UsedGiven
    localparam int unsigned R2Bits = 2 * PositionBits + 2,
    localparam int unsigned PhotonBits = 3 * PositionBits + LoadBits,
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned Beats = Bucket / Lanes,
    localparam int unsigned BeatBits = Beats > 1 ? $clog2(Beats) : 1
) (
    input  logic                                clk_i,
    input  logic                                rst_i,
    // beats of lines
    input  logic                                in_valid_i,
    input  logic [             ContextBits-1:0] in_context_i,
    input  logic [                BeatBits-1:0] in_beat_i,
    input  logic [        Lanes*PhotonBits-1:0] in_photons_i,
    input  logic [                   Lanes-1:0] in_used_i,
    // context state
    output logic [             ContextBits-1:0] query_context_o,
    input  logic [      3*(PositionBits+1)-1:0] query_i,          // signed, from where positions count
    output logic [             ContextBits-1:0] bound_context_o,
    input  logic [                  R2Bits-1:0] bound_i,
    // lines without candidates
    output logic                                empty_valid_o,
    output logic [             ContextBits-1:0] empty_context_o,
    // beats of candidates: one leaves, and is kept
    output logic                                out_valid_o,
    output logic                                out_keep_o,
    output logic [             ContextBits-1:0] out_context_o,
    output logic [                BeatBits-1:0] out_beat_o,
    output logic                                out_last_o,
    output logic [                   Lanes-1:0] out_mask_o,
    output logic [            Lanes*R2Bits-1:0] out_d2_o,
    output logic [          Lanes*LoadBits-1:0] out_loads_o
);
  localparam int unsigned P = PositionBits;

  if (Bucket % Lanes != 0) begin : gen_bad_lanes
    lanes_must_divide_bucket bad_lanes ();
  end

  // ---- register | differences | squares | sum | compare ----
  localparam int unsigned Stages = 5;
  /* verilator lint_off UNUSEDSIGNAL */  // the first stage
  logic [Stages-1:0] valid_q, last_q;
  logic [ContextBits-1:0] context_q[0:Stages-1];
  logic [BeatBits-1:0] beat_q[0:Stages-1];
  /* verilator lint_on UNUSEDSIGNAL */
  logic [Lanes*LoadBits-1:0] load_q[1:Stages-1];
  /* verilator lint_off UNUSEDSIGNAL */
  logic [Lanes*PhotonBits-1:0] photons_q;
  /* verilator lint_on UNUSEDSIGNAL */
  logic [Lanes-1:0] used_q[1:Stages-2];
  /* verilator lint_off UNUSEDSIGNAL */
  logic [Lanes-1:0] given_q;
  /* verilator lint_on UNUSEDSIGNAL */
  logic [Lanes-1:0] mask_q;
  logic [Lanes*R2Bits-1:0] d2, d2_q;
  logic [R2Bits-1:0] bound_q;

  assign query_context_o = FromRegister ? in_context_i : context_q[0];
  assign bound_context_o = context_q[2];

  for (genvar lane = 0; lane < Lanes; lane++) begin : gen_lane
    logic [PhotonBits-1:0] photon;
    logic beyond;
    logic [3*(P+1)-1:0] offset_q;
    assign photon = FromRegister ? in_photons_i[PhotonBits*lane+:PhotonBits] : photons_q[PhotonBits*lane+:PhotonBits];

    always_ff @(posedge clk_i) begin
      for (int unsigned axis = 0; axis < 3; axis++)
        offset_q[(P+1)*axis+:P+1] <= {1'b0, photon[P*axis+:P]} - query_i[(P+1)*axis+:P+1];
      load_q[1][LoadBits*lane+:LoadBits] <= photon[3*P+:LoadBits];
      // The code of an unused slot: mantissas 0, exponent all ones.
      used_q[1][lane] <= UsedGiven ? given_q[lane] : !(photon[PhotonBits-1-:ExponentBits] == '1 &&
                           photon[PhotonBits-1-ExponentBits-:MantissasBits] == '0);
      mask_q[lane] <= used_q[Stages-2][lane] && !beyond;
    end

    less_than #(
        .Width(R2Bits)
    ) compare (
        .a_i(bound_q),
        .b_i(d2[R2Bits*lane+:R2Bits]),
        .less_o(beyond)
    );

    squared_distance #(
        .Bits(P + 1)
    ) square (
        .clk_i(clk_i),
        .offset_i(offset_q),
        .sum_o(d2[R2Bits*lane+:R2Bits])
    );
  end

  always_ff @(posedge clk_i) begin
    valid_q <= FromRegister ? {valid_q[Stages-2:1], in_valid_i, 1'b0} : {valid_q[Stages-2:0], in_valid_i};
    last_q <= FromRegister ? {last_q[Stages-2:1], in_beat_i == BeatBits'(Beats - 1), 1'b0} :
        {last_q[Stages-2:0], in_beat_i == BeatBits'(Beats - 1)};
    context_q[0] <= in_context_i;
    beat_q[0] <= in_beat_i;
    photons_q <= in_photons_i;
    given_q <= in_used_i;
    for (int unsigned i = 1; i < Stages; i++) begin
      context_q[i] <= FromRegister && i == 1 ? in_context_i : context_q[i-1];
      beat_q[i] <= FromRegister && i == 1 ? in_beat_i : beat_q[i-1];
    end
    for (int unsigned i = 2; i < Stages; i++) load_q[i] <= load_q[i-1];
    for (int unsigned i = 2; i < Stages - 1; i++) used_q[i] <= used_q[i-1];
    bound_q <= bound_i;
    d2_q <= d2;
    if (rst_i) valid_q <= '0;
  end

  // ---- what is kept ----
  logic keep, kept_q;  // kept_q: an earlier beat of the line was

  assign keep = valid_q[Stages-1] && (mask_q != '0 || (last_q[Stages-1] && kept_q));
  assign empty_valid_o = valid_q[Stages-1] && mask_q == '0 && last_q[Stages-1] && !kept_q;
  assign empty_context_o = context_q[Stages-1];

  always_ff @(posedge clk_i) begin
    if (valid_q[Stages-1]) kept_q <= (keep || kept_q) && !last_q[Stages-1];
    if (rst_i) kept_q <= 1'b0;
  end

  assign out_valid_o = valid_q[Stages-1];
  assign out_keep_o = keep;
  assign out_context_o = context_q[Stages-1];
  assign out_beat_o = beat_q[Stages-1];
  assign out_last_o = last_q[Stages-1];
  assign out_mask_o = mask_q;
  assign out_d2_o = d2_q;
  assign out_loads_o = load_q[Stages-1];
endmodule
