// SPDX-License-Identifier: Apache-2.0
// sources: rtl/board/link_crc.sv
// link_crc: after a message, whatever its register, four bytes more leave the residue 0xDEBB20E3 iff they are the message's
// CRC, the inverted register with its low byte first.
module link_crc_residue (
    input logic clk_i
);
  (* anyconst *) logic [31:0] data;
  logic started_q = 1'b0, last_q = 1'b0;
  logic [2:0] sent_q = '0;
  logic [31:0] crc, before_q;
  logic in_ready, send;
  assign send = started_q && sent_q != 3'd4;

  link_crc dut (
      .clk_i(clk_i),
      .clear_i(1'b0),
      .rst_i(!started_q),
      .in_valid_i(send),
      .in_ready_o(in_ready),
      .in_i(data[8*sent_q[1:0]+:8]),
      .crc_o(crc)
  );

  always_ff @(posedge clk_i) begin
    started_q <= 1'b1;
    if (send && in_ready) sent_q <= sent_q + 1'b1;
    if (sent_q == '0) before_q <= crc;
    if (sent_q == 3'd4 && in_ready) last_q <= 1'b1;
  end
  always_comb begin
    if (sent_q == 3'd4 && in_ready && !last_q) assert ((crc == 32'hDEBB20E3) == (data == ~before_q));
  end
endmodule
