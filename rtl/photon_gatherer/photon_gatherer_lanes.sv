// SPDX-License-Identifier: Apache-2.0
// Leaf lines to candidates. A line is cut into beats of Lanes photons; each lane computes its photon's exact squared
// distance and drops it when the slot is unused or it is beyond the bound of that moment (a bound only shrinks, so
// this never drops what the list would take). Beats that keep a photon, and the last of each line, wait in a FIFO; the
// loads of their photons wait beside it in block RAM.
//
// A line may come every Bucket / Lanes cycles and is announced by issue_i as many cycles ahead as its sender likes;
// ready_o says that one more may be issued, and room for all that were is held. Latency 6 from line to FIFO.
module photon_gatherer_lanes #(
    parameter int unsigned PositionBits = 16,
    parameter int unsigned Contexts = 16,
    parameter int unsigned Bucket = 8,
    parameter int unsigned Lanes = 4,
    parameter int unsigned LoadBits = 48,      // direction, mantissas, exponent of a photon
    parameter int unsigned MantissasBits = 27,
    parameter int unsigned ExponentBits = 5,
    localparam int unsigned R2Bits = 2 * PositionBits + 2,
    localparam int unsigned PhotonBits = 3 * PositionBits + LoadBits,
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned Beats = Bucket / Lanes,
    localparam int unsigned BeatBits = Beats > 1 ? $clog2(Beats) : 1
) (
    input  logic                         clk_i,
    input  logic                         rst_i,
    // lines
    output logic                         ready_o,
    input  logic                         issue_i,
    input  logic                         in_valid_i,
    input  logic [      ContextBits-1:0] in_context_i,
    input  logic [Bucket*PhotonBits-1:0] in_line_i,
    // context state
    output logic [      ContextBits-1:0] query_context_o,
    input  logic [   3*PositionBits-1:0] query_i,
    output logic [      ContextBits-1:0] bound_context_o,
    input  logic [           R2Bits-1:0] bound_i,
    // beats of candidates
    output logic                         out_valid_o,
    input  logic                         out_ready_i,
    output logic [      ContextBits-1:0] out_context_o,
    output logic [         BeatBits-1:0] out_beat_o,
    output logic                         out_last_o,
    output logic                         out_first_o,   // no earlier beat of the line was kept
    output logic [            Lanes-1:0] out_mask_o,
    output logic [     Lanes*R2Bits-1:0] out_d2_o,
    input  logic                         load_read_i,   // when a beat is taken whose loads are wanted: they come
    output logic [   Lanes*LoadBits-1:0] load_o         // in the next cycle and stay until the next such
);
  localparam int unsigned P = PositionBits;
  localparam int unsigned Depth = 2 * Beats > 16 ? 2 * Beats : 16;
  localparam int unsigned RoomBits = $clog2(Depth + 1);
  localparam int unsigned WordBits = Lanes * (R2Bits + 1) + ContextBits + BeatBits + 2;
  localparam int unsigned FifoDepth = 1 << $clog2(Depth);

  if (Bucket % Lanes != 0) begin : gen_bad_lanes
    lanes_must_divide_bucket bad_lanes ();
  end

  // ---- room: a line is let in when its beats have a place in the FIFO, and not more often than it takes to cut ----
  logic [RoomBits-1:0] room_q;
  logic [BeatBits-1:0] pause_q;
  logic pop, drop;

  assign ready_o = room_q >= RoomBits'(Beats) && pause_q == '0;

  always_ff @(posedge clk_i) begin
    room_q <= room_q - (issue_i ? RoomBits'(Beats) : '0) + RoomBits'(pop) + RoomBits'(drop);
    if (issue_i) pause_q <= BeatBits'(Beats - 1);
    else if (pause_q != '0) pause_q <= pause_q - 1'b1;
    if (rst_i) begin
      room_q <= RoomBits'(Depth);
      pause_q <= '0;
    end
  end

  // ---- cutting ----
  logic valid_0_q;
  logic [ContextBits-1:0] context_0_q;
  logic [Bucket*PhotonBits-1:0] line_0_q;
  logic [BeatBits-1:0] beat_0_q;
  logic last_0;

  assign last_0 = beat_0_q == BeatBits'(Beats - 1);

  always_ff @(posedge clk_i) begin
    if (in_valid_i) begin
      valid_0_q <= 1'b1;
      context_0_q <= in_context_i;
      line_0_q <= in_line_i;
      beat_0_q <= '0;
    end else begin
      if (last_0) valid_0_q <= 1'b0;
      line_0_q <= line_0_q >> (Lanes * PhotonBits);
      beat_0_q <= beat_0_q + 1'b1;
    end
    if (rst_i) valid_0_q <= 1'b0;
  end

  // ---- distances: differences | squares | sum | compare ----
  localparam int unsigned Stages = 4;
  logic [Stages-1:0] valid_q, last_q;
  logic [ContextBits-1:0] context_q[0:Stages-1];
  logic [BeatBits-1:0] beat_q[0:Stages-1];
  logic [Lanes*LoadBits-1:0] load_q[0:Stages-1];
  logic [Lanes-1:0] used_q[0:Stages-2];
  logic [Lanes-1:0] mask_q;
  logic [Lanes*R2Bits-1:0] d2, d2_q;
  logic [R2Bits-1:0] bound_q;

  assign query_context_o = context_0_q;
  assign bound_context_o = context_q[1];

  for (genvar lane = 0; lane < Lanes; lane++) begin : gen_lane
    logic [PhotonBits-1:0] photon;
    logic [3*(P+1)-1:0] offset_q;
    assign photon = line_0_q[PhotonBits*lane+:PhotonBits];

    always_ff @(posedge clk_i) begin
      for (int unsigned axis = 0; axis < 3; axis++)
        offset_q[(P+1)*axis+:P+1] <= {1'b0, photon[P*axis+:P]} - {1'b0, query_i[P*axis+:P]};
      load_q[0][LoadBits*lane+:LoadBits] <= photon[3*P+:LoadBits];
      // The code of an unused slot: mantissas 0, exponent all ones.
      used_q[0][lane] <= !(photon[PhotonBits-1-:ExponentBits] == '1 &&
                           photon[PhotonBits-1-ExponentBits-:MantissasBits] == '0);
      mask_q[lane] <= used_q[Stages-2][lane] && d2[R2Bits*lane+:R2Bits] <= bound_q;
    end

    squared_distance #(
        .Bits(P + 1)
    ) square (
        .clk_i(clk_i),
        .offset_i(offset_q),
        .sum_o(d2[R2Bits*lane+:R2Bits])
    );
  end

  always_ff @(posedge clk_i) begin
    valid_q <= {valid_q[Stages-2:0], valid_0_q};
    last_q <= {last_q[Stages-2:0], last_0};
    context_q[0] <= context_0_q;
    beat_q[0] <= beat_0_q;
    for (int unsigned i = 1; i < Stages; i++) begin
      context_q[i] <= context_q[i-1];
      beat_q[i] <= beat_q[i-1];
      load_q[i] <= load_q[i-1];
    end
    for (int unsigned i = 1; i < Stages - 1; i++) used_q[i] <= used_q[i-1];
    bound_q <= bound_i;
    d2_q <= d2;
    if (rst_i) valid_q <= '0;
  end

  // ---- the FIFO ----
  logic keep, kept_q;
  logic [$clog2(FifoDepth)-1:0] write_q, read_q;
  /* verilator lint_off UNUSEDSIGNAL */  // room was reserved
  logic fifo_ready;
  /* verilator lint_on UNUSEDSIGNAL */

  assign keep = valid_q[Stages-1] && (last_q[Stages-1] || mask_q != '0);
  assign drop = valid_q[Stages-1] && !keep;
  assign pop = out_valid_o && out_ready_i;

  always_ff @(posedge clk_i) begin
    if (valid_q[Stages-1]) kept_q <= (keep || kept_q) && !last_q[Stages-1];
    if (keep) write_q <= write_q + 1'b1;
    if (pop) read_q <= read_q + 1'b1;
    if (rst_i) begin
      kept_q <= 1'b0;
      write_q <= '0;
      read_q <= '0;
    end
  end

  block_ram #(
      .Width(Lanes * LoadBits),
      .Depth(FifoDepth)
  ) loads (
      .clk_i(clk_i),
      .write_i(keep),
      .write_address_i(write_q),
      .write_data_i(load_q[Stages-1]),
      .read_i(load_read_i),
      .read_address_i(read_q),
      .read_data_o(load_o)
  );

  fifo #(
      .Width(WordBits),
      .Depth(FifoDepth)
  ) beats (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(keep),
      .in_ready_o(fifo_ready),
      .in_i({context_q[Stages-1], beat_q[Stages-1], last_q[Stages-1], !kept_q, mask_q, d2_q}),
      .out_valid_o(out_valid_o),
      .out_ready_i(out_ready_i),
      .out_o({out_context_o, out_beat_o, out_last_o, out_first_o, out_mask_o, out_d2_o})
  );
endmodule
