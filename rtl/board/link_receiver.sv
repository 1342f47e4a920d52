// SPDX-License-Identifier: Apache-2.0
// From the UART's bytes to frames (docs/host-link.md): RxBytes bytes wait in block RAM; one frame at a time is unstuffed
// into a buffer and its CRC checked. frame_valid_o stays until frame_done_i; meanwhile frame_bad_o and frame_bytes_o (id
// to CRC) hold and byte read_address_i of the frame is in read_data_o two cycles later. A byte that comes when RxBytes wait is lost.
// Throughput: a byte in 10 cycles.
module link_receiver #(
    parameter int unsigned RxBytes = 2048,
    localparam int unsigned MaxFrame = 272
) (
    input  logic       clk_i,
    input  logic       rst_i,
    input  logic       byte_valid_i,
    input  logic [7:0] byte_i,
    output logic       byte_lost_o,
    output logic       frame_valid_o,
    output logic       frame_bad_o,
    output logic [8:0] frame_bytes_o,
    input  logic       frame_done_i,
    input  logic [8:0] read_address_i,
    output logic [7:0] read_data_o
);
  localparam logic [7:0] End = 8'hC0;
  localparam logic [7:0] Escape = 8'hDB;
  localparam logic [7:0] EscapedEnd = 8'hDC;
  localparam logic [7:0] EscapedEscape = 8'hDD;
  localparam logic [31:0] Residue = 32'hDEBB20E3;

  logic waiting, take, room;
  logic [7:0] data;
  /* verilator lint_off PINCONNECTEMPTY */
  ram_fifo #(
      .Width(8),
      .Depth(RxBytes)
  ) bytes (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .clear_i(1'b0),
      .in_valid_i(byte_valid_i),
      .in_ready_o(room),
      .in_i(byte_i),
      .out_valid_o(waiting),
      .out_ready_i(take),
      .out_o(data),
      .room_o(),
      .empty_o()
  );
  /* verilator lint_on PINCONNECTEMPTY */
  assign byte_lost_o = byte_valid_i && !room;

  logic escaped_q, bad_q, crc_ready, store;
  logic [ 8:0] bytes_q;
  logic [31:0] crc;
  logic is_end, escaped_good;
  logic [7:0] plain, stored;

  assign take = waiting && crc_ready && !frame_valid_o;
  assign is_end = data == End;
  assign escaped_good = data == EscapedEnd || data == EscapedEscape;
  assign plain = !escaped_q ? data : data == EscapedEnd ? End : Escape;
  assign store = take && !is_end && (escaped_q ? escaped_good : data != Escape) && bytes_q != 9'(MaxFrame);
  assign frame_bytes_o = bytes_q;

  link_crc crc32 (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .clear_i(rst_i || frame_done_i),
      .in_valid_i(store),
      .in_ready_o(crc_ready),
      .in_i(plain),
      .crc_o(crc)
  );

  block_ram #(
      .Width(8),
      .Depth(512)
  ) frame (
      .clk_i(clk_i),
      .write_i(store),
      .write_address_i(bytes_q),
      .write_data_i(plain),
      .read_i(frame_valid_o),
      .read_address_i(read_address_i),
      .read_data_o(stored)
  );

  always_ff @(posedge clk_i) begin
    read_data_o <= stored;
    if (take) begin
      escaped_q <= !is_end && !escaped_q && data == Escape;
      if (is_end) begin
        // Nothing between two ENDs is no frame.
        frame_valid_o <= bytes_q != 9'd0 || escaped_q || bad_q;
        frame_bad_o   <= bad_q || escaped_q || bytes_q < 9'd6 || crc != Residue;
      end else if (!store && (escaped_q || data != Escape)) begin
        bad_q <= 1'b1;
      end
      if (store) bytes_q <= bytes_q + 9'd1;
    end
    if (rst_i || frame_done_i) begin
      frame_valid_o <= 1'b0;
      escaped_q <= 1'b0;
      bad_q <= 1'b0;
      bytes_q <= '0;
    end
  end
endmodule
