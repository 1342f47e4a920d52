// SPDX-License-Identifier: Apache-2.0
// Lines and words in an SDR SDRAM that runs in a clock of its own: line requests, answered in order with 64 bits of
// the line a cycle at most, and words of 32 bits to write, which go before lines. Addresses are of halfwords; a line
// starts at its address and is LineHalfwords long, a multiple of four.
//
// At most 4 lines are on their way. There is room for all of them on this side, so nothing depends on the ratio of the
// clocks, but the rate: the SDRAM's 16 bits a cycle need a quarter of its frequency here.
module sdram_lines #(
    parameter int unsigned TagBits = 3,
    parameter int unsigned LineHalfwords = 64,
    parameter int unsigned SdramKHz = 100000,  // frequency of clk_sdram_i at most
    parameter int unsigned RefreshesAhead = 0  // sdram_controller's
) (
    input  logic               clk_i,
    input  logic               rst_i,
    // lines
    input  logic               line_req_valid_i,
    output logic               line_req_ready_o,
    input  logic [       23:0] line_req_address_i,
    input  logic [TagBits-1:0] line_req_tag_i,
    output logic               line_rsp_valid_o,
    output logic [TagBits-1:0] line_rsp_tag_o,
    output logic [       63:0] line_rsp_data_o,
    // words; one that is not inside is taken and lost
    input  logic               write_valid_i,
    input  logic               write_inside_i,
    output logic               write_taken_o,
    input  logic [       23:0] write_address_i,
    input  logic [       31:0] write_data_i,
    output logic               ready_o,             // the SDRAM is initialised
    // events: a line has come; one is on its way
    output logic               done_o,
    output logic               busy_o,
    // the chip, in the domain of clk_sdram_i
    input  logic               clk_sdram_i,
    input  logic               rst_sdram_i,
    output logic               sdram_cke_o,
    output logic               sdram_cs_no,
    output logic               sdram_ras_no,
    output logic               sdram_cas_no,
    output logic               sdram_we_no,
    output logic [        1:0] sdram_ba_o,
    output logic [       12:0] sdram_a_o,
    output logic [        1:0] sdram_dqm_o,
    input  logic [       15:0] sdram_dq_i,
    output logic [       15:0] sdram_dq_o,
    output logic               sdram_dq_oe_o
);
  localparam int unsigned Outstanding = 4;
  localparam int unsigned OutBits = $clog2(Outstanding + 1);
  localparam int unsigned WideWords = LineHalfwords / 4;  // of 64 bits
  localparam int unsigned WideBits = $clog2(WideWords + 1);
  localparam int unsigned RspDepth = 1 << $clog2(Outstanding * WideWords);

  // ---- to the SDRAM's clock: {write, address, data}; words before lines ----
  logic go_valid, go_ready, line_go, line_taken;
  logic [23:0] sdram_address;
  logic [OutBits-1:0] outstanding_q;
  logic sdram_valid, sdram_ready, sdram_write;
  logic [31:0] sdram_data;

  assign line_go = line_req_valid_i && outstanding_q != OutBits'(Outstanding) && !write_valid_i;
  // In reset nothing is taken. What is held in reset itself need not know: rst_i goes a long way.
  assign go_valid = write_valid_i ? write_inside_i : line_go;
  assign write_taken_o = write_valid_i && (go_ready || !write_inside_i) && !rst_i;
  assign line_taken = line_go && go_ready;
  assign line_req_ready_o = outstanding_q != OutBits'(Outstanding) && !write_valid_i && go_ready && !rst_i;

  async_fifo #(
      .Width(57),
      .Depth(8)
  ) requests (
      .in_clk_i(clk_i),
      .in_rst_i(rst_i),
      .in_valid_i(go_valid),
      .in_ready_o(go_ready),
      .in_i({write_valid_i, write_valid_i ? write_address_i : line_req_address_i, write_data_i}),
      .out_clk_i(clk_sdram_i),
      .out_rst_i(rst_sdram_i),
      .out_valid_o(sdram_valid),
      .out_ready_i(sdram_ready),
      .out_o({sdram_write, sdram_address, sdram_data})
  );

  // ---- the controller ----
  logic half_valid, run;
  logic [15:0] half;

  sdram_controller #(
      .ClockKHz(SdramKHz),
      .LineHalfwords(LineHalfwords),
      .RefreshesAhead(RefreshesAhead)
  ) controller (
      .clk_i(clk_sdram_i),
      .rst_i(rst_sdram_i),
      .ready_o(run),
      .req_valid_i(sdram_valid),
      .req_ready_o(sdram_ready),
      .req_write_i(sdram_write),
      .req_address_i(sdram_address),
      .req_data_i(sdram_data),
      .rsp_valid_o(half_valid),
      .rsp_data_o(half),
      .sdram_cke_o(sdram_cke_o),
      .sdram_cs_no(sdram_cs_no),
      .sdram_ras_no(sdram_ras_no),
      .sdram_cas_no(sdram_cas_no),
      .sdram_we_no(sdram_we_no),
      .sdram_ba_o(sdram_ba_o),
      .sdram_a_o(sdram_a_o),
      .sdram_dqm_o(sdram_dqm_o),
      .sdram_dq_i(sdram_dq_i),
      .sdram_dq_o(sdram_dq_o),
      .sdram_dq_oe_o(sdram_dq_oe_o)
  );

  logic [1:0] run_q;
  always_ff @(posedge clk_i) run_q <= {run_q[0], run};
  assign ready_o = run_q[1] && !rst_i;

  // ---- back: four halfwords a word ----
  logic [63:0] wide_q;
  logic [1:0] half_q;
  logic wide_valid_q;
  always_ff @(posedge clk_sdram_i) begin
    wide_valid_q <= half_valid && half_q == 2'd3;
    if (half_valid) begin
      wide_q <= {half, wide_q[63:16]};
      half_q <= half_q + 1'b1;
    end
    if (rst_sdram_i) begin
      wide_valid_q <= 1'b0;
      half_q <= '0;
    end
  end

  /* verilator lint_off UNUSEDSIGNAL */  // has room for all lines outstanding
  logic back_ready, tags_ready;
  /* verilator lint_on UNUSEDSIGNAL */
  logic came;
  logic [63:0] came_data;
  async_fifo #(
      .Width(64),
      .Depth(RspDepth)
  ) responses (
      .in_clk_i(clk_sdram_i),
      .in_rst_i(rst_sdram_i),
      .in_valid_i(wide_valid_q),
      .in_ready_o(back_ready),
      .in_i(wide_q),
      .out_clk_i(clk_i),
      .out_rst_i(rst_i),
      .out_valid_o(came),
      .out_ready_i(1'b1),
      .out_o(came_data)
  );

  logic [WideBits-1:0] wide_count_q;
  /* verilator lint_off UNUSEDSIGNAL */  // an assertion alone reads it
  logic tag_valid;
  /* verilator lint_on UNUSEDSIGNAL */
  logic came_last;
  logic [TagBits-1:0] came_tag;
  assign came_last = came && wide_count_q == WideBits'(WideWords - 1);
  fifo #(
      .Width(TagBits),
      .Depth(Outstanding)
  ) tags (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(line_taken),
      .in_ready_o(tags_ready),
      .in_i(line_req_tag_i),
      .out_valid_o(tag_valid),
      .out_ready_i(came_last),
      .out_o(came_tag)
  );

  // Whether a word came is a comparison, and far from where lines are kept.
  always_ff @(posedge clk_i) begin
    line_rsp_valid_o <= came && !rst_i;
    line_rsp_data_o <= came_data;
    line_rsp_tag_o <= came_tag;
    done_o <= came_last && !rst_i;
    if (came) wide_count_q <= came_last ? '0 : wide_count_q + 1'b1;
    outstanding_q <= outstanding_q + OutBits'(line_taken) - OutBits'(came_last);
    if (rst_i) begin
      wide_count_q <= '0;
      outstanding_q <= '0;
    end
  end
  assign busy_o = outstanding_q != '0;

`ifndef SYNTHESIS
  always_ff @(posedge clk_i) if (!rst_i) assert (!came || tag_valid);
  always_ff @(posedge clk_sdram_i) if (!rst_sdram_i) assert (!wide_valid_q || back_ready);
`endif
endmodule
