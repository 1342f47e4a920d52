// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/room_ahead.sv
// room_ahead: a FIFO that is filled only while there is room never holds more than Depth words, and where for three cycles it has held
// at most Depth - 3 there is room.
module room_ahead_fill #(
    parameter int unsigned Depth = 4
) (
    input logic clk_i,
    input logic rst_i,
    input logic push_i,
    input logic pop_i
);
  localparam int unsigned FillBits = $clog2(Depth + 1) + 1;  // room for one too many
  logic room;

  room_ahead #(
      .Depth(Depth)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .push_i(push_i),
      .pop_i(pop_i),
      .room_o(room)
  );

  logic started_q = 1'b0;
  logic [FillBits-1:0] fill_q;
  logic [1:0] low_q;  // cycles that it has held few
  always_ff @(posedge clk_i) begin
    started_q <= 1'b1;
    fill_q <= rst_i ? '0 : fill_q + FillBits'(push_i) - FillBits'(pop_i);
    low_q <= rst_i || fill_q > FillBits'(Depth - 3) ? '0 : low_q == 2'd3 ? low_q : low_q + 1'b1;
  end

  always_comb begin
    assume (rst_i == !started_q);
    if (!rst_i) begin
      if (push_i) assume (room);
      if (pop_i) assume (fill_q != '0);
      assert (fill_q <= FillBits'(Depth));
      if (low_q == 2'd3) assert (room);
    end
  end
endmodule
