// SPDX-License-Identifier: Apache-2.0
// CRC-32 of IEEE 802.3 (reflected polynomial 0xEDB88320), a bit a cycle: a byte is taken when in_ready_o is 1 and is in
// crc_o 8 cycles later. crc_o is the register before the final inversion; over a message and its CRC, little endian, it
// ends as 0xDEBB20E3.
module link_crc (
    input  logic        clk_i,
    input  logic        clear_i,     // before a message, while in_ready_o is 1 or rst_i
    input  logic        rst_i,
    input  logic        in_valid_i,
    output logic        in_ready_o,
    input  logic [ 7:0] in_i,
    output logic [31:0] crc_o
);
  logic [7:0] bits_q;
  logic [3:0] left_q;
  logic feedback;

  assign in_ready_o = left_q == 4'd0;
  assign feedback = crc_o[0] ^ bits_q[0];

  always_ff @(posedge clk_i) begin
    bits_q <= in_ready_o ? in_i : {1'b0, bits_q[7:1]};
    if (!in_ready_o) begin
      left_q <= left_q - 4'd1;
      crc_o  <= {1'b0, crc_o[31:1]} ^ (feedback ? 32'hEDB88320 : 32'd0);
    end else if (in_valid_i) begin
      left_q <= 4'd8;
    end
    if (clear_i) crc_o <= '1;
    if (rst_i) left_q <= 4'd0;
  end
endmodule
