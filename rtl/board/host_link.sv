// SPDX-License-Identifier: Apache-2.0
// The board's side of docs/host-link.md between the UART's two wires and the words of the address space and of the two
// streams. Frames wait in RxBytes bytes of block RAM while an answer is on its way; the line limits the rate, not this.
// It answers whatever the gatherers do: nothing here waits for them but a write that write_ready_i keeps waiting.
module host_link #(
    parameter int unsigned ClocksPerBit = 4,
    parameter int unsigned RxBytes = 2048
) (
    input  logic        clk_i,
    input  logic        rst_i,
    input  logic        uart_rx_i,
    output logic        uart_tx_o,
    // one cycle each
    output logic        byte_received_o,
    output logic        byte_sent_o,
    output logic        byte_lost_o,
    output logic        frame_bad_o,
    // as in link_commands
    output logic [31:0] address_o,
    output logic        first_o,
    output logic        read_valid_o,
    input  logic [31:0] read_word_i,
    output logic        write_valid_o,
    input  logic        write_ready_i,
    input  logic [ 1:0] write_status_i,
    output logic [31:0] write_word_o,
    output logic        write_last_o,
    output logic        push_valid_o,
    output logic [31:0] push_word_o,
    input  logic [31:0] push_position_i,
    input  logic [15:0] push_room_i,
    output logic        keep_valid_o,
    input  logic        pull_before_i,
    input  logic        pull_after_i,
    input  logic [31:0] pull_first_i,
    input  logic [31:0] pull_end_i,
    input  logic [31:0] pull_word_i
);
  logic in_valid;
  logic [7:0] in;
  uart_rx #(
      .ClocksPerBit(ClocksPerBit)
  ) incoming (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .rx_i(uart_rx_i),
      .valid_o(in_valid),
      .data_o(in)
  );
  assign byte_received_o = in_valid;

  logic frame_valid, frame_bad, frame_done;
  logic [8:0] frame_bytes, frame_address;
  logic [7:0] frame_data;
  link_receiver #(
      .RxBytes(RxBytes)
  ) receiver (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .byte_valid_i(in_valid),
      .byte_i(in),
      .byte_lost_o(byte_lost_o),
      .frame_valid_o(frame_valid),
      .frame_bad_o(frame_bad),
      .frame_bytes_o(frame_bytes),
      .frame_done_i(frame_done),
      .read_address_i(frame_address),
      .read_data_o(frame_data)
  );

  logic answer_valid, answer_ready, answer_last;
  logic [7:0] answer;
  link_commands commands (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .frame_valid_i(frame_valid),
      .frame_bad_i(frame_bad),
      .frame_bytes_i(frame_bytes),
      .frame_done_o(frame_done),
      .frame_bad_o(frame_bad_o),
      .read_address_o(frame_address),
      .read_data_i(frame_data),
      .answer_valid_o(answer_valid),
      .answer_ready_i(answer_ready),
      .answer_o(answer),
      .answer_last_o(answer_last),
      .address_o(address_o),
      .first_o(first_o),
      .read_valid_o(read_valid_o),
      .read_word_i(read_word_i),
      .write_valid_o(write_valid_o),
      .write_ready_i(write_ready_i),
      .write_status_i(write_status_i),
      .write_word_o(write_word_o),
      .write_last_o(write_last_o),
      .push_valid_o(push_valid_o),
      .push_word_o(push_word_o),
      .push_position_i(push_position_i),
      .push_room_i(push_room_i),
      .keep_valid_o(keep_valid_o),
      .pull_before_i(pull_before_i),
      .pull_after_i(pull_after_i),
      .pull_first_i(pull_first_i),
      .pull_end_i(pull_end_i),
      .pull_word_i(pull_word_i)
  );

  logic out_valid, out_ready;
  logic [7:0] out;
  link_sender sender (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(answer_valid),
      .in_ready_o(answer_ready),
      .in_i(answer),
      .in_last_i(answer_last),
      .out_valid_o(out_valid),
      .out_ready_i(out_ready),
      .out_o(out)
  );
  uart_tx #(
      .ClocksPerBit(ClocksPerBit)
  ) outgoing (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(out_valid),
      .in_ready_o(out_ready),
      .in_i(out),
      .tx_o(uart_tx_o)
  );
  assign byte_sent_o = out_valid && out_ready;
endmodule
