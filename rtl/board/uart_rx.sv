// SPDX-License-Identifier: Apache-2.0
// Receiver of a UART: 8 data bits, no parity, 1 stop bit, least significant bit first, ClocksPerBit (at least 4) clocks a
// bit. The line passes two registers, then each bit is sampled in its middle. A start bit that is not 0 in its middle
// and a byte whose stop bit is 0 are dropped; the next start bit is looked for from the middle of the stop bit on, so
// the sender may be a little faster. data_o is valid in the one cycle of valid_o.
module uart_rx #(
    parameter int unsigned ClocksPerBit = 4,
    localparam int unsigned CountBits = $clog2(ClocksPerBit)
) (
    input  logic       clk_i,
    input  logic       rst_i,
    input  logic       rx_i,
    output logic       valid_o,
    output logic [7:0] data_o
);
  if (ClocksPerBit < 4) begin : gen_bad_rate
    uart_needs_at_least_4_clocks_per_bit bad_rate ();
  end

  logic [2:0] line_q;  // the newest bit lowest
  logic active_q;
  logic [CountBits-1:0] count_q;
  logic [3:0] bit_q;  // 0 start, 1 to 8 data, 9 stop
  logic sample;

  assign sample = active_q && count_q == '0;

  always_ff @(posedge clk_i) begin
    line_q  <= {line_q[1:0], rx_i};
    valid_o <= 1'b0;
    count_q <= count_q - 1'b1;
    if (!active_q) begin
      active_q <= line_q[2] && !line_q[1];
      count_q  <= CountBits'(ClocksPerBit / 2 - 1);
      bit_q    <= 4'd0;
    end
    if (sample) begin
      count_q <= CountBits'(ClocksPerBit - 1);
      bit_q   <= bit_q + 4'd1;
      if (bit_q == 4'd0 && line_q[1]) active_q <= 1'b0;
      if (bit_q == 4'd9) begin
        active_q <= 1'b0;
        valid_o  <= line_q[1];
      end else begin
        data_o <= {line_q[1], data_o[7:1]};
      end
    end
    if (rst_i) begin
      line_q   <= '1;
      active_q <= 1'b0;
      valid_o  <= 1'b0;
    end
  end
endmodule
