// SPDX-License-Identifier: Apache-2.0
// In place of sdram_controller where chip and addresses do not matter: two lines are inside at most, their halfwords come in
// order, after any time and with any gaps, and words are taken at any time. A halfword is {number of its line modulo 8, its
// place}. The pins tell what is taken: cke that something is, we_n that it is a line, {ba, a} the low bits of its address, dq of its data.
module sdram_controller #(
    parameter int unsigned ClockKHz = 100000,
    parameter int unsigned LineHalfwords = 8
) (
    input  logic        clk_i,
    input  logic        rst_i,
    output logic        ready_o,
    input  logic        req_valid_i,
    output logic        req_ready_o,
    input  logic        req_write_i,
    input  logic [23:0] req_address_i,
    input  logic [31:0] req_data_i,
    output logic        rsp_valid_o,
    output logic [15:0] rsp_data_o,
    output logic        sdram_cke_o,
    output logic        sdram_cs_no,
    output logic        sdram_ras_no,
    output logic        sdram_cas_no,
    output logic        sdram_we_no,
    output logic [ 1:0] sdram_ba_o,
    output logic [12:0] sdram_a_o,
    output logic [ 1:0] sdram_dqm_o,
    input  logic [15:0] sdram_dq_i,
    output logic [15:0] sdram_dq_o,
    output logic        sdram_dq_oe_o
);
  localparam int unsigned PlaceBits = $clog2(LineHalfwords);
  (* anyseq *) logic takes, gives;
  logic [1:0] inside_q;
  logic [2:0] line_q;
  logic [PlaceBits-1:0] place_q;
  logic line_taken, line_given;

  assign req_ready_o = takes && inside_q != 2'd2 && !rst_i;
  assign rsp_valid_o = gives && inside_q != 2'd0 && !rst_i;
  assign rsp_data_o = 16'({line_q, place_q});
  assign line_taken = req_valid_i && req_ready_o && !req_write_i;
  assign line_given = rsp_valid_o && place_q == PlaceBits'(LineHalfwords - 1);
  always_ff @(posedge clk_i) begin
    inside_q <= inside_q + 2'(line_taken) - 2'(line_given);
    if (rsp_valid_o) place_q <= line_given ? '0 : place_q + 1'b1;
    if (line_given) line_q <= line_q + 1'b1;
    if (rst_i) {inside_q, line_q, place_q} <= '0;
  end

  assign ready_o = !rst_i;
  assign sdram_cke_o = req_valid_i && req_ready_o;
  assign sdram_we_no = !req_write_i;
  assign {sdram_ba_o, sdram_a_o} = req_address_i[14:0];
  assign sdram_dq_o = req_data_i[15:0];
  assign {sdram_cs_no, sdram_ras_no, sdram_cas_no, sdram_dqm_o, sdram_dq_oe_o} = '0;
endmodule
