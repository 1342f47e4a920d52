// SPDX-License-Identifier: Apache-2.0
// The eight LEDs of docs/host-link.md. ClockKHz is that of clk_i; 0 (simulation) counts as 20.
module board_leds #(
    parameter int unsigned ClockKHz = 0,
    localparam int unsigned TickCycles = (ClockKHz == 0 ? 20 : ClockKHz) * 50,  // a twentieth of a second
    localparam int unsigned TickBits = $clog2(TickCycles)
) (
    input  logic       clk_i,
    input  logic       rst_i,
    input  logic       byte_received_i,  // one cycle each
    input  logic       byte_sent_i,
    input  logic       busy_i,           // levels
    input  logic       replay_busy_i,
    input  logic       memory_busy_i,
    input  logic       bad_seen_i,
    input  logic       plan_read_i,
    input  logic       testing_i,        // all are lit
    input  logic       test_failed_i,    // all blink
    output logic [7:0] led_o
);
  logic [TickBits-1:0] cycle_q;
  logic [3:0] tick_q;
  logic [1:0] received_q, sent_q;
  logic tick, beat_q;
  assign tick = cycle_q == TickBits'(TickCycles - 1);

  always_ff @(posedge clk_i) begin
    cycle_q <= tick ? '0 : cycle_q + 1'b1;
    if (tick) begin
      tick_q <= tick_q == 4'd9 ? 4'd0 : tick_q + 4'd1;
      if (tick_q == 4'd9) beat_q <= !beat_q;
    end
    if (byte_received_i) received_q <= '1;
    else if (tick) received_q <= {1'b0, received_q[1]};
    if (byte_sent_i) sent_q <= '1;
    else if (tick) sent_q <= {1'b0, sent_q[1]};
    led_o <= testing_i ? '1 : test_failed_i ? {8{beat_q}} : {
      plan_read_i, bad_seen_i, memory_busy_i, replay_busy_i, busy_i, sent_q[0], received_q[0], beat_q
    };
    if (rst_i) begin
      cycle_q <= '0;
      tick_q <= '0;
      beat_q <= 1'b0;
      received_q <= '0;
      sent_q <= '0;
    end
  end
endmodule
