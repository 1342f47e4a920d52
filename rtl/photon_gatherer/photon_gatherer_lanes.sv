// SPDX-License-Identifier: Apache-2.0
// Beats of leaf lines, Lanes photons each, to beats of candidates. Each lane computes its photon's exact squared
// distance and drops it when the slot is unused or it is beyond the bound of that moment (a bound only shrinks, so
// this never drops what the list would take). A line that keeps none leaves by empty_*; else beats that keep a photon,
// and the last of the line, wait in a FIFO. What else their photons have (direction, power: their load) goes to a row
// of block RAM, whose number goes with the beat: the directions are read when the beat is taken, the loads when its
// candidates are at the list. Rows are reused in turn, after more beats than there can be between here and there.
//
// A line is announced by issue_i as many cycles ahead as its sender likes; ready_o says that one more may be issued,
// and room for all that were is held. Latency 6 from beat to FIFO; one beat a cycle.
module photon_gatherer_lanes #(
    parameter int unsigned PositionBits = 16,
    parameter int unsigned Contexts = 16,
    parameter int unsigned Bucket = 8,
    parameter int unsigned Lanes = 4,
    parameter int unsigned DirectionBits = 8,
    parameter int unsigned LoadBits = 48,      // direction, mantissas, exponent of a photon
    parameter int unsigned MantissasBits = 27,
    parameter int unsigned ExponentBits = 5,
    parameter int unsigned Behind = 16,        // beats that may be between the FIFO and the list
    localparam int unsigned R2Bits = 2 * PositionBits + 2,
    localparam int unsigned PhotonBits = 3 * PositionBits + LoadBits,
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned Beats = Bucket / Lanes,
    localparam int unsigned BeatBits = Beats > 1 ? $clog2(Beats) : 1,
    localparam int unsigned FifoDepth = 2 * Beats > 16 ? 1 << $clog2(2 * Beats) : 16,
    localparam int unsigned RowBits = $clog2(FifoDepth + Behind)
) (
    input  logic                                clk_i,
    input  logic                                rst_i,
    // lines
    output logic                                ready_o,
    input  logic                                issue_i,
    input  logic                                in_valid_i,
    input  logic [             ContextBits-1:0] in_context_i,
    input  logic [                BeatBits-1:0] in_beat_i,
    input  logic [        Lanes*PhotonBits-1:0] in_photons_i,
    // context state
    output logic [             ContextBits-1:0] query_context_o,
    input  logic [          3*PositionBits-1:0] query_i,
    output logic [             ContextBits-1:0] bound_context_o,
    input  logic [                  R2Bits-1:0] bound_i,
    // lines without candidates
    output logic                                empty_valid_o,
    output logic [             ContextBits-1:0] empty_context_o,
    // beats of candidates
    output logic                                out_valid_o,
    input  logic                                out_ready_i,
    output logic [             ContextBits-1:0] out_context_o,
    output logic [                BeatBits-1:0] out_beat_o,
    output logic [                 RowBits-1:0] out_row_o,
    output logic                                out_last_o,
    output logic [                   Lanes-1:0] out_mask_o,
    output logic [            Lanes*R2Bits-1:0] out_d2_o,
    // directions of a beat, read when it is taken: in the next cycle, until the next such
    input  logic                                direction_read_i,
    output logic [   2*Lanes*DirectionBits-1:0] directions_o,
    // loads of a row, in the next cycle
    input  logic [                 RowBits-1:0] load_row_i,
    output logic [          Lanes*LoadBits-1:0] loads_o
);
  localparam int unsigned P = PositionBits;
  localparam int unsigned RoomBits = $clog2(FifoDepth + 1);
  localparam int unsigned WordBits = Lanes * (R2Bits + 1) + ContextBits + BeatBits + RowBits + 1;

  if (Bucket % Lanes != 0) begin : gen_bad_lanes
    lanes_must_divide_bucket bad_lanes ();
  end

  // ---- room: a line is let in when its beats have a place in the FIFO. That of the last cycle is counted now. ----
  logic [RoomBits-1:0] room_q;
  logic issue_q, pop, drop;

  assign ready_o = room_q >= (issue_q ? RoomBits'(2 * Beats) : RoomBits'(Beats));

  always_ff @(posedge clk_i) begin
    issue_q <= issue_i;
    room_q <= room_q - (issue_q ? RoomBits'(Beats) : '0) + RoomBits'(pop) + RoomBits'(drop);
    if (rst_i) begin
      issue_q <= 1'b0;
      room_q  <= RoomBits'(FifoDepth);
    end
  end

  // ---- register | differences | squares | sum | compare ----
  localparam int unsigned Stages = 5;
  logic [Stages-1:0] valid_q, last_q;
  logic [ContextBits-1:0] context_q[0:Stages-1];
  logic [BeatBits-1:0] beat_q[0:Stages-1];
  logic [Lanes*LoadBits-1:0] load_q[1:Stages-1];
  logic [Lanes*PhotonBits-1:0] photons_q;
  logic [Lanes-1:0] used_q[1:Stages-2];
  logic [Lanes-1:0] mask_q;
  logic [Lanes*R2Bits-1:0] d2, d2_q;
  logic [R2Bits-1:0] bound_q;

  assign query_context_o = context_q[0];
  assign bound_context_o = context_q[2];

  for (genvar lane = 0; lane < Lanes; lane++) begin : gen_lane
    logic [PhotonBits-1:0] photon;
    logic beyond;
    logic [3*(P+1)-1:0] offset_q;
    assign photon = photons_q[PhotonBits*lane+:PhotonBits];

    always_ff @(posedge clk_i) begin
      for (int unsigned axis = 0; axis < 3; axis++)
        offset_q[(P+1)*axis+:P+1] <= {1'b0, photon[P*axis+:P]} - {1'b0, query_i[P*axis+:P]};
      load_q[1][LoadBits*lane+:LoadBits] <= photon[3*P+:LoadBits];
      // The code of an unused slot: mantissas 0, exponent all ones.
      used_q[1][lane] <= !(photon[PhotonBits-1-:ExponentBits] == '1 &&
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
    valid_q <= {valid_q[Stages-2:0], in_valid_i};
    last_q <= {last_q[Stages-2:0], in_beat_i == BeatBits'(Beats - 1)};
    context_q[0] <= in_context_i;
    beat_q[0] <= in_beat_i;
    photons_q <= in_photons_i;
    for (int unsigned i = 1; i < Stages; i++) begin
      context_q[i] <= context_q[i-1];
      beat_q[i] <= beat_q[i-1];
    end
    for (int unsigned i = 2; i < Stages; i++) load_q[i] <= load_q[i-1];
    for (int unsigned i = 2; i < Stages - 1; i++) used_q[i] <= used_q[i-1];
    bound_q <= bound_i;
    d2_q <= d2;
    if (rst_i) valid_q <= '0;
  end

  // ---- the FIFO ----
  logic keep, kept_q;  // kept_q: an earlier beat of the line was
  logic [RowBits-1:0] row_q;
  logic [2*Lanes*DirectionBits-1:0] directions;
  /* verilator lint_off UNUSEDSIGNAL */  // room was reserved
  logic fifo_ready;
  /* verilator lint_on UNUSEDSIGNAL */

  assign keep = valid_q[Stages-1] && (mask_q != '0 || (last_q[Stages-1] && kept_q));
  assign empty_valid_o = valid_q[Stages-1] && mask_q == '0 && last_q[Stages-1] && !kept_q;
  assign empty_context_o = context_q[Stages-1];
  assign drop = valid_q[Stages-1] && !keep;
  assign pop = out_valid_o && out_ready_i;

  always_ff @(posedge clk_i) begin
    if (valid_q[Stages-1]) kept_q <= (keep || kept_q) && !last_q[Stages-1];
    if (keep) row_q <= row_q + 1'b1;
    if (rst_i) begin
      kept_q <= 1'b0;
      row_q <= '0;
    end
  end

  for (genvar lane = 0; lane < Lanes; lane++) begin : gen_directions
    assign directions[2*DirectionBits*lane+:2*DirectionBits] = load_q[Stages-1][LoadBits*lane+:2*DirectionBits];
  end

  block_ram #(
      .Width(2 * Lanes * DirectionBits),
      .Depth(1 << RowBits)
  ) direction_rows (
      .clk_i(clk_i),
      .write_i(keep),
      .write_address_i(row_q),
      .write_data_i(directions),
      .read_i(direction_read_i),
      .read_address_i(out_row_o),
      .read_data_o(directions_o)
  );

  block_ram #(
      .Width(Lanes * LoadBits),
      .Depth(1 << RowBits)
  ) load_rows (
      .clk_i(clk_i),
      .write_i(keep),
      .write_address_i(row_q),
      .write_data_i(load_q[Stages-1]),
      .read_i(1'b1),
      .read_address_i(load_row_i),
      .read_data_o(loads_o)
  );

  fifo #(
      .Width(WordBits),
      .Depth(FifoDepth)
  ) beats (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(keep),
      .in_ready_o(fifo_ready),
      .in_i({context_q[Stages-1], beat_q[Stages-1], row_q, last_q[Stages-1], mask_q, d2_q}),
      .out_valid_o(out_valid_o),
      .out_ready_i(out_ready_i),
      .out_o({out_context_o, out_beat_o, out_row_o, out_last_o, out_mask_o, out_d2_o})
  );
endmodule
