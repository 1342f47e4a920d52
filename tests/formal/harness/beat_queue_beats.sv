// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/lut_ram.sv rtl/common/fifo.sv tests/formal/harness/stubs/block_ram.sv rtl/photon_gatherer/photon_gatherer_beat_queue.sv
// photon_gatherer_beat_queue: one beat that is kept, any, is followed. It comes out as it went in, once, behind all that were
// kept before it and before all that were kept after it, and stays offered until it is taken; its directions are read when it is
// taken, with DistanceRows its distance too, its loads until 31 beats have been kept after it. Room is promised exactly where there is some; with Ahead
// only where there is some, and where all of it has been free for two cycles. A line is
// announced by issue_i only where ready_o is 1, and its beats come later, kept or not.
//
// Of each block RAM the row of the beat that is followed is kept.
module beat_queue_beats #(
    parameter int unsigned Order = 1,
    parameter int unsigned Room = 1,
    parameter int unsigned Lemmas = 0,
    parameter int unsigned Ahead = 0,
    parameter bit DistanceRows = 1'b0,
    parameter int unsigned Places = 16,
    localparam int unsigned Beats = Places == 16 ? 2 : 4,
    localparam int unsigned FifoDepth = 1 << $clog2(Places),
    localparam int unsigned Behind = 32 - Places,
    localparam int unsigned RowBits = 5,
    localparam int unsigned BeatBits = $clog2(Beats),
    localparam int unsigned W = $clog2(FifoDepth) + 1  // of counters and of the FIFO's pointers
) (
    input logic clk_i,
    input logic rst_i,
    input logic issue_i,
    input logic in_valid_i,
    input logic in_keep_i,
    input logic in_context_i,
    input logic [BeatBits-1:0] in_beat_i,
    input logic in_last_i,
    input logic in_mask_i,
    input logic in_d2_i,
    input logic [2:0] in_load_i,
    input logic out_ready_i,
    input logic direction_read_i,
    input logic [RowBits-1:0] load_row_i,
    input logic pick_i
);
  logic [BeatBits-1:0] out_beat;
  logic ready, out_valid, out_context, out_last, out_mask, out_d2;
  logic [RowBits-1:0] out_row;
  logic [1:0] directions;
  logic [2:0] load;

  photon_gatherer_beat_queue #(
      .R2Bits(1),
      .Contexts(2),
      .Bucket(Beats),
      .Lanes(1),
      .DirectionBits(1),
      .LoadBits(3),
      .Behind(Behind),
      .Ahead(Ahead),
      .DistanceRows(DistanceRows),
      .Queued(Places)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .ready_o(ready),
      .issue_i(issue_i),
      .in_valid_i(in_valid_i),
      .in_keep_i(in_keep_i),
      .in_context_i(in_context_i),
      .in_beat_i(in_beat_i),
      .in_last_i(in_last_i),
      .in_mask_i(in_mask_i),
      .in_d2_i(in_d2_i),
      .in_loads_i(in_load_i),
      .out_valid_o(out_valid),
      .out_ready_i(out_ready_i),
      .out_context_o(out_context),
      .out_beat_o(out_beat),
      .out_row_o(out_row),
      .out_last_o(out_last),
      .out_mask_o(out_mask),
      .out_d2_o(out_d2),
      .direction_read_i(direction_read_i),
      .directions_o(directions),
      .load_row_i(load_row_i),
      .loads_o(load)
  );

  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;
  always_comb assume (rst_i == !started_q);

  // Beats that are due, those inside, and those that are inside and go before the one that is followed, which is picked and
  // comes out, and has others that were kept after it.
  logic [W-1:0] due_q, inside_q, ahead_q;
  logic picked_q, out_q;
  logic [1:0] empty_q;  // cycles in which nothing was due or inside
  logic [4:0] since_q;  // at most 31: then its row may have another
  logic [RowBits-1:0] row_q;
  logic [BeatBits+3:0] word_q;
  logic d2_q;
  logic [2:0] load_q;
  logic keeps, picks, takes, comes;
  logic [BeatBits+3:0] word;
  logic directed_q, loaded_q, stalled_q;
  logic [BeatBits+3:0] shown_q;
  logic [RowBits-1:0] shown_row_q;
  assign word  = {out_context, out_beat, out_last, out_mask, !DistanceRows && out_d2};
  assign keeps = in_valid_i && in_keep_i;
  assign picks = keeps && pick_i && !picked_q;
  assign takes = out_valid && out_ready_i;
  assign comes = out_valid && picked_q && !out_q && ahead_q == '0;

  always_ff @(posedge clk_i) begin
    due_q <= due_q + (issue_i ? W'(Beats) : '0) - W'(in_valid_i);
    inside_q <= inside_q + W'(keeps) - W'(takes);
    if (picks) begin
      picked_q <= 1'b1;
      word_q <= {in_context_i, in_beat_i, in_last_i, in_mask_i, !DistanceRows && in_d2_i};
      d2_q <= in_d2_i;
      load_q <= in_load_i;
      ahead_q <= inside_q - W'(takes);
    end else if (takes && ahead_q != '0) begin
      ahead_q <= ahead_q - 1'b1;
    end
    if (comes && takes) out_q <= 1'b1;
    if (comes) row_q <= out_row;
    if (picked_q && keeps && since_q != '1) since_q <= since_q + 1'b1;
    directed_q <= comes ? direction_read_i : directed_q && !direction_read_i;
    loaded_q <= (comes && load_row_i == out_row) || (out_q && since_q != '1 && load_row_i == row_q);
    stalled_q <= out_valid && !out_ready_i;
    empty_q <= due_q != '0 || inside_q != '0 || issue_i ? '0 : empty_q == 2'd2 ? 2'd2 : empty_q + 1'b1;
    shown_q <= word;
    shown_row_q <= out_row;
    if (rst_i) begin
      due_q <= '0;
      inside_q <= '0;
      picked_q <= 1'b0;
      out_q <= 1'b0;
      since_q <= '0;
      directed_q <= 1'b0;
      loaded_q <= 1'b0;
      stalled_q <= 1'b0;
      empty_q <= '0;
    end
  end

  // The row of the beat, where the memories look.
  (* anyconst *) logic [RowBits-1:0] watched;
  (* keep *) logic [RowBits-1:0] directions_watched, loads_watched, distances_watched, row;  // probes
  always_comb begin
    assume (directions_watched == watched && loads_watched == watched && (!DistanceRows || distances_watched == watched));
    if (picks) assume (row == watched);
    if (!rst_i) begin
      if (issue_i) assume (ready);
      if (in_valid_i) assume (due_q != '0);
      if (in_keep_i) assume (in_valid_i);
    end
  end

  if (Order == 1) begin : gen_order
    always_comb begin
      if (!rst_i) begin
        if (picked_q && !out_q) assert (out_valid);
        if (comes) assert (word == word_q && out_row == watched);
        if (directed_q) assert (directions == load_q[1:0] && (!DistanceRows || out_d2 == d2_q));
        if (loaded_q) assert (load == load_q);
        if (stalled_q) assert (out_valid && word == shown_q && out_row == shown_row_q);
      end
    end
  end
  if (Room == 1) begin : gen_room
    always_comb begin
      if (!rst_i) begin
        assert (inside_q <= W'(Places) && due_q <= W'(Places) - inside_q);
        if (Ahead == 0) assert (ready == (due_q + inside_q <= W'(Places - Beats)));
        if (Ahead != 0 && ready) assert (due_q + inside_q <= W'(Places - Beats));
        if (Ahead != 0 && empty_q == 2'd2) assert (ready);
        assert (out_valid == (inside_q != '0));
      end
    end
  end

  // ---- inside ----
  (* keep *) logic [W-1:0] head, tail, room, place;  // probes, and where the beat lies
  (* keep *) logic issue;
  (* keep *) logic popped, dropped;  // with Ahead: room that is counted in the next cycle
  logic [W-1:0] back;
  assign back = Ahead != 0 ? W'(popped) + W'(dropped) : '0;
  (* keep *) logic [FifoDepth*(BeatBits+9)-1:0] words;
  logic [BeatBits+8:0] placed;
  (* keep *) logic [2:0] row_load;
  (* keep *) logic [1:0] row_directions;
  (* keep *) logic row_distance;
  assign place  = head + ahead_q;
  assign placed = words[(BeatBits+9)*place[W-2:0]+:BeatBits+9];
  if (Lemmas == 1) begin : gen_lemmas
    always_comb begin
      if (!rst_i) begin
        assert (tail - head == inside_q && inside_q <= W'(Places) && due_q <= W'(Places) - inside_q);
        assert (room - (issue ? W'(Beats) : '0) + back == W'(Places) - due_q - inside_q);
        if (Ahead != 0 && issue) assert (due_q >= W'(Beats) && room >= W'(Beats));
        if (Ahead != 0) assert (room <= W'(Places));
        if (Ahead != 0 && ready) assert (room >= (issue ? W'(2 * Beats) : W'(Beats)));
        if (Ahead != 0 && empty_q != '0) assert (room == W'(Places) && !issue);
      end
      if (!rst_i && Order == 1) begin
        if (!picked_q) assert (!directed_q && since_q == '0);
        if (DistanceRows && picked_q) assert (!word_q[0]);
        if (picked_q) assert (since_q == '1 || (row_load == load_q && row_directions == load_q[1:0] && (!DistanceRows || row_distance == d2_q)));
        if (picked_q && !out_q) begin
          assert (ahead_q < inside_q && since_q == 5'(inside_q - ahead_q - 1'b1));
          assert (placed == {word_q[BeatBits+3:3], watched, word_q[2:1], DistanceRows ? d2_q : word_q[0]});
          // As many beats have come behind it as there are in the FIFO behind it.
          assert (row == RowBits'(watched + inside_q - ahead_q));
        end
        if (out_q) begin
          assert (picked_q && row_q == watched);
          assert (since_q == '1 || row == RowBits'(watched + since_q + 1'b1));
        end
      end
    end
  end
endmodule
