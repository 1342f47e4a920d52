// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/lut_ram.sv rtl/common/fifo.sv rtl/common/async_fifo.sv tests/formal/harness/stubs/sdram_controller.sv
// sources: rtl/board/sdram_lines.sv
// sdram_lines: lines come back in the order in which they were taken, each whole, with its tag, its halfwords in their places,
// and none that was not asked for; at most four are on their way. With What 1: the controller gets words and lines in the order in
// which they were taken, unchanged, but words that are not inside. Clocks, requests and the controller's pace are any; each
// step of the proof is an edge of either clock or of both. Of addresses and of data, which only pass, the lowest four bits vary.
module sdram_lines_order #(
    parameter int unsigned What = 0,  // 0: replies, 1: requests
    localparam int unsigned TagBits = 2,
    localparam int unsigned LineHalfwords = 8
) (
    input logic clk_i,
    input logic clk_sdram_i,
    input logic line_req_valid_i,
    input logic [3:0] line_req_address_i,
    input logic [TagBits-1:0] line_req_tag_i,
    input logic write_valid_i,
    input logic write_inside_i,
    input logic [3:0] write_address_i,
    input logic [3:0] write_data_i
);
  logic rst, req_ready, rsp_valid, write_taken, done, busy, told, told_line;
  logic [TagBits-1:0] rsp_tag;
  logic [63:0] rsp_data;
  logic [14:0] told_address;
  logic [15:0] told_data;

  sdram_lines #(
      .TagBits(TagBits),
      .LineHalfwords(LineHalfwords)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst),
      .line_req_valid_i(line_req_valid_i),
      .line_req_ready_o(req_ready),
      .line_req_address_i(24'(line_req_address_i)),
      .line_req_tag_i(line_req_tag_i),
      .line_rsp_valid_o(rsp_valid),
      .line_rsp_tag_o(rsp_tag),
      .line_rsp_data_o(rsp_data),
      .write_valid_i(write_valid_i),
      .write_inside_i(write_inside_i),
      .write_taken_o(write_taken),
      .write_address_i(24'(write_address_i)),
      .write_data_i(32'(write_data_i)),
      .ready_o(),
      .done_o(done),
      .busy_o(busy),
      .clk_sdram_i(clk_sdram_i),
      .rst_sdram_i(rst),
      .sdram_cke_o(told),
      .sdram_cs_no(),
      .sdram_ras_no(),
      .sdram_cas_no(),
      .sdram_we_no(told_line),
      .sdram_ba_o(told_address[14:13]),
      .sdram_a_o(told_address[12:0]),
      .sdram_dqm_o(),
      .sdram_dq_i(16'd0),
      .sdram_dq_o(told_data),
      .sdram_dq_oe_o()
  );

  // Reset is over once each side has had an edge in it.
  logic started_q = 1'b0, sdram_started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;
  always_ff @(posedge clk_sdram_i) sdram_started_q <= 1'b1;
  assign rst = !started_q || !sdram_started_q;

  logic line_taken, word_taken;
  assign line_taken = line_req_valid_i && req_ready && !rst;
  assign word_taken = write_valid_i && write_taken && write_inside_i && !rst;

  // ---- replies: lines are numbered as they are taken ----
  logic [3:0] taken_q = '0, came_q = '0;
  logic second_q = 1'b0;
  logic [TagBits-1:0] tags_q[0:7];
  logic [63:0] expected;
  always_comb
    for (int unsigned h = 0; h < 4; h++) expected[16*h+:16] = 16'({came_q[2:0], second_q, 2'(h)});
  always_ff @(posedge clk_i) begin
    if (line_taken) begin
      tags_q[taken_q[2:0]] <= line_req_tag_i;
      taken_q <= taken_q + 1'b1;
    end
    if (rsp_valid && !rst) begin
      second_q <= !second_q;
      if (second_q) came_q <= came_q + 1'b1;
    end
    if (What == 0 && !rst) begin
      assert (4'(taken_q - came_q) <= 4'd4 + 4'(rsp_valid && second_q));
      assert (done == (rsp_valid && second_q));
      // A reply leaves a cycle after it is counted as no longer on its way.
      assert (busy == (taken_q != came_q + 4'(done)));
      if (rsp_valid) assert (taken_q != came_q && rsp_tag == tags_q[came_q[2:0]] && rsp_data == expected);
    end
  end

  // ---- requests: one, any, is followed ----
  (* anyconst *) logic [3:0] number;
  logic [3:0] in_q = '0, out_q = '0;
  logic followed_q = 1'b0, line_q;
  logic [3:0] address_q, data_q;
  always_ff @(posedge clk_i) begin
    if (line_taken || word_taken) begin
      in_q <= in_q + 1'b1;
      if (in_q == number) begin
        followed_q <= 1'b1;
        line_q <= !word_taken;
        address_q <= word_taken ? write_address_i : line_req_address_i;
        data_q <= write_data_i;
      end
    end
    if (What == 1 && !rst) assert (!(line_taken && write_valid_i));
  end
  always_ff @(posedge clk_sdram_i) begin
    if (told && !rst) out_q <= out_q + 1'b1;
    if (What == 1 && !rst && told && out_q == number) begin
      assert (followed_q && told_line == line_q && told_address == 15'(address_q));
      if (!line_q) assert (told_data == 16'(data_q));
    end
  end
endmodule
