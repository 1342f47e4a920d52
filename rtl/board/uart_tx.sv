// SPDX-License-Identifier: Apache-2.0
// Sender of a UART: 8 data bits, no parity, 1 stop bit, least significant bit first, ClocksPerBit (at least 4) clocks a
// bit. Takes a byte in 10 * ClocksPerBit + 1 cycles; in_ready_o comes from a register.
module uart_tx #(
    parameter int unsigned ClocksPerBit = 4,
    localparam int unsigned CountBits = $clog2(ClocksPerBit)
) (
    input  logic       clk_i,
    input  logic       rst_i,
    input  logic       in_valid_i,
    output logic       in_ready_o,
    input  logic [7:0] in_i,
    output logic       tx_o
);
  if (ClocksPerBit < 4) begin : gen_bad_rate
    uart_needs_at_least_4_clocks_per_bit bad_rate ();
  end

  logic active_q;
  logic [CountBits-1:0] count_q;
  logic [3:0] bits_q;  // bits that follow this one
  logic [8:0] shift_q;

  assign in_ready_o = !active_q;

  always_ff @(posedge clk_i) begin
    count_q <= count_q - 1'b1;
    if (!active_q) begin
      count_q <= CountBits'(ClocksPerBit - 1);
      bits_q  <= 4'd9;
      if (in_valid_i) begin
        active_q <= 1'b1;
        tx_o     <= 1'b0;
        shift_q  <= {1'b1, in_i};
      end
    end else if (count_q == '0) begin
      count_q  <= CountBits'(ClocksPerBit - 1);
      bits_q   <= bits_q - 4'd1;
      active_q <= bits_q != 4'd0;
      tx_o     <= shift_q[0];
      shift_q  <= {1'b1, shift_q[8:1]};
    end
    if (rst_i) begin
      active_q <= 1'b0;
      tx_o     <= 1'b1;
    end
  end
endmodule
