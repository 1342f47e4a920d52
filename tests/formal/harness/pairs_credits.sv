// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/lut_ram.sv rtl/common/fifo.sv rtl/common/oct_decode.sv rtl/photon_gatherer/photon_gatherer_pairs.sv
// photon_gatherer_pairs: a pair is tested only where it will have room, so its FIFO never overflows; all room comes back; and a pair
// that is offered stays and holds, bit for bit, until it is taken, past an empty FIFO too. Beats, directions and normals are any.
module pairs_credits #(
    parameter int unsigned Lemmas = 0,
    parameter int unsigned Lanes = 2,
    parameter int unsigned RoomLater = 0,
    parameter bit ReadAlways = 1'b0,
    localparam int unsigned Depth = 8
) (
    input logic clk_i,
    input logic rst_i,
    input logic in_valid_i,
    input logic in_context_i,
    input logic in_row_i,
    input logic in_last_i,
    input logic [Lanes-1:0] in_mask_i,
    input logic [Lanes-1:0] in_d2_i,
    input logic [4*Lanes-1:0] directions_i,
    input logic [11:0] normal_i,
    input logic out_ready_i
);
  (* anyconst *) logic [3:0] followed;
  logic out_valid, out_context, out_row, out_last, out_first;
  logic [1:0] out_front;
  logic [3:0] out_candidates;

  photon_gatherer_pairs #(
      .R2Bits(1),
      .Contexts(2),
      .Bucket(Lanes),
      .Lanes(Lanes),
      .RowBits(1),
      .DirectionBits(2),
      .NormalBits(2),
      .RoomLater(RoomLater),
      .ReadAlways(ReadAlways)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i),
      .in_ready_o(),
      .in_context_i(in_context_i),
      .in_beat_i(1'b0),
      .in_row_i(in_row_i),
      .in_last_i(in_last_i),
      .in_mask_i(in_mask_i),
      .in_d2_i(in_d2_i),
      .direction_read_o(),
      .directions_i(directions_i),
      .normal_context_o(),
      .normal_i(normal_i),
      .out_valid_o(out_valid),
      .out_ready_i(out_ready_i),
      .out_context_o(out_context),
      .out_row_o(out_row),
      .out_last_o(out_last),
      .out_first_o(out_first),
      .out_front_o(out_front),
      .out_candidates_o(out_candidates)
  );

  (* keep *) logic [3:0] room, head, tail;  // probes
  (* keep *) logic [5:0] stages;  // probe
  (* keep *) logic fifo_push, fifo_ready;  // probes
  (* keep *) logic room_back, discarded;  // of many lanes or RoomLater, probes: room that is counted in the next cycle
  (* keep *) logic some_room, holds;  // where ReadAlways, probes: registers
  logic [3:0] going, back;
  assign back = Lanes > 4 || RoomLater != 0 ? 4'(room_back) + 4'(discarded) : 4'd0;
  always_comb begin
    going = '0;
    for (int unsigned i = 0; i < 6; i++) going = going + 4'(stages[i]);
  end

  logic started_q = 1'b0, stalled_q, shown_q;
  logic [15:0] bits;
  assign bits = {6'd0, out_context, out_row, out_last, out_first, out_front, out_candidates};
  always_ff @(posedge clk_i) begin
    started_q <= 1'b1;
    stalled_q <= !rst_i && out_valid && !out_ready_i;
    shown_q   <= bits[followed];
  end
  always_comb begin
    assume (rst_i == !started_q);
    if (!rst_i) begin
      if (fifo_push) assert (fifo_ready);
      if (stages == '0 && !out_valid) assert (room + back == 4'(Depth));
      if (stalled_q) assert (out_valid && bits[followed] == shown_q);
    end
  end

  if (Lemmas == 1) begin : gen_lemmas
    always_comb begin
      if (!rst_i) assert (6'(room) + 6'(back) + 6'(going) + 6'(4'(tail - head)) == 6'(Depth));
      if (!rst_i && ReadAlways) assert (some_room == (room != '0) && holds == (head != tail));
    end
  end
endmodule
