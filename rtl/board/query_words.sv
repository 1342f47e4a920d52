// SPDX-License-Identifier: Apache-2.0
// The input stream of docs/host-link.md: words from the link wait in block RAM and become queries, the least significant
// word first. position_o is the number of the next
// word; it stays when a word comes for which there is no room, and that word is lost. While hold_i is 1 no query begins. clear_i forgets all words and
// starts again at position 0; a query that is already offered stays until it is taken. busy_o: a word or a query is here.
// Throughput: a query in QueryWords + 1 cycles.
module query_words #(
    parameter int unsigned Depth = 512  // words that wait
) (
    input  logic                           clk_i,
    input  logic                           rst_i,
    input  logic                           clear_i,
    input  logic                           hold_i,
    input  logic                           in_valid_i,
    input  logic                    [31:0] in_i,
    output logic                    [31:0] position_o,
    output logic                    [15:0] room_o,
    output logic                           busy_o,
    output logic                           out_valid_o,
    input  logic                           out_ready_i,
    output photonloom_pkg::gather_query_t  out_o
);
  localparam int unsigned Bits = photonloom_pkg::GatherQueryPacketBits;
  localparam int unsigned Words = (Bits + 31) / 32;
  localparam int unsigned CountBits = $clog2(Words + 1);

  logic in_ready, waiting, take, empty;
  logic [31:0] word;
  logic [$clog2(Depth):0] room;
  ram_fifo #(
      .Width(32),
      .Depth(Depth)
  ) words (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .clear_i(clear_i),
      .in_valid_i(in_valid_i),
      .in_ready_o(in_ready),
      .in_i(in_i),
      .out_valid_o(waiting),
      .out_ready_i(take),
      .out_o(word),
      .room_o(room),
      .empty_o(empty)
  );
  assign room_o = 16'(room);

  logic [32*Words-1:0] query_q;
  logic [CountBits-1:0] count_q;  // words of the query that are in query_q
  assign take = !out_valid_o && !hold_i;
  assign out_o = query_q[Bits-1:0];
  assign busy_o = !empty || count_q != '0 || out_valid_o;
  if (32 * Words > Bits) begin : gen_unused
    logic unused;
    assign unused = &{1'b0, query_q[32*Words-1:Bits]};
  end

  always_ff @(posedge clk_i) begin
    if (in_valid_i && in_ready) position_o <= position_o + 32'd1;
    if (take && waiting) begin
      query_q <= (32 * Words)'({word, query_q} >> 32);
      count_q <= count_q + 1'b1;
      if (count_q == CountBits'(Words - 1)) begin
        count_q <= '0;
        out_valid_o <= 1'b1;
      end
    end
    if (out_valid_o && out_ready_i) out_valid_o <= 1'b0;
    if (clear_i) begin
      position_o <= '0;
      count_q <= '0;
      if (!out_valid_o) out_valid_o <= 1'b0;  // nor does one become whole now
    end
    if (rst_i) begin
      position_o <= '0;
      count_q <= '0;
      out_valid_o <= 1'b0;
    end
  end
endmodule
