// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/skid_buffer.sv rtl/common/word_sender.sv rtl/common/word_receiver.sv tests/formal/harness/stream_checks.sv
// word_sender and word_receiver keep the laws of a stream of packets, with a skid buffer between them and words that wait before
// and behind it as long as they like. Of a packet one bit is followed, any; the others are any. The highest word is filled up.
module word_stream #(
    parameter int unsigned Between = 1,  // words wait, and pass a skid buffer
    parameter int unsigned Order = 1,
    parameter int unsigned Law = 1,
    parameter int unsigned Progress = 1,
    localparam int unsigned Width = 5,
    localparam int unsigned Words = 3,
    localparam int unsigned WordBits = 2
) (
    input logic clk_i,
    input logic rst_i,
    input logic in_valid_i,
    input logic [Width-1:0] in_i,
    input logic out_ready_i,
    input logic [1:0] wait_i  // no word goes into the skid buffer, none out of it
);
  (* anyconst *) logic [2:0] watched;  // bit
  logic in_ready, sent_valid, sent_ready, word_valid, word_ready, out_valid;
  logic [WordBits-1:0] sent, word;
  logic [Width-1:0] out;

  word_sender #(
      .Width(Width),
      .Words(Words)
  ) dut_sender (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i),
      .in_ready_o(in_ready),
      .in_i(in_i),
      .out_valid_o(sent_valid),
      .out_ready_i(sent_ready),
      .out_o(sent)
  );
  if (Between == 1) begin : gen_between
    logic between_valid, between_ready;
    skid_buffer #(
        .Width(WordBits)
    ) between (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .in_valid_i(sent_valid && !wait_i[0]),
        .in_ready_o(between_ready),
        .in_i(sent),
        .out_valid_o(between_valid),
        .out_ready_i(word_ready && !wait_i[1]),
        .out_o(word)
    );
    assign sent_ready = between_ready && !wait_i[0];
    assign word_valid = between_valid && !wait_i[1];
  end else begin : gen_wires
    assign sent_ready = word_ready;
    assign word_valid = sent_valid;
    assign word = sent;
  end
  word_receiver #(
      .Width(Width),
      .Words(Words)
  ) dut_receiver (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(word_valid),
      .in_ready_o(word_ready),
      .in_i(word),
      .out_valid_o(out_valid),
      .out_ready_i(out_ready_i),
      .out_o(out)
  );

  // The giver holds its packet.
  logic started_q = 1'b0;
  logic held_q;
  logic [Width-1:0] held_packet_q;
  always_ff @(posedge clk_i) begin
    started_q <= 1'b1;
    held_q <= !rst_i && in_valid_i && !in_ready;
    held_packet_q <= in_i;
  end
  always_comb begin
    assume (rst_i == !started_q);
    assume (watched < 3'(Width));
    if (!rst_i && held_q) assume (in_valid_i && in_i == held_packet_q);
    if (Progress == 1) assume (wait_i == '0);
  end

  // A packet takes its words and a cycle in which it stands.
  stream_checks #(
      .Order(Order),
      .Law(Law),
      .Progress(Progress),
      .Limit(Words + 1)
  ) checks (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i),
      .in_ready_i(in_ready),
      .in_i(in_i[watched]),
      .out_valid_i(out_valid),
      .out_ready_i(out_ready_i),
      .out_i(out[watched])
  );
endmodule
