// SPDX-License-Identifier: Apache-2.0
// From the bytes of an answer (id, command, body; the last one marked) to a frame of docs/host-link.md: END, the bytes and
// their CRC stuffed, END. Faster than any UART.
module link_sender (
    input  logic       clk_i,
    input  logic       rst_i,
    input  logic       in_valid_i,
    output logic       in_ready_o,
    input  logic [7:0] in_i,
    input  logic       in_last_i,
    output logic       out_valid_o,
    input  logic       out_ready_i,
    output logic [7:0] out_o
);
  localparam logic [7:0] End = 8'hC0;
  localparam logic [7:0] Escape = 8'hDB;

  typedef enum logic [2:0] {
    Idle,
    Begin,    // END
    Body,     // a byte is taken
    Check,    // one of the CRC
    Send,
    Escaped,  // what follows an escape
    Finish    // END
  } state_t;
  state_t state_q, after;
  logic crc_ready, last_q, special;
  logic [7:0] byte_q, crc_byte;
  logic [2:0] crc_left_q;
  logic [31:0] crc;

  link_crc crc32 (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .clear_i(state_q == Idle),
      .in_valid_i(in_valid_i && in_ready_o),
      .in_ready_o(crc_ready),
      .in_i(in_i),
      .crc_o(crc)
  );

  assign in_ready_o = state_q == Body && crc_ready;
  assign after = !last_q ? Body : crc_left_q == 3'd0 ? Finish : Check;
  assign special = byte_q == End || byte_q == Escape;
  always_comb begin
    unique case (crc_left_q[1:0])
      2'd0: crc_byte = ~crc[7:0];
      2'd3: crc_byte = ~crc[15:8];
      2'd2: crc_byte = ~crc[23:16];
      default: crc_byte = ~crc[31:24];
    endcase
  end

  assign out_valid_o = state_q == Begin || state_q == Send || state_q == Escaped || state_q == Finish;
  always_comb begin
    if (state_q == Send) out_o = special ? Escape : byte_q;
    else if (state_q == Escaped) out_o = byte_q == End ? 8'hDC : 8'hDD;
    else out_o = End;
  end

  always_ff @(posedge clk_i) begin
    unique case (state_q)
      Idle: begin
        last_q <= 1'b0;
        crc_left_q <= 3'd4;
        if (in_valid_i) state_q <= Begin;
      end
      Begin: if (out_ready_i) state_q <= Body;
      Body: begin
        byte_q <= in_i;
        if (in_valid_i && crc_ready) begin
          last_q  <= in_last_i;
          state_q <= Send;
        end
      end
      Check: begin
        byte_q <= crc_byte;
        if (crc_ready) begin
          crc_left_q <= crc_left_q - 3'd1;
          state_q <= Send;
        end
      end
      Send: if (out_ready_i) state_q <= special ? Escaped : after;
      Escaped: if (out_ready_i) state_q <= after;
      default: if (out_ready_i) state_q <= Idle;
    endcase
    if (rst_i) state_q <= Idle;
  end
endmodule
