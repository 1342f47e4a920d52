// SPDX-License-Identifier: Apache-2.0
// Beats of candidates on their way to one list. They wait in a FIFO. What else their photons have (direction, power: their
// load) goes to a row of block RAM, whose number goes with the beat: the directions are read when the beat is taken, the
// loads when its candidates are at the list. With DistanceRows squared distances have rows too, read as directions are: LUTs for block
// RAM. Rows are reused in turn, after more beats than there can be between here
// and there.
//
// A line is announced by issue_i as many cycles ahead as its sender likes; ready_o says that one more may be issued,
// and room for all that were is held, whichever list they will turn out to be of. Latency 1; one beat a cycle.
module photon_gatherer_beat_queue #(
    parameter int unsigned R2Bits = 34,
    parameter int unsigned Contexts = 16,      // of the list
    parameter int unsigned Bucket = 8,
    parameter int unsigned Lanes = 4,
    parameter int unsigned DirectionBits = 8,
    parameter int unsigned LoadBits = 48,      // direction, mantissas, exponent of a photon
    parameter int unsigned Behind = 16,        // beats that may be between the FIFO and the list
    // Of many lanes it is known late whether one is near. Then beats are written before that, since each has room for it; and the room
    // that comes back is counted a cycle later, as if a line were issued in each: room for three lines is what it takes to issue one in
    // each cycle.
    parameter int unsigned Ahead = Lanes > 4 ? 1 : 0,
    parameter bit DistanceRows = 1'b0,
    parameter int unsigned Queued = photonloom_pkg::QueuedBeats,  // places, where two lines are not more
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned Beats = Bucket / Lanes,
    localparam int unsigned BeatBits = Beats > 1 ? $clog2(Beats) : 1,
    localparam int unsigned Places = 2 * Beats > 16 ? 1 << $clog2(2 * Beats) : Queued,
    localparam int unsigned FifoDepth = 1 << $clog2(Places),
    localparam int unsigned RowBits = $clog2(Places + Behind)
) (
    input  logic                             clk_i,
    input  logic                             rst_i,
    // lines
    output logic                             ready_o,
    input  logic                             issue_i,
    // beats: one leaves the lanes, and it is kept here
    input  logic                             in_valid_i,
    input  logic                             in_keep_i,
    input  logic [          ContextBits-1:0] in_context_i,
    input  logic [             BeatBits-1:0] in_beat_i,
    input  logic                             in_last_i,
    input  logic [                Lanes-1:0] in_mask_i,
    input  logic [         Lanes*R2Bits-1:0] in_d2_i,
    input  logic [       Lanes*LoadBits-1:0] in_loads_i,
    // beats of candidates
    output logic                             out_valid_o,
    input  logic                             out_ready_i,
    output logic [          ContextBits-1:0] out_context_o,
    output logic [             BeatBits-1:0] out_beat_o,
    output logic [              RowBits-1:0] out_row_o,
    output logic                             out_last_o,
    output logic [                Lanes-1:0] out_mask_o,
    output logic [         Lanes*R2Bits-1:0] out_d2_o,         // with DistanceRows as directions_o
    // directions of a beat, read when it is taken: in the next cycle, until the next such
    input  logic                             direction_read_i,
    output logic [2*Lanes*DirectionBits-1:0] directions_o,
    // loads of a row, in the next cycle
    input  logic [              RowBits-1:0] load_row_i,
    output logic [       Lanes*LoadBits-1:0] loads_o
);
  localparam int unsigned RoomBits = $clog2(FifoDepth + 1);
  localparam int unsigned QueuedBits = DistanceRows ? 1 : Lanes * R2Bits;  // of distances; the one beside rows is not used
  localparam int unsigned WordBits = Lanes + QueuedBits + ContextBits + BeatBits + RowBits + 1;

  // ---- room: a line is let in when its beats have a place in the FIFO. That of the last cycle is counted now. ----
  logic [RoomBits-1:0] room_q;
  logic issue_q, pop, drop, popped, dropped, ready_ahead;

  assign ready_o = Ahead != 0 ? ready_ahead : room_q >= (issue_q ? RoomBits'(2 * Beats) : RoomBits'(Beats));
  assign drop = in_valid_i && !in_keep_i;
  assign pop = out_valid_o && out_ready_i;

  if (Ahead != 0) begin : gen_ahead
    logic ready_q, pop_q, drop_q;
    always_ff @(posedge clk_i) begin
      ready_q <= room_q >= (issue_q ? RoomBits'(3 * Beats) : RoomBits'(2 * Beats));
      {pop_q, drop_q} <= {pop, drop};
      if (rst_i) {ready_q, pop_q, drop_q} <= '0;
    end
    assign ready_ahead = ready_q;
    assign popped = pop_q;
    assign dropped = drop_q;
  end else begin : gen_at_once
    assign ready_ahead = pop;  // nothing looks at it
    assign popped = pop;
    assign dropped = drop;
  end

  always_ff @(posedge clk_i) begin
    issue_q <= issue_i;
    room_q <= room_q - (issue_q ? RoomBits'(Beats) : '0) + RoomBits'(popped) + RoomBits'(dropped);
    if (rst_i) begin
      issue_q <= 1'b0;
      room_q  <= RoomBits'(Places);
    end
  end

  // ---- rows ----
  logic [RowBits-1:0] row_q;
  logic [2*Lanes*DirectionBits-1:0] directions;

  always_ff @(posedge clk_i) begin
    if (in_keep_i) row_q <= row_q + 1'b1;
    if (rst_i) row_q <= '0;
  end

  for (genvar lane = 0; lane < Lanes; lane++) begin : gen_directions
    assign directions[2*DirectionBits*lane+:2*DirectionBits] = in_loads_i[LoadBits*lane+:2*DirectionBits];
  end

  block_ram #(
      .Width(2 * Lanes * DirectionBits),
      .Depth(1 << RowBits)
  ) direction_rows (
      .clk_i(clk_i),
      .write_i(Ahead != 0 ? in_valid_i : in_keep_i),
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
      .write_i(Ahead != 0 ? in_valid_i : in_keep_i),
      .write_address_i(row_q),
      .write_data_i(in_loads_i),
      .read_i(1'b1),
      .read_address_i(load_row_i),
      .read_data_o(loads_o)
  );

  // ---- the FIFO ----
  /* verilator lint_off UNUSEDSIGNAL */  // room was reserved
  logic fifo_ready;
  logic [QueuedBits-1:0] queued;
  /* verilator lint_on UNUSEDSIGNAL */

  fifo #(
      .Width(WordBits),
      .Depth(FifoDepth),
      .Ahead(Ahead)
  ) beats (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_keep_i),
      .in_ready_o(fifo_ready),
      .in_i({in_context_i, in_beat_i, row_q, in_last_i, in_mask_i, QueuedBits'(in_d2_i)}),
      .out_valid_o(out_valid_o),
      .out_ready_i(out_ready_i),
      .out_o({out_context_o, out_beat_o, out_row_o, out_last_o, out_mask_o, queued})
  );

  if (DistanceRows) begin : gen_distance_rows
    /* verilator lint_off UNUSEDSIGNAL */
    logic unused;
    /* verilator lint_on UNUSEDSIGNAL */
    assign unused = queued[0];
    block_ram #(
        .Width(Lanes * R2Bits),
        .Depth(1 << RowBits)
    ) distance_rows (
        .clk_i(clk_i),
        .write_i(Ahead != 0 ? in_valid_i : in_keep_i),
        .write_address_i(row_q),
        .write_data_i(in_d2_i),
        .read_i(direction_read_i),
        .read_address_i(out_row_o),
        .read_data_o(out_d2_o)
    );
  end else begin : gen_queued_distances
    assign out_d2_o = queued;
  end
endmodule
