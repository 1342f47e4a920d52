// SPDX-License-Identifier: Apache-2.0
// Leaf lines straight from the line port to the lanes, where a plan has no leaf cache: each leaf that is reached fetches its
// line. What the cache does is not there: no tags, no memory of lines, no second lookup.
//
// Where ready_i says that there is room for its line behind the lanes, a leaf's line is asked for, and issue_o says so; else it
// waits in a queue. Each context has one leaf at a time, so its number is the tag, and a reply finds its way whenever it
// comes. Beats of a line come in order and not interleaved, and are always taken; PartBeats of them are a part, what the
// lanes take a cycle. Plain lines only.
//
// One line in two cycles. Latency 1 cycle from in_valid_i to the request; a part leaves in the cycle in which its last beat comes.
// With Parity a beat's highest bit says that it was not read right where it comes from; out_wrong_o tells of the part of
// the cycle before.
module photon_gatherer_uncached #(
    parameter int unsigned Contexts = 16,
    parameter int unsigned AddressBits = 14,
    parameter int unsigned Items = 8,
    parameter int unsigned ItemBytes = 16,
    parameter int unsigned ItemBits = 96,
    parameter int unsigned Parts = 2,
    parameter int unsigned BeatBits = 128,
    parameter int unsigned Parity = 0,
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned PartBits = Parts > 1 ? $clog2(Parts) : 1,
    localparam int unsigned DataBits = Items / Parts * ItemBits
) (
    input  logic                       clk_i,
    input  logic                       rst_i,
    // requests, always taken
    input  logic                       in_valid_i,
    input  logic [    ContextBits-1:0] in_context_i,
    input  logic [    AddressBits-1:0] in_address_i,
    // room for a line, and that one begins
    input  logic                       ready_i,
    output logic                       issue_o,
    // parts of lines
    output logic                       out_valid_o,
    output logic [    ContextBits-1:0] out_context_o,
    output logic [       PartBits-1:0] out_part_o,
    output logic [       DataBits-1:0] out_data_o,
    output logic                       out_wrong_o,       // the part of the cycle before
    // memory
    output logic                       line_req_valid_o,
    input  logic                       line_req_ready_i,
    output logic [    AddressBits-1:0] line_req_addr_o,
    output logic [    ContextBits-1:0] line_req_tag_o,
    input  logic                       line_rsp_valid_i,
    input  logic [    ContextBits-1:0] line_rsp_tag_i,
    input  logic [BeatBits+Parity-1:0] line_rsp_data_i
);
  localparam int unsigned PartLineBits = Items / Parts * ItemBytes * 8;
  localparam int unsigned PartBeats = PartLineBits / BeatBits;
  localparam int unsigned BeatCountBits = PartBeats > 1 ? $clog2(PartBeats) : 1;
  localparam int unsigned QueueDepth = Contexts > 2 ? 1 << $clog2(Contexts) : 2;

  if (PartBeats * BeatBits != PartLineBits || Items % Parts != 0) begin : gen_bad_beat
    without_a_leaf_cache_a_beat_must_divide_what_the_lanes_take_a_cycle bad_beat ();
  end

  // ---- requests ----
  logic waiting, free;
  logic [AddressBits-1:0] address;
  logic [ContextBits-1:0] tag;
  /* verilator lint_off UNUSEDSIGNAL */  // the queue holds every context
  logic queue_ready;
  /* verilator lint_on UNUSEDSIGNAL */

  fifo #(
      .Width(ContextBits + AddressBits),
      .Depth(QueueDepth)
  ) requests (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i && (waiting || !free)),
      .in_ready_o(queue_ready),
      .in_i({in_context_i, in_address_i}),
      .out_valid_o(waiting),
      .out_ready_i(free),
      .out_o({tag, address})
  );

  assign free = ready_i && !line_req_valid_o;
  assign issue_o = free && (waiting || in_valid_i);
  always_ff @(posedge clk_i) begin
    if (line_req_ready_i) line_req_valid_o <= 1'b0;
    if (free) begin
      line_req_valid_o <= issue_o;
      line_req_addr_o  <= waiting ? address : in_address_i;
      line_req_tag_o   <= waiting ? tag : in_context_i;
    end
    if (rst_i) line_req_valid_o <= 1'b0;
  end

  // ---- replies ----
  logic [BeatCountBits-1:0] beat_q;
  logic [PartBits-1:0] part_q;
  logic last_beat;
  /* verilator lint_off UNUSEDSIGNAL */  // the padding of items
  logic [PartLineBits-1:0] raw;
  /* verilator lint_on UNUSEDSIGNAL */

  assign last_beat = PartBeats == 1 || beat_q == BeatCountBits'(PartBeats - 1);
  assign out_valid_o = line_rsp_valid_i && last_beat;
  assign out_context_o = line_rsp_tag_i;
  assign out_part_o = part_q;
  always_ff @(posedge clk_i) begin
    if (line_rsp_valid_i) begin
      beat_q <= last_beat ? '0 : beat_q + 1'b1;
      if (last_beat) part_q <= Parts == 1 || part_q == PartBits'(Parts - 1) ? '0 : part_q + 1'b1;
    end
    if (rst_i) begin
      beat_q <= '0;
      part_q <= '0;
    end
  end
  if (PartBeats > 1) begin : gen_collect
    logic [PartLineBits-BeatBits-1:0] collected_q;  // beats of the part that have come, the last one highest
    always_ff @(posedge clk_i) if (line_rsp_valid_i) collected_q <= raw[PartLineBits-1:BeatBits];
    assign raw = {line_rsp_data_i[BeatBits-1:0], collected_q};
  end else begin : gen_whole
    assign raw = line_rsp_data_i[BeatBits-1:0];
  end
  for (genvar item = 0; item < Items / Parts; item++) begin : gen_item
    assign out_data_o[ItemBits*item+:ItemBits] = raw[ItemBytes*8*item+:ItemBits];
  end

  if (Parity != 0) begin : gen_parity
    logic wrong, wrong_q;  // a beat of the part that has come so far
    assign wrong = line_rsp_data_i[BeatBits] || (beat_q != '0 && wrong_q);
    always_ff @(posedge clk_i) begin
      if (line_rsp_valid_i) wrong_q <= wrong;
      out_wrong_o <= out_valid_o && wrong;
      if (rst_i) out_wrong_o <= 1'b0;
    end
  end else begin : gen_no_parity
    assign out_wrong_o = 1'b0;
  end
endmodule
