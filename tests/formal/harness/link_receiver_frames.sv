// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/block_ram.sv rtl/board/link_receiver.sv
// sources: tests/formal/harness/stubs/ram_fifo.sv tests/formal/harness/stubs/link_crc.sv
// link_receiver: a frame counts as good iff its bytes since the last END are well stuffed, at least 6, at most 272, and
// their CRC leaves the residue. So one with a wrong CRC is never taken, and whatever came before an END does not matter to
// the frame after it. Bytes are looked at where the receiver takes them; its FIFO and the CRC are narrowed.
module link_receiver_frames (
    input logic clk_i,
    input logic rst_i,
    input logic frame_done_i
);
  logic frame_valid, frame_bad;
  logic [8:0] frame_bytes;
  logic take;  // probes: a byte is taken
  logic [7:0] data;

  link_receiver #(
      .RxBytes(4)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .byte_valid_i(1'b0),
      .byte_i(8'd0),
      .byte_lost_o(),
      .frame_valid_o(frame_valid),
      .frame_bad_o(frame_bad),
      .frame_bytes_o(frame_bytes),
      .frame_done_i(frame_done_i),
      .read_address_i(9'd0),
      .read_data_o()
  );

  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;
  always_comb assume (rst_i == !started_q);
  always_comb if (!rst_i && frame_done_i) assume (frame_valid);

  // The definition, byte by byte: what came since the last END.
  logic escape_q, broken_q, ended_q, good_q;
  logic [8:0] count_q;
  logic [1:0] crc_q;
  logic [7:0] plain;
  logic stands;
  assign stands = escape_q ? data == 8'hDC || data == 8'hDD : data != 8'hDB;
  assign plain  = !escape_q ? data : data == 8'hDC ? 8'hC0 : 8'hDB;

  always_ff @(posedge clk_i) begin
    ended_q <= 1'b0;
    if (take) begin
      if (data == 8'hC0) begin
        ended_q <= count_q != '0 || escape_q || broken_q;
        good_q <= !escape_q && !broken_q && count_q >= 9'd6 && crc_q == 2'd2;
        escape_q <= 1'b0;
        broken_q <= 1'b0;
        count_q <= '0;
        crc_q <= '1;
      end else begin
        escape_q <= !escape_q && data == 8'hDB;
        if (stands && count_q == 9'd272) broken_q <= 1'b1;
        if (escape_q && !stands) broken_q <= 1'b1;
        if (stands && count_q != 9'd272) begin
          count_q <= count_q + 1'b1;
          crc_q   <= {crc_q[0], crc_q[1] ^ plain[0]} + plain[2:1];
        end
      end
    end
    if (rst_i) begin
      escape_q <= 1'b0;
      broken_q <= 1'b0;
      count_q <= '0;
      crc_q <= '1;
      ended_q <= 1'b0;
    end
  end

  logic valid_q;
  always_ff @(posedge clk_i) valid_q <= frame_valid && !frame_done_i && !rst_i;
  always_comb begin
    if (!rst_i) begin
      // A frame appears in the cycle after its END, and judged as defined.
      if (frame_valid && !valid_q) assert (ended_q && frame_bad == !good_q);
      if (ended_q) assert (frame_valid);
      if (valid_q) assert (frame_valid && !take);
    end
  end
endmodule
