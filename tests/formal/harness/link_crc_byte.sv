// SPDX-License-Identifier: Apache-2.0
// sources: rtl/board/link_crc.sv
// link_crc: from any register and any byte, 8 cycles later the register is that of the definition, the remainder of the
// message by the polynomial of IEEE 802.3, taken a byte at a time; a byte is taken only once. After reset nothing but the
// idle state is known, so one byte stands for all.
module link_crc_byte (
    input logic clk_i
);
  (* anyconst *) logic [7:0] data;
  logic started_q = 1'b0, sent_q = 1'b0;
  logic [3:0] age_q = '0;
  logic in_ready;
  logic [31:0] crc, before_q;

  link_crc dut (
      .clk_i(clk_i),
      .clear_i(1'b0),
      .rst_i(!started_q),
      .in_valid_i(started_q && !sent_q),
      .in_ready_o(in_ready),
      .in_i(data),
      .crc_o(crc)
  );

  // Each bit of the remainder of 8 more bits, by polynomial division from the highest power.
  function automatic logic [31:0] next(input logic [31:0] register, input logic [7:0] value);
    logic [39:0] dividend;  // highest power on top: bits leave the reflected register from its lowest
    for (int unsigned i = 0; i < 32; i++) dividend[39-i] = register[i] ^ (i < 8 ? value[i%8] : 1'b0);
    dividend[7:0] = '0;
    for (int unsigned i = 0; i < 8; i++) begin
      if (dividend[39-i]) dividend[39-i-:33] = dividend[39-i-:33] ^ {1'b1, 32'h04C11DB7};
    end
    for (int unsigned i = 0; i < 32; i++) next[i] = dividend[31-i];
  endfunction

  always_ff @(posedge clk_i) begin
    started_q <= 1'b1;
    if (started_q) sent_q <= 1'b1;
    if (started_q && !sent_q) before_q <= crc;
    if (sent_q && age_q != 4'd9) age_q <= age_q + 1'b1;
  end

  always_comb begin
    if (started_q && !sent_q) assert (in_ready);
    if (sent_q && age_q < 4'd8) assert (!in_ready);
    if (age_q == 4'd8) assert (in_ready && crc == next(before_q, data));
  end
endmodule
